"""A fold, a doubling or a pitchfork of periodic orbits without symmetry once more. README, section 10."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import acb, arb, arb_mat

from .conditions import Hypothesis, Vector
from .jets import CannotFollow, Jet, ball
from .legs import Legs, Return, Start, form
from .multipliers import apart, linear, multipliers
from .newton import checked, solved
from .periodic import attempted
from .periodic_statement import PeriodicStatement, read_periodic
from .proof import NotProved, dot
from .statement import BadCertificate, exact, read

SIGMA = {"periodic-fold": 1, "periodic-doubling": -1, "periodic-pitchfork": -1}
"""The multiplier of each kind that is followed, of a pitchfork that of the return under S."""


@dataclass(frozen=True)
class BifurcationStatement:
    """What a certificate claims of a bifurcation: the orbit, what varies, vectors in the coordinates of the box.

    Attributes:
        value: what varies is near it; `orbit.varying` is its name, `None` for the level.
        kernel: one vector; of a torus its real and its imaginary part, and `multiplier` has cosine and sine.
    """

    kind: str
    orbit: PeriodicStatement
    value: Fraction
    kernel: tuple[tuple[Fraction, ...], ...]
    multiplier: tuple[Fraction, ...] = ()

    @property
    def sigma(self) -> int:
        """The multiplier."""
        return SIGMA[self.kind]


def read_bifurcation(certificate: Mapping[str, Any], torus: bool = False) -> BifurcationStatement:
    """The statement of a certificate of a bifurcation. Raises `BadCertificate`, and `CannotFollow` for other kinds."""
    claim = "statement.candidate"
    kind, given = read(certificate, f"{claim}.kind", str), read(certificate, claim, dict)
    if not torus and kind not in SIGMA:
        raise CannotFollow(f"no theorem that is used here is about {kind}")
    orbit, kernel = read_periodic(certificate), read(certificate, f"{claim}.kernel", exact)
    size, name, signs = len(orbit.names), given.get("parameter"), None
    if len(kernel) != 1 + torus or any(len(row) != size - 1 or not any(row) for row in kernel):
        raise BadCertificate(f"{claim}.kernel: no vector in the coordinates of the box")
    value = orbit.level if name is None else orbit.parameters.get(name)
    if value is None or name in orbit.names:
        raise BadCertificate(f"{claim}.parameter: neither a parameter nor a level varies")
    multiplier = read(certificate, f"{claim}.multiplier", exact) if torus else ()
    if len(multiplier) != 2 * torus:
        raise BadCertificate(f"{claim}.multiplier: not a cosine and a sine")
    if kind == "periodic-pitchfork":
        matrix = read(certificate, f"{claim}.symmetry", exact)
        if len(matrix) != size or any(len(row) != size for row in matrix):
            raise BadCertificate(f"{claim}.symmetry: no matrix for the state")
        signs = tuple(int(row[i]) for i, row in enumerate(matrix))
        if any(
            sign not in (1, -1) or row != tuple(sign * (i == j) for j in range(size))
            for i, (sign, row) in enumerate(zip(signs, matrix, strict=True))
        ):
            raise CannotFollow("an S that does not act on the coordinates by signs is not followed")
    elif given.get("symmetry") is not None:
        raise BadCertificate(f"{claim}.symmetry: {kind} has none")
    return BifurcationStatement(kind, replace(orbit, varying=name, symmetry=signs), value, kernel, multiplier)


@dataclass(frozen=True)
class ProvedPeriodicBifurcation:
    """The bifurcation is proved.

    Attributes:
        kind: as claimed.
        point, period, multipliers, inside, on, outside, hypotheses, width, bits, steps: as of `ProvedPeriodic`, for the
            orbit that bifurcates; without the multiplier that is `known`, 1 or -1.
        name, parameter: what varies, `None` for the level, and its value.
        level: enclosure of the first integral if a parameter varies on a level.
        side: where the new orbits are, above or below this value; `opening`: kappa of Lemmas 9 and 10, for the vector
            in the claim.
        criticality: of a doubling or a pitchfork without level, whether -1 is passed outwards or inwards to where the
            new orbits are.
        is_fixed: of a pitchfork, whether the orbit lies in Fix(S); if not, S moves it by half a period.
    """

    kind: str
    point: dict[str, arb]
    name: str | None
    parameter: arb
    level: arb | None
    period: arb
    known: int
    multipliers: tuple[acb, ...]
    inside: int
    on: int
    outside: int
    side: str
    opening: arb
    criticality: str | None
    is_fixed: bool | None
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


class VaryingLegs(Legs):
    """An attempt with something that varies, and vectors of which the first components are claimed.

    Attributes:
        varied: the place of what varies, between mu and T; W has no component there.
    """

    degree = 2, 3

    def __init__(self, claim: BifurcationStatement, bits: int, start: Start | None = None) -> None:
        self.claim = claim
        super().__init__(claim.orbit, bits, start)
        self.varied = self.time - 1
        frame = claim.orbit.frame
        self.claimed = [
            [dot([ball(a) for a in row], [ball(k) for k in kernel]).mid() for row in frame] for kernel in claim.kernel
        ]

    def varies(self) -> Vector:
        """The value near which it is."""
        return [ball(self.claim.value).mid()]

    def full(self, vector: Sequence[Any], a: int = 0) -> list[Any]:
        """A vector in X with a component for what varies."""
        return [*vector[:-1], a, vector[-1]]

    def equations(self, rows: Sequence[Jet]) -> list[Vector]:
        """The derivatives of G by X and what varies, in the order of the unknowns."""
        return [[*line[:-1], row[self.varied,], line[-1]] for line, row in zip(self.slopes(rows), rows, strict=True)]

    def bent(self, rows: Sequence[Jet], vector: Sequence[arb]) -> list[Vector]:
        """The derivatives of D E W by X and what varies, in the order of the unknowns."""
        n = self.time + 1
        units = [[arb(int(i == j)) for i in range(n)] for j in range(n)]
        return [list(line) for line in zip(*(form(rows, self.full(vector), unit) for unit in units), strict=True)]

    def coordinates(self, vector: Sequence[arb]) -> Vector:
        """Coordinates in the box of a vector along the section, given by its components in the state."""
        orbit = self.statement
        lines = [[*map(ball, row), ball(a)] for row, a in zip(orbit.frame, orbit.normal, strict=True)]
        return solved(lines, vector[: self.size])[:-1]


def best_border(lines: Sequence[Sequence[Any]], below: Sequence[Any], matrix: Any) -> Any:
    """A matrix bordered by a unit vector and a row: the one of these with the largest determinant about."""

    def bordered(k: int) -> Any:
        return matrix([*([*line, int(i == k)] for i, line in enumerate(lines)), [*below, 0]])

    return bordered(max(range(len(lines)), key=lambda k: float(abs(bordered(k).det().mid()).mid())))


class _Proof(VaryingLegs):
    """One attempt: the unknowns are those of the orbit, what varies, and the vector W."""

    def __init__(self, claim: BifurcationStatement, bits: int, start: Start | None = None) -> None:
        super().__init__(claim, bits, start)
        if claim.sigma == 1:
            self.degree = 2, 2

    def vector(self, unknowns: Sequence[arb]) -> Vector:
        """W."""
        return list(unknowns[self.time + 1 :])

    def prepare(self, rows: Sequence[Jet]) -> None:
        """A first W, which is W_0: where D_sigma W is a multiple of a unit vector and w_0 near that of the claim."""
        (claimed,), lines = self.claimed, self.slopes(rows, self.claim.sigma)
        below = [*claimed, *[arb(0)] * (len(lines) - self.size)]
        *found, _ = (
            best_border(lines, below, arb_mat).solve(arb_mat([*[[0]] * len(lines), [dot(claimed, claimed)]])).tolist()
        )
        self.weights = [w.mid() for (w,) in found]
        self.length = dot(self.weights, self.weights)
        self.centre = [*self.centre, *self.weights]

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivative of the extended system by X, a and W."""
        n, lines = len(self.columns), self.slopes(rows, self.claim.sigma)
        upper = [[*line, *[arb(0)] * n] for line in self.equations(rows)]
        lower = [[*b, *line] for b, line in zip(self.bent(rows, self.vector(around)), lines, strict=True)]
        return [*upper, *lower, [*[arb(0)] * (n + 1), *self.weights]]

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The extended system at the centre."""
        vector = self.vector(self.centre)
        second = [dot(line, vector) for line in self.slopes(rows, self.claim.sigma)]
        return [*self.defects(rows), *second, dot(self.weights, vector) - self.length]

    def conclusion(self) -> ProvedPeriodicBifurcation:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        claim, orbit = self.claim, self.statement
        newton, zero, found, rows = self.enclosed()
        point, period, value, vector = zero[: self.size], zero[self.time], zero[self.varied], self.vector(zero)
        checks, level = self.check_orbit(found, zero)
        is_fixed, mirrored = self.mirrored(zero) if orbit.symmetry is not None else (None, [])
        side, kappa, outwards = self.coefficients(rows, vector)
        hypotheses = checked([newton, *checks, *mirrored, side])
        known, balls = self.multipliers(found, 1 if level is None else 2, is_fixed)
        on = int(len(balls) == 1 and orbit.keeps_volume())
        if on:
            balls = [acb(known)]
        inside, outside = sum(abs(z) < 1 for z in balls), sum(abs(z) > 1 for z in balls)
        opening, criticality = kappa * self.scale(vector) ** 2, None
        if level is None and outwards.is_finite() and not outwards.contains(0):
            criticality = "supercritical" if outwards > 0 else "subcritical"
        return ProvedPeriodicBifurcation(
            claim.kind, dict(zip(orbit.names, point, strict=True)), orbit.varying, value,
            None if orbit.varying is None else level, 2 * period if is_fixed is False else period, known, tuple(balls),
            inside, on, outside, "above" if kappa > 0 else "below", opening, criticality, is_fixed, hypotheses,
            self.width, self.bits, self.steps,
        )  # fmt: skip

    def multipliers(self, found: Return, trivial: int, is_fixed: bool | None) -> tuple[int, list[acb]]:
        """The one that is known of the orbit, and the others. README, section 10.7."""
        matrix, factors = self.monodromy(found), [linear(1)] * trivial
        if is_fixed is not None:
            balls = multipliers(matrix, [*factors, linear(-1)])
            if is_fixed is False:
                return 1, apart([z * z for z in balls])
            signs = self.statement.symmetry or ()
            matrix = arb_mat([[x * sign for x in row] for row, sign in zip(matrix.tolist(), signs, strict=True)])
            return 1, multipliers(matrix, [*factors, linear(1)])
        return self.claim.sigma, multipliers(matrix, [*factors, linear(self.claim.sigma)])

    def mirrored(self, zero: Vector) -> tuple[bool, list[Hypothesis]]:
        """Where S takes the point: whether S x = x, and that this or that it is another one is shown. README, 10.6."""
        orbit, size = self.statement, self.size
        signs = [*(orbit.symmetry or ()) * len(self.shares), *[1] * (len(self.columns) - self.state)]
        point = zero[:size]
        away = [x * sign - x for x, sign in zip(point, signs, strict=False)]
        if any(not d.contains(0) for d in away):
            return False, [Hypothesis("S moves the point", True, dict(zip(orbit.names, away, strict=True)))]
        turned = [w * sign for w, sign in zip(self.vector(zero), signs, strict=True)]
        factor = self.length / dot(self.weights, turned)
        image = [x * sign for x, sign in zip(zero[: self.state], signs, strict=False)] + zero[
            self.state : self.time + 1
        ]
        image += [w * factor for w in turned]
        moves = [x - c for x, c in zip(image, self.centre, strict=True)]
        inside = all(abs(move) < self.reach for move in moves) and factor < 0
        return True, [Hypothesis("in Fix(S)", inside, {"factor": factor} | dict(zip(self.names(), moves, strict=True)))]

    def coefficients(self, rows: Sequence[Jet], vector: Sequence[arb]) -> tuple[Hypothesis, arb, arb]:
        """Whether alpha and beta, or gamma and c, are not 0; kappa; c/(l J' W), 0 for a fold. README, 10.4, 10.5."""
        sigma, size = self.claim.sigma, self.size
        kernel, by_a = self.full(vector), [row[self.varied,] for row in rows]
        left = self.left_kernel(rows)
        if sigma == 1:
            speed, bend = dot(left, by_a), dot(left, form(rows, kernel, kernel)) / 2
            outwards = arb(0)
        else:
            slopes = self.slopes(rows)
            curve, even = (
                [-entry for entry in solved(slopes, values)]
                for values in (by_a, [value / 2 for value in form(rows, kernel, kernel)])
            )
            speed = dot(left, form(rows, kernel, self.full(curve, 1)))
            cubic = [value / 6 for value in form(rows, kernel, kernel, kernel)]
            bend = dot(left, form(rows, kernel, self.full(even))) + dot(left, cubic)
            outwards = bend / dot(left[:size], vector[:size])
        kappa = -bend / speed
        away = not speed.contains(0) and not bend.contains(0) and not kappa.contains(0)
        return Hypothesis("side", away, {"of a": speed, "of y^2": bend, "kappa": kappa}), kappa, outwards

    def left_kernel(self, rows: Sequence[Jet]) -> Vector:
        """l with l (D E - J_sigma) = 0 at the bifurcation, one component 1. README, section 10.3."""
        lines = self.slopes(rows, self.claim.sigma)
        last: Vector = best_border(lines, self.weights, arb_mat).inv().tolist()[len(lines)]
        return last[:-1]

    def scale(self, vector: Sequence[arb]) -> arb:
        """By what the vector is multiplied so that its product with the one of the claim is that one's with itself."""
        kernel = [ball(k) for k in self.claim.kernel[0]]
        return dot(kernel, kernel) / dot(kernel, self.coordinates(vector))


def prove_bifurcation(certificate: Mapping[str, Any]) -> ProvedPeriodicBifurcation | NotProved:
    """Prove the bifurcation that a certificate claims, from its statement, the centre of its box and its vector alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    try:
        claim = read_bifurcation(certificate)
    except CannotFollow as error:
        return NotProved(str(error))
    return attempted(
        claim.orbit,
        lambda bits: _Proof(claim, bits).guess(),
        3,
        lambda bits, start: _Proof(claim, bits, start).conclusion(),
    )
