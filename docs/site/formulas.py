"""Pages of the tree with their formulas set: what is written in plain text, sign for sign."""

from __future__ import annotations

import re

from orbitproof.figures.report.formulas import GREEK, to_latex

_CODE = re.compile(r"\s*(?:orbitproof|from|import|make|pip|python|>>>|#|\$)\b|.*(?:\.json|import )")


def is_formula(block: str) -> bool:
    """Whether an indented block of a chapter is a formula: neither commands nor program text."""
    return not any(_CODE.match(line) for line in block.splitlines())


_INDEXED = re.compile(
    rf"(?<![\w`\\/.])(?:[A-Za-z]|{'|'.join(GREEK)})[0-9]?'*"
    r"(?:[_^](?:\([^()`|*]*\)|-?[A-Za-z0-9]+))+'*(?![\w/]|\.\w)"
)
"""A letter with indices or exponents, in running text."""
_VERBATIM = re.compile(r"(`[^`]*`|\]\([^)]*\)|<[^>]*>)")


def with_formulas(text: str) -> str:
    """A Markdown page with its indented formulas, and indexed letters in its text, as mathematics.

    Fenced and other indented blocks, words in backticks and addresses of links stay as they are.
    """
    parts = re.split(r"(?m)(^```[\s\S]*?^```$|^\n(?: {4}\S.*\n(?:\s*\n(?= {4}))?)+)", text)
    return "".join(_block(part) if index % 2 else _running(part) for index, part in enumerate(parts))


def _block(block: str) -> str:
    if block.startswith("```") or not is_formula(block):
        return block
    lines = [to_latex(line) for line in block.strip("\n").splitlines() if line.strip()]
    return "\n" + "".join(f"```{{math}}\n{line}\n```\n" for line in lines)


def _running(text: str) -> str:
    pieces = _VERBATIM.split(text)
    return "".join(
        piece if index % 2 else _INDEXED.sub(lambda found: f"{{math}}`{to_latex(found[0]).strip()}`", piece)
        for index, piece in enumerate(pieces)
    )
