"""Pseudo-arclength continuation of families of symmetric periodic orbits.

No coordinate is a global parameter: each step predicts along the tangent of the family and corrects
in the hyperplane across it, so that folds in any coordinate are passed.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, pairwise
from typing import Literal

import numpy as np

from orbitproof.explore.families.step_control import DEFAULT, StepControl
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.numerics import NoStep, predict, walked
from orbitproof.explore.orbits import Correction, CorrectionFailure, ShootingProblem, SymmetricOrbit

Outcome = Literal["limit", "closed", "failed", "interrupted"]

ON_SECTION = 1e-12
"""Distance from the section, relative to the largest of the orbit, below which a sample has no side."""

RETURNED = "the family returns to Fix(S)"
RETRACES = "the family goes back over its own orbits, each from its other point on Fix(R)"
"""Where both points on Fix(R) fall together: there the half orbit is a whole one, or the orbit an equilibrium."""

_ASIDE = 0.05
_ALONG = 0.97

Stop = Callable[[SymmetricOrbit, Matrix], str | None]
"""Called with each new orbit and samples of its states; a reason ends the family after this orbit."""


@dataclass(frozen=True)
class Ending:
    """Why a family goes no further, and the same in words, with the place."""

    outcome: Outcome
    reason: str


@dataclass(frozen=True)
class Family:
    """A curve of symmetric periodic orbits.

    Attributes:
        problem: what the orbits solve.
        orbits: in order of arclength.
        tangents: unit tangents in scaled unknowns, one per orbit.
        outcome: why it ends.
        reason: the same in words, with the place.
        beginning: why it goes no further on the side of its first orbit; `None` if it was traced from there.
    """

    problem: ShootingProblem
    orbits: tuple[SymmetricOrbit, ...]
    tangents: tuple[Vector, ...]
    outcome: Outcome
    reason: str
    beginning: Ending | None = None

    @property
    def retraces(self) -> bool:
        """Whether it ends because it goes back over its own orbits; files say so in the reason alone."""
        return self.reason.startswith(RETRACES)

    @property
    def returned(self) -> bool:
        """Whether it ends because it is back on Fix(S); files say so in the reason alone."""
        return self.reason.startswith(RETURNED)

    @property
    def failed(self) -> bool:
        """Whether the family goes on where the continuation could not, at either end."""
        return "failed" in (self.outcome, self.beginning and self.beginning.outcome)

    @property
    def tangencies(self) -> tuple[str, ...]:
        """One line for each place where an orbit touches the section and the number of its crossings changes."""
        return tuple(
            tangency(self.problem, *pair) for pair in pairwise(self.orbits) if pair[0].crossings != pair[1].crossings
        )

    def turned(self) -> Family:
        """This family with its orbits in the opposite order."""
        length = self.orbits[-1].arclength
        end = self.beginning or Ending("limit", "started")
        return replace(
            self,
            orbits=tuple(replace(orbit, arclength=length - orbit.arclength) for orbit in reversed(self.orbits)),
            tangents=tuple(-tangent for tangent in reversed(self.tangents)),
            outcome=end.outcome,
            reason=end.reason,
            beginning=Ending(self.outcome, self.reason),
        )

    @cached_property
    def arclengths(self) -> tuple[float, ...]:
        """Arclength of each orbit."""
        return tuple(orbit.arclength for orbit in self.orbits)

    def orbit_at(self, arclength: float) -> SymmetricOrbit:
        """The orbit between two computed ones, at a chord arclength within the family.

        Prediction by Hermite interpolation between the nearest orbits, corrected in the hyperplane across
        the chord. Raises `CorrectionFailure`.
        """
        index = min(max(bisect_right(self.arclengths, arclength) - 1, 0), len(self.orbits) - 2)
        left, right = self.orbits[index], self.orbits[index + 1]
        scales = self.problem.scales
        step = (right.unknowns - left.unknowns) / scales
        length = float(np.linalg.norm(step))
        chord = step / length
        nearest = [i for i in (index, index + 1, index - 1, index + 2) if 0 <= i < len(self.orbits)]
        prediction = predict(
            [self.orbits[i].unknowns / scales for i in nearest],
            [self.tangents[i] for i in nearest],
            chord,
            length * (arclength - left.arclength) / (right.arclength - left.arclength),
        )
        correction = self.problem.correct(prediction * scales, chord)
        number = left.crossings
        if right.crossings != number:
            number = crossings(self.problem, _samples(self.problem, correction))
        return self.problem.orbit(correction, arclength, number)


@dataclass(frozen=True)
class Start:
    """Where a family starts: approximate unknowns, the direction to leave in and its scaled length.

    The first orbit is the solution in the hyperplane across `direction`. `origin`, if given, is an
    exact first orbit at which the family branches off; then the continuation starts from there.
    """

    unknowns: Vector
    direction: Vector
    origin: SymmetricOrbit | None = None


@dataclass(frozen=True)
class Course:
    """How a family is followed, and how far.

    Attributes:
        stop: the limits; see `Stop`.
        control: steps and tolerances.
        max_orbits: the last limit.
        progress: called with each accepted orbit.
    """

    stop: Stop
    control: StepControl = DEFAULT
    max_orbits: int = 1000
    progress: Callable[[SymmetricOrbit], None] | None = None


def trace(problem: ShootingProblem, start: Start, course: Course) -> Family:
    """Continue a family from `start` until a limit, closure, failure or an interrupt.

    Returns the family with the orbits found; raises `CorrectionFailure` only if not even the first
    orbit can be found.
    """
    direction = start.direction / float(np.linalg.norm(start.direction))
    if start.origin is not None:
        orbits, tangents = [start.origin], [direction]
    else:
        correction = problem.correct(start.unknowns, direction)
        tangents = [problem.tangent(correction.jacobian, direction)]
        orbits = [problem.orbit(correction, 0.0, crossings(problem, _samples(problem, correction)))]
    return extend(Family(problem, tuple(orbits), tuple(tangents), "limit", "started"), course)


def extend(family: Family, course: Course) -> Family:
    """Continue a family from its last orbit; result as for `trace`."""
    control, max_orbits = course.control, course.max_orbits
    problem, orbits, tangents = family.problem, list(family.orbits), list(family.tangents)
    others = [_other_point(orbit) for orbit in orbits]
    first = control.initial
    if len(orbits) > 2:
        first = min(_longest(problem, orbits[-1], control), orbits[-1].arclength - orbits[-2].arclength)

    def ended(outcome: Outcome, reason: str) -> Family:
        return Family(problem, tuple(orbits), tuple(tangents), outcome, reason, family.beginning)

    def advance(step: float) -> tuple[tuple[SymmetricOrbit, Vector, Matrix], float]:
        return _advance(problem, orbits[-3:], tangents[-3:], step, control)

    failures = CorrectionFailure, FlowFailure, ZeroDivisionError
    try:
        steps = walked(advance, first, control.minimum, failures)
        for orbit, tangent, states in islice(steps, max(0, max_orbits - len(orbits))):
            touches = orbit.crossings != orbits[-1].crossings
            orbits.append(orbit)
            others.append(_other_point(orbit))
            tangents.append(tangent)
            if course.progress is not None:
                course.progress(orbit)
            if touches and control.until_tangency:
                return ended("limit", tangency(problem, orbits[-2], orbit))
            if _closes(problem, orbits):
                return ended("closed", f"the family closes ({describe(problem, orbit)})")
            reason = course.stop(orbit, states)
            if reason is not None:
                return ended("limit", f"{reason} ({describe(problem, orbit)})")
            if _retraces(problem, orbits, others):
                return ended("limit", f"{RETRACES} ({describe(problem, orbit)})")
    except NoStep as error:
        place = describe(problem, orbits[-1])
        return ended("failed", f"{error}; no orbit within the smallest step {control.minimum:g} ({place})")
    except KeyboardInterrupt:
        return ended("interrupted", f"interrupted ({describe(problem, orbits[-1])})")
    return ended("limit", f"{max_orbits} orbits ({describe(problem, orbits[-1])})")


def _longest(problem: ShootingProblem, orbit: SymmetricOrbit, control: StepControl) -> float:
    return control.maximum * max(1.0, 0.1 * float(np.linalg.norm(orbit.unknowns / problem.scales)))


def _advance(
    problem: ShootingProblem,
    orbits: Sequence[SymmetricOrbit],
    tangents: Sequence[Vector],
    step: float,
    control: StepControl,
) -> tuple[tuple[SymmetricOrbit, Vector, Matrix], float]:
    """The next orbit after the last of `orbits`, its tangent and its states, and the length of the next step."""
    last, tangent = orbits[-1], tangents[-1]
    backwards = [orbit.unknowns / problem.scales for orbit in reversed(orbits)]
    prediction = predict(backwards, list(reversed(tangents)), tangent, step)
    correction = problem.correct(prediction * problem.scales, tangent)
    new_tangent = problem.tangent(correction.jacobian, tangent)
    angle = float(np.arccos(min(1.0, float(new_tangent @ tangent))))
    moved = (correction.unknowns - last.unknowns) / problem.scales
    # Where a branch leaves Fix(S) it may turn within less than the accuracy of its tangent. The hyperplane across its
    # direction has no orbits of Fix(S) but the first, so that a longer way than the step is no sign of another family.
    leaving = in_fixed_space(problem, last)
    turning, reach = (0.5 * np.pi, control.maximum) if leaving else (control.turning, 1.5 * step)
    if angle > turning or float(np.linalg.norm(moved)) > max(reach, 1.5 * step):
        raise CorrectionFailure("the family turns too sharply")
    states = _samples(problem, correction)
    orbit = problem.orbit(correction, crossings=crossings(problem, states))
    orbit = replace(orbit, arclength=last.arclength + float(np.linalg.norm(moved)))
    growth = 1.0
    if angle < 0.6 * control.turning:
        growth = {0: 2.0, 1: 2.0, 2: 1.6, 3: 1.3, 4: 1.0}.get(correction.iterations, 0.7)
    return (orbit, new_tangent, states), min(_longest(problem, orbit, control), step * growth)


def in_fixed_space(problem: ShootingProblem, orbit: SymmetricOrbit) -> bool:
    """Whether an orbit lies in Fix(S) for a symmetry S that its family does not have."""
    if problem.symmetry is not None:
        return False
    odd = [problem.odd_unknowns(name) for name in problem.system.symmetries]
    return any(indices and all(orbit.unknowns[i] == 0 for i in indices) for indices in odd)


def _samples(problem: ShootingProblem, correction: Correction) -> Matrix:
    return problem.samples(correction.unknowns)


def crossings(problem: ShootingProblem, states: Matrix) -> int:
    """How often a sampled half orbit meets the section after its start, its end included."""
    *inner, end = states[1:, problem.system.section_index]
    heights = np.array(inner)
    # Samples next to the end may lie on the wrong side of the section, by as much as the end itself is off it.
    error = max(10 * abs(end), ON_SECTION * float(np.max(np.abs(heights), initial=0.0)))
    signs = np.sign(heights[np.abs(heights) > error])
    return 1 + int(np.count_nonzero(signs[1:] != signs[:-1]))


def tangency(problem: ShootingProblem, before: SymmetricOrbit, after: SymmetricOrbit) -> str:
    """The sentence that between two orbits one is tangent to the section, in words, with the place."""
    counts = f"{before.crossings} to {after.crossings} crossings in the half orbit"
    return f"the orbit becomes tangent to the section: {counts} ({describe(problem, after)})"


def _closes(problem: ShootingProblem, orbits: Sequence[SymmetricOrbit]) -> bool:
    if len(orbits) < 10:
        return False
    start, left, right = (orbit.unknowns / problem.scales for orbit in (orbits[0], orbits[-2], orbits[-1]))
    chord = right - left
    fraction = float((start - left) @ chord) / float(chord @ chord)
    distance = float(np.linalg.norm(start - left - fraction * chord))
    return 0.0 <= fraction <= 1.0 and distance < 0.1 * float(np.linalg.norm(chord))


def _other_point(orbit: SymmetricOrbit) -> Vector:
    """The unknowns of an orbit that starts at its other point on Fix(R)."""
    return np.append(orbit.centre("second"), orbit.half_period)


def _retraces(problem: ShootingProblem, orbits: Sequence[SymmetricOrbit], others: Sequence[Vector]) -> bool:
    """Whether the last step leads to an earlier orbit at its other point on Fix(R), and back along these."""
    if len(orbits) < 3:
        return False
    earlier = np.array(others[:-1]) / problem.scales
    chords = np.diff(earlier, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    last, before = (orbit.unknowns / problem.scales for orbit in (orbits[-1], orbits[-2]))
    step = last - before
    offsets = last - earlier[:-1]
    along = np.sum(offsets * chords, axis=1)
    aside = np.linalg.norm(offsets - (along / lengths**2)[:, None] * chords, axis=1)
    on_chord = (along >= 0) & (along <= lengths**2) & (aside < _ASIDE * lengths)
    return bool(np.any(on_chord & (chords @ step < -_ALONG * lengths * np.linalg.norm(step))))


def describe(problem: ShootingProblem, orbit: SymmetricOrbit) -> str:
    """The place of an orbit in one line: its unknowns and first integral."""
    names = (*problem.system.centre_coordinates, "half period")
    parts = [f"{name} = {value:.8g}" for name, value in zip(names, orbit.unknowns, strict=True)]
    if orbit.first_integral is not None:
        parts.append(f"{problem.system.first_integral_name} = {orbit.first_integral:.8g}")
    return ", ".join(parts)
