"""A piece is proved if its hypotheses were checked and hold; whatever else becomes of a check is not proved."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from flint import arb

from orbitproof.shared import InputError
from orbitproof.verify.curve import Computation, IntervalResult, PieceResult, ProvedInterval, attempt
from orbitproof.verify.evidence import Checklist, IntegrationFailure, NotProved, Proved, Reason

ENDS = (Fraction(-1), Fraction(1))
KNOWN = ProvedInterval(*ENDS, (Fraction(1, 2**40),), (Fraction(1, 2**36),), arb(3))
REASON = Reason("tube", "the tube is empty", "")


class OneHypothesis:
    hypotheses = ("piece",)


def holding(checklist: Checklist) -> ProvedInterval:
    with checklist.hypothesis("piece", "15.2", "there is one orbit", "none") as evidence:
        evidence.require(True, "there is none")
    return KNOWN


def failing(checklist: Checklist) -> ProvedInterval:
    with checklist.hypothesis("piece", "15.2", "there is one orbit", "none") as evidence:
        evidence.require(False, "there is none")
    return KNOWN


def raising(error: Exception) -> Callable[[Checklist], ProvedInterval]:
    def check(checklist: Checklist) -> ProvedInterval:
        holding(checklist)
        raise error

    return check


def of(check: Callable[[Checklist], ProvedInterval]) -> PieceResult[Any]:
    return attempt("p001", ENDS, OneHypothesis(), {"precision": 80}, check)


def test_a_piece_whose_hypotheses_hold_is_proved() -> None:
    found = of(holding)
    assert isinstance(found.outcome, Proved)
    assert [each.name for each in found.outcome.hypotheses] == ["piece"]
    assert (found.is_proved, found.stored.is_proved, found.stored.verdict) == (True, True, "proved")


CHECKS = {
    "a hypothesis fails": (failing, "piece"),
    "none was checked": (lambda checklist: KNOWN, "verification"),
    "not enclosed": (raising(IntegrationFailure("size", "it is too large", "none")), "size"),
    **{
        type(error).__name__: (raising(error), "verification")
        for error in (ValueError("no ball"), ZeroDivisionError(), OverflowError(), FloatingPointError())
    },
}


@pytest.mark.parametrize("name", CHECKS)
def test_a_piece_of_which_anything_else_becomes_is_not_proved(name: str) -> None:
    check, condition = CHECKS[name]
    found = of(check)
    assert isinstance(found.outcome, NotProved)
    assert (found.is_proved, found.stored.is_proved, found.stored.verdict) == (False, False, "not proved")
    assert found.outcome.reason.condition == condition
    assert found.stored.deviation == ()


@pytest.mark.parametrize(("verdict", "reason"), [("proved", REASON), ("not proved", None), ("it is so", None)])
def test_a_verdict_is_that_of_its_reason(verdict: str, reason: Reason | None) -> None:
    with pytest.raises(InputError, match="does not fit the reason"):
        IntervalResult("p001", ENDS, verdict, Computation(1.0), reason)
