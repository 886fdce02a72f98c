"""Which intervals of the pieces of an atlas remain to be proved.

What fails is tried again with more precision, and then split in two; where that promises more, it is split first, or
tried with higher derivatives across the curve.
Nothing here carries proof: what the proved intervals show together is decided by `verify.curve.conclude`, from the
intervals themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from orbitproof.shared.formats import AnyPiece
from orbitproof.verify.atlas import Result, Settings, condition_of, covers
from orbitproof.verify.curve import SINGULAR, UNCLEAR_SLOPE, Interval

_OVERLAP = Fraction(1, 64)
"""By this part of its length an interval that is split is exceeded by each half beyond the middle."""

NOT_FOR_SPLITTING = ("process",)
"""Conditions that a shorter interval does not mend; except of second derivatives, without which halves are tried."""

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
        missing: what is to be tried next, from left to right: intervals, and which of the attempts.
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
        """Whether nothing more is to be tried: all is proved, or one part cannot be."""
        return not self.missing or bool(self.failed)


def full_interval(piece: AnyPiece) -> Interval:
    """The interval of s on which a piece has to be proved; its symmetry gives the other half of a symmetric one."""
    return (Fraction(0), Fraction(1)) if piece.kind == "symmetric" else (Fraction(-1), Fraction(1))


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
        if result.is_proved:
            proved.append(result.interval)
        if result.is_proved and not condition:
            enough.append(result.interval)
        else:
            against.setdefault(_asked(piece, result.interval), []).append((result, condition))
    done: list[Interval] = []
    missing: list[tuple[Interval, int]] = []
    failed: list[Interval] = []

    def is_across(result: Result) -> bool:
        return for_slopes is not None and made_with(result, for_slopes)

    def walk(interval: Interval, splits: int, in_vain: bool = False) -> None:
        if covers(enough, interval):
            done.append(interval)
            return
        only_lacks = covers(proved, interval)
        tried = against.get(interval, [])
        conditions = [condition for _, condition in tried]
        across = [(result, condition) for result, condition in tried if is_across(result)]
        lost = any(condition in NOT_FOR_SPLITTING and not is_across(result) for result, condition in tried)
        if lost or SINGULAR in conditions:
            (done if only_lacks else failed).append(interval)
            return
        mended_by_halves = [*FOR_SPLITTING]
        if splits < max_splits:
            mended_by_halves += (*FIRST_FOR_SPLITTING, *(FIRST_FOR_ONE_SPLIT if splits <= halved else ()))
        if for_slopes is not None and UNCLEAR_SLOPE in conditions and not (across or in_vain):
            missing.append((interval, len(attempts)))
            return
        in_vain = in_vain or any(not r.is_proved and condition not in FOR_SPLITTING for r, condition in across)
        wide = splits < min(halved, max_splits) or any(condition in mended_by_halves for condition in conditions)
        untried = [n for n, settings in enumerate(attempts) if not any(made_with(r, settings) for r, _ in tried)]
        if untried and not wide:
            missing.append((interval, untried[0]))
        elif splits >= (min(max_splits, halved + _SPLITS_FOR_LIST) if only_lacks else max_splits):
            (done if only_lacks else failed).append(interval)
        else:
            for half in halves(interval):
                walk(half, splits + 1, in_vain)

    walk(full_interval(piece), 0)
    return Plan(tuple(done), tuple(missing), tuple(failed))


def with_closer_looks(
    state: Plan,
    results: Sequence[Result],
    wanted: Callable[[Result], Sequence[Interval]],
    attempts: Sequence[Settings],
) -> Plan:
    """A plan with short intervals about places that are known roughly, each tried once, with the last of the attempts.

    Args:
        wanted: such intervals of a proved result.
    """
    looked_at = [result.interval for result in results if made_with(result, attempts[-1])]
    missing = list(state.missing)
    for result in results:
        for start, end in wanted(result) if result.is_proved else ():
            # A look that did not show enough is followed by a closer one, if that is closer indeed.
            longest = (end - start) * _CLOSER
            near = [(first, last) for first, last in looked_at if first < end and start < last]
            if end - start >= _SHORTEST and not any(last - first < longest for first, last in near):
                looked_at.append((start, end))
                missing.append(((start, end), len(attempts) - 1))
    return replace(state, missing=tuple(missing))


def _asked(piece: AnyPiece, interval: Interval) -> Interval:
    """What was asked for: a proof on a symmetric piece about 0 is one on both sides of it."""
    start, end = interval
    return (Fraction(0), end) if piece.kind == "symmetric" and start == -end else interval


def made_with(result: Result, settings: Settings) -> bool:
    """Whether a result comes from these settings of the integrator."""
    return all(getattr(result.computation, name) == value for name, value in settings.items())
