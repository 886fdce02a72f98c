"""Distances from a body along the orbits of an interval of a piece (section 20).

The half orbits that the stability matrix takes are looked at once more, for omega = 0: the orbits of the curve alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from math import comb, floor, lcm, log2

import numpy as np
from flint import arb

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import (
    Floats,
    Grading,
    PreparedProgram,
    Series,
    WideArithmetic,
    evaluate,
    inflate,
    prepare,
    total,
)
from orbitproof.verify.curve import BEYOND
from orbitproof.verify.distances.stored_distances import PARTS, SLACK, Bounds, DistanceFunctions, Extremes, Where
from orbitproof.verify.evidence import IntegrationFailure, NotKnown, enclose, is_positive, symmetric
from orbitproof.verify.flow import advance, dyadic_below
from orbitproof.verify.functions import StoredFunction, error_of, known_part, restricted
from orbitproof.verify.orbit import distance_rates
from orbitproof.verify.poincare import HalfOrbits, InTime, at_start

_GRID = 32
"""A step is divided into so many parts."""
_TIMES = tuple((Fraction(2 * number + 1, 2 * _GRID), Fraction(1, 2 * _GRID)) for number in range(_GRID))
_ACROSS = tuple((Fraction(2 * number + 1 - PARTS, PARTS) / BEYOND, 1 / BEYOND / PARTS) for number in range(PARTS))
"""Middles and radii of the cells in theta and sigma."""
_SHORTEST = 2.0**-20
"""Half the length at least of the step that leads beyond the other point on Fix(R)."""

Signs = list[list[int]]


@dataclass(frozen=True)
class _Step:
    """The orbits of the curve over one step, theta in [0, 1]: squared distance, state with constants of motion."""

    value: Series
    state: tuple[Series, ...]
    turning: PreparedProgram

    @cached_property
    def curvature(self) -> Signs:
        """Signs of the second derivative of the squared distance."""
        return Cells.of(evaluate(self.turning, self.state)[0]).signs


class DistanceAlongCurve:
    """The squared distance along the orbits from y(s) to x(s), step by step."""

    def __init__(self, returns: HalfOrbits, share: Fraction) -> None:
        """`share`: sigma = share tau."""
        self.returns, self.share = returns, share
        flow = returns.arithmetic
        assert isinstance(flow, WideArithmetic)
        self.arithmetic = WideArithmetic(Grading((1,), 0), flow.bits, 0, flow.degree, width=flow.width)
        program = distance_rates(returns.system, returns.coordinates)
        value, _, curvature = program.outputs
        self._value, self._turning = (prepare(replace(program, outputs=(output,))) for output in (value, curvature))
        self._constants = [self._on_curve(element) for element in returns.constants]
        self._states: list[tuple[Series, ...]] = []

    def cover(self) -> None:
        """The step that was taken last."""
        assert self.returns.step_taken is not None
        self._states.append(tuple(self._on_curve(element) for element in self.returns.step_taken[0].solution))

    def _on_curve(self, element: Series) -> Series:
        """A function of (theta, sigma, omega) at omega = 0: of higher grades nothing is there."""
        return Series(self.arithmetic, [element.coefs[0]], [element.errors[0], 0.0])

    def functions(
        self, system: ReversibleSystem, here: Sequence[Series], there: Sequence[Series]
    ) -> DistanceFunctions | NotKnown:
        """What is known of the distance, or why it is not.

        Args:
            here, there: state and parameters at x(s) and y(s), functions of sigma.
        """
        program = system.squared_distance_program
        assert program is not None
        try:
            self._states.append(self._beyond())
            start, end = (at_start(program, arguments)[0] for arguments in (there, here))
            parts = self._extremes([self._step(state) for state in self._states], start, end)
        except IntegrationFailure as failure:
            return NotKnown(failure.reason)
        at_ends = [StoredFunction.of(restricted(element, self.share)) for element in (end, start)]
        return DistanceFunctions(at_ends[0], at_ends[1], parts)

    def _step(self, state: Sequence[Series]) -> _Step:
        arguments = (*state, *self._constants)
        return _Step(evaluate(self._value, arguments)[0], arguments, self._turning)

    def _beyond(self) -> tuple[Series, ...]:
        """One more step, which ends after all orbits have come to x(s)."""
        returns = self.returns
        state, fixed = ([self._on_curve(element) for element in row] for row in (returns.state, returns.fixed))
        rate = self.arithmetic.constant(Fraction(1)) if returns.rate is None else self._on_curve(returns.rate)
        delay = self._on_curve(returns.delay)
        longest = max(float(_value(delay, part).upper() / _value(rate, part).lower()) for part in range(PARTS))
        length = dyadic_below(2 * max(longest, _SHORTEST))
        expansion = returns.oracle.expand(returns.program, self.arithmetic, state, fixed)
        step = advance(returns.program, state, fixed, expansion, length)
        if not all(is_positive(_value(rate.scaled(length) - delay, part)) for part in range(PARTS)):
            raise IntegrationFailure("stability", "the half periods differ too much", "give a narrower piece")
        return step.solution

    def _extremes(self, steps: Sequence[_Step], start: Series, end: Series) -> tuple[Extremes, ...]:
        cells = [Cells.of(step.value) for step in steps]
        inside = np.array([(cell.lower.min(axis=0), cell.upper.max(axis=0)) for cell in cells])
        at_times = np.array([(cell.upper_at_times.min(axis=0), cell.lower_at_times.max(axis=0)) for cell in cells])
        sides = [
            _Side.of(Where.HERE, steps, self._known(end), True),
            _Side.of(Where.THERE, steps, self._known(start), False),
        ]
        nearest, farthest = _taken(sides, 1), _taken(sides, -1)
        return tuple(
            Extremes(
                _outward(inside[:, 0, part].min(), at_times[:, 0, part].min()),
                _outward(at_times[:, 1, part].max(), inside[:, 1, part].max()),
                nearest[part],
                farthest[part],
            )
            for part in range(PARTS)
        )

    def _known(self, end: Series) -> Series:
        """A function of sigma as one of theta and sigma."""
        return self.arithmetic.polynomial({(0,): known_part(end, 0)}).widened(error_of(end))


@dataclass(frozen=True)
class _Side:
    """The cells of all steps, in their order from one end of the half orbits.

    Attributes:
        where: the point of Fix(R) at this end.
        steps: in this order.
        rows: of the cells of a step, in this order.
        away: signs of the distance less that at this end; shape (cells, parts).
    """

    where: Where
    steps: Sequence[_Step]
    rows: range
    away: Floats

    @classmethod
    def of(cls, where: Where, steps: Sequence[_Step], distance: Series, backwards: bool) -> _Side:
        """With the distance at this end, that of `x(s)` if `backwards`."""
        ordered = list(reversed(steps)) if backwards else steps
        rows = range(_GRID - 1, -1, -1) if backwards else range(_GRID)
        away = [np.array(Cells.of(step.value - distance).signs, dtype=float)[rows] for step in ordered]
        return cls(where, ordered, rows, np.concatenate(away))

    def has_extreme(self, part: int, sign: int) -> bool:
        """Whether the distance is least (sign 1) or greatest (-1) at this end of the orbits (Lemma 20.1)."""
        beside = 1 + int(np.flatnonzero(self.away[:, part] != sign).max(initial=0))
        # The second derivative is found for a step when it is asked for: few steps are.
        return beside < len(self.away) and all(self._curvature(cell)[part] == sign for cell in range(beside))

    def _curvature(self, cell: int) -> list[int]:
        step, row = divmod(cell, _GRID)
        return self.steps[step].curvature[self.rows[row]]


def _taken(sides: Sequence[_Side], sign: int) -> list[Where]:
    """At which end of the orbits the distance is least (sign 1) or greatest (-1), for each part."""
    return [next((side.where for side in sides if side.has_extreme(part, sign)), Where.ALONG) for part in range(PARTS)]


@dataclass(frozen=True)
class Cells:
    """Bounds of a function of theta and sigma on the cells of a grid, and at the middle times of these (section 20.2).

    All of shape (grid, parts).
    """

    lower: Floats
    upper: Floats
    lower_at_times: Floats
    upper_at_times: Floats

    @classmethod
    def of(cls, element: Series) -> Cells:
        """The cells of an element of the algebra in theta and sigma."""
        arithmetic = element.arithmetic
        assert isinstance(arithmetic, WideArithmetic)
        known = arithmetic.unpack(element.coefs[0], arithmetic.scales[0], arithmetic.degree + 1)
        in_time, across = _recentring(arithmetic.degree, _TIMES), _recentring(arithmetic.width, _ACROSS)
        local = (in_time @ known)[:, None] @ across.transpose(0, 2, 1)[None]
        # More than what is lost by rounding, of a recentring and of a sum of bounds (section 20.2).
        share = (known.size + 64) * 2.0**-52
        unknown = inflate(total([*element.errors, float(np.abs(known).sum()) * 2 * share]))
        sizes = np.abs(local)
        middle = local[:, :, 0, 0]
        at_times = sizes[:, :, 0, 1:].sum(axis=-1) + unknown
        radius = sizes[:, :, 1:].sum(axis=(-2, -1)) + at_times
        slack = 4 * share * (np.abs(middle) + radius)
        radius, at_times = radius + slack, at_times + slack
        return cls(middle - radius, middle + radius, middle - at_times, middle + at_times)

    @property
    def signs(self) -> Signs:
        """1 or -1 where the function has that sign on the cell, else 0."""
        found: Signs = ((self.lower > 0).astype(int) - (self.upper < 0).astype(int)).tolist()
        return found


@cache
def _recentring(degree: int, cells: tuple[tuple[Fraction, Fraction], ...]) -> Floats:
    """For each cell, middle m and radius r, the matrix that takes coefficients of x^k to those in (x - m)/r."""
    powers = range(degree + 1)
    rows = []
    for middle, radius in cells:
        below = lcm(middle.denominator, radius.denominator)
        m, r = int(middle * below), int(radius * below)
        rows.append([[comb(k, j) * m ** (k - j) * r**j / below**k if k >= j else 0.0 for k in powers] for j in powers])
    return np.array(rows)


def _value(element: Series, part: int) -> arb:
    """Encloses the values of a function of sigma on a part of the interval."""
    middle, radius = _ACROSS[part]
    return InTime(element, enclose(middle) + symmetric(radius)).value(arb(0))


def _outward(low: float, high: float) -> Bounds:
    """Weaker bounds of a square with few bits."""
    if not (np.isfinite(low) and np.isfinite(high)):
        raise IntegrationFailure("stability", "the distance is not enclosed", "give a narrower piece")
    below, above = max(Fraction(low), Fraction(0)), max(Fraction(high), Fraction(0))
    unit = Fraction(2) ** (floor(log2(above)) - 16) if above else Fraction(1)
    return (below * (1 - SLACK) // unit) * unit, -(-above * (1 + SLACK) // unit) * unit
