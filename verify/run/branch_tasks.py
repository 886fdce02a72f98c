"""The proof of one interval of a piece as a task for an engine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from orbitproof.shared.formats import AnyAtlas, AnyPiece, InputError
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems import LIFTED
from orbitproof.verify.branches import ProvedBefore, Result, Settings, condition_of, kind_of
from orbitproof.verify.branches.certificate import results_for
from orbitproof.verify.branches.interval_proof import not_proved, question
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.results import result_from_json
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.curve import NOT_PROVED, Interval
from orbitproof.verify.evidence import Reason
from orbitproof.verify.run import Answer, Failure, Task
from orbitproof.verify.run.splitting import UNFINISHED, made_with

MOST_SPLITS, LARGEST_ORDER = 20, 99


@dataclass(frozen=True)
class RunLimits:
    """How to prove pieces.

    Attributes:
        integrator: settings of `PieceLimits` or `SurfaceLimits` for the first attempt, by name, if not the default.
        timeout: seconds of processor time for an interval, or `None`.
        max_splits: how often an interval is halved at most.
        stability: whether the stability of the orbits on proved intervals is enclosed as well.
        order: up to which k all resonances are wanted then.
        combinations: whether combination resonances are wanted then.
        lasting: whether their twist is enclosed too.
    """

    integrator: Mapping[str, int]
    timeout: float | None = None
    max_splits: int = 6
    stability: bool = False
    order: int = 1
    combinations: bool = False
    lasting: bool = False

    def __post_init__(self) -> None:
        for name, value, first, last in (
            ("complete", self.order, 1, LARGEST_ORDER),
            ("max_splits", self.max_splits, 0, MOST_SPLITS),
        ):
            if type(value) is not int or not first <= value <= last:
                raise ValueError(f"{name}: {value!r} is not a whole number from {first} to {last}")
        if self.timeout is not None and not 0 < self.timeout < 1e9:
            raise ValueError(f"timeout: {self.timeout!r} is not a positive number of seconds")


def attempts_of(atlas: AnyAtlas, limits: RunLimits) -> tuple[Settings, ...]:
    """Settings of the integrator for the first attempt at an interval and for the next one.

    Some orbits lose more digits than others, and no shorter interval makes up for them. Raises `ValueError` if a
    setting is out of range.
    """
    given = {**_wanted(atlas, limits), **limits.integrator}
    first = kind_of(atlas).settings(**given)
    # Bounds of what is beyond the highest derivatives grow over a whole period, not over half of one.
    more = {"precision": _MORE_BITS, "order": _MORE_ORDER, "width": _MORE_WIDTH, **kind_of(atlas).more_at_next}
    return first, {name: value + more.get(name, 0) for name, value in first.items()}


def for_slopes_of(attempts: Sequence[Settings]) -> Settings | None:
    """Settings for intervals on which the derivative across the curve may be singular: second ones are followed too.

    Bounds of what is beyond the first derivatives grow along an orbit; `None` if these are not the highest anyway.
    """
    return {**attempts[0], "top": 2} if attempts[0]["top"] == 1 else None


def all_attempts_of(atlas: AnyAtlas, limits: RunLimits) -> tuple[Settings, ...]:
    """`attempts_of`, then those for special cases: `for_slopes_of`, and last of all `closer_look_of`."""
    attempts = attempts_of(atlas, limits)
    across = for_slopes_of(attempts)
    special = (*(() if across is None else (across,)), *((closer_look_of(attempts),) if limits.lasting else ()))
    return *attempts, *special


def _wanted(atlas: AnyAtlas, limits: RunLimits) -> Settings:
    if limits.lasting:
        return _FOR_LASTING
    if not limits.stability:
        return {}
    if atlas.system is LIFTED:
        return _FOR_AXIAL_ORBITS
    pieces = atlas.curve_pieces()
    return _FOR_ONE_PARAMETER if pieces and len(pieces[0].tube) == 1 else _FOR_STABILITY


def closer_look_of(attempts: Sequence[Settings]) -> Settings:
    """Settings for short intervals about exceptions of `lasting`: few powers of s, and more bits."""
    first = attempts[0]
    more = {"precision": _CLOSER_BITS, "order": _CLOSER_ORDER}
    return {**{name: value + more.get(name, 0) for name, value in first.items()}, "width": _CLOSER_WIDTH}


_CLOSER_BITS, _CLOSER_ORDER, _CLOSER_WIDTH = 48, 12, 12
_MORE_BITS, _MORE_ORDER, _MORE_WIDTH = 48, 8, 8
_FOR_STABILITY = {"precision": 88, "order": 36, "width": 56}
"""More than a proof takes: of n parameters of stability one may be small and the others large."""
_FOR_ONE_PARAMETER = {"precision": 72, "order": 28, "width": 40}
"""With more of each the points of a list are no better known: the curve is not, as far as its tube is wide."""
_FOR_AXIAL_ORBITS = {"precision": 108, "order": 38, "width": 56}
"""One parameter is in the hundreds, one about 1: with 88 bits a_2 of L2, Earth-Moon, is known up to 0.4 at first."""
_FOR_LASTING = {"precision": 96, "order": 40, "width": 36}
"""Where it is not enough, shorter intervals take less time than more bits; exceptions are looked at closer anyway."""
HALVED_FOR_LASTING = 1
"""Derivatives converge more slowly along the curve: with a smaller width halves of a piece take less time together."""


def task_of(
    atlas: AnyAtlas, piece: AnyPiece, interval: Interval, settings: Settings, limits: RunLimits, steps: int
) -> Task:
    """The task of proving a piece on an interval; the expected number of `steps` is for progress only."""
    asked = (limits.stability, limits.timeout, steps, limits.lasting)
    return Task(piece.id, question(atlas, piece, interval, settings, *asked))


def task_again(atlas: AnyAtlas, before: ProvedBefore, timeout: float | None) -> Task:
    """The task of proving an interval again that a certificate says is proved; `timeout` in seconds."""
    looked_at = (before.stability, timeout, before.steps, before.lasting)
    asked = question(atlas, before.piece, before.interval, before.settings, *looked_at)
    parts = {"parts": [[format_exact(end) for end in part] for part in before.parts]} if before.parts else {}
    stated = {} if before.stated is None else {"stated": before.stated}
    return Task(before.name, {**asked, **parts, **stated})


def result_of(answer: Answer, piece: AnyPiece, kind: BranchKind) -> Result:
    """The result of a task about a piece of a branch of this kind, also if its process was lost."""
    if isinstance(answer.result, Failure):
        return not_proved(answer.task.argument, answer.result.kind, answer.result.message, answer.seconds)
    try:
        found = result_from_json(kind.result(piece), answer.result, "the answer")
        if found.piece != piece.id:
            raise ValueError(f"it is about {found.piece!r}")
        return found
    except (InputError, LookupError, TypeError, ValueError) as error:
        return not_proved(answer.task.argument, "process", f"no result: {error}", answer.seconds)


def in_vain(result: Result) -> Result:
    """A closer look that leaves open what the wider one decides, and is not to count in its place."""
    reason = Reason("stability", "it leaves open what a wider interval decides", "nothing is missing")
    return Result(result.piece, result.interval, NOT_PROVED, result.computation, reason)


def reusable(
    certificate: Certificate,
    atlas: AnyAtlas,
    attempts: Sequence[Settings],
    stability: bool = False,
    lasting: bool = False,
) -> list[Result]:
    """The results of an earlier run that count for an atlas, with these settings of the integrator for attempts.

    If `stability` or `lasting` is asked for, they must have looked at it. What failed for want of time or memory,
    or with other settings, is tried again.
    """
    return [
        result
        for result in results_for(certificate, atlas)
        if (_has(result, stability, lasting) if result.is_proved else _is_final(result, attempts))
    ]


def _has(result: Result, stability: bool, lasting: bool) -> bool:
    return (not stability or result.stability is not None) and (not lasting or result.twist is not None)


def _is_final(result: Result, attempts: Sequence[Settings]) -> bool:
    return condition_of(result) not in UNFINISHED and any(made_with(result, settings) for settings in attempts)
