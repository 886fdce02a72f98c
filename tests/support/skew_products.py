"""Skew products over the Duffing oscillator x'' = -x - x^3: families of symmetric orbits with known stability.

The orbit of (A, 0) is A cn(omega t, m) with omega^2 = 1 + A^2 and m = A^2/(2 omega^2), and its half period is
2 K(m)/omega. Over it y'' = - (K_0 + K_1 x + K_2 x^2) F(y, E), E = x'^2/2 + x^2/2 + x^4/4: where F(y, E) = 0 with
x' = 0, y rests, and the points (A, y) are a curve of symmetric orbits that is known in closed form. Variations at fixed
E obey a linear equation over the base, integrated here by a method that shares nothing with the code under test.

Two curves: the line y = 0 (F = y; n = 1, 2, 3, the matrices K_i symmetric or not), and an ellipse
y_1^2 + (E - E_0)^2/a^2 = r^2 with folds of E at y_1 = 0; multiplied by y_1 it breaks the symmetry y_1 -> -y_1 there.
So that this is one for n = 2 and n = 3 too, what couples y_1 to the others is multiplied by y_1 once more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from orbitproof.shared.claims import Atlas, Claim, Piece
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.shared.systems.system import VectorField

_NODES = 160
_POINTS = chebyshev.chebpts1(_NODES)
"""Of Chebyshev interpolation along a curve."""


def interpolated(values: Any) -> Any:
    """Chebyshev coefficients, the first axis, of functions from values at as many Chebyshev points, the last axis."""
    number = values.shape[-1]
    table = chebyshev.chebvander(chebyshev.chebpts1(number), number - 1)
    coefficients = table.T @ np.moveaxis(values, -1, 0).reshape(number, -1) * 2 / number
    coefficients[0] /= 2
    return coefficients.reshape(number, *values.shape[:-1])


def energy(amplitude: Any) -> Any:
    """E of the orbit that starts at rest."""
    return amplitude**2 / 2 + amplitude**4 / 4


def half_period(amplitude: Any) -> Any:
    """From rest to rest."""
    return 2 * ellipk(amplitude**2 / (2 + 2 * amplitude**2)) / np.sqrt(1 + amplitude**2)


def position(amplitude: Any, time: Any) -> Any:
    """x at a time after rest."""
    return amplitude * ellipj(np.sqrt(1 + amplitude**2) * time, amplitude**2 / (2 + 2 * amplitude**2))[1]


@dataclass(frozen=True)
class SkewProduct:
    """A system and a curve of its symmetric orbits.

    Attributes:
        name: of the system.
        stiffness: K_0, K_1, K_2, each n x n.
        ellipse: E_0, a, r; `None` for the line y = 0.
        breaks: whether the ellipse meets the line y = 0, which y -> -y fixes.
        begin, end: of the parameter of the curve: A on the line; on the ellipse the angle.
        across: g_0, g_1, g_2 of z'' = - (g_0 + g_1 x + g_2 x^2) z, variations out of a plane that all this is in.
        body: c and kappa of the distance whose square is (x - c)^2 + kappa x'^2 + y_1^2 + .. + y_n^2.
    """

    name: str
    stiffness: tuple[tuple[tuple[Fraction, ...], ...], ...]
    begin: float
    end: float
    ellipse: tuple[Fraction, Fraction, Fraction] | None = None
    breaks: bool = False
    across: tuple[Fraction, Fraction, Fraction] | None = None
    body: tuple[Fraction, Fraction] | None = None

    @property
    def size(self) -> int:
        """n."""
        return len(self.stiffness[0])

    @cached_property
    def system(self) -> ReversibleSystem:
        """The equations."""
        n = self.size
        names = [f"y{i}" for i in range(1, n + 1)]

        def field(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
            x, v, y, w = state[0], state[1], list(state[2 : 2 + n]), list(state[2 + n :])
            square = x * x
            if self.ellipse is not None:
                centre, length, radius = self.ellipse
                level = (v * v / 2 + square / 2 + square * square / 4 - centre) / length
                y[0], first = y[0] * y[0] + level * level - radius * radius, y[0]
                if self.breaks:
                    y[0] = y[0] * first
            forces = []
            for i, rows in enumerate(zip(*self.stiffness, strict=True)):
                pulls = [
                    (zero + one * x + two * square)
                    * (value * state[2] if self.breaks and (i == 0) != (j == 0) else value)
                    for j, (zero, one, two, value) in enumerate(zip(*rows, y, strict=True))
                ]
                forces.append(-sum(pulls[1:], pulls[0]))
            return (v, -x - square * x, *w, *forces)

        return ReversibleSystem(
            name=self.name,
            title="a skew product over the Duffing oscillator",
            state=("x", "v", *names, *(f"w{i}" for i in range(1, n + 1))),
            parameters={},
            vector_field=field,
            reversing_symmetry=(1, -1, *[1] * n, *[-1] * n),
            symmetries=self._symmetries,
            section="v",
            first_integral=lambda s, _: (s[1] * s[1] / 2 + s[0] * s[0] / 2 + s[0] * s[0] * s[0] * s[0] / 4,),
            first_integral_name="energy",
            stiffness_across=self._stiffness_across,
            squared_distance=self._squared_distance,
            distance_name="the body" if self.body else None,
        )

    @property
    def _stiffness_across(self) -> VectorField | None:
        if self.across is None:
            return None
        zero, one, two = self.across
        return lambda state, _: (zero + one * state[0] + two * (state[0] * state[0]),)

    @property
    def _squared_distance(self) -> VectorField | None:
        if self.body is None:
            return None
        centre, share = self.body

        def square(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
            along, v, y = state[0] - centre, state[1], state[2 : 2 + self.size]
            return (sum((value * value for value in y), along * along + share * (v * v)),)

        return square

    @property
    def _symmetries(self) -> dict[str, tuple[int, ...]]:
        if self.breaks:
            return {"S": (1, 1, *[-1, *[1] * (self.size - 1)] * 2)}
        return {"S": (1, 1, *[-1] * 2 * self.size)} if self.ellipse is None else {}

    # The curve

    def amplitude(self, place: Any) -> Any:
        """A at a place of the curve."""
        if self.ellipse is None:
            return place
        centre, length, radius = map(float, self.ellipse)
        level = centre + length * radius * np.cos(place)
        return np.sqrt(np.sqrt(1 + 4 * level) - 1)

    def point(self, place: Any) -> Any:
        """(A, y_1, .., y_n) at places of the curve; shape (1 + n, ..)."""
        place = np.asarray(place, dtype=float)
        rest = np.zeros((self.size, *place.shape))
        if self.ellipse is not None:
            rest[0] = float(self.ellipse[2]) * np.sin(place)
        return np.concatenate([self.amplitude(place)[None], rest])

    def place(self, point: Sequence[float]) -> float:
        """Where on the curve a point of it is."""
        if self.ellipse is None:
            return point[0]
        centre, length, _ = map(float, self.ellipse)
        angle = np.arctan2(point[1], (energy(point[0]) - centre) / length)
        return float(angle + 2 * np.pi * round((((self.begin + self.end) / 2) - angle) / (2 * np.pi)))

    @property
    def _middle(self) -> float:
        return (self.begin + self.end) / 2

    @property
    def _reach(self) -> float:
        """A little more than the curve: pieces overlap its ends."""
        return (self.end - self.begin) * 0.65

    # The stability, independently

    def _factors(self, place: Any) -> Any:
        """What K is multiplied by for the derivatives of the forces at places of the curve; shape (n, n, ..)."""
        factors = np.ones((self.size, self.size, *np.shape(place)))
        if self.ellipse is not None:
            y = float(self.ellipse[2]) * np.sin(place)
            factors[:, 0] = 2 * y * y if self.breaks else 2 * y
            if self.breaks:
                factors[0, 1:] *= y
                factors[1:, 0] *= y
        return factors

    @cached_property
    def _blocks(self) -> tuple[Any, Any]:
        """Chebyshev coefficients of the derivatives of (y, w) with respect to y, after one and two half periods."""
        places = self._middle + self._reach * _POINTS
        amplitudes, factors, n = self.amplitude(places), self._factors(places), self.size
        zero, one, two = np.array(self.stiffness, dtype=float)
        times = half_period(amplitudes)

        def field(time: float, flat: Any) -> Any:
            y, w = flat.reshape(2, n, n, _NODES)
            x = position(amplitudes, time * times)
            matrix = zero[:, :, None] + one[:, :, None] * x + two[:, :, None] * x * x
            return np.array([w, -np.einsum("ijm,jkm->ikm", matrix * factors, y)]).ravel() * np.tile(times, 2 * n * n)

        start = np.zeros((2, n, n, _NODES))
        start[0, range(n), range(n)] = 1
        found = solve_ivp(field, (0, 2), start.ravel(), "DOP853", (1.0, 2.0), rtol=1e-13, atol=1e-14)
        half, whole = np.moveaxis(found.y.reshape(2, n, n, _NODES, 2), -1, 0)
        return interpolated(half), interpolated(whole[0])

    @cached_property
    def _variations(self) -> Any:
        """Chebyshev coefficients of V_11, V_12, V_21, V_22 of variations out of the plane."""
        assert self.across is not None
        amplitudes = self.amplitude(self._middle + self._reach * _POINTS)
        zero, one, two = map(float, self.across)
        times = half_period(amplitudes)

        def field(time: float, flat: Any) -> Any:
            z, w = flat.reshape(2, 2, _NODES)
            x = position(amplitudes, time * times)
            return (np.array([w, -(zero + one * x + two * x * x) * z]) * times).ravel()

        start = np.repeat(np.eye(2).ravel(), _NODES)
        found = solve_ivp(field, (0, 1), start, "DOP853", (1.0,), rtol=1e-13, atol=1e-14)
        return interpolated(found.y.reshape(4, _NODES))

    def variations(self, places: Any) -> Any:
        """V_11, V_12, V_21, V_22 at places of the curve; shape (4, ..)."""
        return chebyshev.chebval((np.asarray(places) - self._middle) / self._reach, self._variations)

    def distances(self, places: Any) -> Any:
        """Of the body, least and greatest, at rest with x = A and with x = -A, on the line; shape (4, ..).

        With E the square is a polynomial in x from -A to A.
        """
        assert self.body is not None
        centre, share = map(float, self.body)
        amplitudes = np.asarray(self.amplitude(places), dtype=float)
        turns = np.roots([-2 * share, 0, 2 - 2 * share, -2 * centre] if share else [2, -2 * centre])
        turns = turns.real[np.abs(turns.imag) < 1e-12]
        candidates = np.stack([amplitudes, -amplitudes, *(np.clip(turn, -amplitudes, amplitudes) for turn in turns)])
        squares = (candidates - centre) ** 2 + share * 2 * (energy(amplitudes) - energy(candidates))
        return np.sqrt(np.abs([squares.min(axis=0), squares.max(axis=0), squares[0], squares[1]]))

    def _values(self, coefficients: Any, places: Any) -> Any:
        scaled = (np.asarray(places) - self._middle) / self._reach
        return np.moveaxis(chebyshev.chebval(scaled, coefficients), (0, 1), (-2, -1))

    def sigma(self, places: Any) -> Any:
        """The stability matrix at places of the curve; shape (.., n, n)."""
        return self._values(self._blocks[1], places)

    def first_block(self, places: Any) -> Any:
        """dy/dy(0) after half a period: singular where the period doubles at this point of the orbit."""
        return self._values(self._blocks[0][:, 0], places)

    def kernel_block(self, places: Any) -> Any:
        """dw/dy(0) after half a period: singular where other symmetric orbits meet the curve."""
        return self._values(self._blocks[0][:, 1], places)

    # What is claimed

    def pieces(self, number: int, degree: int = 18, tube: Fraction = Fraction(1, 2**20)) -> tuple[Piece, ...]:
        """Pieces that cover the curve from `begin` to `end`."""
        ends = np.linspace(self.begin, self.end, number + 1)
        overlap = (ends[1] - ends[0]) / 16
        result = []
        for index in range(number):
            low, high, kind = ends[index] - overlap, ends[index + 1] + overlap, "regular"
            if self.breaks and index in (0, number - 1):
                centre = ends[0] if index == 0 else ends[-1]
                reach = ends[1] - ends[0] + overlap
                low, high, kind = centre - reach, centre + reach, "symmetric"
            result.append(self._piece(f"p{index:03}", kind, low, high, degree, tube))
        return tuple(result)

    def _piece(self, name: str, kind: str, low: float, high: float, degree: int, tube: Fraction) -> Piece:
        middle = (low + high) / 2
        centre = self.point(middle)
        along = (self.point(middle + 1e-6) - self.point(middle - 1e-6)) / 2e-6
        if kind == "symmetric":
            along[0], centre[1:] = 0, 0
        frame = np.linalg.qr(np.column_stack([along, np.eye(self.size + 1)]))[0]
        frame[:, 0] *= np.sign(frame[:, 0] @ along)
        frame = np.round(frame * 2**30) / 2**30
        ends = np.linalg.inv(frame) @ (self.point(np.array([low, high])) - centre[:, None])
        half_width = Fraction(float(np.float32(np.abs(ends[0]).max())))
        bare = Piece(
            name, kind, _exact(centre), tuple(map(_exact, frame)), half_width, (), (tube,) * self.size, "physical"
        )
        nodes = chebyshev.chebpts1(degree + 1)
        across = np.linalg.inv(frame) @ (self.point(self.places(bare, nodes)) - centre[:, None])
        rows = []
        for row in powers(interpolated(across[1:])).T:
            if kind == "symmetric":
                row[1::2] = 0
            rows.append(_exact(np.trim_zeros(np.where(np.abs(row) < 1e-13, 0, row), "b")) or (Fraction(0),))
        return replace(bare, polynomial=tuple(rows))

    def places(self, piece: Piece, s: Any) -> Any:
        """Where on the curve s of a piece is."""
        first = np.linalg.inv(np.array(piece.frame, dtype=float))[0]
        centre = np.array(piece.centre, dtype=float)
        width = float(piece.half_width)
        # About linear in s: by the secant method.
        middle = self.place(list(centre))
        value = lambda place: np.tensordot(first, self.point(place) - centre.reshape(-1, *[1] * np.ndim(place)), 1)  # noqa: E731
        rate = (value(middle + 1e-4) - value(middle - 1e-4)) / 2e-4
        here = middle + 0 * s
        after = middle + width * s / rate
        there = value(here) - width * s
        for _ in range(40):
            gap = value(after) - width * s
            step = np.where(np.abs(gap) > 1e-15, gap * (after - here) / np.where(gap == there, 1, gap - there), 0)
            here, there, after = after, gap, after - step
            if np.abs(step).max() < 1e-15 * (1 + np.abs(after).max()):
                break
        return after

    def atlas(self, number: int, degree: int = 18, tube: Fraction = Fraction(1, 2**20)) -> Atlas:
        """The claim."""
        closed = self.ellipse is not None and abs(self.end - self.begin - 2 * np.pi) < 1e-9
        claim = Claim("symmetric-loop", "S") if self.breaks else Claim("loop" if closed else "arc")
        return Atlas(self.name, "a skew product", self.system, {}, claim, self.pieces(number, degree, tube))


def _exact(values: Any) -> tuple[Fraction, ...]:
    return tuple(Fraction(float(value)) for value in values)


def powers(coefficients: Any) -> Any:
    """Coefficients of powers from those of Chebyshev polynomials, along the first axis."""
    flat = coefficients.reshape(len(coefficients), -1).T
    rows = [np.pad(row := chebyshev.cheb2poly(each), (0, len(coefficients) - len(row))) for each in flat]
    return np.array(rows).T.reshape(coefficients.shape)
