"""Family files: traced families as JSON, version 1, for pictures and for going on with a run.

``{"format": "orbitproof-family", "version": 1, "families": [...]}``; the fields stand in
``shared/schemas/family.schema.json``. The file carries no proof and holds ordinary floats; the
parameters are exact strings as in a candidates file. Reading it needs neither JAX nor diffrax.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.names import examined
from orbitproof.explore.records.entries import Array, ObjectReader, to_json
from orbitproof.shared.formats import read_document, read_system, validate_document, write_text
from orbitproof.shared.systems import ReversibleSystem

BAND = 1.1
"""Magnitude of a stability parameter up to which its changes and extrema are followed."""


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
class SamplesRecord:
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
    curve: SamplesRecord | None = None
    extrema: tuple[ExtremumRecord, ...] = ()
    beginning: EndingRecord | None = None
    branch: str | None = None


def write_families(path: Path, families: Sequence[FamilyRecord]) -> None:
    """Write a family file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {"format": "orbitproof-family", "version": 1, "families": [_to_json(family) for family in families]}
    validate_document(document, "family", "family file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def _to_json(family: FamilyRecord) -> dict[str, Any]:
    result: dict[str, Any] = to_json(family)
    for orbit in result["orbits"]:
        orbit["period"] = 2 * orbit["half_period"]
    absent = [name for name in ("beginning", "branch", "curve") if result[name] is None]
    for name in (*absent, *(["extrema"] if "curve" in absent else ())):
        del result[name]
    return result


def read_families(path: Path) -> list[FamilyRecord]:
    """Read a family file. Raises `InputError`, one line, for anything that is not well formed."""
    document = read_document(path, "family")
    return [_family(entry, f"{path}: field families[{index}]") for index, entry in enumerate(document["families"])]


def _family(value: Mapping[str, Any], source: str) -> FamilyRecord:
    system, parameters = read_system(value, source)
    examined(system, source)
    entry = ObjectReader(source, system)
    if value["symmetry"] is not None and value["symmetry"] not in system.symmetries:
        entry.refuse("symmetry", f"{system.name} has no symmetry {value['symmetry']!r}")
    size = len(system.centre_coordinates)
    scale = entry.array("scale", value["scale"], size + 1)
    if not np.all(scale > 0):
        entry.refuse("scale", "not positive", f"it needs {size + 1} positive numbers")
    orbits = tuple(_orbit(entry, f"orbits[{index}]", orbit) for index, orbit in enumerate(value["orbits"]))
    entry.increasing("orbits[{}].arclength", np.array([orbit.arclength for orbit in orbits]))
    resonances: list[ResonanceRecord] = []
    for index, resonance in enumerate(value["resonances"]):
        where = f"resonances[{index}]"
        entry.finite(where, resonance["arclength"], resonance["first_integral"])
        point = entry.array(f"{where}.point", resonance["point"], size)
        resonances.append(ResonanceRecord(**{**resonance, "point": point}))
    extrema = tuple(ExtremumRecord(**extremum) for extremum in value.get("extrema", ()))
    for index, extremum in enumerate(extrema):
        entry.finite(f"extrema[{index}]", extremum.arclength, extremum.first_integral, extremum.stability_parameter)
    return FamilyRecord(
        name=value["name"],
        label=value.get("label", ""),
        system=system,
        parameters=parameters,
        symmetry=value["symmetry"],
        scale=tuple(scale.tolist()),
        outcome=value["outcome"],
        reason=value["reason"],
        orbits=orbits,
        resonances=tuple(resonances),
        curve=_curve(entry, value.get("curve")),
        extrema=extrema,
        beginning=EndingRecord(**value["beginning"]) if "beginning" in value else None,
        branch=value.get("branch"),
    )


def _orbit(entry: ObjectReader, where: str, value: Mapping[str, Any]) -> OrbitRecord:
    system, integral = entry.system, value["first_integral"]
    size, kernel = len(system.centre_coordinates), len(system.kernel_coordinates)
    lengths = {"point": size, "second_point": size, "tangent": size + 1, "coefficients": kernel + 1}
    entry.finite(where, value["arclength"], value["half_period"], integral)
    if (integral is None) != (system.first_integral is None):
        entry.refuse(f"{where}.first_integral", "does not fit the system")
    return OrbitRecord(
        arclength=float(value["arclength"]),
        half_period=float(value["half_period"]),
        first_integral=None if integral is None else float(integral),
        stability=entry.stability(f"{where}.stability", value["stability"]),
        crossings=value["crossings"],
        **{name: entry.array(f"{where}.{name}", value[name], length) for name, length in lengths.items()},
    )


def _curve(entry: ObjectReader, value: Mapping[str, Any] | None) -> SamplesRecord | None:
    if value is None:
        return None
    system, count = entry.system, len(value["arclength"])
    shapes: dict[str, tuple[int, ...]] = {"arclength": (count,), "half_periods": (count,)}
    shapes |= dict.fromkeys(("points", "second_points"), (count, len(system.centre_coordinates)))
    shapes["coefficients"] = (count, len(system.kernel_coordinates) + 1)
    if system.first_integral is not None:
        shapes["first_integrals"] = (count,)
    elif value["first_integrals"] is not None:
        entry.refuse("curve.first_integrals", "does not fit the system")
    arrays = {name: entry.array(f"curve.{name}", value[name], *shape) for name, shape in shapes.items()}
    entry.increasing("curve.arclength[{}]", arrays["arclength"])
    return SamplesRecord(**{"first_integrals": None, **arrays})
