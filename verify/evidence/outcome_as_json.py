"""Outcomes as JSON, and words of a file as quotations (sections 10.2 and 13.1)."""

from __future__ import annotations

import re
from typing import Any

from orbitproof.verify.evidence.balls_as_text import balls_to_json
from orbitproof.verify.evidence.outcome import Hypothesis, Outcome, Proved, Reason


def outcome_to_json(outcome: Outcome[object]) -> dict[str, Any]:
    """The JSON object of an outcome: verdict, reason and hypotheses with their enclosures, without the results."""
    return {
        "verdict": "proved" if isinstance(outcome, Proved) else "not proved",
        "reason": None if isinstance(outcome, Proved) else reason_to_json(outcome.reason),
        "hypotheses": [hypothesis_to_json(hypothesis) for hypothesis in outcome.hypotheses],
    }


def reason_to_json(reason: Reason) -> dict[str, str]:
    """The JSON object of a reason: one line each, whatever an exception had to say."""
    return {"condition": reason.condition, "message": one_line(reason.message), "remedy": one_line(reason.remedy)}


def as_said(reason: Reason) -> str:
    """A reason as a certificate tells it: words of the run that made it are a quotation, which nothing checks."""
    remedy = f", and to try: {one_line(reason.remedy)!r}" if reason.remedy else ""
    return f"{reason.condition}; the run said: {one_line(reason.message)!r}{remedy}"


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


def one_line(text: str) -> str:
    """A text on one line, of bounded length, without characters that are not printed as themselves."""
    return "".join(each if each.isprintable() else "?" for each in " ".join(text.split())[:_LONGEST_LINE])


_LONGEST_LINE = 4000
