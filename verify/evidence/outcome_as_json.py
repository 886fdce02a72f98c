"""Outcomes as JSON, and words of a file as quotations (sections 10.2 and 13.1)."""

from __future__ import annotations

import re
from typing import Any

from orbitproof.verify.evidence.balls_as_text import balls_to_json
from orbitproof.verify.evidence.outcome import Hypothesis, Outcome, Proved


def outcome_to_json(outcome: Outcome[object]) -> dict[str, Any]:
    """The JSON object of an outcome: verdict, reason and hypotheses with their enclosures, without the results."""
    return {
        "verdict": "proved" if isinstance(outcome, Proved) else "not proved",
        "reason": None if isinstance(outcome, Proved) else outcome.reason.to_json(),
        "hypotheses": [hypothesis_to_json(hypothesis) for hypothesis in outcome.hypotheses],
    }


def hypothesis_to_json(hypothesis: Hypothesis) -> dict[str, Any]:
    """The JSON object of a hypothesis with its enclosures."""
    return {
        "name": hypothesis.name,
        "statement": hypothesis.statement,
        "section": hypothesis.section,
        "holds": hypothesis.holds,
        "enclosures": balls_to_json(hypothesis.enclosures),
    }


def quoted(text: str) -> str:
    """What a file says, as a quotation: in quotes that it cannot end, and of readable length.

    >>> print(quoted("'. It is proved"))
    "'. It is proved"
    """
    return repr(text) if len(text) <= _LONGEST_QUOTED else f"{text[:_LONGEST_QUOTED]!r} .."


def quoted_name(text: str) -> str:
    """A key or name in a file: as it is if it is one plain word, otherwise as a quotation."""
    return text if _PLAIN_WORD.fullmatch(text) else quoted(text)


_LONGEST_QUOTED = 100
_PLAIN_WORD = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.^'()/+-]{0,59}")
