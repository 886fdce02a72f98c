"""Hopf points once more: a real system for the pair, and the centre manifold as a graph. README, 17.4 to 17.6."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, arb, arb_mat

from .conditions import Hypothesis, Vector
from .equilibria import EquilibriumStatement, HopfClaim, OfEquilibrium, about, bits_for, read_equilibrium
from .jets import CannotFollow, Jet, Monomial, ball, combine, joined, precision
from .multipliers import multipliers
from .newton import checked, solved
from .periodic import ERRORS
from .proof import NotProved, dot

ALONG, VARIED = (0, 1), 2
"""Variables of jets: the two coordinates along the plane of the pair, and what varies less its value."""
SQUARES: tuple[Monomial, ...] = ((0, 0), (0, 1), (1, 1))
CUBES: tuple[Monomial, ...] = ((0, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1))
MIXED: tuple[Monomial, ...] = ((0, VARIED), (1, VARIED))


@dataclass(frozen=True)
class ProvedHopf:
    """The Hopf point is proved.

    Attributes:
        point, is_only, hypotheses, width, bits: as of `ProvedEquilibrium`.
        name, parameter: what varies, and its value.
        frequency: the eigenvalues of the pair are +- i times this.
        vector: the eigenvector q as the claim has it.
        multipliers, left, right: of the other eigenvalues; none has real part 0.
        speed: the derivative of the real part of the pair.
        lyapunov: the first Lyapunov coefficient, for an eigenvector of length 1.
        side: values of what varies for which there are orbits; `criticality`: supercritical if `lyapunov` < 0.
    """

    point: dict[str, arb]
    name: str
    parameter: arb
    frequency: arb
    vector: tuple[acb, ...]
    multipliers: tuple[acb, ...]
    left: int
    right: int
    speed: arb
    lyapunov: arb
    side: str
    criticality: str
    is_only: bool
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int


class _Hopf(OfEquilibrium):
    """One attempt: the unknowns x, a, kappa and u."""

    degree = 2, 2

    def __init__(self, statement: EquilibriumStatement, claim: HopfClaim, bits: int) -> None:
        super().__init__(statement, bits)
        self.claim = claim
        self.borders = [[ball(value) for value in row] for row in claim.kernel]
        start = [ball(statement.parameters[claim.parameter]).mid(), (ball(claim.frequency) ** 2).mid()]
        self.centre = [*self.centre, *start, *(value.mid() for value in self.borders[0])]

    def names(self) -> list[str]:
        """The names of all unknowns."""
        return [*super().names(), "a", "kappa", *(f"u {i}" for i in range(self.size))]

    def slopes(self, rows: Sequence[Jet], vector: Sequence[arb]) -> list[Vector]:
        """The derivatives of A w by x and a, w fixed."""
        places = range(self.size)
        return [
            [sum((row[joined((j,), (k,))] * (1 + (j == k)) * vector[j] for j in places), arb(0)) for k in self.varied]
            for row in rows
        ]

    @property
    def varied(self) -> range:
        """Variables of jets of f."""
        return range(self.size + 1)

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivative of (17.1) by x, a, kappa and u."""
        n, kappa, u = self.size, around[self.size + 1], around[self.size + 2 :]
        matrix = arb_mat(super().system(rows, around))
        moved, none = [dot(line, u) for line in matrix.tolist()], [arb(0)] * n
        inner = matrix * arb_mat(self.slopes(rows, u))
        square = matrix * matrix
        found = [[row[k,] for k in self.varied] + [arb(0), *none] for row in rows]
        for i, line in enumerate(self.slopes(rows, moved)):
            by_u = [square[i, j] + (kappa if i == j else 0) for j in range(n)]
            found.append([*(x + inner[i, k] for k, x in enumerate(line)), u[i], *by_u])
        return found + [[*[arb(0)] * (n + 2), *border] for border in self.borders]

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of (17.1) at the centre."""
        kappa, u = self.centre[self.size + 1], self.centre[self.size + 2 :]
        matrix = arb_mat(super().system(rows, u))
        twice = (matrix * matrix * arb_mat([[x] for x in u])).entries()
        sums = [value + kappa * x for value, x in zip(twice, u, strict=True)]
        return [*super().zeros(rows), *sums, *(dot(c, u) - dot(c, self.borders[0]) for c in self.borders)]

    def box(self) -> Vector:
        """What (x, a, kappa, u) may be for the points of the claim's box. README, 17.4."""
        claim = self.claim
        value = about(self.statement.parameters[claim.parameter], claim.parameter_radius)
        omega = about(claim.frequency, claim.frequency_radius)
        real, imaginary = ([about(c, claim.kernel_radius) for c in row] for row in claim.kernel)
        lines = [[dot(c, real), -dot(c, imaginary)] for c in self.borders]
        turn = solved(lines, [dot(c, self.borders[0]) for c in self.borders])
        u = [turn[0] * x - turn[1] * y for x, y in zip(real, imaginary, strict=True)]
        return [*super().box(), value, omega * omega, *u]

    def conclusion(self) -> ProvedHopf:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        n, claim = self.size, self.claim
        newton, zero, _, _ = self.enclosed()
        kappa, u = zero[n + 1], zero[n + 2 :]
        first = Hypothesis("frequency", kappa > 0, {"kappa": kappa})
        checked([newton, first])
        omega, (_, rows) = kappa.sqrt(), self.evaluated(zero, 1)
        matrix = arb_mat(super().system(rows, zero))
        v = [-dot(line, u) / omega for line in matrix.tolist()]
        turn = acb(sum((x * x for row in self.borders for x in row), arb(0)))
        turn /= sum((acb(k, -m) * acb(x, y) for k, m, x, y in zip(*self.borders, u, v, strict=True)), acb(0))
        frame, kept = _frame(u, v)
        inner = (frame.inv() * matrix * frame).tolist()
        block = [line[2:] for line in inner[2:]]
        balls = multipliers(arb_mat(block), []) if block else []
        apart = Hypothesis("others", not any(z.real.contains(0) for z in balls), {"omega": omega} | _parts(balls))
        checked([apart])
        drift = [-x for x in solved(matrix.tolist(), [row[n,] for row in rows])]
        first_rate, second_rate = self.reduced(zero, frame, kept, drift, block, omega)
        speed = (first_rate[0, VARIED] + second_rate[1, VARIED]) / 2
        length = sum((x * x for x in (*u, *v)), arb(0))
        lyapunov = 4 * amplitude(first_rate, second_rate, omega) / (omega * length)
        last = [Hypothesis("crossing", not speed.contains(0), {"speed": speed})]
        last.append(Hypothesis("lyapunov", not lyapunov.contains(0), {"l_1": lyapunov}))
        hypotheses = checked([newton, first, apart, *last])
        return ProvedHopf(
            dict(zip(self.statement.names, zero, strict=False)), claim.parameter, zero[n], omega,
            tuple(turn * acb(x, y) for x, y in zip(u, v, strict=True)), tuple(balls),
            sum(z.real < 0 for z in balls), sum(z.real > 0 for z in balls), speed, lyapunov,
            "above" if speed * lyapunov < 0 else "below", "supercritical" if lyapunov < 0 else "subcritical",
            self.is_only(), hypotheses, self.width, self.bits,
        )  # fmt: skip

    def reduced(
        self,
        zero: Vector,
        frame: arb_mat,
        kept: Sequence[int],
        drift: Vector,
        block: Sequence[Vector],
        omega: arb,
    ) -> tuple[Jet, Jet]:
        """Jets of the field on the centre manifold, in the coordinates of the plane. README, 17.5."""
        inverse, graph = frame.inv().tolist(), [Jet({}, 3) for _ in kept]
        start = [
            Jet({(): x, (VARIED,): drift[i], **{(j,): frame[i, j] for j in ALONG}}, 3)
            for i, x in enumerate(zero[: self.size])
        ]  # fmt: skip
        value = Jet({(): zero[self.size], (VARIED,): arb(1)}, 3)

        def moved() -> list[Jet]:
            state = list(start)
            for place, height in zip(kept, graph, strict=True):
                state[place] = state[place] + height
            rates = self.statement.rates(state, value)
            return [combine(rates, line, 3) for line in inverse]

        for monomials in (SQUARES, MIXED, CUBES) if kept else ():
            first, second, *across = moved()
            missing = [
                rate - (derived(height, 0) * first + derived(height, 1) * second)
                for rate, height in zip(across, graph, strict=True)
            ]
            graph = [
                height + more
                for height, more in zip(graph, homological(missing, monomials, block, omega), strict=True)
            ]  # fmt: skip
        first, second, *_ = moved()
        return first, second


def homological(
    missing: Sequence[Jet], monomials: Sequence[Monomial], block: Sequence[Vector], omega: arb
) -> list[Jet]:
    """The forms H in these monomials with H' J p - D H = `missing`, J p = omega (p_1, -p_0). README, 17.5."""
    size, places = len(block), {a: n for n, a in enumerate(monomials)}
    count = size * len(monomials)
    lines = [[arb(0)] * count for _ in range(count)]
    for a, n in places.items():
        for k in range(size):
            for l in range(size):
                lines[n * size + k][n * size + l] -= block[k][l]
        for j, sign in ((0, 1), (1, -1)):
            if j in a:
                rest = list(a)
                rest.remove(j)
                to = places[joined(tuple(rest), (1 - j,))]
                for k in range(size):
                    lines[to * size + k][n * size + k] += sign * a.count(j) * omega
    found = solved(lines, [jet[a] for a in monomials for jet in missing])
    return [Jet({a: found[n * size + k] for a, n in places.items()}, 3) for k in range(size)]


def derived(jet: Jet, j: int) -> Jet:
    """The derivative of a jet in one variable."""
    found = Jet({}, jet.degree)
    for a, c in jet.items():
        if j in a:
            rest = list(a)
            rest.remove(j)
            found[tuple(rest)] = c * a.count(j)
    return found


def amplitude(y: Jet, x: Jet, omega: arb) -> arb:
    """The coefficient a of r' = a r^3, of x' = - omega y + .., y' = omega x + .., y variable 0. README, (17.4)."""
    fxx, fxy, fyy = 2 * x[1, 1], x[0, 1], 2 * x[0, 0]
    gxx, gxy, gyy = 2 * y[1, 1], y[0, 1], 2 * y[0, 0]
    cubic = 6 * x[1, 1, 1] + 2 * x[0, 0, 1] + 2 * y[0, 1, 1] + 6 * y[0, 0, 0]
    bent = (fxy * (fxx + fyy) - gxy * (gxx + gyy) - fxx * gxx + fyy * gyy) / omega
    return arb(cubic + bent) / 16


def _frame(u: Vector, v: Vector) -> tuple[arb_mat, list[int]]:
    """The matrix with the columns u, v and unit vectors, and the places of these."""
    size = len(u)
    areas = {(i, j): abs((u[i] * v[j] - u[j] * v[i]).mid()) for j in range(size) for i in range(j)}
    left_out = max(areas, key=lambda places: float(areas[places]))
    kept = [i for i in range(size) if i not in left_out]
    return arb_mat([[u[i], v[i], *(arb(int(i == k)) for k in kept)] for i in range(size)]), kept


def _parts(balls: Sequence[acb]) -> dict[str, arb]:
    return {f"real part {n}": z.real for n, z in enumerate(balls, start=1)}


def prove_hopf(certificate: Mapping[str, Any]) -> ProvedHopf | NotProved:
    """Prove the Hopf point that a certificate claims, from its statement and its box alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    statement = read_equilibrium(certificate)
    claim = statement.claim
    if claim is None:
        return NotProved("nothing varies")
    bits = bits_for([*statement.radii, claim.parameter_radius, claim.frequency_radius, claim.kernel_radius])
    with precision(bits):
        try:
            return _Hopf(statement, claim, bits).conclusion()
        except (CannotFollow, *ERRORS) as error:
            return NotProved(f"{type(error).__name__}: {error}")
