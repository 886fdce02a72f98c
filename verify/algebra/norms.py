"""Upper bounds in float64: graded norms and their convolution (section 2.3).

A graded norm is a list of G + 2 non-negative floats: bounds for the grades 0 .. G and, last, one for
everything above G. Every function returns upper bounds: the terms are non-negative, so float
rounding is a relative error far below the factor of `inflate`, and its summand covers underflow,
even where subnormal numbers are flushed to zero. Overflow gives infinity and NaN is never turned
into a number; a bound that is not finite fails every comparison that could carry proof.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

GradedNorm = list[float]

_SLACK = 1.0 + 2.0**-40
FLOOR = 2.0**-1000
"""What is added to a bound: more than all that underflow can have taken from it."""


def inflate(value: float) -> float:
    """An upper bound for a float sum of at most 4000 products of non-negative floats."""
    return value * _SLACK + FLOOR


def float_above(numerator: int, exponent: int) -> float:
    """A float that is at least ``numerator * 2**exponent``, for numerator >= 0."""
    excess = numerator.bit_length() - 52
    if excess > 0:
        numerator = (numerator >> excess) + 1
        exponent += excess
    try:
        return math.ldexp(numerator, exponent) + FLOOR
    except OverflowError:
        return math.inf


def fraction_above(value: Fraction) -> float:
    """A float that is at least `value`, which is not negative."""
    return float_above(-((-value.numerator << 1000) // value.denominator), -1000)


def total(norm: Sequence[float]) -> float:
    """A bound for the sum over all grades."""
    return inflate(sum(norm))


def add(left: Sequence[float], right: Sequence[float]) -> GradedNorm:
    """Bounds for a sum."""
    return [inflate(a + b) for a, b in zip(left, right, strict=True)]


def convolve(left: Sequence[float], right: Sequence[float]) -> GradedNorm:
    """Bounds for a product: ``|ab|_g <= sum |a|_i |b|_(g-i)``, everything above G in the last slot."""
    top = len(left) - 2
    result = [0.0] * (top + 2)
    for i, a in enumerate(left):
        if a == 0.0:
            continue
        for j, b in enumerate(right):
            grade = i + j
            result[grade if grade <= top else top + 1] += a * b
    return [inflate(value) for value in result]


def geometric(ratio: Sequence[float]) -> GradedNorm | None:
    """Bounds for ``sum_(k >= 1) |E|^k``, given the graded norm of E; `None` unless the total is below 1/2.

    The sum F satisfies F = E + E F, which is solved grade by grade.
    """
    top = len(ratio) - 2
    everything = total(ratio)
    if not everything < 0.5:
        return None
    denominator = (1.0 - ratio[0]) / _SLACK
    result: GradedNorm = []
    for grade in range(top + 1):
        mixed = sum(ratio[i] * result[grade - i] for i in range(1, grade + 1))
        result.append(inflate((ratio[grade] + mixed) / denominator))
    overflow = ratio[top + 1] * (1.0 + sum(result))
    for i in range(1, top + 1):
        overflow += ratio[i] * sum(result[j] for j in range(top + 1 - i, top + 1))
    result.append(inflate(overflow / ((1.0 - everything) / _SLACK)))
    return result
