"""The conditions of Walawska and Wilczak on tables of derivatives. README, section 6."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial, prod
from typing import Any

from flint import arb, arb_mat

from .jets import Jet, implicit, joined, substitute

Vector = list[arb]


@dataclass(frozen=True)
class Hypothesis:
    """A condition, whether it is certain of the enclosures, and these."""

    name: str
    condition: bool
    enclosures: dict[str, arb]

    @property
    def holds(self) -> bool:
        """Only if the balls are finite, and there are some."""
        return self.condition is True and bool(self.enclosures) and all(c.is_finite() for c in self.enclosures.values())


@dataclass(frozen=True)
class Table:
    """A function: its jet at a point up to `order`, and up to order 3 at every point of a convex set around it."""

    centre: Jet
    around: Jet
    order: int

    def jet(self, reach: Sequence[arb]) -> Jet:
        """Jets at all points centre + `reach`, in the set: mean value theorem. README, section 5.1."""
        result = Jet(self.around, 3)
        for a in {**self.centre, **self.around}:
            if len(a) <= self.order:
                # The derivative in p_j of the coefficient of a is that of a p_j, as often as p_j occurs there.
                changes = [x * (a.count(j) + 1) * self.around[joined(a, (j,))] for j, x in enumerate(reach)]
                result[a] = sum(changes, self.centre[a])
        return result


@dataclass(frozen=True)
class Conclusion:
    """Every condition; if all hold, the point in p, the side, the normal form (README, 6.7).

    `slope` is p_0'(p_1) along the branch at the point, `drift` p_1'(p_0) along the family.
    """

    hypotheses: list[Hypothesis]
    point: Vector
    side: str
    normal_form: dict[str, arb]
    slope: arb
    drift: arb


def conclude(k: int, breaking: bool, iterates: Sequence[Sequence[Table]], integral: Table, radii: Vector) -> Conclusion:
    """The conditions, evaluated: all are in the conclusion, also those that do not hold.

    For i = 1, .., k `iterates` has the tables of q_1(P^i), .., q_n(P^i), on the box with these radii; `breaking` says
    that this is about symmetry breaking.
    """
    n, last, none, found = len(radii) - 1, iterates[-1], arb(0), list[Hypothesis]()
    whole = [arb(0, r.upper()) for r in radii]

    def check(name: str, condition: bool, **enclosures: arb) -> None:
        found.append(Hypothesis(name, condition, enclosures))

    def slopes(table: Table) -> Vector:
        jet = table.jet(whole)
        return [jet[j,] for j in range(n + 1)]

    p2 = p2_centre = none
    if n == 2:
        steep = slopes(last[1])[2]
        p2, p2_centre = (-last[1].jet(reach)[()] / steep for reach in ([*whole[:2], none], [none] * 3))
        check("HC2", not steep.contains(0) and abs(p2) < radii[2], p2=p2, slope=steep, P2=radii[2])
    family, drift = [none, p2][:n], none
    if not breaking:
        first = [slopes(table) for table in iterates[0]]
        inverse = arb_mat([row[1:] for row in first]).inv()
        values = arb_mat([[-table.jet([whole[0], *[none] * n])[()]] for table in iterates[0]])
        family = [row[0] for row in (inverse * values).tolist()]
        drift = -(inverse * arb_mat([row[:1] for row in first]))[0, 0]
        for i, tables in enumerate(iterates[:-1], 1):
            value = arb_mat([slopes(table)[1:] for table in tables]).det()
            check(f"regular-{i}", not value.contains(0), determinant=value)
    is_inside = all(abs(c) < r for c, r in zip(family, radii[1:], strict=True))
    check("family", is_inside, **{f"p{j}": c for j, c in enumerate(family, 1)})

    def reduced(reach: Sequence[arb]) -> list[Jet]:
        """Partial derivatives of the bifurcation function G and of K in (p_0, p_1), by Lyapunov-Schmidt reduction."""
        jets = [last[0].jet(reach), integral.jet(reach)]
        if n == 2:
            jets = substitute(jets, implicit([last[1].jet(reach)], [2]))
        return [Jet({a: prod(factorial(a.count(j)) for j in (0, 1)) * c for a, c in jet.items()}, 3) for jet in jets]

    g, h = reduced(whole)
    g_centre, _ = reduced([none, none, arb(0, p2_centre.abs_upper())][: n + 1])

    def g_over(p1: arb) -> Any:
        return g_centre[1,] + g_centre[1, 1] * p1 + g[1, 1, 1] * p1 * p1 / 2

    g_0, g_at = g[0, 1] + g[1, 1] * drift / 2, g_over(whole[1])
    p0, crossing = -g_at / g_0, g[0, 1] + g[1, 1] * drift
    check("HC3", not g_0.contains(0) and abs(p0) < radii[0], g_0=g_0, g=g_at, p0=p0, P0=radii[0])
    check("HC4", not crossing.contains(0), value=crossing)
    plain, h_fp = slopes(integral)[0], h[0,] + h[1,] * drift
    check("dH/dp_0", not plain.contains(0), value=plain)
    check("h_fp'", not h_fp.contains(0), value=h_fp)
    slope = -(g[1, 1] / 2) / g_0
    form = {"alpha": crossing / h[0,], "h_fp'": h_fp}
    if k % 2 and k > 1:
        rise, side = h[0,] * slope + h[1,], "both"
        check("h_b'", not rise.contains(0), value=rise)
        form |= {"beta": rise / (1 - drift * rise / h_fp), "h_b'": rise}
    else:
        numerator = ((g[0, 0, 0] * slope + 3 * g[0, 0, 1]) * slope + 3 * g[0, 1, 1]) * slope + g[1, 1, 1]
        second = -numerator / (3 * (g[0, 1] + g[0, 0] * slope))
        bend = (h[0, 0] * slope + 2 * h[0, 1]) * slope + h[1, 1] + h[0,] * second
        side = "above" if bend > 0 else "below"
        check("h_b''", not bend.contains(0), value=bend, slope=slope)
        form |= {"beta": bend / 2, "h_b''": bend}
    # x* lies on the branch and on the family, so p_0* = p_0(p_1*) with p_1* in p_1(P_0).
    return Conclusion(found, [-g_over(family[0]) / g_0, *family], side, form, slope, drift)


def conclude_fold(tables: Sequence[Table], integral: Table, radii: Vector) -> Conclusion:
    """The conditions of a fold, evaluated, for tables of q_1(P), .., q_n(P) on the box. README, section 6.8."""
    n, none, found = len(radii) - 1, arb(0), list[Hypothesis]()
    whole, others = [arb(0, r.upper()) for r in radii], [0, 2][:n]

    def check(name: str, condition: bool, **enclosures: arb) -> None:
        found.append(Hypothesis(name, condition, enclosures))

    slopes = arb_mat([[table.jet(whole)[j,] for j in others] for table in tables])
    inverse = slopes.inv()

    def over(p1: arb) -> Vector:
        """The points of the curve over some p_1 in P_1."""
        values = arb_mat([[-table.jet([none, p1, none][: n + 1])[()]] for table in tables])
        first, *more = [row[0] for row in (inverse * values).tolist()]
        return [first, p1, *more]

    def parameter(reach: Vector) -> Jet:
        """H along the curve, as a function of p_1, at points of the curve in `reach`."""
        return substitute([integral.jet(reach)], implicit([table.jet(reach) for table in tables], others))[0]

    curve = over(whole[1])
    is_inside = all(abs(curve[j]) < radii[j] for j in others)
    check("curve", is_inside, determinant=slopes.det(), **{f"p{j}": curve[j] for j in others})
    bend, rise = 2 * parameter(whole)[1, 1], parameter(over(none))[1,]
    p1 = -rise / bend
    check("extremum", not bend.contains(0) and abs(p1) < radii[1], bend=bend, slope=rise, p1=p1, P1=radii[1])
    plain = integral.jet(whole)[0,]
    check("dH/dp_0", not plain.contains(0), value=plain)
    return Conclusion(found, over(p1), "above" if bend > 0 else "below", {"beta": bend / 2}, none, none)
