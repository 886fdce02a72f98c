"""Conditions at the bifurcation point: its type, the side, the normal form (sections 9 and 11)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.conditions import Point, Problem
from orbitproof.verify.bifurcation.reduction import BifurcationFunction, Family
from orbitproof.verify.evidence import Checklist, excludes_zero, meet, show, sign

_REMEDY = "choose smaller radii or more precision; a value that vanishes belongs to a degenerate bifurcation"


@dataclass(frozen=True)
class Nondegeneracy:
    """Where the new orbits live, and the coefficients of the normal form.

    Attributes:
        side: "above", "below" or "both".
        normal_form: alpha and beta, and the derivatives that decide the side.
    """

    side: str
    normal_form: Mapping[str, arb]


def _require_nonzero(checklist: Checklist, name: str, section: str, what: str, ball: arb) -> None:
    with checklist.hypothesis(name, section, f"{what} is not zero at the bifurcation point", _REMEDY) as evidence:
        evidence.record(name, ball)
        evidence.require(excludes_zero(ball), f"{show(ball)} may be zero", needs_precision=True)


def side_of(second_derivative: arb) -> str:
    """Side of the new orbits for a branch whose parameter has an extremum with this second derivative."""
    return {1: "above", -1: "below", 0: "not known"}[sign(second_derivative)]


def check_family_of_maps(
    checklist: Checklist, claim: Candidate, reduction: BifurcationFunction, point: Point
) -> Nondegeneracy:
    """Maps with a parameter: G_11 != 0 for touch-and-go; G_01 != 0 and G_111 != 0 otherwise.

    Otherwise G_11 = 0 at the point, hence nu'' = -G_111 / (3 G_01) along the branch.
    """
    jet = reduction.jet(point.where)
    alpha = point.crossing
    if not claim.is_tangential:
        second = jet.derivative(0, 2)
        _require_nonzero(checklist, "G_11", "9.1", "G_11", second)
        return Nondegeneracy("both", {"alpha": alpha, "beta": -second / (2 * alpha)})
    # G_01 + G_11 p_1' is G_01 there: both enclose it.
    mixed, third = meet(jet.derivative(1, 1), alpha), jet.derivative(0, 3)
    _require_nonzero(checklist, "G_01", "9.2", "G_01", mixed)
    _require_nonzero(checklist, "G_111", "9.2", "G_111", third)
    curvature = -third / (3 * mixed)
    return Nondegeneracy(side_of(curvature), {"alpha": mixed, "beta": curvature / 2})


def check_level_slope(checklist: Checklist, problem: Problem, where: Sequence[arb]) -> None:
    """The level of H is a coordinate near the point: dH/dp_0 is not zero."""
    integral = problem.first_integral
    if integral is None:
        raise ValueError("a Hamiltonian problem has a first integral")
    slope = integral.gradient(where, 0)[0]
    _require_nonzero(checklist, "dH/dp_0", "9.3", "the derivative of H in p_0", slope)


def check_hamiltonian(
    checklist: Checklist,
    claim: Candidate,
    problem: Problem,
    family: Family,
    reduction: BifurcationFunction,
    point: Point,
) -> Nondegeneracy:
    """The level of H as parameter: dH/dp_0, h_fp', and h_b' (touch-and-go) or h_b'' (otherwise) are not zero."""
    integral = problem.first_integral
    if integral is None:
        raise ValueError("a Hamiltonian problem has a first integral")
    where = point.where
    jet, level, curve = reduction.jet(where), reduction.restrict(integral, where), family.jet(where)
    k_0, k_1 = level.derivative(1, 0), level.derivative(0, 1)

    check_level_slope(checklist, problem, where)
    family_slope = k_0 + k_1 * curve.slope
    _require_nonzero(checklist, "h_fp'", "9.3", "the derivative of H along the family", family_slope)

    g_0 = jet.derivative(1, 1) + jet.derivative(0, 2) * curve.slope / 2
    g_1 = jet.derivative(0, 2) / 2
    alpha = point.crossing / k_0
    if not claim.is_tangential:
        branch_slope = k_0 * (-g_1 / g_0) + k_1
        _require_nonzero(checklist, "h_b'", "9.4", "the derivative of H along the branch", branch_slope)
        beta = branch_slope / (1 - curve.slope * branch_slope / family_slope)
        return Nondegeneracy("both", {"alpha": alpha, "beta": beta, "h_b'": branch_slope, "h_fp'": family_slope})
    # h_b' = 0 at the point, so that p_0' = -K_1 / K_0 as well; by a symmetry S it is 0.
    slope = arb(0) if claim.uses_symmetry else meet(-g_1 / g_0, -k_1 / k_0)
    g_11 = jet.derivative(0, 3) / 3
    g_01 = jet.derivative(1, 2) / 2 + jet.derivative(0, 3) * curve.slope / 6
    g_00 = (
        jet.derivative(2, 1)
        + jet.derivative(1, 2) * curve.slope
        + jet.derivative(0, 3) * curve.slope * curve.slope / 3
        + jet.derivative(0, 2) * curve.curvature / 2
    )
    curvature = -(g_00 * slope * slope + 2 * g_01 * slope + g_11) / g_0
    branch_curvature = (
        level.derivative(2, 0) * slope * slope
        + 2 * level.derivative(1, 1) * slope
        + level.derivative(0, 2)
        + k_0 * curvature
    )
    _require_nonzero(checklist, "h_b''", "9.4", "the second derivative of H along the branch", branch_curvature)
    return Nondegeneracy(
        side_of(branch_curvature),
        {"alpha": alpha, "beta": branch_curvature / 2, "h_b''": branch_curvature, "h_fp'": family_slope},
    )
