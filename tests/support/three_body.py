"""Symmetric orbits of the three-body problem, all that a list says of them, by an integrator of its own.

The equations and their variations are written out here and followed by DOP853 in float64, in time s with dt = r ds, r
the distance from the smaller primary, which is the origin here. Of the code under test nothing is used; of the common
statement the points of a piece.

Monodromy matrices are those of the whole orbit, 6 x 6: that the second half is an image of the first is not used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support.list_truths import KnownCurve
from support.skew_products import interpolated

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Atlas, Piece

_RELATIVE, _ABSOLUTE = 3e-14, 1e-15
_NODES = 72
"""Of Chebyshev interpolation along a piece."""
_GRID = 801
"""Places on a piece between which zeros are looked for."""
_ALONG = 257
"""Times of half an orbit at which distances are compared."""
_X, _Y, _Z, _VX, _VY, _VZ, _TIME = range(7)
SPATIAL, PLANAR = (_X, _Z, _VY), (_X, _VY)
"""Coordinates of Fix(R)."""


def rates(state: Any, mu: float, variations: Any) -> tuple[Any, Any]:
    """Derivatives by s.

    Args:
        state: x, y, z about the smaller primary, their velocities, t; shape (7, N).
        variations: of the first six; shape (6, k, N).
    """
    x, y, z, vx, vy, vz, _ = state
    forces = np.array([x + 1 - mu + 2 * vy, y - 2 * vx, 0 * z])
    turns = np.array([variations[_X] + 2 * variations[_VY], variations[_Y] - 2 * variations[_VX], 0 * variations[_Z]])
    for mass, centre in ((1 - mu, -1), (mu, 0)):
        along = np.array([x - centre, y, z])
        distance = np.sqrt((along**2).sum(axis=0))
        inner = np.einsum("iN,ikN->kN", along, variations[:3])
        forces -= mass * along / distance**3
        turns -= mass * (variations[:3] / distance**3 - 3 * along[:, None] * inner / distance**5)
    # The last one is the smaller primary.
    physical = np.concatenate([[vx, vy, vz], forces, np.ones((1, x.size))])
    change = np.concatenate([variations[3:], turns])
    return distance * physical, distance * change + physical[:6, None] * (inner / distance)


def follow(start: Any, lengths: Any, mu: float, shares: Sequence[float], columns: Any) -> tuple[Any, Any]:
    """States, shape (7, N, shares), and variations, shape (6, k, N, shares), after shares of the lengths in s.

    Args:
        columns: variations at the start, shape (6, k).
    """
    number, count = start.shape[1], columns.shape[1]

    def field(_: float, flat: Any) -> Any:
        state, variations = flat[: 7 * number].reshape(7, number), flat[7 * number :].reshape(6, count, number)
        return np.concatenate([(rate * lengths).ravel() for rate in rates(state, mu, variations)])

    begun = np.concatenate([start.ravel(), np.repeat(columns.ravel(), number)])
    run = solve_ivp(field, (0, shares[-1]), begun, "DOP853", shares, rtol=_RELATIVE, atol=_ABSOLUTE)
    assert run.success
    states, changes = run.y[: 7 * number], run.y[7 * number :]
    return states.reshape(7, number, len(shares)), changes.reshape(6, count, number, len(shares))


def jacobi_constant(state: Any, mu: float) -> Any:
    """That of the shared statement, without mu (1 - mu)."""
    x, y, z, vx, vy, vz = state[:6]
    across = y**2 + z**2
    potential = (1 - mu) / np.sqrt((x + 1) ** 2 + across) + mu / np.sqrt(x**2 + across)
    return (x + 1 - mu) ** 2 + y**2 + 2 * potential - vx**2 - vy**2 - vz**2


@dataclass(frozen=True)
class Orbits:
    """Orbits through points of Fix(R).

    Attributes:
        points: coordinates of the piece less those of `Problem.origin`, shape (1 + n, N).
        start: shape (7, N).
        lengths: of half orbits, in s.
    """

    points: Any
    start: Any
    lengths: Any
    mu: float

    @cached_property
    def _half(self) -> tuple[Any, Any]:
        """State and variations at the other point of Fix(R)."""
        states, changes = follow(self.start, self.lengths, self.mu, (1.0,), np.eye(6))
        return states[..., 0], changes[..., 0]

    @cached_property
    def _whole(self) -> tuple[Any, Any]:
        """The same after a whole orbit, less the state where it begins: beside the body variations are of all sizes."""
        there = self._half[0]
        nearer = np.linalg.norm(there[:3], axis=0).mean() < np.linalg.norm(self.start[:3], axis=0).mean()
        begun = self.start if nearer else there
        states, changes = follow(begun, self.lengths, self.mu, (2.0,), np.eye(6))
        return states[..., 0] - begun, changes[..., 0]

    @property
    def half_period(self) -> Any:
        """Time to the other point of Fix(R)."""
        return self._half[0][_TIME]

    @property
    def gap(self) -> float:
        """By how much the orbits do not close, and do not meet Fix(R) halfway."""
        return float(max(np.abs(self._whole[0][:6]).max(), np.abs(self._half[0][[_Y, _VX, _VZ]]).max()))

    def minors(self, coordinates: Sequence[int]) -> Any:
        """a_1, .., a_n: the multipliers are 1, 1 and lambda_i, 1/lambda_i with lambda_i + 1/lambda_i = 2 c_i."""
        rows = [_X, _Y, _VX, _VY] if coordinates == PLANAR else range(6)
        matrix = np.moveaxis(self._whole[1], -1, 0)[:, rows][:, :, rows]
        trace = (np.trace(matrix, axis1=1, axis2=2) - 2) / 2
        if coordinates == PLANAR:
            return np.array([trace])
        squares = (np.trace(matrix @ matrix, axis1=1, axis2=2) + 2) / 4
        return np.array([trace, (trace**2 - squares) / 2])

    def first_factor(self, coordinates: Sequence[int]) -> Any:
        """The determinant of the derivative of the half return within Fix(R)."""
        state, changes = self._half
        velocity = rates(state, self.mu, np.zeros((6, 0, state.shape[1])))[0][:6]
        on_section = changes - velocity[:, None] * (changes[_Y] / velocity[_Y])
        return np.linalg.det(np.moveaxis(on_section[np.ix_(coordinates, coordinates)], -1, 0))

    @property
    def across(self) -> Any:
        """V_11, V_12, V_21, V_22 of (z, vz) after half an orbit."""
        return self._half[1][np.ix_((_Z, _VZ), (_Z, _VZ))].reshape(4, -1)

    @cached_property
    def distances(self) -> Any:
        """From the smaller primary: least and greatest, at this and at the other point; shape (4, N)."""
        shares = (1 - np.cos(np.pi * np.arange(_ALONG) / (_ALONG - 1))) / 2
        states, _ = follow(self.start, self.lengths, self.mu, shares, np.zeros((6, 0)))
        squares = states[_X] ** 2 + states[_Y] ** 2 + states[_Z] ** 2
        rows = [[_extreme(shares, row), -_extreme(shares, -row), row[0], row[-1]] for row in squares]
        return np.sqrt(np.array(rows).T)


def _extreme(shares: Any, values: Any) -> float:
    """The least value, by the parabola through three of them if it is not at an end."""
    number = int(np.argmin(values))
    if number in (0, len(values) - 1):
        return float(values[number])
    three = slice(number - 1, number + 2)
    a, b, c = np.polyfit(shares[three] - shares[number], values[three], 2)
    return float(c - b * b / (4 * a))


@dataclass(frozen=True)
class Problem:
    """How coordinates of a piece are coordinates of Fix(R).

    Attributes:
        mass: mu.
        libration_point: its distance from the smaller primary, for planar orbits in units of their size; else `None`.
        is_planar: whether orbits are in the plane.
    """

    mass: Fraction
    libration_point: float | None = None
    is_planar: bool = False

    @property
    def mu(self) -> float:
        """The same, rounded."""
        return float(self.mass)

    @property
    def origin(self) -> tuple[Fraction, ...]:
        """Coordinates of a piece that are 0 here: digits of the distance from the smaller primary are not lost."""
        others = (Fraction(0),) * (len(self.coordinates) - 1)
        return (1 - self.mass if self.libration_point is None else Fraction(0), *others)

    @property
    def coordinates(self) -> tuple[int, ...]:
        """Of the state."""
        return PLANAR if self.is_planar else SPATIAL

    @property
    def kernel(self) -> tuple[int, ...]:
        """Coordinates that R negates, but y."""
        return (_VX,) if self.is_planar else (_VX, _VZ)

    def start(self, points: Any) -> tuple[Any, Any]:
        """States, shape (7, N), and their derivatives by the coordinates, shape (6, 1 + n, N)."""
        number = points.shape[1]
        state, columns = np.zeros((7, number)), np.zeros((6, len(points), number))
        if self.libration_point is None:
            state[list(self.coordinates)] = points
            columns[self.coordinates, range(len(points))] = 1
            return state, columns
        size, speed = points
        state[_X], state[_VY] = self.libration_point + size, size * speed
        columns[_X, 0], columns[_VY, 0], columns[_VY, 1] = 1, speed, size
        return state, columns

    def lengths(self, points: Any, along: Any) -> Any:
        """Of the half orbits to the next crossing of y = 0, about; seven of them are followed.

        `along`: increasing numbers, of which lengths are taken to be functions.
        """
        start, _ = self.start(points)
        chosen = np.unique(np.linspace(0, len(along) - 1, 7).round().astype(int))
        found = []
        for number in chosen:
            begun = start[:, number]

            def crossing(_: float, state: Any) -> Any:
                return state[_Y]

            crossing.terminal, crossing.direction = True, -np.sign(begun[_VY])  # type: ignore[attr-defined]

            def field(_: float, state: Any) -> Any:
                return rates(state[:, None], self.mu, np.zeros((6, 0, 1)))[0][:, 0]

            run = solve_ivp(field, (0, 1000), begun, "DOP853", events=crossing, rtol=1e-10, atol=1e-12)
            found.append(run.t_events[0][0])
        return np.polynomial.Polynomial.fit(along[chosen], found, len(chosen) - 1)(along)

    def on_curve(self, piece: Piece, s: Any) -> Orbits:
        """The orbits of a piece, by Newton's method from its polynomial; s increasing, of shape (N,)."""
        frame = np.array(piece.frame, dtype=float)
        exact = (zip(piece.point(Fraction(x)), self.origin, strict=True) for x in s)
        points = np.array([[float(value - origin) for value, origin in point] for point in exact]).T
        lengths = self.lengths(points, s)
        for _ in range(6):
            start, columns = self.start(points)
            # All of the derivatives, as those of the start differ from orbit to orbit.
            states, changes = follow(start, lengths, self.mu, (1.0,), np.eye(6))
            state = states[..., 0]
            velocity = rates(state, self.mu, np.zeros((6, 0, len(s))))[0]
            across = np.einsum("abN,bcN,cd->Nad", changes[..., 0], columns, frame[:, 1:])
            rows = [_Y, *self.kernel]
            matrix = np.concatenate([across[:, rows], velocity[rows].T[:, :, None]], axis=2)
            step = np.linalg.solve(matrix, -state[rows].T[:, :, None])[:, :, 0].T
            points = points + frame[:, 1:] @ step[:-1]
            lengths = lengths + step[-1]
            if np.abs(step).max() < 1e-8:
                return Orbits(points, self.start(points)[0], lengths, self.mu)
        raise AssertionError("Newton's method does not converge")


def problem_of(atlas: Atlas) -> Problem:
    """That of an atlas of orbits in space, or of planar ones, around L1 in units of their size."""
    mass = atlas.parameters["mu"]
    mu = float(mass)
    if atlas.system.name in ("cr3bp", "cr3bp-planar"):
        return Problem(mass, is_planar=atlas.system.name == "cr3bp-planar")
    assert atlas.system.name == "cr3bp-l1"

    def force(x: float) -> float:
        return x + 1 - mu - (1 - mu) / (x + 1) ** 2 + mu / x**2

    return Problem(mass, brentq(force, -0.5, -1e-6, xtol=1e-16, rtol=1e-15), is_planar=True)


@dataclass(frozen=True)
class Stretch:
    """The part of a piece that a curve runs through: places from `first` to `last`, place = s + shift."""

    piece: Piece
    first: float
    last: float
    shift: float


@dataclass(frozen=True)
class Numbers:
    """Functions along a curve of proved pieces."""

    problem: Problem
    stretches: tuple[Stretch, ...]

    @cached_property
    def _nodes(self) -> list[Orbits]:
        """Orbits of each piece."""
        return [self.problem.on_curve(stretch.piece, chebyshev.chebpts1(_NODES)) for stretch in self.stretches]

    @property
    def gap(self) -> float:
        """By how much the orbits that are interpolated do not close."""
        return max(orbits.gap for orbits in self._nodes)

    @cached_property
    def _coefficients(self) -> list[Any]:
        return [interpolated(self.functions(orbits)) for orbits in self._nodes]

    def functions(self, orbits: Orbits) -> Any:
        """Coordinates, a_1, .., a_n, first factor, level, half period, Jacobi constant, V; shape (.., N)."""
        constant = jacobi_constant(orbits.start, self.problem.mu)
        level = constant if self.problem.libration_point is None else orbits.points[0]
        chosen = self.problem.coordinates
        single = [orbits.first_factor(chosen), level, orbits.half_period, constant]
        origin = np.array(self.problem.origin, dtype=float)[:, None]
        return np.concatenate([orbits.points + origin, orbits.minors(chosen), single, orbits.across])

    def _on_stretches(self, places: Any, function: Callable[[int, Any], Any]) -> Any:
        """A function of stretch and increasing s at places of any shape."""
        flat = np.asarray(places, dtype=float).ravel()
        number = np.searchsorted([stretch.last for stretch in self.stretches[:-1]], flat)
        found = []
        for n in np.unique(number):
            s = flat[number == n] - self.stretches[n].shift
            order = np.argsort(s)
            found.append((np.flatnonzero(number == n)[order], function(n, s[order])))
        result = np.empty((len(found[0][1]), flat.size))
        for here, values in found:
            result[:, here] = values
        return result.reshape(-1, *np.shape(places))

    def values(self, places: Any) -> Any:
        """All functions, by interpolation."""
        return self._on_stretches(places, lambda n, s: chebyshev.chebval(s, self._coefficients[n]))

    def distances(self, places: Any) -> Any:
        """As in `Orbits`."""
        return self._on_stretches(places, lambda n, s: self._orbits(n, s).distances)

    def _orbits(self, number: int, s: Any) -> Orbits:
        return self.problem.on_curve(self.stretches[number].piece, s)

    def place(self, piece: str, s: float) -> float:
        """Of s on a piece."""
        (found,) = [stretch for stretch in self.stretches if stretch.piece.id == piece]
        return s + found.shift

    def curve(self, symmetric: Sequence[float] = ()) -> KnownCurve:
        """All that a list may speak of; `symmetric` as there."""
        first, last = self.stretches[0], self.stretches[-1]
        n = len(self.problem.coordinates) - 1
        ends = (1 + n, 1 + 2 * n)
        return KnownCurve(
            n,
            first.first,
            last.last,
            self.place,
            lambda places: self.values(places)[: ends[0]],
            lambda places: self.values(places)[ends[0] : ends[1]],
            *(lambda places, row=row: self.values(places)[ends[1] + row] for row in range(3)),
            tuple(symmetric),
            jacobi_constant=lambda places: self.values(places)[ends[1] + 3],
            across=(lambda places: self.values(places)[ends[1] + 4 :]) if self.problem.is_planar else None,
            distances=self.distances if self.problem.libration_point is None else None,
            grid_size=_GRID * len(self.stretches),
        )


def numbers(atlas: Atlas, stretches: Sequence[Mapping[str, str]]) -> Numbers:
    """Along the stretches of a conclusion: the pieces that the curve runs through, and where it leaves them."""
    pieces, problem = {piece.id: piece for piece in atlas.curve_pieces()}, problem_of(atlas)
    found: list[Stretch] = []
    for entry in stretches:
        piece, leaves = pieces[entry["piece"]], float(parse_exact(entry["leaves"]))
        enters, first = float(parse_exact(entry["enters"])), 0.0
        if found:
            before = found[-1]
            orbit = problem.on_curve(before.piece, np.array([before.last - before.shift]))
            along = np.linalg.inv(np.array(piece.frame, dtype=float))[0]
            away = [float(c - origin) for c, origin in zip(piece.centre, problem.origin, strict=True)]
            moved = orbit.points[:, 0] - np.array(away)
            enters, first = float(along @ moved) / float(piece.half_width), before.last
        found.append(Stretch(piece, first, first + leaves - enters, first - enters))
    return Numbers(problem, tuple(found))
