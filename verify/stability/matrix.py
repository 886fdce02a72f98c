"""The stability matrix along a proved interval of a piece (section 18.3).

The flow of the tube is followed to its second return: its derivative across the curve, modulo the direction of the
curve, is the stability matrix Sigma(s) of the orbits. The proof of the piece has followed it to the first one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from math import ceil, floor, log2

import numpy as np
from flint import arb, fmpq, fmpq_mat
from numpy.polynomial.polynomial import polyval

from orbitproof.shared.formats import Piece
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Floats, Grading, Series, WideArithmetic, recentred
from orbitproof.verify.curve import (
    BEYOND,
    HalfReturn,
    Interval,
    PieceLimits,
    about_pieces,
    broken_off,
    divided_by_wide,
    parameter_series,
    tube_points,
)
from orbitproof.verify.distances import distance_along
from orbitproof.verify.evidence import IntegrationFailure, NotKnown, guarded, is_inside
from orbitproof.verify.functions import (
    bounded,
    determinant,
    error_of,
    function,
    inverse,
    known_part,
    norm_of,
    restricted,
    slope,
)
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.poincare import (
    PHYSICAL,
    REGULARISED,
    HalfOrbits,
    WideOracle,
    first_integral,
    initial_values,
)
from orbitproof.verify.stability.along import CurveInTube, at_origin, level_around, solve
from orbitproof.verify.stability.first_half import from_first_half, is_enough
from orbitproof.verify.stability.stored_stability import SHARE, OrbitFunctions, StabilityFunctions
from orbitproof.verify.stability.units import at_other_point, in_own_units, units_of

_LEAST_SLOPE_BITS, _BITS_LEFT_OUT = 56, 32
_BELOW_ERROR, _LEAST_BITS, _LEAST_ORDER = 44, 64, 24
"""An integration whose points are known with an error has so many bits beyond it: few are lost at the start."""
SPARE_BITS = 48
"""The algebra of functions of sigma has so many bits more than the flow."""
_WIDER = 8
"""A tube about so many times as wide is followed where the piece's own does not do: at complex s the curve is farther
from the polynomial."""
_PARTS = [(arb(2 * part - 31) + arb(0, 1)) / 32 for part in range(32)]
"""Balls that cover |tau| <= 1."""
_FRAME = 2**16
"""Denominator of the frame at the other point."""
_ALONG = np.linspace(-1, 1, 9)
_CIRCLE = np.exp(2j * np.pi * np.arange(257) / 256)
"""Real and complex tau at which directions at the other point are compared."""


def stability_slope_bits(precision: int) -> int:
    """Significant bits of the derivatives across the curve where the stability of the orbits is enclosed as well."""
    return max(_LEAST_SLOPE_BITS, precision - _BITS_LEFT_OUT)


@dataclass(frozen=True)
class TubeOfOrbits:
    """A tube about an interval of a piece that is proved there, to be followed to its second return.

    Attributes:
        interval: that of the proof; on a symmetric piece with 0 inside it is [-c, c].
        limits, coordinates: how to integrate; those with which the piece is proved.
        symmetry: name of the symmetry of a symmetric piece.
        crossings: of the section in a half orbit, its end included.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    piece: Piece
    interval: Interval
    limits: PieceLimits
    coordinates: str
    oracle: WideOracle
    symmetry: str | None = None
    crossings: int = 1

    @property
    def divided(self) -> bool:
        """Whether the equations are divided by sigma."""
        return self.piece.is_symmetric and self.interval[0] <= 0 <= self.interval[1]

    @property
    def middle(self) -> Fraction:
        return sum(self.interval, Fraction(0)) / 2

    @property
    def radius(self) -> Fraction:
        """ds/dsigma."""
        return (self.interval[1] - self.interval[0]) / 2 * BEYOND

    def wider(self, progress: Callable[[float], None] | None) -> HalfReturn:
        """The return of a wider tube."""
        return self.follow([_WIDER * Fraction(2) ** floor(log2(width)) for width in self.piece.tube], progress)

    def follow(self, widths: Sequence[Fraction], progress: Callable[[float], None] | None) -> HalfReturn:
        """The return of a tube of other widths about the same polynomial."""
        system, flow = self.system, self._format(max(widths))
        tube = tube_points(flow, system.centre_coordinates, self.piece, (self.middle, self.radius), widths)
        start = {**parameter_series(flow, system, self.parameters), **tube}
        return HalfReturn.of(system, start, widths, self.coordinates, self.oracle, None, progress, self.crossings)

    def _format(self, width: Fraction, error: Fraction = Fraction(0)) -> WideArithmetic:
        """The format of an integration of a tube of this width, whose points are known with this error."""
        limits, count = self.limits, len(self.piece.tube)
        bits, order = limits.precision, limits.order
        slope_bits = stability_slope_bits(bits)
        if error:
            bits = slope_bits = min(bits, max(_LEAST_BITS, _BELOW_ERROR - floor(log2(error))))
            order = min(order, max(_LEAST_ORDER, ceil(order * bits / limits.precision)))
        grade_bits = floor(-log2(width)) - max(0, bits - slope_bits)
        return WideArithmetic(Grading((1,) * count, 1), bits, grade_bits, order, width=limits.width)

    @cached_property
    def arithmetic(self) -> WideArithmetic:
        """The algebra in sigma, or tau."""
        return WideArithmetic(Grading((1,), 0), self.limits.precision + SPARE_BITS, 0, 0, width=self.limits.width)

    def functions(self, half: HalfReturn, progress: Callable[[float], None] | None) -> OrbitFunctions:
        """All functions, from the first half of the orbits, where that is enough, or by integrating the second."""
        if is_enough(self):
            with suppress(IntegrationFailure):
                return from_first_half(self, half, progress)
        system, widths = self.system, half.widths
        flow = half.state[0].arithmetic
        assert isinstance(flow, WideArithmetic)
        integral = first_integral(system, flow, half.start) if system.family_parameter is None else None
        level = half.start[str(system.family_parameter)] if integral is None else integral
        curve = self.curve(half)
        beyond = self._at_other_point(curve, half.state)
        there = self.named(half.start, half.state, 1)
        other = OtherPoint.of([curve.value(element) for element in there])
        images = [
            [restricted(curve.across(element, j).scaled(1 / width), SHARE) for element in there]
            for j, width in enumerate(widths)
        ]
        out = other.modulo(images)
        around = _as_wide(out, max(widths))
        second_flow = self._format(max(around), max(map(error_of, there)))
        parameters = parameter_series(second_flow, system, self.parameters)
        begun = {**parameters, **other.tube(second_flow, system.centre_coordinates, around)}

        known_level = None if integral is None else level_around(begun, beyond, curve.value(integral))
        returns = HalfOrbits(beyond, second_flow, begun, self.oracle, self.coordinates, known_level)
        along = distance_along(returns, self.symmetry, SHARE)

        def after_step(number: float) -> None:
            if along is not None:
                along.cover()
            if progress is not None:
                progress(half.steps + number)

        second, _ = returns.half_orbit(self.crossings, after_step)
        back = self._back(curve, widths, around, self.named(begun, second, 0))
        sigma = _stability_matrix(out, back)
        points = self.initial(system, curve, half.start), self.initial(beyond, curve, half.start, there)
        return OrbitFunctions(
            tuple(_minors(sigma, order) for order in range(1, len(widths) + 1)),
            restricted(curve.value(level), SHARE),
            restricted(curve.value(half.time), SHARE),
            determinant([other.along, *images]),
            None if along is None else along.functions(system, *points),
            self._across(curve, half, flow),
        )

    def _across(
        self, curve: CurveInTube, half: HalfReturn, flow: WideArithmetic
    ) -> VariationFunctions | NotKnown | None:
        """Variations out of the plane, of motion in one."""
        if self.system.stiffness_across is None:
            return None
        from orbitproof.verify.out_of_plane import variations_across

        start = {name: curve.value(element) for name, element in half.start.items()}
        return variations_across(self.system, flow, start, SHARE, self.crossings, self.oracle)

    def _at_other_point(self, curve: CurveInTube, state: Sequence[Series]) -> ReversibleSystem:
        """The system at P(x): with the sheet of its fixed level on which that lies along the curve, or in its units."""
        system = self.system
        if system.normalised:
            return at_other_point(system)
        if system.fixed_level is None:
            return system
        from orbitproof.verify.poincare import on_sheet

        there = bounded(restricted(curve.value(state[system.state.index(str(system.level_coordinate))]), SHARE))
        return on_sheet(system, [there.value(part) for part in _PARTS])

    def initial(
        self, system: ReversibleSystem, curve: CurveInTube, start: Mapping[str, Series], point: Sequence[Series] = ()
    ) -> list[Series]:
        """State and parameters on Fix(R) as functions of sigma: at x(s), or at a point with these coordinates."""
        moved = {**start, **dict(zip(self.system.centre_coordinates, point, strict=True))} if point else start
        values = {name: curve.value(element) for name, element in moved.items()}
        return initial_values(system, self.arithmetic, values)

    def curve(self, half: HalfReturn) -> CurveInTube:
        """omega on the curve, from the state at the first return."""
        curve = solve(self.arithmetic, self.equations(half))
        for omega, width, tube in zip(curve.omega, half.widths, self.piece.tube, strict=True):
            known = bounded(restricted(omega, SHARE))
            if not all(is_inside(known.value(part), tube / width) for part in _PARTS):
                raise IntegrationFailure("stability", "the curve is not shown to be in its tube", "give a wider tube")
        return curve

    def equations(self, half: HalfReturn) -> list[Series]:
        """What vanishes on the curve at the first return."""
        signs = self.system.symmetries[str(self.symmetry)] if self.divided else [1] * len(half.state)
        return [
            divided_by_wide(half.state[index]) if signs[index] < 0 else half.state[index]
            for index in self.system.kernel_coordinates
        ]

    def named(self, tube: Mapping[str, Series], state: Sequence[Series], end: int) -> list[Series]:
        """The coordinates of a return in the order of the system's `centre_coordinates`; `end` is 0 at x, 1 at P(x)."""
        named = {**tube, **dict(zip(self.system.state, state[: len(self.system.state)], strict=True))}
        if self.system.normalised:
            named.update(in_own_units(self.system, units_of(self.system)[end], named))
        return [named[name] for name in self.system.centre_coordinates]

    def _back(
        self, curve: CurveInTube, widths: Sequence[Fraction], around: Sequence[Fraction], second: Sequence[Series]
    ) -> list[list[Series]]:
        """The columns of A': vectors at x modulo the direction of the curve, p_1, .., p_n (section 18.3).

        `widths` are those of the tubes at x, `around` at y.
        """
        piece, scale = self.piece, 1 / self.piece.half_width
        turns = []
        for polynomial, width, omega in zip(piece.polynomial, widths, curve.omega, strict=True):
            slopes = [n * value for n, value in enumerate(polynomial)][1:] or [Fraction(0)]
            along = function(self.arithmetic, recentred(slopes, self.middle, self.radius * SHARE), Fraction(0))
            turns.append(along.scaled(scale) + slope(omega, SHARE).scaled(scale * width / self.radius))
        columns = []
        for j, width in enumerate(around):
            image = [restricted(at_origin(element, j, self.arithmetic), SHARE).scaled(1 / width) for element in second]
            p = [_combined(row, image) for row in inverse_of(piece.frame)]
            columns.append([value - turn * p[0] for value, turn in zip(p[1:], turns, strict=True)])
        return columns


def stability_of_piece(
    tube: TubeOfOrbits, progress: Callable[[float], None] | None = None, half: HalfReturn | None = None
) -> StabilityFunctions | NotKnown:
    """The functions of section 18.3 as they are stored, or why there are none; arguments as `orbit_functions`."""
    followed = PHYSICAL if tube.coordinates == PHYSICAL else REGULARISED
    try:
        return orbit_functions(replace(tube, coordinates=followed), progress, half).stored
    except IntegrationFailure as error:
        return NotKnown(about_pieces(error.reason))
    except (ArithmeticError, ValueError) as error:
        return NotKnown(broken_off("stability", error))


def orbit_functions(
    tube: TubeOfOrbits, progress: Callable[[float], None] | None = None, half: HalfReturn | None = None
) -> OrbitFunctions:
    """The functions of section 18.3 on the interval of a tube.

    Args:
        progress: called after every step with the number of steps; what it raises passes through.
        half: the return of the tube, if it is known already, with these limits.

    Raises `IntegrationFailure`.
    """
    with guarded(tube.limits.precision + SPARE_BITS), np.errstate(all="ignore"):
        try:
            return tube.functions(tube.wider(progress) if half is None else half, progress)
        except IntegrationFailure:
            if half is None:
                raise
            return tube.functions(tube.wider(progress), progress)


@dataclass(frozen=True)
class OtherPoint:
    """The other point y(s) of the orbits on Fix(R), and coordinates for directions there.

    Attributes:
        point: its coordinates, as functions of sigma.
        frame: rows, exact; column 0 is about along the curve of these points.
    """

    point: tuple[Series, ...]
    frame: tuple[tuple[Fraction, ...], ...]

    @classmethod
    def of(cls, point: Sequence[Series]) -> OtherPoint:
        """With a frame that is chosen in float64; no result depends on it."""
        slopes = [[float(value) for value in known_part(slope(element, SHARE), 0)] or [0.0] for element in point]
        start = np.column_stack([_direction(slopes), np.eye(len(point))])
        columns = np.linalg.qr(start)[0]
        return cls(
            tuple(point),
            tuple(tuple(Fraction(round(float(value) * _FRAME), _FRAME) for value in row) for row in columns),
        )

    def tube(self, arithmetic: WideArithmetic, names: Sequence[str], widths: Sequence[Fraction]) -> dict[str, Series]:
        """The points y(s) + frame (0, widths * omega), by name."""
        result = {}
        count = len(widths)
        for name, element, row in zip(names, self.point, self.frame, strict=True):
            terms: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {(0,) * count: known_part(element, 0)}
            for j, width in enumerate(widths):
                terms[tuple(int(i == j) for i in range(count))] = row[j + 1] * width
            result[name] = arithmetic.polynomial(terms).widened(error_of(element))
        return result

    @cached_property
    def along(self) -> list[Series]:
        """y', functions of tau."""
        return [slope(element, SHARE) for element in self.point]

    def modulo(self, vectors: Sequence[Sequence[Series]]) -> list[list[Series]]:
        """Vectors at y(s) modulo y'(s): functions of tau, n for each vector (section 18.3)."""
        rows = inverse_of(self.frame)
        along = [_combined(row, self.along) for row in rows]
        share = inverse(along[0])
        turns = [element * share for element in along[1:]]
        result = []
        for vector in vectors:
            local = [_combined(row, vector) for row in rows]
            result.append([value - turn * local[0] for value, turn in zip(local[1:], turns, strict=True)])
        return result


def _direction(slopes: Sequence[Sequence[float]]) -> Floats:
    """A unit vector whose product with y'(tau), of these coefficients, is as far from 0 for |tau| <= 1 as can be found.

    Tried are the axes, the directions of y' at real tau and those halfway between two of them, or of one and the
    opposite of another. Raises `IntegrationFailure` if there is none.
    """
    along = np.array([polyval(_ALONG, row) for row in slopes]).T
    directions = [unit for unit in map(_unit, along) if unit is not None]
    sums = [_unit(first + sign * second) for first, second in combinations(directions, 2) for sign in (1, -1)]
    units: list[Floats] = [*np.eye(len(slopes)), *directions, *(unit for unit in sums if unit is not None)]
    on_circle = np.array([polyval(_CIRCLE, row) for row in slopes])
    scores = [_distance_from_zero(unit @ on_circle) for unit in units]
    if not max(scores) > 0:
        raise IntegrationFailure("stability", "the other point of the orbit may not move", "give a narrower piece")
    return units[int(np.argmax(scores))]


def _unit(vector: Floats) -> Floats | None:
    """The unit vector, or `None` if there is none."""
    norm = float(np.linalg.norm(vector))
    unit: Floats = vector / (norm or 1.0)
    return unit if 0 < norm < np.inf else None


def _distance_from_zero(values: Floats) -> float:
    """The least over the greatest size of a function on the circle; 0 if it has a zero inside (argument principle)."""
    sizes = np.abs(values)
    if not 0 < sizes.min() <= sizes.max() < np.inf:
        return 0.0
    angles = np.unwrap(np.angle(values))
    turns = round(float(angles[-1] - angles[0]) / (2 * np.pi))
    return float(sizes.min() / sizes.max()) if turns == 0 else 0.0


def _as_wide(vectors: Sequence[Sequence[Series]], width: Fraction) -> list[Fraction]:
    """Widths of a tube in proportion to the components of vectors, powers of two, about this width in the mean."""
    sizes = [max(norm_of(element) for element in row) for row in zip(*vectors, strict=True)]
    logarithms = [log2(size) if size else 0.0 for size in sizes]
    mean = sum(logarithms) / len(sizes)
    return [width * Fraction(2) ** round(logarithm - mean) for logarithm in logarithms]


def _stability_matrix(out: Sequence[Sequence[Series]], back: Sequence[Sequence[Series]]) -> list[list[Series]]:
    """Sigma = 2 A' A - 1, from the columns of A and A' (18.1)."""
    size = range(len(out))
    one = out[0][0].arithmetic.constant(Fraction(1))
    products = [
        [_combined([Fraction(2)] * len(out), [back[i][k] * out[j][i] for i in size]) for j in size] for k in size
    ]
    return [[products[k][j] - one if k == j else products[k][j] for j in size] for k in size]


def inverse_of(frame: Sequence[Sequence[Fraction]]) -> list[list[Fraction]]:
    """The exact inverse of a regular matrix."""
    rows = fmpq_mat([[fmpq(value.numerator, value.denominator) for value in row] for row in frame])
    return [[Fraction(int(value.p), int(value.q)) for value in row] for row in rows.inv().tolist()]


def _combined(factors: Sequence[Fraction], elements: Sequence[Series]) -> Series:
    terms = [element.scaled(factor) for factor, element in zip(factors, elements, strict=True)]
    return sum(terms[1:], terms[0])


def _minors(matrix: Sequence[Sequence[Series]], order: int) -> Series:
    """The sum of the principal minors of an order."""
    chosen = combinations(range(len(matrix)), order)
    minors = [determinant([[matrix[i][j] for j in places] for i in places]) for places in chosen]
    return sum(minors[1:], minors[0])
