"""Reversible maps of the plane near a 1:k resonance of their fixed point, and what their portraits show.

The map is f(x, y) = (y, -x + 2 g(y)) with g(y) = c y + a y^2 + b y^3. It preserves area and is reversible:
R(x, y) = (y, x) satisfies R f R f = 1. The fixed point 0 has the multipliers exp(+-i theta) with
c = cos(theta), so that the resonance 1:k is at c = cos(2 pi/k).

Portraits are drawn in the coordinates (u, v) in which the linear part at the resonance is a rotation and
R is (u, v) -> (u, -v); Fix(R) is the line v = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi, sin, sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Line = Literal["R", "R f"]
"""The reversing symmetries whose fixed sets, lines here, meet the symmetric periodic orbits."""

_SAMPLES = 4001
_BISECTIONS = 60
_SAME = 1e-6
_LONGEST = 1000
_NEAR = 1e-5
_SPACING = 2e-3


@dataclass(frozen=True)
class ReversibleMap:
    """The map f(x, y) = (y, -x + 2 (c y + a y^2 + b y^3)); points are arrays of shape (.., 2)."""

    c: float
    a: float
    b: float

    def g(self, y: Array) -> Array:
        """g(y) = c y + a y^2 + b y^3."""
        return y * (self.c + y * (self.a + y * self.b))

    def slope(self, y: float) -> float:
        """g'(y)."""
        return self.c + y * (2 * self.a + 3 * self.b * y)

    def __call__(self, points: Array) -> Array:
        x, y = points[..., 0], points[..., 1]
        return np.stack([y, 2 * self.g(y) - x], axis=-1)

    def power(self, points: Array, k: int) -> Array:
        """f^k, k >= 0."""
        for _ in range(k):
            points = self(points)
        return points

    def iterates(self, point: Array, count: int, radius: float) -> Array:
        """point, f(point), .. as long as they stay within `radius` of 0, at most `count` points."""
        x, y = map(float, point)
        rows = [(x, y)]
        while len(rows) < count:
            x, y = y, 2 * y * (self.c + y * (self.a + y * self.b)) - x
            if not x * x + y * y <= radius * radius:
                break
            rows.append((x, y))
        return np.array(rows)

    def derivative(self, point: Array, k: int) -> Array:
        """Derivative of f^k at a point, shape (2, 2)."""
        result = np.eye(2)
        for _ in range(k):
            result = np.array([[0.0, 1.0], [-1.0, 2 * self.slope(float(point[1]))]]) @ result
            point = self(point)
        return result

    def on_line(self, line: Line, t: Array) -> Array:
        """Points of Fix(R) (x = y = t) or of Fix(R f) (y = t, x = g(t)), shape t.shape + (2,)."""
        return np.stack([t if line == "R" else self.g(t), t], axis=-1)

    def off_line(self, line: Line, points: Array) -> Array:
        """A function of the plane that vanishes exactly on the line."""
        x, y = points[..., 0], points[..., 1]
        return x - (y if line == "R" else self.g(y))


@dataclass(frozen=True)
class PeriodicOrbit:
    """A symmetric periodic orbit.

    Attributes:
        points: shape (k, 2), an orbit of principal period k.
        line: the fixed line on which its first point lies.
        trace: of Df^k: between -2 and 2 for an elliptic orbit, beyond for a hyperbolic one.
    """

    points: Array
    line: Line
    trace: float

    @property
    def elliptic(self) -> bool:
        """Whether the multipliers lie on the unit circle."""
        return abs(self.trace) < 2


def symmetric_periodic_orbits(mapping: ReversibleMap, k: int, extent: float) -> list[PeriodicOrbit]:
    """The symmetric orbits of principal period k whose first point has |t| <= `extent` on a fixed line.

    A point of the line of an involution T has period k exactly if, for even k, its iterate number k/2 lies on
    that line again, and for odd k = 2m + 1 its iterate number m or m + 1 lies on the other line.
    """
    lines: tuple[Line, ...] = ("R", "R f") if k % 2 == 0 else ("R",)
    found: list[PeriodicOrbit] = []
    for line in lines:
        half, target = (k // 2, line) if k % 2 == 0 else ((k - 1) // 2, "R f")

        def miss(t: Array, line: Line = line, half: int = half, target: Line = target) -> Array:
            return mapping.off_line(target, mapping.power(mapping.on_line(line, t), half))

        grid = np.linspace(-extent, extent, _SAMPLES)
        values = miss(grid)
        for i in np.flatnonzero(values[:-1] * values[1:] < 0):
            low, high = grid[i], grid[i + 1]
            for _ in range(_BISECTIONS):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if miss(middle) * values[i] > 0 else (low, middle)
            orbit = _orbit(mapping, mapping.on_line(line, np.asarray(0.5 * (low + high))), k, line)
            if orbit is not None and not any(_same(orbit, other) for other in found):
                found.append(orbit)
    return found


def _orbit(mapping: ReversibleMap, point: Array, k: int, line: Line) -> PeriodicOrbit | None:
    """The orbit of a point of period k, unless k is not its principal period."""
    points = np.array([mapping.power(point, i) for i in range(k)])
    if any(np.linalg.norm(row - point) < _SAME for row in points[1:]):
        return None
    return PeriodicOrbit(points, line, float(np.trace(mapping.derivative(point, k))))


def _same(one: PeriodicOrbit, other: PeriodicOrbit) -> bool:
    return bool(np.linalg.norm(other.points - one.points[0], axis=1).min() < _SAME)


def unstable_manifold(mapping: ReversibleMap, orbit: PeriodicOrbit, radius: float, length: float) -> list[Array]:
    """The two branches of the unstable manifold of each point of a hyperbolic orbit.

    A fundamental segment along the eigenvector is iterated; each branch, shape (N, 2), ends after `length`
    or where it leaves the disc of `radius`. The stable manifold is its image under R.
    """
    k = len(orbit.points)
    branches = []
    for point in orbit.points:
        values, vectors = np.linalg.eig(mapping.derivative(point, k))
        i = int(np.argmax(np.abs(values)))
        multiplier, direction = float(values[i].real), vectors[:, i].real
        # A branch of a negative multiplier returns to itself after two iterations only.
        repeat = 1 if multiplier > 0 else 2
        factor = abs(multiplier) ** repeat
        steps = np.geomspace(_NEAR, _NEAR * factor, max(4, int(40 * np.log(factor))), endpoint=False)
        for sign in (1.0, -1.0):
            branches.append(_branch(mapping, point + sign * steps[:, None] * direction, k * repeat, radius, length))
    return [branch for branch in branches if len(branch) > 1]


def _branch(mapping: ReversibleMap, segment: Array, k: int, radius: float, length: float) -> Array:
    rows: list[Array] = []
    total, last = 0.0, segment[0]
    while True:
        for row in segment:
            total += float(np.linalg.norm(row - last))
            if not np.hypot(*row) <= radius or total > length:
                return np.array(rows)
            if not rows or np.linalg.norm(row - rows[-1]) > _SPACING * radius:
                rows.append(row)
            last = row
        segment = mapping.power(segment, k)


@dataclass(frozen=True)
class Resonance:
    """A resonance 1:k with the nonlinear terms for which its portrait is made.

    Attributes:
        k: multiplicity.
        a, b: coefficients of y^2 and y^3.
        sign: the new orbits exist (k = 4), or pass the fixed point, as sign * (c - cos(2 pi/k)) grows.
    """

    k: int
    a: float
    b: float
    sign: int

    @cached_property
    def frame(self) -> Array:
        """Shape (2, 2): (u, v) = frame (x, y); the linear part of f at the resonance becomes a rotation."""
        half = pi / self.k
        return np.array([[0.5 / cos(half), 0.5 / cos(half)], [0.5 / sin(half), -0.5 / sin(half)]])

    def at(self, distance: float) -> ReversibleMap:
        """The map at the unfolding parameter `distance` = sign * (c - cos(2 pi/k))."""
        return ReversibleMap(cos(2 * pi / self.k) + self.sign * distance, self.a, self.b)


QUADRUPLING = Resonance(4, 0.0, 1.0, -1)
"""Period quadrupling: an elliptic and a hyperbolic orbit of period 4 appear at distance sqrt(nu) from 0."""

TOUCH_AND_GO = Resonance(3, 1.0, 0.0, 1)
"""Third-order touch-and-go: a hyperbolic orbit of period 3 passes through 0 as nu changes its sign."""


@dataclass(frozen=True)
class Portrait:
    """The phase portrait of one map, in the coordinates (u, v).

    Attributes:
        k: resonance.
        parameter: the unfolding parameter nu; 0 at the resonance.
        map: the map.
        window: half-width of the square that is shown.
        orbits: of bounded orbits, the points inside the square, arrays of shape (N, 2).
        curves: invariant curves through orbits that leave, arrays of shape (N, 2).
        manifolds: of hyperbolic periodic orbits, stable and unstable, arrays of shape (N, 2).
        periodic: the symmetric orbits of period k, in (u, v).
    """

    k: int
    parameter: float
    map: ReversibleMap
    window: float
    orbits: tuple[Array, ...]
    curves: tuple[Array, ...]
    manifolds: tuple[Array, ...]
    periodic: tuple[PeriodicOrbit, ...]


def portrait(resonance: Resonance, parameter: float, window: float, orbits: int, iterates: int) -> Portrait:
    """The portrait at one value of the unfolding parameter.

    Arguments:
        window: half-width of the square that is shown, in (u, v).
        orbits: how many start on each half of Fix(R), and as many in the middle of the sector above it.
        iterates: of each orbit, forward; the backward half is an image under R.
    """
    k, frame = resonance.k, resonance.frame
    mapping, inverse = resonance.at(parameter), np.linalg.inv(frame)
    radius = 2.0 * window * float(np.linalg.norm(inverse, 2))
    mirror = np.array([1.0, -1.0])
    dots: list[Array] = []
    curves: list[Array] = []
    for angle in (0.0, pi, pi / k):
        direction = np.array([cos(angle), sin(angle)])
        for i in range(orbits):
            start = inverse @ (window * sqrt(2.0) * (i + 0.5) / orbits * direction)
            # The image under R of a forward orbit is a backward orbit: of the same point if that lies on
            # Fix(R), else of its image, which belongs to the portrait as well.
            for point in [start] if angle % pi == 0 else [start, start[::-1]]:
                rows = mapping.iterates(point, iterates, radius)
                if len(rows) == iterates:
                    rows = np.vstack([rows, rows[1:, ::-1]]) @ frame.T
                    dots.append(rows[np.abs(rows).max(axis=1) <= 1.05 * window])
                else:
                    shown = [curve @ frame.T for curve in _invariant_curves(mapping, point, k, radius)]
                    curves += [line for curve in shown for line in (curve, curve * mirror)]
    periodic = symmetric_periodic_orbits(mapping, k, 3.0 * window)
    shown_periodic = [PeriodicOrbit(orbit.points @ frame.T, orbit.line, orbit.trace) for orbit in periodic]
    # Orbits far outside the square are no part of the resonance.
    near = [i for i, orbit in enumerate(shown_periodic) if np.abs(orbit.points).max() <= window]
    manifolds: list[Array] = []
    for i in near:
        if not periodic[i].elliptic:
            for branch in unstable_manifold(mapping, periodic[i], radius, 2.4 * window):
                shown = branch @ frame.T
                manifolds += [shown, shown * mirror]
    return Portrait(
        k,
        parameter,
        mapping,
        window,
        tuple(rows for rows in dots if len(rows)),
        tuple(curves),
        tuple(manifolds),
        tuple(shown_periodic[i] for i in near),
    )


def _invariant_curves(mapping: ReversibleMap, start: Array, k: int, radius: float) -> list[Array]:
    """k curves through an orbit that leaves the disc of `radius`: the iterates of an arc to its k-th point.

    Close to the resonance f^k is close to the flow of a Hamiltonian, and the arc to a line of that flow.
    """
    following = mapping.power(start, k)
    # The map's inverse is R f R; the four points give the arc its bend.
    before = mapping.power(start[::-1], k)[::-1]
    arc = _cubic_arc(before, start, following, mapping.power(following, k))
    # Begun early enough that the image under R of each curve joins it.
    segment = mapping.power(arc[:, ::-1], k - 1)[:, ::-1]
    pieces: list[list[Array]] = [[] for _ in range(k)]
    for i in range(_LONGEST * k):
        if not np.hypot(*segment[-1]) <= radius:
            break
        pieces[i % k].append(segment[:-1])
        segment = mapping(segment)
    return [np.vstack(piece) for piece in pieces if len(piece) > 1]


def _cubic_arc(before: Array, start: Array, end: Array, beyond: Array) -> Array:
    """The part from `start` to `end` of the cubic through four points at the times -1, 0, 1, 2; 9 rows."""
    t = np.linspace(0.0, 1.0, 9)[:, None]
    return np.asarray(
        -t * (t - 1) * (t - 2) / 6 * before
        + (t + 1) * (t - 1) * (t - 2) / 2 * start
        - (t + 1) * t * (t - 2) / 2 * end
        + (t + 1) * t * (t - 1) / 6 * beyond
    )
