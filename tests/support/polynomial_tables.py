"""Polynomials of degree 3 with numbers that may be balls, as tables of derivatives on a box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import perm

from flint import arb

from orbitproof.verify.evidence import DerivativeTable, MultiIndex, indices_up_to

Coefficients = Mapping[MultiIndex, arb]


def derivative(polynomial: Coefficients, index: MultiIndex, at: Sequence[arb]) -> arb:
    """Of a polynomial, at a point."""
    found = arb(0)
    for powers, coefficient in polynomial.items():
        if all(e >= i for e, i in zip(powers, index, strict=True)):
            term = coefficient
            for x, e, i in zip(at, powers, index, strict=True):
                term = term * perm(e, i)
                for _ in range(e - i):
                    term = term * x
            found += term
    return found


def table(polynomial: Coefficients, sides: Sequence[arb]) -> DerivativeTable:
    """On the box |p_i| <= sides_i, and at its centre."""
    indices, centre = indices_up_to(len(sides), 3), [arb(0)] * len(sides)
    return DerivativeTable(
        {index: derivative(polynomial, index, sides) for index in indices},
        {index: derivative(polynomial, index, centre) for index in indices},
    )
