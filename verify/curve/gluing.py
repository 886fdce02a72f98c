"""Pieces in order become one smooth curve (sections 15.5, 15.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb

from orbitproof.verify.curve.proved_intervals import Run
from orbitproof.verify.curve.tube import Tube, lower_end, upper_end
from orbitproof.verify.evidence import Evidence, all_finite, enclose, exact_interval_text, is_below, is_positive, show

_TRIALS = 32
"""Places along a piece where the next one is looked for, from its end backwards."""


class ClaimedCurve(Protocol):
    """What a claim says of how its pieces lie together, as `Claim` and the claims of other curves do."""

    @property
    def goes_round(self) -> bool: ...

    @property
    def is_closed(self) -> bool: ...

    @property
    def is_of_symmetric_curve(self) -> bool: ...


@dataclass(frozen=True)
class Joint:
    """Where the curve goes over from one piece to the next.

    Attributes:
        before, after: ids of the pieces.
        leaves: s of the former, exact.
        enters: s of the latter at the same point.
        offsets: the point's p_j - polynomial_j(s) in the latter, in units of its tube, all inside (-1, 1).
        turn: derivative of the latter's s by the former's, positive.
    """

    before: str
    after: str
    leaves: Fraction
    enters: arb
    offsets: tuple[arb, ...]
    turn: arb


@dataclass(frozen=True)
class Stretch:
    """The part of a piece that the curve runs along: from where it enters it to s = `leaves`.

    Attributes:
        tube, run: the piece, and the run of proved intervals in it.
        enters, entered: bounds of the s at which the curve enters: from below, from above.
        leaves: s at which it leaves, exact.
    """

    tube: Tube
    run: Run
    enters: Fraction
    entered: Fraction
    leaves: Fraction

    def contains(self, s: arb) -> bool:
        """Whether s certainly belongs to the part that the curve runs along."""
        return s.is_finite() and self.entered <= lower_end(s) and upper_end(s) <= self.leaves


@dataclass(frozen=True)
class Chain:
    """A curve, piece after piece, and what joins them."""

    stretches: tuple[Stretch, ...]
    joints: tuple[Joint, ...]

    @property
    def ends(self) -> tuple[list[arb], list[arb]]:
        """Enclosures of the coordinates of the first and of the last point."""
        first, last = self.stretches[0], self.stretches[-1]
        return first.tube.point(first.run, first.enters), last.tube.point(last.run, last.leaves)


def follow(evidence: Evidence, claim: ClaimedCurve, tubes: Sequence[Tube]) -> Chain | None:
    """The curve through the tubes in order, as it is claimed; `None`, with the reason in `evidence`, if there is none.

    An arc begins at s = -1 of the first piece and ends at s = 1 of the last; a symmetric arc begins at s = 0; a
    symmetric loop begins and ends at s = 0; a loop begins where its last piece enters the first.
    """
    first = tubes[0]
    if claim.goes_round:
        run, enters = (first.runs[-1], first.runs[-1].start) if first.runs else (None, Fraction(0))
    else:
        enters = Fraction(0 if claim.is_of_symmetric_curve else -1)
        run = next((run for run in first.runs if run.start <= enters < run.end), None)
    if run is None:
        evidence.require(False, _nothing_proved(first, enters, f"s = {_decimal(enters)}"))
        return None
    reached = enters
    stretches: list[Stretch] = []
    joints: list[Joint] = []
    successors = [*tubes[1:], *([first] if claim.goes_round else [])]
    for number, tube in enumerate(tubes):
        if number == len(successors):
            leaves = Fraction(0 if claim.is_closed else 1)
            evidence.require(reached < leaves, f"piece {tube.piece.id} is entered after s = {leaves}, its end")
            evidence.require(
                run.end >= leaves,
                _nothing_proved(tube, _after(run), f"s from {_decimal(run.end)} to {leaves}, where the curve ends"),
            )
            stretches.append(Stretch(tube, run, enters, reached, leaves))
            break
        found = _join(tube, run, reached, successors[number])
        if isinstance(found, str):
            evidence.require(False, found)
            return None
        joint, next_run = found
        evidence.require(True, "")
        stretches.append(Stretch(tube, run, enters, reached, joint.leaves))
        joints.append(joint)
        enters, reached, run = lower_end(joint.enters), upper_end(joint.enters), next_run
    if not evidence.holds:
        return None
    if claim.goes_round:
        start = stretches[0]
        if run != start.run or not reached < start.leaves:
            place = f"{first.piece.id} is entered behind the place where the curve leaves it"
            evidence.require(False, f"the loop does not close: {place}")
            return None
        stretches[0] = Stretch(start.tube, start.run, enters, reached, start.leaves)
    return Chain(tuple(stretches), tuple(joints))


def _join(tube: Tube, run: Run, reached: Fraction, after: Tube) -> tuple[Joint, Run] | str:
    """The last place after s = `reached` at which the curve certainly enters the tube `after`, or why there is none."""
    failures: list[tuple[int, str]] = []
    for trial in range(_TRIALS):
        s = run.end - (run.end - reached) * Fraction(trial, _TRIALS)
        if s <= reached:
            # This also keeps off s = 0 of a symmetric piece, where the first one is entered.
            continue
        found = _enter(tube, run, s, after)
        if not isinstance(found[0], int):
            return found
        failures.append(found)
    place = f"{tube.piece.id} and {after.piece.id}"
    if not failures:
        return f"{place}: the curve leaves what is proved of {tube.piece.id} where it enters it"
    # How far the best place came is what helps: inside the interval but beside the tube, and so on.
    message = max(failures, key=lambda failure: failure[0])[1]
    missing = "" if run.end == 1 else f"; {_nothing_proved(tube, _after(run), f's just above {_decimal(run.end)}')}"
    return f"{place}: {message}{missing}"


def _enter(tube: Tube, run: Run, s: Fraction, after: Tube) -> tuple[Joint, Run] | tuple[int, str]:
    """The joint at s of one piece with the next, or how far it came (a number to compare by) and what is wrong."""
    p, slope = after.from_piece(tube.piece, tube.local(run, s), tube.local_slope(run, s))
    where = after.parameter(p)
    place = f"the point s = {_decimal(s)} of {tube.piece.id} has s = {show(where)} in {after.piece.id}"
    if not where.is_finite():
        return 0, f"{place}, which is not known"
    next_run = next(
        (r for r in after.runs if is_below(enclose(r.start), where) and is_below(where, enclose(r.end))), None
    )
    if next_run is None:
        proved = ", ".join(exact_interval_text(r.start, r.end, inward=True) for r in after.runs)
        reason = after.refusal(lower_end(where))
        why = f"; {reason}" if reason else ""
        return 1, f"there is a gap: {place}, where nothing is proved (proved: {proved or 'nothing'}{why})"
    if after.is_symmetric and not is_positive(-where):
        return 2, f"{place}, but a symmetric piece has to be entered before s = 0"
    offsets = [ball / enclose(width) for ball, width in zip(after.offsets(where, p), after.piece.tube, strict=True)]
    if not after.contains(where, p):
        most = max(offsets, key=lambda ball: abs(ball).upper() if ball.is_finite() else arb("inf"))
        return 3, f"{place}, but lies beside its tube: it is {show(most)} half-widths off its polynomial"
    turn = after.parameter(slope)
    if not is_positive(turn):
        return 4, f"{place}, where the curve is not shown to go on in the direction of increasing s ({show(turn)})"
    if not all_finite(offsets):
        return 4, f"{place}, with offsets that are not finite"
    return Joint(tube.piece.id, after.piece.id, s, where, tuple(offsets), turn), next_run


def _nothing_proved(tube: Tube, s: Fraction, where: str) -> str:
    reason = tube.refusal(s)
    return f"piece {tube.piece.id}: nothing is proved at {where}{f' ({reason})' if reason else ''}"


def _after(run: Run) -> Fraction:
    """A little more than the end of a run."""
    return run.end + (1 - run.end) / 2**20


def _decimal(value: Fraction) -> str:
    return f"{float(value):.6g}"
