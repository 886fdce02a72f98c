"""The extrema of a quantity along half an orbit, all of them (section 19.4).

Time is covered by intervals on each of which the rate of the quantity has a sign or its second derivative has.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

from flint import arb

from orbitproof.shared.stored import rules
from orbitproof.verify.evidence import Brief, IntegrationFailure, hull, is_below, meet, sign
from orbitproof.verify.poincare import InTime

Kind = Annotated[int, rules("extremum_kind", enum=(1, -1))]
_DEPTH = 20
_NEWTON_STEPS = 12


@dataclass(frozen=True)
class Approach:
    """A time at which the rate of the quantity vanishes.

    Attributes:
        time: enclosure of the system's time, from the beginning of the half orbit on.
        value: of the quantity there.
        kind: 1 for a strict local minimum, -1 for a strict local maximum.
    """

    time: Brief
    value: Brief
    kind: Kind


@dataclass(frozen=True)
class Step:
    """What is known over one step, theta in [0, 1].

    Attributes:
        value, rate, curvature: the quantity and its derivatives by the time of the integration, functions of theta.
        length: of the step, in that time: a derivative by theta is so many times that by time.
        time: the system's time at a theta.
    """

    value: InTime
    rate: InTime
    curvature: InTime
    length: arb
    time: Callable[[arb], arb]

    def zero(self, left: arb, right: arb) -> Approach | None:
        """Where the rate vanishes on [left, right], its derivative having one sign there; `None` if nowhere."""
        where = left.union(right)
        turn = self.length * self.curvature.value(where)
        for _ in range(_NEWTON_STEPS):
            middle = where.mid()
            image = middle - self.rate.value(middle) / turn
            if not image.is_finite():
                break
            if image.overlaps(where) is not True:
                return None
            where = meet(where, image)
            turn = meet(turn, self.length * self.curvature.value(where))
        value = self.value.value(where.mid()) + self.length * self.rate.value(where) * (where - where.mid())
        return Approach(self.time(where), meet(self.value.value(where), value), sign(turn))


@dataclass
class _Run:
    """Intervals on which the second derivative has one sign, `turn`, one after another."""

    turn: int
    parts: list[tuple[Step, arb, arb]]


class DistanceAlong:
    """The quantity along the orbits of a box, from a point of Fix(R) on, step by step.

    By symmetry the rate is 0 at the start and at the other point on Fix(R); the caller guarantees that the quantity is
    invariant under R.
    """

    def __init__(self) -> None:
        self.found: list[Approach] = []
        self.start_kind = 0
        self._run: _Run | None = None
        self._sign = 0
        self._clear: arb | None = None

    def cover(self, step: Step) -> None:
        """Cover one step. Raises `IntegrationFailure` if some part of it cannot be classified."""
        self._cover(step, arb(0), arb(1), 0)

    def _cover(self, step: Step, left: arb, right: arb, depth: int) -> None:
        slope = step.rate.sign(left, right)
        if slope:
            self._moves(slope, step.time(right))
            return
        turn = step.curvature.sign(left, right)
        if turn:
            self._turns(step, left, right, turn)
            return
        if depth == _DEPTH:
            raise _undecided("the distance hardly changes for a while")
        middle = (left + right) / 2
        self._cover(step, left, middle, depth + 1)
        self._cover(step, middle, right, depth + 1)

    def _moves(self, slope: int, until: arb) -> None:
        """An interval on which the rate has a sign; it ends a run."""
        run, self._run = self._run, None
        if self._clear is None:
            if run is None or run.turn != slope:
                raise _undecided("it is not shown to be extremal where the orbit starts")
            self.start_kind = run.turn
        elif slope != self._sign:
            if run is None or run.turn != slope:
                raise _undecided("its rate changes sign, and a zero is not shown")
            self.found.append(_located(run))
        self._sign, self._clear = slope, until

    def _turns(self, step: Step, left: arb, right: arb, turn: int) -> None:
        """An interval on which the second derivative has a sign."""
        if self._run is None:
            self._run = _Run(turn, [])
        if self._run.turn != turn:
            raise _undecided("its second derivative changes sign near a zero of the first")
        self._run.parts.append((step, left, right))

    def end_kind(self, half_period: arb, reached: arb) -> int:
        """The kind of the extremum at the other point on Fix(R), as `Approach.kind`.

        Args:
            half_period: the system's time there.
            reached: that at the end of the last step.

        Raises `IntegrationFailure` if that is not beyond it, or if the rate may have another zero near the end.
        """
        run, clear = self._run, self._clear
        alone = run is not None and clear is not None and run.turn == -self._sign and is_below(clear, half_period)
        if run is None or not alone or not is_below(half_period, reached):
            raise _undecided("it is not shown to be extremal at the other point on Fix(R)")
        return run.turn


def _located(run: _Run) -> Approach:
    found = [zero for zero in (step.zero(left, right) for step, left, right in run.parts) if zero is not None]
    if not found:
        raise _undecided("a zero of its rate is not found")
    first, *others = found
    return Approach(
        hull(first.time, *(zero.time for zero in others)), hull(first.value, *(zero.value for zero in others)), run.turn
    )


def _undecided(why: str) -> IntegrationFailure:
    return IntegrationFailure(
        "distance",
        f"the extrema of the distance are not all enclosed: {why}",
        "give smaller radii",
        needs_precision=True,
    )
