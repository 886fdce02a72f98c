"""Products and powers with a wide variable, at random: what is kept and what is said to be lost is all of them.

Half of all have approximations that were corrupted: what is enclosed around them holds the power all the same.
"""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import arb, ctx, fmpz_poly
from support.exact_elements import packed_from, rows_of

from orbitproof.verify.algebra import Grading, Series, WideArithmetic, correct_power

EXPONENTS = [Fraction(-1), Fraction(-1, 2), Fraction(-3, 2), Fraction(-5, 3)]
Table = list[list[int]]


def arithmetic_at_random(source: random.Random) -> WideArithmetic:
    """Of few bits or many, short or long, narrow or wide."""
    return WideArithmetic(
        Grading((1,), 1), source.choice((12, 30, 64, 90)), source.choice((0, 7)), source.choice((0, 1, 4, 9)),
        width=source.choice((1, 3, 8, 13)),
    )  # fmt: skip


def table_at_random(source: random.Random, arithmetic: WideArithmetic, size: int) -> Table:
    """Coefficients of powers of theta and s, up to 2^size, that decay at random rates or not at all."""
    late, high = source.choice((0, 1, 4)), source.choice((0, 2, 5))
    return [
        [source.randint(-(2**size), 2**size) >> (late * n + high * j) for j in range(arithmetic.width + 1)]
        for n in range(arithmetic.degree + 1)
    ]


def exact_product(left: Table, right: Table) -> dict[tuple[int, int], int]:
    """All terms of a product, each at its place: packed so widely that none runs into another."""
    stride = len(left[0]) + len(right[0])
    one, other = (fmpz_poly([c for row in table for c in row + [0] * (stride - len(row))]) for table in (left, right))
    return {divmod(index, stride): int(c) for index, c in enumerate((one * other).coeffs()) if c}


def check_a_product(source: random.Random) -> None:
    arithmetic = arithmetic_at_random(source)
    left, right = (
        table_at_random(source, arithmetic, source.choice((3, arithmetic.bits - 1, arithmetic.bits + 9)))
        for _ in range(2)
    )
    square = source.random() < 0.3
    first = [packed_from(arithmetic, left), fmpz_poly([])]
    second = first if square else [packed_from(arithmetic, right), fmpz_poly([])]
    value, lost = arithmetic.product_slice(first, second, 0)
    exact = exact_product(left, left if square else right)
    kept = {(n, j): int(c) for n, row in enumerate(rows_of(arithmetic, value)) for j, c in enumerate(row) if c}
    assert all(j <= arithmetic.width and n <= arithmetic.degree for n, j in kept)
    places, one = exact.keys() | kept.keys(), int(arithmetic.one)
    missing = sum(abs(exact.get(place, 0) - one * kept.get(place, 0)) for place in places)
    assert Fraction(missing, one * one) <= Fraction(lost)


def value_at(arithmetic: WideArithmetic, polynomial: fmpz_poly, theta: Fraction, s: Fraction) -> Fraction:
    terms = (c * theta**n * s**j for n, row in enumerate(rows_of(arithmetic, polynomial)) for j, c in enumerate(row))
    return sum(terms, Fraction(0)) / int(arithmetic.one)


def corrupted(source: random.Random, arithmetic: WideArithmetic, polynomial: fmpz_poly) -> fmpz_poly:
    """With one coefficient that is kept changed by more than rounding does."""
    place = source.randrange(arithmetic.degree + 1) * arithmetic.stride + source.randrange(arithmetic.width + 1)
    change = source.choice((-1, 1)) << source.randrange(4, arithmetic.bits)
    return polynomial + fmpz_poly([0] * place + [change])


def check_a_power(source: random.Random, corrupt: bool) -> bool:
    """Whether there was an enclosure, which holds the power then."""
    arithmetic, exponent = arithmetic_at_random(source), source.choice(EXPONENTS)
    table = table_at_random(source, arithmetic, max(1, arithmetic.bits - source.choice((4, 8, 11))))
    table[0][0] = source.randint(1, 3) << arithmetic.bits
    base = Series(arithmetic, [packed_from(arithmetic, table), fmpz_poly([])], arithmetic.zero_errors())
    if source.random() < 0.3:
        base = base.widened(Fraction(source.randint(1, 9), 2 ** (arithmetic.bits // 2)))
    approximate = arithmetic.power(base.coefs[0], exponent)
    if corrupt:
        approximate = corrupted(source, arithmetic, approximate)
    known = Series(arithmetic, [approximate, fmpz_poly([])], arithmetic.zero_errors())
    found = correct_power(known, base, exponent)
    if found is None:
        return False
    theta, s = Fraction(source.randint(0, 8), 8), Fraction(source.randint(-8, 8), 8)
    # Whatever of the unknown part of the base: the ends of its interval.
    for unknown in (-1, 1):
        exact = value_at(arithmetic, base.coefs[0], theta, s) + unknown * Fraction(base.errors[0])
        assert exact > 0
        power = (arb(exact.numerator) / exact.denominator) ** (arb(exponent.numerator) / exponent.denominator)
        kept = value_at(arithmetic, found.coefs[0], theta, s)
        distance = abs(power - arb(kept.numerator) / kept.denominator)
        assert not distance > arb(found.errors[0])
    return True


@pytest.mark.parametrize("count", [600, pytest.param(100_000, marks=pytest.mark.slow)])
def test_products_and_powers_at_random_are_enclosed(count: int) -> None:
    source, enclosed, before = random.Random(count), {False: 0, True: 0}, ctx.prec
    ctx.prec = 300
    try:
        for _ in range(count // 4):
            check_a_product(source)
            for corrupt in (False, True, True):
                enclosed[corrupt] += check_a_power(source, corrupt)
    finally:
        ctx.prec = before
    # Most are enclosed, also around corrupted approximations.
    assert min(enclosed.values()) > count // 20, enclosed
