"""Polynomials in s by their coefficients of 1, s, s^2, ..: moved to another interval, and enclosed on it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import zip_longest
from math import comb

from flint import arb, arb_poly

from orbitproof.verify.evidence import enclose, total


def recentred(coefficients: Sequence[Fraction], middle: Fraction, radius: Fraction) -> list[Fraction]:
    """Coefficients in sigma of a polynomial in s = middle + radius * sigma, exactly."""
    if middle == 0:
        return [value * radius**n for n, value in enumerate(coefficients)]
    result = [Fraction(0)] * len(coefficients)
    for n, value in enumerate(coefficients):
        for j in range(n + 1):
            result[j] += value * comb(n, j) * middle ** (n - j)
    return [value * radius**j for j, value in enumerate(result)]


def plus(left: Sequence[Fraction], right: Sequence[Fraction], factor: Fraction) -> tuple[Fraction, ...]:
    """Coefficients of left + factor * right, exactly."""
    return tuple(a + factor * b for a, b in zip_longest(left, right, fillvalue=Fraction(0)))


def ball_polynomial(coefficients: Iterable[Fraction]) -> arb_poly:
    """A polynomial whose coefficients enclose exact ones."""
    return arb_poly([enclose(value) for value in coefficients])


def values_around(polynomial: arb_poly, centre: arb, reach: arb) -> arb:
    """Values at all points within `reach` of `centre`.

    The polynomial is a sum of a_n v^n at centre + reach v, and with |v| <= 1 within the sum of |a_n|, n >= 1, of a_0.
    """
    value, *others = [*polynomial(arb_poly([centre, reach])).coeffs(), arb(0)]
    return value + arb(0, 1) * total(abs(other) for other in others)
