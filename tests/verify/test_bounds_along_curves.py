"""Bounds along a curve at their limits: unknown parts that are as large as they may be, and data made by hand."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import cos, pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_poly, ctx
from scipy.integrate import solve_ivp
from support.closed_form_lists import ellipse, line, result, results
from support.flow_checks import ball
from support.stored import function_of, json_of_function, unconfirmed_of, values
from support.within import within

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.branches.conclusion_as_json import _outward, shortened
from orbitproof.verify.branches.index import _listed
from orbitproof.verify.curve import Chain, conclude
from orbitproof.verify.distances import Extreme, Where
from orbitproof.verify.distances.ranges import joined
from orbitproof.verify.evidence import IntegrationFailure, Proved
from orbitproof.verify.functions import (
    REACH,
    BoundedFunction,
    determinant,
    error_of,
    function,
    known_part,
    restricted,
    slope,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.out_of_plane import KnownVariations, VariationFunctions, variations_across
from orbitproof.verify.stability import (
    Bound,
    CompleteList,
    CurveEnd,
    Gap,
    Kind,
    Matter,
    OtherPoint,
    Resonance,
    Segment,
    extrema_on,
    is_stable,
    stable_intervals,
)
from orbitproof.verify.stability.along import CurveInTube, at_origin, solve
from orbitproof.verify.stability.complete_list import Finder
from orbitproof.verify.stability.known_functions import segments_of
from orbitproof.verify.stability.matrix import SHARE, _minors, _stability_matrix
from orbitproof.verify.stability.zeros import zeros_beside_double_one, zeros_on

END = 1 / REACH
ZERO = Fraction(0)

_precision = within(lambda: ctx.workprec(160))


def bounded(*coefficients: Any, error: Any = 0) -> BoundedFunction:
    return BoundedFunction(arb_poly([ball(Fraction(c)) for c in coefficients]), ball(Fraction(error)))


# Functions with an unknown part c tau^n, |c| as large as the bound


@pytest.mark.parametrize("power", [0, 1, 2, 7, 33, 66])
@pytest.mark.parametrize("side", [1, -1])
def test_an_unknown_power_is_in_values_and_derivatives(power: int, side: int) -> None:
    error = Fraction(1, 8)
    known, unknown = bounded(1, 2, -3, 1, error=error), side * error
    for number in range(-8, 9):
        tau = END * Fraction(number, 8)
        at = float(tau)
        for spread in (0.0, 0.0625):
            # A part that has tau inside, and lies on one side of it.
            part = ball(tau) - arb(spread * (1 if number > 0 else -1), spread)
            tail = [unknown * tau**power, 0.0, 0.0]
            if power > 0:
                tail[1] = float(unknown) * power * at ** (power - 1)
            if power > 1:
                tail[2] = float(unknown) * power * (power - 1) * at ** (power - 2)
            near = arb(0, 1e-12)
            assert known.value(part).contains(ball(1 + 2 * tau - 3 * tau**2 + tau**3 + tail[0]))
            assert (known.slope(part) + near).contains(arb(2 - 6 * at + 3 * at**2 + tail[1]))
            assert (known.curvature(part) + near).contains(arb(-6 + 6 * at + tail[2]))


def test_sums_and_products_hold_the_largest_unknown_parts() -> None:
    """At tau = 1 the unknown parts 1/2 tau^n of both factors are 1/2."""
    for first, second in ((3, 5), (-3, 5), (0, 0), (2, 0), (0, 2)):
        for sign in (1, -1):
            f, g = bounded(0, first, error=Fraction(1, 2)), bounded(0, 0, second, error=Fraction(1, 4))
            a, b = first + Fraction(sign, 2), second + Fraction(sign, 4)
            one = arb(1)
            assert (f + g).value(one).contains(ball(a + b))
            assert (f - g).value(one).contains(ball(a - second + Fraction(sign, 4)))
            assert (f * g).value(one).contains(ball(a * b))
            assert (f * g).value(one).contains(ball(a * (second - Fraction(sign, 4))))
            assert f.scaled(arb(-3)).value(one).contains(ball(-3 * a))
            assert f.shifted(arb(7)).value(one).contains(ball(a + 7))
            assert f.mirrored().value(-one).contains(ball(a))
            assert not f.mirrored().value(one).contains(ball(Fraction(4 * first))) or not first


def test_a_function_contains_no_other_whose_parts_may_lie_beyond() -> None:
    held = bounded(1, 2, error=Fraction(1, 8))
    assert held.contains(bounded(1, 2, error=Fraction(1, 9)))
    for other in (
        bounded(1, 2, error=Fraction(1, 7)),
        bounded(1, Fraction(33, 16), error=Fraction(1, 15)),
        bounded(Fraction(17, 16), Fraction(31, 16), error=Fraction(1, 100)),
        bounded(1, 2, Fraction(1, 8), error=Fraction(1, 100)),
    ):
        assert not held.contains(other)
    assert held.as_found.error == held.error / 2


ALGEBRA = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=40)


def element(*coefficients: Any, error: Any = 0) -> Series:
    return function(ALGEBRA, [Fraction(c) for c in coefficients], Fraction(error))


@pytest.mark.parametrize("seed", range(6))
def test_stored_functions_lose_nothing_and_leave_room_for_another_integration(seed: int) -> None:
    source = random.Random(seed)
    found = element(*(Fraction(source.getrandbits(110), 2**100) for _ in range(6)), error=source.random() * 2.0**-50)
    stored = function_of(json_of_function(found))
    lost = sum((abs(arb(0) + ball(c) - stored.polynomial[n]) for n, c in enumerate(known_part(found, 0))), arb(0))
    assert lost > 0
    assert lost + ball(error_of(found)) <= stored.as_found.error
    exact = function_of(json_of_function(element(*known_part(found, 0))))
    assert lost <= exact.as_found.error


@pytest.mark.parametrize("power", [1, 5, 33, 40])
def test_the_derivative_on_a_smaller_disc_holds_that_of_unknown_powers(power: int) -> None:
    error = Fraction(1, 2**20)
    derived, smaller = (f(element(1, 2, error=error), SHARE) for f in (slope, restricted))
    assert error_of(derived) >= error * power * SHARE ** (power - 1)
    assert error_of(smaller) >= error
    for found, expected in ((smaller, [1, 2 * SHARE]), (slope(element(1, 2, 3), SHARE), [2, 6 * SHARE])):
        for value, wanted in zip(known_part(found, 0), expected, strict=True):
            assert abs(value - wanted) < Fraction(1, 2**100)


@pytest.mark.parametrize("value", [2.0**201, float("inf"), float("nan")])
def test_functions_without_a_bound_are_refused(value: float) -> None:
    with pytest.raises(IntegrationFailure):
        error_of(Series(ALGEBRA, element(1).coefs, [value]))


def test_determinants_have_their_signs() -> None:
    rows = [[2, 7, 1], [3, -1, 4], [5, 6, -2]]
    assert known_part(determinant([[element(c) for c in row] for row in rows]), 0)[0] == 161
    matrix = [[element(c) for c in row] for row in rows]
    assert [known_part(_minors(matrix, order), 0)[0] for order in (1, 2, 3)] == [-1, -54, 161]


def test_sigma_is_twice_the_product_less_one() -> None:
    """Columns of A and A'; A' A = ((1, 2), (3, 4)) ((5, 6), (7, 8)) with A given by its columns."""
    back, out = (
        [[element(c) for c in column] for column in columns] for columns in (((1, 3), (2, 4)), ((5, 7), (6, 8)))
    )
    found = _stability_matrix(out, back)
    assert [[known_part(entry, 0)[0] for entry in row] for row in found] == [[37, 44], [86, 99]]


# The curve in its tube


TUBE = WideArithmetic(Grading((1,), 1), 80, 0, 0, width=10)


def in_tube(zero: Any, one: Any, errors: list[float]) -> Series:
    """zero + one omega and unknown parts of the grades 0, 1 and above."""
    return TUBE.polynomial({(0,): [Fraction(zero)], (1,): [Fraction(one)]}).with_errors(errors)


@pytest.mark.parametrize("errors", [[0.125, 0.0, 0.0], [0.0, 0.125, 0.0], [0.0, 0.0, 0.125], [0.5, 0.25, 0.125]])
def test_values_and_derivatives_on_the_curve_hold_unknown_parts_of_every_grade(errors: list[float]) -> None:
    """u_0 = e_0, u_1 = e_1 omega, u_> = e_> omega^2 at omega = 3/8."""
    e0, e1, e2 = map(Fraction, errors)
    place = Fraction(3, 8)
    curve = CurveInTube((element(place),), place)
    f = in_tube(2, 3, errors)
    value = curve.value(f)
    assert known_part(value, 0)[0] == 2 + 3 * place
    assert error_of(value) >= e0 + place * e1 + place**2 * e2
    across = curve.across(f, 0)
    assert known_part(across, 0)[0] == 3
    assert error_of(across) >= e1 + 2 * place * e2
    assert error_of(at_origin(f, 0, ALGEBRA)) >= e1


def test_known_parts_above_grade_1_count_as_unknown() -> None:
    """omega^2/8, kept as such or not."""
    place = Fraction(3, 8)
    curve = CurveInTube((element(place),), place)
    higher = WideArithmetic(Grading((1,), 2), 80, 0, 0, width=10)
    f = higher.polynomial({(0,): [Fraction(2)], (1,): [Fraction(3)], (2,): [Fraction(1, 8)]})
    assert error_of(curve.value(f)) >= place**2 / 8
    assert error_of(curve.across(f, 0)) >= place / 4


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("grade", [0, 1, 2])
def test_the_zero_in_the_tube_is_enclosed_with_unknown_parts_of_every_grade(grade: int, sign: int) -> None:
    """-1/8 + omega + e omega^grade = 0, for the largest e of both signs."""
    error = 1 / 16
    curve = solve(ALGEBRA, [in_tube(Fraction(-1, 8), 1, [error * (n == grade) for n in range(3)])])
    e = sign * error
    root = [0.125 - e, 0.125 / (1 + e), (-1 + (1 + e / 2) ** 0.5) / (2 * e)][grade]
    (omega,) = curve.omega
    found = function_of(json_of_function(omega))
    middle = float(known_part(omega, 0)[0])
    assert abs(root - middle) <= float(error_of(omega)) + 1e-12
    assert found.value(arb(0)).contains(arb(root))
    assert abs(root) <= curve.size


def test_a_map_into_the_ball_that_is_no_contraction_shows_no_zero() -> None:
    """b (e_1 + 2 R e_>) = 1.13 for R = 0.40, while b (e_0 + R e_1 + R^2 e_>) = 0.23 <= r_0 = 0.25."""
    with pytest.raises(IntegrationFailure, match="analytic"):
        solve(ALGEBRA, [in_tube(Fraction(-3, 20), 1, [0.0, 0.0, 1.4])])


def test_a_zero_beyond_half_of_the_tube_is_not_shown() -> None:
    solve(ALGEBRA, [in_tube(Fraction(-15, 32), 1, [0.0, 0.0, 0.0])])
    with pytest.raises(IntegrationFailure, match="analytic"):
        solve(ALGEBRA, [in_tube(Fraction(-17, 32), 1, [0.0, 0.0, 0.0])])


@pytest.mark.parametrize("errors", [[0.0, 0.875, 0.0], [0.0, 0.0, 64.0], [0.25, 0.25, 0.0]])
def test_a_map_that_leaves_the_ball_shows_no_zero(errors: list[float]) -> None:
    with pytest.raises(IntegrationFailure, match="analytic"):
        solve(ALGEBRA, [in_tube(Fraction(-1, 64), 1, errors)])


def test_two_equations_are_solved_together() -> None:
    arithmetic = WideArithmetic(Grading((1, 1), 1), 80, 0, 0, width=10)
    rows = [((1, 2), Fraction(1, 10)), ((3, -1), Fraction(1, 20))]
    equations = [
        arithmetic.polynomial({(0, 0): [-value], (1, 0): [Fraction(a)], (0, 1): [Fraction(b)]}).with_errors([0.0] * 3)
        for (a, b), value in rows
    ]
    curve = solve(ALGEBRA, equations)
    first, second = (known_part(omega, 0)[0] for omega in curve.omega)
    assert abs(first + 2 * second - Fraction(1, 10)) < Fraction(1, 10**9)
    assert abs(3 * first - second - Fraction(1, 20)) < Fraction(1, 10**9)


# Zeros


def test_a_zero_at_which_a_bound_is_as_large_as_the_function_is_not_lost() -> None:
    """f - e and f + e have their zeros at other places: one, none, or two."""
    for error, number in ((Fraction(1, 100), 1), (Fraction(128), 0)):
        found = zeros_on(bounded(0, 1, error=error / 64), -END, END)
        assert len(found.zeros) == number
        assert all(zero.place.contains(ball(side * error / 64)) for zero in found.zeros for side in (1, -1))
    hidden = zeros_on(bounded(Fraction(1, 1000), 0, 1, error=Fraction(1, 900)), -END, END)
    assert hidden.zeros == ()
    assert any(low <= 0 <= high for low, high in hidden.undecided)


def test_zeros_beside_a_double_one_on_the_left_and_behind_wide_bounds() -> None:
    end, found = zeros_beside_double_one(bounded(0, 0, Fraction(1, 2), 1), -END)
    assert Fraction(-1, 2) < end < 0
    (zero,) = found.zeros
    assert zero.place.contains(ball(Fraction(-1, 2)))
    for upper in (END, -END):
        end, found = zeros_beside_double_one(bounded(0, 0, Fraction(1, 1000), error=1), upper)
        assert (end, found.zeros) == (0, ())
        assert found.undecided == (tuple(sorted((ZERO, upper))),)


# Parts of a curve


@cache
def proved(name: str) -> tuple[Atlas, list[dict[str, Any]], Chain]:
    system = line(1, 1, True) if name == "line" else ellipse(1, 1, "breaks")
    atlas = system.atlas(4 if name == "line" else 10)
    found = results(system, atlas, split=True)
    outcome = conclude(atlas, values(found)).outcome
    assert isinstance(outcome, Proved), outcome
    return atlas, found, outcome.results.chain


def segments(name: str) -> list[Segment]:
    _, found, chain = proved(name)
    return [s for n, stretch in enumerate(chain.stretches) for s in segments_of(n, stretch, values(found))[0]]


def finder(sigma: BoundedFunction, start: Fraction, entered: Fraction, end: Fraction) -> Finder:
    """On the second stretch of the line, with this stability parameter as a function of s."""
    atlas, _, chain = proved("line")
    flat = bounded(0)
    segment = Segment(1, start, entered, end, ZERO, Fraction(1), (sigma,), flat, bounded(3), flat)
    return Finder(atlas, chain.stretches[1], segment)


def test_a_zero_at_a_joint_is_named_and_beside_it_listed() -> None:
    """Sigma = s + 3/8: the value cos(2 pi/4) = 0 is taken at -3/8, in the joint or beside it."""
    for entered, number in ((Fraction(-1, 4), 0), (Fraction(-7, 16), 1)):
        work = finder(bounded(Fraction(3, 8), 1), Fraction(-1, 2), entered, Fraction(1, 2))
        work.resonances(4, 1)
        assert len(work.points) == number
        assert len(work.gaps) == 1 - number
        for gap in work.gaps:
            assert (gap.start, gap.end, gap.subject) == (Fraction(-1, 2), entered, Resonance(4, 1))
        for point in work.points:
            # The proof of the piece says that the curve is so far from y = 0 at most.
            assert point.point["y1"].contains(arb(2.0**-30))
            assert point.point["y1"].contains(arb(-(2.0**-30)))
    outside = finder(bounded(Fraction(3, 4), 1), Fraction(-1, 2), Fraction(-1, 2), Fraction(1, 2))
    outside.resonances(4, 1)
    assert outside.points == outside.gaps == []


def test_a_double_zero_is_a_gap_of_its_resonance() -> None:
    work = finder(bounded(0, 0, 1), Fraction(-1, 2), Fraction(-1, 2), Fraction(1, 2))
    work.resonances(4, 1)
    assert work.points == []
    (gap,) = work.gaps
    assert gap.start < 0 < gap.end
    assert gap.subject == Resonance(4, 1)


@pytest.mark.parametrize("name", ["line", "loop"])
def test_segments_follow_each_other_from_beginning_to_end(name: str) -> None:
    _, found, chain = proved(name)
    for number, stretch in enumerate(chain.stretches):
        parts, gaps = segments_of(number, stretch, values(found))
        assert gaps == []
        assert parts[0].start == stretch.enters
        assert parts[0].entered == min(max(stretch.enters, stretch.entered), parts[0].end)
        assert parts[-1].end == stretch.leaves
        for before, after in pairwise(parts):
            assert before.end == after.start == after.entered
        without = [entry for entry in found if entry["piece"] != stretch.tube.piece.id]
        (gap,) = segments_of(number, stretch, values(without))[1]
        assert (gap.start, gap.end, gap.subject) == (stretch.enters, stretch.leaves, Matter.EVERYTHING)


def test_a_symmetric_loop_begins_and_ends_at_symmetric_points() -> None:
    first, *others, last = segments("loop")
    assert (first.meets_symmetric_point, last.meets_symmetric_point) == (-1, 1)
    assert not any(part.meets_symmetric_point for part in others)


def test_the_ends_of_a_gap_are_written_outward() -> None:
    third = Fraction(1, 3)
    assert 0 < third - shortened(third, -1) < Fraction(1, 2**59)
    assert 0 < shortened(third, 1) - third < Fraction(1, 2**59)
    assert shortened(-third, -1) < -third < shortened(-third, 1)
    assert shortened(Fraction(3, 8), 1) == shortened(Fraction(3, 8), -1) == Fraction(3, 8)
    chain = proved("loop")[2]
    known: Any = SimpleNamespace(curve=SimpleNamespace(chain=chain))
    for low, high in ((-third, third), (third, 2 * third), (-2 * third, -third)):
        first, last = map(parse_exact, _outward(low, high))
        assert (first < low, last > high) == (True, True)
        listed = _listed(known, Bound(1, low, high, (CurveEnd.END,)))
        assert listed.interval == (first, last)
        assert listed.piece == chain.stretches[1].tube.piece.id


def test_functions_of_the_other_half_of_a_symmetric_piece_are_mirrored() -> None:
    """At the end of a symmetric loop s < 0 is used; Sigma, level and time agree with those of the other side."""
    _, found, chain = proved("loop")
    number = len(chain.stretches) - 1
    parts = segments_of(number, chain.stretches[number], values(found))[0]
    (stored,) = [
        entry
        for entry in found
        if entry["piece"] == chain.stretches[number].tube.piece.id and not entry["interval"][0].startswith("-")
    ]
    (mirrored,) = [part for part in parts if part.middle < 0]
    assert mirrored.middle < 0
    original = [function_of(entry) for entry in stored["stability"]["characteristic"]]
    for at in (-0.75, 0.25, 0.5):
        assert mirrored.characteristic[0].value(arb(at)).contains(original[0].value(arb(-at)).mid())
        level = function_of(stored["stability"]["level"])
        assert mirrored.level.value(arb(at)).contains(level.value(arb(-at)).mid())


def test_an_interval_that_the_proof_of_the_curve_does_not_count_gives_no_functions() -> None:
    _, found, chain = proved("line")
    piece = chain.stretches[1].tube.piece.id
    moved = [entry | {"interval": ["-1", "1"]} if entry["piece"] == piece else entry for entry in found]
    parts, gaps = segments_of(1, chain.stretches[1], values(moved))
    assert parts == []
    assert [gap.subject for gap in gaps] == [Matter.EVERYTHING]


def test_functions_of_a_regular_piece_say_nothing_of_the_other_half() -> None:
    """Of two intervals that are mirror images the left one is known with more digits."""
    system = line(1, 1, True)
    atlas = system.atlas(4)
    halves = [(Fraction(-1), Fraction(1, 8)), (Fraction(-1, 8), Fraction(1))]
    found = [result(system, piece, half, 1e-7) for piece in atlas.curve_pieces() for half in halves]
    for number, entry in enumerate(found):
        entry["computation"] = {"precision": 200 - number % 2}
    outcome = conclude(atlas, values(found)).outcome
    assert isinstance(outcome, Proved)
    for number, stretch in enumerate(outcome.results.chain.stretches):
        for part in segments_of(number, stretch, values(found))[0]:
            stored = found[2 * number + (part.middle > 0)]["stability"]["characteristic"][0]
            assert part.characteristic[0].polynomial[1] == function_of(stored).polynomial[1]


def test_of_intervals_alike_each_is_used_up_to_the_middle_of_what_they_share() -> None:
    system = line(1, 1, True)
    atlas = system.atlas(4)
    places = [(Fraction(-1), Fraction(1, 8)), (Fraction(-3, 8), Fraction(3, 4)), (Fraction(-1, 8), Fraction(1))]
    found = [result(system, piece, place, 1e-7) for piece in atlas.curve_pieces() for place in places]
    outcome = conclude(atlas, values(found)).outcome
    assert isinstance(outcome, Proved)
    for number, stretch in enumerate(outcome.results.chain.stretches):
        parts, gaps = segments_of(number, stretch, values(found))
        assert gaps == []
        assert [(part.end, part.middle) for part in parts] == [
            (Fraction(-1, 8), Fraction(-7, 16)),
            (Fraction(5, 16), Fraction(3, 16)),
            (stretch.leaves, Fraction(7, 16)),
        ]


def test_the_second_integration_begins_with_the_error_of_its_points() -> None:
    error = Fraction(1, 2**20)
    other = OtherPoint.of([element(1, 3, error=error), element(2, -1)])
    first, second = other.tube(TUBE, ("a", "b"), [Fraction(1, 2**10)]).values()
    assert first.errors[0] >= error > second.errors[0]


@pytest.mark.parametrize("side", [1, -1])
def test_variations_across_hold_those_of_all_initial_values(side: int) -> None:
    """x'' = -x from 1 + e to -1 - e, and w'' = -x^2 w with unknown |e| <= 1/1024."""
    system = ReversibleSystem(
        name="oscillator across",
        title="an oscillator",
        state=("x", "v"),
        parameters={},
        vector_field=lambda state, _: (state[1], -state[0]),
        reversing_symmetry=(1, -1),
        section="v",
        first_integral=lambda state, _: (state[0] * state[0] + state[1] * state[1],),
        stiffness_across=lambda state, _: (state[0] * state[0],),
    )
    flow = WideArithmetic(Grading((1,), 0), 60, 0, 16, width=4)
    found = variations_across(system, flow, {"x": element(1, error=Fraction(1, 1024))}, SHARE, 1, ORACLE)
    assert isinstance(found, VariationFunctions)
    start = 1 + side / 1024
    true = solve_ivp(
        lambda t, w: [w[1], -((start * np.cos(t)) ** 2) * w[0], w[3], -((start * np.cos(t)) ** 2) * w[2]],
        (0, np.pi),
        [1, 0, 0, 1],
        "DOP853",
        rtol=1e-12,
        atol=1e-12,
    ).y[:, -1]
    for entry, value in zip(found.entries, true[[0, 2, 1, 3]], strict=True):
        enclosure = entry.enclosed
        assert (BoundedFunction(enclosure.polynomial, enclosure.error / 2).value(arb(0)) + arb(0, 1e-9)).contains(
            arb(float(value))
        )


def test_variations_across_have_their_parameter() -> None:
    """V = ((2, 3), (5, 8)): V_11 V_22 + V_12 V_21 = 31; mirrored, those of -tau."""
    known = KnownVariations((bounded(2), bounded(3, 1), bounded(5), bounded(8)))
    assert known.parameter.value(arb(0)).contains(31)
    assert known.mirrored().entries[1].value(arb(0.5)).contains(arb(2.5))


# Stability


@pytest.mark.parametrize("subject", [Matter.EVERYTHING, Resonance(1, 0), Resonance(2, 1)])
def test_stability_is_not_decided_across_a_gap(subject: Any) -> None:
    """The orbits on its two sides are decided apart, and those in it are not."""
    _, _, chain = proved("line")
    flat = bounded(0)
    half = [replace(s, characteristic=(bounded(0),), level=flat) for s in segments("line")]
    gap = Gap(1, "p001", Fraction(-1, 8), Fraction(1, 8), subject, "")
    stable, unknown = stable_intervals(chain, CompleteList(4, 1, (), (gap,), tuple(half)), False)
    assert [(entry.begin.what, entry.end.what) for entry in stable] == [
        ((CurveEnd.BEGINNING,), (subject,)),
        ((subject,), (CurveEnd.END,)),
    ]
    assert [(entry.begin.lower, entry.end.upper) for entry in unknown] == [(Fraction(-1, 8), Fraction(1, 8))]


@pytest.mark.parametrize("closed", [False, True])
def test_stable_orbits_on_both_sides_of_the_cut_of_a_loop_are_one_interval(closed: bool) -> None:
    _, _, chain = proved("line")
    flat = bounded(0)
    parts = [replace(s, characteristic=(bounded(0),), level=flat) for s in segments("line")]
    gap = Gap(1, "p001", Fraction(-1, 8), Fraction(1, 8), Matter.EVERYTHING, "")
    stable, unknown = stable_intervals(chain, CompleteList(4, 1, (), (gap,), tuple(parts)), closed)
    assert len(unknown) == 1
    ends = [(entry.begin.what, entry.end.what) for entry in stable]
    if closed:
        assert ends == [((Matter.EVERYTHING,), (Matter.EVERYTHING,))]
        (entry,) = stable
        assert (entry.begin.upper, entry.end.lower) == (Fraction(1, 8), Fraction(-1, 8))
    else:
        assert len(ends) == 2


@pytest.mark.parametrize(("trace", "product", "stable"), [(0, Fraction(-1, 4), True), (3, Fraction(35, 16), False)])
def test_two_parameters_beyond_one_are_not_stable(trace: Any, product: Any, stable: bool) -> None:
    _, _, chain = proved("line")
    parts = [replace(s, characteristic=(bounded(trace), bounded(product))) for s in segments("line")]
    found, unknown = stable_intervals(chain, CompleteList(4, 2, (), (), tuple(parts)), False)
    assert (len(found), unknown) == (int(stable), [])


def test_orbits_of_which_nothing_is_known_are_neither_stable_nor_unstable() -> None:
    segment = replace(segments("line")[0], characteristic=(bounded(0, error=2),))
    assert is_stable(segment, arb(0)) is None


# Extrema


def test_extrema_with_an_uncertain_value_or_place_are_open() -> None:
    """Sigma = 2 tau^2 - 1 up to e: with e small the extremum at 0 is found, with a large one it is open."""
    flat = bounded(0)
    for error, number in ((Fraction(1, 10**6), 1), (Fraction(1), 0)):
        sigma = bounded(-1, 0, 2, error=error)
        segment = Segment(0, -END, -END, END, ZERO, Fraction(1), (sigma,), flat, flat, flat)
        turns, undecided = extrema_on(segment, 0)
        assert len(turns) == number
        assert bool(undecided) is not bool(number)


def test_where_extrema_are_open_the_list_says_so() -> None:
    for error, number in ((Fraction(1, 10**6), 0), (Fraction(1), 1)):
        work = finder(bounded(-1, 0, 2, error=error), Fraction(-1, 2), Fraction(-1, 2), Fraction(1, 2))
        work.turns()
        assert bool(work.open_extrema) is bool(number)
        assert len(work.extrema) == 1 - number
        assert all(gap.subject is Matter.EXTREMA for gap in work.open_extrema)


# Confirmation


def functions_of(change: Callable[[dict[str, Any]], None] | None = None) -> dict[str, Any]:
    entry = {"coefficients": ["1", "2"], "error": "0x1p-20"}
    names = ("level", "half_period", "first_factor")
    found = {"characteristic": [dict(entry), dict(entry)], **{name: dict(entry) for name in names}}
    found["out_of_plane"] = {name: dict(entry) for name in ("11", "12", "21", "22")}
    if change is not None:
        change(found)
    return found


@pytest.mark.parametrize("place", ["0", "1", "level", "half_period", "first_factor", "11", "12", "21", "22"])
@pytest.mark.parametrize("how", ["coefficient", "bound"])
def test_every_function_is_confirmed(place: str, how: str) -> None:
    """A new integration that found another function, or a bound that is not smaller."""

    def change(found: dict[str, Any]) -> None:
        entries = {**found, **{str(n): e for n, e in enumerate(found["characteristic"])}, **found["out_of_plane"]}
        entry = entries[place]
        entry |= {"coefficients": ["1", "2.001"]} if how == "coefficient" else {"error": "0x1p-18"}

    assert list(unconfirmed_of(functions_of(), functions_of())) == []
    assert len(list(unconfirmed_of(functions_of(), functions_of(change)))) == 1


def test_what_is_not_found_again_is_not_confirmed() -> None:
    none = {"reason": {"message": "the tube is too wide"}}
    assert list(unconfirmed_of(functions_of(), none))
    assert list(unconfirmed_of(none, functions_of())) == []
    fewer, across = functions_of(), functions_of()
    fewer["characteristic"] = fewer["characteristic"][:1]
    del across["out_of_plane"]
    assert list(unconfirmed_of(functions_of(), fewer))
    assert list(unconfirmed_of(functions_of(), across))


# Distances


def test_extremes_of_parts_at_different_points_are_along_the_orbit() -> None:
    first, second = Extreme(arb(3, 1), Where.HERE), Extreme(arb(8, 1), Where.THERE)
    both = joined([first, second])
    assert both.where is Where.ALONG
    assert both.square.contains(arb(2.5))
    assert both.square.contains(arb(8.5))
    assert joined([first, first]).where is Where.HERE


# Kinds of points, on a list from closed forms


@pytest.mark.parametrize(("function_here", "kind"), [((0, 1), "changes"), ((1, 0), "keeps"), ((0, 0), "open")])
def test_a_factor_that_changes_sign_is_told_from_one_that_does_not(function_here: Any, kind: str) -> None:
    """Sigma = 1 + s or -1 + s; level' or det A is s, or 1, or not known."""
    atlas, _, chain = proved("line")
    error = 1 if kind == "open" else 0
    factor = bounded(*function_here, error=error)
    level = (
        bounded(0, 0, Fraction(1, 2), error=error) if kind == "changes" else bounded(0, function_here[0], error=error)
    )
    kinds = {"changes": (Kind.FOLD, Kind.HERE), "keeps": (Kind.LOSS, Kind.THERE), "open": (Kind.UNDECIDED,) * 2}[kind]
    for k, expected in zip((1, 2), kinds, strict=True):
        value = round(cos(2 * pi * (k - 1) / k))
        segment = Segment(
            1, -END, -END, END, ZERO, Fraction(1), (bounded(value, 1),), level, bounded(3), factor
        )  # fmt: skip
        work = Finder(atlas, chain.stretches[1], segment)
        work.resonances(k, k - 1)
        (point,) = work.points
        assert point.kind is expected
