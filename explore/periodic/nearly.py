"""Guesses of periodic orbits: an orbit is followed until it nearly repeats."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem, correct
from orbitproof.explore.periodic.flow import SAMPLES, Matrix, Vector, arc_of, stiff_path
from orbitproof.explore.periodic.section import AffineSection
from orbitproof.explore.periodic.segments import nodes_of, segments_for

_PIECES = 40
_NEAR = 0.1
"""Distance, relative to the size of the orbit, from which Newton's method is tried."""
_CLOSED = 1e-4
"""Distance, so measured, between the ends of a piece that is an orbit up to errors of the integration."""
_TRIED = 12
_SAME = 1e-6
_AT_REST = 1e-6
"""An orbit that moves less than this, relative to where it is and was, is at an equilibrium."""


@dataclass(frozen=True)
class Recurrence:
    """A piece of an orbit that nearly closes.

    Attributes:
        point: where it begins.
        time: how long it takes.
        returns: of the section in the direction.
        distance: between its ends, relative to the size of the orbit.
    """

    point: Vector
    time: float
    returns: int
    distance: float


def follow(
    problem: PeriodicProblem, start: Sequence[float] | Vector, time: float, progress: Callable[[float], None]
) -> tuple[Matrix, Vector]:
    """States at equal times over a long time, shape (K, N), and these times. Raises `PeriodicFailure`."""
    x, states, piece, is_stiff = np.array(start, dtype=float), [], time / _PIECES, False
    try:
        for number in range(_PIECES):
            x, samples, is_stiff = _piece(problem, x, piece, is_stiff)
            states.append(samples[:-1])
            progress((number + 1) / _PIECES)
    except FlowFailure as failure:
        why = "it runs away, or the field is too stiff; begin elsewhere"
        raise PeriodicFailure(f"{failure}, after {number} of {_PIECES} pieces: {why}") from None
    return np.concatenate(states), np.arange(_PIECES * (SAMPLES - 1)) * (piece / (SAMPLES - 1))


def _piece(problem: PeriodicProblem, x: Vector, time: float, is_stiff: bool) -> tuple[Vector, Matrix, bool]:
    """The end and the states of a piece, and whether it takes an implicit method. Raises `FlowFailure`."""
    if not is_stiff:
        try:
            arc = arc_of(problem.system, x, time, problem.values)
            return arc.end, arc.samples, False
        except FlowFailure as failure:
            explicit = failure
    try:
        return *stiff_path(problem.system, x, time, problem.values), True
    except FlowFailure as failure:
        raise failure if is_stiff else explicit from None


def equilibrium_of(states: Matrix) -> Vector | None:
    """Where a followed orbit has come to rest, shape (N,); `None` if it still moves."""
    last = states[-len(states) // _PIECES :]
    scale = np.maximum(np.max(np.abs(last), axis=0), np.ptp(states, axis=0))
    return states[-1] if np.all(np.ptp(last, axis=0) <= _AT_REST * scale) else None


def recurrences(
    problem: PeriodicProblem, states: Matrix, times: Vector, section: AffineSection, most: int
) -> Iterator[Recurrence]:
    """Where an orbit nearly repeats after 1, .., `most` returns to a section; the closest first for each number."""
    heights = section.heights(states)
    where = np.flatnonzero((heights[:-1] < 0) & (heights[1:] >= 0))
    share = heights[where] / (heights[where] - heights[where + 1])
    points = states[where] + share[:, None] * (states[where + 1] - states[where])
    moments = times[where] + share * (times[1] - times[0])
    size = float(np.max(np.ptp(states, axis=0))) or 1.0
    for returns in range(1, most + 1):
        if len(points) <= returns:
            return
        distances = np.max(np.abs(points[returns:] - points[:-returns]), axis=1) / size
        for place in np.argsort(distances, kind="stable")[:_TRIED]:
            if distances[place] < _NEAR:
                length = float(moments[place + returns] - moments[place])
                yield Recurrence(points[place], length, returns, float(distances[place]))


def nearby_orbits(
    problem: PeriodicProblem, found: Iterator[Recurrence], section: AffineSection | None = None
) -> Iterator[ClosedOrbit]:
    """The different orbits to which Newton's method leads from there, in order of the returns."""
    known: list[ClosedOrbit] = []
    for guess in found:
        try:
            orbit = _corrected(problem, guess, section)
        except (FlowFailure, PeriodicFailure):
            continue
        if not any(_same(orbit, other) for other in known):
            known.append(orbit)
            yield orbit


def _corrected(problem: PeriodicProblem, guess: Recurrence, section: AffineSection | None) -> ClosedOrbit:
    """The orbit near a guess, in segments where one shot takes too many explicit steps. Raises what fails."""
    try:
        return correct(problem, guess.point, guess.time, section)
    except PeriodicFailure:
        if guess.distance > _CLOSED:
            raise
    loop = stiff_path(problem.system, guess.point, guess.time, problem.values)[1]
    number = segments_for(problem.system, loop, guess.time, problem.values)
    return correct(problem, nodes_of(loop, number), guess.time, section)


def _same(left: ClosedOrbit, right: ClosedOrbit) -> bool:
    if abs(left.period - right.period) > _SAME * right.period:
        return False
    # The other one's point lies on it as exactly as samples at equal times tell.
    gaps = np.max(np.abs(left.loop - right.point), axis=1)
    pace = float(np.max(np.abs(np.diff(left.loop, axis=0))))
    return float(gaps.min()) < pace
