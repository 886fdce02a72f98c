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
from pathlib import Path
from typing import Any, Literal

import numpy as np

from orbitproof.explore.names import examined
from orbitproof.explore.records import Array, ObjectReader, to_json
from orbitproof.shared.claims.candidate import OfKind
from orbitproof.shared.formats import REVERSOR_BREAKING, read_document, read_system, validate_document, write_text
from orbitproof.shared.systems import ReversibleSystem

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
        half_period: the time between the two points, their sum. Orbits that R does not map to themselves have all
            their crossings of the section here, c of them, and the times between them; the points have the coordinates
            of the first and of that half of the crossings later; half the period is half of all times.
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
class BranchRecord(OfKind):
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
    document = {"format": "orbitproof-branches", "version": 1, "branches": to_json(list(branches))}
    validate_document(document, "branches", "branch file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def read_branches(path: Path) -> list[BranchRecord]:
    """Read a branch file. Raises `InputError`, one line, for anything that is not well formed."""
    document = read_document(path, "branches")
    return [_branch(entry, f"{path}: field branches[{index}]") for index, entry in enumerate(document["branches"])]


def _branch(value: Mapping[str, Any], source: str) -> BranchRecord:
    system, parameters = read_system(value, source)
    examined(system, source)
    entry, size = ObjectReader(source, system), len(system.centre_coordinates)
    loop = value["kind"] == REVERSOR_BREAKING
    sides = tuple(
        BranchSide(
            tuple(
                _orbit(entry, f"sides[{i}].orbits[{j}]", orbit, None if loop else value["k"])
                for j, orbit in enumerate(side["orbits"])
            ),
            side["outcome"],
            side["reason"],
        )
        for i, side in enumerate(value["sides"])
    )
    if len(sides) != (0 if value["birth"] is None else 2):
        entry.refuse("sides", f"{len(sides)} of them", "a branch has two, and none without birth")
    arrays = {name: entry.array(name, value[name], size) for name in ("point", "second_point", "scale")}
    if not np.all(arrays["scale"] > 0):
        entry.refuse("scale", "not positive")
    entry.finite("level", value["half_period"], value["level"])
    numbers = {name: float(value[name]) for name in ("half_period", "level")}
    birth = None if value["birth"] is None else Birth(**value["birth"])
    read = {"system": system, "parameters": parameters, "birth": birth, "sides": sides}
    return BranchRecord(**{**value, **arrays, **numbers, **read})


def _orbit(entry: ObjectReader, where: str, value: Mapping[str, Any], k: int | None) -> BranchOrbit:
    """One orbit; k is `None` if it is not symmetric."""
    size, m = len(entry.system.centre_coordinates), len(entry.system.state)
    count = len(value["times"])
    if k is None and (count < 2 or count % 2):
        entry.refuse(f"{where}.times", f"{count} of them", "a whole orbit has an even number of crossings")
    between, times = (count, count) if k is None else (k - 1, k)
    shapes = {"point": (size,), "second_point": (size,), "crossings": (between, m), "times": (times,)}
    numbers = {name: value[name] for name in ("arclength", "half_period", "level", "level_difference")}
    entry.finite(where, *numbers.values())
    return BranchOrbit(
        **{name: float(number) for name, number in numbers.items()},
        **{name: entry.array(f"{where}.{name}", value[name], *shape) for name, shape in shapes.items()},
        stability=entry.stability(f"{where}.stability", value["stability"]),
    )
