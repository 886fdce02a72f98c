"""Derivatives on a box from one graded Taylor model (section 6)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import factorial, prod

from flint import arb

from orbitproof.verify.algebra import GradedNorm, Grading, Series
from orbitproof.verify.evidence import MAX_ORDER, DerivativeTable, MultiIndex, enclose, index_factorial, indices_up_to


def derivative_table(element: Series, scales: Sequence[Fraction], ratio: Fraction) -> DerivativeTable:
    """Derivatives with respect to p_i = scales_i xi_i on the box |xi_i| <= ratio < 1.

    Raises `ValueError` for an element that depends on theta or on a wide variable.
    """
    arithmetic = element.arithmetic
    if any(polynomial.length() > 1 for polynomial in element.coefs):
        raise ValueError("the element is no function on the box")
    coefficients = [
        arb(polynomial[0]) * arb(2) ** -scale
        for polynomial, scale in zip(element.coefs, arithmetic.scales, strict=True)
    ]
    return table_of(arithmetic.grading, coefficients, element.errors, scales, ratio)


def table_of(
    grading: Grading, coefficients: Sequence[arb], errors: GradedNorm, scales: Sequence[Fraction], ratio: Fraction
) -> DerivativeTable:
    """Derivatives from the coefficients of the kept monomials and the errors by grade.

    The unknown part of grade g is a power series with l1 norm at most e_g on the closed unit
    polydisc, so by Cauchy's estimate its derivative d^alpha on the smaller polydisc is at most
    alpha! (1 - ratio)^-|alpha| e_g, and 0 if g is below the grade of alpha.
    """
    known = dict(zip(grading.monomials, coefficients, strict=True))
    bounds = [arb(e) for e in errors]
    inside = enclose(ratio)
    unit = arb(0, 1)
    box: dict[MultiIndex, arb] = {}
    centre: dict[MultiIndex, arb] = {}
    for alpha in indices_up_to(len(scales), MAX_ORDER):
        grade = grading.grade(alpha)
        factor = arb(index_factorial(alpha))
        scale = prod((s**a for s, a in zip(scales, alpha, strict=True)), start=Fraction(1))
        value = arb(0)
        for exponents, coefficient in known.items():
            if all(n >= a for n, a in zip(exponents, alpha, strict=True)):
                falling = prod(factorial(n) // factorial(n - a) for n, a in zip(exponents, alpha, strict=True))
                term = coefficient * falling
                for n, a in zip(exponents, alpha, strict=True):
                    for _ in range(n - a):
                        term = term * (inside * unit)
                value = value + term
        unknown = sum((e for g, e in enumerate(bounds) if g >= min(grade, grading.top + 1)), arb(0))
        spread = factor * unknown / (1 - inside) ** sum(alpha)
        box[alpha] = (value + unit * spread) / enclose(scale)
        own = bounds[min(grade, grading.top + 1)]
        centre[alpha] = (known.get(alpha, arb(0)) * factor + unit * factor * own) / enclose(scale)
    return DerivativeTable(box, centre)
