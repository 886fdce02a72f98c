"""From a checklist to an outcome: what is raised on the way proves nothing (section 10.1)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from orbitproof.verify.evidence.failure import without_result
from orbitproof.verify.evidence.outcome import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    Theorem,
)

Results = TypeVar("Results")


def concluded(theorem: Theorem | Reason, checklist: Checklist, check: Callable[[], Results]) -> Outcome[Results]:
    """The theorem with what `check` finds, or why it is not proved.

    Args:
        theorem: what is claimed, or why that is no theorem.
        check: looks at the hypotheses that are not on the list yet, one by one, and returns what is known then. What
            it raises, `NotEstablishedError` for the first that fails or an `ArithmeticError`, is why nothing is proved.
    """
    if isinstance(theorem, Reason):
        return NotProved(theorem, tuple(checklist.hypotheses))
    try:
        results = check()
    except NotEstablishedError as error:
        return NotProved(error.reason, tuple(checklist.hypotheses))
    except ArithmeticError as error:
        message = f"a result could not be evaluated: {without_result(error)}"
        reason = Reason("results", message, "more precision", needs_precision=True)
        return NotProved(reason, tuple(checklist.hypotheses))
    return Proved(theorem, results, tuple(checklist.hypotheses))
