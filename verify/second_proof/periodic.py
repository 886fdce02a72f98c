"""A periodic orbit without symmetry once more: the flow over the period has a fixed point. README, section 9."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from flint import acb, arb, arb_mat

from .conditions import Hypothesis
from .crossing import crossing_state, first_crossing, sign_of
from .flow import take_step
from .jets import CannotFollow, Jet, ball, combine, precision
from .multipliers import multipliers
from .proof import NEWTON_STEPS, NotProved, check_integral, dot
from .statement import BadCertificate, Program, exact, read

Result = TypeVar("Result")
ROUGH, KNOWN = (160, 320, 640), 128
"""Bits of the first integration, tried one after the other; of the others beyond twice those that are lost."""
MOST_STEPS = 10_000
ERRORS = (ArithmeticError, ValueError, TypeError, MemoryError)
DEPENDENCE = {name: lambda a, b: a | b for name in "+-*/"} | {"**": lambda a, exponent: a}
"""For the sets of names on which lines depend."""


def gradient(program: Program, names: Sequence[str]) -> Program:
    """The partial derivatives of a program with one output, by reverse accumulation. README, section 9.2."""
    lines, adjoint = list(program.lines), dict[int, int]()

    def line(operation: str, *operands: Any) -> int:
        lines.append((operation, operands))
        return len(lines) - 1

    def add(place: int, term: int) -> None:
        adjoint[place] = line("+", adjoint[place], term) if place in adjoint else term

    zero, minus = line("constant", Fraction(0)), line("constant", Fraction(-1))
    adjoint[program.outputs[0]] = line("constant", Fraction(1))
    for place, (operation, (left, *more)) in reversed(list(enumerate(program.lines))):
        if place not in adjoint or operation in ("name", "constant"):
            continue
        factor, right = adjoint[place], more[0]
        if operation in "+-":
            add(left, factor)
            add(right, factor if operation == "+" else line("*", minus, factor))
        elif operation == "*":
            add(left, line("*", factor, right))
            add(right, line("*", factor, left))
        elif operation == "/":
            add(left, line("/", factor, right))
            add(right, line("*", minus, line("/", line("*", factor, place), right)))
        elif right:
            slope = line("*", line("constant", right), line("**", left, right - 1))
            add(left, line("*", factor, slope))
    places = {operands[0]: n for n, (operation, operands) in enumerate(program.lines) if operation == "name"}
    return Program(tuple(lines), tuple(adjoint.get(places.get(name, -1), zero) for name in names))


@dataclass(frozen=True)
class PeriodicStatement:
    """What a certificate claims of a periodic orbit: the field, a section in a direction, its crossings, the box.

    Followed are x, with a first integral mu, and the height y = a . x - b. README, section 9.1.

    Attributes:
        integral, slopes: the first integral and its gradient; `None` where no level is claimed, as `level`.
        varying: a parameter that is followed as a coordinate with rate 0, before y; `parameters` has a value near it.
    """

    names: tuple[str, ...]
    parameters: Mapping[str, Fraction]
    field: Program
    integral: Program | None
    slopes: Program | None
    level: Fraction | None
    normal: tuple[Fraction, ...]
    offset: Fraction
    direction: int
    crossings: int
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    varying: str | None = None

    @property
    def section(self) -> int:
        """The coordinate y."""
        return len(self.names) + (self.slopes is not None) + (self.varying is not None)

    def evaluate(self, program: Program, state: Sequence[Jet]) -> list[Jet]:
        """The outputs of a program at x."""

        def constant(value: Fraction) -> Jet:
            return Jet({(): ball(value)}, state[0].degree)

        known = {name: constant(value) for name, value in self.parameters.items()}
        if self.varying is not None:
            known[self.varying] = state[self.section - 1]
        return program.run(known | dict(zip(self.names, state, strict=False)), constant)

    def velocity(self, state: Sequence[Jet]) -> list[Jet]:
        """f + mu grad H, mu' = 0, the rate 0 of what varies, and y'."""
        rows, still = self.evaluate(self.field, state), list[Jet]()
        if self.slopes is not None:
            mu = state[len(self.names)]
            rows = [f + mu * slope for f, slope in zip(rows, self.evaluate(self.slopes, state), strict=True)]
            still = [Jet({}, state[0].degree)]
        still += [Jet({}, state[0].degree)] * (self.varying is not None)
        return [*rows, *still, combine(rows, [ball(a) for a in self.normal], state[0].degree)]

    def keeps_volume(self) -> bool:
        """Whether no component of the field depends on its own coordinate: then its divergence is 0."""
        inputs = {name: frozenset({name}) for name in (*self.names, *self.parameters)}
        found = self.field.run(inputs, lambda _: frozenset(), DEPENDENCE)
        return all(name not in used for name, used in zip(self.names, found, strict=True))

    def check(self) -> None:
        """The box lies in the section, and is as many-dimensional as that is."""
        columns = list(zip(*self.frame, strict=True))
        flat = all(sum(map(operator.mul, self.normal, column)) == 0 for column in columns)
        if not any(self.normal) or not flat or sum(map(operator.mul, self.normal, self.centre)) != self.offset:
            raise CannotFollow("the box does not lie in the section")


def read_periodic(certificate: Mapping[str, Any]) -> PeriodicStatement:
    """The statement of a certificate of a periodic orbit. Raises `BadCertificate`."""
    claim, words = "statement.candidate", read(certificate, "statement", dict)
    given = read(certificate, claim, dict)
    field = read(certificate, "statement.vector_field", Program.from_text)
    names = field.inputs[: len(field.outputs)]
    parameters = read(certificate, f"{claim}.parameters", lambda known: {n: exact(v) for n, v in known.items()})
    level = None if given.get("level") is None else read(certificate, f"{claim}.level", exact)
    integral = None
    if level is not None:
        integral = read(certificate, "statement.first_integral", Program.from_text)
    shape = {"normal": len(names), "centre": len(names), "frame": len(names)}
    vectors = {name: read(certificate, f"{claim}.{name}", exact) for name in (*shape, "offset")}
    direction, crossings = (read(certificate, f"{claim}.{name}", operator.index) for name in ("direction", "crossings"))
    is_claim = direction in (1, -1) and 0 < crossings <= 1000 and words.get("vector_field") is not None
    sizes = all(len(vectors[name]) == size for name, size in shape.items())
    if not is_claim or not sizes or any(len(row) != len(names) - 1 for row in vectors["frame"]):
        raise BadCertificate(f"{claim}: direction, crossings or the box are not those of a claim")
    if len(set(names)) != len(names) or len(integral.outputs if integral else [0]) != 1:
        raise BadCertificate("statement: the programs are not those of a field and its first integral")
    if not {*names, *parameters} >= {*field.inputs, *(integral.inputs if integral else ())}:
        raise BadCertificate(f"{claim}.parameters: state and parameters are not the inputs of the programs")
    slopes = None if integral is None else gradient(integral, names)
    return PeriodicStatement(
        names, parameters, field, integral, slopes, level, vectors["normal"], vectors["offset"], direction, crossings,
        vectors["centre"], vectors["frame"],
    )  # fmt: skip


@dataclass(frozen=True)
class ProvedPeriodic:
    """The periodic orbit is proved.

    Attributes:
        point: enclosures of the state at its point on the section, by name; `level`: of the first integral there.
        period: its least period.
        multipliers: those that are not 1 for every orbit of its kind, each in a ball of its own.
        inside, on, outside: how many of them are shown to be where.
        hypotheses: every inequality with its enclosures.
        width, bits, steps: as of `Proved`; the box has the radius 2^-width.
    """

    point: dict[str, arb]
    level: arb | None
    period: arb
    multipliers: tuple[acb, ...]
    inside: int
    on: int
    outside: int
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


class Return(NamedTuple):
    """Jets of the coordinates at the end, the time there, the crossings in the direction till then, states between."""

    state: list[Jet]
    time: arb
    crossings: int
    between: dict[int, list[Jet]]


class PeriodicProof:
    """One attempt: the centre in (x, mu, T), which Newton's method moves."""

    def __init__(self, statement: PeriodicStatement, bits: int, start: tuple[arb, int] | None = None) -> None:
        """`start`: a guess of the period, and how many bits are lost on the way."""
        self.statement, self.bits, self.steps = statement, bits, 0
        self.centre = [ball(c).mid() for c in statement.centre] + [arb(0)] * (statement.slopes is not None)
        self.around = self.centre
        self.period, self.lost = start or (arb(0), 0)

    def guess(self) -> tuple[arb, int]:
        """The time of the crossing that is claimed, and how many bits its enclosure has lost."""
        time = self.followed([arb(0)] * self.statement.section, None).time
        return time.mid(), self.bits + int(float(arb(time.rad()).log() / arb(2).log()))

    def followed(self, spread: Sequence[arb], period: arb | None, degree: int = 1) -> Return:
        """Integrate centre + spread to a time; without one, to the crossing that is claimed. README, section 9.3."""
        statement = self.statement
        values = [c + s for c, s in zip(self.centre[: statement.section], spread, strict=True)]
        state = [Jet({(): value, (j,): arb(1)}, degree) for j, value in enumerate(values)]
        normal = [ball(a) for a in statement.normal]
        state.append(combine(state[: len(normal)], normal, degree) - Jet({(): ball(statement.offset)}, degree))
        parts = {} if period is None else {q: period / q for q in _prime_divisors(statement.crossings)}
        between, now, guess, sign, count = dict[int, list[Jet]](), arb(0), arb(1) / 2, 0, 0
        with precision(self.bits):
            while period is None or not now > period:
                step, guess = take_step(statement, state, guess, self.bits)
                self.steps += 1
                if self.steps > MOST_STEPS:
                    raise CannotFollow(f"the orbit takes more than {MOST_STEPS} steps")
                end = step.duration
                while not sign_of(step.polynomials[statement.section][()](end)):
                    end = (end * 7 / 8).mid()
                    if end < step.duration / 16:
                        raise CannotFollow("no step ends away from the section")
                for q, part in parts.items():
                    early = part - now
                    if early >= 0 and early <= step.duration:
                        between.setdefault(q, step.at(early))
                self.check_kept(state, step.at(end))
                piece, sign = first_crossing(step, statement.section, sign, arb(0), end)
                while piece is not None:
                    count += sign == statement.direction
                    if period is not None and now + piece[0] < period and period < now + piece[1]:
                        return Return(step.at(period - now), period, count, between)
                    if period is None and count >= statement.crossings and sign == statement.direction:
                        found, moment = crossing_state(statement, step, piece)
                        return Return(found, now + moment, count, between)
                    piece, sign = first_crossing(step, statement.section, sign, piece[1], end)
                state, now = step.at(end), now + end
        raise CannotFollow("the section is not crossed at the end of the period")

    def check_kept(self, before: Sequence[Jet], after: Sequence[Jet]) -> None:
        """The first integral has points in common with itself, in its derivatives by x too. README, section 9.1."""
        statement, mu = self.statement, len(self.statement.names)
        if statement.integral is not None:
            one, other = (statement.evaluate(statement.integral, jets)[0] for jets in (before, after))
            check_integral(*(Jet({a: c for a, c in jet.items() if mu not in a}, jet.degree) for jet in (one, other)))

    def system(self, around: Return) -> arb_mat:
        """D G at the points of a set, by (x, mu, T), from what was followed of them."""
        statement, size = self.statement, len(self.centre)
        start = [Jet({(): c}, 0) for c in self.around]
        speed = statement.velocity([Jet({(): jet[()]}, 0) for jet in around.state])
        matrix = [
            [around.state[i][j,] - int(i == j) for j in range(size)] + [speed[i][()]]
            for i in range(len(statement.names))
        ]
        unused = [arb(0)] * (size + 1 - len(statement.names))
        matrix.append([*(ball(a) for a in statement.normal), *unused])
        if statement.slopes is not None:
            matrix.append([*(slope[()] for slope in statement.evaluate(statement.slopes, start)), *unused])
        return arb_mat(matrix)

    def values(self, found: Return) -> arb_mat:
        """G at the centre."""
        statement = self.statement
        x = self.centre[: len(statement.names)]
        rows = [jet[()] - c for jet, c in zip(found.state, x, strict=False)]
        rows.append(dot([ball(a) for a in statement.normal], x) - ball(statement.offset))
        if statement.integral is not None and statement.level is not None:
            (height,) = statement.evaluate(statement.integral, [Jet({(): c}, 0) for c in x])
            rows.append(height[()] - ball(statement.level))
        return arb_mat([[row] for row in rows])

    def refine(self) -> Return:
        """Move the centre to the orbit by Newton's method; what was followed from it in the end."""
        none = [arb(0)] * len(self.centre)
        for _ in range(NEWTON_STEPS):
            self.around = self.centre
            found = self.followed(none, self.period)
            moves = [move for (move,) in self.system(found).solve(self.values(found)).tolist()]
            largest = max(abs(move) for move in moves)
            if largest < arb(2) ** (self.lost + KNOWN // 2 - self.bits):
                self.reach = max(largest.abs_upper() * 256, arb(2) ** (self.lost + KNOWN // 4 - self.bits)).mid()
                return found
            if not largest < arb(2) ** -8:
                break
            self.centre = [(c - move).mid() for c, move in zip(self.centre, moves, strict=False)]
            self.period = (self.period - moves[-1]).mid()
        raise CannotFollow("Newton's method does not converge from the centre of the certificate")

    def conclusion(self) -> ProvedPeriodic:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        statement, n = self.statement, len(self.statement.names)
        exactly = self.refine()
        spread = arb(0, self.reach)
        self.around = [c + spread for c in self.centre]
        found = self.followed([spread] * len(self.centre), self.period + spread)
        moves = [-move for (move,) in self.system(found).solve(self.values(exactly)).tolist()]
        names = [*statement.names, *(["mu"] if statement.slopes is not None else []), "T"]
        newton = self.check_newton(dict(zip(names, moves, strict=True)))
        point, period = [c + move for c, move in zip(self.centre, moves, strict=False)], self.period + moves[-1]
        checks, level = self.check_orbit(found, point, period)
        hypotheses = checked([newton, *checks])
        balls = multipliers(monodromy(found, n), 1 if level is None else 2)
        pair = len(balls) == 2 and statement.keeps_volume() and not any(z.imag.contains(0) for z in balls)
        counts = sum(abs(z) < 1 for z in balls), 0, sum(abs(z) > 1 for z in balls)
        return ProvedPeriodic(
            dict(zip(statement.names, point, strict=False)), level, period, tuple(balls),
            *((0, 2, 0) if pair else counts), hypotheses, self.width, self.bits, self.steps,
        )  # fmt: skip

    def check_newton(self, moves: Mapping[str, arb]) -> Hypothesis:
        """Lemma 5, from the moves of all unknowns."""
        inside = all(abs(move) < self.reach for move in moves.values())
        return Hypothesis("newton", inside, {"R": self.reach} | dict(moves))

    @property
    def width(self) -> int:
        """The box has the radius 2^-width."""
        return int(-float(self.reach.log() / arb(2).log()))

    def check_orbit(self, found: Return, point: Sequence[arb], period: arb) -> tuple[list[Hypothesis], arb | None]:
        """T is the least period of an orbit as claimed; and the value of the first integral on its level."""
        statement, state, level = self.statement, [Jet({(): x}, 0) for x in point], None
        speed = [f[()] for f in statement.evaluate(statement.field, state)]
        rate = dot([ball(a) for a in statement.normal], speed)
        checks = [Hypothesis("direction", rate * statement.direction > 0, {"rate": rate})]
        checks.append(Hypothesis("crossings", found.crossings == statement.crossings, {"T": period}))
        if statement.slopes is not None and statement.integral is not None:
            level = statement.evaluate(statement.integral, state)[0][()]
            slopes = [slope[()] for slope in statement.evaluate(statement.slopes, state)]
            kept = dot(slopes, speed).contains(0) and any(not slope.contains(0) for slope in slopes)
            checks.append(Hypothesis("gradient", kept, dict(zip(statement.names, slopes, strict=True))))
        for q in _prime_divisors(statement.crossings):
            apart = [jet[()] - x for jet, x in zip(found.between.get(q, []), point, strict=False)]
            apart = apart[: len(statement.names)]
            away = any(not d.contains(0) for d in apart)
            checks.append(Hypothesis(f"least period, T/{q}", away, dict(zip(statement.names, apart, strict=False))))
        return checks, level


def checked(hypotheses: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """All of them, if all hold. Raises `CannotFollow`."""
    for failed in (h for h in hypotheses if not h.holds):
        shown = ", ".join(f"{name} = {value.str(6)}" for name, value in failed.enclosures.items())
        raise CannotFollow(f"{failed.name} is not shown: {shown}")
    return tuple(hypotheses)


def monodromy(found: Return, size: int) -> arb_mat:
    """The derivative of the state at the end by that at the start."""
    return arb_mat([[found.state[i][j,] for j in range(size)] for i in range(size)])


def _prime_divisors(number: int) -> list[int]:
    return [q for q in range(2, number + 1) if number % q == 0 and all(q % r for r in range(2, q))]


def prove_periodic(certificate: Mapping[str, Any]) -> ProvedPeriodic | NotProved:
    """Prove the orbit that a certificate claims, from its statement and the centre of its box alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    statement = read_periodic(certificate)

    def prove(start: tuple[arb, int]) -> ProvedPeriodic:
        # A box of the width that is lost on the way, and what is to be known of derivatives on it.
        fine = 2 * start[1] + KNOWN
        with precision(fine):
            return PeriodicProof(statement, fine, start).conclusion()

    return attempted(statement, lambda bits: PeriodicProof(statement, bits).guess(), prove)


def attempted(
    statement: PeriodicStatement,
    guess: Callable[[int], tuple[arb, int]],
    prove: Callable[[tuple[arb, int]], Result],
) -> Result | NotProved:
    """The proof from a guess of the period and the bits that are lost on the way. README, section 9.4."""
    reasons = []
    try:
        statement.check()
        for bits in ROUGH:
            with precision(bits):
                try:
                    period, lost = guess(bits)
                except (CannotFollow, *ERRORS) as error:
                    reasons.append(f"{type(error).__name__}: {error} ({bits} bits)")
                    continue
            return prove((period, max(lost, 0)))
    except (CannotFollow, *ERRORS) as error:
        reasons.append(f"{type(error).__name__}: {error}")
    return NotProved("; ".join(reasons))
