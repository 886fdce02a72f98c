"""The time in formulas, as sin and cos of multiples of it: a periodic force, as two further coordinates (section 1.1).

The pair (u, v) turns on the circle u^2 + v^2 = 1, which attracts it: u' = -r v + r g u, v' = r u + r g v with
g = (1 - u^2 - v^2)/4. As (u^2 + v^2)' = 2 r g (u^2 + v^2), a periodic orbit with (u, v) not 0 has u^2 + v^2 = 1
throughout, so that u = cos(r t + c) and v = sin(r t + c). So the periodic orbits of the system with u and v, other than
those with u = v = 0, are those of the forced one, and their periods are multiples of 2 pi/|r|.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import Any

from orbitproof.shared.systems.formulas import TIME, FormulaError, evaluate_formula, nodes_of

FORCE = ("force_cos", "force_sin")
"""The cosine and the sine of the force's phase, as coordinates. At the start it is 0."""
FORCE_AT_START = dict(zip(FORCE, ("1", "0"), strict=True))

_MOST_HARMONICS = 16
_MULTIPLES = "the time t stands only in sin(..) and cos(..) of r*t + c, where r is made of parameters and numbers"
_REMEDY = f"{_MULTIPLES} (docs/how-to/forced-systems.md)"


@dataclass(frozen=True)
class Forced:
    """A description's formulas without the time.

    Attributes:
        state: with the coordinates of the force, if there is one.
        field, where, texts: formulas by name; further ones of the description in `texts`.
    """

    state: tuple[str, ...]
    field: Mapping[str, Any]
    where: Mapping[str, Any]
    texts: Mapping[str, Any]


def without_time(
    state: tuple[str, ...],
    parameters: Sequence[str],
    field: Mapping[str, Any],
    where: Mapping[str, Any],
    texts: Mapping[str, Any],
) -> Forced:
    """The formulas with coordinates in place of the time, unless t is a name of the description's own.

    Raises `FormulaError` where the time stands otherwise than in `_MULTIPLES`.
    """
    names = (*state, *parameters, *where)
    if TIME in names:
        return Forced(state, field, where, texts)
    for name in names:
        # Harmonics have such names too, with a number.
        if name.startswith(FORCE):
            raise FormulaError(f"{name} begins like the names of the force; choose another one")
    # Once to see how fast the phases turn, and again with the harmonics of a rate of which all are multiples.
    reader = _Reader(names, parameters, {})
    kept, changed, rest = reader.all_without(where, field, texts)
    if not reader.rates:
        return Forced(state, changed, kept, rest)
    base, harmonics = _common(reader.rates)
    reader = _Reader(names, parameters, harmonics)
    kept, changed, rest = reader.all_without(where, field, texts)
    cosine, sine = FORCE
    rate, spring = _as_text(base), f"(1 - {cosine}**2 - {sine}**2)/4"
    force = {cosine: f"({rate})*(-{sine} + {spring}*{cosine})", sine: f"({rate})*({cosine} + {spring}*{sine})"}
    highest = max(map(abs, harmonics.values()), default=1)
    return Forced((*state, *FORCE), changed | force, _harmonics(highest) | kept, rest)


def _harmonics(highest: int) -> dict[str, str]:
    """cos and sin of multiples of the force's phase, as formulas under names."""
    cosine, sine = FORCE
    found = {}
    for order in range(2, highest + 1):
        before = _named(order - 1)
        found[_named(order)[0]] = f"{before[0]}*{cosine} - {before[1]}*{sine}"
        found[_named(order)[1]] = f"{before[1]}*{cosine} + {before[0]}*{sine}"
    return found


def _named(order: int) -> tuple[str, str]:
    cosine, sine = FORCE
    return (cosine, sine) if order == 1 else (f"{cosine}_{order}", f"{sine}_{order}")


def _common(rates: Sequence[Terms]) -> tuple[Terms, dict[str, int]]:
    """A rate of which all are whole multiples, and which multiple each is, by its text."""
    first, ratios = rates[0], []
    product, factor = next(iter(first.items()))
    for rate in rates:
        ratio = rate.get(product, Fraction(0)) / factor
        if not ratio or rate != _product(first, {(): ratio}):
            raise FormulaError(
                f"the rates {_as_text(first)} and {_as_text(rate)} of the force have no common period that is seen; "
                "give one of them as a multiple of the other"
            )
        ratios.append(ratio)
    # The least of which all are multiples, with the sign that makes its first term positive.
    unit = Fraction(gcd(*(ratio.numerator for ratio in ratios)), lcm(*(ratio.denominator for ratio in ratios)))
    unit = unit if factor > 0 else -unit
    found = {_as_text(rate): int(ratio / unit) for rate, ratio in zip(rates, ratios, strict=True)}
    if max(map(abs, found.values())) > _MOST_HARMONICS:
        raise FormulaError(f"the force has more than {_MOST_HARMONICS} harmonics; write it with fewer")
    return _product(first, {(): unit}), found


Terms = Mapping[tuple[tuple[str, int], ...], Fraction]
"""A sum of products of powers of names, with their factors: equal sums have equal terms."""


@dataclass(frozen=True)
class _InTime:
    """rest + rate t, the rest as text (`None`: 0), the rate as a sum of products of parameters.

    `terms` are those of the rest where it is such a sum too.
    """

    rest: str | None
    rate: Terms
    terms: Terms | None

    def __add__(self, other: Any) -> _InTime:
        right = _in_time(other)
        terms = None if self.terms is None or right.terms is None else _sum(self.terms, right.terms)
        rest = " + ".join(f"({each.rest})" for each in (self, right) if each.rest is not None) or None
        return _InTime(rest, _sum(self.rate, right.rate), terms)

    __radd__ = __add__

    def __neg__(self) -> _InTime:
        return self * Fraction(-1)

    def __sub__(self, other: Any) -> _InTime:
        return self + _in_time(other) * Fraction(-1)

    def __rsub__(self, other: Any) -> _InTime:
        return _in_time(other) - self

    def __mul__(self, other: Any) -> _InTime:
        left, right = self, _in_time(other)
        if right.rate:
            left, right = right, left
        if right.rate or (left.rate and right.terms is None):
            raise FormulaError(f"a product with the time t cannot be read; {_REMEDY}")
        terms = None if left.terms is None or right.terms is None else _product(left.terms, right.terms)
        rest = None if left.rest is None or right.rest is None else f"({left.rest})*({right.rest})"
        return _InTime(rest, _product(left.rate, right.terms) if right.terms is not None else {}, terms)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> _InTime:
        return self * _in_time(other) ** Fraction(-1)

    def __rtruediv__(self, other: Any) -> _InTime:
        return _in_time(other) / self

    def __pow__(self, exponent: Fraction) -> _InTime:
        if self.rate:
            raise FormulaError(f"a power or quotient of the time t cannot be read; {_REMEDY}")
        if self.rest is None and exponent < 0:
            raise FormulaError("a formula divides by zero; correct it")
        terms: Terms | None = None
        if self.terms is not None and len(self.terms) == 1 and exponent.denominator == 1:
            ((product, factor),) = self.terms.items()
            powers = tuple((name, power * int(exponent)) for name, power in product if exponent)
            terms = {powers: factor ** int(exponent)}
        elif self.terms is not None:
            terms = {((f"({_as_text(self.terms)})**({exponent})", 1),): Fraction(1)}
        return _InTime(f"({self.rest or 0})**({exponent})", {}, terms)


def _in_time(value: Any) -> _InTime:
    if isinstance(value, _InTime):
        return value
    return _InTime(None if value == 0 else str(value), {}, {} if value == 0 else {(): value})


def _sum(left: Terms, right: Terms) -> Terms:
    found = {key: left.get(key, Fraction(0)) + right.get(key, Fraction(0)) for key in (*left, *right)}
    return {key: value for key, value in found.items() if value}


def _product(left: Terms, right: Terms) -> Terms:
    result: dict[tuple[tuple[str, int], ...], Fraction] = {}
    for one, a in left.items():
        for two, b in right.items():
            powers = dict(one)
            for name, power in two:
                powers[name] = powers.get(name, 0) + power
            key = tuple(sorted((name, power) for name, power in powers.items() if power))
            result[key] = result.get(key, Fraction(0)) + a * b
    return {key: value for key, value in result.items() if value}


def _as_text(terms: Terms) -> str:
    return " + ".join(_product_as_text(product, factor) for product, factor in terms.items())


def _product_as_text(product: tuple[tuple[str, int], ...], factor: Fraction) -> str:
    powers = [name if power == 1 else f"({name})**({power})" for name, power in product]
    return "*".join(powers if factor == 1 and powers else [f"({factor})" if factor < 0 else f"{factor}", *powers])


class _Reader:
    """Takes the time out of formulas.

    Attributes:
        rates: of the phases, in the order in which they are met.

    Args:
        harmonics: which multiple of the force's phase turns at a rate, by its text; none while rates are collected.
    """

    def __init__(self, names: Sequence[str], parameters: Sequence[str], harmonics: Mapping[str, int]) -> None:
        self._values = {
            name: _InTime(name, {}, {((name, 1),): Fraction(1)} if name in parameters else None) for name in names
        }
        self._values[TIME] = _InTime(None, {(): Fraction(1)}, {})
        self._moving, self._harmonics = {TIME}, harmonics
        self.rates: list[Terms] = []

    def all_without(
        self, where: Mapping[str, Any], field: Mapping[str, Any], texts: Mapping[str, Any]
    ) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
        """The formulas without the time; those under where that are phases are left out."""
        kept, first, second = ({}, {}, {})  # type: tuple[dict[str, Any], dict[str, Any], dict[str, Any]]
        for each, found in ((where, kept), (field, first), (texts, second)):
            for name, text in each.items():
                try:
                    if each is not where or not self._is_phase(name, text):
                        found[name] = self._without(text)
                except FormulaError as error:
                    raise FormulaError(f"in the formula of {name}: {error}") from None
        return kept, first, second

    def _is_phase(self, name: str, text: Any) -> bool:
        """Whether a formula under where is r*t + c; whatever it is, `name` stands for it in what follows."""
        if any(map(_is_call, nodes_of(text))) or not isinstance(text, str):
            return False
        try:
            value = _in_time(evaluate_formula(text, self._values))
        except FormulaError:
            if self._moves(text):
                raise
            # What is wrong with it is said where it is read.
            return False
        if not value.rate:
            self._values[name] = _InTime(name, {}, value.terms)
            return False
        self._values[name] = value
        self._moving.add(name)
        return True

    def _without(self, text: Any) -> Any:
        if not self._moves(text):
            return text
        text = " ".join(text.split())
        while (found := self._innermost(text)) is not None:
            argument = ast.get_source_segment(text, found.args[0]) or ""
            turn = self._turn(found.func.id, argument)
            text = f"{text[: found.col_offset]}{turn}{text[found.end_col_offset :]}"
        if self._moves(text):
            raise FormulaError(f"the time in {text[:60]!r} cannot be read; {_REMEDY}")
        return text

    def _moves(self, text: Any) -> bool:
        return any(isinstance(node, ast.Name) and node.id in self._moving for node in nodes_of(text))

    def _innermost(self, text: str) -> Any:
        """A sine or cosine of something that moves, without another one in its argument."""
        calls = [node for node in nodes_of(text) if _is_call(node) and node.func.id in ("sin", "cos")]  # type: ignore[attr-defined]
        turns = [call for call in calls if self._moves(ast.get_source_segment(text, call.args[0]))]  # type: ignore[attr-defined]
        return min(turns, key=lambda call: call.end_col_offset - call.col_offset, default=None)  # type: ignore[attr-defined]

    def _turn(self, function: str, argument: str) -> str:
        """sin or cos of rest + rate t, by the addition theorem."""
        if any(map(_is_call, nodes_of(argument))):
            raise FormulaError(f"the phase {argument[:60]!r} cannot be read: give what is added to r*t under where")
        phase = _in_time(evaluate_formula(argument, self._values))
        if not phase.rate:
            return f"{function}({phase.rest or 0})"
        self.rates.append(phase.rate)
        order = self._harmonics.get(_as_text(phase.rate), 1)
        cosine, sine = _named(abs(order))
        sine = sine if order > 0 else f"(-{sine})"
        if phase.rest is None:
            return cosine if function == "cos" else sine
        by_cosine, by_sine = f"cos({phase.rest})", f"sin({phase.rest})"
        if function == "cos":
            return f"({by_cosine}*{cosine} - {by_sine}*{sine})"
        return f"({by_sine}*{cosine} + {by_cosine}*{sine})"


def _is_call(node: ast.AST) -> bool:
    """A function of one argument, a root excepted."""
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id != "sqrt"
        and len(node.args) == 1
    )
