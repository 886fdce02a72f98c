"""Single orbits of springs whose motions are known: enclosures, results, and enclosures that prove nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import arb
from support.balls import agree
from support.springs import BITS, CLAIMS, SMALL, SPRINGS, Y, claim, exactly, half, number, springs
from support.within import within

from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import NotProved, Proved, bounds
from orbitproof.verify.newton import BoxFunction
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import Approach, Extremum, OrbitEnclosures, OrbitResults, enclose_orbit
from orbitproof.verify.orbit.proved_orbit import _coordinate
from orbitproof.verify.poincare import IntegratorSettings

precision = within(lambda: mpmath.workprec(BITS))


def proved(name: str) -> OrbitResults:
    candidate, enclosures = springs(name)
    outcome = _conclude(candidate, 128, enclosures)
    assert isinstance(outcome, Proved), outcome.reason
    assert isinstance(outcome.results, OrbitResults)
    return outcome.results


def holds(ball: arb, value: Any) -> bool:
    low, high = bounds(ball)
    return bool(low - Fraction(1, 2**140) <= exactly(value) <= high + Fraction(1, 2**140))


@pytest.mark.parametrize("name", CLAIMS)
def test_results_are_those_of_the_motion(name: str) -> None:
    orbit, (candidate, _) = proved(name), springs(name)
    w, m = number(candidate.parameters["w"]), candidate.crossings
    a = number(candidate.centre[0] - SMALL[0] / 2)
    time, sign = m * half(a), (-1) ** m
    turned = mpmath.cos(mpmath.sqrt(w) * time)
    y = number(Y)
    expected = {"x": a, "y": y}
    assert all(holds(ball, expected[key]) for key, ball in orbit.point.items())
    expected = {"x": sign * a, "y": turned * y}
    assert all(holds(ball, expected[key]) for key, ball in orbit.other_point.items())
    assert holds(orbit.half_period, time)
    assert orbit.level is not None
    assert holds(orbit.level, a**2 + a**4 / 2 + w * y**2)
    (low, high), ends = bounds(orbit.half_period), bounds(orbit.period)
    assert low < high
    assert ends[0] <= 2 * low < 2 * high <= ends[1]
    # A period turns y by a multiple of 2 pi, on all orbits near by as well.
    (parameter,) = orbit.stability.parameters
    assert holds(parameter.real, mpmath.mpf(1))
    assert parameter.real.rad() < 2**-5
    assert orbit.least is not None
    assert orbit.greatest is not None
    count = round(float(mpmath.sqrt(w) * time / mpmath.pi))
    times = [mpmath.pi * k / mpmath.sqrt(w) for k in range(count + 1)]
    for extremum, distance, those in (
        (orbit.greatest, 3 + y, times[::2]), (orbit.least, 3 - y, times[1::2])
    ):  # fmt: skip
        assert holds(extremum.distance, mpmath.sqrt(distance))
        assert extremum.distance.rad() < 1e-9
        assert len(extremum.times) == len(those)
        assert all(holds(ball, value) for ball, value in zip(extremum.times, those, strict=True))
        assert all(ball.rad() < 1e-9 for ball in extremum.times)


def test_derivatives_are_enclosed_at_all_points_of_a_wide_box() -> None:
    """Those of the second half at all points in which the first one ends."""
    candidate = claim(4, Fraction(7, 4), 1, (Fraction(1, 2**16), Fraction(1, 2**20)), Fraction(0))
    candidate = replace(candidate, system=replace(SPRINGS, squared_distance=None, distance_name=None))
    enclosures = enclose_orbit(candidate, IntegratorSettings(80), ORACLE)
    w = mpmath.sqrt(number(candidate.parameters["w"]))
    for signs in ((0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)):
        p = [sign * radius for sign, radius in zip(signs, candidate.radii, strict=True)]
        a, y = (
            number(c + sum(value * part for value, part in zip(row, p, strict=True)))
            for c, row in zip(candidate.centre, candidate.frame, strict=True)
        )
        time, turn = half(a), w * half(a)
        assert holds(enclosures.half_period.box[0, 0], time)
        assert holds(enclosures.iterates[-1][0].box[0, 0], -w * y * mpmath.sin(turn))
        values = (-a, y * mpmath.cos(turn))
        assert all(holds(table.box[0, 0], value) for table, value in zip(enclosures.image, values, strict=True))
        # The second half begins in (-a, y cos), and a greater -a is a smaller a.
        slope = values[1] * mpmath.sin(turn) * w * mpmath.diff(half, a)
        wanted = ((-1, 0), (slope, mpmath.cos(turn)))
        for row, values in zip(enclosures.back, wanted, strict=True):
            assert all(holds(ball, mpmath.mpf(value)) for ball, value in zip(row, values, strict=True)), (row, values)
    assert enclosures.back[1][1].rad() < 1e-1


def test_a_coordinate_is_enclosed_on_every_part_of_the_box() -> None:
    candidate = springs("once")[0]
    sides = [arb(0, arb(radius.numerator) / radius.denominator) for radius in candidate.radii]
    for row, (middle, slopes) in enumerate(zip(candidate.centre, candidate.frame, strict=True)):
        function = BoxFunction(_coordinate(candidate, row))
        for share in (Fraction(-1), Fraction(0), Fraction(1)):
            value = middle + share * sum(s * r for s, r in zip(slopes, candidate.radii, strict=True))
            here = [arb(radius.numerator) * share.numerator / radius.denominator for radius in candidate.radii]
            for where in (sides, here):
                low, high = bounds(function.value(where))
                assert low <= value <= high


Change = Callable[[OrbitEnclosures], OrbitEnclosures]
ZERO, X, Y_INDEX = (0, 0), (1, 0), (0, 1)


def table(old: Any, changes: dict[tuple[int, int], arb]) -> Any:
    return replace(old, box={**old.box, **changes}, centre={**old.centre, **changes})


def kernel(changes: Callable[[Any], dict[tuple[int, int], arb]]) -> Change:
    return lambda e: replace(e, iterates=((table(e.iterates[0][0], changes(e.iterates[0][0])),),))


def distance(**changes: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda e: replace(
        e, distance=replace(e.distance, **{name: change(getattr(e.distance, name)) for name, change in changes.items()})
    )


def _later(extrema: tuple[Approach, ...]) -> tuple[Approach, ...]:
    return (*extrema[:-1], replace(extrema[-1], time=extrema[-1].time + 1))


def _earlier(extrema: tuple[Approach, ...]) -> tuple[Approach, ...]:
    return (replace(extrema[0], time=arb(0)), *extrema[1:])


def _vanishing(extrema: tuple[Approach, ...]) -> tuple[Approach, ...]:
    return (*extrema[:2], replace(extrema[2], value=arb(1, 2)), *extrema[3:])


NOTHING: dict[str, tuple[Callable[[Any], Any], str]] = {
    "nothing": (lambda e: None, "poincare-map"),
    "no other point": (lambda e: replace(e, image=e.image[:1]), "poincare-map"),
    "no derivatives of the second half": (lambda e: replace(e, back=e.back[:1]), "poincare-map"),
    "no level": (lambda e: replace(e, first_integral=None), "poincare-map"),
    "no distances": (lambda e: replace(e, distance=None), "poincare-map"),
    "a time that may be negative": (
        lambda e: replace(e, half_period=table(e.half_period, {ZERO: arb(1, 2)})), "poincare-map",
    ),
    "an infinite derivative of the second half": (
        lambda e: replace(e, back=((arb("nan"), e.back[0][1]), e.back[1])), "poincare-map",
    ),
    "an infinite derivative": (kernel(lambda t: {(2, 1): arb(0, "inf")}), "poincare-map"),
    "derivatives that may vanish": (kernel(lambda t: {X: t.box[X] * arb(0, 1)}), "orbit"),
    "an image over the edge of the box": (
        kernel(lambda t: {ZERO: t.centre[ZERO] + t.centre[X] * arb(0, 1) * arb(2) ** -50}), "orbit",
    ),
    "an image beyond the box": (kernel(lambda t: {ZERO: t.centre[X] * arb(2) ** -46}), "orbit"),
    "a level that may be extremal": (
        lambda e: replace(e, first_integral=table(e.first_integral, {X: arb(0, 1), Y_INDEX: arb(1, 1)})), "level",
    ),
    "a distance that may vanish": (distance(between=_vanishing), "distance"),
    "a distance that may vanish at the end": (distance(end=lambda t: table(t, {ZERO: arb(1, 2)})), "distance"),
    "an extremum left out": (distance(between=lambda each: each[1:]), "distance"),
    "another kind at the start": (distance(start_kind=lambda kind: -kind), "distance"),
    "an unknown kind": (distance(end_kind=lambda kind: 0), "distance"),
    "an extremum at the start": (distance(between=_earlier), "distance"),
    "an extremum after the end": (distance(between=_later), "distance"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "condition"), NOTHING.values(), ids=NOTHING.keys())
def test_enclosures_that_show_less_prove_nothing(change: Change, condition: str) -> None:
    candidate, enclosures = springs("once")
    outcome = _conclude(candidate, 128, change(enclosures))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == condition


def test_a_crossing_before_the_end_that_may_be_in_fix_r_proves_nothing() -> None:
    candidate, enclosures = springs("twice")
    ((first,), last) = enclosures.iterates
    near = replace(enclosures, iterates=((table(first, {ZERO: arb(0, 1)}),), last))
    outcome = _conclude(candidate, 128, near)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "half-orbit"


def least(change: Change) -> Extremum:
    candidate, enclosures = springs("once")
    outcome = _conclude(candidate, 128, change(enclosures))
    assert isinstance(outcome, Proved), outcome.reason
    assert isinstance(outcome.results, OrbitResults)
    assert outcome.results.least is not None
    return outcome.results.least


def test_of_minima_that_overlap_each_may_be_the_least() -> None:
    vague = least(distance(between=lambda each: (replace(each[0], value=arb(2.5, 0.25)), *each[1:])))
    assert len(vague.times) == 4
    low, high = bounds(vague.distance)
    assert low <= Fraction(3, 2)
    assert high**2 >= Fraction(5, 2)
    alone = least(distance(between=lambda each: (*each[:2], replace(each[2], value=arb(2)), *each[3:])))
    assert agree(alone.distance, arb(2).sqrt())
    assert len(alone.times) == 1
