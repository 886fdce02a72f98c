"""The parts of maps of any system: sets, coordinates of affine sections, numbers of crossings, combinations, zeros."""

from __future__ import annotations

import random
from fractions import Fraction
from math import prod

import pytest
from flint import arb, ctx, fmpq
from support.flow_checks import contains, random_fraction, series_at
from support.within import within

from orbitproof.shared import define_system
from orbitproof.verify.algebra import Arithmetic, Grading
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, indices_up_to
from orbitproof.verify.maps import (
    AffineSection,
    Format,
    FramingOracle,
    StartingSet,
    combination,
    enclose_flow,
    enclose_poincare_map,
    enclose_zeros,
    flow_map,
    framed_orbits,
    image_of,
)
from orbitproof.verify.maps.poincare_map import number_of
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.approximations import Approximations
from orbitproof.verify.poincare.functions import function_of

SYSTEM = define_system(
    {"name": "any", "state": "x y z", "parameters": "a", "field": {"x": "y/z", "y": "a*x - z", "z": "x*y**2 + 1"}}
)

_bits = within(lambda: ctx.workprec(200))


def random_set(source: random.Random, variables: int, size: int = 3, parameters: int = 1) -> StartingSet:
    """Numbers with few bits."""
    centre = tuple(random_fraction(source, 2) for _ in range(size + parameters))
    frame = tuple(tuple(random_fraction(source) for _ in range(variables)) for _ in centre)
    return StartingSet(size, centre, frame, tuple(Fraction(source.randint(1, 99), 100) for _ in range(variables)))


def random_section(source: random.Random, size: int = 3) -> AffineSection:
    """Some coefficients are 0."""
    normal = [source.choice((0, 1)) * random_fraction(source) for _ in range(size)]
    normal[source.randrange(size)] = source.choice((-1, 1)) * (random_fraction(source) + 2)
    return AffineSection(tuple(map(Fraction, normal)), random_fraction(source))


def test_elements_are_the_points_of_the_set() -> None:
    source = random.Random(1)
    for variables in (0, 1, 2, 3):
        start = random_set(source, variables)
        arithmetic = start.arithmetic(Format(100, 2))
        elements = [x for group in start.elements(arithmetic) for x in group]
        for _ in range(20):
            xi = [random_fraction(source) for _ in range(variables)]
            p = [x * scale for x, scale in zip(xi, start.scales, strict=True)]
            for element, middle, row in zip(elements, start.centre, start.frame, strict=True):
                value = middle + sum((a * x for a, x in zip(row, p, strict=True)), Fraction(0))
                assert contains(series_at(element, Fraction(0), xi), value)
                assert series_at(element, Fraction(0), xi).rad() < 1e-25
        assert all(scale == 4 * radius for scale, radius in zip(start.scales, start.radii, strict=True))


def test_coordinates_of_a_section_follow_the_same_orbits() -> None:
    source = random.Random(2)
    for _ in range(40):
        section = random_section(source)
        coordinates = section.coordinates(SYSTEM.program)
        k = section.pivot
        assert abs(section.normal[k]) == max(map(abs, section.normal))
        state = [random_fraction(source) + 2 for _ in range(3)]
        y = sum((a * x for a, x in zip(section.normal, state, strict=True)), Fraction(0)) - section.offset
        moved = [*state[:k], y, *state[k + 1 :]]
        parameter = random_fraction(source)
        slopes = SYSTEM.program.evaluate([*state, parameter], Fraction, lambda base, power: base ** int(power))
        along = sum((a * slope for a, slope in zip(section.normal, slopes, strict=True)), Fraction(0))
        expected = [*slopes[:k], along, *slopes[k + 1 :]]
        found = coordinates.field.evaluate([*moved, parameter], Fraction, lambda base, power: base ** int(power))
        assert found == expected
        assert coordinates.section == k
        arithmetic = StartingSet(3, (), (), ()).arithmetic(Format(100, 1))
        own = section.own_state([arithmetic.constant(value) for value in moved])
        assert all(contains(series_at(x, Fraction(0), ()), value) for x, value in zip(own, state, strict=True))


def test_a_set_lies_on_a_section_exactly_or_not_at_all() -> None:
    source = random.Random(3)
    for _ in range(40):
        section, start = random_section(source), random_set(source, 2)
        k = section.pivot
        assert not section.holds(start)

        def on(row: list[Fraction], value: Fraction, section: AffineSection = section, k: int = k) -> Fraction:
            others = sum(
                (a * x for i, (a, x) in enumerate(zip(section.normal, row, strict=True)) if i != k), Fraction(0)
            )
            return (value - others) / section.normal[k]

        centre, columns = list(start.centre), [[row[j] for row in start.frame] for j in range(2)]
        centre[k] = on(centre[:3], section.offset)
        for column in columns:
            column[k] = on(column[:3], Fraction(0))
        frame = tuple(zip(*columns, strict=True))
        there = StartingSet(3, tuple(centre), frame, start.radii)
        assert section.holds(there)
        arithmetic = there.arithmetic(Format(64, 2))
        element = section.section_coordinate(there, arithmetic)
        assert not any(element.norm()[:-1][i] > 1e-200 for i in range(3))
        beside = StartingSet(3, (*centre[:k], centre[k] + Fraction(1, 2**300), *centre[k + 1 :]), frame, start.radii)
        assert not section.holds(beside)
        tilted = [list(row) for row in frame]
        tilted[k][1] += Fraction(1, 2**300)
        assert not section.holds(StartingSet(3, tuple(centre), tuple(map(tuple, tilted)), start.radii))


def test_numbers_of_crossings_in_a_direction() -> None:
    for side in (-1, 1):
        directions = [-side * (-1) ** i for i in range(12)]
        for direction in (-1, 1):
            places = [i + 1 for i, each in enumerate(directions) if each == direction]
            assert [number_of(n, direction, side) for n in range(1, 7)] == places
        assert [number_of(n, 0, side) for n in range(1, 7)] == [1, 2, 3, 4, 5, 6]


def polynomial_table(coefficients: dict[tuple[int, ...], Fraction], radii: tuple[Fraction, ...]) -> DerivativeTable:
    """The derivatives of a polynomial of degree 1 in two variables."""
    zero, units = (0, 0), ((1, 0), (0, 1))
    at = {index: arb(0) for index in indices_up_to(2, 3)}
    for index, value in coefficients.items():
        at[index] = arb(value.numerator) / value.denominator
    box = dict(at)
    for unit, radius in zip(units, radii, strict=True):
        box[zero] = box[zero] + at[unit] * arb(0, float(radius))
    return DerivativeTable(box, at)


def test_a_combination_has_the_derivatives_of_the_sum() -> None:
    source = random.Random(4)
    for _ in range(20):
        start = random_set(source, 2)
        pair = [
            {(0, 0): random_fraction(source), (1, 0): random_fraction(source), (0, 1): random_fraction(source)}
            for _ in "ab"
        ]
        factors, own, constant = (
            [random_fraction(source) for _ in "ab"],
            [random_fraction(source) for _ in "ab"],
            random_fraction(source),
        )
        table = combination(start, [polynomial_table(each, start.radii) for each in pair], factors, own, constant)
        for _ in range(20):
            p = [random_fraction(source, radius) for radius in start.radii]
            value = constant + sum((a * x for a, x in zip(own, p, strict=True)), Fraction(0))
            for factor, each in zip(factors, pair, strict=True):
                value += factor * (each[0, 0] + each[1, 0] * p[0] + each[0, 1] * p[1])
            assert contains(table.box[0, 0], value, Fraction(1, 10**12))
        middle = constant + sum((f * each[0, 0] for f, each in zip(factors, pair, strict=True)), Fraction(0))
        assert contains(table.centre[0, 0], middle, Fraction(1, 10**12))
        for j, unit in enumerate(((1, 0), (0, 1))):
            slope = own[j] + sum((f * each[unit] for f, each in zip(factors, pair, strict=True)), Fraction(0))
            assert contains(table.box[unit], slope, Fraction(1, 10**12))
            assert contains(table.centre[unit], slope, Fraction(1, 10**12))


def test_zeros_are_proved_in_the_set_only() -> None:
    radii = (Fraction(1), Fraction(1))
    first = polynomial_table({(0, 0): Fraction(1, 2), (1, 0): Fraction(1)}, radii)
    second = polynomial_table({(0, 0): Fraction(-1, 4), (1, 0): Fraction(1, 3), (0, 1): Fraction(1)}, radii)
    zeros = enclose_zeros([first, second], radii)
    assert contains(zeros.at[0], Fraction(-1, 2), Fraction(1, 10**12))
    assert contains(zeros.at[1], Fraction(5, 12), Fraction(1, 10**12))
    graph = enclose_zeros([second], radii)
    assert contains(graph.graph.over([arb(1) / 2])[1], Fraction(1, 12), Fraction(1, 10**12))
    outside = polynomial_table({(0, 0): Fraction(3, 2), (1, 0): Fraction(1)}, radii)
    beyond = polynomial_table({(0, 0): Fraction(1), (1, 0): Fraction(1)}, radii)
    flat = polynomial_table({(0, 0): Fraction(0)}, radii)
    for functions, words in (
        ([outside, second], "no zero"),
        ([beyond, second], "may lie outside"),
        ([first, flat], "may be singular on the set"),
        ([], "may be singular on the set"),
    ):
        with pytest.raises(IntegrationFailure, match=words):
            enclose_zeros(functions, radii)


@pytest.mark.parametrize("unknowns", [1, 2])
def test_every_unknown_stays_within_its_own_half_width(unknowns: int) -> None:
    """Zeros of affine functions: the farthest one is known exactly."""
    source = random.Random(unknowns)
    verdicts = set()
    for _ in range(60):
        radii = tuple(Fraction(source.choice((1, 4, 16)), 4) for _ in range(2))
        rows, reaches = [], []
        for place in range(2 - unknowns, 2):
            at, slope = Fraction(source.randint(-20, 20), 7), Fraction(source.randint(-9, 9), 7)
            # p_place = at + slope p_0, or at where nothing is independent.
            rows.append({(0, 0): -at, (0, 1) if place else (1, 0): Fraction(1)})
            if unknowns == 1:
                rows[-1][1, 0] = -slope
            reaches.append(abs(at) + (abs(slope) * radii[0] if unknowns == 1 else 0))
        inside = all(reach < radius for reach, radius in zip(reaches, radii[2 - unknowns :], strict=True))
        tables = [polynomial_table(row, radii) for row in rows]
        if inside:
            enclose_zeros(tables, radii)
        else:
            with pytest.raises(IntegrationFailure):
                enclose_zeros(tables, radii)
        verdicts.add(inside)
    assert verdicts == {True, False}


@pytest.mark.parametrize("name", ["sin", "cos", "exp", "log"])
def test_functions_of_elements_contain_the_functions_of_their_values(name: str) -> None:
    source = random.Random(name)
    for _ in range(30):
        variables = source.randint(0, 3)
        grading = Grading((1,) * variables, source.randint(1, 3))
        arithmetic = Arithmetic(grading, 90, 0, 4)
        size = Fraction(source.choice((1, 8, 64)), 200)
        terms = {index: random_fraction(source, size / 10 ** (sum(index) - 1)) for index in grading.monomials}
        terms[(0,) * variables] = (Fraction(1, 2) + abs(random_fraction(source, 3))) * (
            1 if name == "log" else source.choice((1, -1))
        )
        unknown = Fraction(source.choice((0, 1)), 2**20)
        element = arithmetic.polynomial(terms).widened(unknown)
        if element.norm()[0] == 0 or sum(element.norm()[1:]) > 0.2:
            continue
        found = function_of(name, element)
        for _ in range(20):
            xi = [random_fraction(source) for _ in range(variables)]
            exact = sum(
                (
                    value * prod((x**n for x, n in zip(xi, index, strict=True)), start=Fraction(1))
                    for index, value in terms.items()
                ),
                random_fraction(source, unknown),
            )
            value = getattr(arb(fmpq(exact.numerator, exact.denominator)), name)()
            near = series_at(found, Fraction(0), xi)
            assert (abs(value - near.mid()) <= near.rad() + arb(2) ** -150) is True
            assert near.rad() < 3
    precise = function_of(name, Arithmetic(Grading((), 1), 90, 0, 4).constant(Fraction(5, 4)))
    assert series_at(precise, Fraction(0), ()).rad() < 1e-25
    with pytest.raises(IntegrationFailure, match="not enclosed"):
        function_of(name, Arithmetic(Grading((1,), 1), 90, 0, 4).polynomial({(0,): Fraction(1), (1,): Fraction(2)}))


def test_an_integration_ends_after_a_number_of_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    point = StartingSet(2, (Fraction(1), Fraction(0)), ((), ()), ())
    circle = define_system({"name": "circle", "state": "x y", "field": {"x": "y", "y": "-x"}})
    assert enclose_flow(circle.program, point, Fraction(12), Format(64, 1), ORACLE).steps > 2
    monkeypatch.setattr(flow_map, "MOST_STEPS", 2)
    with pytest.raises(IntegrationFailure, match="not reached within 2 steps"):
        enclose_flow(circle.program, point, Fraction(12), Format(64, 1), ORACLE)


def test_a_return_may_take_as_many_steps_as_an_approximation_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stiff orbits need thousands of them; those that do not come back are given up soon, whatever an oracle says."""

    def steps(field: dict[str, str], oracle: FramingOracle) -> int:
        system = define_system({"name": "any", "state": "x y", "field": field})
        point = StartingSet(2, (Fraction(1), Fraction(0)), ((), ()), ())
        section = AffineSection((Fraction(0), Fraction(1)), Fraction(0))
        return enclose_poincare_map(system.program, point, section, -1, 1, Format(64, 1), oracle).steps

    class Endless(Approximations):
        def further_steps(self, *_: object) -> int:
            return 10**9

    class Mute(Approximations):
        def further_steps(self, *_: object) -> int:
            return -1

    circle, comes_to_rest = {"x": "y", "y": "-x"}, {"x": "y", "y": "-x - 3*y"}
    assert steps(circle, Mute()) > 3
    monkeypatch.setattr(framed_orbits, "MOST_STEPS", 1)
    assert steps(circle, ORACLE) > 3
    for field, oracle, many in ((circle, Mute(), 2), (comes_to_rest, ORACLE, 2), (comes_to_rest, Endless(), 9)):
        monkeypatch.setattr(framed_orbits, "MOST_EXPECTED", 7)
        with pytest.raises(IntegrationFailure, match=f"was not reached within {many} steps"):
            steps(field, oracle)


def test_what_has_no_bound_is_not_enclosed() -> None:
    start = random_set(random.Random(5), 2)
    arithmetic = start.arithmetic(Format(64, 1))
    state, _ = start.elements(arithmetic)
    endless = [float("inf"), 0.0, 0.0]
    with pytest.raises(IntegrationFailure, match="finite"):
        image_of(start, [state[0].with_errors(endless)], arithmetic.constant(Fraction(1)), 1)
    tiny = StartingSet(3, start.centre, start.frame, (Fraction(1, 10**300), Fraction(1)))
    with pytest.raises(IntegrationFailure, match="floats"):
        tiny.arithmetic(Format(64, 2))
    far = define_system({"name": "far", "state": "x y", "field": {"x": "y", "y": "-x"}})
    point = StartingSet(2, (Fraction(1), Fraction(0)), ((), ()), ())
    with pytest.raises(IntegrationFailure, match=r"not reached|tube"):
        enclose_flow(far.program, point, Fraction(10**9), Format(64, 1), ORACLE)
