"""Functions, lists and levels along curves: parts are covered up to their ends, and balls give balls."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, arb_poly, ctx
from support.balls import agree
from support.chain_cases import concluded, parabola, proved
from support.curve_cases import proof
from support.inclusion import broken_inclusions
from support.random_segments import ball, function_of, number, segment_of
from support.stored import values
from support.within import within

from orbitproof.shared.claims import Claim
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_PLANAR, FALKNER_SKAN, LIFTED, VERTICAL, record
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import PlaceOnCurve, is_inside_curve
from orbitproof.verify.curve.tube import read_tube
from orbitproof.verify.distances.ranges import Extreme, KnownDistances, PartOfInterval, Where, _values, ranges_between
from orbitproof.verify.evidence import enclose, hull
from orbitproof.verify.functions import BoundedFunction, StoredFunction
from orbitproof.verify.index.along_curve import Interval
from orbitproof.verify.stability import point_over
from orbitproof.verify.stability.between_orbits import _bends
from orbitproof.verify.stability.closer_tube import _largest
from orbitproof.verify.stability.extrema import _Stationary
from orbitproof.verify.stability.level import gradient
from orbitproof.verify.stability.linear_stability import Bound, is_stable
from orbitproof.verify.stability.zeros import zeros_beside_double_one, zeros_on
from orbitproof.verify.web import Arc
from orbitproof.verify.web.arc import level_at

BITS = 160
MU = Fraction(1, 80)

precision = within(lambda: ctx.workprec(BITS))


@pytest.mark.parametrize("seed", range(3))
def test_values_of_functions_along_a_curve(seed: int) -> None:
    """At balls of tau: of a function, of stationary values, of second derivatives of parameters, of eigenvalues."""
    chance = random.Random(seed)
    tau = ball(chance, -0.5, 0.5)
    function = function_of(chance, 6)
    for of_tau in (function.value, function.slope, function.curvature):
        assert not broken_inclusions(of_tau, (tau,), chance)
    for count in (1, 2):
        segment = segment_of(chance, count)
        if count == 2:
            # With a positive discriminant.
            trace, second = segment.characteristic
            segment = replace(segment, characteristic=(trace, second.shifted(arb(-9))))
        trace, *others = segment.characteristic
        stationary = _Stationary(trace, others[0] if others else None)
        for of_tau in (stationary.value, stationary.slope, stationary.parameter):
            assert not broken_inclusions(of_tau, (tau,), chance)
        for of_ball in (segment.s_of, segment.tau_of):
            assert not broken_inclusions(of_ball, (tau,), chance)
        assert not broken_inclusions(lambda tau, segment=segment: _bends(segment, tau), (tau,), chance)
        assert not broken_inclusions(lambda c, segment=segment: segment.at(c).value(arb(1) / 8), (tau,), chance)


@pytest.mark.parametrize("seed", range(6))
def test_stability_parameters_bend_and_turn_as_their_sum_and_product_say(seed: int) -> None:
    """Two even polynomials a < b of tau: their second derivatives, and where a' b' = 0, divided by tau^2."""
    chance = random.Random(seed)
    low, high = (arb_poly([arb(start), 0, ball(chance, -1, 1), 0, ball(chance, -1, 1)]) for start in (-1, 4))
    trace, second = (BoundedFunction(function, arb(0)) for function in (low + high, low * high))
    segment = segment_of(chance, 2, characteristic=(trace, second))
    stationary = _Stationary(trace, second)
    for tau in (arb(share) / 16 for share in (-8, -3, 2, 7)):
        slopes = [function.derivative()(tau) for function in (low, high)]
        bends = [function.derivative().derivative()(tau) for function in (low, high)]
        for found, known in zip(_bends(segment, tau), bends, strict=True):
            assert agree(found, known)
            assert found.rad() < 1e-30
        # The resultant of the characteristic polynomial and its derivative by tau.
        turning = -((high(tau) - low(tau)) ** 2) * slopes[0] * slopes[1]
        assert agree(stationary.value(tau), turning)
        assert stationary.value(tau).rad() < 1e-30
        assert stationary.over_square(hull(arb(0), tau)).contains((turning / tau**2).mid())
        near = tau / 2**20
        quotient = stationary.value(near) / near**2
        assert agree(quotient, stationary.over_square(hull(arb(0), near)))
        assert stationary.over_square(hull(arb(0), near)).rad() < 1e-3


def edges(function: Any, low: Fraction, high: Fraction) -> list[arb]:
    """Its values at both ends of an interval, and a little inside."""
    places = [low, high, low + (high - low) / 1024, high - (high - low) / 1024, (low + high) / 2]
    return [function(enclose(place)) for place in places]


@pytest.mark.parametrize("seed", range(3))
def test_values_over_parts_hold_those_at_both_ends(seed: int) -> None:
    chance = random.Random(seed)
    low, high = Fraction(-7, 16), Fraction(chance.randint(0, 7), 16)
    for slope in (1, -1):
        line = BoundedFunction(ball_polynomial([number(chance), Fraction(slope)]), arb(0))
        assert all(agree(_values(line, low, high), value) for value in edges(line.value, low, high))
        places = [low, (low + 3 * high) / 4, high]
        ends = zip(pairwise(places), (Where.HERE, Where.THERE), strict=True)
        parts = tuple(
            PartOfInterval(*part, Extreme(hull(*map(enclose, part)), Where.ALONG), Extreme(arb(0), where))
            for part, where in ends
        )
        known = KnownDistances(line, line.scaled(arb(2)), parts)
        found = known.over(low, high)
        assert found is not None
        assert all(found[0].square.contains(enclose(place)) for place in (low, high))
        assert found[1].where is Where.ALONG
        assert agree(found[1].square, line.value(enclose(low)))
        assert agree(found[1].square, 2 * line.value(enclose(high)))
        turned = known.mirrored().over(-high, -low)
        assert turned is not None
        assert agree(turned[1].square, 2 * line.value(enclose(high)))
        segment = segment_of(chance, 1, half_period=line, level=line, distances=None)
        for begin, end in ((Fraction(-3, 8), Fraction(3, 8)), (Fraction(-1, 2), Fraction(1, 2))):
            ranges = ranges_between([segment], (0, begin), (0, end))
            assert ranges is not None
            wanted = edges(segment.tau_of, begin, end)
            assert all(agree(ranges.half_period, line.value(tau)) for tau in wanted)


def test_a_function_near_balls_holds_those_with_coefficients_at_all_of_their_ends() -> None:
    chance = random.Random(0)
    for error in (0.0, 2.0**-24):
        balls = [ball(chance) + arb(0, chance.choice([2.0**-20, 2.0**-30, 0.0])) for _ in range(6)]
        found = StoredFunction.near(balls, arb(error)).enclosed
        for sign in (1, -1):
            ends = [each.mid() + chance.choice([1, -1]) * sign * each.rad() for each in balls]
            assert found.contains(BoundedFunction(arb_poly(ends), arb(error)))
        assert not found.contains(BoundedFunction(arb_poly([each.mid() for each in balls]), arb(2.0**-16)))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_largest_value_of_a_polynomial_may_be_at_either_end(sign: int) -> None:
    """Where sigma is at most 16/17."""
    end = Fraction(16, 17)
    for coefficients in ([0, 1], [0, -1], [0, 0, 0, 1], [-1, 1], [1, 1], [0, 0, 1], [-2, 0, 1]):
        row = [Fraction(c) * sign**n for n, c in enumerate(coefficients)]
        most = max(abs(sum((c * s**n for n, c in enumerate(row)), Fraction(0))) for s in (end, -end, Fraction(0)))
        assert most <= _largest(row) <= most * Fraction(9, 8)


@pytest.mark.parametrize("sign", [1, -1])
def test_points_and_levels_of_an_arc_hold_those_of_its_ends(sign: int) -> None:
    """y = beta^2/100: the level is beta, of which both ends are exact; the deviation is across."""
    atlas, results = parabola(Claim("arc", None, ("beta",)))
    curve = proof(concluded((atlas, results)))
    arc = Arc(atlas, curve)
    first, last = curve.chain.stretches[0], curve.chain.stretches[-1]
    levels = arc.levels()
    for stretch, s in ((first, first.enters), (last, last.leaves)):
        point = stretch.tube.point(stretch.run, s)
        assert levels.contains(point[0].mid())
    assert not levels.contains(arb("0.98"))
    assert not levels.contains(arb("5.02"))
    assert arc.period.contains(2 * curve.half_period)
    piece = atlas.curve_pieces()[1]
    tube = read_tube(piece, values([proved(piece, deviation=["0x1p-21"])]))
    stretch = replace(first, tube=tube, run=tube.runs[0], enters=Fraction(-1), leaves=Fraction(1))
    low, high = Fraction(-1, 4), Fraction(1, 2)
    over = point_over(stretch, hull(enclose(low), enclose(high)))
    for s in (low, high, Fraction(1, 8)):
        beta = piece.centre[0] + piece.half_width * s
        y = piece.centre[1] + piece.frame[1][0] * piece.half_width * s + piece.polynomial[0][2] * s**2
        assert over[0].contains(enclose(beta))
        assert over[1].contains(enclose(y + sign * Fraction(1, 2**21)))
        at = point_over(stretch, enclose(s))
        assert at[1].contains(enclose(y + sign * Fraction(1, 2**21)))


@pytest.mark.parametrize("sign", [1, -1])
def test_points_over_two_proved_intervals_are_as_uncertain_as_over_the_worse_one(sign: int) -> None:
    atlas, results = parabola(Claim("arc", None, ("beta",)))
    stretch, piece = proof(concluded((atlas, results))).chain.stretches[0], atlas.curve_pieces()[1]
    deviations = ["0x1p-21", "0x1p-26"][::sign]
    halves = [
        proved(piece, *ends, deviation=[width])
        for ends, width in zip((("-1", "0x0"), ("0x0", "1")), deviations, strict=True)
    ]
    tube = read_tube(piece, values(halves))
    stretch = replace(stretch, tube=tube, run=tube.runs[0], enters=Fraction(-1), leaves=Fraction(1))
    over = point_over(stretch, hull(enclose(Fraction(-1, 2**40)), enclose(Fraction(1, 2**40))))
    for side in (1, -1):
        assert over[1].contains(enclose(piece.centre[1] + side * Fraction(1, 2**21)))


def test_levels_of_an_arc_are_those_of_all_its_parts_and_of_its_birth(monkeypatch: pytest.MonkeyPatch) -> None:
    """A function that is 0 at one orbit alone, wherever that lies on the curve, or among those that are born."""
    atlas, results = parabola(Claim("arc", None, ("beta",)))
    curve, end = proof(concluded((atlas, results))), Fraction(1, 8)
    birth: Any = SimpleNamespace(
        tube=SimpleNamespace(proved=SimpleNamespace(end=end, time=arb(7)), states=lambda s: {"beta": s})
    )
    arc = Arc(atlas, replace(curve, birth=birth))
    assert arc.period.contains(2 * curve.half_period)
    assert arc.period.contains(28)
    born = [share * end for share in (-1, Fraction(-1, 64), Fraction(1, 64), 1)]
    along = [1 + Fraction(share, 32) for share in (1, 3, 5, 31, 33, 61, 63, 80, 125, 127)]
    for place in (*born, *along):
        monkeypatch.setattr(
            "orbitproof.verify.web.arc.level_at",
            lambda _, point, place=place: -abs(point["beta"] - enclose(place)),
        )
        assert arc.levels().contains(0)
    assert not arc.levels().contains(1)


def test_an_orbit_is_inside_an_arc_if_it_is_certainly_none_of_its_ends() -> None:
    atlas, results = parabola(Claim("arc", None, ("beta",)))
    chain, names = proof(concluded((atlas, results))).chain, [piece.id for piece in atlas.curve_pieces()]
    near = arb(2) ** -20
    for name, s, inside in (
        (names[0], arb(-1), False), (names[0], -1 + near, True), (names[0], arb(-1, near), False),
        (names[0], -1 - near, False), (names[1], arb(-1, near), True), (names[1], arb(1, near), True),
        (names[2], arb(1), False), (names[2], 1 - near, True), (names[2], arb(1, near), False),
        (names[2], 1 - 2 * near + arb(0, near), True), (names[0], arb(1), True),
    ):  # fmt: skip
        assert is_inside_curve(atlas, chain, PlaceOnCurve(name, s, False)) == inside


def test_an_interval_of_a_curve_holds_what_lies_between_its_places_and_not_in_them() -> None:
    low, high = Fraction(1, 4), Fraction(1, 2)
    interval = Interval(Bound(0, low, high, ()), Bound(2, low, high, ()))
    for stretch, s, holds in (
        (0, 0, False), (0, low, False), (0, Fraction(3, 8), False), (0, high, False), (0, Fraction(5, 8), True),
        (1, -1, True), (1, 1, True), (2, 0, True), (2, low, False), (2, Fraction(3, 8), False), (2, 1, False),
        (3, 0, False),
    ):  # fmt: skip
        assert interval.holds(stretch, Fraction(s)) == holds


def test_levels_of_points() -> None:
    chance = random.Random(0)
    for system in (CR3BP, CR3BP_PLANAR, *AROUND.values(), VERTICAL["L1"], LIFTED, FALKNER_SKAN):
        atlas: Any = SimpleNamespace(system=system, parameters={"mu": MU} if "mu" in system.parameters else {})
        point = {name: ball(chance, 0.3, 0.6) for name in system.centre_coordinates}
        assert not broken_inclusions(lambda point, atlas=atlas: level_at(atlas, point), (point,), chance), system.name


def test_gradients_are_derivatives_and_hold_those_of_all_points() -> None:
    chance = random.Random(0)
    inputs = ("x", "y", "c")
    program = record(
        lambda s, p: ((s[0] * s[1] - p[0] / s[0]) * (s[0] ** 3 + s[1]) ** Fraction(3, 2),), ("x", "y"), ("c",)
    )
    arguments = [ball(chance, 1, 2) for _ in inputs]
    step = arb(2) ** -60

    def value(at: Any) -> arb:
        (found,) = program.evaluate(at, enclose, lambda base, power: base ** enclose(power))
        return arb(found)

    for name, slope in zip(inputs, gradient(program, arguments, inputs), strict=True):
        moved = [x + step * (name == own) for x, own in zip(arguments, inputs, strict=True)]
        assert abs((value(moved) - value(arguments)) / step - slope) < arb(2) ** -50
    assert not broken_inclusions(lambda at: gradient(program, at, inputs), (arguments,), chance)


@pytest.mark.parametrize("count", [1, 2])
def test_orbits_are_stable_only_where_all_of_a_ball_are(count: int) -> None:
    """c = tau, and -tau beside it: stable for abs(tau) < 1, and of two equal ones at 0 nothing is known."""
    zero, tau = (BoundedFunction(ball_polynomial(row), arb(0)) for row in ([Fraction(0)], [Fraction(0), Fraction(1)]))
    segment = segment_of(random.Random(0), count)
    slow = tau.scaled(arb(2))
    segment = replace(segment, characteristic=(slow,) if count == 1 else (zero, (slow * slow).scaled(arb(-1))))
    for middle, radius, wanted in (
        ("0.3", "0.1", True), ("0.45", "0.04", True), ("0.45", "0.06", None), ("0.7", "0.1", False),
        ("-0.45", "0.06", None), ("-0.3", "0.1", True), ("-0.7", "0.05", False), ("-0.7", "0.3", None),
    ):  # fmt: skip
        assert is_stable(segment, arb(middle, radius)) is wanted
    if count == 2:
        assert is_stable(segment, arb(0, "0.01")) is None
        # One inside and one beyond, on either side.
        for trace in ("3", "-3"):
            beyond = replace(segment, characteristic=(zero.shifted(arb(trace)), zero.shifted(arb("1.25"))))
            assert is_stable(beyond, arb(0)) is False


@pytest.mark.parametrize("seed", range(4))
def test_every_zero_of_every_function_that_may_be_meant_is_listed_or_open(seed: int) -> None:
    chance = random.Random(seed)
    roots = sorted(chance.sample(range(-28, 29), 4))
    coefficients = [Fraction(1)]
    for root in roots:
        coefficients = [
            a - Fraction(root, 32) * b
            for a, b in zip([Fraction(0), *coefficients], [*coefficients, Fraction(0)], strict=True)
        ]
    error = Fraction(1, 2**20)
    known = BoundedFunction(ball_polynomial(coefficients), enclose(error))
    found = zeros_on(known, Fraction(-15, 16), Fraction(15, 16))
    for power, sign in ((0, 1), (1, -1), (4, 1)):
        meant = [c + sign * error * (n == power) for n, c in enumerate(coefficients)]
        exact_function = BoundedFunction(ball_polynomial(meant), arb(0))
        true = zeros_on(exact_function, Fraction(-15, 16), Fraction(15, 16))
        assert len(true.zeros) == 4
        for zero in true.zeros:
            listed = [each for each in found.zeros if agree(each.place, zero.place)]
            open_there = any(enclose(low) <= zero.place <= enclose(high) for low, high in found.undecided)
            assert len(listed) == 1 or open_there
    double = [Fraction(0), Fraction(0), *coefficients]
    beyond = [root for root in roots if root > 0]
    end, listed_beside = zeros_beside_double_one(BoundedFunction(ball_polynomial(double), arb(0)), Fraction(15, 16))
    assert end > 0
    assert len(listed_beside.zeros) == len(beyond)
    for zero, root in zip(listed_beside.zeros, beyond, strict=True):
        assert agree(zero.place, arb(root) / 32)
