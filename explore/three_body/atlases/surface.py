"""Pieces of surfaces of halo or axial orbits about the symmetry-breaking points of L1, L2 and L3, in float64.

A piece is a symmetry-breaking candidate whose mass and centre are polynomials in s in [-1, 1]. Near L1 and L2 the
system is the one in Hill's units with h = mu^(1/3) linear in s, regular at h = 0; near L3 it is the CR3BP with mu
linear in s. The polynomials interpolate `masses.curve` at Chebyshev nodes. The boxes follow from the orbits
that are born themselves: (x, vy) on the branch is x* + curvature z^2/2, for axial orbits with vz in place of z.

Half-widths. With u the parameter (h or mu), Taylor coefficients in u of the orbits of L1 and L2 decay like R^-n with R
between 1 - h and 1.3 (1 - h) (the masses change roles at h = 1), those of L3 with R between 0.42 and 0.5: measured over
the half return, from values on circles in the complex plane, at h = 0.1, 0.2, 0.45, 0.55, 0.7 and mu = 0.05, 0.15, ..,
0.45. A piece is a share of that wide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import ceil, log, log2

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.explore.numerics import NewtonRule
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.three_body.masses import (
    HALO,
    CurveRecord,
    MassChart,
    PointRecord,
    chart_of,
    correct_at,
    first_breaking,
    trace_curve,
)
from orbitproof.shared.formats import SurfacePiece
from orbitproof.shared.systems import CR3BP, HILL, HILL_AXIAL, ReversibleSystem

NODES = 32
NOISE = 1e-13
"""Chebyshev coefficients of the curve below this, relative to the first, are rounding errors."""

OVERLAP = Fraction(1, 512)
"""How far a piece reaches beyond its neighbour's end, as a part of its width."""

AMPLITUDE = 0.03
"""z (vz) of the orbits that give the curvatures; their relative error is about its square."""

ALONG = 1.0
"""Half-width of P_0 in units of what the branch moves along the family; it is bent away, but not exactly."""

ACROSS = 0.125
"""P_2 in units of P_0: across the family the half return is about so much more sensitive."""

_FLAT = 0.1
"""For L3 pieces become narrower towards small masses, where the equations hardly depend on the orbit, down to this."""

_HALO = NewtonRule(tolerance=1e-11, accepted=1e-6, steps=12)
"""At small masses around L3 the last equation is nearly the same for all orbits, and known to few digits."""
_SAMPLES = np.cos(np.pi * (np.arange(7) + 0.5) / 7)


@dataclass(frozen=True)
class Births:
    """Which surface: the libration point, and the family that is born on the planar one there."""

    libration: str
    family: str = HALO

    @property
    def chart(self) -> MassChart:
        """In which its curve of symmetry-breaking points is regular."""
        return chart_of(self.libration, self.family)

    @property
    def system(self) -> ReversibleSystem:
        """The system that its pieces are about."""
        if self.libration == "L3":
            return CR3BP
        return HILL if self.family == HALO else HILL_AXIAL

    @property
    def odd(self) -> int:
        """The coordinate of Fix(R) that S negates, as an index of the state."""
        system = self.system
        return next(i for i in system.fixed_coordinates if system.symmetries["S"][i] < 0)

    @property
    def rows(self) -> tuple[int, int, int]:
        """What vanishes after the half period: the section coordinate, what S keeps, and what S negates."""
        system = self.system
        kept, negated = sorted(system.kernel_coordinates, key=lambda i: -system.symmetries["S"][i])
        return system.section_index, kept, negated


@dataclass(frozen=True)
class Shape:
    """How orbits of both families leave a symmetry-breaking point, in the plane of (position, velocity).

    Attributes:
        tangent: shape (2,), unit vector along the planar family.
        curvature: shape (2,), second derivative of the branch in the coordinate that S negates.
    """

    tangent: Vector
    curvature: Vector


def intervals(libration: str, lowest: Fraction, highest: Fraction, share: float) -> list[tuple[Fraction, Fraction]]:
    """Centres and half-widths in the parameter of pieces that cover [lowest, highest] exactly and overlap a little.

    A half-width is at most `share` of the radius of convergence at the centre, see the module's text, and for L3 at
    most `share` of the distance of the centre from `_FLAT` below mass 0.
    """
    low, high = float(lowest), float(highest)
    # Between neighbouring edges the distance from the origin of the scale changes by one and the same factor.
    origin = -_FLAT if libration == "L3" else 1.0
    factor = (1 + share) / (1 - share)
    count = ceil(abs(log((high - origin) / (low - origin))) / log(factor) - 1e-9)
    edges = [lowest]
    for k in range(1, count):
        edge = origin + (low - origin) * ((high - origin) / (low - origin)) ** (k / count)
        edges.append(Fraction(round(edge * 2**20), 2**20))
    edges.append(highest)
    result = []
    for number, (start, end) in enumerate(pairwise(edges), start=1):
        beyond = OVERLAP * (end - start)
        start, end = start - beyond * (number > 1), end + beyond * (number < count)
        result.append(((start + end) / 2, (end - start) / 2))
    return result


def trace(births: Births, smallest: float, largest: float) -> CurveRecord:
    """The curve of symmetry-breaking points down to a mass; raises `families.named.FamilyFailure`."""
    start = first_breaking(births.libration, Fraction(largest), births.family)
    return trace_curve(births.libration, [start], smallest, family=births.family, step=0.2)


def piece(
    births: Births,
    curve: Sequence[PointRecord],
    interval: tuple[Fraction, Fraction],
    z: Fraction,
    name: str,
    progress: Callable[[float], None] | None = None,
) -> SurfacePiece:
    """The piece over centre +- half-width of the parameter.

    Arguments:
        curve: points of the curve that cover the interval, apart from a neighbourhood of mass 0.
        z: half-width of P_1 in the system's units.

    Raises `CorrectionFailure` where a point is not found.
    """
    centre, width = interval
    system, libration = births.system, births.libration
    angles = np.pi * (np.arange(NODES) + 0.5) / NODES
    nodes = np.cos(angles)
    values = np.array([_place(births, curve, float(centre) + float(width) * s) for s in nodes])
    coefficients = np.polynomial.chebyshev.chebfit(nodes, values, NODES - 1)
    polynomials = [_monomial(coefficients[:, j]) for j in range(3)]
    shapes = []
    for number, s in enumerate(_SAMPLES):
        x, v, time = (float(np.polyval(p[::-1], s)) for p in polynomials)
        shapes.append(_shape(births, float(centre) + float(width) * s, x, v, time))
        if progress is not None:
            progress((number + 1) / len(_SAMPLES))
    middle = shapes[len(shapes) // 2].tangent
    frame = np.array([middle, [-middle[1], middle[0]]]).T
    shears, radii = _box(frame, shapes, float(z))
    tilt, *bend = (tuple(Fraction(float(c)) for c in row) for row in shears)
    zero, one = Fraction(0), Fraction(1)
    parameter = (centre, width)
    position = [Fraction(float(c)) for c in polynomials[0]]
    if libration == "L3":
        # The chart counts the position from the larger mass, at -mu.
        position = [c - (parameter[k] if k < 2 else zero) for k, c in enumerate(position)]
    rows = [[Fraction(float(value)) for value in row] for row in frame]
    # The coordinates of Fix(R) in their order, and those of the kernel: what S negates is p_1 and q_1.
    centres = [tuple(position), tuple(Fraction(float(c)) for c in polynomials[1])]
    frames = [(row[0], zero, row[1]) for row in rows]
    place = system.fixed_coordinates.index(births.odd)
    centres.insert(place, (zero,))
    frames.insert(place, (zero, one, zero))
    kernel = [tuple(Fraction(int(i == j)) for j in system.kernel_coordinates) for i in reversed(births.rows[1:])]
    return SurfacePiece(
        id=name,
        parameters={system.fixed_parameters[0]: parameter},
        centre=tuple(centres),
        frame=tuple(frames),
        kernel_frame=tuple(kernel),
        radii=(_few_bits(radii[0]), z, _few_bits(radii[1])),
        tilt=(tilt,),
        bend=tuple(bend),
    )


def _place(births: Births, curve: Sequence[PointRecord], parameter: float) -> tuple[float, float, float]:
    """Position, velocity (the chart's units) and half period of the point at a parameter."""
    chart = births.chart
    mu = parameter**3 if chart.smaller else parameter
    guess = _guess(chart, curve, mu)
    point = correct_at(chart, guess)
    return (*point.scaled, point.half_period)


def _guess(chart: MassChart, curve: Sequence[PointRecord], mu: float) -> Vector:
    """The chart's unknowns at a mass by interpolation; below the curve's smallest mass those of its last point."""

    def unknowns(point: PointRecord) -> Vector:
        time = chart.unknowns(point.x, point.vy, point.half_period, point.mu)[2]
        return np.array([*point.scaled, time, np.log(mu)])

    for a, b in pairwise(curve):
        if b.mu <= mu <= a.mu:
            weight = np.log(mu / a.mu) / np.log(b.mu / a.mu)
            return np.asarray(unknowns(a) + weight * (unknowns(b) - unknowns(a)))
    return unknowns(curve[-1] if mu < curve[-1].mu else curve[0])


def _monomial(coefficients: Vector) -> Vector:
    """Coefficients of 1, s, s^2, .. from Chebyshev coefficients, without those that are noise."""
    size = np.abs(coefficients)
    # The first gap: beyond it single coefficients above the noise are noise too.
    small = np.maximum(size, np.append(size[1:], 0.0)) < NOISE * size[0]
    kept = int(np.argmax(small)) if small.any() else len(size)
    return np.asarray(np.polynomial.chebyshev.cheb2poly(coefficients[: max(kept, 2)]))


def _shape(births: Births, parameter: float, x: float, velocity: float, time: float) -> Shape:
    """Tangent of the planar family and curvature of the branch at a symmetry-breaking point."""
    start = x if births.chart.smaller else x - parameter
    unknowns = np.array([start, velocity, time])
    equations = _Equations(births, parameter, 0.0)
    _, jacobian = equations(unknowns)
    # The rows of the section and of the velocity along x determine the planar family.
    _, _, rows = np.linalg.svd(jacobian[:2])
    tangent = rows[-1][:2] / np.linalg.norm(rows[-1][:2])
    equations = _Equations(births, parameter, AMPLITUDE)
    last = np.inf
    for _ in range(_HALO.steps):
        residual, jacobian = equations(unknowns)
        step = np.linalg.solve(jacobian, residual)
        size = float(np.linalg.norm(step))
        unknowns = unknowns - step
        if _HALO.judge(size, last)[0]:
            break
        last = size
    else:
        named = births.system.state[births.odd]
        raise CorrectionFailure(f"no {births.family} orbit with {named} = {AMPLITUDE} at the parameter {parameter:.6g}")
    return Shape(tangent, 2 * (unknowns[:2] - [start, velocity]) / AMPLITUDE**2)


class _Equations:
    """`Births.rows` after the half period for an orbit that starts on Fix(R), in (x, vy, half period)."""

    def __init__(self, births: Births, parameter: float, odd: float) -> None:
        self._flow = flow_of(births.system)
        self._births = births
        self._parameter = parameter
        self._odd = odd

    def __call__(self, unknowns: Vector) -> tuple[Vector, Matrix]:
        x, velocity, time = unknowns
        start = [x, 0.0, 0.0, 0.0, velocity, 0.0]
        start[self._births.odd] = self._odd
        try:
            end = self._flow.derivative(start, time, [self._parameter])
        except FlowFailure as failure:
            raise CorrectionFailure(str(failure)) from None
        rows = list(self._births.rows)
        columns = [end.state_transition[rows, 0], end.state_transition[rows, 4], end.velocity[rows]]
        return end.state[rows], np.column_stack(columns)


def _box(frame: Matrix, shapes: Sequence[Shape], z: float) -> tuple[list[Vector], list[float]]:
    """Polynomials in s of tilt_2, bend_0 and bend_2, with which the family is p_2 = 0 and the branch p_0 = p_2 = 0 to
    leading order, and the half-widths of P_0 and P_2."""
    tangents = np.linalg.solve(frame, np.array([shape.tangent for shape in shapes]).T)
    curvatures = np.linalg.solve(frame, np.array([shape.curvature for shape in shapes]).T)
    values = [tangents[1] / tangents[0], curvatures[0] / 2, curvatures[1] / 2]
    along = float(np.abs(values[1]).max()) * z * z
    degree = len(_SAMPLES) - 1
    rows = [
        np.asarray(np.polynomial.chebyshev.cheb2poly(np.polynomial.chebyshev.chebfit(_SAMPLES, value, degree)))
        for value in values
    ]
    return rows, [ALONG * along, ACROSS * ALONG * along]


def _few_bits(value: float) -> Fraction:
    """A number with few bits at or above `value`."""
    exponent = ceil(log2(value)) - 3
    return Fraction(ceil(value / 2.0**exponent)) * Fraction(2) ** exponent
