"""A torus born where two multipliers cross the unit circle (Neimark, Sacker) once more. README, section 11."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, acb_mat, arb, arb_poly

from .conditions import Hypothesis, Vector
from .jets import CannotFollow, Jet, ball
from .legs import Return, form
from .multipliers import linear, multipliers
from .newton import checked
from .periodic import attempted
from .periodic_bifurcation import VaryingLegs, best_border, read_bifurcation
from .proof import NotProved

RESONANCES = 1, 2, 3, 4
Complex = list[acb]


@dataclass(frozen=True)
class ProvedTorus:
    """The bifurcation is proved.

    Attributes:
        kind, point, name, parameter, period, hypotheses, width, bits, steps: as of `ProvedPeriodicBifurcation`.
        multiplier: one of the pair on the circle.
        multipliers, inside, on, outside: of the others; none is on the circle.
        speed: the derivative of the absolute value of the pair by the parameter.
        lyapunov: d of section 11.1, for the vector in the claim.
        side: where the torus is; `criticality`: supercritical if d < 0.
    """

    kind: str
    point: dict[str, arb]
    name: str
    parameter: arb
    period: arb
    multiplier: acb
    multipliers: tuple[acb, ...]
    inside: int
    on: int
    outside: int
    speed: arb
    lyapunov: arb
    side: str
    criticality: str
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


def product(left: Sequence[Any], right: Sequence[Any]) -> acb:
    """The sum of products, without conjugates."""
    return sum((a * b for a, b in zip(left, right, strict=True)), acb(0))


def solve(lines: Sequence[Sequence[acb]], values: Sequence[acb]) -> Complex:
    """The solution of linear equations."""
    return [entry for (entry,) in acb_mat(lines).solve(acb_mat([[value] for value in values])).tolist()]


class _Torus(VaryingLegs):
    """One attempt: the unknowns are those of the orbit, the parameter, U and V with W = U + i V, and the angle."""

    def multiplier(self, unknowns: Sequence[arb]) -> acb:
        """Lambda, on the unit circle."""
        return acb(unknowns[-1].cos(), unknowns[-1].sin())

    def vector(self, unknowns: Sequence[arb]) -> Complex:
        """W."""
        n = len(self.columns)
        first = self.time + 1
        return [acb(u, v) for u, v in zip(unknowns[first : first + n], unknowns[first + n : -1], strict=True)]

    def lines(self, rows: Sequence[Jet], at: acb) -> list[Complex]:
        """D E - J with this multiplier."""
        lines = [[acb(entry) for entry in line] for line in self.slopes(rows)]
        for i in range(self.size):
            lines[i][i] += 1 - at
        return lines

    def prepare(self, rows: Sequence[Jet]) -> None:
        """A first W, which is W_0, as for one vector, and a first angle."""
        u, v = self.claimed
        cosine, sine = (ball(value) for value in self.claim.multiplier)
        guess = acb(cosine, sine)
        lines, claimed = self.lines(rows, guess), [acb(a, b) for a, b in zip(u, v, strict=True)]
        below = [*(z.conjugate() for z in claimed), *[acb(0)] * (len(lines) - self.size)]
        matrix = best_border(lines, below, acb_mat)
        right = acb_mat([*[[0]] * len(lines), [sum((abs(z) ** 2 for z in claimed), arb(0))]])
        found = [w for (w,) in matrix.solve(right).tolist()][:-1]
        self.weights = [acb(w.real.mid(), w.imag.mid()) for w in found]
        self.length = sum((abs(w) ** 2 for w in self.weights), arb(0))
        self.centre = [
            *self.centre, *(w.real for w in self.weights), *(w.imag for w in self.weights), arb(guess.arg().mid())
        ]  # fmt: skip

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivative of (11.1) by X, a, U, V and the angle."""
        n, at, vector = len(self.columns), self.multiplier(around), self.vector(around)
        zeros = [arb(0)] * n
        result = [[*line, *zeros, *zeros, arb(0)] for line in self.equations(rows)]
        lines = self.lines(rows, at)
        bent = zip(
            *(self.bent(rows, part) for part in ([w.real for w in vector], [w.imag for w in vector])), strict=True
        )
        turned = [-acb(0, 1) * at * w if i < self.size else acb(0) for i, w in enumerate(vector)]
        turned += [acb(0)] * (n - len(turned))
        real, imaginary = list[Vector](), list[Vector]()
        for line, (by_u, by_v), turn in zip(lines, bent, turned[:n], strict=True):
            parts = [z.real for z in line], [z.imag for z in line]
            real.append([*by_u, *parts[0], *(-z for z in parts[1]), turn.real])
            imaginary.append([*by_v, *parts[1], *parts[0], turn.imag])
        first, second = [w.real for w in self.weights], [w.imag for w in self.weights]
        none = [arb(0)] * (n + 1)
        return [
            *result, *real, *imaginary,
            [*none, *first, *second, arb(0)], [*none, *(-w for w in second), *first, arb(0)],
        ]  # fmt: skip

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of (11.1) at the centre."""
        vector = self.vector(self.centre)
        values = [product(line, vector) for line in self.lines(rows, self.multiplier(self.centre))]
        scale = product([w.conjugate() for w in self.weights], vector) - self.length
        return [*self.defects(rows), *(z.real for z in values), *(z.imag for z in values), scale.real, scale.imag]

    def conclusion(self) -> ProvedTorus:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        orbit, size = self.statement, self.size
        newton, zero, found, rows = self.enclosed()
        checks, _ = self.check_orbit(found, zero)
        at, vector = self.multiplier(zero), self.vector(zero)
        powers = {f"power {k}": abs(at**k - 1) for k in RESONANCES}
        away = Hypothesis("non-resonance", all(z > 0 for z in powers.values()), powers)
        balls = self.others(found, at)
        sizes = {"T": zero[self.time]} | {f"size {i}": abs(z) for i, z in enumerate(balls)}
        inside, outside = sum(abs(z) < 1 for z in balls), sum(abs(z) > 1 for z in balls)
        others = Hypothesis("others", inside + outside == len(balls), sizes)
        speed, bend = self.coefficients(rows, at, vector)
        crossing = Hypothesis("crossing", not speed.contains(0), {"speed": speed})
        bend = bend * self.scale(vector)
        lyapunov = Hypothesis("lyapunov", not bend.contains(0), {"d": bend})
        hypotheses = checked([newton, *checks, away, others, crossing, lyapunov])
        assert orbit.varying is not None
        return ProvedTorus(
            self.claim.kind, dict(zip(orbit.names, zero[:size], strict=True)), orbit.varying, zero[self.varied],
            zero[self.time], at, tuple(balls), inside, 0, outside, speed, bend,
            # The product of two wide balls that are positive need not be.
            "below" if (speed > 0) == (bend > 0) else "above",
            "supercritical" if bend < 0 else "subcritical", hypotheses, self.width, self.bits, self.steps,
        )  # fmt: skip

    def others(self, found: Return, at: acb) -> list[acb]:
        """The multipliers but for 1 and the pair."""
        return multipliers(self.monodromy(found), [linear(1), arb_poly([1, -2 * at.real, 1])])

    def coefficients(self, rows: Sequence[Jet], at: acb, vector: Complex) -> tuple[arb, arb]:
        """The derivative of |lambda| by the parameter, and d for this W. README, Lemmas 12 and 13."""
        size, w = self.size, self.full(vector)
        conjugate = [z.conjugate() for z in w]
        inverse = best_border(self.lines(rows, at), [z.conjugate() for z in self.weights], acb_mat).inv()
        left: Complex = inverse.tolist()[len(vector)][:-1]
        pairing = product(left[:size], vector[:size])
        one, twice = self.lines(rows, acb(1)), self.lines(rows, at * at)
        curve = solve(one, [-acb(row[self.varied,]) for row in rows])
        speed = product(left, form(rows, w, self.full(curve, 1))) / pairing
        mixed = self.full(solve(one, [-z for z in form(rows, w, conjugate)]))
        square = self.full(solve(twice, [-z for z in form(rows, w, w)]))
        terms = form(rows, w, w, conjugate), form(rows, w, mixed), form(rows, conjugate, square)
        bend = product(left, [a + 2 * b + c for a, b, c in zip(*terms, strict=True)]) / (2 * pairing)
        return (at.conjugate() * speed).real, (at.conjugate() * bend).real

    def scale(self, vector: Complex) -> arb:
        """|b|^2, b W being the multiple of W whose product with the vector of the claim is that of this with itself."""
        u, v = (self.coordinates([z.real for z in vector]), self.coordinates([z.imag for z in vector]))
        mine = [acb(a, b) for a, b in zip(u, v, strict=True)]
        claimed = [acb(ball(a), ball(b)) for a, b in zip(*self.claim.kernel, strict=True)]
        length = sum((abs(z) ** 2 for z in claimed), arb(0))
        return abs(length / product([z.conjugate() for z in claimed], mine)) ** 2


def prove_torus(certificate: Mapping[str, Any]) -> ProvedTorus | NotProved:
    """Prove the bifurcation that a certificate claims, from its statement, the centre of its box and its vectors alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    try:
        claim = read_bifurcation(certificate, torus=True)
        if claim.orbit.level is not None or claim.orbit.varying is None:
            raise CannotFollow("a torus is followed while a parameter varies, on no level")
    except CannotFollow as error:
        return NotProved(str(error))
    return attempted(
        claim.orbit,
        lambda bits: _Torus(claim, bits).guess(),
        3,
        lambda bits, start: _Torus(claim, bits, start).conclusion(),
    )
