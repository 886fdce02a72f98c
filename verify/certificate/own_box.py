"""From the proof of a level form to that of the candidate's own box (section 12.3); reasons of what broke off."""

from __future__ import annotations

from typing import Any

from orbitproof.shared.formats import BoxClaim, InputError
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    guarded,
)


def for_origin(origin: BoxClaim, outcome: Outcome[Any], precision: int) -> Outcome[Any]:
    """The outcome for a candidate whose level form was checked: that it holds for its own box has to be shown too."""
    if isinstance(outcome, NotProved):
        return outcome
    kind = kind_of(origin)
    form = kind.level_form(origin)
    if form is None or kind.check_own_box is None:
        reason = Reason("level-box", "the candidate has no level form", "verify it with `level` coordinates")
        return NotProved(reason, outcome.hypotheses)
    theorem = kind.theorem_of(origin, form)
    if isinstance(theorem, Reason):
        return NotProved(theorem, outcome.hypotheses)
    checklist = Checklist()
    checklist.hypotheses += outcome.hypotheses
    with guarded(precision):
        try:
            kind.check_own_box(checklist, origin, form, outcome.results.point)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
    return Proved(theorem, outcome.results, tuple(checklist.hypotheses))


def broken_off(stage: str, error: Exception) -> Reason:
    """The reason of a stage that ended with an exception that no hypothesis accounts for."""
    message = " ".join(f"the {stage} broke off: {type(error).__name__}: {error}".split()).removesuffix(":")
    if isinstance(error, MemoryError):
        remedy = "free memory, or give fewer `jobs` or `max_precision` less"
    elif isinstance(error, InputError):
        remedy = "correct the candidate"
    elif isinstance(error, (ArithmeticError, ValueError)):
        remedy = "smaller radii or another centre"
    else:
        remedy = "report it together with the candidate: this is a defect of the verifier"
    return Reason(stage, message, remedy)
