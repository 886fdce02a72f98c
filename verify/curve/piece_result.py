"""What became of an interval of a piece, of a curve or of a surface (sections 15.3 and 17.2)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from orbitproof.shared.numbers import format_exact
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Outcome, Proved, Reason, Theorem

Interval = tuple[Fraction, Fraction]
Account = dict[str, float | int | str]
"""Settings of the integrator, steps, coordinates and seconds, by name."""


class Results(Protocol):
    """What is known of a piece on an interval that is proved."""

    def to_json(self) -> dict[str, Any]:
        """Its part of the JSON object of the result; all numbers that carry proof are exact."""


Known = TypeVar("Known", bound=Results, covariant=True)


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
        outcome = NotProved(error.reason, tuple(checklist.hypotheses))
    except (ArithmeticError, ValueError) as error:
        message = " ".join(f"the verification broke off: {type(error).__name__}: {error}".split())
        outcome = NotProved(Reason("verification", message, "give a narrower piece"), tuple(checklist.hypotheses))
    computation["seconds"] = round(time.monotonic() - start, 3)
    return PieceResult(piece, interval, outcome, computation)
