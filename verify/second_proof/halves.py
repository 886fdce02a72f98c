"""Symmetric orbits as zeros: a point of Fix(R) and half the period, without a Poincare map. README, section 13."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb

from .conditions import Hypothesis, Vector
from .crossing import TIME, crossing_state, first_crossing, follow, moving, sign_of
from .flow import take_step
from .jets import CannotFollow, Jet, ball, precision
from .legs import Start
from .newton import Newton
from .periodic_statement import DEPENDENCE
from .proof import check_integral
from .statement import LEVEL, BadCertificate, Program, Statement, exact, read, read_reversible

MOST_STEPS = 10_000
_EARLIER_LEVEL = "level"
"""What the input `LEVEL` is called in certificates of versions before 0.3."""


@dataclass(frozen=True)
class Lifting:
    """The coordinate w that follows from a level, which is the first number of the centre.

    Attributes:
        place: its index in the state; `sign`: of w.
        program: w as a function of the level and the other coordinates. It gives a guess, and nothing rests on it.
        level: the input that is the level.
    """

    place: int
    sign: int
    program: Program
    level: str


@dataclass(frozen=True)
class SymmetricStatement:
    """What a certificate claims of a symmetric orbit.

    Attributes:
        system: the field, its symmetry, section, crossings and frames.
        lifting: if the first number of the centre is the level of the first integral.
        quantity, value, place: the equation that singles an orbit out; `place` of the coordinate if it is about one.
        twist: the sign that is claimed, or 0.
    """

    system: Statement
    lifting: Lifting | None = None
    quantity: str | None = None
    value: Fraction = Fraction(0)
    place: int | None = None
    twist: int = 0

    @property
    def places(self) -> tuple[int, ...]:
        """Indices in the state of all coordinates of Fix(R)."""
        on_level = self.system.level_set
        return self.system.fixed if on_level is None else (*self.system.fixed, on_level.place)

    @property
    def sheet(self) -> tuple[int, int] | None:
        """The coordinate whose sign is claimed, and this sign."""
        found = self.lifting or self.system.level_set
        return None if found is None else (found.place, found.sign)

    def check(self) -> None:
        """R reverses the field and keeps the first integral."""
        self.system.check()

    def begin(self) -> Vector:
        """The centre of the claim in all coordinates of Fix(R), about."""
        system, centre = self.system, [ball(c).mid() for c in self.system.centre]
        if self.lifting is not None:
            level, *others = centre
            values = dict(zip((i for i in self.places if i != self.lifting.place), others, strict=True))
            known = {name: Jet({(): values.get(i, arb(0))}, 0) for i, name in enumerate(system.state)}
            known |= {name: Jet({(): ball(value)}, 0) for name, value in system.parameters.items()}
            known[self.lifting.level] = Jet({(): level}, 0)
            (w,) = self.lifting.program.run(known, lambda c: Jet({(): ball(c)}, 0))
            values[self.lifting.place] = w[()].mid()
        else:
            values = dict(zip(system.fixed, centre, strict=True))
            if system.level_set is not None:
                state = [Jet({(): values.get(i, arb(0))}, 1) for i in range(len(system.state))]
                values[system.level_set.place] = system.level_set.near(system.conserved, state)
        return [values[i] for i in self.places]

    def coordinates(self, point: Sequence[arb], level: arb) -> Vector:
        """A point of Fix(R), on this level, in the coordinates of the claim."""
        lifting, known = self.lifting, dict(zip(self.places, point, strict=True))
        lead = [] if lifting is None else [level]
        return [*lead, *(known[i] for i in self.system.fixed if lifting is None or i != lifting.place)]


def read_symmetric(certificate: Mapping[str, Any]) -> SymmetricStatement:
    """The statement of a certificate of a symmetric orbit. Raises `BadCertificate`, and `CannotFollow`."""
    claim = "statement.candidate"
    given, kind = read(certificate, claim, dict), read(certificate, f"{claim}.kind", str)
    if read(certificate, f"{claim}.k", operator.index) != 1 or given.get("symmetry") is not None:
        raise BadCertificate(f"{claim}.k: a claim about one orbit has k = 1 and no symmetry")
    system, lifting = read_reversible(certificate, kind, 1), None
    if system.level_set is not None and system.level_set.between is not None:
        raise CannotFollow("of a coordinate that follows from a level the sign has to be claimed, not an interval")
    if given.get("parameter"):
        if len(system.state) != len(system.field.outputs):
            raise BadCertificate(f"{claim}.parameters: a parameter is free, and a level too")
        program = read(certificate, "statement.level_coordinate", Program.from_text)
        names = {name: frozenset({name}) for name in program.inputs}
        (used,) = program.run(names, lambda _: frozenset(), DEPENDENCE)
        places = [i for i in system.fixed if system.state[i] not in used]
        sign = read(certificate, f"{claim}.level_sign", {1: 1, -1: -1}.__getitem__)
        own = {*system.state, *system.parameters}
        level = LEVEL if LEVEL in program.inputs else _EARLIER_LEVEL
        if len(places) != 1 or level in own or not {*own, level} >= {*program.inputs}:
            raise BadCertificate("statement.level_coordinate: no coordinate that follows from the level")
        lifting = Lifting(places[0], sign, program, level)
    statement = SymmetricStatement(system, lifting)
    if kind == "reversor_breaking":
        return statement
    quantity = read(certificate, f"{claim}.equation.quantity", str)
    value, twist, place = read(certificate, f"{claim}.equation.value", exact), 0, None
    if quantity == "coordinate":
        place = read(certificate, f"{claim}.equation.coordinate", system.state.index)
    if given.get("twist") is not None:
        twist = read(certificate, f"{claim}.twist", {1: 1, -1: -1}.__getitem__)
    if quantity not in ("half period", "level", "coordinate") or (place is not None and place not in system.fixed):
        raise BadCertificate(f"{claim}.equation: nothing that singles out an orbit")
    return SymmetricStatement(system, lifting, quantity, value, place, twist)


class Half(NamedTuple):
    """Jets of the state at the point and at the end of the half orbit, the latter with `TIME` as a variable."""

    start: list[Jet]
    end: list[Jet]


class HalfOrbits(Newton):
    """One attempt: the unknowns are the coordinates of Fix(R), T = half the period, and others a kind of claim has.

    Attributes:
        moved: indices in the state of the coordinates by which there are derivatives.
        time: the place of T among the unknowns.
    """

    def __init__(self, claim: SymmetricStatement, bits: int, start: Start) -> None:
        self.claim, self.bits, self.lost, self.steps = claim, bits, start.lost, 0
        self.places, self.moved = claim.places, claim.places
        self.time, self.reach = len(self.places), arb(0)
        self.centre = [*start.points[0], start.period]
        self.odd = tuple(i for i, sign in enumerate(claim.system.reversing) if sign == -1)

    @property
    def columns(self) -> list[int]:
        """Variables of jets that are even under R: the coordinates of Fix(R) and the time."""
        return [*self.places, TIME]

    def jets(self, point: Sequence[arb], degree: int) -> list[Jet]:
        """Jets of the state about points of Fix(R)."""
        return begun(self.claim.system, dict(zip(self.places, point, strict=True)), self.moved, degree)

    def evaluated(self, around: Sequence[arb], degree: int) -> tuple[Half, list[Jet]]:
        """The half orbits of a set of points, and jets of the equations: which coordinates vanish, on which level."""
        system, start = self.claim.system, self.jets(around[: self.time], degree)
        with precision(self.bits):
            end, steps = half_orbit(system, start, around[self.time], self.bits)
        self.steps += steps
        rows = [end[i] for i in self.odd]
        if system.level_set is not None:
            rows.append(system.conserved(start) - Jet({(): ball(system.level_set.value)}, degree))
        return Half(start, end), [*rows, *self.more(Half(start, end), around, degree)]

    def more(self, half: Half, around: Sequence[arb], degree: int) -> list[Jet]:
        """The equations besides those of a symmetric orbit."""
        raise NotImplementedError

    def slopes(self, rows: Sequence[Jet]) -> list[Vector]:
        """Derivatives by the coordinates of Fix(R) and T."""
        return [[row[v,] for v in self.columns] for row in rows]

    def names(self) -> list[str]:
        """The names of all unknowns."""
        known = [self.claim.system.state[i] for i in self.places]
        return [*known, "T", *(f"w {i}" for i in range(len(self.centre) - self.time - 1))]

    def check_point(self, zero: Vector) -> list[Hypothesis]:
        """T is the time to the crossing that is claimed; the sign of w is that of the claim."""
        checks = [Hypothesis("crossings", zero[self.time] > 0, {"T": zero[self.time]})]
        if self.claim.sheet is not None:
            place, sign = self.claim.sheet
            w = zero[self.places.index(place)]
            checks.append(Hypothesis("sheet", w * sign > 0, {self.claim.system.state[place]: w}))
        return checks


def begun(system: Statement, values: Mapping[int, arb], moved: Sequence[int], degree: int) -> list[Jet]:
    """Jets of a state with these coordinates, the others 0, in the coordinates that are `moved`."""
    return [
        Jet(({(): values[i]} if i in values else {}) | ({(i,): arb(1)} if i in moved else {}), degree)
        for i in range(len(system.state))
    ]


def guess(claim: SymmetricStatement, bits: int) -> Start:
    """From the centre to the crossing that is claimed: about how long it takes, and the bits that are lost."""
    point = claim.begin()
    start = begun(claim.system, dict(zip(claim.places, point, strict=True)), claim.places, 1)
    found, time, _ = follow(claim.system, start, bits)
    widest = max(arb(jet[()].rad()) for jet in found)
    lost = max(bits + int(float(widest.log() / arb(2).log())), 0) if widest > 0 else 0
    return Start(time.mid(), lost, [arb(1)], [point])


def half_orbit(system: Statement, start: list[Jet], duration: arb, bits: int) -> tuple[list[Jet], int]:
    """Jets after a time, with `TIME` as a variable, and the steps; the crossing that is claimed is the one near it.

    At the crossings before it no orbit is in Fix(R). README, section 13.2.
    """
    state, now, step_size, sign, left = start, arb(0), arb(1) / 2, 0, system.crossings
    for steps in range(1, MOST_STEPS + 1):
        step, step_size = take_step(system, state, step_size, bits)
        end, rest = step.duration, duration - now
        while not sign_of(step.polynomials[system.section][()](end)):
            end = (end * 7 / 8).mid()
            if end < step.duration / 16:
                raise CannotFollow("no step ends away from the section")
        piece, sign = first_crossing(step, system.section, sign, arb(0), end)
        while piece is not None:
            left -= 1
            if left == 0:
                if not (piece[0] < rest and rest < piece[1]):
                    raise CannotFollow("the half orbit does not end with the crossing that is claimed")
                found = step.at(rest)
                check_integral(system.conserved(start), system.conserved(found))
                return moving(system, found), steps
            crossing, _ = crossing_state(system, step, piece)
            if not any(sign_of(crossing[i][()]) for i in system.kernel):
                raise CannotFollow("the half orbit may end before the crossing that is claimed")
            piece, sign = first_crossing(step, system.section, sign, piece[1], end)
        state, now = step.at(end), now + end
    raise CannotFollow(f"the orbit takes more than {MOST_STEPS} steps")
