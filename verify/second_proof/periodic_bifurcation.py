"""A fold or a period doubling of periodic orbits without symmetry once more. README, section 10."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import factorial, prod
from typing import Any

from flint import acb, arb, arb_mat

from .conditions import Hypothesis, Vector
from .crossing import TIME, moving
from .jets import CannotFollow, Jet, ball, combine, precision
from .multipliers import multipliers
from .periodic import (
    PeriodicProof,
    PeriodicStatement,
    Return,
    attempted,
    checked,
    monodromy,
    read_periodic,
)
from .proof import NEWTON_STEPS, NotProved, dot
from .statement import BadCertificate, exact, read

SIGMA = {"periodic-fold": 1, "periodic-doubling": -1}
"""The multiplier of each kind that is followed."""
KNOWN = 192
"""Bits beyond thrice those that are lost."""


@dataclass(frozen=True)
class BifurcationStatement:
    """What a certificate claims of a bifurcation: the orbit, what varies, a vector in the coordinates of the box.

    Attributes:
        value: what varies is near it; `orbit.varying` is its name, `None` for the level.
    """

    kind: str
    orbit: PeriodicStatement
    value: Fraction
    kernel: tuple[Fraction, ...]

    @property
    def sigma(self) -> int:
        """The multiplier."""
        return SIGMA[self.kind]


def read_bifurcation(certificate: Mapping[str, Any]) -> BifurcationStatement:
    """The statement of a certificate of a bifurcation. Raises `BadCertificate`, and `CannotFollow` for other kinds."""
    claim = "statement.candidate"
    kind, name = read(certificate, f"{claim}.kind", str), read(certificate, claim, dict).get("parameter")
    if kind not in SIGMA:
        raise CannotFollow(f"no theorem that is used here is about {kind}")
    orbit, kernel = read_periodic(certificate), read(certificate, f"{claim}.kernel", exact)
    if len(kernel) != 1 or len(kernel[0]) != len(orbit.names) - 1 or not any(kernel[0]):
        raise BadCertificate(f"{claim}.kernel: no vector in the coordinates of the box")
    value = orbit.level if name is None else orbit.parameters.get(name)
    if value is None or name in orbit.names:
        raise BadCertificate(f"{claim}.parameter: neither a parameter nor a level varies")
    return BifurcationStatement(kind, replace(orbit, varying=name), value, kernel[0])


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
        criticality: of a doubling without level, whether -1 is passed outwards or inwards to where the new orbits are.
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
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


def derivative(jet: Jet, *variables: int) -> Any:
    """The partial derivative by these variables at the point that a jet is about."""
    return jet[tuple(sorted(variables))] * prod(factorial(variables.count(v)) for v in set(variables))


def form(rows: Sequence[Jet], *vectors: Mapping[int, arb]) -> Vector:
    """The symmetric multilinear form of derivatives, at vectors given by their components along the variables."""
    return [
        sum(
            (derivative(row, *places) * prod(v[i] for v, i in zip(vectors, places, strict=True))
             for places in product(*vectors)),
            arb(0),
        )
        for row in rows
    ]  # fmt: skip


class _Proof(PeriodicProof):
    """One attempt: the centre in (x, mu, T), in what varies, and in the vector W, all moved by Newton's method.

    Attributes:
        unknowns: variables of jets in X = (x, mu, T); `varied`: of a.
    """

    def __init__(self, claim: BifurcationStatement, bits: int, start: tuple[arb, int] | None = None) -> None:
        super().__init__(claim.orbit, bits, start)
        self.claim, self.varied, size = claim, len(self.centre), len(claim.orbit.names)
        self.unknowns = [*range(self.varied), TIME]
        self.centre.append(ball(claim.value).mid())
        columns = [dot([ball(a) for a in row], [ball(k) for k in claim.kernel]).mid() for row in claim.orbit.frame]
        self.vector: Vector = columns + [arb(0)] * (len(self.unknowns) - size)

    def returned(self, found: Return, around: Sequence[arb], degree: int) -> list[Jet]:
        """Jets of E in X and a, at the points (x, mu, a) of a set and their times of return. README, section 10.2."""
        orbit, size = self.statement, len(self.statement.names)
        start = [Jet({(): c, (j,): arb(1)}, degree) for j, c in enumerate(around)]
        rows = moving(orbit, found.state)[:size]
        rows.append(combine(start[:size], [ball(a) for a in orbit.normal], degree) - _constant(orbit.offset, degree))
        if orbit.integral is not None and orbit.level is not None:
            height = start[self.varied] if orbit.varying is None else _constant(orbit.level, degree)
            rows.append(orbit.evaluate(orbit.integral, start)[0] - height)
        return rows

    def slopes(self, rows: Sequence[Jet], sigma: int) -> list[Vector]:
        """D E - sigma J, by X."""
        size = len(self.statement.names)
        return [
            [derivative(row, v) - sigma * int(i == j < size) for j, v in enumerate(self.unknowns)]
            for i, row in enumerate(rows)
        ]

    def along(self, vector: Sequence[arb]) -> dict[int, arb]:
        """A vector in X by the variables."""
        return dict(zip(self.unknowns, vector, strict=True))

    def extended(self, rows: Sequence[Jet], vector: Sequence[arb]) -> arb_mat:
        """The derivative of the extended system by X, a and W."""
        n, one = len(self.unknowns), arb(1)
        bent = [form(rows, self.along(vector), {v: one}) for v in (*self.unknowns, self.varied)]
        upper = [
            [*line, derivative(row, self.varied), *[arb(0)] * n]
            for line, row in zip(self.slopes(rows, 1), rows, strict=True)
        ]
        lower = [[*(column[i] for column in bent), *line] for i, line in enumerate(self.slopes(rows, self.claim.sigma))]
        return arb_mat([*upper, *lower, [*[arb(0)] * (n + 1), *self.weights]])

    def zeros(self, rows: Sequence[Jet]) -> arb_mat:
        """The extended system at the centre."""
        size, vector = len(self.statement.names), self.vector
        first = [row[()] - (self.centre[i] if i < size else 0) for i, row in enumerate(rows)]
        second = [dot(line, vector) for line in self.slopes(rows, self.claim.sigma)]
        return arb_mat([[value] for value in (*first, *second, dot(self.weights, vector) - self.length)])

    def converge(self) -> list[Jet]:
        """Move the centre to the bifurcation by Newton's method; jets of E from it in the end."""
        small, n = arb(2) ** (self.lost + KNOWN // 2 - self.bits), len(self.unknowns)
        for turn in range(NEWTON_STEPS):
            none = [arb(0)] * self.statement.section
            found = self.followed(none, self.period, 2)
            rows = self.returned(found, self.centre, 2)
            if turn == 0:
                # The last component from those of the state: (M - sigma) w + tau f is about 0.
                lines = self.slopes(rows, self.claim.sigma)[: len(self.statement.names)]
                speed, rest = [line[-1] for line in lines], [dot(line, self.vector) for line in lines]
                self.vector[-1] = (-dot(speed, rest) / dot(speed, speed)).mid()
                self.weights, self.length = list(self.vector), dot(self.vector, self.vector)
            matrix = self.extended(rows, self.vector)
            moves = [move for (move,) in matrix.solve(self.zeros(rows)).tolist()]
            largest = max(abs(move) for move in moves)
            if largest < small:
                self.reach = max(largest.abs_upper() * 256, small * arb(2) ** -(KNOWN // 4)).mid()
                return rows
            if not largest < arb(2) ** -8:
                break
            *x, time, a = moves[: n + 1]
            self.centre = [(c - move).mid() for c, move in zip(self.centre, [*x, a], strict=True)]
            self.period = (self.period - time).mid()
            self.vector = [(c - move).mid() for c, move in zip(self.vector, moves[n + 1 :], strict=True)]
        raise CannotFollow("Newton's method does not converge from the centre of the certificate")

    def concluded(self) -> ProvedPeriodicBifurcation:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        claim, orbit, n, size = self.claim, self.statement, len(self.unknowns), len(self.statement.names)
        exactly, spread = self.zeros(self.converge()), arb(0, self.reach)
        degree = 2 if claim.sigma == 1 else 3
        found = self.followed([spread] * orbit.section, self.period + spread, degree)
        rows = self.returned(found, [c + spread for c in self.centre], degree)
        matrix = self.extended(rows, [c + spread for c in self.vector])
        moves = [-move for (move,) in matrix.solve(exactly).tolist()]
        names = [*orbit.names, *(["mu"] if orbit.slopes is not None else []), "T", "a"]
        names += [f"W{i}" for i in range(n)]
        newton = self.check_newton(dict(zip(names, moves, strict=True)))
        *x, time, a = moves[: n + 1]
        point = [c + move for c, move in zip(self.centre, [*x, a], strict=True)]
        period, value = self.period + time, point[-1]
        vector = [c + move for c, move in zip(self.vector, moves[n + 1 :], strict=True)]
        checks, level = self.check_orbit(found, point, period)
        side, kappa, outwards = self.coefficients(rows, vector)
        hypotheses = checked([newton, *checks, side])
        balls = multipliers(monodromy(found, size), 1 if level is None else 2, [claim.sigma])
        on = int(len(balls) == 1 and orbit.keeps_volume())
        if on:
            balls = [acb(claim.sigma)]
        inside, outside = sum(abs(z) < 1 for z in balls), sum(abs(z) > 1 for z in balls)
        opening = kappa * self.scale(vector) ** 2
        criticality = None
        if claim.sigma == -1 and level is None and outwards.is_finite() and not outwards.contains(0):
            criticality = "supercritical" if outwards > 0 else "subcritical"
        return ProvedPeriodicBifurcation(
            claim.kind, dict(zip(orbit.names, point, strict=False)), orbit.varying, value,
            None if orbit.varying is None else level, period, claim.sigma, tuple(balls), inside, on, outside,
            "above" if kappa > 0 else "below", opening, criticality, hypotheses, self.width, self.bits, self.steps,
        )  # fmt: skip

    def coefficients(self, rows: Sequence[Jet], vector: Sequence[arb]) -> tuple[Hypothesis, arb, arb]:
        """That alpha and beta, or gamma and c, are not 0; kappa; c/(l J W) of a doubling. README, 10.4, 10.5."""
        sigma, size = self.claim.sigma, len(self.statement.names)
        kernel, by_a = self.along(vector), [derivative(row, self.varied) for row in rows]
        left = self.left_kernel(rows)
        if sigma == 1:
            speed, bend = dot(left, by_a), dot(left, form(rows, kernel, kernel)) / 2
            outwards = arb(0)
        else:
            inverse = arb_mat(self.slopes(rows, 1)).inv()
            curve, even = (
                self.along([-entry for (entry,) in (inverse * arb_mat([[value] for value in values])).tolist()])
                for values in (by_a, [value / 2 for value in form(rows, kernel, kernel)])
            )
            speed = dot(left, form(rows, kernel, curve | {self.varied: arb(1)}))
            cubic = [value / 6 for value in form(rows, kernel, kernel, kernel)]
            bend = dot(left, form(rows, kernel, even)) + dot(left, cubic)
            outwards = bend / dot(left[:size], vector[:size])
        kappa = -bend / speed
        away = not speed.contains(0) and not bend.contains(0) and not kappa.contains(0)
        return Hypothesis("side", away, {"of a": speed, "of y^2": bend, "kappa": kappa}), kappa, outwards

    def left_kernel(self, rows: Sequence[Jet]) -> Vector:
        """l with l (D E - sigma J) = 0 at the bifurcation, one component 1. README, section 10.3."""
        lines, n = self.slopes(rows, self.claim.sigma), len(self.unknowns)

        def bordered(k: int) -> arb_mat:
            upper = [[*line, arb(int(i == k))] for i, line in enumerate(lines)]
            return arb_mat([*upper, [*self.weights, arb(0)]])

        best = max(range(n), key=lambda k: float(abs(bordered(k).det().mid())))
        last: Vector = bordered(best).inv().tolist()[n]
        return last[:n]

    def scale(self, vector: Sequence[arb]) -> arb:
        """By what the vector is multiplied so that its product with the one of the claim is that one's with itself."""
        orbit, kernel = self.statement, [ball(k) for k in self.claim.kernel]
        lines = [[*map(ball, row), ball(a)] for row, a in zip(orbit.frame, orbit.normal, strict=True)]
        *found, _ = arb_mat(lines).solve(arb_mat([[w] for w in vector[: len(orbit.names)]])).tolist()
        return dot(kernel, kernel) / dot(kernel, [p for (p,) in found])


def _constant(value: Fraction, degree: int) -> Jet:
    return Jet({(): ball(value)}, degree)


def prove_bifurcation(certificate: Mapping[str, Any]) -> ProvedPeriodicBifurcation | NotProved:
    """Prove the bifurcation that a certificate claims, from its statement, the centre of its box and its vector alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    try:
        claim = read_bifurcation(certificate)
    except CannotFollow as error:
        return NotProved(str(error))

    def prove(start: tuple[arb, int]) -> ProvedPeriodicBifurcation:
        # Third derivatives lose what a box of that width does once more.
        fine = 3 * start[1] + KNOWN
        with precision(fine):
            return _Proof(claim, fine, start).concluded()

    return attempted(claim.orbit, lambda bits: _Proof(claim, bits).guess(), prove)
