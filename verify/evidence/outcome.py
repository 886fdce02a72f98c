"""What a verification returns: `Proved` or `NotProved`, with every hypothesis and its enclosures.

Rows, pieces, curves and surfaces all end in one of the two. A `Proved` cannot be made unless the hypotheses are
exactly those of the theorem, in order, and all of them hold; a check that was left out can therefore never lead to it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from flint import arb

from orbitproof.verify.evidence.comparisons import EmptyIntersectionError


@dataclass(frozen=True)
class Hypothesis:
    """One hypothesis of a theorem and what was found.

    Attributes:
        name: short key, for example "HC3".
        statement: the inequality or inclusion that was checked, in words.
        section: section of the method (docs/method.md leads to it) that says why it is enough.
        holds: whether it is shown.
        enclosures: the balls that show it, by name.
    """

    name: str
    statement: str
    section: str
    holds: bool
    enclosures: Mapping[str, arb] = field(default_factory=dict)


class Theorem(Protocol):
    """What a verdict proves: a value of a type that its chapter has, which says what it is about.

    Its words follow from it and from the results (`verify.words`).
    """

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """The names of the hypotheses that it takes, in the order of checking."""


@dataclass(frozen=True)
class Reason:
    """Why a claim is not proved. Failure to verify is not a proof that the claim is false.

    Attributes:
        condition: name of the hypothesis, or short key of what stopped the verification.
        message: what happened.
        remedy: what to try; settings have Python's names, between backticks (`shared.arguments.as_options`).
        needs_precision: whether more precision may mend it.
        enough_precision: bits that are expected to be enough, where that is known.
        excluded: whether enclosures show that there is no such point in the box, whatever the form of the claim.
        reached: how far an integration came that broke off: its time.
        enclosures: what the condition failed with, by name, where the outcome has no such hypothesis.
    """

    condition: str
    message: str
    remedy: str
    needs_precision: bool = False
    enough_precision: int | None = None
    excluded: bool = False
    reached: float | None = None
    enclosures: Mapping[str, arb] = field(default_factory=dict, compare=False)


Results = TypeVar("Results", covariant=True)
"""What is known of what is proved."""


@dataclass(frozen=True)
class Proved(Generic[Results]):
    """The theorem holds, and gives the results. Raises `ValueError` if the hypotheses are not all there."""

    theorem: Theorem
    results: Results
    hypotheses: tuple[Hypothesis, ...]

    def __post_init__(self) -> None:
        names = tuple(hypothesis.name for hypothesis in self.hypotheses)
        if not names or names != self.theorem.hypotheses:
            raise ValueError(f"hypotheses {names} are not those of the theorem, {self.theorem.hypotheses}")
        if not all(hypothesis.holds is True for hypothesis in self.hypotheses):
            raise ValueError("a hypothesis that does not hold proves nothing")


@dataclass(frozen=True)
class NotProved:
    """The theorem was not shown to hold; `hypotheses` are those that were looked at."""

    reason: Reason
    hypotheses: tuple[Hypothesis, ...] = ()


Outcome = Proved[Results] | NotProved


class NotEstablishedError(Exception):
    """A hypothesis could not be shown; carries the `Reason`. Ends the check of one candidate."""

    def __init__(self, reason: Reason) -> None:
        super().__init__(reason.message)
        self.reason = reason


class Evidence:
    """Collects the enclosures and requirements of one hypothesis."""

    def __init__(self, remedy: str) -> None:
        self.remedy = remedy
        self.enclosures: dict[str, arb] = {}
        self.requirements: list[bool] = []
        self.failure: str | None = None
        self.needs_precision = False
        self.excluded = False

    def record(self, name: str, ball: arb) -> arb:
        """Keep an enclosure for the certificate and return it; two of one name are no evidence."""
        if name in self.enclosures:
            self.require(False, f"two enclosures are called {name}")
        self.enclosures[name] = ball
        return ball

    def require(self, holds: bool, failure: str, needs_precision: bool = False, excluded: bool = False) -> None:
        """Add a requirement; `failure` says in words what is wrong if it is not met, the rest is as in `Reason`."""
        self.requirements.append(holds is True)
        if holds is not True and self.failure is None:
            self.failure = failure
            self.needs_precision = needs_precision
            self.excluded = excluded

    @property
    def holds(self) -> bool:
        """Whether there is a requirement and all are met."""
        return bool(self.requirements) and all(self.requirements)


class Checklist:
    """The hypotheses looked at so far, in order."""

    def __init__(self) -> None:
        self.hypotheses: list[Hypothesis] = []

    @contextmanager
    def hypothesis(self, name: str, section: str, statement: str, remedy: str) -> Iterator[Evidence]:
        """Check one hypothesis in the body of a ``with`` statement.

        The body records enclosures and requirements. If a requirement fails, or there is none, or the
        arithmetic has no finite result, the hypothesis does not hold and `NotEstablishedError` is raised.
        """
        evidence = Evidence(remedy)
        try:
            yield evidence
        except ZeroDivisionError:
            evidence.require(False, "a divisor or a matrix may be singular", needs_precision=True)
        except EmptyIntersectionError as error:
            evidence.require(False, f"{error}; a bound is wrong", needs_precision=False)
        except KeyError as error:
            evidence.require(False, f"the derivative {error} is missing", needs_precision=False)
        self.hypotheses.append(Hypothesis(name, statement, section, evidence.holds, dict(evidence.enclosures)))
        if not evidence.holds:
            message = evidence.failure or "nothing was checked"
            raise NotEstablishedError(
                Reason(
                    name,
                    f"{statement}: {message}",
                    evidence.remedy,
                    evidence.needs_precision,
                    excluded=evidence.excluded,
                )
            )


def show(ball: arb) -> str:
    """A ball for a message, with few digits: FLINT's decimal interval, which contains it."""
    return ball.str(4)
