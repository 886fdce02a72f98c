"""What a command line says about a system without symmetry: which one, all its numbers, a section."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from orbitproof.explore.names.exact_numbers import exact_number
from orbitproof.explore.names.own_systems import values_by_name
from orbitproof.shared.formats import InputError, load_system
from orbitproof.shared.systems import FORCE_AT_START, SYSTEMS, FormulaError, System, evaluate_formula

_LONGEST = 1000


def own_system(text: str) -> System:
    """Any system by its name or by its file, with or without symmetry. Raises `InputError`."""
    if text in SYSTEMS:
        return SYSTEMS[text]
    name = text.partition(":")[0]
    if Path(name).suffix not in (".py", ".json") and Path(text).suffix not in (".py", ".json"):
        known = ", ".join(SYSTEMS)
        raise InputError(f"--system {text}: unknown; give one of {known}, or your own system's file (.py or .json)")
    return load_system(text)


def given_values(option: str, words: Sequence[str], names: Sequence[str]) -> dict[str, Fraction]:
    """A number for each of the names, in their order, from words like ``x=0.2``. Raises `InputError`."""
    texts = values_by_name(option, words)
    for name in texts:
        if name not in names:
            known = ", ".join(names) or "none"
            raise InputError(f"{option} {name}: there is no such name; there are {known}")
    for name in names:
        if name not in texts:
            raise InputError(f"{option}: {name} is missing; give {' '.join(f'{each}=..' for each in names)}")
    values = {name: exact_number(f"{option} {name}", texts[name]) for name in names}
    for name, value in values.items():
        if not abs(value) < 2**_LONGEST:
            raise InputError(f"{option} {name}: too large; give a smaller number")
    return values


def start_values(option: str, words: Sequence[str], system: System) -> dict[str, Fraction]:
    """A number for each given coordinate of the state; a force that is not given begins with the phase 0.

    Raises `InputError`.
    """
    given, names = values_by_name(option, words), system.given_state
    force = [f"{name}={value}" for name, value in FORCE_AT_START.items() if name in names and name not in given]
    return given_values(option, [*words, *force], names)


def section_of(
    system: System, text: str | None, direction: str | None
) -> tuple[tuple[Fraction, ...], Fraction, int] | None:
    """Normal, offset and direction of a section such as ``z=27`` or ``x+2*y=1/2``; `None` for none.

    Raises `InputError`.
    """
    if text is None:
        if direction is not None:
            raise InputError("--direction: belongs to --section; give that too")
        return None
    left, sign, right = text.partition("=")
    if not sign or not left.strip() or not right.strip():
        raise InputError(f"--section {text}: no equation; write for example {system.given_state[-1]}=1/2")
    offset = exact_number("--section, right side", right.strip())

    normal, constant = _linear(system, f"--section {text}", left)
    if not any(normal):
        raise InputError(f"--section {text}: no coordinate is in it; there are {', '.join(system.given_state)}")
    return normal, offset - constant, -1 if direction == "-" else 1


def symmetry_of(system: System, text: str) -> tuple[tuple[Fraction, ...], ...]:
    """The rows of a linear map such as ``-x,-y,z``, the image of the state (x, y, z). Raises `InputError`."""
    option = f"--symmetry={text}"
    parts = text.split(",")
    if len(parts) != len(system.given_state):
        raise InputError(f"{option}: give the image of ({', '.join(system.given_state)}), one expression for each")
    rows = []
    for part in parts:
        row, constant = _linear(system, option, part)
        if constant:
            raise InputError(f"{option}: {part.strip()} has a constant; a symmetry is linear")
        rows.append(row)
    return tuple(rows)


def _linear(system: System, option: str, expression: str) -> tuple[tuple[Fraction, ...], Fraction]:
    """The coefficients of a linear expression in the state, and its constant. Raises `InputError`."""
    names, size = ", ".join(system.given_state), len(system.given_state)

    def value(point: Sequence[Fraction]) -> Fraction:
        try:
            return Fraction(evaluate_formula(expression, dict(zip(system.given_state, point, strict=True))))
        except (FormulaError, TypeError, ZeroDivisionError) as error:
            raise InputError(f"{option}: {error}; write a linear expression in {names}") from None

    units = [tuple(Fraction(int(i == j)) for i in range(size)) for j in range(size)]
    constant = value((Fraction(0),) * size)
    slopes = tuple(value(unit) - constant for unit in units)
    for point in (
        tuple(Fraction(3 * i + 2, i + 3) for i in range(size)),
        tuple(Fraction(-i - 1, 7) for i in range(size)),
    ):
        if value(point) != constant + sum((a * x for a, x in zip(slopes, point, strict=True)), Fraction(0)):
            raise InputError(f"{option}: {expression} is not linear; write one such as {system.given_state[0]}+2*..")
    return slopes, constant
