"""What a chapter may ask when a claim is not proved (section 10.3): what to try, and whether more precision is.

Whatever is answered, nothing becomes proved, nothing is excluded, and the condition that failed stays the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.conditions import Problem
from orbitproof.verify.evidence import Hypothesis, Reason


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
    """The reason as a counsel tells it; what failed, and what is excluded, is not for it to say."""
    return replace(counsel(failure), condition=failure.reason.condition, excluded=failure.reason.excluded)
