"""Polynomials of degree 3 with numbers that may be balls, as tables of derivatives on a box."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from math import perm

from flint import arb

from orbitproof.verify.evidence import DerivativeTable, MultiIndex, indices_up_to

Coefficients = Mapping[MultiIndex, arb]
MOST = 3


def derivative(polynomial: Coefficients, index: MultiIndex, at: Sequence[arb]) -> arb:
    """Of the polynomial, at a point."""
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
    size = len(sides)
    indices, centre = indices_up_to(size, MOST), [arb(0)] * size
    return DerivativeTable(
        {index: derivative(polynomial, index, sides) for index in indices},
        {index: derivative(polynomial, index, centre) for index in indices},
    )


def random_polynomial(
    variables: int, chance: random.Random, linear: Sequence[float], density: float = 0.5
) -> dict[MultiIndex, arb]:
    """One with these linear terms, without a constant one, and random ones of degree 2 and 3."""
    found = {}
    for index in indices_up_to(variables, MOST):
        if sum(index) == 1:
            found[index] = arb(linear[index.index(1)])
        elif sum(index) > 1 and chance.random() < density:
            found[index] = arb(chance.randint(-12, 12)) / 8
    return found
