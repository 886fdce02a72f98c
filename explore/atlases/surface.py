"""Pieces of the surface of halo orbits (mass, z) about the symmetry-breaking points of L1, L2 and L3, in float64.

A piece is a symmetry-breaking candidate whose mass and centre are polynomials in s in [-1, 1]. Near L1 and L2 the
system is the one in Hill's units with h = mu^(1/3) linear in s, regular at h = 0; near L3 it is the CR3BP with mu
linear in s. The polynomials interpolate `explore.masses.curve` at Chebyshev nodes. The boxes follow from the halo
orbits themselves: (x, vy) on the branch is x* + curvature z^2/2.

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
from orbitproof.explore.masses import CurveRecord, PointRecord, chart_of, correct_at, first_breaking, trace_curve
from orbitproof.explore.numerics import NewtonRule
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.shared.formats import SurfacePiece
from orbitproof.shared.systems import CR3BP, HILL, ReversibleSystem

NODES = 32
NOISE = 1e-13
"""Chebyshev coefficients of the curve below this, relative to the first, are rounding errors."""

OVERLAP = Fraction(1, 512)
"""How far a piece reaches beyond its neighbour's end, as a part of its width."""

AMPLITUDE = 0.03
"""z of the halo orbits that give the curvatures; their relative error is about its square."""

ALONG = 1.0
"""Half-width of P_0 in units of what the halo branch moves along the family; it is bent away, but not exactly."""

ACROSS = 0.125
"""P_2 in units of P_0: across the family the half return is about so much more sensitive."""

_FLAT = 0.1
"""For L3 pieces become narrower towards small masses, where the equations hardly depend on the orbit, down to this."""

_HALO = NewtonRule(tolerance=1e-11, accepted=1e-6, steps=12)
"""At small masses around L3 the last equation is nearly the same for all orbits, and known to few digits."""
_SAMPLES = np.cos(np.pi * (np.arange(7) + 0.5) / 7)


@dataclass(frozen=True)
class Shape:
    """How halo orbits and planar orbits leave a symmetry-breaking point, in the plane of (position, velocity).

    Attributes:
        tangent: shape (2,), unit vector along the planar family.
        curvature: shape (2,), second derivative of the halo branch in z.
    """

    tangent: Vector
    curvature: Vector


def system_of(libration: str) -> ReversibleSystem:
    """The system that the pieces of a libration point are about."""
    return CR3BP if libration == "L3" else HILL


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


def trace(libration: str, smallest: float, largest: float) -> CurveRecord:
    """The curve of symmetry-breaking points down to a mass; raises `explore.families.named.FamilyFailure`."""
    return trace_curve(libration, [first_breaking(libration, Fraction(largest))], smallest, step=0.2)


def piece(
    libration: str,
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
    system = system_of(libration)
    angles = np.pi * (np.arange(NODES) + 0.5) / NODES
    nodes = np.cos(angles)
    values = np.array([_place(libration, curve, float(centre) + float(width) * s) for s in nodes])
    coefficients = np.polynomial.chebyshev.chebfit(nodes, values, NODES - 1)
    polynomials = [_monomial(coefficients[:, j]) for j in range(3)]
    shapes = []
    for number, s in enumerate(_SAMPLES):
        x, v, time = (float(np.polyval(p[::-1], s)) for p in polynomials)
        shapes.append(_shape(system, libration, float(centre) + float(width) * s, x, v, time))
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
    return SurfacePiece(
        id=name,
        parameters={system.fixed_parameters[0]: parameter},
        centre=(tuple(position), (zero,), tuple(Fraction(float(c)) for c in polynomials[1])),
        frame=((rows[0][0], zero, rows[0][1]), (zero, one, zero), (rows[1][0], zero, rows[1][1])),
        kernel_frame=((zero, one), (one, zero)),
        radii=(_few_bits(radii[0]), z, _few_bits(radii[1])),
        tilt=(tilt,),
        bend=tuple(bend),
    )


def _place(libration: str, curve: Sequence[PointRecord], parameter: float) -> tuple[float, float, float]:
    """Position, velocity (the chart's units) and half period of the point at a parameter."""
    chart = chart_of(libration)
    mu = parameter if libration == "L3" else parameter**3
    guess = _guess(libration, curve, mu)
    point = correct_at(chart, guess)
    return (*point.scaled, point.half_period)


def _guess(libration: str, curve: Sequence[PointRecord], mu: float) -> Vector:
    """The chart's unknowns at a mass by interpolation; below the curve's smallest mass those of its last point."""
    chart = chart_of(libration)

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


def _shape(system: ReversibleSystem, libration: str, parameter: float, x: float, velocity: float, time: float) -> Shape:
    """Tangent of the planar family and curvature of the halo branch at a symmetry-breaking point."""
    chart = chart_of(libration)
    start = x - parameter if not chart.smaller else x
    unknowns = np.array([start, velocity, time])
    equations = _Equations(system, parameter, 0.0)
    _, jacobian = equations(unknowns)
    # The rows of the section and of the velocity along x determine the planar family.
    _, _, rows = np.linalg.svd(jacobian[:2])
    tangent = rows[-1][:2] / np.linalg.norm(rows[-1][:2])
    equations = _Equations(system, parameter, AMPLITUDE)
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
        raise CorrectionFailure(f"no halo orbit with z = {AMPLITUDE} at the parameter {parameter:.6g}")
    return Shape(tangent, 2 * (unknowns[:2] - [start, velocity]) / AMPLITUDE**2)


class _Equations:
    """(y, vx, vz) after the half period for the orbit that starts at (x, 0, z, 0, vy, 0), in (x, vy, half period)."""

    def __init__(self, system: ReversibleSystem, parameter: float, z: float) -> None:
        self._flow = flow_of(system)
        self._parameter = parameter
        self._z = z

    def __call__(self, unknowns: Vector) -> tuple[Vector, Matrix]:
        x, velocity, time = unknowns
        try:
            end = self._flow.derivative([x, 0.0, self._z, 0.0, velocity, 0.0], time, [self._parameter])
        except FlowFailure as failure:
            raise CorrectionFailure(str(failure)) from None
        rows = [1, 3, 5]
        columns = [end.state_transition[rows, 0], end.state_transition[rows, 4], end.velocity[rows]]
        return end.state[rows], np.column_stack(columns)


def _box(frame: Matrix, shapes: Sequence[Shape], z: float) -> tuple[list[Vector], list[float]]:
    """Polynomials in s of tilt_2, bend_0 and bend_2, with which the family is p_2 = 0 and the halo branch p_0 = p_2 = 0
    to leading order, and the half-widths of P_0 and P_2."""
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
