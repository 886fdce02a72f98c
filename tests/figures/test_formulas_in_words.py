"""Formulas in the words of theorems: found, typeset sign for sign, and nothing else."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from orbitproof.figures.report.document import Math
from orbitproof.figures.report.formulas import typeset

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path.insert(0, str(DOCS))

import theorems  # noqa: E402


def shown(text: str) -> str:
    return "".join(run if isinstance(run, str) else f"${run.latex}$" for run in typeset(text)).replace("  ", " ")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("the map P to the section {y = 0}.", r"the map $P$ to the section $\{ y = 0\}$."),
        ("an R-symmetric periodic orbit, P^2(x) = x,", r"an $R$-symmetric periodic orbit, $P^{2}(x) = x$,"),
        ("of R- and S-symmetric ones", "of $R$- and $S$-symmetric ones"),
        ("beta in [1.5, 2.5], in piece p014", r"$\beta \in [1.5, 2.5]$, in piece p014"),
        ("Jacobi constant in [-1e-05, 0.5]", r"Jacobi constant in $[-1 \cdot 10^{-5}, 0.5]$"),
        ("for all mu in (0, 1/2] it", r"for all $\mu \in (0, 1/2]$ it"),
        ("and |vz| <= 0.004 mu^(1/3)", r"and $|v_{z}| \le 0.004 \mu ^{1/3}$"),
        ("X(h, 0) in Fix(R), of Fix(R').", r"$X(h, 0) \in \mathrm{Fix}(R)$, of $\mathrm{Fix}(R')$."),
        ("y' = vy at it", "$y' = v_{y}$ at it"),
        ("X = x_l + eps x on it", r"$X = x_{l} + \varepsilon x$ on it"),
        ("the multiplier -1: each orbit", "the multiplier $-1$: each orbit"),
        ("xi in [-0.774657454957, -0.774657454953]", r"$\xi$ in [-0.774657454957, -0.774657454953]"),
        ("the case eps2 -> 0", r"the case $\varepsilon _{2} \to 0$"),
    ],
)  # fmt: skip
def test_formulas_are_typeset(words: str, expected: str) -> None:
    assert shown(words) == expected


@pytest.mark.parametrize(
    "words",
    [
        "earth-moon-L1-halo-k1-1: symmetry breaking", "all resonances 1:1 to 1:12, a period 2-tupling of order 3",
        "takes all values from 1.125 to 100000 of a curve", "in Hill's units around L1, the orbit's end",
        "(exactly 0x18e267d713713fp-59), sections 17.5 and 17.6", "I know a point (section 17.7) in piece birth",
        "at (2) in [words], {sets of them} and |a word|", "candidates.json", "A point; a pair of R's", "", "x-axis",
    ],
)  # fmt: skip
def test_words_stay_words(words: str) -> None:
    assert shown(words) == words


def test_a_long_tuple_is_a_formula_for_each_entry_and_a_long_equation_one() -> None:
    ball = "[0.824060996142612345, 0.824060996142612346]"
    assert shown(f"beta in {ball}, from ({ball}, 0, {ball}) on") == rf"$\beta$ in {ball}, from ({ball}, 0, {ball}) on"
    long = "x, x + y + z + x + y + z + x + y + z + x + y + z + x + y + z, z"
    first, second, third = long.split(", ")
    assert shown(f"at ({long}) on") == f"at (${first}$, ${second}$, ${third}$) on"
    equation = "(x, z, vy) = (1 - mu + h xi, h zeta, h veta) + (1 - mu + h xi, h zeta, h veta)"
    assert [type(run) for run in typeset(f"is {equation}: for")] == [str, Math, str]


def test_nothing_of_a_text_is_lost() -> None:
    text = "Let (x, y) in [0, 1] be 2 pi/((1 - mu)/|x + mu|^3)^(1/2), with 1:2, f(x and (y), {z = 0, |x| <= or -> 3."
    parts = [run for run in typeset(text) if isinstance(run, str)]
    place = 0
    for part in parts:
        place = text.index(part, place) + len(part)


def test_pages_of_theorems_have_their_formulas_between_dollars() -> None:
    words = "with mu = 0.5 (exactly 0x1p-1), the map P to {y = 0}"
    told = r"with $\mu = 0.5$ (exactly `0x1p-1`), the map $P$ to $\lbrace y = 0\rbrace$"
    assert theorems.as_page(words) == told
    for page in sorted((DOCS / "theorems").glob("*.md")):
        for _, _, text, _ in theorems.MARKED.findall(page.read_text("utf-8")):
            assert text.count("$") > 3, page
            plain = " ".join(text.split("$")[::2])
            assert "Fix(" not in plain, page
            assert " mu " not in plain, page
            assert "_" not in plain, page
