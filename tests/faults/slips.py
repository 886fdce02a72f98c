"""Faults made by rule: each slip changes one expression or statement of a trusted module in one of a dozen ways.

The table holds by hand what changes an idea. A slip breaks what the function around it says, so it is named by that
function, the first sentence of its documentation, and the sections that it or its module names.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

Rule = Iterator[tuple[str, str]]
"""What a rule does, in words, and the new text of the node that it is given."""

_OTHER: Mapping[type[ast.AST], tuple[str, ...]] = {
    ast.Add: ("-",), ast.Sub: ("+",), ast.Mult: ("/",), ast.Div: ("*",), ast.FloorDiv: ("/",), ast.Mod: ("//",),
    ast.LShift: (">>",), ast.RShift: ("<<",), ast.Pow: ("*",), ast.BitOr: ("&",), ast.BitAnd: ("|",),
    ast.Lt: ("<=", ">"), ast.LtE: ("<", ">="), ast.Gt: (">=", "<"), ast.GtE: (">", "<="),
    ast.Eq: ("!=",), ast.NotEq: ("==",), ast.In: ("not in",), ast.NotIn: ("in",),
    ast.Is: ("is not",), ast.IsNot: ("is",),
}  # fmt: skip
_OPPOSITES = (
    "any all", "min max", "upper lower", "upper_end lower_end", "begin end", "start end", "first last", "left right",
    "enters leaves", "above below", "is_above is_below", "before after", "hull intersection", "old new", "stored fresh",
)  # fmt: skip
_OPPOSITE = {a: b for pair in _OPPOSITES for a, b in (pair.split(), reversed(pair.split()))}


@dataclass(frozen=True)
class Slip:
    """One change of a module.

    Attributes:
        file: the module, from the root of the checkout.
        line: of the change.
        function: around it, with its class; empty outside of all.
        says: the first sentence that documents the function, or else the module.
        sections: that the function, or else the module, names.
        rule: what is done, in words.
        begin, end: characters of the module that are replaced.
        new: by what.
    """

    file: str
    line: int
    function: str
    says: str
    sections: tuple[str, ...]
    rule: str
    begin: int
    end: int
    new: str

    def applied(self, text: str) -> str:
        """The module with the slip."""
        return text[: self.begin] + self.new + text[self.end :]


def slips(root: Path, file: str) -> list[Slip]:
    """All slips of a module, in the order of its lines; some leave it as it is, or no Python (`changes`)."""
    text = (root / file).read_text(encoding="utf-8")
    found = {(slip.begin, slip.end, slip.new): slip for slip in _Finder(file, text, ast.parse(text)).found()}
    return [found[place] for place in sorted(found)]


def changes(slip: Slip, text: str) -> bool:
    """Whether a module with a slip is Python, and another program than without."""
    try:
        return ast.dump(ast.parse(slip.applied(text))) != ast.dump(ast.parse(text))
    except SyntaxError:
        return False


class _Finder:
    """Walks over the statements of one module."""

    def __init__(self, file: str, text: str, tree: ast.Module) -> None:
        self.file, self.text, self.tree = file, text, tree
        lines = text.splitlines(keepends=True)
        self._lines = [line.encode() for line in lines]
        self._starts = [0]
        for line in lines:
            self._starts.append(self._starts[-1] + len(line))

    def found(self) -> Iterator[Slip]:
        yield from self._under(self.tree, "", ast.get_docstring(self.tree) or "", ast.get_docstring(self.tree) or "")

    def _under(self, node: ast.AST, function: str, says: str, module: str) -> Iterator[Slip]:
        for inner in ast.iter_child_nodes(node):
            if isinstance(inner, (ast.FunctionDef, ast.ClassDef)):
                name, own = f"{function}.{inner.name}".lstrip("."), ast.get_docstring(inner)
                yield from self._under(inner, name, own or says, module)
            elif not _is_left_alone(inner, node):
                for rule, new in self._changes(inner, node):
                    begin, end = self._span(inner)
                    sections = _sections(says) or _sections(module)
                    first = says.partition("\n\n")[0].replace("\n", " ")
                    yield Slip(self.file, inner.lineno, function, first, sections, rule, begin, end, new)
                yield from self._under(inner, function, says, module)

    def _span(self, node: ast.AST) -> tuple[int, int]:
        begin = self._starts[node.lineno - 1] + len(self._lines[node.lineno - 1][: node.col_offset].decode())
        last = node.end_lineno - 1
        return begin, self._starts[last] + len(self._lines[last][: node.end_col_offset].decode())

    def _said(self, node: ast.AST) -> str:
        begin, end = self._span(node)
        text = self.text[begin:end]
        plain = isinstance(
            node, (ast.Starred, ast.Name, ast.Constant, ast.Call, ast.Attribute, ast.Subscript, ast.List, ast.Dict)
        )
        return text if plain else f"({text})"

    def _changes(self, node: ast.AST, above: ast.AST) -> Rule:
        """What the rules make of a node."""
        said = self._said
        is_test = isinstance(above, (ast.If, ast.While)) and above.test is node
        if is_test or _is_condition(node) or _is_required(node, above):
            yield from (("a condition is taken to hold", "True"), ("a condition is taken to fail", "False"))
        if isinstance(above, (ast.For, ast.comprehension)) and above.iter is node:
            for which, part in (
                ("nothing", "0"),
                ("not the first", "1:"),
                ("not the last", ":-1"),
                ("backwards", "::-1"),
            ):
                begin, end = self._span(node)
                yield f"what is gone through: {which}", f"list({self.text[begin:end]})[{part}]" if part != "0" else "()"
        match node:
            case ast.BinOp(left, op, right):
                yield from (("an operand is left out", said(each)) for each in (left, right))
                yield from (
                    ("another operator", f"{said(left)} {each} {said(right)}") for each in _OTHER.get(type(op), ())
                )
            case ast.Compare(left, [op], [right]):
                yield from (("another comparison", f"{said(left)} {each} {said(right)}") for each in _OTHER[type(op)])
            case ast.BoolOp(op, values):
                word, other = (" and ", " or ") if isinstance(op, ast.And) else (" or ", " and ")
                yield from (
                    ("one of several conditions is left out", word.join(each)) for each in _without_one(said, values)
                )
                yield "and for or", other.join(map(said, values))
            case ast.IfExp(_, body, other):
                yield from (("one of two cases", said(each)) for each in (body, other))
            case ast.UnaryOp(_, operand):
                yield "a sign is left out", said(operand)
            case ast.Constant(bool(value)):
                yield "the other truth", str(not value)
            case ast.Constant(int(value) | float(value)):
                yield from (
                    ("another number", str(each)) for each in (value + 1, value - 1, 2 * value, 0 * value) if each >= 0
                )
            case ast.Call(_, arguments, keywords) if arguments or keywords:
                begin, end = self._span(node)
                if arguments and not isinstance(arguments[0], ast.Starred):
                    yield "a function is not applied", said(arguments[0])
                for one, two in pairwise(arguments):
                    (a, b), (c, d) = self._span(one), self._span(two)
                    swapped = self.text[c:d] + self.text[b:c] + self.text[a:b]
                    yield "two arguments are exchanged", self.text[begin:a] + swapped + self.text[d:end]
                for each in (*arguments, *keywords):
                    a, b = self._span(each)
                    rest = self.text[b:end].lstrip().removeprefix(",")
                    yield "an argument is left out", self.text[begin:a] + rest
            case ast.Name(name) if name in _OPPOSITE:
                yield "the opposite", _OPPOSITE[name]
            case ast.Attribute(value, name) if name in _OPPOSITE:
                yield "the opposite", f"{said(value)}.{_OPPOSITE[name]}"
            case ast.Expr() | ast.AugAssign() | ast.Raise():
                yield "a statement is left out", "pass"
            case ast.Tuple(values) | ast.List(values) if len(values) > 1 and isinstance(node.ctx, ast.Load):
                opens, closes = ("[", "]") if isinstance(node, ast.List) else ("(", ",)")
                for each in _without_one(said, values):
                    yield "an entry is left out", f"{opens}{', '.join(each)}{closes}"


def _without_one(said: Callable[[ast.AST], str], values: Sequence[ast.AST]) -> list[list[str]]:
    return [[said(each) for each in values if each is not left] for left in values]


def _is_required(node: ast.AST, above: ast.AST) -> bool:
    """Whether a node says whether a hypothesis holds."""
    if isinstance(above, ast.Call) and isinstance(above.func, ast.Attribute):
        return above.func.attr == "require" and node is above.args[0]
    return isinstance(above, ast.keyword) and above.arg == "holds"


def _is_condition(node: ast.AST) -> bool:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return node.func.id in ("any", "all") or node.func.id.startswith(("is_", "excludes", "has_"))
    return isinstance(node, (ast.Compare, ast.BoolOp)) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    )


def _is_left_alone(node: ast.AST, above: ast.AST) -> bool:
    """Documentation, annotations, imports, words of messages."""
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.JoinedStr, ast.arguments, ast.Assert)):
        return True
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True
    annotation = getattr(above, "annotation", None) is node or getattr(above, "returns", None) is node
    return annotation or not (hasattr(node, "lineno") or isinstance(node, (ast.comprehension, ast.keyword)))


def _sections(text: str) -> tuple[str, ...]:
    """The sections, theorems and formulas of chapters that a text names."""
    return tuple(dict.fromkeys(re.findall(r"\d+\.\d+", text)))
