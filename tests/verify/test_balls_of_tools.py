"""Of the tools under all proofs: what is found for balls contains what is found for each of their points."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import prod
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, arb_poly, ctx
from support.balls import agree
from support.flow_checks import random_fraction
from support.inclusion import Path, broken_inclusions, checked
from support.polynomial_tables import derivative, table
from support.thresholds import unsound_balls
from support.within import within

from orbitproof.shared import define_system
from orbitproof.shared.systems import FixedLevel
from orbitproof.verify.algebra import Arithmetic, Grading, values_around
from orbitproof.verify.algebra.wide import WideArithmetic
from orbitproof.verify.claim import LevelEquation, is_in
from orbitproof.verify.evidence import (
    FUNCTIONS,
    Checklist,
    IntegrationFailure,
    MultiIndex,
    NotEstablishedError,
    bounds,
    dot,
    enclose,
    excludes_zero,
    guarded,
    indices_up_to,
    is_below,
    is_inside,
    is_outside,
    is_positive,
    power,
    sign,
    symmetric,
    total,
    up_to,
)
from orbitproof.verify.maps import combination, displacement, enclose_zeros, image_of
from orbitproof.verify.maps.affine_section import AffineSection
from orbitproof.verify.maps.poincare_map import time_at_crossing
from orbitproof.verify.maps.starting_set import Format, StartingSet
from orbitproof.verify.newton import (
    BoxFunction,
    ImplicitGraph,
    Jet,
    compose,
    derivatives_of,
    enclose_zero,
    implicit_jets,
    left_kernel,
    newton_image,
)
from orbitproof.verify.newton.interval_newton import regularity_defect
from orbitproof.verify.poincare.crossing import InTime, range_of, stays_positive, wide_parts
from orbitproof.verify.poincare.derivatives import table_of
from orbitproof.verify.poincare.functions import _taylor

BITS = 160
HALF = Fraction(1, 2)
NARROW, NEAR = Fraction(1, 2**20), 2.0**-23
"""Of boxes, in which squares are much smaller than the balls; and how far from the centre zeros are."""
FINE, COARSE = arb(2) ** -26, arb(2) ** -8
"""Of balls of numbers that are as small, and of others."""

precision = within(lambda: guarded(BITS))


def numbers(count: int, chance: random.Random, size: float = 1.0) -> list[arb]:
    return [arb(chance.uniform(-size, size)) for _ in range(count)]


def random_polynomial(
    variables: int, chance: random.Random, linear: Sequence[float], density: float = 0.5
) -> dict[MultiIndex, arb]:
    """One of degree 3 with these linear terms, without a constant one, and random ones of degree 2 and 3."""
    found = {}
    for index in indices_up_to(variables, 3):
        if sum(index) == 1:
            found[index] = arb(linear[index.index(1)])
        elif sum(index) > 1 and chance.random() < density:
            found[index] = arb(chance.randint(-12, 12)) / 8
    return found


def matrix_near(size: int, chance: random.Random, rest: float = 0.3) -> list[list[arb]]:
    """A regular one, with entries of both signs."""
    return [
        [arb(chance.uniform(-rest, rest)) + (chance.choice((-1, 1)) * 1.5 if i == j else 0) for j in range(size)]
        for i in range(size)
    ]


def test_comparisons_hold_just_if_they_hold_for_both_ends() -> None:
    """Of finite balls by their exact ends, every other one next to what they are compared with."""
    chance = random.Random(0)
    for _ in range(400):
        bound, radius = Fraction(chance.randint(0, 6), 4), Fraction(chance.randint(0, 6), 8)
        middle = (
            chance.choice((-1, 0, 1)) * bound + chance.choice((-1, 0, 1)) * radius + Fraction(chance.randint(-1, 1), 64)
        )
        ball = arb(0).union(arb(0)) + enclose(middle) + (symmetric(radius) if radius else 0)
        low, high = bounds(ball)
        assert low <= middle - radius <= middle + radius <= high
        other = enclose(chance.choice((-1, 1)) * bound) + (symmetric(radius) if chance.random() < 0.5 else 0)
        least, most = bounds(other)
        assert is_positive(ball) is (low > 0)
        assert excludes_zero(ball) is (low > 0 or high < 0)
        assert sign(ball) == (1 if low > 0 else -1 if high < 0 else 0)
        assert is_below(ball, other) is (high < least)
        assert is_below(other, ball) is (most < low)
        # The bound is exact.
        assert is_inside(ball, bound) is (-bound < low and high < bound)
        assert is_outside(ball, bound) is (high < -bound or low > bound)
        for exponent in (Fraction(1, 2), Fraction(-1, 2), Fraction(5, 3)):
            assert power(ball, exponent).is_finite() is (low > 0)
        assert power(ball, Fraction(-2)).is_finite() is (low > 0 or high < 0)


def test_sums_powers_and_functions() -> None:
    chance = random.Random(1)
    vectors = numbers(3, chance), numbers(3, chance)
    for count in (1, 2, 4):
        left, right = numbers(count, chance), numbers(count, chance)
        assert agree(dot(left, right), sum((a * b for a, b in zip(left, right, strict=True)), arb(0)))
        assert agree(total(left), sum(left, arb(0)))
    assert not broken_inclusions(dot, vectors, chance)
    assert not broken_inclusions(lambda terms: total(iter(terms)), (numbers(4, chance),), chance)
    assert all(up_to(arb(0.7, 0.1)).contains(arb(value)) for value in (0, 0.59, 0.7, 0.799))
    for exponent in (Fraction(3), Fraction(-2), Fraction(-3, 2), Fraction(2, 3)):
        assert not broken_inclusions(lambda base, e=exponent: power(base, e), (arb(1.3),), chance)
    for name, function in FUNCTIONS.items():
        assert not broken_inclusions(function, (arb(0.8),), chance), name


def test_polynomials_near_a_point() -> None:
    chance = random.Random(2)

    def around(coefficients: list[arb], centre: arb, reach: arb) -> arb:
        return values_around(arb_poly(coefficients), centre, reach)

    assert not broken_inclusions(around, (numbers(5, chance), arb(0.4), arb(0.125)), chance, size=arb(1) / 4)
    polynomial = arb_poly(numbers(5, chance))
    for end in (arb(0.4) - 0.125, arb(0.4) + 0.125):
        assert agree(values_around(polynomial, arb(0.4), arb(0.125)), polynomial(end))


@pytest.mark.parametrize("size", [1, 2, 3])
def test_linear_equations(size: int) -> None:
    chance = random.Random(size)
    matrix, right = matrix_near(size, chance), numbers(size, chance)
    assert not broken_inclusions(newton_image, (matrix, right), chance, 10)
    for row in range(size):
        wide = [[ball + (i == row) * arb(0, 1) / 8 for ball in line] for i, line in enumerate(matrix)]
        assert max(entry for line in regularity_defect(wide) for entry in line) > arb(1) / 64
    if size == 1:
        return
    singular = [[sum((matrix[i][j] for j in range(size)), arb(0)) if j == 0 else ball for j, ball in enumerate(line)]
                for i, line in enumerate(matrix)]  # fmt: skip
    border = [arb(1), *numbers(size - 1, chance)]
    assert not broken_inclusions(lambda balls, row: left_kernel(balls, 0, row), (singular, border), chance, 10)


def graph_of(polynomials: Sequence[Any], sides: Sequence[arb], independent: int) -> ImplicitGraph:
    return ImplicitGraph(tuple(BoxFunction(table(each, sides)) for each in polynomials), tuple(sides), independent)


@pytest.mark.parametrize(("independent", "size"), [(1, 1), (2, 1), (1, 2), (2, 2)])
def test_graphs_of_zeros(independent: int, size: int) -> None:
    """By the independent variables, each coefficient of the equations, and the place where jets are asked for."""
    chance = random.Random(10 * independent + size)
    variables = independent + size
    sides = [arb(0, 1) * enclose(NARROW)] * variables
    polynomials = []
    for i in range(size):
        slopes = [chance.uniform(-0.5, 0.5) + (1.5 if j == independent + i else 0) for j in range(variables)]
        constant = {(0,) * variables: arb(chance.uniform(-NEAR, NEAR))}
        polynomials.append({**constant, **random_polynomial(variables, chance, slopes)})
    where = [arb(chance.uniform(-NEAR, NEAR)) for _ in range(independent)]
    parts = [arb(chance.uniform(-NEAR, NEAR)) + arb(0, 1) * NEAR for _ in range(size)]

    def over(polynomials: Any, where: Any) -> Any:
        return graph_of(polynomials, sides, independent).over(where)

    def image(polynomials: Any, where: Any) -> Any:
        graph = graph_of(polynomials, sides, independent)
        return graph.image(where), graph.image(where, [arb(0).union(part) for part in parts])

    for function in (over, image):
        assert not broken_inclusions(lambda where, f=function: f(polynomials, where), (where,), chance, size=FINE)
        by_polynomials = partial(
            broken_inclusions, lambda given, f=function: f(given, where), (polynomials,), chance, 4
        )
        assert not by_polynomials(size=FINE, where=lambda path: not any(path[-1]))
        assert not by_polynomials(size=COARSE, where=lambda path: sum(path[-1]) == 1)

    def jets(polynomials: Any, place: Any) -> Any:
        found = graph_of(polynomials, sides, independent).jets(place)
        return [jet.coefficients for jet in found], [derivatives_of(jet) for jet in found]

    place = [arb(chance.uniform(-NEAR, NEAR)) for _ in range(variables)]
    assert not broken_inclusions(lambda place: jets(polynomials, place), (place,), chance, size=FINE)
    assert not broken_inclusions(lambda given: jets(given, place), (polynomials,), chance, 3, size=COARSE)
    # Over all of the independent variables at once there is what is over each of their corners.
    graph = graph_of(polynomials, sides, independent)
    whole = graph.over([side / 4 for side in sides[:independent]])
    for _ in range(4):
        corner = [side.rad() / 4 * chance.choice((-1, 1)) for side in sides[:independent]]
        assert all(agree(a, b) for a, b in zip(whole, graph.over(corner), strict=True))


def test_taylor_forms_of_a_box() -> None:
    chance = random.Random(4)
    sides = [arb(0, 1) / 8, arb(0, 1) / 32, arb(0, 1)]
    polynomial = random_polynomial(3, chance, [0.5, -1.0, 2.0], 1.0)
    where = [side.rad() * chance.uniform(-0.9, 0.9) for side in sides]

    def found(polynomial: Any, where: Any) -> Any:
        function = BoxFunction(table(polynomial, sides))
        return function.value(where), function.gradient(where, 0), function.gradient(where, 1), (
            function.derivatives(where)
        )  # fmt: skip

    assert not broken_inclusions(found, (polynomial, where), chance, 10)
    assert not broken_inclusions(lambda where: found(polynomial, where), (where,), chance)


def test_jets_are_composed_and_solved_for() -> None:
    chance = random.Random(5)
    indices = list(random_polynomial(2, chance, [1.0, 1.0], 1.0))

    def jet(values: Sequence[arb]) -> Jet:
        return Jet(2, 3, dict(zip(indices, values, strict=True)))

    def products(left: Any, right: Any) -> Any:
        a, b = jet(left), jet(right)
        return [each.coefficients for each in (a * b, a + b, a.scaled(right[0]))]

    left, right = numbers(len(indices), chance), numbers(len(indices), chance)
    assert not broken_inclusions(products, (left, right), chance)
    scaled = jet(left).scaled(right[0])
    assert all(agree(scaled[index], ball * right[0]) for index, ball in zip(indices, left, strict=True))
    derivatives = {index: arb(chance.uniform(-1, 1)) for index in [(0, 0), *indices]}
    assert agree(compose(derivatives, [jet(left), jet(right)])[0, 0], derivatives[0, 0])
    assert not broken_inclusions(
        lambda outer, one, other: compose(outer, [jet(one), jet(other)]).coefficients,
        (derivatives, left, right),
        chance,
    )
    functions = [random_polynomial(3, chance, [chance.uniform(-1, 1), 2.0, -0.5], 1.0),
                 random_polynomial(3, chance, [chance.uniform(-1, 1), 0.3, 1.5], 1.0)]  # fmt: skip
    whole = [{index: each.get(index, arb(0)) for index in table(each, [arb(0)] * 3).box} for each in functions]
    assert not broken_inclusions(
        lambda balls: [each.coefficients for each in implicit_jets(balls, 1, 3)], (whole,), chance, 14
    )


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_zero_in_a_box(size: int) -> None:
    chance = random.Random(size)
    matrix, bent = matrix_near(size, chance), numbers(size, chance, 0.5)
    zero = numbers(size, chance, NEAR)
    radii = [NARROW] * size

    def found(matrix: Any, bent: Any, residual: Any) -> Any:
        def over(where: Sequence[arb]) -> list[list[arb]]:
            return [
                [ball + (2 * bent[i] * where[i] if i == j else 0) for j, ball in enumerate(row)]
                for i, row in enumerate(matrix)
            ]

        def check(checklist: Checklist) -> list[arb]:
            with checklist.hypothesis("zero", "7.5", "there is one", "") as evidence:
                return enclose_zero(evidence, over, residual, radii, [f"p_{place}" for place in range(size)])
            raise AssertionError

        return checked(check)

    residual = [-dot(row, zero) - b * z * z for row, b, z in zip(matrix, bent, zero, strict=True)]
    assert not broken_inclusions(lambda given: found(given, bent, residual), (matrix,), chance, size=COARSE)
    assert not broken_inclusions(lambda given: found(matrix, bent, given), (residual,), chance, size=FINE)

    def proves(given: Any) -> bool:
        try:
            found(matrix, bent, given)
        except NotEstablishedError:
            return False
        return True

    assert not unsound_balls(proves, residual, chance)


def a_set(chance: random.Random, variables: int) -> StartingSet:
    centre = tuple(random_fraction(chance, 2) for _ in range(3))
    frame = tuple(tuple(random_fraction(chance) for _ in range(variables)) for _ in centre)
    return StartingSet(2, centre, frame, (NARROW,) * variables)


def test_functions_of_an_image_and_their_zeros() -> None:
    chance = random.Random(6)
    start = a_set(chance, 2)
    sides = [enclose(radius) * arb(0, 1) for radius in start.radii]
    factors, own = (
        [random_fraction(chance, 3) for _ in "ab"],
        [3 + random_fraction(chance), -2 + random_fraction(chance)],
    )
    polynomials = [random_polynomial(2, chance, [1.0, 0.3], 1.0), random_polynomial(2, chance, [-0.2, 1.2], 1.0)]
    for each in polynomials:
        each[0, 0] = arb(chance.uniform(-NEAR, NEAR))

    def combined(polynomials: Any) -> Any:
        tables = [table(each, sides) for each in polynomials]
        return combination(start, tables, factors, own, Fraction(1, 3))

    assert not broken_inclusions(combined, (polynomials,), chance)
    for corner in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        at = [side.rad() * sign for side, sign in zip(sides, corner, strict=True)]
        values = [derivative(each, (0, 0), at) for each in polynomials]
        exact = dot(list(map(enclose, factors)), values) + dot(list(map(enclose, own)), at) + arb(1) / 3
        assert agree(combined(polynomials).box[0, 0], exact)
    for number in (1, 2):

        def zeros(polynomials: Any, number: int = number) -> Any:
            found = enclose_zeros([table(each, sides) for each in polynomials], start.radii)
            return found.at, found.graph.over([arb(NEAR)] * (2 - number))

        for size, degree in ((FINE, 0), (COARSE, 1)):

            def of_degree(path: Path, degree: int = degree) -> bool:
                return sum(path[-1]) == degree

            assert not broken_inclusions(zeros, (polynomials[-number:],), chance, size=size, where=of_degree)

        def proves(polynomials: Any, zeros: Any = zeros) -> bool:
            try:
                zeros(polynomials)
            except IntegrationFailure:
                return False
            return True

        assert not unsound_balls(proves, polynomials[-number:], chance, 6, where=lambda path: sum(path[-1]) < 2)


def test_a_displacement_is_the_image_less_the_point() -> None:
    """P(x) - x on a box of the section, and again on narrower parts: tables of x are exact."""
    chance = random.Random(7)
    section = AffineSection((Fraction(0), Fraction(1)), Fraction(3, 4))
    centre, column = (Fraction(5, 4), Fraction(3, 4), Fraction(2)), (Fraction(-3, 2), Fraction(0), Fraction(0))
    start = StartingSet(2, centre, tuple((entry,) for entry in column), (Fraction(1, 16),))
    arithmetic = start.arithmetic(Format(120, 2))
    a, b, c = (random_fraction(chance) for _ in "abc")
    s = start.scales[0]
    x = arithmetic.polynomial({(0,): a, (1,): b * s, (2,): c * s * s})
    image = image_of(start, [x, arithmetic.constant(section.offset)], arithmetic.constant(Fraction(1)), 1)
    (moved,) = displacement(start, section, image)
    for side in (-1, 0, 1, HALF):
        p = side * start.radii[0]
        exact = a + b * p + c * p * p - (start.centre[0] + start.frame[0][0] * p)
        assert agree(moved.box[0,], enclose(exact))
        assert agree(BoxFunction(moved).value([enclose(p)]), enclose(exact))
        assert agree(moved.box[1,], enclose(b + 2 * c * p - start.frame[0][0]))
    assert moved.box[0,].rad() < 1


def test_the_time_of_a_crossing_is_that_of_all_steps_and_of_the_delay() -> None:
    """Of the steps in a ball, of the delay as an element: at both ends of the ball, at all points of the set."""
    chance = random.Random(8)
    start = a_set(chance, 1)
    arithmetic = start.arithmetic(Format(120, 1))
    delay = arithmetic.polynomial({(0,): Fraction(1, 3), (1,): Fraction(1, 4)}).widened(Fraction(1, 64))
    time = arb(5) / 2 + arb(0, 1) / 8
    orbits: Any = SimpleNamespace(time=time, arithmetic=arithmetic, delay=delay)
    found = range_of(time_at_crossing(orbits))
    for by in (-1, 1):
        for edge in (-1, 1):
            exact = Fraction(5, 2) + Fraction(by, 8) + Fraction(1, 3) + Fraction(edge, 4) + Fraction(by, 64)
            assert agree(found, enclose(exact))
    assert found.rad() < 0.4


@pytest.mark.parametrize("width", [0, 2])
def test_elements_on_parts_of_their_interval(width: int) -> None:
    """Values of an element at real points of the set, s on a part of its interval, theta on a part of the step."""
    chance = random.Random(width)
    grading = Grading((1, 2), 3)
    arithmetic: Arithmetic = WideArithmetic(grading, 120, 0, 3, 0, width) if width else Arithmetic(grading, 120, 0, 3)
    terms = {index: [random_fraction(chance, 0.2) for _ in range(width + 1)] for index in grading.monomials}
    element = arithmetic.polynomial(terms).widened(Fraction(1, 128))
    exact = dict(terms)

    def value(xi: Sequence[Fraction], s: Fraction) -> Fraction:
        return sum(
            (
                sum((c * s**n for n, c in enumerate(row)), Fraction(0))
                * prod((x**e for x, e in zip(xi, index, strict=True)), start=Fraction(1))
                for index, row in exact.items()
            ),
            Fraction(0),
        )

    for number in (4, 8):
        ends = [(part.mid() - part.rad(), part.mid() + part.rad()) for part in wide_parts(number)]
        assert ends[0][0] <= -1
        assert ends[-1][1] >= 1
        assert all(a[1] >= b[0] for a, b in itertools.pairwise(ends))
    for part in wide_parts(4) if width else [None]:
        found, on_step = range_of(element, part), InTime(element, part).value(arb(0, 1))
        for _ in range(20):
            xi = [random_fraction(chance) for _ in range(2)]
            shape = chance.choice((-1, 1)) if chance.random() < 0.5 else random_fraction(chance)
            s = Fraction(0) if part is None else Fraction(str(float(part.mid()))) + Fraction(1, 4) * shape
            at = value(xi, s) + Fraction(chance.choice((-1, 1)), 128)
            assert agree(found, enclose(at))
            assert agree(on_step, enclose(at))


def test_an_element_stays_positive_for_all_points_or_is_not_said_to() -> None:
    """c + a xi + b s + e, all of them at their worst together: positive just if c exceeds what they take."""
    for width in (0, 1):
        arithmetic: Arithmetic = (
            WideArithmetic(Grading((1,), 1), 120, 0, 2, 0, 1) if width else Arithmetic(Grading((1,), 1), 120, 0, 2)
        )
        for xi, s, unknown in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)):
            s *= width
            least = Fraction(xi + s + unknown, 8)
            for c in (least + Fraction(1, 256), least - Fraction(1, 256)):
                row = [c, Fraction(-s, 8)][: 1 + width]
                element = arithmetic.polynomial({(0,): row, (1,): Fraction(xi, 8)}).widened(Fraction(unknown, 8))
                part = arb(0, 1) if width else None
                assert stays_positive(element, part) is (c > least), (width, xi, s, unknown)


def test_derivatives_on_a_box_are_those_of_all_that_is_known_and_unknown() -> None:
    chance = random.Random(9)
    grading = Grading((1, 2), 3)
    coefficients = numbers(len(grading.monomials), chance)
    scales = [Fraction(3, 8), Fraction(-1, 1) + Fraction(3, 2)]

    def found(coefficients: Any) -> Any:
        return table_of(grading, coefficients, [0.0] * 5, scales, Fraction(1, 4))

    assert not broken_inclusions(found, (coefficients,), chance)
    # At the edges of the box, exactly.
    whole = found(coefficients)
    exact = dict(zip(grading.monomials, coefficients, strict=True))
    for _ in range(12):
        xi = [Fraction(1, 4) * chance.choice((-1, 1, Fraction(1, 3))) for _ in range(2)]
        for index in whole.box:
            value = arb(0)
            for powers, coefficient in exact.items():
                if all(p >= i for p, i in zip(powers, index, strict=True)):
                    factor = prod((prod(range(p - i + 1, p + 1)) * x ** (p - i)
                                   for p, i, x in zip(powers, index, xi, strict=True)), start=Fraction(1))  # fmt: skip
                    value += coefficient * enclose(factor)
            for scale, i in zip(scales, index, strict=True):
                value = value / enclose(scale**i)
            assert agree(whole.box[index], value), index


def test_taylor_coefficients_of_functions_and_the_bound_of_the_rest() -> None:
    """Each is phi^(k)(e)/k! within its ball, and no later one is larger than the bound."""
    middles = {"sin": Fraction(1, 3), "cos": Fraction(-5, 7), "exp": Fraction(-2, 3), "log": Fraction(5, 3)}
    for name, middle in middles.items():
        for last in (1, 3, 6):
            coefficients, bound = _taylor(name, middle, last)
            with ctx.workprec(300):
                more, _ = _taylor(name, middle, last + 5)
            assert len(coefficients) == last + 1
            assert all(agree(a, b) for a, b in zip(coefficients, more, strict=False))
            assert all(abs(each) < bound * 1.001 for each in more[last + 1 :]), name
            with ctx.workprec(300):
                assert agree(coefficients[0], getattr(enclose(middle), name)())


def test_a_level_has_one_coordinate_in_its_interval() -> None:
    """H = (vx^2 + vy^2 + x^2 + c y^2)/2 + a x^2 y - y^3/3, its level and dH/dy = c y + a x^2 - y^2."""
    system = define_system({
        "name": "brakes", "state": "x y vx vy", "parameters": "c a", "R": {"vx": -1, "vy": -1}, "section": "vy",
        "field": {"x": "vx", "y": "vy", "vx": "-x - 2*a*x*y", "vy": "-c*y - a*x**2 + y**2"},
        "first_integral": "(vx**2 + vy**2 + x**2 + c*y**2)/2 + a*x**2*y - y**3/3", "family_parameter": "a",
        "level_coordinate": "y", "fixed_level": {"value": "1/12", "between": ["-1", "-1/10"]},
    })  # fmt: skip
    chance = random.Random(10)
    # On the second interval, and on the third, the derivative is enclosed on parts, on each by other balls.
    for c, low, high in ((arb(1.1), "-1", "-1/10"), (arb(3), "1/10", "9/10"), (arb(-3), "-9/10", "-1/10")):
        ends = Fraction(low), Fraction(high)
        equation = LevelEquation.of(replace(system, fixed_level=FixedLevel(Fraction(1, 12), between=ends)))
        arguments = [arb(0.3), arb(0.1), arb(0.7), arb(-0.4), c, arb(0.9)]
        assert not broken_inclusions(equation.at, (arguments, enclose(sum(ends) / 2)), chance)
        slope = equation.slope(arguments)
        assert slope is not None
        assert excludes_zero(slope)
        for w in (enclose(ends[0] + (ends[1] - ends[0]) * share / 8) for share in range(9)):
            assert slope.contains(equation.at(arguments, w)[1].mid())
    level = FixedLevel(Fraction(2), between=(HALF, Fraction(2)))
    assert is_in(level, arb(1.25, 0.74))
    assert not is_in(level, arb(1.25, 0.76))
    assert not is_in(level, arb(1.5, 0.51))
    assert not is_in(level, arb(1, 0.51))
