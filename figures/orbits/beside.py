"""The periodic orbits beside a fold, a doubling or a pitchfork, by Newton's method: for drawing only.

They are looked for at a distance from the orbit that bifurcates, in the direction of the claim's eigenvector; what
varies is an unknown, and its value says on which side they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.figures.orbits.fixed_set import Array
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.figures.orbits.return_map import ReturnMap
from orbitproof.figures.orbits.returning import ReturningOrbit, returning_orbit
from orbitproof.shared.formats import PeriodicBifurcation

_FIRST = 0.01
"""The first distance on the section, relative to the size of the orbit."""
_APART = 0.1
"""How far from the orbit the new ones are in a picture, where they are farthest, relative to its size."""
_GROWTH = 2.0
_SHRINKINGS = 4
_MOST_STEPS = 20
_DIFFERENCE = 1e-6
_CONVERGED = 1e-9
_NEW = 0.3
"""How far a new orbit has to be from what would make it an old one, relative to the distance on the section."""


@dataclass(frozen=True)
class NewOrbits:
    """Orbits beside a bifurcation.

    Attributes:
        value: of the parameter or the level that varies.
        orbits: one at a doubling, else two.
    """

    value: float
    orbits: tuple[ReturningOrbit, ...]


def new_orbits(
    claim: PeriodicBifurcation, orbit: ReturningOrbit, values: list[float], side: str | None = None
) -> NewOrbits:
    """The orbits that are born, as far from the old one as a picture takes, or less.

    Arguments:
        orbit: at the bifurcation, from its point on.
        values: the parameters there.
        side: "above" or "below", where a certificate says that they are.

    Raises `OrbitNotClosed` if none are found there.
    """
    beside, size = _Beside(claim, orbit, values), float(np.ptp(orbit.states, axis=0).max())
    distance, found, reason = _FIRST * size, None, "no orbits are found beside it in double precision"
    point = None
    for _ in range(_SHRINKINGS + 1):
        try:
            point = beside.at_distance(distance, None)
            found = beside.drawn(point, side)
            break
        except OrbitNotClosed as error:
            reason, distance = str(error), distance / 4
    if point is None or found is None:
        raise OrbitNotClosed(reason)
    while (ratio := _APART * size / _farthest(found.orbits[0].states, orbit.states)) > 1.2:
        factor = min(ratio, _GROWTH)
        try:
            point = beside.at_distance(factor * distance, beside.scaled(point, factor))
            found = beside.drawn(point, side)
        except OrbitNotClosed:
            break
        distance *= factor
    return found


def _farthest(states: Array, others: Array) -> float:
    """The greatest distance of a state of a curve from another curve."""
    some = states[:: max(1, len(states) // 500)]
    rest = others[:: max(1, len(others) // 2000)]
    return max(float(np.min(np.linalg.norm(rest - state, axis=1))) for state in some)


class _Beside:
    """Fixed points of the map about that of the bifurcation, the unknowns p and, if one is named, the parameter."""

    def __init__(self, claim: PeriodicBifurcation, orbit: ReturningOrbit, values: list[float]) -> None:
        times = 1 if claim.is_fold or claim.is_mirrored else 2
        self.claim, self.values = claim, values
        self.map = ReturnMap(claim, values, times * float(orbit.times[-1]))
        self.crossings = times * len(orbit.crossings)
        self.start = self.map.coordinates(orbit.states[:1])[0]
        kernel = np.array([float(value) for value in claim.kernel[0]])
        length = float(np.linalg.norm(self.map.states(kernel[None])[0] - self.map.states(0 * kernel[None])[0]))
        self.kernel = kernel / length
        self.place = None if claim.parameter is None else list(claim.system.parameters).index(claim.parameter)
        self.size = float(np.ptp(orbit.states, axis=0).max())
        own = [] if self.place is None else [values[self.place]]
        self.origin = np.append(self.start, own)

    def level(self, unknowns: Array) -> float:
        """The first integral at the point of unknowns."""
        program = self.claim.system.first_integral_program
        assert program is not None
        state = self.map.states(unknowns[None, : len(self.start)])[0]
        return float(program.evaluate([*state, *self.values_at(unknowns)])[0])

    def values_at(self, unknowns: Array) -> list[float]:
        """All parameters."""
        values = list(self.values)
        if self.place is not None:
            values[self.place] = float(unknowns[-1])
        return values

    def varying(self, unknowns: Array) -> float:
        """What varies: the parameter, or the level."""
        return self.level(unknowns) if self.place is None else float(unknowns[-1])

    def distance(self, unknowns: Array) -> float:
        """From the point of the bifurcation along the eigenvector, in the units of the state."""
        return float(self.kernel @ (unknowns[: len(self.start)] - self.start) / (self.kernel @ self.kernel))

    def scaled(self, unknowns: Array, factor: float) -> Array:
        """A guess farther out: points grow in proportion, what varies with the square."""
        away = (unknowns - self.origin) * factor
        if self.place is not None:
            away[-1] *= factor
        return np.asarray(self.origin + away)

    def at_distance(self, distance: float, guess: Array | None) -> Array:
        """The fixed point at a distance. Raises `OrbitNotClosed`."""
        if guess is None:
            guess = self.origin.copy()
            guess[: len(self.start)] += distance * self.kernel
        return self._solved(guess, lambda unknowns: self.distance(unknowns) - distance)

    def other(self, unknowns: Array) -> Array:
        """The second fixed point at a fold, for the same value of what varies. Raises `OrbitNotClosed`."""
        guess, value = self.origin - (unknowns - self.origin), self.varying(unknowns)
        if self.place is not None:
            guess[-1] = value
        return self._solved(guess, lambda found: self.varying(found) - value)

    def drawn(self, unknowns: Array, side: str | None) -> NewOrbits:
        """The orbits of a fixed point. Raises `OrbitNotClosed` if they are not what is looked for."""
        value, here = self.varying(unknowns), self.varying(self.origin)
        if side is not None and (value > here) != (side == "above"):
            raise OrbitNotClosed(f"orbits are found beside it, but not {side} it")
        first = self._orbit(unknowns)
        apart = _NEW * abs(self.distance(unknowns))
        if self.claim.is_fold:
            second = self._orbit(self.other(unknowns))
        elif self.claim.is_mirrored:
            assert self.claim.symmetry is not None
            matrix = np.array([[float(value) for value in row] for row in self.claim.symmetry])
            second = ReturningOrbit(first.times, first.states @ matrix.T, first.crossings @ matrix.T)
        else:
            if not np.max(np.abs(first.crossings[len(first.crossings) // 2 - 1] - first.states[0])) > apart:
                raise OrbitNotClosed("Newton's method leads back to the old orbits")
            return NewOrbits(value, (first,))
        if not np.min(np.max(np.abs(first.crossings - second.states[0]), axis=1)) > apart:
            raise OrbitNotClosed("Newton's method leads back to the old orbits")
        return NewOrbits(value, (first, second))

    def _orbit(self, unknowns: Array) -> ReturningOrbit:
        state = self.map.states(unknowns[None, : len(self.start)])[0]
        return returning_orbit(self.claim, state.tolist(), self.crossings, self.values_at(unknowns))

    def _solved(self, unknowns: Array, condition: object) -> Array:
        """Newton's method for a fixed point with one more condition, derivatives by differences."""
        assert callable(condition)
        scale = np.full(len(unknowns), self.size)
        if self.place is not None:
            scale[-1] = max(1.0, abs(self.origin[-1]))
        for _ in range(_MOST_STEPS):
            ends = np.concatenate([np.zeros((1, len(scale))), np.diag(scale), -np.diag(scale)]) * _DIFFERENCE
            residuals = self._residuals(unknowns + ends, condition)
            one, other = np.split(residuals[1:], 2)
            slopes = (one - other).T / (2 * _DIFFERENCE)
            if not np.all(np.isfinite(slopes)):
                break
            step = -np.linalg.lstsq(slopes, residuals[0], rcond=1e-12)[0]
            unknowns = unknowns + step * scale
            if np.max(np.abs(step)) < _CONVERGED:
                return unknowns
            if not np.max(np.abs(step)) < 1.0:
                break
        raise OrbitNotClosed("no orbits are found beside it in double precision")

    def _residuals(self, many: Array, condition: object) -> Array:
        """For each row of unknowns what has to be 0, in parts of the size of the orbit."""
        assert callable(condition)
        points = many[:, : len(self.start)]
        images = self.map.images(self.map.states(points), None if self.place is None else many[:, -1])
        columns = [self.map.coordinates(images) - points, np.array([[condition(row)] for row in many])]
        if self.place is not None and self.claim.level is not None:
            level = float(self.claim.level)
            columns.append(np.array([[self.level(row) - level] for row in many]))
        return np.asarray(np.hstack(columns) / self.size)
