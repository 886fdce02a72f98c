"""Functions of time and of the wide variable s in float64 (section 15.1).

Approximations only: nothing here carries proof. A polynomial in s of degree d is represented by its values at
2 (d + 1) roots of unity, so that products and powers are taken point by point; as it is real, half of them do.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from orbitproof.verify.algebra.grading import Factors

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]


def to_points(coefficients: Floats) -> Points:
    """Values at the points, last axis; the last axis of the argument holds the powers of s."""
    return np.asarray(np.fft.rfft(coefficients, 2 * coefficients.shape[-1]))


def from_points(values: Points, width: int) -> Floats:
    """Coefficients of 1, s, .., s^width from the values at the points, last axis."""
    return np.asarray(np.fft.irfft(values, 2 * (width + 1))[..., : width + 1])


def power_of_series(base: Points, exponent: Fraction) -> Points:
    """``base ** exponent`` for power series in theta, shape (rows, points)."""
    rows = len(base)
    p, q = exponent.numerator, exponent.denominator
    result = np.zeros_like(base)
    result[0] = principal_power(base[0], exponent)
    for n in range(1, rows):
        weights = ((p + q) * np.arange(1, n + 1) - q * n)[:, None]
        result[n] = (weights * base[1 : n + 1] * result[n - 1 :: -1][:n]).sum(axis=0) / (q * n * base[0])
    return result


def principal_power(values: Points, exponent: Fraction) -> Points:
    """Powers of values on a closed curve around which the argument does not wind."""
    return np.asarray(np.exp(float(exponent) * (np.log(np.abs(values)) + 1j * np.unwrap(np.angle(values)))))


def graded_power(base: Points, exponent: Fraction, factors: Factors, grades: Sequence[int]) -> Points:
    """``base ** exponent`` for elements without theta, shape (monomials, points); see `Evaluation`."""
    p, q = exponent.numerator, exponent.denominator
    result = np.zeros_like(base)
    result[0] = principal_power(base[0], exponent)
    for position in range(1, len(base)):
        total = np.zeros_like(base[0])
        for i, j in factors[position]:
            weight = p * grades[j] - q * grades[i]
            if i != position and weight:
                total = total + weight * result[i] * base[j]
        result[position] = total / (q * grades[position] * base[0])
    return result
