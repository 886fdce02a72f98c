"""Norms with a wide variable bound tubes, derivatives and values at real points."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from flint import arb, fmpz_poly
from support.balls import agree
from support.exact_elements import (
    PRECISION,
    is_enclosed,
    known_value,
    number,
    packed_from,
    random_element,
    random_point,
)
from support.wide_elements import POINTS, points, wide_arithmetic
from support.within import within

from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.flow import comparison_matrices
from orbitproof.verify.flow.gronwall import PARTS, centre_and_norms, norm_arithmetic
from orbitproof.verify.poincare import range_of, stays_positive, wide_parts

_reference_precision = within(lambda: mpmath.workprec(PRECISION))


@pytest.mark.parametrize("seed", range(3))
def test_the_rounding_of_the_norm_computation_counts(seed: int) -> None:
    """An exact element of 150 bits, all of whose powers are kept."""
    source = random.Random(seed)
    fine = WideArithmetic(Grading((1,), 1), 150, 0, 3, width=2)
    rows = [[source.randint(-(2**150), 2**150) for _ in range(3)] for _ in range(4)]
    element = Series(fine, [packed_from(fine, rows), fmpz_poly([])], [0.0] * 3)
    result = centre_and_norms(norm_arithmetic(fine), element, [0.0] * 3)
    for theta, t, point in points(source, fine):
        assert is_enclosed(result, known_value(element, theta, point), theta, t, point[-1:])


@pytest.mark.parametrize("seed", range(12))
def test_the_comparison_matrix_bounds_products_on_each_part(seed: int) -> None:
    """For all s on the unit circle, with random elements that belong to the derivatives."""
    source = random.Random(seed)
    coarse = WideArithmetic(Grading((), 1), 96, 0, source.choice((4, 24)), width=source.choice((1, 8)))
    rows = [[int(source.uniform(-1, 1) * 2.0**96) for _ in range(coarse.width + 1)] for _ in range(coarse.degree + 1)]
    derivative = Series(coarse, [packed_from(coarse, rows)], [source.random(), source.random(), source.random()])
    error = np.array([10.0 ** source.uniform(-9, 0) for _ in range(3)])
    for part, matrix in enumerate(comparison_matrices([{0: derivative}], 3)):
        for _ in range(4):
            theta = (part + mpmath.mpf(source.choice((0, 1, source.random())))) / PARTS
            s = mpmath.expjpi(source.choice((0, 1, 2 * source.random())))
            value = abs(known_value(derivative, theta, [s]))
            norm = [value + derivative.errors[0], *map(mpmath.mpf, derivative.errors[1:])]
            wanted = [mpmath.mpf(0)] * 3
            for i, bound in enumerate(norm):
                for j in range(3):
                    wanted[min(i + j, 2)] += bound * float(error[j])
            assert all(found >= least for found, least in zip(matrix @ error, wanted, strict=True))


def test_a_polynomial_in_s_is_bounded_by_the_sum_of_its_coefficients() -> None:
    """1 + s - s^2 has the norm 3 on the unit circle's algebra, not its largest value."""
    coarse = WideArithmetic(Grading((), 0), 96, 0, 4, width=2)
    one = int(coarse.one)
    derivative = Series(coarse, [packed_from(coarse, [[one, one, -one]])], [0.0, 0.0])
    for matrix in comparison_matrices([{0: derivative}], 2):
        assert np.allclose(matrix, [[3, 0], [0, 3]], rtol=1e-8, atol=1e-200)


@pytest.mark.parametrize("seed", range(15))
def test_ranges_hold_all_real_values(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic)
    result = element.series.at_end()
    parts = wide_parts(8)
    for _ in range(POINTS):
        _, _, point = random_point(source, arithmetic.grading, wide=True)
        index = source.randrange(8)
        s = Fraction(2 * index - 8 + source.choice((0, 1, 2)), 8)
        xi = [source.choice((-1, 1, Fraction(source.randint(-64, 64), 64))) for _ in point[:-1]]
        exact = element.at(mpmath.mpf(1), [*(number(Fraction(x)) for x in xi), number(s)]).real
        for part in (None, parts[index]):
            ball = range_of(result, part)
            assert abs(exact - mpf_of(ball.mid())) <= mpf_of(ball.rad()) + mpmath.mpf(2) ** -400


def mpf_of(value: arb) -> mpmath.mpf:
    mantissa, exponent = value.mid().man_exp()
    return mpmath.ldexp(int(mantissa), int(exponent))


def test_signs_depend_on_the_part_of_the_wide_interval() -> None:
    """s + 1/2 + theta/4 is positive for s > -1/2 only."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 3, width=2)
    one = int(arithmetic.one)
    series = Series(
        arithmetic, [packed_from(arithmetic, [[one // 2, one, 0], [one // 4, 0, 0]]), fmpz_poly([])], [2.0**-50] * 3
    )
    signs = [stays_positive(series, part) for part in wide_parts(8)]
    # The third part, [-1/2, -1/4], touches -1/2.
    assert signs == [False] * 3 + [True] * 5
    assert not stays_positive(series)
    assert not stays_positive(series.with_errors([0.5, 0.2, 0.0]), wide_parts(8)[4])
    assert stays_positive(series.with_errors([0.1, 0.1, 0.1]), wide_parts(8)[4])


def test_parts_cover_the_wide_interval() -> None:
    parts = wide_parts(8)
    assert (parts[0].lower() <= -1) is True
    assert (parts[-1].upper() >= 1) is True
    assert all(agree(a, b) for a, b in pairwise(parts))
