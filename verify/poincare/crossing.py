"""Counting the crossings of the section along a box of orbits (section 5.2).

The time axis is covered by closed intervals on each of which either the section coordinate y keeps
one sign, or its velocity y' does, for all real points of the box. Between two intervals where y has
opposite signs, joined by intervals where y' has one sign, there is exactly one crossing.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_poly, ctx

from orbitproof.verify.algebra import Series, total
from orbitproof.verify.evidence import IntegrationFailure, sign

_DEPTH = 14
_WIDE_DEPTH = 4
"""How often a part of the wide variable's interval is halved at most."""
_BITS = 96


def stays_positive(series: Series, wide: arb | None = None) -> bool:
    """Whether a function is positive on [0, 1] for all real points of the box, for certain.

    `wide`: the part of the wide variable's interval, if there is one.
    """
    parts = [(wide, 0)]
    with ctx.workprec(_BITS):
        while parts:
            part, depth = parts.pop()
            if _stays_positive(InTime(series, part), arb(0), arb(1), 0):
                continue
            if part is None or depth == _WIDE_DEPTH:
                return False
            middle, half = part.mid(), arb(0, 1) * part.rad() / 2
            parts += [(middle + side * part.rad() / 2 + half, depth + 1) for side in (-1, 1)]
    return True


def _stays_positive(function: InTime, left: arb, right: arb, depth: int) -> bool:
    found = function.sign(left, right)
    if found or depth == _DEPTH:
        return found > 0
    middle = (left + right) / 2
    return _stays_positive(function, left, middle, depth + 1) and _stays_positive(function, middle, right, depth + 1)


def range_of(series: Series, wide: arb | None = None) -> arb:
    """A ball that contains the values of an element without theta at all real points of the box.

    Raises `ValueError` for an element with theta.
    """
    with ctx.workprec(_BITS):
        enclosure = InTime(series, wide)
        if enclosure.polynomial.length() > 1:
            raise ValueError("the element depends on time")
        return enclosure.polynomial(arb(0)) + enclosure.deviation


def wide_parts(number: int) -> list[arb]:
    """Balls that cover the interval [-1, 1] of the wide variable."""
    return [(arb(2 * part + 1 - number) + arb(0, 1)) / number for part in range(number)]


def may_touch(what: str) -> IntegrationFailure:
    """The failure of a count of crossings because orbits may touch the section."""
    remedy = "the orbit may touch the section: give smaller radii or another centre"
    return IntegrationFailure("crossing count", what, remedy, needs_precision=True)


@dataclass(frozen=True)
class Arrival:
    """A box that is close to a crossing, before or after it.

    Attributes:
        since: after this time there is no zero of the section coordinate but that crossing, as far as the box has come.
        behind: the crossing lies behind the box, but the velocity there is not known: a zero that is found from
            here is the crossing only if it lies behind, too.
    """

    since: arb
    behind: bool = False


class CrossingCounter:
    """Number of proven crossings after the start.

    The caller guarantees that at the start, for the whole box, y = 0 exactly, as on Fix(R), or that y has the sign
    `side`: then time 0 alone is the first of the intervals (section 23.3). With a wide variable the orbits that are
    counted are those of a part of its interval.

    Attributes:
        side: the sign of y after the last crossing so far, at first after the start; 0 before that is known.
    """

    def __init__(self, wide: arb | None = None, side: int = 0) -> None:
        self.wide = wide
        self.crossings = 0
        self.clear_time: arb | None = arb(0) if side else None
        self.previous_clear_time: arb | None = None
        self.velocity_sign = 0
        self.side = side
        self._start = side == 0

    def cover(self, position: Series, velocity: Series, time: arb, step: arb) -> None:
        """Cover one step: y over theta in [0, 1], y' there, from `time` on over `step` > 0.

        Raises `IntegrationFailure` if some part of the step cannot be classified.
        """
        with ctx.workprec(_BITS):
            y = InTime(position, self.wide)
            dy = InTime(velocity, self.wide)
            self._cover(y, dy, arb(0), arb(1), 0, time, step)

    def _cover(self, y: InTime, dy: InTime, left: arb, right: arb, depth: int, time: arb, step: arb) -> None:
        if side := y.sign(left, right):
            self._keeps_side(side, time + step * right)
            return
        if direction := dy.sign(left, right):
            self._moves(direction)
            return
        if depth == _DEPTH:
            raise may_touch("the section coordinate and its velocity cannot be separated from zero along the orbit")
        middle = (left + right) / 2
        self._cover(y, dy, left, middle, depth + 1, time, step)
        self._cover(y, dy, middle, right, depth + 1, time, step)

    def _moves(self, sign: int) -> None:
        if self._start:
            self.side, self._start = sign, False
        if self.velocity_sign not in (0, sign):
            raise may_touch("the velocity of the section coordinate changes sign next to the section")
        self.velocity_sign = sign

    def _keeps_side(self, sign: int, until: arb) -> None:
        if self._start:
            raise IntegrationFailure(
                "crossing count", "the orbit does not start on the section", "give a centre on Fix(R)"
            )
        if sign != self.side:
            if self.velocity_sign != sign:
                raise IntegrationFailure(
                    "crossing count",
                    "a crossing against the velocity: the enclosures contradict each other",
                    "this is an error of the integrator; please report it",
                )
            self.crossings += 1
            self.side = sign
            self.previous_clear_time = self.clear_time
        self.velocity_sign = 0
        self.clear_time = until

    def arrival(self, number: int) -> Arrival | None:
        """What is known about crossing `number` if the box is close to it; `None` if too little is (section 5.2)."""
        if self.crossings == number - 1 and self.velocity_sign in (0, -self.side) and self.clear_time is not None:
            return Arrival(self.clear_time)
        if self.crossings == number and self.velocity_sign in (0, self.side) and self.previous_clear_time is not None:
            return Arrival(self.previous_clear_time, behind=self.velocity_sign == 0)
        return None


class InTime:
    """Values of a real function on subintervals of [0, 1], for all real points of the box."""

    def __init__(self, series: Series, wide: arb | None = None) -> None:
        arithmetic = series.arithmetic
        self.polynomial = arb_poly(arithmetic.balls_in_time(series.coefs[0], wide))
        self.derivative = self.polynomial.derivative()
        away = list(series.known)
        away[0] = 0.0
        self.deviation = arb(0, total([total(away), total(series.errors)]))

    def value(self, interval: arb) -> arb:
        """Enclosure of the values at the points of a ball, by the mean value theorem."""
        middle = interval.mid()
        return self.polynomial(middle) + self.derivative(interval) * (interval - middle) + self.deviation

    def at_start(self) -> int:
        """1 or -1 if the function has that sign at 0 for certain, else 0."""
        with ctx.workprec(_BITS):
            return self.sign(arb(0), arb(0))

    def sign(self, left: arb, right: arb) -> int:
        """1 or -1 if the function has that sign on [left, right] for certain, else 0."""
        return sign(self.value(left.union(right)))
