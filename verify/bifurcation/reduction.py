"""Lyapunov-Schmidt reduction: symmetric orbits, p_2^H, bifurcation function (section 8).

Coordinates p = (p_0, p_1, p_2) on the box, p_2 with n - 1 components; subscripts 0 and 1 are
derivatives in p_0 and p_1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.verify.evidence import meet, up_to
from orbitproof.verify.newton import BoxFunction, ImplicitGraph, Jet, compose


@dataclass(frozen=True)
class BifurcationFunction:
    """G(p_0, p_1) = pi_q1 P^k(p_0, p_1, p_2^H(p_0, p_1)), where pi_q2 P^k(p_0, p_1, p_2^H) = 0.

    Attributes:
        component: pi_q1 P^k.
        graph: the graph of p_2^H over (p_0, p_1), from pi_q2 P^k = 0.
    """

    component: BoxFunction
    graph: ImplicitGraph

    def over(self, p_0: arb, p_1: arb) -> tuple[arb, ...]:
        """Enclosure of the points (p_0, p_1, p_2^H(p_0, p_1))."""
        return self.graph.over((p_0, p_1))

    def jet(self, where: Sequence[arb]) -> Jet:
        """Jet of G at the points of the graph in `where`, up to order 3."""
        return compose(self.component.derivatives(where), self.graph.jets(where))

    def restrict(self, function: BoxFunction, where: Sequence[arb]) -> Jet:
        """Jet of K(p_0, p_1) = H(p_0, p_1, p_2^H(p_0, p_1)) for a function H on the box."""
        return compose(function.derivatives(where), self.graph.jets(where))


@dataclass(frozen=True)
class FamilyJet:
    """Enclosures of p_1'(p_0) and p_1''(p_0) along the family."""

    slope: arb
    curvature: arb


@dataclass(frozen=True)
class PeriodTwoFamily:
    """The curve of symmetric period-two points of P in the box, for k > 1: pi_q P = 0 over p_0."""

    graph: ImplicitGraph

    def over(self, p_0: arb) -> tuple[arb, ...]:
        """Enclosure of the points (p_0, p_1(p_0), p_2(p_0))."""
        return self.graph.over((p_0,))

    def jet(self, where: Sequence[arb]) -> FamilyJet:
        """Derivatives of p_1(p_0) at the points of the family in `where`."""
        slope = self.graph.jets(where, 2)[1]
        return FamilyJet(slope.derivative(1), slope.derivative(2))


@dataclass(frozen=True)
class DoublySymmetricFamily:
    """The curve of doubly symmetric points for k = 1: p_1 = 0 exactly, p_2 = p_2^H(p_0, 0)."""

    reduction: BifurcationFunction

    def over(self, p_0: arb) -> tuple[arb, ...]:
        """Enclosure of the points (p_0, 0, p_2^H(p_0, 0))."""
        return self.reduction.over(p_0, arb(0))

    def jet(self, where: Sequence[arb]) -> FamilyJet:
        """p_1 vanishes identically along the family."""
        return FamilyJet(arb(0), arb(0))


Family = PeriodTwoFamily | DoublySymmetricFamily


@dataclass(frozen=True)
class ReducedFunction:
    """g(p_0, p_1), the mean of G_1 between the family and p_1, whose zeros are the branch of new orbits (section 8.4).

    Attributes:
        slope: enclosure of dg/dp_0 over the box.
        foot: p_1 of the family at p_0 = 0.
        at_foot: jet of G there.
        across: jet of G at all points with p_0 = 0.
    """

    slope: arb
    foot: arb
    at_foot: Jet
    across: Jet

    def at_centre(self, p_1: arb) -> arb:
        """Enclosure of g(0, p_1) for p_1 in a part of P_1, by Taylor's theorem about the family's point c = p_1(0).

        g(0, p_1) is the mean of G_1(0, c + t (p_1 - c)) over t in [0, 1]; the powers of t have means 1/2, 1/3.
        """
        distance, value = p_1 - self.foot, self.at_foot.derivative(0, 1)
        square = up_to(distance.abs_upper() * distance.abs_upper()) if distance.contains(0) else distance * distance
        first = value + self.across.derivative(0, 2) * distance / 2
        second = value + self.at_foot.derivative(0, 2) * distance / 2 + self.across.derivative(0, 3) * square / 6
        return meet(first, second)

    def zero(self, p_1: arb) -> arb:
        """Enclosure of the p_0 at which g(p_0, p_1) = 0, by the interval Newton operator at p_0 = 0."""
        return -self.at_centre(p_1) / self.slope


def reduced_function(p_0: arb, p_1: arb, family: Family, reduction: BifurcationFunction) -> ReducedFunction:
    """The reduced function on the box P_0 x P_1."""
    jet = reduction.jet(reduction.over(p_0, p_1))
    slope = jet.derivative(1, 1) + jet.derivative(0, 2) * family.jet(family.over(p_0)).slope / 2
    foot = family.over(arb(0))
    return ReducedFunction(slope, foot[1], reduction.jet(foot), reduction.jet(reduction.over(arb(0), p_1)))
