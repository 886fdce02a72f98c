"""Formulas of the chapters, which are written in plain text, as LaTeX: sign for sign, nothing rearranged."""

from __future__ import annotations

import re

_GREEK = ("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi",
          "pi", "rho", "sigma", "tau", "phi", "psi", "omega")  # fmt: skip
_WORDS = {"integral": r"\int", "int": r"\int", "sum": r"\sum", "in": r"\in", "det": r"\det", "cos": r"\cos",
          "sin": r"\sin", "exp": r"\exp", "log": r"\log", "max": r"\max", "min": r"\min"}  # fmt: skip
_SIGNS = {"<=>": r"\Leftrightarrow", "=>": r"\Rightarrow", "<=": r"\le", ">=": r"\ge", "!=": r"\ne", "->": r"\to",
          "+-": r"\pm", "..": r"\dots", "...": r"\dots", "{": r"\{", "}": r"\}", "*": r"\cdot", "²": "^{2}",
          "³": "^{3}", "#": r"\#", "%": r"\%", "&": r"\&", "~": r"\sim"}  # fmt: skip
_TOKEN = re.compile(
    r"(?P<gap>\s{2,})|(?P<space>\s)|(?P<number>[0-9]+(?:\.[0-9]+)?)|(?P<word>[^\W\d_]+[0-9]*)"
    r"|(?P<prime>'+)|(?P<raise>[_^])|(?P<sign><=>|=>|<=|>=|!=|->|\+-|\.\.\.|\.\.|.)"
)
_CODE = re.compile(r"\s*(?:orbitproof|from|import|make|pip|python|>>>|#|\$)\b|.*(?:\.json|import )")


def is_formula(block: str) -> bool:
    """Whether an indented block of a chapter is a formula: neither commands nor program text."""
    return not any(_CODE.match(line) for line in block.splitlines())


def to_latex(line: str) -> str:
    """One line of a formula. Raises `ValueError` where brackets of an index or exponent do not match."""
    tokens = list(_TOKEN.finditer(line.strip()))
    text, position = _translate(tokens, 0, False)
    if position != len(tokens):
        raise ValueError(f"brackets do not match: {line.strip()!r}")
    return text


def _translate(tokens: list[re.Match[str]], position: int, inside: bool) -> tuple[str, int]:
    """LaTeX of the tokens from a position on; `inside` the brackets of an index, up to the one that closes them."""
    parts: list[str] = []
    depth = 0
    while position < len(tokens):
        token = tokens[position]
        position += 1
        kind, text = token.lastgroup, token[0]
        if kind == "raise":
            group, position = _argument(tokens, position)
            parts.append(f"{text}{{{group}}}")
            continue
        if inside and text in "()":
            depth += 1 if text == "(" else -1
            if depth < 0:
                return "".join(parts), position
        parts.append(_plain(kind, text))
    if inside:
        raise ValueError("a bracket of an index is not closed")
    return "".join(parts), position


def _argument(tokens: list[re.Match[str]], position: int) -> tuple[str, int]:
    """What follows _ or ^: a group in brackets, or one number or word with its sign."""
    if position == len(tokens):
        raise ValueError("an index is missing")
    text = tokens[position][0]
    if text == "(":
        return _translate(tokens, position + 1, True)
    if text in "+-" and position + 1 < len(tokens):
        return text + _plain(tokens[position + 1].lastgroup, tokens[position + 1][0]), position + 2
    return _plain(tokens[position].lastgroup, text), position + 1


def _plain(kind: str | None, text: str) -> str:
    match kind:
        case "gap":
            return r"\quad "
        case "space":
            return " "
        case "number" | "prime":
            return text
        case "word":
            return _word(text)
    return f"{_SIGNS[text]} " if text in _SIGNS else text


def _word(text: str) -> str:
    stem = text.rstrip("0123456789")
    index = text[len(stem) :]
    if stem in _WORDS:
        return f"{_WORDS[stem]} "
    if stem.lower() in _GREEK:
        name = f"\\{stem} "
    elif len(stem) == 1:
        name = stem
    elif stem in ("vx", "vy", "vz"):
        name = f"v_{{{stem[1]}}}"
    else:
        name = rf"\text{{ {stem} }}"
    return f"{name}_{{{index}}}" if index else name


_INDEXED = re.compile(
    rf"(?<![\w`\\/.])(?:[A-Za-z]|{'|'.join(_GREEK)})[0-9]?'*"
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
