"""Formulas as text: read as data, never run.

A formula is built of names, exact numbers, ``+ - * /``, powers with a constant exponent, ``sqrt`` and brackets.
Python's own parser reads it into a tree, and of that tree only these parts are accepted. Numbers are exact: ``0.1``
is one tenth, and ``1/3`` a third. A quotient by a power becomes a product with a power: one form for one function, so
that what is the same in two formulas is seen to be the same.
"""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.program import LARGEST_EXPONENT

LONGEST = 20_000
"""Characters of a formula."""
TIME = "t"
"""The name of the time, where it is no name of a description's own (`forcing`)."""

_MOST_BITS = 20_000
_NUMBER = re.compile(r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,4})?", re.ASCII)
_ALLOWED = "write it with names, numbers, + - * / **, sqrt(..) and brackets"

_HYPERBOLA = (
    "write it with exp(u), where R and S leave u alone; or, where a coordinate u stands in exponentials alone, "
    "t = tanh(u/2) in its place, which has t' = (1 - t**2)*u'/2, exp(u) = (1 + t)/(1 - t)"
)
_IN_PLACE = {"tan": "write sin(u)/cos(u)"} | dict.fromkeys(("sinh", "cosh", "tanh"), _HYPERBOLA)
"""What to write for functions that formulas do not have."""

_OPERATIONS: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def remedy_for(name: str, known: str) -> str:
    """What to write in place of a name that formulas do not know."""
    if name in ("t", "time"):
        return (
            "a periodic force is F*cos(r*t) in a file without R, else two coordinates u and w of its own, "
            "u' = r*w and w' = -r*u (docs/how-to/forced-systems.md)"
        )
    if name == "pi":
        return (
            "make pi, or what it is multiplied by, a parameter with as many digits as are wanted: no number here is pi"
        )
    return f"known: {known}"


class FormulaError(ValueError):
    """What is wrong with a formula, in one line with the remedy."""


def evaluate_formula(text: str, values: Mapping[str, Any]) -> Any:
    """The value of a formula for given values of its names; a `Fraction` if it has none of them.

    Raises `FormulaError` for a text that is no formula or has other names.
    """
    if len(text) > LONGEST:
        raise FormulaError(f"it has more than {LONGEST} characters; define parts of it under where")
    source = " ".join(text.split())
    if "#" in source:
        # Python would leave out all that follows it, also of further lines.
        raise FormulaError(f"{_quoted(source)} has a #, and formulas have no comments; {_ALLOWED}")
    try:
        tree = ast.parse(source, mode="eval")
        return _Reader(source, values).value(tree.body)
    except SyntaxError as error:
        raise FormulaError(f"{_quoted(source)} is no formula ({error.msg}); {_ALLOWED}") from None
    except (RecursionError, MemoryError):
        raise FormulaError("it is nested too deeply; define parts of it under where") from None
    except ZeroDivisionError:
        raise FormulaError(f"{_quoted(source)} divides by zero; correct it") from None
    except FormulaError:
        raise
    except ValueError as error:
        raise FormulaError(f"{_quoted(source)} is no formula ({error}); {_ALLOWED}") from None


class _Reader:
    def __init__(self, source: str, values: Mapping[str, Any]) -> None:
        self.source = source
        self.values = values

    def value(self, node: ast.expr) -> Any:
        match node:
            case ast.Name(id=name):
                if name not in self.values:
                    known = ", ".join(self.values) or "none"
                    remedy = remedy_for(name, known)
                    raise FormulaError(f"the name {name!r} in {_quoted(self.source)} is unknown; {remedy}")
                return self.values[name]
            case ast.Constant():
                return self.number(node)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.value(operand)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.value(operand)
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self.power(self.value(left), self.value(right))
            case ast.BinOp(left=left, op=ast.Div(), right=ast.BinOp(left=base, op=ast.Pow(), right=exponent)):
                return _short(self.value(left) * self.power(self.value(base), -self.value(exponent)))
            case ast.BinOp(left=left, op=ast.Div(), right=ast.Call(func=ast.Name(id="sqrt"), args=[base], keywords=[])):
                return _short(self.value(left) * self.power(self.value(base), Fraction(-1, 2)))
            case ast.BinOp(left=left, op=sign, right=right) if type(sign) in _OPERATIONS:
                return _short(_OPERATIONS[type(sign)](self.value(left), self.value(right)))
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument], keywords=[]):
                return self.power(self.value(argument), Fraction(1, 2))
        part = ast.get_source_segment(self.source, node) or self.source
        raise FormulaError(f"{_quoted(part)} is not allowed in a formula; {_remedy(node)}")

    def number(self, node: ast.Constant) -> Fraction:
        """The number as it is written: what Python makes of 0.1 is another one."""
        text = ast.get_source_segment(self.source, node) or ""
        if _NUMBER.fullmatch(text) is None:
            raise FormulaError(f"{_quoted(text)} is no number; write a whole number or a decimal one")
        value: Fraction = _short(Fraction(text))
        return value

    def power(self, base: Any, exponent: Any) -> Any:
        """The power; a number to a fractional power is no exact number and refused."""
        if not isinstance(exponent, Fraction):
            raise FormulaError(f"an exponent in {_quoted(self.source)} is no constant; write a number in its place")
        if max(abs(exponent.numerator), exponent.denominator) > LARGEST_EXPONENT:
            raise FormulaError(f"the exponent {exponent} in {_quoted(self.source)} is too large; write it as products")
        if not isinstance(base, Fraction):
            return base**exponent
        if exponent.denominator > 1:
            raise FormulaError(f"a root of a number in {_quoted(self.source)} is not exact; make it a parameter")
        if abs(exponent) * max(base.numerator.bit_length(), base.denominator.bit_length()) > _MOST_BITS:
            raise FormulaError(f"a number in {_quoted(self.source)} is too long; give fewer digits")
        return base ** int(exponent)


def _remedy(node: ast.expr) -> str:
    """What to write in place of a part that is not allowed."""
    match node:
        case ast.BinOp(op=ast.BitXor()):
            return "a power is written **, as in x**2"
        case ast.Call(func=ast.Name(id=name)) if name in _IN_PLACE:
            return _IN_PLACE[name]
    return _ALLOWED


def _short(value: Any) -> Any:
    """The value, unless it is a number that is too long."""
    if isinstance(value, Fraction) and max(value.numerator.bit_length(), value.denominator.bit_length()) > _MOST_BITS:
        raise FormulaError("a number is too long; give fewer digits")
    return value


def _quoted(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")


def has_time(text: Any) -> bool:
    """Whether a formula names the time."""
    return any(isinstance(node, ast.Name) and node.id == TIME for node in nodes_of(text))


def nodes_of(text: Any) -> Iterator[ast.AST]:
    """The syntax nodes of a formula; none of what is no formula, or a program as text."""
    if not isinstance(text, str) or not text.isascii() or len(text) > LONGEST or "#" in text:
        return
    try:
        yield from ast.walk(ast.parse(" ".join(text.split()), mode="eval"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
