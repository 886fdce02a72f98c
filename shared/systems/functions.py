"""sin, cos, exp and log in formulas: each becomes a state coordinate of its own, with a rate in plain arithmetic.

A power whose exponent is no constant is x**n = exp(n*log(x)), for positive x.

For a coordinate w that is a function of others, w' follows from the chain rule, and it is a polynomial in these
coordinates: (sin e)' = cos(e) e', (cos e)' = -sin(e) e', (exp e)' = exp(e) e', (log e)' = e'/e. The states that are
meant are those with w = function(argument); they are an invariant set of the system with the further coordinates.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, count
from typing import Any

from orbitproof.shared.systems.formulas import LONGEST, FormulaError, evaluate_formula

FUNCTIONS = ("sin", "cos", "exp", "log")
_PARTNERS = {"sin": "cos", "cos": "sin"}
_MOST = 20


@dataclass(frozen=True)
class Call:
    """A further coordinate, function(argument), the argument a formula of those before it."""

    name: str
    function: str
    argument: str


class FunctionsOf:
    """The functions that stand in formulas, as further coordinates.

    Attributes:
        calls: in an order in which arguments have earlier ones only.

    Args:
        taken: names that coordinates cannot have.
        where: formulas under names; those without names are constants in exponents.
    """

    def __init__(self, taken: Sequence[str], where: Mapping[str, Any]) -> None:
        self.taken = set(taken)
        self._constants: set[str] = set()
        for name, text in where.items():
            if isinstance(text, str) and self._is_constant(_parsed(text)):
                self._constants.add(name)
        self.calls: list[Call] = []

    def without(self, text: str) -> str:
        """The formula with further coordinates in place of its functions; one that cannot be read stays as it is."""
        text = " ".join(text.split())
        while len(text) <= LONGEST and (power := self._power(text)) is not None:
            base, exponent = (ast.get_source_segment(text, part) for part in (power.left, power.right))
            text = f"{text[: power.col_offset]}exp(({exponent})*log({base})){text[power.end_col_offset :]}"
        while len(text) <= LONGEST and (found := _innermost(text)) is not None:
            call = self._call(found.func.id, ast.get_source_segment(text, found.args[0]) or "")
            text = f"{text[: found.col_offset]}{call.name}{text[found.end_col_offset :]}"
        return text

    def _power(self, text: str) -> Any:
        """A power whose exponent is no constant, without another one in it, or `None`."""
        powers = [
            node for node in ast.walk(_parsed(text)) if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow)
        ]
        found = [node for node in powers if not self._is_constant(node.right)]
        return min(found, key=lambda node: (node.end_col_offset or 0) - node.col_offset, default=None)

    def _is_constant(self, node: ast.AST) -> bool:
        """Whether a formula has no names but those of constants."""
        return all(each.id in self._constants for each in ast.walk(node) if isinstance(each, ast.Name))

    def _call(self, function: str, argument: str) -> Call:
        for known in self.calls:
            if (known.function, known.argument) == (function, argument):
                return known
        wanted = [each for each in (function, _PARTNERS.get(function)) if each]
        if len(self.calls) + len(wanted) > _MOST:
            raise FormulaError(f"there are more than {_MOST} different functions; write the system with fewer")
        made = [Call(self._name(each, argument), each, argument) for each in wanted]
        self.calls += made
        return made[0]

    def _name(self, function: str, argument: str) -> str:
        plain = f"{function}_{argument}"
        tries = chain([plain] if plain.isidentifier() else [], (f"{function}_{number}" for number in count(1)))
        name = next(each for each in tries if each not in self.taken)
        self.taken.add(name)
        return name


def _innermost(text: str) -> Any:
    """A call of a function without another one in its argument, or `None`."""
    calls: list[Any] = [node for node in ast.walk(_parsed(text)) if _is_call(node)]
    return next((call for call in calls if not any(map(_is_call, ast.walk(call.args[0])))), None)


def _parsed(text: str) -> ast.AST:
    """The tree of a formula; an empty one for a text that is none."""
    if text.isascii():
        with suppress(SyntaxError, ValueError, RecursionError, MemoryError):
            return ast.parse(text, mode="eval")
    return ast.Module([], [])


def _is_call(node: Any) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in FUNCTIONS
        and len(node.args) == 1
        and not node.keywords
        and not isinstance(node.args[0], ast.Starred)
    )


def rates_of(
    calls: Sequence[Call], where: Mapping[str, str], values: Mapping[str, Any], rates: Mapping[str, Any]
) -> list[Any]:
    """The rates of the further coordinates.

    Args:
        where: formulas under names that arguments use.
        values: of state coordinates, the further ones included, and parameters.
        rates: of the state coordinates without the further ones.
    """
    known: dict[str, Any] = {name: WithRate(value, rates.get(name, Fraction(0))) for name, value in values.items()}
    further = {call.name for call in calls}
    result = []
    for call in calls:
        names = {name: value for name, value in known.items() if name not in further}
        argument = _with_rate(argument_of(call, where, names))
        value = values[call.name]
        match call.function:
            case "sin":
                rate = _times(argument.rate, _partner(calls, call, values))
            case "cos":
                rate = _times(argument.rate, -_partner(calls, call, values))
            case "exp":
                rate = _times(argument.rate, value)
            case _:
                rate = _over(argument.rate, argument.value)
        known[call.name] = WithRate(value, rate)
        further.discard(call.name)
        result.append(rate)
    return result


def argument_of(call: Call, where: Mapping[str, str], values: Mapping[str, Any]) -> Any:
    """The argument of a further coordinate. Raises `FormulaError`."""
    known = dict(values)
    for name, text in where.items():
        try:
            known[name] = evaluate_formula(text, known)
        except FormulaError:
            # It has coordinates that come later, and so the argument does not use it.
            continue
    return evaluate_formula(call.argument, known)


def _partner(calls: Sequence[Call], call: Call, values: Mapping[str, Any]) -> Any:
    wanted = _PARTNERS[call.function]
    return next(values[each.name] for each in calls if (each.function, each.argument) == (wanted, call.argument))


@dataclass(frozen=True)
class WithRate:
    """A number and its derivative by time, with the arithmetic of formulas; what does not move has the exact rate 0.

    Terms with that rate are left out: 0 plus something odd is not seen to be odd.
    """

    value: Any
    rate: Any

    def __add__(self, other: Any) -> WithRate:
        right = _with_rate(other)
        return WithRate(self.value + right.value, _plus(self.rate, right.rate))

    __radd__ = __add__

    def __sub__(self, other: Any) -> WithRate:
        right = _with_rate(other)
        return WithRate(self.value - right.value, _plus(self.rate, -right.rate))

    def __rsub__(self, other: Any) -> WithRate:
        return _with_rate(other) - self

    def __mul__(self, other: Any) -> WithRate:
        right = _with_rate(other)
        rate = _plus(_times(self.rate, right.value), _times(right.rate, self.value))
        return WithRate(self.value * right.value, rate)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> WithRate:
        right = _with_rate(other)
        value = self.value / right.value
        return WithRate(value, _over(_plus(self.rate, _times(-right.rate, value)), right.value))

    def __rtruediv__(self, other: Any) -> WithRate:
        return _with_rate(other) / self

    def __neg__(self) -> WithRate:
        return WithRate(-self.value, -self.rate)

    def __pow__(self, exponent: Fraction) -> WithRate:
        return WithRate(self.value**exponent, _times(self.rate, exponent * self.value ** (exponent - 1)))


def _with_rate(value: Any) -> WithRate:
    return value if isinstance(value, WithRate) else WithRate(value, Fraction(0))


def _is_still(rate: Any) -> bool:
    return isinstance(rate, Fraction) and not rate


def _plus(rate: Any, other: Any) -> Any:
    return other if _is_still(rate) else rate if _is_still(other) else rate + other


def _times(rate: Any, value: Any) -> Any:
    return rate if _is_still(rate) else value * rate


def _over(rate: Any, value: Any) -> Any:
    return rate if _is_still(rate) else rate / value
