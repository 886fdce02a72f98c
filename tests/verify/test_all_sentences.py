"""The sentences of all theorems are those of tests/data/sentences.txt, which are read before they are stored."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
import sentences

from orbitproof.verify.curve import Conclusion
from orbitproof.verify.evidence import Hypothesis, NotProved, Proved, Reason
from orbitproof.verify.words.branches import conclusion_in_words


def test_every_sentence_is_as_it_is_stored() -> None:
    """`python tests/sentences.py` stores them anew."""
    said, stored = sentences.all_sentences(), sentences.stored()
    assert list(said) == list(stored)
    assert {name: text for name, text in said.items() if text != stored[name]} == {}
    assert len(said) > 300


def test_nothing_is_said_of_what_is_not_proved() -> None:
    outcome: Any = NotProved(Reason("pieces", "a piece is missing", "add it"))
    assert conclusion_in_words(Conclusion(outcome)) == ""


def test_a_theorem_of_another_kind_is_about_no_curve() -> None:
    theorem: Any = SimpleNamespace(hypotheses=("holds",))
    proved: Any = Proved(theorem, theorem, (Hypothesis("holds", "it holds", "1", True),))
    with pytest.raises(TypeError, match="SimpleNamespace: a theorem about no curve"):
        conclusion_in_words(Conclusion(proved))
