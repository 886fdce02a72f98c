"""A system as a description: names, signs and formulas, which a JSON file can hold.

The vector field and the first integral are formulas (`formulas`), straight-line programs as text, as certificates
carry them, or Python functions, which only a Python file or a notebook can give. The same description is the same
`ReversibleSystem` object, in every process: a system that went through a pipe comes out as itself.
"""

from __future__ import annotations

import copyreg
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from orbitproof.shared.systems.described_functions import (
    Arithmetic,
    DescribedFunctions,
    DescriptionError,
    formula_value,
    mapping_of,
    name_of,
)
from orbitproof.shared.systems.described_levels import exact_number, level_entry, level_of
from orbitproof.shared.systems.formulas import FormulaError, has_time
from orbitproof.shared.systems.functions import FUNCTIONS, Call, FunctionsOf, argument_of, rates_of
from orbitproof.shared.systems.libration import BRANCH_SYSTEMS
from orbitproof.shared.systems.names import fits
from orbitproof.shared.systems.parity_of_functions import signs_with_functions
from orbitproof.shared.systems.program import record
from orbitproof.shared.systems.system import Defined, ParameterRange, ReversibleSystem, Reversor, System
from orbitproof.shared.systems.titles import SYSTEM, TITLE

_OPTIONAL = (
    "title", "parameters", "symmetries", "where", "family_parameter", "first_integral", "first_integral_name",
    "level_coordinate", "reversors", "reversor",
    "fixed_level", "squared_distance", "distance_name", "defined",
)  # fmt: skip
KEYS = ("name", "state", "field", "R", "section", *_OPTIONAL)
"""What a description has; those after the section may be missing."""
PLAIN_KEYS = ("name", "state", "field", "title", "parameters", "where", "first_integral", "first_integral_name",
              "defined")  # fmt: skip
"""What the description of a system without R and section has; those after the field may be missing."""

_LONGEST_TITLE = 120  # of what is not known to every installation

_INTERNED: dict[str, System] = {}


def describe(system: System) -> str | dict[str, Any]:
    """The description of a system as JSON; for one that every installation knows, its name.

    The vector field, the first integral and the squared distance are programs as text. Raises `DescriptionError` for
    what has no description, and where another system has the same one.
    """
    if BRANCH_SYSTEMS.get(system.name) is system:
        return system.name
    if not isinstance(system, ReversibleSystem):
        plain = _plain_entry(system)
        _INTERNED.setdefault(_text(plain), system)
        return plain
    original, reversor = system.original, system.reversor
    # A changed copy of such a system has the same original, and is described in full.
    if original is not None and original.reversors.get(str(reversor)) and original.under(str(reversor)) is system:
        named = describe(original)
        chosen: dict[str, Any] = {**(named if isinstance(named, dict) else {"name": named}), "reversor": reversor}
        _INTERNED.setdefault(_text(chosen), system)
        return chosen
    if system.derived_parameters or system.normalised:
        raise DescriptionError("derived_parameters: are not part of a description; give such parameters")
    if system.arrival is not None:
        raise DescriptionError("arrival: is no part of a description; half orbits of what is described end in Fix(R)")
    entry: dict[str, Any] = {
        **_plain_entry(system),
        "R": list(system.reversing_symmetry),
        "symmetries": {name: list(signs) for name, signs in system.symmetries.items()},
        "section": system.section,
    }
    level, distance = system.fixed_level, system.squared_distance_program
    optional = {
        "family_parameter": system.family_parameter,
        "level_coordinate": system.level_coordinate,
        "fixed_level": None if level is None else level_entry(level),
        "reversors": {name: _reversor_entry(each) for name, each in system.reversors.items()} or None,
        "squared_distance": None if distance is None else distance.text(),
        "distance_name": system.distance_name,
    }
    entry |= {key: value for key, value in optional.items() if value is not None}
    known = _INTERNED.setdefault(_text(entry), system)
    across = system.stiffness_across_program
    if across is not None and (not isinstance(known, ReversibleSystem) or known.stiffness_across_program != across):
        raise DescriptionError("stiffness_across: is no part of a description, and differs; give it another name")
    return entry


def _plain_entry(system: System) -> dict[str, Any]:
    integral = system.first_integral_program
    named = {} if integral is None else {"first_integral_name": system.first_integral_name or "first integral"}
    return {
        "name": system.name,
        "title": system.title,
        "state": list(system.state),
        "parameters": {
            name: [None if end is None else str(end) for end in (interval.lower, interval.upper)]
            for name, interval in system.parameters.items()
        },
        "field": system.program.text(),
        **({} if integral is None else {"first_integral": integral.text(), **named}),
        **({"defined": _defined_entry(system)} if system.defined else {}),
    }


def _defined_entry(system: System) -> list[list[str]]:
    programs = system.argument_programs
    return [[each.name, each.function, program.text()] for each, program in zip(system.defined, programs, strict=True)]


def described(entry: str | Mapping[str, Any]) -> ReversibleSystem:
    """The reversible system that `describe` describes, or that a file does. Raises `DescriptionError`."""
    if isinstance(entry, str):
        if entry not in BRANCH_SYSTEMS:
            raise DescriptionError(f"name: unknown system {entry!r}; known: {', '.join(BRANCH_SYSTEMS)}")
        return BRANCH_SYSTEMS[entry]
    try:
        system = _interned(_read(entry))
    except TypeError as error:
        raise DescriptionError(f"system: no description ({error}); give the keys {', '.join(KEYS)}") from None
    assert isinstance(system, ReversibleSystem)
    return system


def described_plainly(entry: Mapping[str, Any]) -> System:
    """The system of a description without R and section. Raises `DescriptionError`."""
    try:
        return _interned(_read_plain(entry))
    except TypeError as error:
        raise DescriptionError(f"system: no description ({error}); give the keys {', '.join(PLAIN_KEYS)}") from None


def _interned(system: System) -> System:
    if system.name in BRANCH_SYSTEMS:
        raise DescriptionError(f"name: {system.name!r} is the name of another system; choose your own")
    written = describe(system)
    assert isinstance(written, dict)
    return _INTERNED[_text(written)]


def _text(entry: Mapping[str, Any]) -> str:
    return json.dumps(entry, sort_keys=True)


def _reduced(system: ReversibleSystem) -> tuple[Callable[..., ReversibleSystem], tuple[Any]]:
    return described, (describe(system),)


def _reduced_plainly(system: System) -> tuple[Callable[..., System], tuple[Any]]:
    return described_plainly, (_plain_entry(system),)


copyreg.pickle(ReversibleSystem, _reduced)
copyreg.pickle(System, _reduced_plainly)


def _read_plain(entry: Mapping[str, Any]) -> System:
    for key in entry:
        if key not in PLAIN_KEYS:
            takes = "; it takes R and section as well" if key in KEYS else f"; there are {', '.join(KEYS)}"
            raise DescriptionError(f"{key}: {'not without symmetry' if key in KEYS else 'unknown'}{takes}")
    for key in PLAIN_KEYS[:3]:
        if key not in entry:
            raise DescriptionError(f"{key}: missing; give name, state and field at least")
    name, title, given, ranges = _names_of(entry)
    formulas = _formulas_of(entry, given, tuple(ranges), forced=True)
    integral = formulas.function("first_integral")
    return System(
        name,
        title,
        formulas.state,
        ranges,
        formulas.field,
        first_integral=integral,
        first_integral_name=None if integral is None else entry.get("first_integral_name") or "first integral",
        defined=formulas.defined,
    )


@dataclass(frozen=True)
class _Formulas:
    """The field of a description and what else it gives as formulas of the state.

    Attributes:
        state: the given coordinates, then those that are functions of others.
        texts: of single functions, by their keys; `None` for one that is not there.
    """

    state: tuple[str, ...]
    field: Arithmetic
    defined: tuple[Defined, ...]
    texts: Mapping[str, Any]
    functions: DescribedFunctions

    def function(self, key: str) -> Arithmetic | None:
        text = self.texts[key]
        return None if text is None else self.functions.function(key, text, None)


def _formulas_of(
    entry: Mapping[str, Any],
    state: tuple[str, ...],
    parameters: tuple[str, ...],
    taken: Sequence[str] = (),
    forced: bool = False,
) -> _Formulas:
    """What a description gives as formulas, with coordinates in place of sin, cos, exp and log; `taken` as names.

    Arguments:
        forced: whether sin and cos of the time may stand in them (`forcing`).
    """
    where, field = entry.get("where", {}), entry["field"]
    texts = {key: entry.get(key) for key in ("first_integral", "squared_distance")}
    defined: tuple[Defined, ...] = ()
    extended: Arithmetic | None = None
    if "defined" in entry:
        defined = _read_defined(entry["defined"], state, parameters)
    elif isinstance(field, Mapping) and isinstance(where, Mapping):
        try:
            every = (*field.values(), *where.values(), *texts.values())
            if forced and set(field) == set(state) and any(map(has_time, every)):
                from orbitproof.shared.systems.forcing import without_time

                free = without_time(state, parameters, field, where, texts)
                state, field, where, texts = free.state, free.field, free.where, {**free.texts}
            found = FunctionsOf((*state, *parameters, *where, *taken), where)
            where, field, texts = ({key: _without(found, each[key]) for key in each} for each in (where, field, texts))
        except FormulaError as error:
            raise DescriptionError(f"field: {error}") from None
        if found.calls:
            state, extended, defined = _extended(found.calls, state, parameters, where, field)
    if len(state) - len(defined) == 1:
        raise DescriptionError(f"state: {state[0]!r} alone has no periodic orbits; give two coordinates or more")
    functions = DescribedFunctions(state, parameters, where)
    return _Formulas(state, extended or functions.function("field", field, state), defined, texts, functions)


def _without(found: FunctionsOf, text: Any) -> Any:
    return found.without(text) if isinstance(text, str) and not text.lstrip().startswith("v0 =") else text


def _read_defined(value: Any, state: tuple[str, ...], parameters: tuple[str, ...]) -> tuple[Defined, ...]:
    """Coordinates that are functions of others, as `describe` writes them."""
    functions = DescribedFunctions(state, parameters, {})
    if not isinstance(value, list) or not all(isinstance(each, list) and len(each) == 3 for each in value):
        raise DescriptionError("defined: is no list of coordinates; give name, function and argument of each")
    names = tuple(each[0] for each in value)
    if names != state[len(state) - len(names) :] or any(each[1] not in FUNCTIONS for each in value):
        raise DescriptionError(f"defined: name the last state coordinates in order, each one of {', '.join(FUNCTIONS)}")
    return tuple(
        Defined(name, function, functions.function(f"defined.{name}", text, None)) for name, function, text in value
    )


def _extended(
    calls: Sequence[Call],
    state: tuple[str, ...],
    parameters: tuple[str, ...],
    where: Mapping[str, str],
    field: Mapping[str, str],
) -> tuple[tuple[str, ...], Arithmetic, tuple[Defined, ...]]:
    """State, field and functions of the system with further coordinates in place of functions."""
    if set(field) != set(state):
        raise DescriptionError(f"field: needs a formula, as text, for each of {', '.join(state)}")
    names = (*state, *(call.name for call in calls), *parameters)

    def rates(*inputs: Any) -> Sequence[Any]:
        values = dict(zip(names, inputs, strict=True))
        known = dict(values)
        for key, text in where.items():
            known[key] = formula_value(f"where.{key}", text, known)
        own = {key: formula_value(f"field.{key}", field[key], known) for key in state}
        try:
            return [*own.values(), *rates_of(calls, where, values, own)]
        except FormulaError as error:
            raise DescriptionError(f"field: {error}") from None

    def argument(call: Call) -> Callable[..., Any]:
        return lambda *inputs: argument_of(call, where, dict(zip(names, inputs, strict=True)))

    extended = (*state, *(call.name for call in calls))
    functions = DescribedFunctions(extended, parameters, where)
    # First, so that what is wrong with a formula is said of it and not of an argument that has it.
    arithmetic = functions.function("field", rates, extended)
    defined = tuple(
        Defined(call.name, call.function, functions.function(f"field.{call.name}", argument(call), None))
        for call in calls
    )
    return extended, arithmetic, defined


def _names_of(entry: Mapping[str, Any]) -> tuple[str, str, tuple[str, ...], dict[str, ParameterRange]]:
    """Name and title of a system, the names of its state coordinates and the ranges of its parameters."""
    name = entry["name"]
    if not fits(SYSTEM, name):
        raise DescriptionError(f"name: {name!r} is no name; use letters, digits, - and _, a letter first")
    _check_titles(entry)
    state = _names("state", entry["state"])
    ranges = _ranges(entry.get("parameters", ()))
    _distinct("parameters", (*state, *ranges))
    return name, entry.get("title") or name, state, ranges


def is_title(text: object) -> bool:
    """Whether a value is a title that a user may give."""
    return isinstance(text, str) and len(text) <= _LONGEST_TITLE and fits(TITLE, text)


def _check_titles(entry: Mapping[str, Any]) -> None:
    for key in ("title", "first_integral_name", "distance_name"):
        text = entry.get(key)
        if text is not None and not is_title(text):
            what = f"{_LONGEST_TITLE} letters, digits and signs such as . , ' ( ) + - * / ^ = at most, and no sentences"
            raise DescriptionError(f"{key}: {text!r} is no title; give {what}")


def _read(entry: Mapping[str, Any]) -> ReversibleSystem:
    for key in entry:
        if key not in KEYS:
            raise DescriptionError(f"{key}: unknown; there are {', '.join(KEYS)}")
    for key in KEYS:
        if key not in _OPTIONAL and key not in entry:
            raise DescriptionError(f"{key}: missing; give name, state, field, R and section at least")
    name, title, given, ranges = _names_of(entry)
    named = mapping_of("symmetries", entry.get("symmetries", {}))
    _distinct("symmetries", (*given, *ranges, *named))
    formulas = _formulas_of(entry, given, tuple(ranges), tuple(named))
    integral, distance = formulas.function("first_integral"), formulas.function("squared_distance")

    def signs(key: str, value: Any) -> tuple[int, ...]:
        found = _signs(key, value, given)
        # A description that names such coordinates has their signs with the others.
        return found if "defined" in entry else _signs_with_functions(key, formulas, tuple(ranges), found)

    def reversor(key: str, value: Any) -> Reversor:
        own: dict[str, Any] = {}
        if isinstance(value, Mapping) and not all(isinstance(each, int) for each in value.values()):
            own = {name: each for name, each in value.items() if name != "R"}
            if "R" not in value or not own.keys() <= {"section", "level_coordinate"}:
                what = "give the signs alone, or R and its own section or level_coordinate"
                raise DescriptionError(f"{key}: has {', '.join(value)}; {what}")
            for name, each in own.items():
                if each not in given:
                    there = ", ".join(given)
                    raise DescriptionError(f"{key}.{name}: {each!r} is no state coordinate; there are {there}")
            value = value["R"]
        return Reversor(signs(key, value), key.partition(".")[2], **own)

    try:
        system = ReversibleSystem(
            name=name,
            title=title,
            state=formulas.state,
            parameters=ranges,
            vector_field=formulas.field,
            defined=formulas.defined,
            reversing_symmetry=signs("R", entry["R"]),
            symmetries={name_of("symmetries", key): signs(f"symmetries.{key}", each) for key, each in named.items()},
            section=entry["section"],
            family_parameter=entry.get("family_parameter"),
            first_integral=integral,
            first_integral_name=None if integral is None else entry.get("first_integral_name") or "first integral",
            level_coordinate=entry.get("level_coordinate"),
            fixed_level=level_of(entry.get("fixed_level")),
            squared_distance=distance,
            distance_name=None if distance is None else entry.get("distance_name") or "the body",
            reversors={
                name_of("reversors", key): reversor(f"reversors.{key}", each)
                for key, each in mapping_of("reversors", entry.get("reversors", {})).items()
            },
        )
        chosen = entry.get("reversor")
        return system if chosen is None else system.under(name_of("reversor", chosen))
    except DescriptionError:
        raise
    except (TypeError, ValueError) as error:
        raise DescriptionError(str(error).removeprefix(f"{name}: ")) from None


def _signs_with_functions(
    key: str, formulas: _Formulas, parameters: tuple[str, ...], given: tuple[int, ...]
) -> tuple[int, ...]:
    """Signs of all coordinates: those that are functions of others change with these."""
    programs = [record(each.argument, formulas.state, parameters) for each in formulas.defined]
    found = signs_with_functions([each.function for each in formulas.defined], programs, given)
    for each, sign in zip(formulas.defined, found[len(given) :], strict=True):
        if not sign:
            remedy = (
                "write sin(a + b) as sin(a)*cos(b) + cos(a)*sin(b), cos(a + b) likewise"
                if each.function in ("sin", "cos")
                else "its argument has to be one that these signs leave alone"
            )
            raise DescriptionError(f"{key}: {each.name} in the formulas neither stays nor changes its sign; {remedy}")
    return found


def _distinct(key: str, names: Sequence[str]) -> None:
    if twice := [name for name in names if list(names).count(name) > 1]:
        raise DescriptionError(f"{key}: {twice[0]!r} appears twice; give each its own name")


def _names(key: str, value: Any) -> tuple[str, ...]:
    if isinstance(value, str):
        value = value.replace(",", " ").split()
    if not isinstance(value, (list, tuple)) or not 1 <= len(value) <= 40:
        raise DescriptionError(f"{key}: {value!r} is no list of names; give the names of the state coordinates")
    names = tuple(name_of(key, item) for item in value)
    _distinct(key, names)
    return names


def _ranges(value: Any) -> dict[str, ParameterRange]:
    if isinstance(value, str):
        value = value.replace(",", " ").split()
    if not isinstance(value, Mapping):
        value = dict.fromkeys(value, (None, None))
    result: dict[str, ParameterRange] = {}
    for name, ends in value.items():
        if not isinstance(ends, (list, tuple)) or len(ends) != 2:
            raise DescriptionError(f"parameters.{name}: {ends!r} is no range; give [smallest, largest], null for none")
        lower, upper = (None if end is None else exact_number(f"parameters.{name}", end) for end in ends)
        if lower is not None and upper is not None and not lower < upper:
            raise DescriptionError(f"parameters.{name}: an empty range; give the smaller value first")
        result[name_of("parameters", name)] = ParameterRange(lower, upper)
    return result


def _reversor_entry(reversor: Reversor) -> Any:
    own = {"section": reversor.section, "level_coordinate": reversor.level_coordinate}
    named = {key: value for key, value in own.items() if value is not None}
    return {"R": list(reversor.signs), **named} if named else list(reversor.signs)


def _signs(key: str, value: Any, state: Sequence[str]) -> tuple[int, ...]:
    """One sign for each state coordinate, from a list or by name (those not named: 1)."""
    if isinstance(value, Mapping):
        for name in value:
            if name not in state:
                raise DescriptionError(f"{key}.{name}: no state coordinate; there are {', '.join(state)}")
        value = [value.get(name, 1) for name in state]
    if not isinstance(value, (list, tuple)) or len(value) != len(state) or any(sign not in (1, -1) for sign in value):
        raise DescriptionError(f"{key}: {value!r} is no list of signs; give 1 or -1 for each of {', '.join(state)}")
    return tuple(int(sign) for sign in value)
