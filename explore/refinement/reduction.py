"""Lyapunov-Schmidt reduction in power series, and the radii of the box that follow from it.

From jets of pi_q P^k in the frame's coordinates: the function p_2(p_0, p_1) with q_2 = 0, the bifurcation
function G_k(p_0, p_1) = q_1, and the curvatures and slopes of the two branches that cross at the centre.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, log2, log10
from typing import Any

import mpmath

from orbitproof.explore.numerics import mpf
from orbitproof.explore.refinement.crossing import level_jet, section_crossings
from orbitproof.explore.refinement.frames import Directions, RefinementFailure
from orbitproof.explore.refinement.half_return import section_jets, start_jets
from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.shared.systems import Regularisation, ReversibleSystem

SAFETY = 8
"""Factor by which a radius exceeds what the curvature of the branch asks for."""

EASY_LOSS_BITS = 12
FEW_LOST_BITS = 4
"""A box that is narrower for so many lost bits is not made wider again: the digits asked for take more."""

EASY_CURVATURE_BITS = 8

CENTRE_SHARE = 100
"""A radius is at least so many times as large as the uncertainty of the centre."""


@dataclass(frozen=True)
class BranchGeometry:
    """Derivatives at the bifurcation point, in the frame's coordinates (float64 accuracy).

    Attributes:
        mixed: G_01, the second derivative of G_k in p_0 and p_1, with the precision of the jets; 0 for folds.
        second: G_11; zero within rounding for a tangential bifurcation.
        third: G_111, or `None` for touch and go.
        branch_slope: p_0'(p_1) along the new branch.
        branch_curvature: p_0''(p_1), or `None` for touch and go.
        family_curvature: p_1''(p_0) along the family, or `None` for a tangential bifurcation.
        across: bounds for |second derivatives| of p_2: (in p_1 twice, mixed, in p_0 twice).
        level_family: derivative along the family of the bifurcation parameter, h_fp'.
        level_branch: along the new branch, h_b' for touch and go and h_b'' for a tangential bifurcation.
    """

    mixed: Any
    second: float
    third: float | None
    branch_slope: float
    branch_curvature: float | None
    family_curvature: float | None
    across: tuple[float, float, float]
    level_family: float
    level_branch: float


def branch_geometry(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    centre: Sequence[Fraction],
    frame: Directions,
    k: int,
    tangential: bool,
    context: mpmath.MPContext,
    regularisation: Regularisation | None = None,
    every: int = 1,
) -> BranchGeometry:
    """Slopes and curvatures of the branches, from jets of P^k integrated along all k half returns.

    With a `regularisation` of the system the orbits are followed in its coordinates; half returns cross the section
    `every` so many times.

    Raises `IntegrationFailure`, or `RefinementFailure` if a nondegeneracy condition fails.
    """
    n = len(system.kernel_coordinates)
    heavy = [2] * (n - 1)
    basis = JetBasis.graded([2, 1, *heavy], 3) if tangential else JetBasis.graded([1, 1, *heavy], 2)
    reduced = JetBasis.graded([2, 1], 3) if tangential else JetBasis.graded([1, 1], 2)
    directions = [[frame.columns[i, j] for i in range(n + 1)] + [0] * n for j in range(n + 1)]
    point = [mpf(u, context) for u in centre]
    start, parameter = start_jets(system, point, directions, basis)
    iterates = []
    for crossing in section_crossings(
        system, parameters, start, parameter, context, regularisation=regularisation, every=every
    ):
        kernel = section_jets(system, crossing, parameter)[n + 1 :]
        iterates.append([sum((kernel[j] * frame.rows[i, j] for j in range(n)), basis.constant(0)) for i in range(n)])
        if len(iterates) == k:
            break
    level = level_jet(system, parameters, start, parameter, context)

    p0 = Jet(reduced, [int(m == (1, 0)) for m in reduced.monomials])
    p1 = Jet(reduced, [int(m == (0, 1)) for m in reduced.monomials])
    columns = range(2, n + 1)
    across = _implicit(iterates[-1][1:], columns, [p0, p1] + [reduced.constant(0)] * (n - 1), context)
    bifurcation = _without_constant(iterates[-1][0]).compose([p0, p1, *across])
    h = level.compose([p0, p1, *across])

    def g(*monomial: int) -> Any:
        return bifurcation.coefficients[reduced.index[monomial]]

    def bound(*monomial: int) -> float:
        if monomial not in reduced.index:
            return 0.0
        return max((abs(float(p.coefficients[reduced.index[monomial]])) for p in across), default=0.0)

    mixed, second = g(1, 1), 2 * g(0, 2)
    if mixed == 0:
        raise RefinementFailure("the stability of the family does not change to first order at the resonance")
    p0_slope = -second / (2 * mixed)
    second_derivatives = (2 * bound(0, 2), bound(1, 1), 2 * bound(2, 0))
    h0, h1, h11 = (h.coefficients[reduced.index[m]] for m in ((1, 0), (0, 1), (0, 2)))
    if tangential:
        p0_curvature = -2 * g(0, 3) / mixed
        return BranchGeometry(
            mixed,
            float(second),
            6 * float(g(0, 3)),
            float(p0_slope),
            float(p0_curvature),
            None,
            second_derivatives,
            float(h0),
            float(2 * h11 + h0 * p0_curvature),
        )
    line = JetBasis.graded([1], 2)
    path = [Jet(line, [0, 1, 0])] + [line.constant(0)] * n
    family = _implicit(iterates[0], range(1, n + 1), path, context)
    curvatures = [2 * abs(float(p.coefficients[2])) for p in family]
    family_across = max([second_derivatives[2], *curvatures[1:]])
    return BranchGeometry(
        mixed,
        float(second),
        None,
        float(p0_slope),
        None,
        curvatures[0],
        (*second_derivatives[:2], family_across),
        float(h0),
        float(h0 * p0_slope + h1),
    )


def fold_geometry(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    centre: Sequence[Fraction],
    frame: Directions,
    context: mpmath.MPContext,
    regularisation: Regularisation | None = None,
    every: int = 1,
) -> BranchGeometry:
    """Curvatures of the curve of symmetric orbits at a fold, where it is a graph over p_1.

    `branch_curvature` is its p_0''(p_1), `level_branch` the second derivative of the parameter along it.
    Raises `IntegrationFailure`, or `RefinementFailure` if the second derivative vanishes.
    """
    n = len(system.kernel_coordinates)
    basis = JetBasis.graded([2, 1, *[2] * (n - 1)], 2)
    directions = [[frame.columns[i, j] for i in range(n + 1)] + [0] * n for j in range(n + 1)]
    point = [mpf(u, context) for u in centre]
    start, parameter = start_jets(system, point, directions, basis)
    crossing = next(
        section_crossings(system, parameters, start, parameter, context, regularisation=regularisation, every=every)
    )
    kernel = section_jets(system, crossing, parameter)[n + 1 :]
    equations = [sum((kernel[j] * frame.rows[i, j] for j in range(n)), basis.constant(0)) for i in range(n)]
    line = JetBasis.graded([1], 2)
    path = [line.constant(0), Jet(line, [0, 1, 0]), *[line.constant(0)] * (n - 1)]
    curve = _implicit(equations, [0, *range(2, n + 1)], path, context)
    level = level_jet(system, parameters, start, parameter, context)
    level_slope = float(level.coefficients[basis.variable(0)])
    bend = 2 * float(level.compose([curve[0], path[1], *curve[1:]]).coefficients[2])
    if bend == 0:
        raise RefinementFailure("the second derivative of the parameter along the curve vanishes")
    across, *others = (2 * float(jet.coefficients[2]) for jet in curve)
    most = max(map(abs, others), default=0.0)
    return BranchGeometry(0.0, 0.0, None, 0.0, across, None, (most, 0.0, 0.0), level_slope, bend)


def _without_constant(jet: Jet) -> Jet:
    return Jet(jet.basis, [0, *jet.coefficients[1:]])


def _implicit(
    equations: list[Jet], unknowns: Sequence[int], arguments: list[Jet], context: mpmath.MPContext
) -> list[Jet]:
    """Solve equations = 0 (constant terms dropped) for the arguments numbered `unknowns`, as series."""
    if not equations:
        return []
    basis = equations[0].basis
    functions = [_without_constant(jet) for jet in equations]
    slope = context.matrix([[f.coefficients[basis.variable(j)] for j in unknowns] for f in functions])
    try:
        inverse = context.inverse(slope)
    except ZeroDivisionError:
        raise RefinementFailure("the kernel of D pi_q P^k is not simple") from None
    current = list(arguments)
    for _ in range(4):  # each round adds one grade, and 3 is the highest
        defects = [f.compose(current) for f in functions]
        for row, j in enumerate(unknowns):
            for column, defect in enumerate(defects):
                current[j] = current[j] - defect * inverse[row, column]
    return [current[j] for j in unknowns]


def half_width(geometry: BranchGeometry, digits: int, k: int, lost_bits: int, same_units: bool) -> float:
    """The half-width of P_1 for which third derivatives are enclosed sharply.

    Along an orbit that loses many bits (`lost_bits`, near a collision), over many returns, and where the new
    branch is strongly curved, the part of the map beyond third order is amplified, and the box is made smaller:
    by less where the derivative of G_k that it is compared with is large itself. These sizes say so only if p_0 and
    p_1 are coordinates of one kind (`same_units`), not if p_0 is a parameter.
    """
    lost = float(max(0, lost_bits - EASY_LOSS_BITS))
    amplified = lost + 4 * max(0, k - 4)
    if same_units and k > 1:
        compared = abs(geometry.second if geometry.third is None else geometry.third)
        amplified -= min(max(0.0, lost - FEW_LOST_BITS) / 2, log2(max(1.0, compared)))
        if geometry.branch_curvature:
            amplified += max(0.0, 2 * log2(abs(geometry.branch_curvature)) - EASY_CURVATURE_BITS)
    return float(10.0 ** (-digits / 3) * 4.0**-amplified)


def digits_for(width: float) -> int:
    """Decimal digits of the centre that a half-width of P_1 needs: those of P_0 and P_2 are about its square."""
    return ceil(-2 * log10(width) + log10(CENTRE_SHARE))


def box_radii(geometry: BranchGeometry, width: float, accuracy: float, n: int) -> tuple[Fraction, ...]:
    """Half-widths of P_0, P_1, P_2, powers of two, for a centre known to `accuracy` in the frame.

    They satisfy, with `SAFETY` to spare, p_1(P_0) in P_1, p_2(P_0 x P_1) in P_2 and p_0(P_1) in P_0.

    Arguments:
        width: of P_1, from `half_width`.
        n: number of kernel coordinates.
    """
    floor_ = CENTRE_SHARE * accuracy
    d11, d01, d00 = geometry.across
    if geometry.branch_curvature is not None:
        r1 = max(width, floor_**0.5)
        r0 = max(SAFETY * abs(geometry.branch_curvature) / 2 * r1**2, r1**2, floor_)
        r2 = max(SAFETY * d11 / 2 * r1**2, r1**2, floor_)
    else:
        assert geometry.family_curvature is not None
        slope = abs(geometry.branch_slope)
        r1 = max(width / max(1.0, slope), floor_)
        # Both sides of p_1(P_0) in P_1 shrink with r1, the left one faster.
        widening = SAFETY * max(slope, 1 / SAFETY)
        r1 = min(r1, 2 / (SAFETY * max(geometry.family_curvature, 1e-300) * widening**2))
        r0 = widening * r1
        r2 = SAFETY * (d11 / 2 * r1**2 + d01 * r0 * r1 + d00 / 2 * r0**2)
        r2 = max(r2, r0**2, floor_)
    return (_power_of_two(r0), _power_of_two(r1, down=True), *[_power_of_two(r2)] * (n - 1))


def _power_of_two(value: float, down: bool = False) -> Fraction:
    exponent = log2(value)
    return Fraction(2) ** (floor(exponent) if down else ceil(exponent))
