"""Norms with a wide variable bound tubes, derivatives and values at real points."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from flint import arb, fmpz_poly
from support.exact_elements import (
    PRECISION,
    Element,
    Unknown,
    exponents_of_grade,
    is_enclosed,
    known_value,
    number,
    packed_from,
    random_element,
    random_point,
)
from support.wide_elements import POINTS, points, shrunk, values_of, wide_arithmetic

from orbitproof.shared.systems import AROUND, SYSTEMS
from orbitproof.verify.algebra import Grading, Series, WideArithmetic, prepare
from orbitproof.verify.flow import comparison_matrices, derivative_bounds
from orbitproof.verify.flow.gronwall import PARTS, centre_and_norms, norm_arithmetic
from orbitproof.verify.poincare import range_of, stays_positive, wide_parts


@pytest.fixture(autouse=True)
def _reference_precision() -> Iterator[None]:
    with mpmath.workprec(PRECISION):
        yield


def moved(source: random.Random, element: Element, tube: list[float]) -> Element:
    """An exact element within `tube` of a given one."""
    arithmetic = element.series.arithmetic
    grading = arithmetic.grading
    extra = []
    for slot, size in enumerate(tube):
        grades = [slot] if slot <= grading.top else range(grading.top + 1, grading.top + 3)
        monomials = [exponents for grade in grades for exponents in exponents_of_grade(grading, grade)]
        if monomials:
            exponents = (*source.choice(monomials), source.choice((0, 1, 2 * arithmetic.width + 9)))
            extra.append(Unknown(size, exponents, source.randrange(3)))
    return Element(element.series, (*element.unknown, *extra))


@pytest.mark.parametrize("seed", range(20))
def test_the_tube_holds_every_element_near_the_solution(seed: int) -> None:
    """Also where degrees and precision of the norm computation are below those of the solution."""
    source = random.Random(seed)
    fine = wide_arithmetic(source)
    if seed % 2:
        fine = WideArithmetic(fine.grading, 150, fine.grade_bits, 28, width=source.choice((5, 12)))
    element = random_element(source, fine)
    tube = [10.0 ** source.uniform(-20, -1) for _ in element.series.errors]
    neighbour = moved(source, element, tube)
    coarse = norm_arithmetic(fine)
    assert 0 < coarse.width <= fine.width
    result = centre_and_norms(coarse, element.series, tube)
    for theta, t, point in points(source, fine):
        assert is_enclosed(result, neighbour.at(theta, point), theta, t, point[-1:])


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


@pytest.mark.parametrize("name", ["falkner-skan", "cr3bp", "cr3bp-l1"])
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_derivatives_of_the_field_are_bounded_on_the_tube(name: str, seed: int) -> None:
    """Partial derivatives by central differences, and the values of the field."""
    source = random.Random(f"{name} {seed}")
    system = {**SYSTEMS, "cr3bp-l1": AROUND["L1"]}[name]
    size = len(system.state)
    fine = WideArithmetic(Grading((1, 1), 1), 80, 5, 6, width=source.choice((3, 10)))
    centres = [source.uniform(0.3, 0.6) for _ in range(size + len(system.parameters))]
    if name == "cr3bp-l1":
        centres[size:] = [0.3, 0.2, 0.02]
    small = [shrunk(random_element(source, fine, centre=value), 0.02) for value in centres]
    tube = [1e-5, 1e-6, 1e-7]
    neighbours = [moved(source, x, tube) for x in small]
    coarse = norm_arithmetic(fine)
    inputs = [centre_and_norms(coarse, x.series, tube) for x in small]
    derivatives, slopes = derivative_bounds(prepare(system.program), size, inputs)
    shift = mpmath.mpf(2) ** -150
    for theta, t, point in points(source, fine, 2):
        s = point[-1:]
        values = [x.at(theta, point) for x in neighbours]
        for slope, value in zip(slopes, values_of(system.program, values), strict=True):
            assert is_enclosed(slope, value, theta, t, s)
        for j in range(size):
            ahead, behind = ([v + sign * shift * (i == j) for i, v in enumerate(values)] for sign in (1, -1))
            pairs = zip(values_of(system.program, ahead), values_of(system.program, behind), strict=True)
            for i, (high, low) in enumerate(pairs):
                partial = (high - low) / (2 * shift)
                if j in derivatives[i]:
                    slack = derivatives[i][j].with_errors([e + 1e-60 for e in derivatives[i][j].errors])
                    assert is_enclosed(slack, partial, theta, t, s)
                else:
                    assert partial == 0


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
    assert all(a.overlaps(b) for a, b in pairwise(parts))
