"""Documents are read by people in a hurry: no sentence is long."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LONGEST = {"documents": 35, "chapters": 40}
"""Words of a sentence."""
DOCUMENTS = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "CODE_OF_CONDUCT.md",
    ROOT / "CHANGELOG.md",
    ROOT / "paper" / "paper.md",
    *sorted(path for room in ("shared", "verify") for path in (ROOT / room).rglob("README.md")),
    *sorted(path for path in (ROOT / "docs").rglob("*.md") if path.parent.name not in ("theorems", "site")),
]
"""What people write: pages of theorems have the words of certificates."""


def sentences(text: str) -> Iterator[str]:
    """Those of a text in Markdown; code, a formula and a link count as a word each, tables and headings not at all."""
    text = re.sub(r"\A---\n.*?\n---\n", "", text, flags=re.DOTALL)
    text = re.sub(r"```.*?```|\$\$.*?\$\$|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"^(\||    |#).*$", "", text, flags=re.MULTILINE)
    for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:- |\d+\. ))", text):
        words = re.sub(r"`[^`]*`|\$[^$]*\$", "X", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(paragraph.split())))
        yield from re.split(r"(?<=[.!?:;])\s+(?=[A-Z*\[(])|(?<=\.\))\s+", words)


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_sentences_of_documents_are_short(path: Path) -> None:
    longest = LONGEST["chapters" if path.is_relative_to(ROOT / "verify") else "documents"]
    found = [each for each in sentences(path.read_text("utf-8")) if len(each.split()) > longest]
    assert found == []


def test_a_long_sentence_is_found() -> None:
    text = f"# Title\n\nShort one. Long {'word ' * 41}`code`. Another.\n\n| {'cell ' * 50} |\n\n- {'item ' * 41}\n"
    assert [len(each.split()) for each in sentences(text) if len(each.split()) > LONGEST["chapters"]] == [43, 42]
