"""Periodic orbits as zeros: a point for each leg of the period, and the period. README, sections 9.3 and 9.4."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, permutations
from math import prod
from typing import Any, NamedTuple

from flint import arb, arb_mat

from .conditions import Hypothesis, Vector
from .crossing import TIME, crossing_state, first_crossing, moving, sign_of
from .flow import Step, take_step
from .jets import CannotFollow, Jet, ball, combine, precision
from .newton import Newton
from .periodic_statement import PeriodicStatement
from .proof import check_integral, dot

LEG = 24
"""Bits that a leg may lose."""
MOST_STEPS = 10_000


class Start(NamedTuple):
    """A guess of the period, the bits that a leg loses, the shares of the period at which legs end, their begins."""

    period: arb
    lost: int
    shares: Vector
    points: list[Vector]


class Return(NamedTuple):
    """Jets of the coordinates at the ends of legs, the crossings in the direction till then, states at T/q by q."""

    ends: list[list[Jet]]
    crossings: int
    between: dict[int, list[Jet]]


def form(rows: Sequence[Jet], *vectors: Sequence[Any]) -> list[Any]:
    """The symmetric multilinear form of derivatives of this order, at vectors with a component for each variable."""
    orders = list(permutations(vectors))
    return [
        sum(
            (
                c * sum((prod((v[i] for v, i in zip(order, a, strict=True)), start=arb(1)) for order in orders), arb(0))
                for a, c in row.items()
                if len(a) == len(vectors)
            ),
            arb(0),
        )
        for row in rows
    ]


class Legs(Newton):
    """One attempt: the unknowns x_0, .., x_(k-1), mu, what varies, T, and others that a kind of claim has.

    Attributes:
        shares: of the period at which the legs end, the last one 1.
        state: how many unknowns are coordinates of points; `time`: the place of T.
    """

    def __init__(self, statement: PeriodicStatement, bits: int, start: Start | None = None) -> None:
        self.statement, self.bits, self.steps, self.size = statement, bits, 0, len(statement.names)
        points = start.points if start else [[ball(c).mid() for c in statement.centre]]
        self.shares, self.lost = (start.shares, start.lost) if start else ([arb(1)], 0)
        self.state = len(points) * self.size
        more = [arb(0)] * (statement.slopes is not None) + self.varies()
        self.time = self.state + len(more)
        self.centre = [*(x for point in points for x in point), *more, start.period if start else arb(0)]
        self.reach = arb(0)

    def varies(self) -> Vector:
        """The value of what varies, if something does."""
        return []

    def step(self, state: Sequence[Jet], guess: arb) -> tuple[Step, arb, arb]:
        """One step, a time at which it may end, and a guess for the next one."""
        step, guess = take_step(self.statement, state, guess, self.bits)
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise CannotFollow(f"the orbit takes more than {MOST_STEPS} steps")
        end = step.duration
        while not sign_of(step.polynomials[self.statement.section][()](end)):
            end = (end * 7 / 8).mid()
            if end < step.duration / 16:
                raise CannotFollow("no step ends away from the section")
        return step, end, guess

    def begin(self, values: Sequence[arb], degree: int) -> list[Jet]:
        """Jets of x, mu, a parameter that varies, and y, in x, mu and that parameter."""
        statement = self.statement
        state = [Jet({(): value, (j,): arb(1)}, degree) for j, value in enumerate(values)]
        normal = [ball(a) for a in statement.normal]
        return [*state, combine(state[: self.size], normal, degree) - Jet({(): ball(statement.offset)}, degree)]

    def guess(self) -> Start:
        """From the centre to the crossing that is claimed; where too many bits are lost a leg begins, from a point."""
        statement, section = self.statement, self.statement.section
        values, now, guess, sign, count, lost = self.centre[:section], arb(0), arb(1) / 2, 0, 0, 0
        points, cuts, state = [values[: self.size]], Vector(), self.begin(values, 1)
        with precision(self.bits):
            while True:
                step, end, guess = self.step(state, guess)
                piece, sign = first_crossing(step, section, sign, arb(0), end)
                while piece is not None:
                    count += sign == statement.direction
                    if count == statement.crossings and sign == statement.direction:
                        found, moment = crossing_state(statement, step, piece)
                        period = (now + moment).mid()
                        shares = [*((cut / period).mid() for cut in cuts), arb(1)]
                        return Start(period, max(lost, self.lost_in(found)), shares, points)
                    piece, sign = first_crossing(step, section, sign, piece[1], end)
                state, now = step.at(end), (now + end).mid()
                if self.lost_in(state) > LEG:
                    lost = max(lost, self.lost_in(state))
                    values = [jet[()].mid() for jet in state[:section]]
                    state = self.begin(values, 1)
                    points.append(values[: self.size])
                    cuts.append(now)

    def lost_in(self, state: Sequence[Jet]) -> int:
        """The bits that enclosures of x have lost."""
        widest = max(arb(jet[()].rad()) for jet in state[: self.size])
        return max(self.bits + int(float(widest.log() / arb(2).log())), 0) if widest > 0 else 0

    def followed(self, around: Sequence[arb], degree: int) -> Return:
        """Integrate every leg from the points of a set, for their times. README, section 9.3."""
        size, section = self.size, self.statement.section
        rest, period = around[self.state : self.state + section - size], around[self.time]
        ends, count, between = list[list[Jet]](), 0, dict[int, list[Jet]]()
        with precision(self.bits):
            for i, (first, last) in enumerate(pairwise([arb(0), *self.shares])):
                state = self.begin([*around[i * size : (i + 1) * size], *rest], degree)
                sign = sign_of(state[section][()]) if i else 0
                if i and not sign:
                    raise CannotFollow("a leg begins on the section")
                early = {q: period / q - period * first for q in _prime_divisors(self.statement.crossings)}
                is_last = i + 1 == len(self.shares)
                end, crossings = self.leg(state, sign, period * (last - first), is_last, early, between)
                ends.append(end)
                count += crossings
        return Return(ends, count, between)

    def leg(
        self,
        state: list[Jet],
        sign: int,
        duration: arb,
        is_last: bool,
        early: dict[int, arb],
        between: dict[int, list[Jet]],
    ) -> tuple[list[Jet], int]:
        """Jets at its end and the crossings in the direction; the last leg ends with one, others off the section.

        `sign` is that of y where it begins, 0 on the section.
        """
        statement, now, guess, count = self.statement, arb(0), arb(1) / 2, 0
        while not now > duration:
            step, end, guess = self.step(state, guess)
            left = duration - now
            for q, time in early.items():
                if time - now >= 0 and time - now <= step.duration:
                    between.setdefault(q, step.at(time - now))
            is_end = not is_last and abs(left) <= step.duration
            if is_end:
                end = min(left.upper(), step.duration)
                if not sign_of(step.polynomials[statement.section][()](left)):
                    raise CannotFollow("a leg ends on the section")
            self.check_kept(state, step.at(left if is_end else end))
            piece, sign = first_crossing(step, statement.section, sign, arb(0), end)
            while piece is not None:
                count += sign == statement.direction
                if is_last and piece[0] < left and left < piece[1]:
                    return step.at(left), count
                piece, sign = first_crossing(step, statement.section, sign, piece[1], end)
            if is_end:
                return step.at(left), count
            state, now = step.at(end), now + end
        raise CannotFollow("the section is not crossed at the end of the period")

    def check_kept(self, before: Sequence[Jet], after: Sequence[Jet]) -> None:
        """The first integral has points in common with itself, in its derivatives by x too. README, section 9.1."""
        statement, mu = self.statement, self.size
        if statement.integral is not None:
            one, other = (statement.evaluate(statement.integral, jets)[0] for jets in (before, after))
            check_integral(*(Jet({a: c for a, c in jet.items() if mu not in a}, jet.degree) for jet in (one, other)))

    def evaluated(self, around: Sequence[arb], degree: int) -> tuple[Return, list[Jet]]:
        """What was followed, and jets of E."""
        found = self.followed(around, degree)
        return found, self.returned(found, around, degree)

    def returned(self, found: Return, around: Sequence[arb], degree: int) -> list[Jet]:
        """Jets of E, by the numbers of the unknowns, T being `TIME`. README, section 9.3."""
        orbit, size = self.statement, self.size
        rows = list[Jet]()
        for i, (first, last) in enumerate(pairwise([arb(0), *self.shares])):
            for jet in moving(orbit, found.ends[i])[:size]:
                named = {
                    tuple(v if v == TIME else v + (i * size if v < size else self.state - size) for v in a): (
                        c * (last - first) ** a.count(TIME)
                    )
                    for a, c in jet.items()
                }
                rows.append(Jet(named, degree))
        signs = orbit.symmetry or [1] * size
        rows = [*(row * sign for row, sign in zip(rows[-size:], signs, strict=True)), *rows[:-size]]
        start = self.begin(around[:size], degree)
        rows.append(start[size])
        if orbit.integral is not None and orbit.level is not None:
            more = [
                Jet({(): c, (self.state + j,): arb(1)}, degree) for j, c in enumerate(around[self.state : self.time])
            ]
            height = Jet({(): ball(orbit.level)}, degree) if orbit.varying is not None or len(more) == 1 else more[-1]
            rows.append(orbit.evaluate(orbit.integral, [*start[:size], *more, start[size]])[0] - height)
        return rows

    def slopes(self, rows: Sequence[Jet], sigma: int = 1) -> list[Vector]:
        """D E - J_sigma, by the x_i, mu and T."""
        columns = self.columns
        return [
            [row[v,] - int(i == v < self.state) * (sigma if i < self.size else 1) for v in columns]
            for i, row in enumerate(rows)
        ]

    @property
    def columns(self) -> list[int]:
        """Variables of jets in X = (x_0, .., x_(k-1), mu, T)."""
        return [*range(self.state + (self.statement.slopes is not None)), TIME]

    def defects(self, rows: Sequence[Jet]) -> Vector:
        """G at the centre."""
        return [row[()] - (self.centre[i] if i < self.state else 0) for i, row in enumerate(rows)]

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivatives of all equations by all unknowns, at the points of a set."""
        return self.slopes(rows)

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of all equations at the centre."""
        return self.defects(rows)

    def names(self) -> list[str]:
        """The names of all unknowns."""
        legs = range(len(self.shares))
        points = [f"{name} {i}" if i else name for i in legs for name in self.statement.names]
        more = ["mu"] * (self.statement.slopes is not None)
        more += ["a"] * (self.time - self.state - len(more))
        return [*points, *more, "T", *(f"W {i}" for i in range(len(self.centre) - self.time - 1))]

    def check_orbit(self, found: Return, zero: Vector) -> tuple[list[Hypothesis], arb | None]:
        """T is the least time of return as claimed; and the value of the first integral on its level."""
        statement, point, level = self.statement, zero[: self.size], None
        state = [
            Jet({(): x}, 0) for x in (*point, *zero[self.state : self.state + statement.section - self.size], arb(0))
        ]
        speed = [f[()] for f in statement.evaluate(statement.field, state)]
        rate = dot([ball(a) for a in statement.normal], speed)
        checks = [Hypothesis("direction", rate * statement.direction > 0, {"rate": rate})]
        checks.append(Hypothesis("crossings", found.crossings == statement.crossings, {"T": zero[self.time]}))
        if statement.slopes is not None and statement.integral is not None:
            level = statement.evaluate(statement.integral, state)[0][()]
            slopes = [slope[()] for slope in statement.evaluate(statement.slopes, state)]
            kept = dot(slopes, speed).contains(0) and any(not slope.contains(0) for slope in slopes)
            checks.append(Hypothesis("gradient", kept, dict(zip(statement.names, slopes, strict=True))))
        signs = statement.symmetry or [1] * self.size
        for q in _prime_divisors(statement.crossings):
            between = found.between.get(q, [])
            apart = [jet[()] * sign - x for jet, sign, x in zip(between, signs, point, strict=False)]
            away = any(not d.contains(0) for d in apart)
            checks.append(Hypothesis(f"least period, T/{q}", away, dict(zip(statement.names, apart, strict=False))))
        return checks, level

    def monodromy(self, found: Return) -> arb_mat:
        """The derivative by x_0 of the end of the last leg, mapped by S if there is one."""
        signs, product = self.statement.symmetry or [1] * self.size, None
        for end in found.ends:
            factor = arb_mat([[end[i][j,] for j in range(self.size)] for i in range(self.size)])
            product = factor if product is None else factor * product
        assert product is not None
        return arb_mat([[entry * sign for entry in row] for row, sign in zip(product.tolist(), signs, strict=True)])


def _prime_divisors(number: int) -> list[int]:
    return [q for q in range(2, number + 1) if number % q == 0 and all(q % r for r in range(2, q))]
