"""The conditions of Walawska and Wilczak on the tables of derivatives. README, sections 5 and 6."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from .jets import CannotFollow, Jet, eliminate, monomials

Vector = list[arb]


@dataclass(frozen=True)
class Hypothesis:
    """An inequality that holds, with its enclosures."""

    name: str
    says: str
    enclosures: dict[str, arb]


@dataclass(frozen=True)
class Table:
    """A function of p: its jet up to order 2 at p = 0, and up to order 3 at every point of a box about 0."""

    centre: Jet
    box: Jet

    def jet(self, radii: Sequence[arb], degree: int = 3) -> Jet:
        """Jets at all points with |p_j| <= radii_j, inside the box, by the mean value theorem. README, section 5."""
        table = monomials(len(radii), 3)
        coarse = monomials(len(radii), 2)

        def entry(a: tuple[int, ...]) -> arb:
            if sum(a) == 3:
                value = self.box[table.index[a]]
                return arb(0) if value is None else value
            value = self.centre[coarse.index[a]]
            total = arb(0) if value is None else value
            for j, radius in enumerate(radii):
                if not radius.is_zero():
                    # The derivative of the coefficient of a in p_j is (a_j + 1) times that of a + e_j.
                    above = tuple(c + (i == j) for i, c in enumerate(a))
                    total = total + arb(0, radius.upper()) * (a[j] + 1) * entry(above)
            return total

        return [entry(a) for a in monomials(len(radii), degree).exponents]


def combine(row: Sequence[arb], tables: Sequence[Table]) -> Table:
    """The table of a linear combination."""

    def total(jets: Sequence[Jet]) -> Jet:
        columns = zip(*jets, strict=True)
        return [sum((c * x for c, x in zip(row, column, strict=True) if x is not None), arb(0)) for column in columns]

    return Table(total([t.centre for t in tables]), total([t.box for t in tables]))


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


def determinant(matrix: Sequence[Sequence[arb]]) -> arb:
    """Determinant of a 1 x 1 or 2 x 2 matrix."""
    return matrix[0][0] if len(matrix) == 1 else matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]


def solve(matrix: Sequence[Sequence[arb]], right: Sequence[arb]) -> Vector:
    """Enclosure of the solutions of all systems of size 1 or 2 with matrix and right side in the balls, by Cramer."""
    whole = determinant(matrix)
    if len(matrix) == 1:
        return [right[0] / whole]
    (a, b), (c, d) = matrix
    return [(right[0] * d - b * right[1]) / whole, (a * right[1] - c * right[0]) / whole]


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


@dataclass(frozen=True)
class Conclusion:
    """Hypotheses that hold, enclosures of the bifurcation point in p, and the side of the new orbits."""

    hypotheses: list[Hypothesis]
    point: Vector
    side: str


def _linear(table: Table, radii: Sequence[arb]) -> Vector:
    return table.jet(radii, 1)[1:]


def conclude(claim: Claim) -> Conclusion:
    """Check every condition in turn. Raises `CannotFollow` at the first that is not certain."""
    radii, n = claim.radii, len(claim.iterates[0])
    zero = arb(0)
    found: list[Hypothesis] = []
    only_p0 = [radii[0]] + [zero] * n
    last = claim.iterates[-1]
    slopes = {i: [_linear(table, radii) for table in tables] for i, tables in enumerate(claim.iterates, 1)}

    # HC2: p_2^H over P_0 x P_1.
    reach = [*radii[:2], zero]
    p2, p2_centre = zero, zero
    if n == 2:
        steep = slopes[claim.k][1][2]
        p2 = -last[1].jet(reach, 0)[0] / steep
        p2_centre = -last[1].jet([zero] * 3, 0)[0] / steep
        found.append(
            certain(
                nonzero(steep) and inside(p2, radii[2]),
                "HC2",
                "pi_q2 P^k = 0 has one solution p_2^H in P_2, inside it, over P_0 x P_1",
                p2=p2,
                slope=steep,
                P2=radii[2],
            )
        )

    # The family.
    if claim.breaking:
        family = [zero, p2][:n]
        drift = [zero]
        found.append(certain(True, "family", "the doubly symmetric points are p_1 = 0, p_2 = p_2^H(p_0, 0)", p1=zero))
    else:
        first = claim.iterates[0]
        matrix = [row[1:] for row in slopes[1]]
        family = [-c for c in solve(matrix, [table.jet(only_p0, 0)[0] for table in first])]
        found.append(
            certain(
                all(inside(c, r) for c, r in zip(family, radii[1:], strict=True)),
                "family",
                "interval Newton: pi_q P = 0 has one solution (p_1, p_2)(p_0), inside, over P_0",
                **{f"p{j}": c for j, c in enumerate(family, 1)},
            )
        )
        drift = [-c for c in solve(matrix, [row[0] for row in slopes[1]])]
        for i in range(1, claim.k):
            whole = determinant([row[1:] for row in slopes[i]])
            found.append(
                certain(
                    nonzero(whole),
                    f"regular-{i}",
                    f"every matrix in the enclosure of D_p pi_q P^{i} is regular",
                    determinant=whole,
                )
            )

    # The bifurcation function G and the first integral K over P_0 x P_1, by Lyapunov-Schmidt reduction.
    def reduced(spread: Sequence[arb]) -> tuple[Jet, Jet]:
        jets = [last[0].jet(spread), claim.integral.jet(spread)]
        if n == 2:
            jets = eliminate(monomials(3, 3), last[1].jet(spread), jets)
        full = monomials(2, 3)
        scaled = []
        for jet in jets:
            weights = [_factorial(a[0]) * _factorial(a[1]) for a in full.exponents]
            scaled.append([arb(0) if c is None else c * w for c, w in zip(jet, weights, strict=True)])
        return scaled[0], scaled[1]

    index = monomials(2, 3).index
    g, h = reduced(radii)
    at_centre, _ = reduced([zero, zero, p2_centre.abs_upper()][: n + 1])
    g00, g01, g11 = (g[index[a]] for a in ((2, 0), (1, 1), (0, 2)))
    g111 = g[index[0, 3]]
    p1 = arb(0, radii[1])
    found.append(
        certain(inside(family[0], radii[1]), "HC2-family", "p_1(P_0) lies in the interior of P_1", p1=family[0])
    )

    # HC3: the second curve.
    g_0 = g01 + g11 * drift[0] / 2

    def g_over(p1: arb) -> arb:
        value: arb = at_centre[index[0, 1]] + at_centre[index[0, 2]] * p1 + g111 * p1 * p1 / 2
        return value

    g_at = g_over(p1)
    p0 = -g_at / g_0
    found.append(
        certain(
            nonzero(g_0) and inside(p0, radii[0]),
            "HC3",
            "interval Newton: g = 0 has one solution p_0(p_1), inside P_0, for each p_1 in P_1",
            g_0=g_0,
            g=g_at,
            p0=p0,
            P0=radii[0],
        )
    )

    # HC4: they cross once.
    crossing = g01 + g11 * drift[0]
    found.append(certain(nonzero(crossing), "HC4", "G_01 + G_11 p_1' is not zero", value=crossing))

    # The parameter.
    h0, h1 = h[index[1, 0]], h[index[0, 1]]
    plain = claim.integral.jet(radii, 1)[1]
    found.append(certain(nonzero(plain), "dH/dp_0", "the first integral can replace p_0", value=plain))
    h_fp = h0 + h1 * drift[0]
    found.append(certain(nonzero(h_fp), "h_fp'", "the family is a graph over the first integral", value=h_fp))
    p0_1 = -(g11 / 2) / (g01 + g11 * drift[0] / 2)
    if claim.k % 2 and claim.k > 1:
        slope = h0 * p0_1 + h1
        found.append(certain(nonzero(slope), "h_b'", "the branch is a graph over the first integral", value=slope))
        side = "both"
    else:
        p0_2 = -(((g[index[3, 0]] * p0_1 + 3 * g[index[2, 1]]) * p0_1 + 3 * g[index[1, 2]]) * p0_1 + g111) / (
            3 * (g01 + g00 * p0_1)
        )
        bend = (h[index[2, 0]] * p0_1 + 2 * h[index[1, 1]]) * p0_1 + h[index[0, 2]] + h0 * p0_2
        found.append(
            certain(
                nonzero(bend), "h_b''", "the first integral has a strict extremum on the branch", value=bend, slope=p0_1
            )
        )
        side = "above" if bend > 0 else "below"
    # x* lies on the branch and on the family, so p_0* = p_0(p_1*) with p_1* in p_1(P_0).
    point = [-g_over(family[0]) / g_0, *family]
    return Conclusion(found, point, side)


def _factorial(number: int) -> int:
    return 1 if number < 2 else number * _factorial(number - 1)
