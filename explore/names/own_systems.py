"""What a command line says about a system: which one, its parameters, limits by name, where a family starts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import inf
from pathlib import Path

from orbitproof.explore.names.exact_numbers import NO_NUMBER, exact_number, number_in
from orbitproof.shared.formats import ArgumentError, InputError, load_system, under_reversor
from orbitproof.shared.systems import SYSTEMS, ReversibleSystem

SEARCHED = ("cr3bp", "cr3bp-axial", "cr3bp-planar", "falkner-skan")
"""Systems that a search may be asked for by name."""


def system_named(text: str) -> ReversibleSystem:
    """A system by its name or by its file, with a further reversor after a colon. Raises `InputError`."""
    if text in SEARCHED:
        return SYSTEMS[text]
    name, colon, reversor = text.rpartition(":")
    if colon and not Path(text).exists():
        return under_reversor(system_named(name), reversor, f"--system {text}")
    if Path(text).suffix not in (".py", ".json"):
        known = ", ".join(SEARCHED)
        raise InputError(f"--system {text}: unknown; give one of {known}, or your own system's file (.py or .json)")
    system = load_system(text)
    if not isinstance(system, ReversibleSystem):
        raise InputError(f"--system {text}: has neither R nor section; give both: searches are for symmetric orbits")
    if not system.kernel_coordinates:
        raise InputError(
            f"{text}: R negates the coordinate of the section alone: orbits have no multipliers besides 1, and nothing "
            "branches off; give a system of three coordinates or more"
        )
    return system


def exact_parameters(
    system: ReversibleSystem,
    texts: Mapping[str, str],
    varying: str | None = None,
    why_not: Callable[[ReversibleSystem, str, Fraction], str | None] = lambda system, name, value: None,
) -> dict[str, Fraction]:
    """The exact fixed parameters but a `varying` one from texts by name.

    `why_not` says of a value of a parameter why it is refused. Raises `ArgumentError` about `parameters`.
    """
    fixed = [name for name in system.fixed_parameters if name != varying]
    for name in texts:
        if name not in fixed:
            known = ", ".join(fixed) or "none"
            words = "{parameters:--parameter} {0}: {1} has no such fixed parameter; it has {2}"
            raise ArgumentError(words, name, system.name, known)
    result = {}
    for name in fixed:
        if name not in texts:
            words = "{parameters:--parameter}: {0} is missing; give {parameters:--parameter} {0}=VALUE"
            raise ArgumentError(words, name)
        value = number_in(texts[name])
        if value is None:
            raise ArgumentError("{parameters:--parameter} {0} {1}: {2}", name, texts[name], NO_NUMBER)
        if not system.parameters[name].contains(value):
            words = "{parameters:--parameter} {0}={1}: outside {2}; give a value inside"
            raise ArgumentError(words, name, texts[name], system.parameters[name])
        if (why := why_not(system, name, value)) is not None:
            raise ArgumentError("{parameters:--parameter} {0}={1}: {2}", name, texts[name], why)
        result[name] = value
    return result


def label_of(system: ReversibleSystem, mass: str | None, assignments: Sequence[str] | None) -> str:
    """What the parameters are called in messages and ids."""
    return mass or "-".join([system.name, *assignments] if assignments else [])


def bounds_of(
    names: Sequence[str], smallest: Sequence[Sequence[str]] | None, largest: Sequence[Sequence[str]] | None
) -> dict[str, tuple[float, float]]:
    """The intervals that ``--parameter-min`` and ``--parameter-max`` give by name. Raises `InputError`."""
    result: dict[str, tuple[float, float]] = {}
    for option, pairs, place in (("--parameter-min", smallest, 0), ("--parameter-max", largest, 1)):
        for name, text in pairs or ():
            if name not in names:
                raise InputError(f"{option} {name}: unknown; give one of {', '.join(names)}")
            ends = list(result.get(name, (-inf, inf)))
            ends[place] = finite_number(f"{option} {name}", text)
            if not ends[0] < ends[1]:
                raise InputError(f"{option} {name} {text}: an empty interval; give --parameter-min the smaller value")
            result[name] = (ends[0], ends[1])
    return result


def place_of(
    system: ReversibleSystem, option: str, words: Sequence[str], *, complete: bool, varying: str | None = None
) -> Mapping[str, float]:
    """Centre coordinates by name from words like ``y=0.2``; all of them if `complete`. Raises `InputError`.

    A `varying` parameter comes before them.
    """
    names = system.centre_coordinates if varying is None else (varying, *system.centre_coordinates)
    result: dict[str, float] = {}
    for name, text in values_by_name(option, words).items():
        if name not in names:
            raise InputError(f"{option} {name}: no coordinate of {system.name} on Fix(R); give {', '.join(names)}")
        result[name] = finite_number(f"{option} {name}", text)
        range_ = system.parameters[name] if name in (system.family_parameter, varying) else None
        if range_ is not None and not range_.contains(Fraction(result[name])):
            raise InputError(f"{option} {name}={text}: outside {range_}; give a value inside, or declare a wider range")
    for name in names:
        if complete and name not in result:
            raise InputError(f"{option}: {name} is missing; give {' '.join(f'{each}=..' for each in names)}")
    return result


def varying_in(system: ReversibleSystem, option: str, words: Sequence[str]) -> str:
    """The fixed parameter to which a place like ``mu=0.0035 x=..`` gives a value. Raises `InputError`."""
    given = [name for name in values_by_name(option, words) if name in system.fixed_parameters]
    if len(given) != 1:
        known = ", ".join(system.fixed_parameters) or "none"
        raise InputError(f"{option}: one parameter varies; give a value near which, for one of {known}")
    return given[0]


def finite_number(option: str, text: str) -> float:
    """A number given with an option, as a double. Raises `InputError`."""
    value = exact_number(option, text)
    # The largest doubles are below 2^1024.
    if not abs(value) < 2**1023:
        raise InputError(f"{option} {text}: too large; give a smaller number")
    return float(value)


def values_by_name(option: str, words: Sequence[str]) -> dict[str, str]:
    """Texts by name from words like ``y=0.2``. Raises `InputError`."""
    result: dict[str, str] = {}
    for word in words:
        name, sign, text = word.partition("=")
        if not sign or not name or not text:
            raise InputError(f"{option} {word}: no assignment; write NAME=VALUE")
        if name in result:
            raise InputError(f"{option} {word}: {name} is given twice; give one value")
        result[name] = text
    return result
