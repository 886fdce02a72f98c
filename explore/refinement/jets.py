"""Truncated power series in several variables (jets), with coefficients of any number type.

A `JetBasis` is a finite set of monomials closed under division, for example all of degree <= 2, or
all whose weighted degree is at most 3. A `Jet` is a power series truncated to a basis; products drop
every monomial outside it, which is exact for the monomials kept.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

import mpmath

from orbitproof.explore.numerics import mpf

Monomial = tuple[int, ...]


@dataclass(frozen=True)
class JetBasis:
    """A set of monomials closed under division, ordered by total degree; monomial 0 is the constant."""

    monomials: tuple[Monomial, ...]

    def __post_init__(self) -> None:
        members = set(self.monomials)
        for monomial in self.monomials:
            for variable, exponent in enumerate(monomial):
                if exponent and _lowered(monomial, variable) not in members:
                    raise ValueError(f"the monomials are not closed under division: {monomial}")

    @classmethod
    def graded(cls, weights: Sequence[int], grade: int) -> JetBasis:
        """All monomials whose degree, variable i counted with positive weight `weights[i]`, is at most `grade`."""
        ranges = [range(grade // weight + 1) for weight in weights]
        return cls.of(m for m in product(*ranges) if sum(w * e for w, e in zip(weights, m, strict=True)) <= grade)

    @classmethod
    def of(cls, monomials: Any) -> JetBasis:
        """The basis of the given monomials, put in order."""
        return cls(tuple(sorted(set(monomials), key=lambda m: (sum(m), tuple(-e for e in m)))))

    @property
    def variables(self) -> int:
        """Number of variables."""
        return len(self.monomials[0])

    @property
    def degree(self) -> int:
        """Largest total degree of a monomial."""
        return sum(self.monomials[-1])

    @cached_property
    def index(self) -> dict[Monomial, int]:
        """Position of each monomial."""
        return {monomial: position for position, monomial in enumerate(self.monomials)}

    @cached_property
    def splits(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """For each monomial m the pairs (i, j) of positions with monomial i * monomial j = m."""
        result = []
        for target in self.monomials:
            pairs = []
            for position, left in enumerate(self.monomials):
                right = tuple(t - e for t, e in zip(target, left, strict=True))
                if min(right) >= 0:
                    pairs.append((position, self.index[right]))
            result.append(tuple(pairs))
        return tuple(result)

    @cached_property
    def splits_others(self) -> tuple[bool, ...]:
        """Whether a monomial divides a larger one of the basis."""
        divides = [False] * len(self.monomials)
        for target, pairs in enumerate(self.splits):
            for i, _ in pairs:
                divides[i] |= i != target
        return tuple(divides)

    def variable(self, number: int) -> int:
        """Position of the monomial that is variable `number` itself."""
        return self.index[tuple(int(i == number) for i in range(self.variables))]

    def constant(self, value: Any) -> Jet:
        """The constant jet."""
        return Jet(self, [value] + [0] * (len(self.monomials) - 1))


def _lowered(monomial: Monomial, variable: int) -> Monomial:
    return tuple(e - (i == variable) for i, e in enumerate(monomial))


class Jet:
    """A power series truncated to a `JetBasis`; `coefficients[i]` belongs to `basis.monomials[i]`."""

    __slots__ = ("basis", "coefficients")

    def __init__(self, basis: JetBasis, coefficients: Sequence[Any]) -> None:
        self.basis = basis
        self.coefficients = list(coefficients)

    def _lift(self, other: Any) -> Jet:
        return other if isinstance(other, Jet) else self.basis.constant(other)

    def __add__(self, other: Any) -> Jet:
        right = self._lift(other).coefficients
        return Jet(self.basis, [a + b for a, b in zip(self.coefficients, right, strict=True)])

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(self.basis, [-a for a in self.coefficients])

    def __sub__(self, other: Any) -> Jet:
        return self + (-self._lift(other))

    def __rsub__(self, other: Any) -> Jet:
        return -self + other

    def __mul__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.basis, [a * other for a in self.coefficients])
        left, right = self.coefficients, other.coefficients
        return Jet(self.basis, [sum(left[i] * right[j] for i, j in pairs) for pairs in self.basis.splits])

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.basis, [a / other for a in self.coefficients])
        return self * other.power(Fraction(-1))

    def __rtruediv__(self, other: Any) -> Jet:
        return self.power(Fraction(-1)) * other

    def power(self, exponent: Fraction, scalar_power: Callable[[Any, Fraction], Any] | None = None) -> Jet:
        """The series of `self ** exponent`; the constant term must not vanish unless exponent is 0, 1, 2, ...

        `scalar_power` raises the constant term; by default ``**`` with a float or integer exponent.
        """
        if exponent.denominator == 1 and exponent >= 0:
            result = self.basis.constant(1)
            for _ in range(int(exponent)):
                result = result * self
            return result
        base = self.coefficients
        if scalar_power is not None:
            head = scalar_power(base[0], exponent)
        else:
            head = base[0] ** (int(exponent) if exponent.denominator == 1 else float(exponent))
        result = [head]
        num, den = exponent.numerator, exponent.denominator
        for position, monomial in enumerate(self.basis.monomials[1:], start=1):
            # From a dc = r c da along a variable v of the monomial m:
            # m_v a_0 c_m = sum over j != 0 of (r j_v - (m_v - j_v)) a_j c_(m-j).
            v = next(i for i, e in enumerate(monomial) if e)
            total: Any = 0
            for i, j in self.basis.splits[position]:
                if i:
                    weight = (num + den) * self.basis.monomials[i][v] - den * monomial[v]
                    total = total + weight * (base[i] * result[j])
            result.append(total / (den * monomial[v] * base[0]))
        return Jet(self.basis, result)

    def function(self, name: str, context: Any) -> Jet:
        """sin, cos, exp or log of it; `context` has them of numbers."""
        head = self.coefficients[0]
        rest = Jet(self.basis, [0 * head, *self.coefficients[1:]])
        if name == "log":
            rest = rest / head
            series = [context.log(head), *((-1) ** (k + 1) / context.mpf(k) for k in range(1, self.basis.degree + 1))]
        else:
            sine, cosine = context.sin(head), context.cos(head)
            cycle = [sine, cosine, -sine, -cosine] if name != "exp" else [context.exp(head)] * 4
            places = range(name == "cos", self.basis.degree + 1 + (name == "cos"))
            series = [cycle[k % 4] / context.factorial(n) for n, k in enumerate(places)]
        result = self.basis.constant(series[-1])
        for coefficient in reversed(series[:-1]):
            result = result * rest + coefficient
        return result

    def compose(self, arguments: Sequence[Jet]) -> Jet:
        """Substitute jets without constant term for the variables; the result lives in their basis."""
        target = arguments[0].basis
        powers: dict[Monomial, Jet] = {self.basis.monomials[0]: target.constant(1)}
        result = target.constant(self.coefficients[0])
        for position, monomial in enumerate(self.basis.monomials[1:], start=1):
            v = next(i for i, e in enumerate(monomial) if e)
            powers[monomial] = powers[_lowered(monomial, v)] * arguments[v]
            if self.coefficients[position] != 0:
                result = result + powers[monomial] * self.coefficients[position]
        return result


def operations(context: mpmath.MPContext) -> tuple[Callable[[Any], Any], Callable[[Any, Fraction], Any]]:
    """How a straight-line program reads its constants and takes powers, of numbers and of jets with such numbers."""

    def constant(value: Any) -> Any:
        return mpf(value, context)

    def power(base: Any, exponent: Fraction) -> Any:
        return base.power(exponent, power) if isinstance(base, Jet) else context.mpf(base) ** constant(exponent)

    return constant, power
