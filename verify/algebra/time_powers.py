"""Approximate powers of polynomials in time (section 2.4).

Nothing here carries proof: `correct_power` bounds how far the result is from the power.
"""

from __future__ import annotations

from fractions import Fraction

from flint import arb, arb_series, ctx, fmpz, fmpz_poly

from orbitproof.verify.evidence import IntegrationFailure, guarded


def power_in_time(base: fmpz_poly, exponent: Fraction, bits: int, degree: int) -> tuple[fmpz_poly, fmpz_poly]:
    """Approximations of ``base ** exponent``, exponent < 0, and ``1 / base``, integers times 2^-bits.

    Raises `IntegrationFailure` if there are none.
    """
    length = degree + 1
    scale = arb(2) ** bits
    cap, ctx.cap = ctx.cap, length
    try:
        with guarded(bits):
            series = arb_series([arb(c) / scale for c in base.coeffs()], prec=length)
            inverse = arb_series([1], prec=length) / series
            p, q = -exponent.numerator, exponent.denominator
            if q == 1:
                root = inverse
            elif q == 2:
                root = series.rsqrt()
            else:
                root = (series.log() / arb(-q)).exp()
            power = root
            for _ in range(p - 1):
                power = power * root
            return _fixed(power, scale, length), _fixed(inverse, scale, length)
    except ZeroDivisionError:
        raise _no_expansion() from None
    finally:
        ctx.cap = cap


def _fixed(series: arb_series, scale: arb, length: int) -> fmpz_poly:
    values: list[fmpz] = []
    for n in range(length):
        integer = integer_part(series[n] * scale)
        if integer is None:
            raise _no_expansion()
        values.append(integer)
    return fmpz_poly(values)


def _no_expansion() -> IntegrationFailure:
    return IntegrationFailure(
        "singularity",
        "a power or quotient of the vector field has no finite expansion at the centre",
        "the orbit meets a singularity of the vector field: give another centre",
    )


def integer_part(value: arb) -> fmpz | None:
    """The floor of the midpoint of a ball; `None` if it is not finite."""
    return value.mid().floor().mid().unique_fmpz() if value.is_finite() else None
