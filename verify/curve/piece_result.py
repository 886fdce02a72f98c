"""What became of an interval of a piece, of a curve or of a surface (sections 15.3 and 17.2), in words about pieces."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from orbitproof.shared.numbers import format_exact
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    Theorem,
    without_result,
)

Interval = tuple[Fraction, Fraction]
Account = dict[str, float | int | str]
"""Settings of the integrator, steps, coordinates and seconds, by name."""


class Results(Protocol):
    """What is known of a piece on an interval that is proved."""

    def to_json(self) -> dict[str, Any]:
        """Its part of the JSON object of the result; all numbers that carry proof are exact."""


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
    computation: Mapping[str, float | int | str]

    @property
    def is_proved(self) -> bool:
        """Whether the claim of the piece is proved on the interval."""
        return isinstance(self.outcome, Proved)

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the result."""
        outcome = self.outcome
        proved = isinstance(outcome, Proved)
        return {
            "piece": self.piece,
            "interval": interval_to_json(self.interval),
            "verdict": "proved" if proved else "not proved",
            "computation": dict(self.computation),
            **(outcome.results.to_json() if isinstance(outcome, Proved) else {"reason": outcome.reason.to_json()}),
        }


def interval_to_json(interval: Interval) -> list[str]:
    """The ends of an interval, exactly."""
    return [format_exact(end) for end in interval]


def broken_off(condition: str, error: ArithmeticError | ValueError) -> Reason:
    """The reason of a check of a piece that no hypothesis accounts for, in words about the piece."""
    return Reason(condition, f"on the whole piece {without_result(error)}", _NARROWER)


def about_pieces(reason: Reason) -> Reason:
    """A reason with the remedy that a piece allows."""
    return replace(reason, remedy=_REMEDIES.get(reason.condition, reason.remedy))


def attempt(
    piece: str,
    interval: Interval,
    theorem: Theorem,
    computation: Account,
    check: Callable[[Checklist], Known],
) -> PieceResult[Known]:
    """What comes of `check`, which goes through the hypotheses and completes `computation`."""
    checklist = Checklist()
    outcome: Outcome[Known]
    start = time.monotonic()
    try:
        # Bounds that overflow are infinite, and what is infinite proves nothing.
        with np.errstate(all="ignore"):
            outcome = Proved(theorem, check(checklist), tuple(checklist.hypotheses))
    except NotEstablishedError as error:
        outcome = NotProved(about_pieces(error.reason), tuple(checklist.hypotheses))
    except (ArithmeticError, ValueError) as error:
        outcome = NotProved(broken_off("verification", error), tuple(checklist.hypotheses))
    computation["seconds"] = round(time.monotonic() - start, 3)
    return PieceResult(piece, interval, outcome, computation)
