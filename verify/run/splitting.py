"""Which intervals of the pieces of an atlas remain to be proved.

What fails is tried again with more precision, and then split in two; where that promises more, it is split first, or
tried with higher derivatives across the curve.
Nothing here carries proof: what the proved intervals show together is decided by `verify.curve.conclude`, from the
intervals themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from orbitproof.shared.formats import AnyPiece
from orbitproof.verify.branches import Result, Settings, condition_of, covers
from orbitproof.verify.curve import SINGULAR, UNCLEAR_SLOPE, Interval

_OVERLAP = Fraction(1, 64)
"""By this part of its length an interval that is split is exceeded by each half beyond the middle."""

NOT_FOR_SPLITTING = ("process",)
"""Conditions that a shorter interval does not mend; except of second derivatives, without which halves are tried."""

UNFINISHED = (*NOT_FOR_SPLITTING, "time")
"""Conditions of tasks that came to no end: the next run tries them again."""

FOR_SPLITTING = ("time", "collision", "section", "crossing count", "stability")
"""Conditions that more precision does not mend: the interval takes too long, or its orbits differ too much."""

FIRST_FOR_SPLITTING = (UNCLEAR_SLOPE,)
"""Conditions that more precision seldom mends: it is tried on intervals that may not be halved again."""

FIRST_FOR_ONE_SPLIT = ("zeros",)
"""Conditions that halves mostly mend in less time than more precision: what a list leaves open on an interval."""

_CLOSER = 16
"""A place is not looked at again on an interval that is not so many times as short as the last one."""
_SHORTEST = Fraction(1, 2**36)
"""Nor on one that is shorter than this: what is not decided there is a double zero, or one for a reason."""

_SPLITS_FOR_LIST = 2
"""How often an interval that is proved is halved at most for what a list leaves open on it."""


@dataclass(frozen=True)
class Plan:
    """What the results so far leave to do for one piece.

    Attributes:
        proved: the intervals of the tree of halves that are covered by proved ones.
        missing: what is to be tried next, from left to right: intervals, and which of the attempts. Beyond the first
            interval that failed nothing is.
        failed: intervals that were not proved and may not be split again.
    """

    proved: tuple[Interval, ...]
    missing: tuple[tuple[Interval, int], ...]
    failed: tuple[Interval, ...]

    @property
    def is_proved(self) -> bool:
        """Whether the whole interval of the piece is proved."""
        return not self.missing and not self.failed

    @property
    def is_settled(self) -> bool:
        """Whether nothing more is to be tried: all is proved, or one part cannot be, and all before it is."""
        return not self.missing


def full_interval(piece: AnyPiece) -> Interval:
    """The interval of s on which a piece has to be proved; its symmetry gives the other half of a symmetric one."""
    return (Fraction(0), Fraction(1)) if piece.is_symmetric else (Fraction(-1), Fraction(1))


def halves(interval: Interval) -> tuple[Interval, Interval]:
    """Two intervals of about half the length that overlap and cover the interval together."""
    start, end = interval
    middle, beyond = (start + end) / 2, (end - start) * _OVERLAP
    return (start, middle + beyond), (middle - beyond, end)


def plan(
    piece: AnyPiece,
    results: Sequence[Result],
    attempts: Sequence[Settings],
    max_splits: int,
    lacks: Callable[[Result], str] = lambda result: "",
    halved: int = 0,
    for_slopes: Settings | None = None,
) -> Plan:
    """What is left to do for a piece, given the results of its intervals.

    Each interval is tried with one of the `attempts` after the other, and then halved, at most `max_splits` times.
    What is done about an interval depends on the results for it and for those that it is a part of, and on no others:
    in whatever order results come, and however often a run is interrupted, the same is tried in the end.

    Args:
        for_slopes: settings with which an interval is tried first if the derivative across the curve may be singular on
            it, and its parts no more if they failed for a reason that is not `FOR_SPLITTING`; as an attempt, the one
            after `attempts`.
        lacks: what else is wanted of a proved result and is not there, as a condition; empty for nothing.
        halved: how often intervals are halved before they are tried, `max_splits` times at most.
    """
    proved, enough = [], []
    against: dict[Interval, list[tuple[Result, str]]] = {}
    for result in results:
        condition = lacks(result) if result.is_proved else condition_of(result)
        asked = _asked(piece, result.interval)
        if result.is_proved:
            proved.append(asked)
        if result.is_proved and not condition:
            enough.append(asked)
        else:
            against.setdefault(asked, []).append((result, condition))
    done: list[Interval] = []
    missing: list[tuple[Interval, int]] = []
    failed: list[Interval] = []

    def is_across(result: Result) -> bool:
        return for_slopes is not None and made_with(result, for_slopes)

    def walk(interval: Interval, splits: int, in_vain: bool = False, is_proved: bool = False) -> None:
        """`in_vain`: whether second derivatives were on what it is a part of; `is_proved`: whether that is proved."""
        if _whole(enough, interval):
            done.append(interval)
            return
        is_proved = is_proved or interval in proved
        tried = against.get(interval, [])
        conditions = [condition for _, condition in tried]
        across = [(result, condition) for result, condition in tried if is_across(result)]
        lost = any(condition in NOT_FOR_SPLITTING and not is_across(result) for result, condition in tried)
        if lost or SINGULAR in conditions:
            end(interval, is_proved)
            return
        mended_by_halves = [*FOR_SPLITTING]
        if splits < max_splits:
            mended_by_halves += (*FIRST_FOR_SPLITTING, *(FIRST_FOR_ONE_SPLIT if splits <= halved else ()))
        if for_slopes is not None and UNCLEAR_SLOPE in conditions and not (across or in_vain):
            try_next(interval, len(attempts))
            return
        in_vain = in_vain or any(not r.is_proved and condition not in FOR_SPLITTING for r, condition in across)
        wide = splits < min(halved, max_splits) or any(condition in mended_by_halves for condition in conditions)
        untried = [n for n, settings in enumerate(attempts) if not any(made_with(r, settings) for r, _ in tried)]
        if untried and not wide:
            try_next(interval, untried[0])
        elif splits >= (min(max_splits, halved + _SPLITS_FOR_LIST) if is_proved else max_splits):
            end(interval, is_proved)
        else:
            for half in halves(interval):
                walk(half, splits + 1, in_vain, is_proved)

    def try_next(interval: Interval, attempt: int) -> None:
        if not failed:
            missing.append((interval, attempt))

    def end(interval: Interval, is_proved: bool) -> None:
        """What nothing more is tried about; its parts are proved if another run, with other settings, has done so."""
        (done if is_proved or _whole(proved, interval) else failed).append(interval)

    walk(full_interval(piece), 0)
    return Plan(tuple(done), tuple(missing), tuple(failed))


def _whole(intervals: Collection[Interval], wanted: Interval) -> bool:
    """Whether an interval is among these, or both of its halves are, or the halves of one that is not."""
    if wanted in intervals:
        return True
    inside = [(start, end) for start, end in intervals if wanted[0] <= start and end <= wanted[1]]
    return covers(inside, wanted) and all(_whole(inside, half) for half in halves(wanted))


def with_closer_looks(
    state: Plan,
    results: Sequence[Result],
    wanted: Callable[[Result], Sequence[Interval]],
    attempts: Sequence[Settings],
) -> Plan:
    """A plan with short intervals about places that are known roughly, each tried once, with the last of the attempts.

    As those of a plan, they depend on the result alone that knows the places.

    Args:
        wanted: such intervals of a proved result.
    """
    looks = [result.interval for result in results if made_with(result, attempts[-1])]
    missing = list(state.missing)
    for result in results:
        # A look that did not show enough is followed by a closer one, if that is closer indeed.
        near = [result.interval] if result.interval in looks else []
        for start, end in wanted(result) if result.is_proved else ():
            longest = (end - start) * _CLOSER
            if end - start < _SHORTEST or any(
                first < end and start < last and last - first < longest for first, last in near
            ):
                continue
            near.append((start, end))
            task = ((start, end), len(attempts) - 1)
            if (start, end) not in looks and task not in missing:
                missing.append(task)
    return replace(state, missing=tuple(missing))


def _asked(piece: AnyPiece, interval: Interval) -> Interval:
    """What was asked for: a proof on a symmetric piece about 0 is one on both sides of it."""
    start, end = interval
    return (Fraction(0), end) if piece.is_symmetric and start == -end else interval


def made_with(result: Result, settings: Settings) -> bool:
    """Whether a result comes from these settings of the integrator."""
    return all(getattr(result.computation, name) == value for name, value in settings.items())
