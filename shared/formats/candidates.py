"""Claims about boxes: bifurcations of symmetric periodic orbits, and single orbits; read and written as JSON."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

from orbitproof.shared.formats.documents import ID_IN_WORDS, InputError, read_document, short, validator, write_document
from orbitproof.shared.numbers import format_exact, format_rational, parse_exact
from orbitproof.shared.systems import ID, SYSTEMS, DescriptionError, ReversibleSystem, describe, described, fits

FOLD = "fold"
ONCE = ("symmetry_breaking", FOLD)
"""Kinds of bifurcations of period-two points, k = 1; all others have k > 1."""
KINDS = (*ONCE, "period_tupling", "touch_and_go")

ORBIT = "orbit"
"""What a claim about one orbit says in place of the kind of a bifurcation; k = 1."""
HALF_PERIOD, LEVEL, COORDINATE = "half period", "level", "coordinate"
QUANTITIES = (HALF_PERIOD, LEVEL, COORDINATE)
"""What one orbit of a family can be given by."""


@dataclass(frozen=True)
class Equation:
    """What singles out one orbit of a family: quantity = value.

    Attributes:
        quantity: one of `QUANTITIES`; the level is that of the first integral, the coordinate one of the centre's.
        value: the value, exactly; of the half period in nondimensional units.
        coordinate: name of the coordinate, if the quantity is one.
    """

    quantity: str
    value: Fraction
    coordinate: str | None = None

    def to_json(self) -> dict[str, str]:
        """The JSON object."""
        named = {} if self.coordinate is None else {"coordinate": self.coordinate}
        return {"quantity": self.quantity, **named, "value": format_rational(self.value)}


@dataclass(frozen=True)
class Candidate:
    """A claim: the box ``centre + frame * (P_0 x P_1 x P_2)`` contains a bifurcation, or one orbit.

    Attributes:
        id: unique name within a file.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters, by name.
        kind: one of `KINDS`, or `ORBIT`.
        k: multiplicity; 1 exactly for symmetry breaking, folds and orbits.
        symmetry: name of the symmetry that breaks, for symmetry breaking.
        centre: shape (1 + n,), in the order of `coordinates`.
        frame: shape (1 + n, 1 + n), rows; column j is the direction of p_j.
        kernel_frame: shape (n, n), rows; q_i is row i times the kernel coordinates.
        radii: shape (1 + n,), half-widths of P_0, P_1, P_2, all positive.
        provenance: free-form, ignored by the verifier.
        level_sign: `None`, or, if the first integral is the first coordinate, the sign of the system's
            level coordinate, which follows from it on Fix(R).
        crossings: m, how often a half orbit, from Fix(R) to Fix(R), meets the section after its start; P^m then
            stands for P.
        equation: what singles out the orbit, if the claim is about one.
    """

    id: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    kernel_frame: tuple[tuple[Fraction, ...], ...]
    radii: tuple[Fraction, ...]
    symmetry: str | None = None
    provenance: Mapping[str, Any] = field(default_factory=dict)
    level_sign: int | None = None
    crossings: int = 1
    equation: Equation | None = None

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""

        def refuse(name: str, why: str, remedy: str) -> NoReturn:
            raise InputError(f"{name}: {why}; {remedy}")

        if not fits(ID, self.id):
            refuse("id", f"{self.id!r} is no id", ID_IN_WORDS)
        if self.kind not in (*KINDS, ORBIT):
            refuse("kind", f"{self.kind!r} is unknown", f"give one of {', '.join((*KINDS, ORBIT))}")
        if not isinstance(self.k, int) or self.k < 1:
            refuse("k", f"{self.k!r} is no multiplicity", "give an integer, at least 1")
        if not isinstance(self.crossings, int) or self.crossings < 1:
            refuse("crossings", f"{self.crossings!r} is no number of crossings", "give an integer, at least 1")
        if self.symmetry is not None and self.symmetry not in self.system.symmetries:
            known = ", ".join(self.system.symmetries) or "none"
            refuse("symmetry", f"{self.system.name} has no symmetry {self.symmetry!r}", f"known: {known}")
        if (self.kind == ORBIT) != (self.equation is not None):
            refuse("equation", "a claim about an orbit has one, others have none", "give both or none")
        if self.kind == ORBIT and self.system.fixed_level is not None:
            refuse("kind", "orbits on a fixed level are not claimed", "leave fixed_level out of the system")
        if self.equation is not None:
            _check_equation(self, self.equation, refuse)
        names, kernel = self.coordinates, len(self.system.kernel_coordinates)
        size, wanted = len(names), ", ".join(names)
        for name, values in (("centre", self.centre), ("radii", self.radii)):
            if len(values) != size:
                refuse(name, f"{len(values)} numbers", f"{self.system.name} needs {size}: {wanted}")
        for name, matrix, n in (("frame", self.frame, size), ("kernel_frame", self.kernel_frame, kernel)):
            if len(matrix) != n or any(len(row) != n for row in matrix):
                refuse(name, "wrong shape", f"give {n} rows of {n} numbers")
        numbers: dict[str, Sequence[Sequence[Fraction]]] = {
            **{f"parameters.{name}": [[value]] for name, value in self.parameters.items()},
            "centre": [self.centre],
            "frame": self.frame,
            "kernel_frame": self.kernel_frame,
            "radii": [self.radii],
        }
        if self.equation is not None:
            numbers[_EQUATION_VALUE] = [[self.equation.value]]
        for name, rows in numbers.items():
            for value in (value for row in rows for value in row):
                if not isinstance(value, (int, Fraction)):
                    refuse(name, f"{value!r} is no exact number", "give Fractions, shared.parse_exact reads them")
                try:
                    short_enough = _can_be_written(Fraction(value), _is_rational(name))
                except ValueError:
                    refuse(name, f"{short(str(value))} is neither dyadic nor decimal", "round it to a decimal number")
                if not short_enough:
                    why = "a number is too long to be written exactly"
                    refuse(name, why, "give fewer digits or an exponent closer to 0")
        for position, radius in enumerate(self.radii):
            if radius <= 0:
                refuse(f"radii[{position}]", "not positive", "give positive half-widths")

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre, 1 + n of them."""
        return self.system.centre_coordinates if self.level_sign is None else self.system.level_coordinates

    @property
    def is_family_of_maps(self) -> bool:
        """Whether the first coordinate is the bifurcation parameter: a family parameter or the level of H."""
        return self.system.family_parameter is not None or self.level_sign is not None

    def to_json(self, provenance: bool = True) -> dict[str, Any]:
        """The JSON object of the candidate. All numbers must be dyadic or decimal fractions."""
        result: dict[str, Any] = {
            "id": self.id,
            "system": describe(self.system),
            "parameters": {name: format_rational(value) for name, value in self.parameters.items()},
            "kind": self.kind,
            "k": self.k,
            "symmetry": self.symmetry,
            "centre": [format_exact(value) for value in self.centre],
            "frame": [[format_exact(value) for value in row] for row in self.frame],
            "kernel_frame": [[format_exact(value) for value in row] for row in self.kernel_frame],
            "radii": [format_exact(value) for value in self.radii],
        }
        if self.equation is not None:
            result["equation"] = self.equation.to_json()
        if self.level_sign is not None:
            result |= {"parameter": "first integral", "level_sign": self.level_sign}
        if self.crossings != 1:
            result["crossings"] = self.crossings
        if provenance:
            result["provenance"] = dict(self.provenance)
        return result


_EQUATION_VALUE = "equation.value"


def _is_rational(name: str) -> bool:
    """Whether a number of a claim may be any fraction."""
    return name.startswith("parameters") or name == _EQUATION_VALUE


def _check_equation(candidate: Candidate, equation: Equation, refuse: Callable[[str, str, str], NoReturn]) -> None:
    system = candidate.system
    if equation.quantity not in QUANTITIES:
        refuse("equation.quantity", f"{equation.quantity!r} is unknown", f"give one of {', '.join(QUANTITIES)}")
    if (equation.quantity == COORDINATE) != (equation.coordinate is not None):
        refuse("equation.coordinate", "belongs to the quantity 'coordinate'", "give both or none")
    if equation.coordinate is not None and equation.coordinate not in system.centre_coordinates:
        known = ", ".join(system.centre_coordinates)
        refuse("equation.coordinate", f"{equation.coordinate!r} is no coordinate of Fix(R)", f"give one of {known}")
    if equation.quantity == LEVEL and system.first_integral is None:
        refuse("equation.quantity", f"{system.name} has no first integral", "give another quantity")
    if equation.quantity == HALF_PERIOD and not equation.value > 0:
        refuse(_EQUATION_VALUE, "a half period is positive", "give a positive number")
    if candidate.symmetry is not None or candidate.level_sign is not None:
        refuse("equation", "the orbit is given in the coordinates of Fix(R)", "leave symmetry and parameter out")
    if system.normalised:
        refuse("equation", f"{system.name} is a form of other orbits", "claim it in the original coordinates")


def read_candidates(path: Path) -> list[Candidate]:
    """Read a candidates file. Raises `InputError` for anything that is not a well-formed claim."""
    document = read_document(path, "candidates")
    candidates: list[Candidate] = []
    seen: set[str] = set()
    for index, entry in enumerate(document["candidates"]):
        source = f"{path}: field candidates[{index}]"
        candidate = candidate_from_json(entry, source)
        if candidate.id in seen:
            raise InputError(f"{source}.id: {candidate.id!r} appears twice; give each candidate its own id")
        seen.add(candidate.id)
        candidates.append(candidate)
    return candidates


def read_system(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = SYSTEMS
) -> tuple[ReversibleSystem, dict[str, Fraction]]:
    """The system of a JSON object, one of `systems` by name or one that it describes, and its fixed parameters.

    Raises `InputError` that names the field.
    """
    system = find_system(entry["system"], f"{source}.system", systems)
    parameters = {name: parse_exact(text) for name, text in entry["parameters"].items()}
    if set(parameters) != set(system.fixed_parameters):
        wanted = ", ".join(system.fixed_parameters) or "none"
        raise InputError(f"{source}.parameters: {system.name} takes the parameters: {wanted}; give exactly these")
    for name, value in parameters.items():
        interval = system.parameters[name]
        if not interval.contains(value):
            text = short(entry["parameters"][name])
            raise InputError(f"{source}.parameters.{name}: {text} lies outside {interval}; choose a value inside")
    return system, parameters


def find_system(
    entry: str | Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem]
) -> ReversibleSystem:
    """One of `systems` by its name, or the system that a JSON object describes. Raises `InputError`."""
    if isinstance(entry, str):
        if entry not in systems:
            raise InputError(f"{source}: unknown system {entry!r}; known: {', '.join(systems)}")
        return systems[entry]
    try:
        return described(entry)
    except DescriptionError as error:
        raise InputError(f"{source}.{error}") from None


def candidate_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = SYSTEMS
) -> Candidate:
    """A `Candidate` about one of `systems`, from a schema-valid JSON object; `InputError` names the field."""

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    system, parameters = read_system(entry, source, systems)
    kind, k = entry["kind"], entry["k"]
    symmetry = entry.get("symmetry")
    if (kind in (*ONCE, ORBIT)) != (k == 1):
        refuse("k", f"{kind} with k = {k}", f"{', '.join((*ONCE, ORBIT))} have k = 1, the other kinds have k > 1")
    equation = entry.get("equation")
    level_sign = entry.get("level_sign")
    if (entry.get("parameter") is None) != (level_sign is None):
        refuse("parameter", "parameter and level_sign belong together", "give both or none")
    if level_sign is not None and (system.level_coordinate is None or system.family_parameter is not None):
        refuse("parameter", f"{system.name} has no coordinate that follows from its first integral", "leave it out")
    try:
        return Candidate(
            id=entry["id"], system=system, parameters=parameters, kind=kind, k=k, symmetry=symmetry,
            centre=_vector(entry["centre"]), frame=_matrix(entry["frame"]), radii=_vector(entry["radii"]),
            kernel_frame=_matrix(entry["kernel_frame"]), provenance=entry.get("provenance", {}), level_sign=level_sign,
            crossings=entry.get("crossings", 1),
            equation=None if equation is None else _equation(equation),
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"{source}.{error}") from None


def _equation(entry: Mapping[str, str]) -> Equation:
    return Equation(entry["quantity"], parse_exact(entry["value"]), entry.get("coordinate"))


def _can_be_written(value: Fraction, is_parameter: bool) -> bool:
    """Whether the text of a number, as `Candidate.to_json` writes it, fits the schema again."""
    schema: Any = validator("candidates").schema
    kind, text = ("rational", format_rational(value)) if is_parameter else ("number", format_exact(value))
    return re.fullmatch(schema["$defs"][kind]["pattern"], text) is not None


def _vector(texts: Sequence[str]) -> tuple[Fraction, ...]:
    return tuple(parse_exact(text) for text in texts)


def _matrix(rows: Sequence[Sequence[str]]) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(_vector(row) for row in rows)


def write_candidates(path: Path, candidates: Sequence[Candidate]) -> None:
    """Write a candidates file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {
        "format": "orbitproof-candidates",
        "version": 1,
        "candidates": [candidate.to_json() for candidate in candidates],
    }
    write_document(path, document, "candidates")
