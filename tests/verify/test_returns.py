"""Returns of a harmonic oscillator to the section: times, places, derivatives and what is refused, in closed form."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import pytest
from flint import arb, ctx
from support.closed_form_maps import description
from support.exact_elements import number
from support.flow_checks import contains, halo
from support.wide_checks import OSCILLATOR, TWIST

from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import CR3BP, LEVEL_NAME
from orbitproof.verify.algebra import Arithmetic, Grading, WideArithmetic
from orbitproof.verify.bifurcation import enclose_first_integral
from orbitproof.verify.evidence import Checklist, DerivativeTable, IntegrationFailure, NotEstablishedError
from orbitproof.verify.flow import FlowStep, advance
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import (
    REGULARISED,
    Arrival,
    EarlyEnd,
    HalfOrbits,
    HalfReturns,
    IntegratorSettings,
    Returns,
    box_of,
    check_half_orbit,
    enclose_iterates,
    kernel_components,
)

FRAME = ((Fraction(1), Fraction(3, 10)), (Fraction(1, 5), Fraction(1)))
CENTRE = (Fraction(5, 4), Fraction(1, 2))
RADII = (Fraction(1, 4000), Fraction(1, 1000))
KERNEL = Fraction(7, 16)


@pytest.fixture(autouse=True)
def _precision() -> Iterator[None]:
    with mpmath.workdps(60), ctx.workprec(200):
        yield


def box(k: int, crossings: int) -> Candidate:
    """Pairs (nu, a), in a box that is wide for three crossings and narrow for more."""
    rows, radii = (FRAME, ((KERNEL,),)), RADII if k * crossings < 4 else [r / 2**10 for r in RADII]
    return Candidate("box", OSCILLATOR, {}, "period_tupling", k, CENTRE, *rows, tuple(radii), crossings=crossings)


def exact(value: Any) -> Fraction:
    return Fraction(int(mpmath.nint(value * mpmath.mpf(2) ** 180)), 2**180)


def return_time(number_of: int, p: tuple[Fraction, ...], alpha: tuple[int, ...] = (0, 0)) -> Fraction:
    """i pi/nu at a point of the box, or its derivative: nu = 5/4 + p_0 + 3 p_1/10."""
    nu = number(CENTRE[0] + sum(a * x for a, x in zip(FRAME[0], p, strict=True)))
    order = sum(alpha)
    slopes = FRAME[0][0] ** alpha[0] * FRAME[0][1] ** alpha[1]
    return exact(number_of * mpmath.pi * (-1) ** order * mpmath.factorial(order) / nu ** (order + 1) * number(slopes))


@pytest.mark.parametrize("k, crossings, bits, order", [(3, 1, 60, 16), (2, 2, 40, 12)])
def test_times_and_places_of_returns_and_their_derivatives_are_enclosed(
    k: int, crossings: int, bits: int, order: int
) -> None:
    """The coordinate t of the oscillator is the time when it is on the section."""
    candidate = box(k, crossings)
    found = enclose_iterates(candidate, IntegratorSettings(bits, order), ORACLE)
    assert len(found.return_times) == len(found.iterates) == k * crossings
    source = random.Random(bits)
    points = [tuple(r * Fraction(source.randint(-64, 64), 64) for r in candidate.radii) for _ in range(20)]
    points += [candidate.radii, tuple(-r for r in candidate.radii)]
    for i, (time, (table,)) in enumerate(zip(found.return_times, found.iterates, strict=True), 1):
        for alpha, ball in table.box.items():
            for p in points:
                assert contains(ball, KERNEL * return_time(i, p, alpha))
            assert contains(table.centre[alpha], KERNEL * return_time(i, (Fraction(0), Fraction(0)), alpha))
        assert all(contains(time, return_time(i, p)) for p in points)
        assert float(time.rad()) < 0.1
    assert float(found.iterates[0][0].box[1, 0].rad()) < 0.05


def test_half_returns_are_told_apart_from_the_crossings_between_them() -> None:
    """With two crossings in a half return, those of numbers 2 and 4 are half returns, and 1 is before the first."""
    seen: list[HalfReturns] = []
    settings = IntegratorSettings(60, 16, accuracy=(0, 0))
    watch = EarlyEnd(settings.accuracy, lambda _, half_returns: seen.append(half_returns))
    found = enclose_iterates(box(3, 2), settings, ORACLE, watch=watch)
    rows = found.iterates
    assert [half.before for half in seen] == [rows[:1]] * 2
    assert [half.kernels for half in seen] == [(rows[1],), (rows[1], rows[3])]
    assert [list(half.image) for half in seen] == [[], ["a"]]
    assert contains(seen[1].image["a"].centre[0, 0], CENTRE[1])


@cache
def on_the_section() -> HalfOrbits:
    """The oscillators with nu = 1 + xi/64, near their first crossing."""
    arithmetic = Arithmetic(Grading((1,), 1), 60, 0, 16)
    point = {"nu": arithmetic.polynomial({(0,): Fraction(1), (1,): Fraction(1, 64)})}
    returns = HalfOrbits(OSCILLATOR, arithmetic, {**point, "a": arithmetic.constant(Fraction(1))}, ORACLE)
    while not returns.step():
        assert returns.steps < 40
    return returns


@pytest.mark.parametrize(
    "since, behind, accepted",
    [("-1", False, True), ("-0.03", False, False), ("0.5", False, False), ("-1", True, False)],
)
def test_a_crossing_is_after_the_last_time_without_one_and_behind_if_it_is_said_to_be(
    since: str, behind: bool, accepted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The crossings are within 1/16 of the time to which the orbits were followed, before and after it."""
    returns = on_the_section()
    (counter,) = returns.counters
    monkeypatch.setattr(counter, "arrival", lambda _: Arrival(returns.time + arb(since), behind))
    if accepted:
        returns.crossing(1)
        return
    with pytest.raises(IntegrationFailure, match="not separated"):
        returns.crossing(1)


def test_times_of_returns_hold_what_is_unknown_of_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    returns = on_the_section()
    monkeypatch.setattr(returns, "time", returns.time + arb(0, 2.0**-20))
    _, time = returns.crossing(1)
    assert Fraction(returns.return_time.errors[0]) >= Fraction(1, 2**20)
    assert time.rad() >= arb(2) ** -20


def test_the_kernel_coordinates_are_those_of_the_frame() -> None:
    system = description(2, False)
    arithmetic = Arithmetic(Grading((1,), 1), 60, 0, 2)
    state = [arithmetic.constant(Fraction(n)) for n in range(len(system.state))]
    first, second = (int(state[i].coefs[0][0]) >> 60 for i in system.kernel_coordinates)
    rows = ((Fraction(1), Fraction(10)), (Fraction(100), Fraction(1000)))
    found = [int(x.coefs[0][0]) >> 60 for x in kernel_components(system, rows, state)]
    assert found == [first + 10 * second, 100 * first + 1000 * second]


@pytest.mark.parametrize("c, meets", [("0", True), ("1/3", False)])
def test_the_crossings_of_a_half_orbit_before_its_end_are_off_the_fixed_set(c: str, meets: bool) -> None:
    """In the plane c = d = 0 the orbits are in Fix(R) at every crossing."""
    arithmetic = Arithmetic(Grading((1,), 1), 60, 0, 24)
    values = {"omega": Fraction(3, 2), "a": Fraction(1, 2), "c": Fraction(c)}
    returns = HalfOrbits(
        TWIST, arithmetic, {name: arithmetic.constant(value) for name, value in values.items()}, ORACLE
    )
    if meets:
        with pytest.raises(IntegrationFailure, match=r"in Fix\(R\) at crossing 1 already"):
            returns.half_orbit(2)
        return
    _, time = returns.half_orbit(2)
    assert contains(time, exact(2 * mpmath.pi / (1 + mpmath.mpf(1) / 16)))


@pytest.mark.parametrize("zero", ["-1", "-5/8", "1/16", "7/8", "-9/8", "9/8"])
def test_no_orbit_of_a_piece_is_on_the_fixed_set_at_a_crossing_before_the_end(zero: str) -> None:
    """c = (s - zero)/16, d = 0: the orbit of s = zero is in Fix(R) at every crossing, if it is one of the piece."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 24, width=12)
    along = {"omega": [Fraction(3, 2)], "a": [Fraction(1, 2)], "c": [-Fraction(zero) / 16, Fraction(1, 16)]}
    points = {name: arithmetic.polynomial({(0,): values}) for name, values in along.items()}
    returns = HalfOrbits(TWIST, arithmetic, points, ORACLE)
    if abs(Fraction(zero)) > 1:
        assert len(returns.half_orbit(2)[0]) == len(TWIST.state)
        return
    with pytest.raises(IntegrationFailure, match=r"in Fix\(R\) at crossing 1 already"):
        returns.half_orbit(2)


@pytest.mark.parametrize("wrong", ["time", "u1"])
def test_the_clock_of_regularised_coordinates_runs_forwards_on_every_step(
    wrong: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of all components of the field it is that of the time which has to be positive."""
    candidate = halo("earth-moon", "touch_and_go", ("1e-9",) * 3)
    made = box_of(candidate, 60, 16)
    returns = Returns(CR3BP, made.arithmetic, made.point, ORACLE, REGULARISED)
    regularisation = returns.coordinates.regularisation
    assert regularisation is not None
    place = {"time": regularisation.time_index, "u1": 0}[wrong]

    def backwards(*arguments: Any) -> FlowStep:
        flow = advance(*arguments)
        slopes = [flow.slopes[0].arithmetic.constant(Fraction(-1 if i == place else 1)) for i in range(len(flow.end))]
        return replace(flow, slopes=tuple(slopes))

    monkeypatch.setattr("orbitproof.verify.poincare.returns.advance", backwards)
    if wrong == "time":
        with pytest.raises(IntegrationFailure, match="collision"):
            returns.step()
    else:
        assert not returns.step()


def test_the_level_of_a_level_form_is_its_first_coordinate() -> None:
    """And the level coordinate that follows from it has this level."""
    candidate = replace(halo("earth-moon", "touch_and_go", ("1e-9",) * 3), level_sign=1)
    centre = (Fraction(3), *candidate.centre[:2])
    candidate = replace(candidate, centre=centre, radii=(Fraction(1, 10**9),) * 3)
    assert candidate.coordinates == (LEVEL_NAME, "x", "z")
    assert candidate.titles == ("Jacobi constant", "x", "z")
    table = enclose_first_integral(candidate, 80)
    assert table is not None
    assert contains(table.centre[0, 0, 0], Fraction(3))
    assert contains(table.box[1, 0, 0], Fraction(1))


@pytest.mark.parametrize(
    "balls, stands",
    [
        ([[(1, 2)]], True),
        ([[(-1, 2)]], False),
        ([[(-1, 2), (1, 2)], [(-2, -1), (-1, 1)]], True),
        ([[(-1, 2), (1, 2)], [(-2, 1), (-1, 1)]], False),
        ([[(-1, 2), (-1, 2)], [(1, 2), (1, 1)]], False),
    ],
)
def test_a_half_orbit_ends_where_it_is_said_to_end(balls: list[list[tuple[int, int]]], stands: bool) -> None:
    """At every crossing before, one of the coordinates q is not zero on all of the box."""
    tables = [[DerivativeTable({(0, 0): arb(low).union(arb(high))}, {}) for low, high in row] for row in balls]
    checklist = Checklist()
    if stands:
        check_half_orbit(checklist, tables)
        assert [item.name for item in checklist.hypotheses] == ["half-orbit"]
        return
    with pytest.raises(NotEstablishedError):
        check_half_orbit(checklist, tables)
