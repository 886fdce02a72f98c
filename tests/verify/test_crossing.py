"""Crossings of the section are counted only where they are certain; what cannot be integrated fails with a reason."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb, fmpz_poly
from support.balls import agree
from support.exact_elements import packed_from
from support.flow_checks import box, falkner_skan_box, halo

from orbitproof.shared.claims import Candidate
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS, record
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import (
    Arrival,
    CrossingCounter,
    IntegratorSettings,
    at_start,
    crossing,
    enclose_iterates,
    range_of,
    stays_positive,
    wide_parts,
)

ARITHMETIC = Arithmetic(Grading((1,), 1), 120, 0, 12)
ONE = arb(1)
THIRD = Fraction(1, 3)


def product_of(*roots: Fraction) -> list[Fraction]:
    """Coefficients of the product of (theta - root)."""
    result = [Fraction(1)]
    for root in roots:
        result = [a - root * b for a, b in zip([Fraction(0), *result], [*result, Fraction(0)], strict=True)]
    return result


def scaled(coefficients: Sequence[Fraction], factor: Fraction) -> list[Fraction]:
    """A multiple of a polynomial."""
    return [factor * c for c in coefficients]


def derivative(coefficients: Sequence[Fraction]) -> list[Fraction]:
    """The derivative of a polynomial."""
    return [n * c for n, c in enumerate(coefficients)][1:]


def series(coefficients: Sequence[Fraction], spread: Fraction = Fraction(0), error: float = 0.0) -> Series:
    """A function of theta, plus spread * xi * theta, plus an unknown part."""
    one = int(ARITHMETIC.one)
    known = [fmpz_poly([int(c * one) for c in row]) for row in (coefficients, [Fraction(0), spread])]
    return Series(ARITHMETIC, known, [error, 0.0, 0.0])


def cover(coefficients: Sequence[Fraction], spread: Fraction = Fraction(0), error: float = 0.0) -> CrossingCounter:
    """The count along one step for a section coordinate and its derivative."""
    counter = CrossingCounter()
    counter.cover(series(coefficients, spread, error), series(derivative(coefficients), spread, error), arb(0), ONE)
    return counter


def count(coefficients: Sequence[Fraction], spread: Fraction = Fraction(0), error: float = 0.0) -> int:
    """The count once the orbit has gone on to where it is for certain off the section."""
    return followed(coefficients, spread, error).crossings


def followed(coefficients: Sequence[Fraction], spread: Fraction = Fraction(0), error: float = 0.0) -> CrossingCounter:
    """The count along a step, and along another one on which the section coordinate stays."""
    counter = cover(coefficients, spread, error)
    end, slope = sum(coefficients), sum(derivative(coefficients))
    counter.cover(series([end], spread, error), series([slope], spread, error), ONE, ONE)
    return counter


def test_a_transversal_crossing_is_counted_once() -> None:
    assert count(product_of(Fraction(0), THIRD)) == 1


def test_two_crossings_in_a_step_are_counted() -> None:
    assert count(product_of(Fraction(0), THIRD, 2 * THIRD)) == 2


@pytest.mark.parametrize("seed", range(25))
def test_as_many_crossings_are_counted_as_there_are_roots(seed: int) -> None:
    source = random.Random(seed)
    inside = sorted(Fraction(source.randint(20, 980), 1000) for _ in range(source.randint(0, 5)))
    roots = [Fraction(0), *inside]
    if any(b - a < Fraction(1, 100) for a, b in pairwise(roots)):
        roots = [Fraction(n, 7) for n in range(len(roots))]
    coefficients = scaled(product_of(*roots), Fraction(source.choice((-1, 1)) * 30))
    assert count(coefficients, Fraction(1, 10**12), 1e-14) == len(roots) - 1


def test_a_crossing_is_counted_across_steps() -> None:
    """The first step ends between the start and the crossing, the next one begins before it."""
    whole = product_of(Fraction(0), Fraction(3, 4))
    counter = CrossingCounter()
    half = Fraction(1, 2)
    halves = [
        [whole[0], whole[1] * half, whole[2] * half**2],
        [whole[0] + whole[1] * half + whole[2] * half**2, (whole[1] + whole[2]) * half, whole[2] * half**2],
    ]
    for index, part in enumerate(halves):
        counter.cover(series(part), series(derivative(part)), arb(index) / 2, arb(1) / 2)
        assert counter.crossings == 0
    counter.cover(series([whole[1] + whole[2]]), series([Fraction(1)]), ONE, ONE)
    assert counter.crossings == 1
    assert counter.clear_time is not None
    assert (counter.clear_time > arb(1)) is True


def test_an_orbit_that_turns_before_the_section_is_not_counted() -> None:
    near = [Fraction(0), Fraction(1, 4) + Fraction(1, 100), Fraction(-1), Fraction(1)]
    assert count(near) == 0


def test_an_orbit_that_touches_the_section_is_refused() -> None:
    with pytest.raises(IntegrationFailure) as failure:
        cover(product_of(Fraction(0), Fraction(1, 2), Fraction(1, 2)))
    assert failure.value.reason.condition == "crossing count"


@pytest.mark.parametrize("spread, error", [(Fraction(1, 40), 0.0), (Fraction(0), 0.02)])
def test_a_box_of_which_some_orbits_cross_is_refused(spread: Fraction, error: float) -> None:
    """The centre turns before the section, part of the box crosses it twice."""
    near = [Fraction(0), Fraction(1, 4) + Fraction(1, 100), Fraction(-1), Fraction(1)]
    with pytest.raises(IntegrationFailure) as failure:
        cover(near, spread, error)
    assert failure.value.reason.condition == "crossing count"


def test_an_orbit_that_starts_off_the_section_is_refused() -> None:
    with pytest.raises(IntegrationFailure, match="does not start on the section"):
        cover([Fraction(1), Fraction(1)])


def test_an_orbit_that_starts_along_the_section_is_refused() -> None:
    with pytest.raises(IntegrationFailure):
        cover([Fraction(0), Fraction(0), Fraction(1)])


def level(value: Fraction | int, error: float = 0.0) -> Series:
    """A constant up to an error."""
    return series([Fraction(value)], error=error)


@pytest.mark.parametrize("then", [1, -1])
def test_the_velocity_next_to_the_section_keeps_its_sign_from_step_to_step(then: int) -> None:
    counter = CrossingCounter()
    counter.cover(level(0, 1.0), level(1), arb(0), ONE)
    if then == 1:
        counter.cover(level(0, 1.0), level(then), ONE, ONE)
        return
    with pytest.raises(IntegrationFailure, match="changes sign next to the section"):
        counter.cover(level(0, 1.0), level(then), ONE, ONE)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("velocity", [1, -1, 0])
def test_orbits_cross_in_the_direction_of_their_velocity(side: int, velocity: int) -> None:
    """After the start with y' > 0 the section coordinate is positive; to the other side leads y' < 0 only."""
    counter = CrossingCounter()
    counter.cover(level(0, 1.0), level(1), arb(0), ONE)
    counter.cover(level(1), level(0, 1.0), ONE, ONE)
    if velocity:
        counter.cover(level(0, 1.0), level(velocity), ONE, ONE)
    if side == 1 or velocity == -1:
        counter.cover(level(side), level(0, 1.0), ONE, ONE)
        assert counter.crossings == (side == -1)
        return
    with pytest.raises(IntegrationFailure, match="against the velocity"):
        counter.cover(level(side), level(0, 1.0), ONE, ONE)


@pytest.mark.parametrize("error", [1.0, 1e300, float("inf"), float("nan")])
def test_errors_that_hide_the_orbit_are_refused(error: float) -> None:
    with pytest.raises(IntegrationFailure):
        cover(product_of(Fraction(0), THIRD), error=error)


def shown(counter: CrossingCounter, *numbers: int) -> list[bool]:
    return [counter.arrival(number) is not None for number in numbers]


def test_arrival_is_at_one_crossing_only() -> None:
    whole = product_of(Fraction(0), Fraction(1))
    counter = cover(whole, error=2.0**-100)
    assert counter.crossings == 0
    assert shown(counter, 1, 2) == [True, False]
    onward = scaled(whole, Fraction(-1))
    counter.cover(series(onward), series(derivative(onward)), ONE, ONE)
    assert counter.crossings == 1
    assert shown(counter, 1, 2, 3) == [False, True, False]


def test_an_orbit_on_its_way_from_the_section_has_no_crossing_yet() -> None:
    assert CrossingCounter().arrival(1) is None
    for coefficients in ([Fraction(0), Fraction(1)], [Fraction(0), Fraction(1), Fraction(-1, 4)]):
        assert shown(cover(coefficients), 1, 2) == [False, False]
        counter = followed(coefficients)
        # Whatever crossing comes, it comes after all that was seen.
        assert counter.arrival(1) == Arrival(arb(2))
        assert shown(counter, 2) == [False]


def test_an_orbit_just_past_a_crossing_has_it_behind_a_clear_time() -> None:
    counter = followed(product_of(Fraction(0), THIRD), error=2.0**-100)
    assert counter.crossings == 1
    arrival = counter.arrival(1)
    assert arrival is not None
    assert 0 < arrival.since < arb(1) / 3
    # The velocity there is not known, so the next crossing could be taken for this one.
    assert arrival.behind
    assert counter.arrival(2) == Arrival(arb(2))


def test_an_orbit_that_comes_back_to_the_section_is_not_just_past_a_crossing() -> None:
    """y = theta (theta - 1/3) (theta - 1): at the end it may have crossed once more."""
    counter = cover(product_of(Fraction(0), THIRD, Fraction(1)), error=2.0**-100)
    assert counter.crossings == 1
    assert shown(counter, 1, 2) == [False, True]


MU = MASS_PARAMETERS["earth-moon"]
EARTH_MOON = {"mu": MU}
SMALL = [Fraction(1, 10**10)] * 3


def three_body(x: str | Fraction, z: str, vy: str) -> Candidate:
    """A small box around initial data of the CR3BP."""
    return box(CR3BP, "period_tupling", 2, (x, z, vy), SMALL, EARTH_MOON)


def falkner_skan(beta: str, y: str) -> Candidate:
    """A small box around initial data of the Falkner-Skan equation."""
    return box(FALKNER_SKAN, "period_tupling", 2, (beta, y), SMALL[:2])


HOPELESS: dict[str, Candidate] = {
    "CR3BP, radii 1": halo("earth-moon", "period_tupling", ("1", "1", "1")),
    "CR3BP, radii 1e-3": halo("earth-moon", "period_tupling", ("1e-3", "1e-3", "1e-3")),
    "CR3BP, radii 1e300": halo("earth-moon", "touch_and_go", ("1e300", "1e300", "1e300")),
    "CR3BP, radii 1e400": halo("earth-moon", "period_tupling", ("1e400", "1e-10", "1e-10")),
    "Falkner-Skan, radii 1e-3": falkner_skan_box("period_tupling", 2, ("1e-3", "1e-3")),
    "Falkner-Skan, radii 1": falkner_skan_box("touch_and_go", 2, ("1", "1")),
    "Falkner-Skan, radii 1e160": falkner_skan_box("period_tupling", 2, ("1e160", "1e160")),
    "Falkner-Skan, radii 1e400": falkner_skan_box("period_tupling", 2, ("1e400", "1e400")),
    "at the smaller primary": three_body(1 - MU, "0", "0.1"),
    "at the larger primary": three_body(-MU, "0", "0.1"),
    "box around a primary": three_body(1 - MU + Fraction(1, 10**11), "0", "0.1"),
    "at rest on the axis": three_body("0.95", "0", "0"),
    "next to a libration point": three_body("0.836915132364", "0", "0"),
    "far away": three_body("1e400", "0", "1"),
    "an equilibrium": falkner_skan("453", "1"),
    "the other equilibrium": falkner_skan("453", "-1"),
    "a huge value": falkner_skan("453", "1e400"),
    "a value whose square overflows": falkner_skan("453", "1e200"),
    "a huge parameter": falkner_skan("1e400", "0.5"),
}


@pytest.mark.parametrize("name", HOPELESS)
def test_hopeless_boxes_fail_with_a_reason(name: str) -> None:
    with pytest.raises(IntegrationFailure) as failure:
        enclose_iterates(HOPELESS[name], IntegratorSettings(100), ORACLE)
    assert failure.value.reason.condition
    assert failure.value.reason.message
    assert failure.value.reason.remedy


@pytest.mark.parametrize("radius", ["1e-60", "1e-140"])
def test_tiny_boxes_do_not_underflow(radius: str) -> None:
    """However small the box, the derivatives at its centre stay inside what it encloses."""
    tables = [
        enclose_iterates(falkner_skan_box("touch_and_go", 1, (size, size)), IntegratorSettings(80), ORACLE).iterates[0][
            0
        ]
        for size in ("1e-9", radius)
    ]
    for alpha, known in tables[0].centre.items():
        if sum(alpha) <= 2:
            assert agree(tables[1].box[alpha], known)
        else:
            # Above the kept grade nothing but the error bounds speaks, and they never vanish.
            assert (tables[1].box[alpha].rad() > 0) is True


@pytest.mark.parametrize(("factor", "part", "positive"), [(10, "7/8", True), (-10, "7/8", False), (10, "-7/8", False)])
def test_a_function_is_positive_on_a_part_that_is_halved_where_its_coefficients_belong_together(
    factor: int, part: str, positive: bool
) -> None:
    """1 + c s (1 - theta): with a ball for each of its coefficients the part is too wide."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 2, width=2)
    one = int(arithmetic.one)
    known = packed_from(arithmetic, [[one, factor * one, 0], [0, -factor * one, 0]])
    function = Series(arithmetic, [known, fmpz_poly([])], arithmetic.zero_errors())
    wide = arb(Fraction(part).numerator) / 8 + arb(0, 1) / 8
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(crossing, "_WIDE_DEPTH", 0)
        assert not stays_positive(function, wide)
    assert stays_positive(function, wide) is positive


@pytest.mark.parametrize("number", [1, 2, 7, 8])
def test_the_parts_cover_the_interval_of_the_wide_variable(number: int) -> None:
    parts = wide_parts(number)
    assert all(any(part.contains(arb(n) / 64) for part in parts) for n in range(-64, 65))
    assert len(parts) == number
    assert all(float(part.rad()) < 1.01 / number for part in parts)


@pytest.mark.parametrize("slope", [0, 1, -1])
def test_a_function_that_is_negative_at_one_end_of_a_part_only_is_not_positive(slope: int) -> None:
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 2, width=2)
    one = int(arithmetic.one)
    # 1 +- 10 (s - 1/2), on [3/8, 5/8] between -1/4 and 9/4.
    known = packed_from(arithmetic, [[one - 5 * slope * one, 10 * slope * one, 0]])
    function = Series(arithmetic, [known, fmpz_poly([])], arithmetic.zero_errors())
    assert stays_positive(function, arb(1) / 2 + arb(0, 1) / 8) is (slope == 0)


def test_values_that_are_said_not_to_depend_on_time_do_not() -> None:
    """The range of an element on the section, and the value of a program there, would be those at theta = 0."""
    moving = series([Fraction(1, 2), Fraction(1, 4)])
    doubled = record(lambda x, _: (x[0] + x[0],), ("x",), ())
    with pytest.raises(ValueError, match="depends on time"):
        range_of(moving)
    with pytest.raises(ValueError, match="depends on time"):
        at_start(doubled, [moving])
    assert at_start(doubled, [series([Fraction(1, 2)])])[0].coefs[0] == fmpz_poly([int(ARITHMETIC.one)])
