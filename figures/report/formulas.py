"""Formulas in plain text, as certificates and chapters write them, as LaTeX: sign for sign, nothing rearranged."""

from __future__ import annotations

import re
from collections.abc import Callable

from orbitproof.figures.report.document import Math, Run, Runs

GREEK = ("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi",
          "pi", "rho", "sigma", "tau", "phi", "psi", "omega")  # fmt: skip
_WORDS = {"integral": r"\int", "int": r"\int", "sum": r"\sum", "in": r"\in", "det": r"\det", "cos": r"\cos",
          "sin": r"\sin", "exp": r"\exp", "log": r"\log", "max": r"\max", "min": r"\min"}  # fmt: skip
_SIGNS = {"<=>": r"\Leftrightarrow", "=>": r"\Rightarrow", "<=": r"\le", ">=": r"\ge", "!=": r"\ne", "->": r"\to",
          "+-": r"\pm", "..": r"\dots", "...": r"\dots", "{": r"\{", "}": r"\}", "*": r"\,", "²": "^{2}",
          "³": "^{3}", "#": r"\#", "%": r"\%", "&": r"\&", "~": r"\sim"}  # fmt: skip
_TOKEN = re.compile(
    r"(?P<gap>\s{2,})|(?P<space>\s)|(?P<number>[0-9]+(?:\.[0-9]+)?)"
    # A name that has no form as a letter with one index.
    r"|(?P<name>\b(?:_\w*|(?:v[^\W\d_]+|[^\W\d_]+[0-9]+)_\w*|[^\W\d_]+(?:_[^\W_]*){2,}|[^\W\d_]+_(?![\w(+-])))"
    r"|(?P<word>[^\W\d_]+[0-9]*)"
    r"|(?P<prime>'+)|(?P<raise>[_^])|(?P<sign><=>|=>|<=|>=|!=|->|\+-|\.\.\.|\.\.|.)"
)


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
        case "name":
            escaped = text.replace("_", r"\_")
            return rf"\text{{ {escaped} }}"
    return f"{_SIGNS[text]} " if text in _SIGNS else text


def _word(text: str) -> str:
    stem = text.rstrip("0123456789")
    index = text[len(stem) :]
    if stem in _WORDS:
        return f"{_WORDS[stem]} "
    if stem.lower() in GREEK:
        name = f"\\{stem} "
    elif len(stem) == 1:
        name = stem
    elif stem == "eps":
        name = r"\varepsilon "
    elif stem[0] == "v" and (len(stem) == 2 or stem[1:] in GREEK):
        return f"v_{{{_word(text[1:]).strip()}}}"
    else:
        name = rf"\text{{ {stem} }}"
    return f"{name}_{{{index}}}" if index else name


_IN_WORDS: tuple[tuple[str, Callable[[re.Match[str]], str]], ...] = (
    (r"P\^\((\w+)\)\(([xX])\) = \2", lambda m: rf"P^{{{m[1]}}}({m[2]}) = {m[2]}"),
    (r"P\^(\d+)\(([xX])\) = \2", lambda m: rf"P^{{{m[1]}}}({m[2]}) = {m[2]}"),
    (r"P\^(\d+)\b", lambda m: rf"P^{{{m[1]}}}"),
    (r"Fix\((\w)\)", lambda m: rf"\mathrm{{Fix}}({m[1]})"),
    (r"\{(\w+) = 0\}", lambda m: rf"\{{{to_latex(m[1])} = 0\}}"),
    (r"\|(\w+)\| <= ([\w.-]*\w)(?: mu\^\(1/3\))?",
     lambda m: rf"|{to_latex(m[1])}| \le {to_latex(m[2])}" + (r"\, \mu^{1/3}" if "mu^" in m[0] else "")),
)  # fmt: skip


def typeset(text: str) -> Runs:
    """The words of a statement, with the formulas in them that have a form known here; the others stay as written."""
    runs: list[Run] = [text]
    for pattern, latex in _IN_WORDS:
        runs = [piece for run in runs for piece in _split(run, re.compile(pattern), latex)]
    return tuple(runs)


def _split(run: Run, pattern: re.Pattern[str], latex: Callable[[re.Match[str]], str]) -> list[Run]:
    if not isinstance(run, str):
        return [run]
    pieces: list[Run] = []
    end = 0
    for found in pattern.finditer(run):
        pieces += [run[end : found.start()], Math(latex(found))]
        end = found.end()
    return [piece for piece in (*pieces, run[end:]) if piece != ""]
