"""Lyapunov-Schmidt reduction: symmetric orbits, p_2^H, bifurcation function (section 8).

Coordinates p = (p_0, p_1, p_2) on the box, p_2 with n - 1 components; subscripts 0 and 1 are
derivatives in p_0 and p_1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

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
