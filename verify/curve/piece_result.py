"""What became of an interval of a piece, of a curve or of a surface (sections 15.3 and 17.2), in words about pieces."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Generic, Protocol, TypeVar, cast

import numpy as np
from flint import arb

from orbitproof.shared.claims.fields import Line, PieceId
from orbitproof.shared.errors import InputError
from orbitproof.shared.stored import rules
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    Theorem,
    spared,
    without_result,
)

PROVED, NOT_PROVED = "proved", "not proved"
Interval = tuple[Fraction, Fraction]
Bounds = Annotated[tuple[Fraction, ...], rules("bounds", minItems=1, maxItems=32)]
Setting = Annotated[int, rules("setting", minimum=0, maximum=4096)]
Account = dict[str, Any]
"""What becomes a `Computation`, by name, as long as it goes on."""


@dataclass(frozen=True)
class Computation:
    """How an interval was integrated.

    Attributes:
        seconds: of processor time.
        precision: bits.
        order: degree of the expansions in time.
        width: degree of the expansions in s.
        top: the highest derivatives across the curve.
        steps: of the integration.
        coordinates: those that were integrated.
    """

    seconds: Annotated[float, rules(minimum=0)]
    precision: Setting | None = None
    order: Setting | None = None
    width: Setting | None = None
    top: Setting | None = None
    steps: Annotated[int, rules(minimum=0)] | None = None
    coordinates: Annotated[Line, rules(maxLength=200)] | None = None


@dataclass(frozen=True)
class IntervalResult:
    """What was found for a piece on an interval of s: what is proved, or why it is not.

    Attributes:
        piece: its id.
        interval: on which it is proved, or which was asked for.
        verdict: "proved" or "not proved".
        computation: how.
        reason: why it is not proved; `None` if it is.
        deviation, slope_deviation: as of `ProvedInterval`.
        time: half periods of the orbits.
    """

    piece: PieceId
    interval: Interval
    verdict: Annotated[str, rules(enum=(PROVED, NOT_PROVED))]
    computation: Computation
    reason: Reason | None = None
    deviation: Bounds = ()
    slope_deviation: Bounds = ()
    time: arb | None = None

    stability, twist, multipliers, parts = cast(Any, (None, None, None, ()))
    """What further results of some kinds of branches have; of the others it was not asked."""

    stored_rules: ClassVar = {
        "if": {"properties": {"verdict": {"const": PROVED}}},
        "then": {"not": {"required": ["reason"]}},
        "else": {"required": ["reason"]},
    }

    def __post_init__(self) -> None:
        if self.verdict != (PROVED if self.reason is None else NOT_PROVED):
            raise InputError("verdict: does not fit the reason; write the file again")

    @property
    def is_proved(self) -> bool:
        """Whether the claim of the piece is proved on the interval."""
        return self.reason is None


class Results(Protocol):
    """What is known of a piece on an interval that is proved."""

    def stored(self, piece: str, computation: Computation) -> IntervalResult:
        """The proved interval as it is stored; all numbers that carry proof are exact."""


Known = TypeVar("Known", bound=Results, covariant=True)


_NARROWER = "give a narrower piece or a narrower tube"
_REMEDIES = {
    "singularity": f"orbits of the piece come too close to a collision, or grow without bound: {_NARROWER}",
    "collision": f"{_NARROWER}; the curve may contain a collision",
    "crossing count": f"orbits of the piece may touch the section: {_NARROWER}, or end the curve before it",
    "section": "the half periods differ too much along the piece: give a narrower piece",
    "tube": f"{_NARROWER}, or more precision",
    "steps": f"the orbits may not return, or the steps become too short: {_NARROWER}",
    "size": _NARROWER,
}
"""By the condition that failed; the integrator itself speaks of the boxes of candidates."""


@dataclass(frozen=True)
class PieceResult(Generic[Known]):
    """What was found for a piece on an interval of s.

    Attributes:
        piece: its id.
        interval: the one that was asked for; what is proved may hold on a longer one.
        outcome: whether the claim of the piece is proved for all s of the interval.
        computation: how.
    """

    piece: str
    interval: Interval
    outcome: Outcome[Known]
    computation: Computation

    @property
    def is_proved(self) -> bool:
        """Whether the claim of the piece is proved on the interval."""
        return isinstance(self.outcome, Proved)

    @property
    def stored(self) -> IntervalResult:
        """The result as it is stored; balls are wider than they were found (13.3)."""
        if isinstance(self.outcome, Proved):
            return spared(self.outcome.results.stored(self.piece, self.computation))
        return IntervalResult(self.piece, self.interval, NOT_PROVED, self.computation, self.outcome.reason)


def broken_off(condition: str, error: ArithmeticError | ValueError) -> Reason:
    """The reason of a check of a piece that no hypothesis accounts for, in words about the piece."""
    return Reason(condition, f"on the whole piece {without_result(error)}", _NARROWER)


def about_pieces(reason: Reason) -> Reason:
    """A reason with the remedy that a piece allows."""
    return replace(reason, remedy=_REMEDIES.get(reason.condition, reason.remedy))


def attempt(
    piece: str, interval: Interval, theorem: Theorem, computation: Account, check: Callable[[Checklist], Known]
) -> PieceResult[Known]:
    """What comes of `check`, which goes through the hypotheses and completes `computation`."""
    checklist = Checklist()
    outcome: Outcome[Known]
    start = time.process_time()
    try:
        # Bounds that overflow are infinite, and what is infinite proves nothing.
        with np.errstate(all="ignore"):
            outcome = Proved(theorem, check(checklist), tuple(checklist.hypotheses))
    except NotEstablishedError as error:
        outcome = NotProved(about_pieces(error.reason), tuple(checklist.hypotheses))
    except (ArithmeticError, ValueError) as error:
        outcome = NotProved(broken_off("verification", error), tuple(checklist.hypotheses))
    computation["seconds"] = round(time.process_time() - start, 3)
    return PieceResult(piece, interval, outcome, Computation(**computation))
