"""Conclusions about curves of exact pieces, proved or refused."""

from __future__ import annotations

from orbitproof.verify.curve import Conclusion, ProvedCurve
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.words.branches import conclusion_in_words


def refusal(conclusion: Conclusion[ProvedCurve]) -> str:
    """Condition and message of what is not proved, which says nothing of the curve."""
    assert isinstance(conclusion.outcome, NotProved)
    assert conclusion_in_words(conclusion) == ""
    assert conclusion.outcome.hypotheses[-1].holds is False
    return f"{conclusion.outcome.reason.condition}: {conclusion.outcome.reason.message}"


def proof(conclusion: Conclusion[ProvedCurve]) -> ProvedCurve:
    """What is known of a curve that is proved."""
    assert isinstance(conclusion.outcome, Proved)
    return conclusion.outcome.results
