"""Whatever finds the approximate solution of a step, it is refused or the enclosure holds (sections 3.2 and 3.3)."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import fmpz_poly
from support.exact_elements import is_enclosed, known_value, random_point
from support.within import within

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Grading, PreparedProgram, Series, WideArithmetic, prepare
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import FlowStep, advance
from orbitproof.verify.oracle.wide_solution import expand

STEP = Fraction(1, 8)


def _rotations(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
    a, b, c, d = state
    slow = (a * a + b * b) ** Fraction(-3, 2)
    fast = slow + (c * c + d * d) / 3
    return (-(slow * b), slow * a, -(fast * d), fast * c)


ROTATIONS = ReversibleSystem(
    name="rotations",
    title="two rotations, the first as in the Kepler problem",
    state=("a", "b", "c", "d"),
    parameters={},
    vector_field=_rotations,
    reversing_symmetry=(1, -1, 1, -1),
    section="b",
    first_integral=lambda x, _: (x[0] * x[0] + x[1] * x[1],),
)

FORMATS = {
    "narrow": Arithmetic(Grading((1, 2), 2), 60, 8, 14),
    "wide": WideArithmetic(Grading((1,), 1), 60, 12, 14, width=6),
}

_precision = within(lambda: mpmath.workprec(200))


def rotated(start: Sequence[Any], time: Any) -> list[Any]:
    """The exact solution; radii are constant."""
    a, b, c, d = start
    slow = mpmath.power(a * a + b * b, mpmath.mpf(-3) / 2)
    angles = slow * time, (slow + (c * c + d * d) / 3) * time
    result = []
    for (x, y), angle in zip(((a, b), (c, d)), angles, strict=True):
        result += [x * mpmath.cos(angle) - y * mpmath.sin(angle), x * mpmath.sin(angle) + y * mpmath.cos(angle)]
    return result


def initial(arithmetic: Arithmetic) -> list[Series]:
    """Known values around (1, 0.1, 0.5, -0.2)."""
    monomials = arithmetic.grading.monomials
    small = [Fraction(1, 64), Fraction(-1, 128), Fraction(1, 256)]
    values = []
    for i, centre in enumerate((Fraction(1), Fraction(1, 8), Fraction(1, 2), Fraction(-1, 4))):
        terms: dict[Any, Any] = {m: small[(i + j) % 3] for j, m in enumerate(monomials[1:])}
        terms[monomials[0]] = [centre, small[i % 3]] if arithmetic.width else centre
        values.append(arithmetic.polynomial(terms))
    return values


class Hostile:
    """An expansion that gives something else than what it has found."""

    def __init__(self, honest: Any, spoil: Callable[[int, list[fmpz_poly]], Sequence[Any]]) -> None:
        self._honest, self._spoil = honest, spoil

    def solve(self, along: Any, step: Fraction) -> None:
        self._along = along
        self._honest.solve(self, step)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._along, name)

    def give(self, coefficients: Sequence[fmpz_poly]) -> None:
        self._along.give(self._spoil(self._along.position, [fmpz_poly(p) for p in coefficients]))


def advanced(name: str, spoil: Callable[[int, list[fmpz_poly]], Sequence[Any]], step: Fraction = STEP) -> FlowStep:
    return followed(name, lambda honest: Hostile(honest, spoil), step)


def followed(name: str, hostile: Callable[[Any], Any], step: Fraction = STEP) -> FlowStep:
    """One step with what is made of the honest expansion."""
    arithmetic = FORMATS[name]
    program: PreparedProgram = prepare(ROTATIONS.program)
    state = initial(arithmetic)
    return advance(program, state, [], hostile(expand(program, arithmetic, state, [])), step)


def holds(name: str, flow: FlowStep, source: random.Random, count: int = 3) -> bool:
    """Whether exact solutions lie in the enclosures over the step and at its end."""
    arithmetic = FORMATS[name]
    for _ in range(count):
        theta, t, point = random_point(source, arithmetic.grading, wide=bool(arithmetic.width))
        start = [known_value(x, mpmath.mpf(0), point) for x in initial(arithmetic)]
        for when, enclosures in ((theta, flow.solution), (mpmath.mpf(1), flow.end)):
            exact = rotated(start, when * mpmath.mpf(STEP.numerator) / STEP.denominator)
            if not all(is_enclosed(x, value, when, t, point) for x, value in zip(enclosures, exact, strict=True)):
                return False
    return True


def lost(flow: FlowStep) -> float:
    """The errors of the grades that are kept."""
    return max(sum(x.errors[:-1]) for x in flow.end)


def changed(source: random.Random, arithmetic: Arithmetic, polynomial: fmpz_poly, first: int) -> fmpz_poly:
    """A polynomial with one coefficient changed, from number `first` on, of those that are kept or just beyond."""
    place = source.randrange(first, (arithmetic.degree + 3) * arithmetic.stride)
    values = polynomial.coeffs() + [0] * (place + 1 - polynomial.length())
    values[place] += source.choice((-1, 1)) * 2 ** source.choice((0, 20, 40, 50, 56))
    return fmpz_poly(values)


@pytest.mark.parametrize("name", FORMATS)
def test_an_honest_approximation_is_sharp(name: str) -> None:
    flow = advanced(name, lambda _, column: column)
    assert holds(name, flow, random.Random(name), 10)
    assert lost(flow) < 1e-9


@pytest.mark.parametrize("number", [40, pytest.param(400, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", FORMATS)
def test_a_changed_coefficient_is_refused_or_in_the_errors(name: str, number: int) -> None:
    """Any coefficient of any monomial and component, by 1 to 2^56 units of 2^-60, also at powers that are not kept."""
    source, arithmetic = random.Random(name), FORMATS[name]
    accepted = 0
    for _ in range(number):
        where = source.randrange(len(arithmetic.grading.monomials)), source.randrange(4)
        first = source.choice((0, arithmetic.stride))

        def spoil(position: int, column: list[fmpz_poly], where: Any = where, first: int = first) -> list[fmpz_poly]:
            if position == where[0]:
                column[where[1]] = changed(source, arithmetic, column[where[1]], first)
            return column

        try:
            flow = advanced(name, spoil)
        except (ValueError, IntegrationFailure):
            continue
        accepted += 1
        assert holds(name, flow, source)
    assert accepted > number // 8


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("what", ["exchanged", "doubled", "constant", "nothing later", "those of the centre"])
def test_other_functions_are_refused_or_in_the_errors(name: str, what: str) -> None:
    arithmetic, kept = FORMATS[name], []

    def spoil(position: int, column: list[fmpz_poly]) -> list[fmpz_poly]:
        kept.append(column)
        starts = [p.truncate(arithmetic.stride) for p in column]
        later = [p - start for p, start in zip(column, starts, strict=True)]
        if what == "exchanged":
            later.reverse()
        elif what == "doubled":
            later = [p * 2 for p in later]
        elif what == "constant" or position:
            later = [p * 0 for p in later] if what != "those of the centre" else [p - p[0] for p in kept[0]]
        return [p + start for p, start in zip(later, starts, strict=True)]

    try:
        flow = advanced(name, spoil)
    except (ValueError, IntegrationFailure):
        return
    assert holds(name, flow, random.Random(what), 5)
    assert lost(flow) > 1e-6


@pytest.mark.parametrize("name", FORMATS)
def test_what_is_changed_after_it_was_given_does_not_count(name: str) -> None:
    """Polynomials of FLINT can be changed in place."""
    given: list[fmpz_poly] = []

    def spoil(_: int, column: list[fmpz_poly]) -> list[fmpz_poly]:
        for polynomial in given:
            polynomial[FORMATS[name].stride] = 10**17
        given.extend(column)
        return column

    flow = advanced(name, spoil)
    assert holds(name, flow, random.Random(name), 5)
    assert lost(flow) < 1e-9


def test_what_was_looked_at_can_be_changed_without_harm() -> None:
    """The values at the centre and what is tried out are copies, so the field stays that of what was given."""

    class Vandal(Hostile):
        def centre(self) -> Any:
            for values in (found := self._along.centre())[0]:
                values[1] = 10**17
            for values in found[1].values():
                values[0] = 1
            return self._along.centre()

        def trial(self, position: int, column: Sequence[fmpz_poly]) -> Any:
            for polynomial in self._along.trial(position, column):
                polynomial[2] = 10**17
            return self._along.trial(position, column)

    flow = followed("narrow", lambda honest: Vandal(honest, lambda _, column: column))
    assert holds("narrow", flow, random.Random("vandal"), 5)
    assert lost(flow) < 1e-9


@pytest.mark.parametrize("name", FORMATS)
def test_what_is_tried_out_changes_nothing_and_has_its_turn(name: str) -> None:
    """Trials of any coefficients, of this monomial and of others of its grade; never before those of lower grade."""
    grades = FORMATS[name].grading.grades
    refused = []

    class Trying(Hostile):
        def give(self, column: Sequence[fmpz_poly]) -> None:
            wild = [fmpz_poly([0, 10**17, 3]) for _ in column] if self._along.position else column
            for position, grade in enumerate(grades):
                if position >= self._along.position and grades.index(grade) <= self._along.position:
                    self._along.trial(position, wild)
                else:
                    refused.append(position)
                    with pytest.raises(ValueError, match="tried out"):
                        self._along.trial(position, wild)
            super().give(column)

    flow = followed(name, lambda honest: Trying(honest, lambda _, column: column))
    assert refused
    assert holds(name, flow, random.Random("trials"), 5)
    assert lost(flow) < 1e-9


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("what", ["a component less", "one more", "another start", "a later term", "numbers"])
def test_what_is_no_approximate_solution_is_refused(name: str, what: str) -> None:
    arithmetic = FORMATS[name]

    def spoil(_: int, column: list[fmpz_poly]) -> Sequence[Any]:
        match what:
            case "a component less":
                return column[1:]
            case "one more":
                return [*column, column[0]]
            case "another start":
                return [p + 1 for p in column]
            case "a later term":
                return [p + fmpz_poly([0] * (arithmetic.degree + 1) * arithmetic.stride + [1]) for p in column]
        return [0.5] * len(column)

    with pytest.raises(IntegrationFailure):
        advanced(name, spoil)


@pytest.mark.parametrize("row", [0, 1, 14])
def test_powers_of_the_wide_variable_that_are_not_kept_are_refused(row: int) -> None:
    """A stray 2^-10 sigma^(d + 1), at theta = 0 or with a power of theta, which the value at theta = 1 would lack."""
    arithmetic = FORMATS["wide"]
    stray = fmpz_poly([0] * (row * arithmetic.stride + arithmetic.width + 1) + [2**50])
    with pytest.raises(IntegrationFailure, match="not kept"):
        advanced("wide", lambda _, column: [column[0] + stray, *column[1:]])


@pytest.mark.parametrize("name", FORMATS)
def test_a_solution_that_is_not_complete_is_refused(name: str) -> None:
    class Lazy(Hostile):
        def give(self, coefficients: Sequence[fmpz_poly]) -> None:
            if not self._along.position:
                self._along.give(coefficients)

        def trial(self, _position: int, column: Sequence[fmpz_poly]) -> Any:
            return [fmpz_poly([])] * len(column)

    with pytest.raises(ValueError, match="not complete"):
        followed(name, lambda honest: Lazy(honest, lambda _, column: column))


@pytest.mark.parametrize("name", FORMATS)
def test_a_step_is_positive(name: str) -> None:
    for step in (Fraction(0), -STEP):
        with pytest.raises((ValueError, IntegrationFailure)):
            advanced(name, lambda _, column: column, step)
