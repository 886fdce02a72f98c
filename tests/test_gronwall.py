"""Propagation of graded errors: the tube, the derivatives of the field on it, the comparison system."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import fmpz_poly

from shared.systems import SYSTEMS
from tests.exact_elements import (
    PRECISION,
    Element,
    Unknown,
    allowed,
    exponents_of_grade,
    is_enclosed,
    number,
    random_arithmetic,
    random_element,
    random_point,
)
from verify.algebra import Arithmetic, Series
from verify.evaluation import prepare
from verify.grading import Grading
from verify.gronwall import (
    centre_and_norms,
    comparison_matrix,
    derivative_bounds,
    norm_arithmetic,
)
from verify.norms import convolve


@pytest.fixture(autouse=True)
def _reference_precision() -> Iterator[None]:
    with mpmath.workprec(PRECISION):
        yield


def moved(source: random.Random, element: Element, tube: list[float]) -> Element:
    """An exact element within `tube` of a given one."""
    grading = element.series.arithmetic.grading
    extra = []
    for slot, size in enumerate(tube):
        grades = [slot] if slot <= grading.top else range(grading.top + 1, grading.top + 3)
        monomials = [exponents for grade in grades for exponents in exponents_of_grade(grading, grade)]
        if monomials:
            extra.append(Unknown(size, source.choice(monomials), source.randrange(3)))
    return Element(element.series, (*element.unknown, *extra))


@pytest.mark.parametrize("seed", range(40))
def test_the_tube_holds_every_element_near_the_solution(seed: int) -> None:
    """Also where degree and precision of the norm computation are below those of the solution."""
    source = random.Random(seed)
    fine = random_arithmetic(source)
    if seed % 2:
        fine = Arithmetic(fine.grading, 150, fine.grade_bits, 40)
    element = random_element(source, fine)
    tube = [10.0 ** source.uniform(-20, -1) for _ in element.series.errors]
    neighbour = moved(source, element, tube)
    coarse = norm_arithmetic(fine)
    result = centre_and_norms(coarse, element.series, tube)
    assert all(polynomial.length() <= coarse.degree + 1 for polynomial in result.coefs)
    for _ in range(12):
        theta, t, point = random_point(source, fine.grading)
        assert is_enclosed(result, neighbour.at(theta, point), theta, t, [])


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("seed", range(6))
def test_derivatives_of_the_field_are_bounded_on_the_tube(name: str, seed: int) -> None:
    """Partial derivatives by central differences at real points, and the values of the field."""
    source = random.Random(f"{name} {seed}")
    system = SYSTEMS[name]
    size = len(system.state)
    fine = Arithmetic(Grading((1, 2), 2), 90, 5, 6)
    centres = [source.uniform(0.3, 0.6) for _ in range(size + len(system.parameters))]
    elements = [random_element(source, fine, centre=value) for value in centres]
    small = [
        Element(x.series.with_errors([0.05 * e for e in x.series.errors]),
                tuple(Unknown(0.05 * u.size, u.exponents, u.shape) for u in x.unknown))
        for x in elements
    ]  # fmt: skip
    tube = [1e-4, 1e-5, 1e-5, 1e-6]
    neighbours = [moved(source, x, tube) for x in small]
    coarse = norm_arithmetic(fine)
    inputs = [centre_and_norms(coarse, x.series, tube) for x in small]
    bounds, slopes = derivative_bounds(prepare(system.program), size, inputs)
    shift = mpmath.mpf(2) ** -150
    for _ in range(4):
        theta, t, point = random_point(source, fine.grading)
        values = [x.at(theta, point) for x in neighbours]

        def field(arguments: list[mpmath.mpc]) -> list[mpmath.mpc]:
            return system.program.evaluate(arguments, number, lambda base, e: mpmath.power(base, number(e)))

        for slope, value in zip(slopes, field(values), strict=True):
            assert is_enclosed(slope, value, theta, t, [])
        for j in range(size):
            ahead, behind = ([v + s * shift * (i == j) for i, v in enumerate(values)] for s in (1, -1))
            for i, (high, low) in enumerate(zip(field(ahead), field(behind), strict=True)):
                partial = abs(high - low) / (2 * shift)
                bound = allowed(Series(coarse, [fmpz_poly([])], bounds[i].get(j, [0.0] * 4)), t)
                assert partial <= bound + mpmath.mpf(2) ** -200


@pytest.mark.parametrize("seed", range(10))
def test_the_comparison_matrix_multiplies_grades(seed: int) -> None:
    """M E is, component by component, the sum of the graded convolutions of derivatives and errors."""
    source = random.Random(seed)
    size, slots = source.randint(1, 4), source.randint(2, 5)
    bounds = [
        {j: [10.0 ** source.uniform(-9, 3) for _ in range(slots)] for j in range(size) if source.random() < 0.7}
        for _ in range(size)
    ]
    errors = np.array([[10.0 ** source.uniform(-30, 0) for _ in range(slots)] for _ in range(size)])
    product = (comparison_matrix(bounds, slots) @ errors.reshape(-1)).reshape(size, slots)
    for i, row in enumerate(bounds):
        wanted = [Fraction(0)] * slots
        for j, norm in row.items():
            for grade, value in enumerate(norm):
                for source_grade, error in enumerate(errors[j]):
                    wanted[min(grade + source_grade, slots - 1)] += Fraction(value) * Fraction(float(error))
        for found, value in zip(product[i], wanted, strict=True):
            assert value <= Fraction(float(found)) <= value * (1 + Fraction(1, 2**20))


def test_the_convolution_of_norms_agrees_with_the_comparison_matrix() -> None:
    derivative, error = [2.0, 0.5, 0.25, 0.125], np.array([1.0, 4.0, 0.5, 8.0])
    matrix = comparison_matrix([{0: derivative}], 4)
    assert np.allclose(matrix @ error, convolve(derivative, list(error)), rtol=1e-8)
