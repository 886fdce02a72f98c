"""Periodic orbits without symmetry: what is said is no more than what is proved, in sections of any position too."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from support import periodic_cases as cases
from support.balls import agree
from support.systems import described

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import PeriodicOrbit, define_system
from orbitproof.shared.systems.formulas import evaluate_formula
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Proved, enclose, guarded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import (
    Linearised,
    check_periodic_exactly,
    enclose_periodic,
    multipliers_of,
    prove_periodic,
)
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.words.periodic import linear_in_words, periodic_found, periodic_in_words, setting_in_section

BITS = 200
ZERO, ONE = Fraction(0), Fraction(1)
WIDTH = Fraction(1, 2**90)

HALF_TURN = described(
    name="half-turn",
    state="x y u v",
    where={"s": "1 - x**2 - y**2"},
    field={"x": "x*s - y", "y": "x + y*s", "u": "-v/2", "v": "u/2"},
)
"""The unit circle, multipliers exp(-4 pi), -1 and -1: all orbits on the cylinder over it close after two turns."""

OSCILLATOR = define_system(
    {"name": "oscillator", "state": "x y", "field": {"x": "y", "y": "-x"}, "first_integral": "x**2 + y**2"}
)


def _proof(claim: PeriodicOrbit) -> Proved[Any]:
    checklist = Checklist()
    found = enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)
    with guarded(BITS):
        check_periodic_exactly(checklist, claim)
        outcome = prove_periodic(claim, checklist, found)
    assert isinstance(outcome, Proved), outcome.reason
    return outcome


def _refusal(claim: PeriodicOrbit) -> NotEstablishedError:
    with guarded(BITS), pytest.raises(NotEstablishedError) as refused:
        check_periodic_exactly(Checklist(), claim)
    return refused.value


def test_an_orbit_among_orbits_of_twice_its_period_is_not_called_isolated() -> None:
    proof = _proof(cases.in_plane(HALF_TURN, 1, [ONE, ZERO, ZERO, ZERO], WIDTH))
    assert proof.results.multipliers.undecided == 2
    said = periodic_in_words(proof.theorem)  # type: ignore[arg-type]
    assert "isolated" not in said
    assert "Whether orbits near it close after more crossings is not said." in said


@pytest.mark.parametrize("seed", range(8))
def test_a_section_is_told_as_it_is(seed: int) -> None:
    """Its linear function, read again, has the coefficients; the sense is that of the direction."""
    chance, names = random.Random(seed), ["x", "y", "u", "v"]
    factors = tuple(Fraction(chance.choice((-3, -2, -1, 0, 1, 2)), chance.choice((1, 2))) for _ in names)
    read = re.sub(r"([0-9]) (?=[a-z])", r"\1*", linear_in_words(factors, names))
    for place, factor in enumerate(factors):
        point = {name: Fraction(int(number == place)) for number, name in enumerate(names)}
        assert evaluate_formula(read, point) == factor
    claim = cases.in_plane(HALF_TURN, 1, [ONE, ZERO, ZERO, ZERO], WIDTH)
    for direction, word in ((1, "grows"), (-1, "falls")):
        told = "\n".join(setting_in_section(replace(claim, direction=direction)))
        assert f"where the left side {word} in time." in told


def test_in_the_plane_no_multiplier_is_left_on_a_level() -> None:
    claim = cases.in_plane(OSCILLATOR, 1, [Fraction(2), ZERO], WIDTH, direction=-1, level=Fraction(4))
    proof = _proof(claim)
    assert "There are no other multipliers." in list(periodic_found(claim, proof.results))


@pytest.mark.parametrize(("name", "value"), [("crossings", True), ("direction", True), ("direction", 1.0)])
def test_counts_and_directions_are_integers(name: str, value: object) -> None:
    given: Any = {name: value}
    with pytest.raises(InputError, match=name):
        replace(cases.hopf(), **given)


def test_an_oblique_section_gives_the_same_orbit() -> None:
    """Its frame has entries of both signs, and is not orthogonal."""
    frame = ((-ONE, ZERO), (ZERO, ONE), (ZERO, -ONE))
    claim = cases.hopf(normal=(ZERO, ONE, ONE), frame=frame)
    results = _proof(cases.shifted(cases.shifted(claim, 0, WIDTH / 4), 1, WIDTH / 8)).results
    with ctx.workprec(400):
        exact = {name: arb(int(name == "x")) for name in "xyw"}
        assert all(results.point[name].contains(value) for name, value in exact.items())
        assert agree(results.period, 2 * arb.pi())
        assert results.multipliers.inside == 2
    assert results.period.rad() < 1e-40


def test_with_a_frame_turned_round_the_level_singles_out_the_same_orbit() -> None:
    frame = ((-ONE, ZERO, ZERO), (ZERO, ZERO, ZERO), (ONE, ONE, ZERO), (ZERO, ZERO, ONE))
    claim = cases.shifted(cases.shifted(cases.oscillators(frame=frame), 0, WIDTH / 4), 1, WIDTH / 4)
    results = _proof(claim).results
    assert results.multipliers.on == 2
    with guarded(BITS):
        assert (results.point["x"] - 2).contains(0)
        assert all(results.point[name].contains(0) for name in "yuv")
        assert all(results.point[name].rad() < 1e-40 for name in "xuv")


@pytest.mark.parametrize("radius", [Fraction(5, 4), Fraction(17, 16)])
def test_a_direction_that_fails_on_a_part_of_the_box_is_refused_and_not_excluded(radius: Fraction) -> None:
    error = _refusal(cases.hopf(radii=(radius, ONE)))
    assert error.reason.condition == "direction"
    assert not error.reason.excluded


def test_the_direction_of_no_point_of_the_box_is_excluded() -> None:
    assert _refusal(cases.hopf(direction=-1)).reason.excluded


@pytest.mark.parametrize(
    ("integral", "level"),
    [("3*(x**2 + y**2) - x**2 - y**2", 8), ("(x**2 + y**2)/2", 2), ("(x**2 + y**2)**2 - 5*(x**2 + y**2)", -4)],
)
def test_the_level_may_be_written_in_several_ways(integral: str, level: int) -> None:
    """Its derivatives lead from the centre to the point of the level."""
    field = {"x": "y", "y": "-x", "u": "v", "v": "-2*u"}
    system = define_system({"name": "any", "state": "x y u v", "field": field, "first_integral": integral})
    claim = cases.shifted(cases.oscillators(system=system, level=Fraction(level)), 0, WIDTH / 4)
    results = _proof(claim).results
    with guarded(BITS):
        assert (results.point["x"] - 2).contains(0)
        assert results.point["x"].rad() < 1e-40


def test_all_balls_of_a_function_are_told_as_they_are() -> None:
    function = Linearised(arb(1, 0.5), (arb(2, 0.25), arb(3)))
    told = list(function.balls)
    assert [(float(ball.mid()), ball.rad() >= radius) for ball, radius in zip(told, (0.5, 0.25, 0), strict=True)] == [
        (1, True), (2, True), (3, True),
    ]  # fmt: skip


@pytest.mark.parametrize("side", [Fraction(15, 16), Fraction(-15, 16)])
def test_derivatives_are_enclosed_up_to_the_edges_of_the_box(side: Fraction) -> None:
    radius = Fraction(1, 2**40)
    wide = cases.hopf(radii=(radius, radius))
    narrow = cases.shifted(cases.hopf(), 0, side * radius)
    (all_of_it,), (part,) = (
        enclose_periodic(claim, IntegratorSettings(BITS), ORACLE).returns for claim in (wide, narrow)
    )
    for outer, inner in zip(all_of_it.image, part.image, strict=True):
        assert all(agree(ball, other) for ball, other in zip(outer.slopes, inner.slopes, strict=True))


def test_multipliers_are_finite_where_it_is_not_known_whether_they_are_real() -> None:
    found = multipliers_of([[arb(0.5), arb(0, 1e-9)], [arb(1e-3), arb(0.5)]], 1, False)
    assert all(value.is_finite() for value in found.values)


def test_the_level_may_replace_the_last_equation() -> None:
    frame = ((ZERO, ZERO, ONE), (ZERO, ZERO, ZERO), (ONE, ZERO, ZERO), (ZERO, ONE, ZERO))
    found = _proof(cases.oscillators(frame=frame)).results.multipliers
    assert (found.inside, found.on, found.outside) == (0, 2, 0)


def test_the_value_at_the_centre_counts_with_its_radius() -> None:
    """With twice the half-width of the box the zero is not shown to be inside, nor is it excluded."""
    claim = cases.hopf()
    found = enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)
    (last,) = found.returns
    for place, radius in enumerate(claim.radii):
        image = list(last.image)
        with guarded(BITS):
            unknown = arb(0, enclose(2 * radius))
            image[place] = replace(image[place], centre=image[place].centre + unknown)
            outcome = prove_periodic(claim, Checklist(), replace(found, returns=(replace(last, image=tuple(image)),)))
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "periodic"
        assert not outcome.reason.excluded
