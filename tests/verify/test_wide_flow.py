"""Flows of wide sets of orbits enclose the orbits of independent integrators and of a system in closed form."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, fmpz_poly
from support.balls import agree
from support.exact_elements import is_enclosed, known_value, number, packed_from, random_point
from support.flow_checks import ball
from support.independent_flow import extrapolated_flow
from support.wide_checks import BITS, TOLERANCE, WIDE_SETS, WideSet, holds, oscillators, random_place
from support.within import within

import orbitproof.verify.flow.step
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.algebra import Arithmetic, Grading, PreparedProgram, Series, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import FlowStep, advance
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.wide_solution import CircleExpansion, expand
from orbitproof.verify.poincare import Arrival, CrossingCounter, HalfOrbits, wide_parts
from orbitproof.verify.poincare.crossing import range_of
from orbitproof.verify.poincare.section import onto_section
from orbitproof.verify.poincare.section_field import build_section_program

_reference_precision = within(lambda: mpmath.workprec(BITS + 60))


# One step


class Field:
    """A program as the vector field of `extrapolated_flow`."""

    def __init__(self, program: Any) -> None:
        self.program = program

    def vector_field(self, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        return self.program.evaluate([*state, *parameters], number, lambda base, e: mpmath.power(base, number(e)))


def wide_step(
    program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], constants: Sequence[Series], share: float
) -> tuple[Fraction, FlowStep]:
    with np.errstate(all="ignore"):
        expansion = expand(program, arithmetic, state, constants)
        step = Fraction(int(share * expansion.step_size * 2**20), 2**20)
        return step, advance(program, state, constants, expansion, step)


@pytest.mark.parametrize("name", WIDE_SETS)
def test_one_step_encloses_complex_orbits_grade_by_grade(name: str) -> None:
    """At points of the complex polydisc, where a small w shows whether errors are charged to the right grade."""
    source = random.Random(name)
    wide = WIDE_SETS[name]
    returns = wide.returns()
    arithmetic = wide.arithmetic
    # In the integrator's own coordinates, from initial values and constants with unknown parts.
    unknown = [1e-9, 1e-10, 0.0]
    state = [x.with_errors(unknown) for x in returns.state]
    constants = [x.with_errors(unknown) for x in returns.fixed]
    step, flow = wide_step(returns.program, arithmetic, state, constants, 0.5)
    assert step > 0
    assert max(sum(x.errors) for x in flow.end) < 1e-6
    program = returns.coordinates.field
    rated = returns.rate is not None
    for _ in range(3):
        theta, t, point = random_point(source, arithmetic.grading, wide=True)
        start = [moved(source, x, unknown, point) for x in state]
        parameters = [moved(source, x, unknown, point) for x in constants]
        with mpmath.workprec(120):
            duration = number(step) * theta * (parameters.pop() if rated else 1)
            image = extrapolated_flow(Field(program), parameters, start, duration, 2, 9)  # type: ignore[arg-type]
        for series, value in zip(flow.solution, image, strict=True):
            widened = series.with_errors([series.errors[0] + 2.0**-80, *series.errors[1:]])
            assert is_enclosed(widened, value, theta, t, point)


def moved(source: random.Random, series: Series, unknown: Sequence[float], point: Sequence[Any]) -> Any:
    """A value of an element at a point, with unknown parts of grade 0 and 1."""
    signs = [source.choice((-1, 1)) for _ in range(2)]
    known = known_value(series, mpmath.mpf(0), point)
    return known + signs[0] * mpmath.mpf(unknown[0]) + signs[1] * mpmath.mpf(unknown[1]) * point[0]


def test_a_step_without_its_defect_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        orbitproof.verify.flow.step, "_defect", lambda solution, field, step: solution.arithmetic.zero_errors()
    )
    assert escapes(WIDE_SETS["twist"], half_return(WIDE_SETS["twist"]), 1, 6) > 0


def test_float64_does_where_coefficients_are_at_most_a_multiple_of_their_errors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """2^41 times the errors, as the chapter says (3.4); coefficients of the largest size are between 1/2 and 1."""
    corrected: list[int] = []
    monkeypatch.setattr(CircleExpansion, "_correct", lambda self, *_: corrected.append(1))
    wide = WIDE_SETS["twist"]
    wide = replace(wide, limits=(88, *wide.limits[1:]))
    returns = wide.returns()
    assert max(abs(float(known_value(x, mpmath.mpf(0), [0, 0]).real)) for x in returns.state) < 1
    for error in (2.0**-41, 2.0**-43, 0.0):
        corrected.clear()
        state = [x.with_errors([error, 0.0, 0.0]) for x in returns.state]
        wide_step(returns.program, wide.arithmetic, state, returns.fixed, 0.25)
        assert bool(corrected) == (error < 2.0**-42), error


# HalfOrbits


def half_return(wide: WideSet) -> HalfOrbits:
    returns = wide.returns()
    go_on(returns)
    return returns


def go_on(returns: HalfOrbits) -> None:
    """To the next crossing of the centre."""
    with np.errstate(all="ignore"):
        while not returns.step():
            assert returns.steps < 60


def escapes(wide: WideSet, returns: HalfOrbits, crossing: int, count: int) -> int:
    """How many random orbits of the set lie outside the enclosure of their crossing, or of its time."""
    source = random.Random(f"{wide.system.name} {crossing}")
    with np.errstate(all="ignore"):
        state, time = returns.crossing(crossing)
    found = 0
    for _ in range(count):
        s, w = random_place(source, len(wide.piece.tube))
        when, image = wide.reference(wide.point(s, w), crossing)
        inside = all(holds(series, value, s, w) for series, value in zip(state, image, strict=True))
        found += not (inside and abs(when - rough(time.mid())) <= rough(time.rad().upper()) + TOLERANCE)
    return found


def rough(value: arb) -> Any:
    mantissa, exponent = value.mid().man_exp()
    return mpmath.ldexp(int(mantissa), int(exponent))


RATES = {
    "none": None,
    "falling": [Fraction(1), Fraction(-1, 5)],
    "curved": [Fraction(1), Fraction(1, 16), Fraction(1, 40)],
}


def with_rate(monkeypatch: pytest.MonkeyPatch, powers: Sequence[Fraction] | None) -> None:
    def rate(self: HalfOrbits, _: int) -> Series | None:
        if powers is None:
            return None
        return self.arithmetic.polynomial({self.arithmetic.grading.monomials[0]: powers})

    monkeypatch.setattr(HalfOrbits, "_rate", rate)


@pytest.mark.parametrize(
    "name",
    [
        "falkner-skan",
        "cr3bp, physical",
        pytest.param("cr3bp, regularised", marks=pytest.mark.slow),
        pytest.param("cr3bp-l1", marks=pytest.mark.slow),
        "twist",
    ],
)
def test_half_returns_enclose_independent_orbits(name: str) -> None:
    wide = WIDE_SETS[name]
    returns = half_return(wide)
    assert escapes(wide, returns, 1, 4) == 0
    state, _ = returns.crossing(1)
    assert max(sum(x.errors) for x in state) < wide.sharp


@pytest.mark.parametrize("rate", ["falling", *(pytest.param(r, marks=pytest.mark.slow) for r in ("none", "curved"))])
def test_closed_form_returns_are_enclosed_at_any_rate(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the centre on the section, other orbits are before it and others have passed it."""
    with_rate(monkeypatch, RATES[rate])
    wide = WIDE_SETS["twist"]
    returns = half_return(wide)
    assert (returns.rate is None) == (rate == "none")
    section = returns.state[wide.system.section_index]
    ends = [known_value(section, mpmath.mpf(1), [mpmath.mpf(0), mpmath.mpf(s)]).real for s in (-1, 1)]
    assert ends[0] * ends[1] < 0
    assert max(map(abs, ends)) > 0.05
    assert escapes(wide, returns, 1, 100) == 0


def test_orbits_that_return_together_are_followed_at_their_rate() -> None:
    returns = half_return(WIDE_SETS["twist"])
    assert returns.rate is not None
    section = returns.state[1]
    assert all(abs(known_value(section, mpmath.mpf(1), [mpmath.mpf(0), mpmath.mpf(s)])) < 1e-6 for s in (-1, 1))


@pytest.mark.parametrize("rate", ["own", pytest.param("none", marks=pytest.mark.slow)])
def test_second_returns_are_enclosed(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if rate == "none":
        with_rate(monkeypatch, None)
    wide = oscillators(("1/12", "1/40"))
    returns = half_return(wide)
    assert (returns.rate is None) == (rate == "none")
    with pytest.raises(IntegrationFailure) as failure:
        returns.crossing(2)
    assert failure.value.reason.condition == "crossing count"
    go_on(returns)
    assert escapes(wide, returns, 2, 40) == 0
    with pytest.raises(IntegrationFailure) as failure:
        returns.crossing(1)
    assert failure.value.reason.condition == "crossing count"


def test_a_wrong_rate_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """Orbits whose speed is taken for another arrive elsewhere in time."""
    wide = WIDE_SETS["twist"]
    returns = half_return(wide)
    assert returns.rate is not None
    returns.rate = returns.rate.scaled(Fraction(1000001, 1000000))
    assert escapes(wide, returns, 1, 10) == 0
    returns.rate = returns.rate.scaled(Fraction(3))
    assert escapes(wide, returns, 1, 10) > 0


@pytest.mark.parametrize(
    "powers",
    [[Fraction(1), Fraction(1)], [Fraction(1), Fraction(-1)], [Fraction(1), Fraction(0), Fraction(-3)]],
    ids=str,
)
def test_rates_that_vanish_in_the_piece_are_not_used(powers: list[Fraction], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orbitproof.verify.oracle.relative_return_times", lambda *given: powers)
    assert WIDE_SETS["twist"].returns().rate is None


@pytest.mark.parametrize("powers", [pytest.param(("1/6",), marks=pytest.mark.slow), ("-1/8", "1/20")], ids=str)
def test_orbits_around_their_first_crossing_are_enclosed(
    powers: Sequence[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with_rate(monkeypatch, None)
    wide = oscillators(powers)
    returns = half_return(wide)
    assert escapes(wide, returns, 1, 60) == 0


def test_orbits_that_have_crossed_twice_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frequencies (1 + s/3)^4: when the centre crosses first, some orbits have crossed twice, others never."""
    with_rate(monkeypatch, None)
    assert refusal(oscillators(("4/3", "6/9", "4/27", "1/81"))) == "crossing count"
    assert refusal(oscillators(("1/8",))) == ""


def refusal(wide: WideSet) -> str:
    """The condition at which the first return fails; empty if it does not."""
    try:
        half_return(wide).crossing(1)
    except IntegrationFailure as failure:
        return failure.reason.condition
    return ""


@pytest.mark.slow
@pytest.mark.parametrize("coordinates", ["physical", "regularised"])
@pytest.mark.parametrize("seed", [1, 2])  # pieces that physical coordinates can follow past the primary
def test_both_coordinates_enclose_the_same_orbits(coordinates: str, seed: int) -> None:
    source = random.Random(seed)
    base = WIDE_SETS["cr3bp, regularised"]
    centre = tuple(x * (1 + Fraction(source.randint(-50, 50), 1000)) for x in base.piece.centre)
    piece = replace(base.piece, centre=centre, half_width=Fraction(1, 2000), coordinates=coordinates)
    wide = WideSet(CR3BP, base.parameters, piece, base.reference, (64, 30, 12))
    returns = half_return(wide)
    assert (returns.coordinates.name == "physical") == (coordinates == "physical")
    assert escapes(wide, returns, 1, 20) == 0


def test_crossings_are_counted_on_parts_that_cover_the_piece() -> None:
    parts = [counter.wide for counter in oscillators(("1/8",)).returns().counters]
    for s in (Fraction(n, 64) for n in range(-64, 65)):
        assert any(part is not None and part.contains(ball(s)) for part in parts)


def test_a_zero_is_the_crossing_only_if_it_lies_where_the_crossing_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not before the last time without one, and not ahead of the orbits if the crossing is behind them."""
    with_rate(monkeypatch, None)
    returns = half_return(oscillators(("1/12",)))
    cases = [(Arrival(arb(1)), True), (Arrival(returns.time + 1), False), (Arrival(arb(1), behind=True), False)]
    for arrival, accepted in cases:
        monkeypatch.setattr(CrossingCounter, "arrival", lambda self, number, arrival=arrival: arrival)
        if accepted:
            returns.crossing(1)
        else:
            with pytest.raises(IntegrationFailure, match="not separated"):
                returns.crossing(1)


def test_the_time_of_a_crossing_is_compared_on_each_part_with_what_is_clear_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where frequencies differ by a sixth along the piece each part has a crossing time of its own."""
    with_rate(monkeypatch, None)
    returns = half_return(oscillators(("1/12",)))
    _, whole = returns.crossing(1)
    delay, little = returns.delay, arb(2) ** -20
    firsts = [returns.time + range_of(delay, counter.wide).lower() for counter in returns.counters]
    assert max(firsts) - min(firsts) > 100 * little
    assert min(firsts) > 0
    for late in range(-1, len(firsts)):
        clear = [first + (little if number == late else -little) for number, first in enumerate(firsts)]
        for counter, since in zip(returns.counters, clear, strict=True):
            monkeypatch.setattr(counter, "arrival", lambda _, since=since: Arrival(since))
        if late < 0:
            assert agree(returns.crossing(1)[1], whole)
        else:
            with pytest.raises(IntegrationFailure, match="not separated"):
                returns.crossing(1)


# Onto the section


def test_distances_that_are_not_small_are_brought_onto_the_section() -> None:
    """The section coordinate of the image is zero, and the time is that of the closed form, in several steps."""
    wide = WIDE_SETS["twist"]
    arithmetic = wide.arithmetic
    a, angle = Fraction(1, 2), Fraction(1, 4)
    # From (a cos, a sin, ..), an angle before the section; the angle varies with s.
    turned = [angle + angle / 2, angle / 2]
    cosine = [Fraction(float(x)) for x in np.polynomial.Polynomial([1, 0, -0.5, 0, 1 / 24])(
        np.polynomial.Polynomial([float(x) for x in turned])).coef]  # fmt: skip
    sine = [Fraction(float(x)) for x in np.polynomial.Polynomial([0, 1, 0, -1 / 6, 0, 1 / 120])(
        np.polynomial.Polynomial([float(x) for x in turned])).coef]  # fmt: skip
    rows = [[a * x for x in cosine], [-a * x for x in sine], [Fraction(3, 10)], [Fraction(0)]]
    state = [arithmetic.polynomial({(0,): row}) for row in rows]
    constants = [arithmetic.constant(value) for value in wide.parameters.values()]
    program = build_section_program(wide.system.program, 4, 1)
    with np.errstate(all="ignore"):
        image, elapsed = onto_section(program, 1, arithmetic, state, constants, ORACLE)
    for s in (Fraction(-1), Fraction(0), Fraction(3, 7), Fraction(1)):
        x, y = (sum(number(c) * number(s) ** n for n, c in enumerate(row)) for row in rows[:2])
        radius = mpmath.hypot(x, y)
        place = [mpmath.mpf(0), number(s)]
        time = mpmath.asin(-y / radius) / (1 + radius**2 / 4)
        for series, value in ((elapsed, time), (image[0], radius), (image[1], mpmath.mpf(0))):
            middle = known_value(series, mpmath.mpf(0), place)
            assert abs(middle - value) <= sum(series.errors)
            assert sum(series.errors) < 1e-6


# Crossings


ARITHMETIC = WideArithmetic(Grading((1,), 1), 90, 0, 8, width=4)
Rows = list[list[Fraction]]


def times(left: Rows, right: Rows) -> Rows:
    result = [[Fraction(0)] * 5 for _ in range(len(left) + len(right) - 1)]
    for n, row in enumerate(left):
        for m, other in enumerate(right):
            for i, x in enumerate(row):
                for j, y in enumerate(other):
                    if x and y:
                        result[n + m][i + j] += x * y
    return result


def section_coordinate(*roots: Sequence[Fraction]) -> Rows:
    """theta times the product of (theta - root(s)), roots given by their coefficients in s; rows: powers of theta."""
    result: Rows = [[Fraction(0)], [Fraction(1)]]
    for root in roots:
        result = times(result, [[-x for x in root], [Fraction(1)]])
    return result


def series(rows: Rows, spread: Fraction = Fraction(0), error: float = 0.0) -> Series:
    one = int(ARITHMETIC.one)
    packed = packed_from(ARITHMETIC, [[int(x * one) for x in (*row, *[Fraction(0)] * 5)][:5] for row in rows])
    return Series(ARITHMETIC, [packed, fmpz_poly([int(spread * one)])], [error, 0.0, 0.0])


def counters(rows: Rows, spread: Fraction = Fraction(0), error: float = 0.0) -> list[CrossingCounter]:
    """The counts on each part of the interval of s along a step, and along another on which the orbits stay."""
    return [follow(part, rows, spread, error) for part in wide_parts(8)]


def follow(part: arb, rows: Rows, spread: Fraction = Fraction(0), error: float = 0.0) -> CrossingCounter:
    slope = [[n * x for x in row] for n, row in enumerate(rows)][1:]
    counter = CrossingCounter(part)
    counter.cover(series(rows, spread, error), series(slope, spread, error), arb(0), arb(1))
    padded = ([[*row, *[Fraction(0)] * 5][:5] for row in given] for given in (rows, slope))
    position, velocity = (
        series([[sum(column) for column in zip(*given, strict=True)]], spread, error) for given in padded
    )
    counter.cover(position, velocity, arb(1), arb(1))
    return counter


def test_parts_of_a_piece_are_counted_separately() -> None:
    """Crossings at 1 + s/4: with s > 0 the orbit is on its way to it, with s < 0 it has passed it."""
    rows = section_coordinate([Fraction(1), Fraction(1, 4)])
    found = counters(rows)
    assert [counter.crossings for counter in found] == [1, 1, 1, 0, 0, 0, 0, 0]
    assert all(counter.arrival(1) is not None for counter in found)
    assert [counter.arrival(2) is not None for counter in found] == [True] * 3 + [False] * 5
    for counter in found:
        arrival = counter.arrival(1)
        assert arrival is not None
        assert arrival.behind == (counter.crossings == 1)
        assert 0 < arrival.since < (1 if arrival.behind else 3)


def test_a_crossing_at_a_constant_time_is_found_on_every_part() -> None:
    rows = [[x, x / 3, x / 5] for (x, *_) in section_coordinate([Fraction(1, 3)])]
    found = counters(rows)
    assert [counter.crossings for counter in found] == [1] * 8


def test_orbits_that_come_back_to_the_section_are_not_at_the_first_crossing() -> None:
    """Crossings at 1/2 and 1 + s/8: on some parts, orbits have crossed twice; on others they are on their way back."""
    found = counters(section_coordinate([Fraction(1, 2)], [Fraction(1), Fraction(1, 8)]), error=2.0**-60)
    assert [counter.crossings for counter in found] == [2, 2, 2, 1, 1, 1, 1, 1]
    assert all(counter.arrival(2) is not None for counter in found)
    assert [counter.arrival(1) for counter in found[:5]] == [None] * 5
    # Still off the section for certain, so that a zero behind them is the first crossing.
    arrivals = [counter.arrival(1) for counter in found[5:]]
    assert all(arrival is not None and arrival.behind and arrival.since < arb(1) / 2 for arrival in arrivals)


def test_orbits_of_which_some_touch_the_section_are_refused() -> None:
    """y = theta ((theta - 1/2)^2 + s/8): without a zero in (0, 1) for s > 0 only."""
    rows = times([[Fraction(0)], [Fraction(1)]], [[Fraction(1, 4), Fraction(1, 8)], [Fraction(-1)], [Fraction(1)]])
    with pytest.raises(IntegrationFailure) as failure:
        counters(rows)
    assert failure.value.reason.condition == "crossing count"
    assert follow(wide_parts(8)[6], rows).crossings == 0
    assert follow(wide_parts(8)[1], rows).crossings == 2


@pytest.mark.parametrize("seed", range(10))
def test_as_many_crossings_are_counted_as_there_are_roots(seed: int) -> None:
    source = random.Random(seed)
    middles = source.choice(([], [1], [0.4, 0.9], [0.3, 0.7, 1.2]))
    shifts = [[Fraction(source.randint(-5, 5), 200) for _ in range(2)] for _ in middles]
    roots = [[Fraction(middle) + shift, slope] for middle, (shift, slope) in zip(middles, shifts, strict=True)]
    rows = section_coordinate(*roots)
    found = counters(rows, Fraction(1, 10**12), 1e-15)
    for part, counter in enumerate(found):
        s = [Fraction(2 * part - 8 + shift, 8) for shift in (0, 1, 2)]
        inside = {sum(root[0] + root[1] * x < 1 for root in roots) for x in s}
        assert counter.crossings == min(inside)


def test_orbits_that_leave_the_section_do_not_arrive() -> None:
    """Off the section for certain, then not for certain, but with a velocity away from it."""
    for slope, arrives in ((Fraction(1, 5), False), (Fraction(-1, 5), True)):
        counter = CrossingCounter(wide_parts(8)[3])
        rows = [[Fraction(0)], [Fraction(1)]]
        counter.cover(series(rows), series(rows[1:]), arb(0), arb(1))
        counter.cover(series([[Fraction(1)]]), series(rows[1:]), arb(1), arb(1))
        counter.cover(series([[Fraction(1)], [slope]], error=1.5), series([[slope]], error=0.1), arb(2), arb(1))
        assert counter.crossings == 0
        assert (counter.arrival(1) is not None) == arrives


def test_an_arrival_with_unknown_velocity_says_that_the_crossing_lies_behind() -> None:
    """Crossing at 1/3 for all s, off the section at the end of the step."""
    rows = [[x, Fraction(0)] for (x, *_) in section_coordinate([Fraction(1, 3)])]
    for counter in counters(rows):
        assert counter.velocity_sign == 0
        arrival = counter.arrival(1)
        assert isinstance(arrival, Arrival)
        assert arrival.behind
        assert 0 < arrival.since < arb(1) / 3
