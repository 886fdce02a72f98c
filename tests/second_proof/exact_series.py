"""Power series in several variables with rational coefficients, for comparison with jets."""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction
from itertools import combinations_with_replacement


class Series(dict[tuple[int, ...], Fraction]):
    """Coefficients by the variables of a monomial, ascending; truncated after `degree`."""

    def __init__(self, terms: Mapping[tuple[int, ...], Fraction], degree: int) -> None:
        super().__init__(terms)
        self.degree = degree

    def __missing__(self, key: tuple[int, ...]) -> Fraction:
        return Fraction(0)

    @classmethod
    def constant(cls, value: Fraction, degree: int) -> Series:
        return cls({(): value}, degree)

    @classmethod
    def random(cls, rng: random.Random, variables: int, degree: int) -> Series:
        every = [a for order in range(degree + 1) for a in combinations_with_replacement(range(variables), order)]
        return cls({a: Fraction(rng.randint(-9, 9), rng.randint(1, 5)) for a in every}, degree)

    def without_constant(self) -> Series:
        return Series({a: c for a, c in self.items() if a}, self.degree)

    def __add__(self, other: Series) -> Series:
        return Series({a: self[a] + other[a] for a in {*self, *other}}, self.degree)

    def __sub__(self, other: Series) -> Series:
        return Series({a: self[a] - other[a] for a in {*self, *other}}, self.degree)

    def __mul__(self, other: Series | Fraction | int) -> Series:
        factor = other if isinstance(other, Series) else Series.constant(Fraction(other), self.degree)
        result = Series({}, self.degree)
        for a, x in self.items():
            for b, y in factor.items():
                if len(a) + len(b) <= self.degree:
                    key = tuple(sorted(a + b))
                    result[key] = result[key] + x * y
        return result

    def inverse(self) -> Series:
        """1/self, by long division: one order after another."""
        result = Series.constant(1 / self[()], self.degree)
        for _ in range(self.degree):
            result = result + (Series.constant(Fraction(1), self.degree) - result * self) * (1 / self[()])
        return result

    def composed(self, inner: Mapping[int, Series]) -> Series:
        """The series with its variables replaced by series."""
        result = Series({}, self.degree)
        for a, c in self.items():
            term = Series.constant(c, self.degree)
            for j in a:
                term = term * inner[j]
            result = result + term
        return result

    def derivative(self, variable: int) -> Series:
        result = Series({}, self.degree)
        for a, c in self.items():
            if variable in a:
                rest = list(a)
                rest.remove(variable)
                result[tuple(rest)] = result[tuple(rest)] + c * a.count(variable)
        return result


def variable(number: int, degree: int) -> Series:
    return Series({(number,): Fraction(1)}, degree)
