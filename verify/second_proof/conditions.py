"""The conditions of Walawska and Wilczak on tables of derivatives. README, sections 5 and 6."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial
from typing import Any

from flint import arb, arb_mat

from .jets import CannotFollow, Jet, implicit, monomials, substitute, unit, varying

Vector = list[arb]


@dataclass(frozen=True)
class Hypothesis:
    """An inequality that holds, with its enclosures."""

    name: str
    says: str
    enclosures: dict[str, arb]


@dataclass(frozen=True)
class Table:
    """A function: its jet at a point up to `order`, and up to order 3 at every point of a convex set around it."""

    centre: Jet
    around: Jet
    order: int

    def jet(self, reach: Sequence[arb]) -> Jet:
        """Jets at all points centre + `reach`, in the set: mean value theorem. README, section 5."""
        size = len(reach)
        result: Jet = {}
        for degree in range(4):
            for a in monomials(size, degree):
                value = self.around.get(a, arb(0))
                if degree <= self.order:
                    value = self.centre.get(a, arb(0))
                    for j, change in enumerate(reach):
                        # The derivative of the coefficient of a in p_j is (a_j + 1) times that of a + e_j.
                        above = tuple(c + (i == j) for i, c in enumerate(a))
                        if not change.is_zero():
                            value = value + change * (a[j] + 1) * self.around.get(above, arb(0))
                result[a] = value
        return result


def certain(condition: bool, name: str, says: str, **enclosures: arb) -> Hypothesis:
    """The hypothesis, or `CannotFollow` if it is not certain on finite balls."""
    if not (condition is True and enclosures and all(value.is_finite() for value in enclosures.values())):
        shown = ", ".join(f"{key} = {value.str(6)}" for key, value in enclosures.items())
        raise CannotFollow(f"{name}: not shown: {says}; {shown}")
    return Hypothesis(name, says, enclosures)


def nonzero(value: arb) -> bool:
    """Whether a ball is certainly different from zero."""
    return bool(value > 0) or bool(value < 0)


def inside(value: arb, radius: arb) -> bool:
    """Whether a ball lies inside (-radius, radius)."""
    return bool(value < radius) and bool(value > -radius)


@dataclass(frozen=True)
class Claim:
    """What the conditions are about.

    Attributes:
        k: multiplicity; `breaking`: symmetry breaking, k = 1.
        iterates: for i = 1, .., k the tables of q_1(P^i), .., q_n(P^i).
        integral: the table of the first integral.
        radii: R_0, R_1 (, R_2); the tables hold on this box.
    """

    k: int
    breaking: bool
    iterates: list[list[Table]]
    integral: Table
    radii: list[arb]


def conclude(claim: Claim) -> tuple[list[Hypothesis], Vector, str]:
    """Every condition in turn, the bifurcation point in p, the side. Raises `CannotFollow` at the first that fails."""
    radii, n, last, k = claim.radii, len(claim.radii) - 1, claim.iterates[-1], claim.k
    none, whole, found = arb(0), [arb(0, r.upper()) for r in claim.radii], []
    origin, centre, units = (0,) * (n + 1), [none] * (n + 1), [unit(n + 1, j) for j in range(n + 1)]

    def check(condition: bool, name: str, says: str, **enclosures: arb) -> None:
        found.append(certain(condition, name, says, **enclosures))

    def slopes(table: Table) -> Vector:
        jet = table.jet(whole)
        return [jet[u] for u in units]

    p2, p2_centre = none, none
    if n == 2:
        steep = slopes(last[1])[2]
        p2 = -last[1].jet([*whole[:2], none])[origin] / steep
        p2_centre = -last[1].jet(centre)[origin] / steep
        says = "pi_q2 P^k = 0 has one solution p_2^H in P_2, inside it, over P_0 x P_1"
        check(nonzero(steep) and inside(p2, radii[2]), "HC2", says, p2=p2, slope=steep, P2=radii[2])
    if claim.breaking:
        family, drift = [none, p2][:n], none
        check(True, "family", "the doubly symmetric points are p_1 = 0, p_2 = p_2^H(p_0, 0)", p1=none)
    else:
        first = [slopes(table) for table in claim.iterates[0]]
        inverse = arb_mat([row[1:] for row in first]).inv()
        values = arb_mat([[-table.jet([whole[0], *centre[1:]])[origin]] for table in claim.iterates[0]])
        family = [row[0] for row in (inverse * values).tolist()]
        says = "interval Newton: pi_q P = 0 has one solution (p_1, p_2)(p_0), inside, over P_0"
        enclosures = {f"p{j}": c for j, c in enumerate(family, 1)}
        check(all(inside(c, r) for c, r in zip(family, radii[1:], strict=True)), "family", says, **enclosures)
        drift = -(inverse * arb_mat([row[:1] for row in first]))[0, 0]
        for i in range(1, k):
            value = arb_mat([slopes(table)[1:] for table in claim.iterates[i - 1]]).det()
            says = f"every matrix in the enclosure of D_p pi_q P^{i} is regular"
            check(nonzero(value), f"regular-{i}", says, determinant=value)

    def reduced(reach: Sequence[arb]) -> tuple[Jet, Jet]:
        """Partial derivatives of the bifurcation function G and of K in (p_0, p_1), by Lyapunov-Schmidt reduction."""
        jets = [last[0].jet(reach), claim.integral.jet(reach)]
        if n == 2:
            inner = [{unit(2, i): arb(1)} for i in range(2)] + implicit([last[1].jet(reach)], 2, 3)
            jets = [substitute(varying(jet), inner, (0, 0), 3) for jet in jets]
        zero = {a: none for degree in range(4) for a in monomials(2, degree)}
        g, h = ({a: factorial(a[0]) * factorial(a[1]) * c for a, c in {**zero, **jet}.items()} for jet in jets)
        return g, h

    g, h = reduced(whole)
    g_centre, _ = reduced([none, none, arb(0, p2_centre.abs_upper())][: n + 1])
    g_01, g_11, g_111 = g[1, 1], g[0, 2], g[0, 3]
    check(inside(family[0], radii[1]), "HC2-family", "p_1(P_0) lies in the interior of P_1", p1=family[0])

    def g_over(p1: arb) -> Any:
        return g_centre[0, 1] + g_centre[0, 2] * p1 + g_111 * p1 * p1 / 2

    g_0, g_at = g_01 + g_11 * drift / 2, g_over(whole[1])
    p0 = -g_at / g_0
    says = "interval Newton: g = 0 has one solution p_0(p_1), inside P_0, for each p_1 in P_1"
    check(nonzero(g_0) and inside(p0, radii[0]), "HC3", says, g_0=g_0, g=g_at, p0=p0, P0=radii[0])
    crossing = g_01 + g_11 * drift
    check(nonzero(crossing), "HC4", "G_01 + G_11 p_1' is not zero", value=crossing)
    plain, h_fp = slopes(claim.integral)[0], h[1, 0] + h[0, 1] * drift
    check(nonzero(plain), "dH/dp_0", "the first integral can replace p_0", value=plain)
    check(nonzero(h_fp), "h_fp'", "the family is a graph over the first integral", value=h_fp)
    slope = -(g_11 / 2) / g_0
    if k % 2 and k > 1:
        rise, side = h[1, 0] * slope + h[0, 1], "both"
        check(nonzero(rise), "h_b'", "the branch is a graph over the first integral", value=rise)
    else:
        numerator = ((g[3, 0] * slope + 3 * g[2, 1]) * slope + 3 * g[1, 2]) * slope + g_111
        second = -numerator / (3 * (g_01 + g[2, 0] * slope))
        bend = (h[2, 0] * slope + 2 * h[1, 1]) * slope + h[0, 2] + h[1, 0] * second
        side = "above" if bend > 0 else "below"
        says = "the first integral has a strict extremum on the branch"
        check(nonzero(bend), "h_b''", says, value=bend, slope=slope)
    # x* lies on the branch and on the family, so p_0* = p_0(p_1*) with p_1* in p_1(P_0).
    return found, [-g_over(family[0]) / g_0, *family], side
