"""Family files: traced families as JSON, version 1, for pictures and for going on with a run.

``{"format": "orbitproof-family", "version": 1, "families": [...]}``; the fields stand in
``shared/schemas/family.schema.json``. The file carries no proof and holds ordinary floats; the
parameters are exact strings as in a candidates file. Reading it needs neither JAX nor diffrax.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbitproof.shared.formats import InputError, read_document, validate_document, write_text
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.shared.systems import SYSTEMS, ReversibleSystem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OrbitRecord:
    """One orbit of a family file; lengths as in the schema, nondimensional units.

    Attributes:
        arclength: along the family, in units of the family's `scale`.
        point, second_point: shape (1 + n,), both points on Fix(R), in the order of
            `ReversibleSystem.centre_coordinates`.
        half_period: the time between them.
        first_integral: `None` for a system with a family parameter.
        stability: n stability parameters (lambda + 1/lambda)/2.
        coefficients: shape (n + 1,), characteristic polynomial of the stability matrix.
        tangent: shape (2 + n,), unit tangent of the family in units of `scale`.
        crossings: of the section in the half orbit, its end included.
    """

    arclength: float
    point: Array
    second_point: Array
    half_period: float
    first_integral: float | None
    stability: tuple[complex, ...]
    coefficients: Array
    tangent: Array
    crossings: int


@dataclass(frozen=True)
class ResonanceRecord:
    """A resonance in a family file, located in float64."""

    k: int
    kind: str
    side: str
    point: Array
    arclength: float
    first_integral: float | None
    stability_parameter: float


@dataclass(frozen=True)
class CurveRecord:
    """A family sampled finely enough for its list of resonances, N orbits; see `explore.families.stability_curve`.

    Attributes:
        arclength, half_periods: shape (N,), as in `OrbitRecord`; arclength increases.
        points, second_points: shape (N, 1 + n).
        first_integrals: shape (N,), or `None`.
        coefficients: shape (N, n + 1).
    """

    arclength: Array
    points: Array
    second_points: Array
    half_periods: Array
    first_integrals: Array | None
    coefficients: Array


@dataclass(frozen=True)
class ExtremumRecord:
    """A local extremum of a stability parameter, and the resonance 1:k whose value (level) is nearest."""

    arclength: float
    first_integral: float | None
    stability_parameter: float
    k: int
    level: float


@dataclass(frozen=True)
class EndingRecord:
    """Why a family goes no further, and the same in words."""

    outcome: str
    reason: str


@dataclass(frozen=True)
class FamilyRecord:
    """A traced family as it stands in a file; see the schema for the meaning of the fields."""

    name: str
    label: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    symmetry: str | None
    scale: tuple[float, ...]
    outcome: str
    reason: str
    orbits: tuple[OrbitRecord, ...]
    resonances: tuple[ResonanceRecord, ...]
    curve: CurveRecord | None = None
    extrema: tuple[ExtremumRecord, ...] = ()
    beginning: EndingRecord | None = None


def write_families(path: Path, families: Sequence[FamilyRecord]) -> None:
    """Write a family file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {"format": "orbitproof-family", "version": 1, "families": [_to_json(family) for family in families]}
    validate_document(document, "family", "family file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def _to_json(family: FamilyRecord) -> dict[str, Any]:
    result = {
        "name": family.name,
        "label": family.label,
        "system": family.system.name,
        "parameters": {name: format_exact(value) for name, value in family.parameters.items()},
        "symmetry": family.symmetry,
        "scale": list(family.scale),
        "outcome": family.outcome,
        "reason": family.reason,
        "orbits": [
            {
                "arclength": orbit.arclength,
                "point": orbit.point.tolist(),
                "second_point": orbit.second_point.tolist(),
                "half_period": orbit.half_period,
                "period": 2 * orbit.half_period,
                "first_integral": orbit.first_integral,
                "stability": [[value.real, value.imag] for value in orbit.stability],
                "coefficients": orbit.coefficients.tolist(),
                "tangent": orbit.tangent.tolist(),
                "crossings": orbit.crossings,
            }
            for orbit in family.orbits
        ],
        "resonances": [
            {
                "k": resonance.k,
                "kind": resonance.kind,
                "side": resonance.side,
                "point": resonance.point.tolist(),
                "arclength": resonance.arclength,
                "first_integral": resonance.first_integral,
                "stability_parameter": resonance.stability_parameter,
            }
            for resonance in family.resonances
        ],
    }
    if family.beginning is not None:
        result["beginning"] = asdict(family.beginning)
    if family.curve is not None:
        curve = {field.name: getattr(family.curve, field.name) for field in fields(CurveRecord)}
        result["curve"] = {name: None if value is None else value.tolist() for name, value in curve.items()}
        result["extrema"] = [asdict(extremum) for extremum in family.extrema]
    return result


def read_families(path: Path) -> list[FamilyRecord]:
    """Read a family file. Raises `InputError`, one line, for anything that is not well formed."""
    document = read_document(path, "family")
    return [_family(entry, f"{path}: field families[{index}]") for index, entry in enumerate(document["families"])]


def _family(entry: Mapping[str, Any], source: str) -> FamilyRecord:
    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    system = SYSTEMS.get(entry["system"])
    if system is None:
        refuse("system", f"unknown system {entry['system']!r}", f"known: {', '.join(SYSTEMS)}")
    parameters = {name: parse_exact(text) for name, text in entry["parameters"].items()}
    if set(parameters) != set(system.fixed_parameters):
        wanted = ", ".join(system.fixed_parameters) or "none"
        refuse("parameters", f"{system.name} takes the parameters: {wanted}", "give exactly these")
    for name, value in parameters.items():
        if not system.parameters[name].contains(value):
            refuse(f"parameters.{name}", f"lies outside {system.parameters[name]}", "choose a value inside")
    if entry["symmetry"] is not None and entry["symmetry"] not in system.symmetries:
        refuse("symmetry", f"{system.name} has no symmetry {entry['symmetry']!r}", "write the file again")
    size, kernel = len(system.centre_coordinates), len(system.kernel_coordinates)
    lengths = {
        "point": size,
        "second_point": size,
        "tangent": size + 1,
        "coefficients": kernel + 1,
        "stability": kernel,
    }

    def finite(where: str, *numbers: float) -> None:
        if not all(isfinite(number) for number in numbers):
            refuse(where, "a number is too large for a double", "write the file again")

    if len(entry["scale"]) != size + 1 or not all(isfinite(scale) and scale > 0 for scale in entry["scale"]):
        refuse("scale", "wrong length or not positive", f"it needs {size + 1} positive numbers")
    orbits: list[OrbitRecord] = []
    for index, orbit in enumerate(entry["orbits"]):
        where = f"orbits[{index}]"
        for name, length in lengths.items():
            if len(orbit[name]) != length:
                refuse(f"{where}.{name}", f"{len(orbit[name])} numbers", f"{system.name} needs {length}")
        values = [*orbit["point"], *orbit["second_point"], *orbit["tangent"], *orbit["coefficients"]]
        finite(where, *values, orbit["arclength"], orbit["half_period"], orbit["first_integral"] or 0.0)
        finite(where, *(part for pair in orbit["stability"] for part in pair))
        if (orbit["first_integral"] is None) != (system.first_integral is None):
            refuse(f"{where}.first_integral", "does not fit the system", "write the file again")
        if orbits and orbit["arclength"] <= orbits[-1].arclength:
            refuse(f"{where}.arclength", "does not increase", "list the orbits along the family")
        orbits.append(
            OrbitRecord(
                arclength=float(orbit["arclength"]),
                point=np.array(orbit["point"], dtype=float),
                second_point=np.array(orbit["second_point"], dtype=float),
                half_period=float(orbit["half_period"]),
                first_integral=None if orbit["first_integral"] is None else float(orbit["first_integral"]),
                stability=tuple(complex(*pair) for pair in orbit["stability"]),
                coefficients=np.array(orbit["coefficients"], dtype=float),
                tangent=np.array(orbit["tangent"], dtype=float),
                crossings=orbit["crossings"],
            )
        )
    resonances: list[ResonanceRecord] = []
    for index, resonance in enumerate(entry["resonances"]):
        if len(resonance["point"]) != size:
            refuse(f"resonances[{index}].point", f"{len(resonance['point'])} numbers", f"{system.name} needs {size}")
        finite(f"resonances[{index}]", *resonance["point"], resonance["arclength"], resonance["first_integral"] or 0.0)
        fields = {**resonance, "point": np.array(resonance["point"], dtype=float)}
        resonances.append(ResonanceRecord(**fields))
    extrema = tuple(ExtremumRecord(**extremum) for extremum in entry.get("extrema", ()))
    for index, extremum in enumerate(extrema):
        finite(f"extrema[{index}]", extremum.arclength, extremum.first_integral or 0.0, extremum.stability_parameter)
    return FamilyRecord(
        name=entry["name"], label=entry.get("label", ""), system=system, parameters=parameters,
        symmetry=entry["symmetry"], scale=tuple(float(scale) for scale in entry["scale"]),
        outcome=entry["outcome"], reason=entry["reason"], orbits=tuple(orbits), resonances=tuple(resonances),
        curve=_curve(entry.get("curve"), system, refuse), extrema=extrema,
        beginning=EndingRecord(**entry["beginning"]) if "beginning" in entry else None,
    )  # fmt: skip


def _curve(
    entry: Mapping[str, Any] | None, system: ReversibleSystem, refuse: Callable[[str, str, str], NoReturn]
) -> CurveRecord | None:
    if entry is None:
        return None
    size, count = len(system.centre_coordinates), len(entry["arclength"])
    shapes = {
        "arclength": (count,), "points": (count, size), "second_points": (count, size), "half_periods": (count,),
        "coefficients": (count, len(system.kernel_coordinates) + 1),
    }  # fmt: skip
    if system.first_integral is not None:
        shapes["first_integrals"] = (count,)
    elif entry["first_integrals"] is not None:
        refuse("curve.first_integrals", "does not fit the system", "write the file again")
    arrays: dict[str, Array | None] = {"first_integrals": None}
    for name, shape in shapes.items():
        try:
            array = np.array(entry[name], dtype=float)
        except (TypeError, ValueError):
            refuse(f"curve.{name}", "rows of different lengths, or none", "write the file again")
        if array.shape != shape:
            refuse(f"curve.{name}", f"shape {array.shape}", f"{system.name} needs {shape}")
        if not np.all(np.isfinite(array)):
            refuse(f"curve.{name}", "a number is too large for a double", "write the file again")
        arrays[name] = array
    if not np.all(np.diff(arrays["arclength"]) > 0):
        refuse("curve.arclength", "does not increase", "list the orbits along the family")
    return CurveRecord(**arrays)
