"""Bifurcating branches and branch files (JSON, version 1), for pictures and comparison.

``{"format": "orbitproof-branches", "version": 1, "branches": [...]}``; the fields stand in
``shared/schemas/branches.schema.json``. Like a family file it carries no proof and holds ordinary floats; the
parameters are exact strings. Reading it needs neither JAX nor diffrax.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any, Literal, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbitproof.shared.formats import InputError, read_document, validate_document, write_text
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.shared.systems import SYSTEMS, ReversibleSystem

Array = NDArray[np.float64]

BirthSide = Literal["above", "below", "both"]
Outcome = Literal["length", "orbits", "meets family", "failed", "interrupted"]


@dataclass(frozen=True)
class BranchOrbit:
    """An orbit on a branch, nondimensional units.

    Attributes:
        arclength: of the starting points from the bifurcation, in units of the branch's `scale`; negative on
            the side of negative p_1.
        point: shape (1 + n,), the start on Fix(R), in the order of `ReversibleSystem.centre_coordinates`.
        second_point: shape (1 + n,), where the orbit is on Fix(R) half a period later.
        crossings: shape (k - 1, m), states where the half orbit crosses the section between the two.
        times: shape (k,), times from each of these states to the next.
        half_period: the time between the two points, their sum.
        level: first integral or family parameter.
        level_difference: level minus that of the bifurcation, without the loss of digits of the difference.
        stability: the n stability parameters (lambda + 1/lambda)/2.
    """

    arclength: float
    point: Array
    second_point: Array
    crossings: Array
    times: Array
    half_period: float
    level: float
    level_difference: float
    stability: tuple[complex, ...]


@dataclass(frozen=True)
class Birth:
    """How a branch leaves the bifurcation, from orbits at the amplitudes a, -a, a/2 and -a/2.

    Attributes:
        side: of the level at the bifurcation on which the new orbits are; "both" for touch-and-go.
        slope, curvature: c_1 and c_2 in level = level at the bifurcation + c_1 a + c_2 a^2 + .. (c_1 = 0 but for
            touch-and-go).
        amplitude: a, arclength along the tangent of the branch in units of the branch's `scale`.
        noise: what rounding may change the level by, over its change.
    """

    side: BirthSide
    slope: float
    curvature: float
    amplitude: float
    noise: float


@dataclass(frozen=True)
class BranchSide:
    """The orbits on one side, away from the bifurcation; why there are no more, and that in words."""

    orbits: tuple[BranchOrbit, ...]
    outcome: Outcome
    reason: str


@dataclass(frozen=True)
class BranchRecord:
    """A branch, or why there is none, as it stands in a file.

    Attributes:
        id, system, parameters, kind, k, symmetry: the claim, as in `shared.formats.candidates.Candidate`.
        verdict: of its certificate, "proved" or "not proved"; `None` for a numerical point.
        certified_side: if proved, on which side the new orbits are.
        point, second_point: shape (1 + n,), where the resonant orbit is on Fix(R).
        half_period: the time between the two.
        level: first integral or family parameter there.
        scale: shape (1 + n,), units of arclength.
        birth: `None` if no new orbit was found.
        failure: why not, or "".
        sides: negative and positive p_1; empty if no new orbit was found.
    """

    id: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    symmetry: str | None
    verdict: str | None
    certified_side: str | None
    point: Array
    second_point: Array
    half_period: float
    level: float
    scale: Array
    birth: Birth | None
    failure: str
    sides: tuple[BranchSide, ...]

    @property
    def contradicts(self) -> bool:
        """Whether the side that was found differs from the certified one."""
        return self.birth is not None and self.certified_side is not None and self.birth.side != self.certified_side


def write_branches(path: Path, branches: Sequence[BranchRecord]) -> None:
    """Write a branch file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {"format": "orbitproof-branches", "version": 1, "branches": [_to_json(branch) for branch in branches]}
    validate_document(document, "branches", "branch file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def _to_json(branch: BranchRecord) -> dict[str, Any]:
    birth = branch.birth
    return {
        "id": branch.id,
        "system": branch.system.name,
        "parameters": {name: format_exact(value) for name, value in branch.parameters.items()},
        "kind": branch.kind,
        "k": branch.k,
        "symmetry": branch.symmetry,
        "verdict": branch.verdict,
        "certified_side": branch.certified_side,
        "point": branch.point.tolist(),
        "second_point": branch.second_point.tolist(),
        "half_period": branch.half_period,
        "level": branch.level,
        "scale": branch.scale.tolist(),
        "birth": None if birth is None else dict(vars(birth)),
        "failure": branch.failure,
        "sides": [
            {
                "outcome": side.outcome,
                "reason": side.reason,
                "orbits": [
                    {
                        "arclength": orbit.arclength,
                        "point": orbit.point.tolist(),
                        "second_point": orbit.second_point.tolist(),
                        "crossings": orbit.crossings.tolist(),
                        "times": orbit.times.tolist(),
                        "half_period": orbit.half_period,
                        "level": orbit.level,
                        "level_difference": orbit.level_difference,
                        "stability": [[value.real, value.imag] for value in orbit.stability],
                    }
                    for orbit in side.orbits
                ],
            }
            for side in branch.sides
        ],
    }


def read_branches(path: Path) -> list[BranchRecord]:
    """Read a branch file. Raises `InputError`, one line, for anything that is not well formed."""
    document = read_document(path, "branches")
    return [_branch(entry, f"{path}: field branches[{index}]") for index, entry in enumerate(document["branches"])]


def _branch(entry: Mapping[str, Any], source: str) -> BranchRecord:
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

    def array(where: str, value: Any, *shape: int) -> Array:
        try:
            result = np.array(value, dtype=float)
        except ValueError:
            refuse(where, "rows of different lengths", "write the file again")
        # A list of no crossings has no second dimension.
        result = result.reshape(shape) if result.size == 0 and 0 in shape else result
        if result.shape != shape:
            refuse(where, f"shape {result.shape}", f"{system.name} needs {shape}")
        if not np.all(np.isfinite(result)):
            refuse(where, "a number is too large for a double", "write the file again")
        return result

    size, m, n, k = len(system.centre_coordinates), len(system.state), len(system.kernel_coordinates), entry["k"]

    def orbit(value: Mapping[str, Any], where: str) -> BranchOrbit:
        numbers = ("arclength", "half_period", "level", "level_difference")
        if not all(isfinite(value[name]) for name in numbers):
            refuse(where, "a number is too large for a double", "write the file again")
        pairs = array(f"{where}.stability", value["stability"], n, 2)
        return BranchOrbit(
            **{name: float(value[name]) for name in numbers},
            point=array(f"{where}.point", value["point"], size),
            second_point=array(f"{where}.second_point", value["second_point"], size),
            crossings=array(f"{where}.crossings", value["crossings"], k - 1, m),
            times=array(f"{where}.times", value["times"], k),
            stability=tuple(complex(*pair) for pair in pairs),
        )

    sides = tuple(
        BranchSide(
            tuple(orbit(value, f"sides[{i}].orbits[{j}]") for j, value in enumerate(side["orbits"])),
            side["outcome"], side["reason"],
        )
        for i, side in enumerate(entry["sides"])
    )  # fmt: skip
    if len(sides) != (0 if entry["birth"] is None else 2):
        refuse("sides", f"{len(sides)} of them", "a branch has two, and none without birth")
    scale = array("scale", entry["scale"], size)
    if not np.all(scale > 0):
        refuse("scale", "not positive", "write the file again")
    if not (isfinite(entry["half_period"]) and isfinite(entry["level"])):
        refuse("level", "a number is too large for a double", "write the file again")
    return BranchRecord(
        id=entry["id"], system=system, parameters=parameters, kind=entry["kind"], k=k, symmetry=entry["symmetry"],
        verdict=entry["verdict"], certified_side=entry["certified_side"], point=array("point", entry["point"], size),
        second_point=array("second_point", entry["second_point"], size), half_period=float(entry["half_period"]),
        level=float(entry["level"]), scale=scale,
        birth=None if entry["birth"] is None else Birth(**entry["birth"]), failure=entry["failure"], sides=sides,
    )  # fmt: skip
