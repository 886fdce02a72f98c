"""What a chapter may ask when a claim is not proved (section 10.3): what to try, and whether more precision is.

Whatever is answered, nothing becomes proved, nothing is excluded, and the condition that failed stays the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation import proved_bifurcation
from orbitproof.verify.bifurcation.conditions import Problem
from orbitproof.verify.bifurcation.proved_bifurcation import BifurcationResults, check
from orbitproof.verify.evidence import Checklist, DerivativeTable, Hypothesis, Outcome, Reason


@dataclass(frozen=True)
class Failure:
    """What is known of a claim that is not proved.

    Attributes:
        claim, problem: what was claimed, and what the conditions were evaluated from.
        reason: why it is not proved.
        hypotheses: those that were looked at, the one that fails last.
        check: the conditions, of another problem; raises as they do.
    """

    claim: Candidate
    problem: Problem
    reason: Reason
    hypotheses: Sequence[Hypothesis]
    check: Callable[[Problem], object]


Counsel = Callable[[Failure], Reason]
"""The reason, in better words and with a better remedy. `verify.oracle` has one."""


def silent(failure: Failure) -> Reason:
    """The counsel that knows nothing better."""
    return failure.reason


def advised(failure: Failure, counsel: Counsel) -> Reason:
    """The reason as a counsel tells it."""
    return failure.reason.told(counsel(failure))


def prove(
    candidate: Candidate,
    checklist: Checklist,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb] = (),
    counsel: Counsel = silent,
) -> Outcome[BifurcationResults]:
    """As `proved_bifurcation.prove`, a counsel being asked about a claim that is not proved and not excluded."""

    def tell(problem: Problem, reason: Reason) -> Reason:
        hypotheses = tuple(checklist.hypotheses)
        return counsel(
            Failure(candidate, problem, reason, hypotheses, lambda other: check(candidate, Checklist(), other))
        )

    return proved_bifurcation.prove(candidate, checklist, iterates, first_integral, return_times, tell)
