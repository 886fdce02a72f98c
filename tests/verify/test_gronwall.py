"""Propagation of graded errors: the tube, the derivatives of the field on it, the comparison system."""

from __future__ import annotations

import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import fmpz_poly
from support.exact_elements import (
    PRECISION,
    Element,
    Unknown,
    exponents_of_grade,
    is_enclosed,
    random_arithmetic,
    random_element,
    random_point,
)
from support.wide_elements import shrunk, values_of
from support.within import within

from orbitproof.shared.systems import AROUND, SYSTEMS
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic, prepare
from orbitproof.verify.flow import comparison_matrices, derivative_bounds
from orbitproof.verify.flow.gronwall import PARTS, centre_and_norms, norm_arithmetic

_reference_precision = within(lambda: mpmath.workprec(PRECISION))


def moved(source: random.Random, element: Element, tube: list[float]) -> Element:
    """An exact element within `tube` of a given one."""
    arithmetic = element.series.arithmetic
    grading = arithmetic.grading
    extra = []
    for slot, size in enumerate(tube):
        grades = [slot] if slot <= grading.top else range(grading.top + 1, grading.top + 3)
        monomials = [exponents for grade in grades for exponents in exponents_of_grade(grading, grade)]
        if monomials:
            power = (source.choice((0, 1, 2 * arithmetic.width + 9)),) if arithmetic.width else ()
            extra.append(Unknown(size, (*source.choice(monomials), *power), source.randrange(3)))
    return Element(element.series, (*element.unknown, *extra))


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("wide", [False, True])
def test_the_tube_holds_every_element_near_the_solution(wide: bool, seed: int) -> None:
    """Also where degrees and precision of the norm computation are below those of the solution."""
    source = random.Random(f"{wide} {seed}")
    fine = random_arithmetic(source, wide)
    if seed % 2:
        grading, bits = fine.grading, fine.grade_bits
        width = source.choice((5, 12))
        fine = WideArithmetic(grading, 150, bits, 28, width=width) if wide else Arithmetic(grading, 150, bits, 40)
    element = random_element(source, fine)
    tube = [10.0 ** source.uniform(-20, -1) for _ in element.series.errors]
    neighbour = moved(source, element, tube)
    coarse = norm_arithmetic(fine)
    assert min(1, fine.width) <= coarse.width <= fine.width
    result = centre_and_norms(coarse, element.series, tube)
    assert wide or all(polynomial.length() <= coarse.degree + 1 for polynomial in result.coefs)
    for _ in range(8):
        theta, t, point = random_point(source, fine.grading, wide)
        assert is_enclosed(result, neighbour.at(theta, point), theta, t, point[-1:] if wide else [])


def test_the_coarse_centre_is_an_enclosure_of_an_exact_one() -> None:
    """Nothing is unknown of the element, and the tube is empty: what its centre loses is all there is."""
    fine = Arithmetic(Grading((1,), 1), 200, 0, 3)
    exact = [Fraction(2**200 - 1, 2**200 * 3**n) for n in range(4)]
    centre = fmpz_poly([int(value * 2**200) for value in exact])
    element = Series(fine, [centre, fmpz_poly([])], fine.zero_errors())
    result = centre_and_norms(norm_arithmetic(fine), element, fine.zero_errors())
    lost = sum(Fraction(int(a), 2**200) - Fraction(int(b), 2**96) for a, b in zip(centre, result.coefs[0], strict=True))
    assert 0 < lost <= Fraction(result.errors[0])


@pytest.mark.parametrize(
    ("name", "wide"), [*((name, False) for name in SYSTEMS), *((name, True) for name in ("falkner-skan", "cr3bp-l1"))]
)
@pytest.mark.parametrize("seed", range(6))
def test_derivatives_of_the_field_are_bounded_on_the_tube(name: str, wide: bool, seed: int) -> None:
    """Partial derivatives by central differences, at real points if nothing is wide, and the values of the field."""
    source = random.Random(f"{name} {wide} {seed}")
    system = {**SYSTEMS, "cr3bp-l1": AROUND["L1"]}[name]
    size = len(system.state)
    width = source.choice((3, 10))
    fine = WideArithmetic(Grading((1, 1), 1), 80, 5, 6, width) if wide else Arithmetic(Grading((1, 2), 2), 90, 5, 6)
    centres = [source.uniform(0.3, 0.6) for _ in range(size + len(system.parameters))]
    if name == "cr3bp-l1":
        centres[size:] = [0.3, 0.2, 0.02]
    small = [shrunk(random_element(source, fine, centre=value), 0.02) for value in centres]
    tube = [1e-4, 1e-5, 1e-5, 1e-6][: fine.grading.top + 2]
    neighbours = [moved(source, x, tube) for x in small]
    coarse = norm_arithmetic(fine)
    inputs = [centre_and_norms(coarse, x.series, tube) for x in small]
    derivatives, slopes = derivative_bounds(prepare(system.program), size, inputs)
    shift = mpmath.mpf(2) ** -150
    for _ in range(2 if wide else 4):
        theta, t, point = random_point(source, fine.grading, wide)
        s = point[-1:] if wide else []
        values = [x.at(theta, point) for x in neighbours]
        for slope, value in zip(slopes, values_of(system.program, values), strict=True):
            assert is_enclosed(slope, value, theta, t, s)
        for j in range(size):
            ahead, behind = ([v + sign * shift * (i == j) for i, v in enumerate(values)] for sign in (1, -1))
            pairs = zip(values_of(system.program, ahead), values_of(system.program, behind), strict=True)
            for i, (high, low) in enumerate(pairs):
                partial = (high - low) / (2 * shift)
                if j in derivatives[i]:
                    # Room for the truncation of central differences with steps of 2^-150.
                    slack = derivatives[i][j].with_errors([e + 1e-60 for e in derivatives[i][j].errors])
                    assert is_enclosed(slack, partial, theta, t, s)
                else:
                    assert abs(partial) < mpmath.mpf(2) ** -200


@pytest.mark.parametrize("seed", range(20))
def test_the_comparison_matrices_bound_the_derivatives_part_by_part(seed: int) -> None:
    """M E is at least, component by component, the sum of the graded products of derivatives and errors."""
    source = random.Random(seed)
    size, top = source.randint(1, 3), source.randint(0, 3)
    slots = top + 2
    coarse = Arithmetic(Grading((), top), 96, 0, 24)
    scale = 10.0 ** source.uniform(-20, 3)
    derivatives = [
        {
            j: Series(
                coarse,
                [fmpz_poly([int(source.uniform(-1, 1) * scale * 2.0**96) for _ in range(source.randint(0, 25))])],
                [10.0 ** source.uniform(-9, 3) * scale * (source.random() < 0.8) for _ in range(slots)],
            )
            for j in range(size)
            if source.random() < 0.7
        }
        for _ in range(size)
    ]
    errors = np.array([[10.0 ** source.uniform(-30, 0) for _ in range(slots)] for _ in range(size)])
    matrices = comparison_matrices(derivatives, slots)
    assert len(matrices) == PARTS
    for part, matrix in enumerate(matrices):
        product = (matrix @ errors.reshape(-1)).reshape(size, slots)
        for place in (Fraction(0), Fraction(1), Fraction(source.random())):
            theta = (part + place) / PARTS
            for i, row in enumerate(derivatives):
                wanted = [Fraction(0)] * slots
                for j, series in row.items():
                    value = abs(sum((int(c) * theta**n for n, c in enumerate(series.coefs[0].coeffs())), Fraction(0)))
                    norm = [Fraction(e) for e in series.errors]
                    norm[0] += value / 2**96
                    for grade, bound in enumerate(norm):
                        for source_grade, error in enumerate(errors[j]):
                            wanted[min(grade + source_grade, slots - 1)] += bound * Fraction(float(error))
                for found, least in zip(product[i], wanted, strict=True):
                    assert Fraction(float(found)) >= least


def test_a_constant_derivative_is_not_enlarged() -> None:
    coarse = Arithmetic(Grading((), 1), 96, 0, 24)
    derivative = Series(coarse, [fmpz_poly([3 << 95])], [0.0, 0.25, 0.5])
    for matrix in comparison_matrices([{0: derivative}], 3):
        expected = [[1.5, 0.0, 0.0], [0.25, 1.5, 0.0], [0.5, 0.75, 2.25]]
        assert np.allclose(matrix, expected, rtol=1e-8, atol=1e-200)


def test_an_oscillation_is_bounded_by_its_size_on_each_part() -> None:
    """The sum of the coefficients of a Chebyshev polynomial is far above its values."""
    values = [1, 0, -32, 0, 160, 0, -256, 0, 128]
    coarse = Arithmetic(Grading((), 0), 96, 0, 24)
    derivative = Series(coarse, [fmpz_poly([v << 96 for v in values])], [0.0, 0.0])
    for matrix in comparison_matrices([{0: derivative}], 2):
        assert matrix[0, 0] < 10
