"""The pages of theorems about whole branches have the words that the program prints now."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
from support import stability_cases
from support.chain_cases import certificate, circle_point, concluded, symmetric_arc, symmetric_loop
from support.forgeries import DATA, conclusion_of, read
from test_forged_certificates import of_parabola

from orbitproof.verify.branches.curve_conclusion import told

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path.insert(0, str(DOCS))

from theorems import in_markdown  # noqa: E402

PAGES = "\n".join(page.read_text("utf-8") for page in sorted((DOCS / "theorems").glob("*.md")))


def skeleton(text: str) -> str:
    """Without numbers, enclosures, ids and lists of names."""
    text = re.sub(r" \(exactly [^)]*\)", "", text)
    text = re.sub(r"[\[(]-?[0-9][^\])]*\]", "#", text)
    text = re.sub(r"(?<![A-Za-z^_])-?[0-9][0-9.e+-]*[0-9]|(?<![A-Za-z^_])[0-9]\b", "#", text)
    text = re.sub(r"\bL[123]\b", "L#", text)
    return re.sub(r"^- [^:]*: (.*) in piece .*", r"- \1", text)


def lyapunov() -> str:
    result = {
        **of_parabola()[1][0], "piece": "p001", "deviation": ["0x1p-40"], "slope_deviation": ["0x1p-36"]
    }  # fmt: skip
    return said(conclusion_of(read("atlas-lyapunov.json"), [result], []))


def said(conclusion: dict[str, Any]) -> str:
    assert conclusion["verdict"] == "proved"
    return as_on_a_page(conclusion["statement"])


def as_on_a_page(text: str) -> str:
    """With formulas between dollars."""
    return "\n".join(map(in_markdown, text.splitlines()))


def results(name: str) -> Any:
    return json.loads((DATA / name).read_text())


CASES = {
    "curve": lambda: said(conclusion_of(stability_cases.atlas(), stability_cases.results(), [])),
    "symmetric arc": lambda: said(told(concluded(symmetric_arc()))),
    "symmetric loop": lambda: said(told(concluded(symmetric_loop(), certificate(circle_point(0.7), name="one")))),
    "family of a libration point": lyapunov,
    "surface": lambda: said(conclusion_of(read("surface.json"), results("surface-results.json"), [])),
}


def sentences(text: str) -> set[str]:
    return {each for line in text.splitlines() for each in re.split(r"(?<=[.:]) ", skeleton(line))}


@pytest.mark.parametrize("case", CASES)
def test_the_pages_have_the_words_of_this_version(case: str) -> None:
    missing = sentences(CASES[case]()) - sentences(PAGES)
    # Of the surfaces of the pages it is known which family their orbits belong to.
    assert [each for each in missing if "up to the identification" not in each] == []
    more = sentences(as_on_a_page("Along it beta increases strictly. There is no such theorem."))
    assert more - sentences(PAGES) == {"There is no such theorem."}
