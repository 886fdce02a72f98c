"""Approximate powers of functions of time and the wide variable (section 15.1).

Nothing here carries proof: `verify.algebra.series.correct_power` bounds how far the result is from the power.
"""

from __future__ import annotations

from fractions import Fraction

from flint import fmpz, fmpz_poly

from orbitproof.verify.algebra.circle import from_points, pack, power_of_series, to_points, unpack
from orbitproof.verify.algebra.series import Arithmetic

_FLOAT_BITS = 50


def wide_power(arithmetic: Arithmetic, base: fmpz_poly, exponent: Fraction) -> tuple[fmpz_poly, fmpz_poly]:
    """Approximations of ``base ** exponent``, exponent < 0, and of ``1 / base`` as packed polynomials of grade 0.

    The power is found in float64 and improved by one step of Newton's method for y^q base^p = 1; the inverse,
    which only higher grades need, is left at float64.
    """
    bits, width = arithmetic.bits, arithmetic.width
    values = to_points(unpack(arithmetic, base, bits, arithmetic.degree + 1))
    inverse = pack(arithmetic, from_points(power_of_series(values, Fraction(-1)), width), bits)
    power = inverse if exponent == -1 else pack(
        arithmetic, from_points(power_of_series(values, exponent), width), bits
    )  # fmt: skip
    if bits <= _FLOAT_BITS:
        return power, inverse
    p, q = -exponent.numerator, exponent.denominator
    value = fmpz_poly([arithmetic.one])
    for _ in range(q):
        value = _product(arithmetic, value, power)
    for _ in range(p):
        value = _product(arithmetic, value, base)
    defect = fmpz_poly([arithmetic.one]) - value
    return power + _product(arithmetic, power, defect) // fmpz(q), inverse


def _product(arithmetic: Arithmetic, left: fmpz_poly, right: fmpz_poly) -> fmpz_poly:
    return arithmetic.cut(left * right)[0] // arithmetic.one
