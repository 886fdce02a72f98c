"""Formulas in plain text, as certificates and chapters write them, as LaTeX, sign for sign, and LaTeX as MathML."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from latex2mathml.converter import convert

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


_MATHML = "http://www.w3.org/1998/Math/MathML"
_PRIMES = re.compile("[\u2032-\u2034\u2057]+")
ElementTree.register_namespace("", _MATHML)


def to_mathml(latex: str, display: str = "inline") -> str:
    """MathML of a formula. Primes stand beside their letter: fonts raise them already, and raised twice they vanish."""
    formula = ElementTree.fromstring(convert(latex, display=display))
    for part in formula.iter():
        name = part.tag.rpartition("}")[2]
        if name not in ("msup", "msubsup") or not _PRIMES.fullmatch(part[-1].text or ""):
            continue
        *base, prime = part
        prime.tag = f"{{{_MATHML}}}mo"
        prime.attrib |= {"form": "postfix", "lspace": "0", "rspace": "0"}
        if name == "msubsup":
            letter = ElementTree.Element(f"{{{_MATHML}}}msub")
            letter.extend(base)
            base = [letter]
        part.tag = f"{{{_MATHML}}}mrow"
        part[:] = [*base, prime]
    return ElementTree.tostring(formula, encoding="unicode")


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


_SINGLE = frozenset("BCDEFGHJKLMNPQRSTUVWXYZbcdefghjklmnopqrstuvwxyz")
"""Letters that are names where they stand alone; a, A and I are words."""
_PIECES = re.compile(r"[^\W\d]\w*|[0-9]+[ijkmn]\b|[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?(?!\w)|<=|>=|->|\.\.|\s|.")
_OPERATORS = ("+", "-", "*", "/", "=", "<", ">", "<=", ">=", "->")
_CLOSING = {"(": ")]", "[": ")]", "{": "}"}
_LONGEST_NUMBER, _LONGEST_NUMBERS = 9, 26
"""Numbers and enclosures with many digits stay words: they are to be copied."""
_LONGEST = 60
"""Letters of a formula that is kept in one piece: one in a line of text is not broken."""


def typeset(text: str) -> Runs:
    """The words of a statement, with the formulas in them; a tuple that is long is one formula for each entry."""
    pieces = [found[0] for found in _PIECES.finditer(text)]
    runs: list[Run] = []
    position = 0
    while position < len(pieces):
        end = _formula(pieces, position) if _is_apart(pieces, position) else position
        if end > position and _is_whole(pieces, position, end):
            runs += _set(pieces[position:end])
            position = end
        else:
            runs.append(pieces[position])
            position += 1
    return _joined(runs)


def _joined(runs: list[Run]) -> Runs:
    """Texts that follow each other as one."""
    found: list[Run] = []
    for run in runs:
        if isinstance(run, str) and found and isinstance(found[-1], str):
            found[-1] += run
        else:
            found.append(run)
    return tuple(found)


def _set(pieces: list[str]) -> list[Run]:
    text = "".join(pieces)
    if len(text) <= _LONGEST or pieces[0] not in "([" or _group(pieces, 0) != len(pieces):
        return [Math(_fixed(to_latex(text)))]
    runs: list[Run] = [pieces[0]]
    entry: list[str] = []
    depth = 0
    for piece in pieces[1:-1]:
        depth += (piece in "([{") - (piece in ")]}")
        if piece == "," and not depth:
            runs += [*_set(entry), ","]
            entry = []
        elif piece == " " and not entry:
            runs.append(" ")
        else:
            entry.append(piece)
    return [*runs, *_set(entry), pieces[-1]]


def _fixed(latex: str) -> str:
    powers = re.sub(
        r"(?<=[0-9])e([+-]?)0*([0-9]+)", lambda found: rf" \cdot 10^{{{found[1].strip('+')}{found[2]}}}", latex
    )
    return powers.replace(r"\text{ Fix }", r"\mathrm{Fix}").strip()


def _is_apart(pieces: list[str], position: int) -> bool:
    """Whether a formula may begin here: not within a word with hyphens, a number with a colon, or a file's name."""
    before = pieces[position - 1] if position else " "
    return before in (" ", "(", "[", "|")


def _is_whole(pieces: list[str], start: int, end: int) -> bool:
    """Whether what was found is a formula, and not the beginning of a word; a number alone stays a number."""
    if end - start - 2 * (pieces[start] == "(") == 1 and pieces[end - 1 - (pieces[start] == "(")][0].isdigit():
        return False
    if pieces[start] == "-" and end - start == 2 and len(pieces[end - 1]) > _LONGEST_NUMBER:
        return False
    after, more = (pieces[end : end + 2] + [" ", " "])[:2]
    if after == "-":
        return pieces[start] in ("R", "S") and (more.isalpha() or more == " ")
    return not (after[0].isalnum() or after in "_'^/" or (after in ".:" and more.strip() and more[0].isalnum()))


def _is_name(piece: str) -> bool:
    stem = piece.split("_")[0]
    return (
        piece.rstrip("0123456789") == "eps"
        or stem in _SINGLE
        or stem in GREEK
        or (stem[:1] == "v" and (stem[1:] in _SINGLE or stem[1:] in GREEK))
    )


def _formula(pieces: list[str], position: int) -> int:
    """Where the formula that begins here ends; the position itself if none does."""
    end = _term(pieces, position)
    while end > position:
        following = end + 1 if pieces[end : end + 1] == [" "] else end
        operator = pieces[following : following + 1]
        if operator == ["in"] or (operator and operator[0] in _OPERATORS):
            # Spaces on both sides, or on neither.
            right = following + 1 + (following > end)
            if following > end and pieces[following + 1 : right] != [" "]:
                return end
            further = _term(pieces, right)
            if operator == ["in"] and pieces[right : right + 1] not in (["("], ["["], ["Fix"]):
                return end
        elif following > end and pieces[following : following + 1] and _juxtaposed(pieces, end, following):
            right, further = following, _term(pieces, following)
        else:
            return end
        if further <= right:
            return end
        end = further
    return end


def _juxtaposed(pieces: list[str], end: int, following: int) -> bool:
    """Whether a product is written without a sign: a number or letter before a Greek letter, eps before a name."""
    before, name = pieces[end - 1], pieces[following]
    stem = name.removeprefix("v")
    if before.rstrip("0123456789") == "eps":
        return _is_name(name)
    return stem in GREEK and (before[0].isdigit() or before in _SINGLE)


def _term(pieces: list[str], position: int) -> int:
    """Where a name, a number or a group, with what is attached to it, ends."""
    if position >= len(pieces):
        return position
    piece, end = pieces[position], position + 1
    if piece == "-":
        end = _term(pieces, end)
        return position if end == position + 1 else end
    if piece in _CLOSING:
        end = _group(pieces, position)
        if end == position:
            return position
    elif piece == "|":
        inner = _formula(pieces, position + 1)
        if inner == position + 1 or pieces[inner : inner + 1] != ["|"]:
            return position
        end = inner + 1
    elif piece == "Fix":
        further = _group(pieces, end) if pieces[end : end + 1] == ["("] else end
        return position if further == end else further
    elif not (_is_name(piece) or piece[0].isdigit()):
        return position
    if pieces[end : end + 1] == ["'"] and not "".join(pieces[end + 1 : end + 2]).isalnum():
        end += 1
    while pieces[end : end + 1] in (["^"], ["("]):
        start = end + 1 if pieces[end] == "^" else end
        further = _group(pieces, start) if pieces[start : start + 1] == ["("] else start + 1
        if further == start or (pieces[end] == "(" and not _is_name(piece) and pieces[end - 1] != ")"):
            return end
        end = further
    return end


def _group(pieces: list[str], position: int) -> int:
    """Where formulas in brackets, with commas between them, end."""
    closing, end = _CLOSING[pieces[position]], position + 1
    while True:
        further = _formula(pieces, end)
        if further == end or further >= len(pieces):
            return position
        if pieces[further] in closing:
            text = "".join(pieces[position : further + 1])
            return position if len(text) > _LONGEST_NUMBERS and not re.search("[a-z]", text) else further + 1
        if pieces[further : further + 2] != [",", " "]:
            return position
        end = further + 2
