"""A file that breaks its schema is refused with the field and the rule, never with a copy of the file."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from orbitproof.shared.formats import InputError, validate_document

DOCUMENT = json.loads((Path(__file__).parents[1] / "data" / "figures-certificates.json").read_text())


def put(*path: str | int, value: Any) -> Callable[[Any], None]:
    """A change that stores `value` at the end of `path`."""

    def change(document: Any) -> None:
        for step in path[:-1]:
            document = document[step]
        document[path[-1]] = value

    return change


FIRST = ("certificates", 0)
LONG = ["filler"] * 1000
# The change, the field that the message has to name, and the rule.
BROKEN: dict[str, tuple[Callable[[Any], None], str, str]] = {
    "no entries": (put("certificates", value=[]), "field certificates:", "at least 1 entries"),
    "list for an object": (put(*FIRST, "results", value=LONG), "certificates[0].results:", "type object"),
    "object for a list": (put("certificates", value={"a": LONG}), "field certificates:", "type array"),
    "text for a number": (put(*FIRST, "k", value=LONG), "certificates[0]:", "unknown key 'k'"),
    "long key": (put(*FIRST, "filler" * 1000, value=0), "certificates[0]:", "unknown key"),
    "long text": (put(*FIRST, "verdict", value="filler" * 1000), "certificates[0].verdict:", '"not proved"'),
    "NaN as text": (put(*FIRST, "results", "parameter", "mid", value="nan"), "results.parameter.mid:", '"nan"'),
    "wrong version": (put("version", value=2), "field version:", "2 must be 1"),
    "verdict without its reason": (put(*FIRST, "verdict", value="not proved"), "statement:", "'theorem'"),
    "proved, but a hypothesis fails": (put(*FIRST, "hypotheses", 0, "holds", value=False), "holds:", "must be true"),
    "a number with a point for an integer": (
        put(*FIRST, "computation", "precision", value=176.0),
        "precision:",
        "type integer",
    ),
    "missing key": (lambda document: document["certificates"][0].pop("id"), "certificates[0]:", "'id' is missing"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_the_message_names_field_and_rule_without_the_value(case: str) -> None:
    change, field, rule = BROKEN[case]
    document = copy.deepcopy(DOCUMENT)
    validate_document(document, "certificates", "file.json")
    change(document)
    with pytest.raises(InputError) as caught:
        validate_document(document, "certificates", "file.json")
    message = str(caught.value)
    assert field in message
    assert rule in message
    assert len(message) < 300
    assert "\n" not in message
