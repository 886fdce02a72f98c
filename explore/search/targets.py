"""Which points are refined, under which ids, and how new candidates join those of a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, log2
from typing import Any

import numpy as np

from orbitproof.explore.families import LocatedResonance, TracedFamily
from orbitproof.explore.flow import Vector
from orbitproof.explore.names import short_name
from orbitproof.explore.orbits import Side
from orbitproof.explore.refinement import Task
from orbitproof.shared.formats import Candidate

SAME_POINT = 1e-6
"""Largest distance, relative where a coordinate exceeds 1, of a refined point from its float64 approximation."""


@dataclass(frozen=True)
class Target:
    """A resonance at one of the two points of its orbit on Fix(R)."""

    item: TracedFamily
    resonance: LocatedResonance
    side: Side
    id: str

    @property
    def guess(self) -> Vector:
        """The float64 point, in the order of `ReversibleSystem.centre_coordinates`."""
        return self.resonance.orbit.centre(self.side)

    def task(self, digits: int) -> Task:
        """What the refinement needs."""
        resonance, problem = self.resonance, self.item.family.problem
        return Task(
            id=self.id,
            system=self.item.system,
            parameters=dict(problem.parameters),
            kind=resonance.kind,
            k=resonance.k,
            symmetry=resonance.symmetry,
            guess=tuple(float(value) for value in self.guess),
            digits=digits,
            provenance=self._provenance(),
            crossings=resonance.orbit.crossings,
            work=self._work(),
        )

    def _work(self) -> float:
        """A measure of how long the refinement takes: errors that grow along the orbit ask for more precision."""
        half, n = self.resonance.orbit.derivative, len(self.item.system.kernel_coordinates)
        growth = 1.0 if half is None else float(np.linalg.cond(half.derivative))
        return n**2 * (2 + self.resonance.k) * (1 + log2(max(growth, 1.0)))

    def _provenance(self) -> Mapping[str, Any]:
        orbit, branch = self.resonance.orbit, self.item.branch
        return {
            "family": self.item.name,
            **({} if branch is None else {"branch": branch}),
            "parameters": self.item.label,
            "point_on_fix_r": self.side,
            "shows_at_both_points": self.resonance.other_side,
            "float64_point": [float(value) for value in self.guess],
            "float64_first_integral": orbit.first_integral,
            "stability_parameters": [[value.real, value.imag] for value in orbit.stability],
            "resonant_value": self.resonance.value,
            "arclength": orbit.arclength,
        }


def targets_of(item: TracedFamily, points: str) -> list[Target]:
    """The points to refine, in order along the family; `points` is one of `POINTS`.

    The ids count the resonances of a multiplicity, and the folds, from the birth of the family: they do not depend on
    which other multiplicities or points were asked for, nor on how far the family was traced.
    """
    label = "-".join(part for part in (item.label or item.system.name, item.name) if part)
    counts: dict[str, int] = {}
    result: list[Target] = []
    for resonance in item.detection.resonances:
        k = resonance.k
        what = short_name(resonance.kind, k)
        counts[what] = counts.get(what, 0) + 1
        id = f"{label}-{what}-{counts[what]}"
        result.append(Target(item, resonance, resonance.side, id))
        # For odd k both points belong to the same new orbits, for even k >= 4 to different ones.
        distinct = points == "distinct" and k % 2 == 0
        if k > 1 and resonance.other_side and (distinct or points == "all"):
            result.append(Target(item, resonance, "second", f"{id}-second"))
    return result


def is_refined(task: Task, candidate: Candidate) -> bool:
    """Whether a candidate of the task's id is what the task would find."""
    wanted = (task.system, task.kind, task.k, task.crossings)
    if (candidate.system, candidate.kind, candidate.k, candidate.crossings) != wanted:
        return False
    digits = candidate.provenance.get("digits")
    if dict(candidate.parameters) != dict(task.parameters) or not isinstance(digits, int) or digits < task.digits:
        return False
    return all(
        abs(float(value) - guess) <= SAME_POINT * max(1.0, abs(guess))
        for value, guess in zip(candidate.centre, task.guess, strict=True)
    )


def merged(kept: Sequence[Candidate], new: Sequence[Candidate]) -> list[Candidate]:
    """Both lists: new candidates replace those of the same id, and each family is in order along it.

    Families stay in the order in which they first appear; candidates without an arclength in their
    provenance stay in front of those with one.
    """
    fresh = {candidate.id: candidate for candidate in new}
    old = {candidate.id for candidate in kept}
    both = [fresh.get(candidate.id, candidate) for candidate in kept]
    both += [candidate for candidate in new if candidate.id not in old]
    groups: dict[tuple[str, ...], list[Candidate]] = {}
    for candidate in both:
        names = (candidate.provenance.get("parameters"), candidate.provenance.get("family"))
        groups.setdefault((candidate.system.name, *map(str, names)), []).append(candidate)
    return [candidate for group in groups.values() for candidate in sorted(group, key=_place)]


def _place(candidate: Candidate) -> tuple[float, bool]:
    place = candidate.provenance.get("arclength")
    # Rounded, so that both points of one orbit stay together also if they were found in different runs.
    second = candidate.provenance.get("point_on_fix_r") == "second"
    return round(place, 5) if isinstance(place, float) else -inf, second
