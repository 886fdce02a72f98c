"""A proved piece contains the curve, and nothing that is not a piece of a curve is proved.

In the system `TWIST` the symmetric orbits are the circle a^2 + c^2 = 1 and the line c = 0, exactly."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import arb, arb_poly, ctx
from support.exact_elements import number
from support.flow_checks import ball
from support.piece_cases import (
    LINE,
    ONE,
    REGULAR,
    SYMMETRIC,
    WHOLE,
    ZERO,
    check_circle,
    known_piece,
    places,
    prove,
    proved_interval,
    refused,
    slow,
    with_terms,
)
from support.reference import Orbits, falkner_skan, three_body
from support.wide_checks import MU, libration_point
from support.within import within

from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, ReversibleSystem
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.branches import condition_of
from orbitproof.verify.curve import UNCLEAR_SLOPE, Equation, PieceLimits, check_newton, prove_piece
from orbitproof.verify.curve.equation import combined, inverse_near, values_on
from orbitproof.verify.evidence import Checklist, IntegrationFailure, exact_value
from orbitproof.verify.oracle import ORACLE

BITS = 110

_reference_precision = within(lambda: mpmath.workprec(200))


INTERVALS = [
    WHOLE,
    (Fraction(0), Fraction(1, 1000)),
    (Fraction(-1), Fraction(1, 3)),
    (Fraction(1, 100), Fraction(1)),
    (Fraction(-3, 7), Fraction(-1, 7)),
]


@pytest.mark.parametrize("interval", [*INTERVALS[:2], *slow(*INTERVALS[2:])], ids=str)
@pytest.mark.parametrize("piece", [SYMMETRIC, REGULAR], ids=["symmetric", "regular"])
def test_proved_pieces_hold_the_circle(piece: Piece, interval: tuple[Fraction, Fraction]) -> None:
    """Also through the symmetry breaking at s = 0; the interval of the proof covers what was asked for."""
    result = prove(piece, interval)
    check_circle(piece, result)
    known = proved_interval(result)
    assert known.start <= interval[0] < interval[1] <= known.end
    assert known.deviation[0] < Fraction(5, 10**8)
    for s in places(interval, 5):
        a = number(piece.point(s)[0])
        time = mpmath.pi / (1 + a * a / 4)
        assert abs(time - mpmath.mpf(known.time.mid().str(40, radius=False))) <= float(known.time.rad()) + 1e-6


@pytest.mark.parametrize("piece", [SYMMETRIC, REGULAR], ids=["symmetric", "regular"])
def test_deviations_are_about_as_large_as_they_are(piece: Piece) -> None:
    """A polynomial that is off by 1e-8 (1 - 3 s^2) lies so far from the curve, and not much farther."""
    off = with_terms(piece, {0: Fraction(1, 10**8), 2: Fraction(-3, 10**8)})
    result = prove(off)
    check_circle(off, result)
    known = proved_interval(result)
    assert Fraction(2, 10**8) <= known.deviation[0] <= Fraction(3, 10**8)
    assert Fraction(6, 10**8) <= known.slope_deviation[0] <= Fraction(2, 10**6)


@pytest.mark.parametrize("interval", [(ZERO, Fraction(1, 1000)), (Fraction(1, 10), Fraction(1, 5))], ids=str)
def test_slopes_of_symmetric_pieces_are_relative_to_s(interval: tuple[Fraction, Fraction]) -> None:
    off = with_terms(SYMMETRIC, {2: Fraction(5, 10**8)})
    check_circle(off, prove(off, interval))


@pytest.mark.slow
def test_parts_of_a_piece_agree() -> None:
    """What is proved on overlapping intervals is one curve: deviations leave room for it on both."""
    off = with_terms(REGULAR, {1: Fraction(1, 10**8)})
    parts = [(Fraction(-1), Fraction(-2, 5)), (Fraction(-1, 2), Fraction(1, 2)), (Fraction(2, 5), Fraction(1))]
    deviations = [proved_interval(prove(off, interval)).deviation[0] for interval in parts]
    assert deviations[1] < deviations[0]
    assert deviations[1] < deviations[2]
    assert Fraction(5, 10**9) <= deviations[1] < Fraction(6, 10**9)


def test_the_line_is_proved_away_from_the_symmetry_breaking() -> None:
    assert proved_interval(prove(LINE)).deviation[0] < Fraction(1, 10**9)


@pytest.mark.parametrize("seeds", [(0, 3, 4), *slow(range(5, 62))])
def test_whatever_is_proved_holds_the_circle(seeds: Iterable[int]) -> None:
    """Random polynomials around the true one, with random tubes: proved or not, never wrong."""
    proved = set()
    for seed in seeds:
        source = random.Random(seed)
        piece = source.choice((REGULAR, SYMMETRIC))
        power = 2 * source.randint(0, 5) if piece is SYMMETRIC else source.randint(0, 10)
        piece = replace(piece, tube=(Fraction(10.0 ** source.uniform(-7, -1.5)),))
        piece = with_terms(piece, {power: Fraction(10.0 ** source.uniform(-9, -2))})
        result = prove(piece, source.choice(INTERVALS))
        proved.add(result.is_proved)
        if result.is_proved:
            check_circle(piece, result)
    assert proved == {True, False}


@pytest.mark.parametrize("seed", range(20))
def test_derivatives_of_the_equation_hold_its_unknown_parts(seed: int) -> None:
    """F = 1/8 + s/4 + w + unknown parts of every grade, at real points with |s| <= 16/17 and |w| <= 1/2."""
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 4, width=2)
    known = arithmetic.polynomial({(0,): [Fraction(1, 8), Fraction(1, 4)], (1,): ONE})
    errors = [source.random() for _ in range(3)]
    powers = [source.choice((0, 1, 2, 7)), source.choice((0, 1, 2, 7)), source.choice((0, 3))]
    top = source.choice((2, 3))
    s, w = Fraction(source.choice((-16, 16, source.randint(-16, 16))), 17), Fraction(source.choice((-1, 1)), 2)
    monomials = [(powers[0], 0), (powers[1], 1), (powers[2], top)]
    value = Fraction(1, 8) + s / 4 + Fraction(errors[0]) * s ** powers[0]
    slope = 1 + sum(Fraction(e) * s**i * j * w ** (j - 1) for e, (i, j) in zip(errors, monomials, strict=True) if j)
    change = sum(Fraction(e) * i * s ** (i - 1) * w**j for e, (i, j) in zip(errors, monomials, strict=True) if i)
    equation = Equation(known.with_errors(errors))
    with ctx.workprec(100):
        part = ball(s) + arb(0, 1) / 64
        assert equation.value(part).contains(ball(value))
        assert equation.slope(0, part).contains(ball(slope))
        assert values_on(part, *equation.along([ball(w)], False)).contains(ball(Fraction(1, 4) + change))


@pytest.mark.parametrize("power", [2, 4, 16, 32])
@pytest.mark.parametrize("grade", [0, 1, 2])
def test_derivatives_divided_by_s_hold_the_unknown_parts_of_an_even_function(power: int, grade: int) -> None:
    """F = 1/8 + s^2/4 + w + e s^power w^grade: F'/s, at s = 16/17."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 4, width=2)
    known = arithmetic.polynomial({(0,): [Fraction(1, 8), Fraction(0), Fraction(1, 4)], (1,): ONE})
    errors = [0.5 if each == grade else 0.0 for each in range(3)]
    s, w = Fraction(16, 17), Fraction(1, 2)
    truth = Fraction(1, 2) + Fraction(1, 2) * power * s ** (power - 2) * w**grade
    with ctx.workprec(100):
        found = values_on(ball(s), *Equation(known.with_errors(errors)).along([ball(w)], True))
        assert found.contains(ball(truth))


def nearly_dependent(source: random.Random, weak: Fraction) -> tuple[WideArithmetic, list[Series], list[Any]]:
    """F with singular values of about 2 and `weak`, whose directions turn with sigma, and the functions themselves.

    The first component is f + omega_1 + sigma omega_2, the second sigma times the first, and weak omega_2.
    """
    arithmetic = WideArithmetic(Grading((1, 1), 1), 100, 0, 4, width=4)
    f = [Fraction(source.randint(-9, 9), 10**12) for _ in range(3)]
    known = [
        arithmetic.polynomial({(0, 0): f, (1, 0): ONE, (0, 1): [ZERO, ONE]}),
        arithmetic.polynomial({(0, 0): [ZERO, *f], (1, 0): [ZERO, ONE], (0, 1): [weak, ZERO, ONE]}),
    ]

    def value(s: Fraction, v: Fraction, w: Fraction) -> Fraction:
        return sum((c * s**n for n, c in enumerate(f)), ZERO) + v + s * w

    functions = [value, lambda s, v, w: s * value(s, v, w) + weak * w]
    return arithmetic, known, functions


@pytest.mark.parametrize("seed", range(20))
def test_combinations_of_the_equations_hold_their_unknown_parts(seed: int) -> None:
    """F + e_0 sigma^a + e_1 sigma^b omega_1 + e_2 omega_1^2 omega_2 for each component, times polynomials."""
    source = random.Random(seed)
    _, known, functions = nearly_dependent(source, Fraction(1, 100))
    errors = [[source.random() for _ in range(3)] for _ in known]
    a, b = (source.choice((0, 1, 2, 7)) for _ in range(2))
    s, v, w = (Fraction(source.choice((-1, 1)) * source.randint(9, 16), d) for d in (17, 32, 32))
    made = [Equation(each.with_errors(own)) for each, own in zip(known, errors, strict=True)]
    signs = [source.choice((-1, 1)) for _ in known]
    unknown = [[sign * Fraction(e) for e in own] for sign, own in zip(signs, errors, strict=True)]
    eps = Fraction(1, 10**9)
    with ctx.workprec(150):
        part = ball(s) + arb(0, 1) / 64
        for row in inverse_near(made, part.mid() + arb(1) / 128):
            at = [exact_value(weight(ball(s)).mid()) for weight in row]
            values = [f(s, ZERO, ZERO) + e[0] * s**a for f, e in zip(functions, unknown, strict=True)]
            slopes = [
                (f(s, ONE, ZERO) - f(s, ZERO, ZERO)) + e[1] * s**b + 2 * e[2] * v * w
                for f, e in zip(functions, unknown, strict=True)
            ]
            turned = [
                (f(s + eps, v, w) - f(s - eps, v, w)) / (2 * eps)
                + (e[0] * a * s ** (a - 1) if a else 0)
                + (e[1] * b * s ** (b - 1) * v if b else 0)
                for f, e in zip(functions, unknown, strict=True)
            ]
            for truth, enclosed in (
                (values, [each.at_zero for each in made]),
                (slopes, [each.across(0) for each in made]),
                (turned, [each.along([ball(v), ball(w)], False) for each in made]),
            ):
                exact = sum((x * y for x, y in zip(at, truth, strict=True)), ZERO)
                found = combined(row, enclosed, part)
                assert abs(exact_value(found.mid()) - exact) <= exact_value(found.rad()) + Fraction(1, 10**12)


def test_nearly_dependent_equations_are_told_apart_on_large_parts() -> None:
    """Singular values 2 and 1e-9, whose directions turn along the piece: balls of the components tell nothing."""
    _, known, _ = nearly_dependent(random.Random(1), Fraction(1, 10**9))
    with ctx.workprec(150):
        deviation, slope = check_newton(Checklist(), known, ONE)
        # omega_1 = -f is the zero, and omega_2 = 0.
        assert float(deviation[0]) < 3e-11
        assert float(deviation[1]) < 1e-3
        assert float(slope[0]) < 1


def test_what_is_unknown_counts_with_the_largest_weight_on_the_part() -> None:
    weight, unknown = arb_poly([0, 0, 1]), (arb_poly(), arb(1))
    for part, largest in ((arb(0, 1), ONE), (arb("0.5", "0.25"), Fraction(9, 16))):
        found = combined([weight], [unknown], part)
        assert found.contains(ball(largest))
        assert found.contains(ball(-largest))


def newton(*components: Mapping[tuple[int, ...], Sequence[Fraction]], divided: bool = False, top: int = 1) -> Any:
    """Bounds of omega and of its slopes for known functions of |sigma| <= 16/17."""
    arithmetic = WideArithmetic(Grading((1,) * len(components), top), 100, 0, 4, width=4)
    with ctx.workprec(150):
        return check_newton(Checklist(), [arithmetic.polynomial(each) for each in components], ONE, divided)


SMALL, EDGE = Fraction(1, 1000), Fraction(16, 17)


@pytest.mark.parametrize("divided", [False, True])
def test_slopes_are_those_at_the_curve_on_all_of_the_interval(divided: bool) -> None:
    """omega = SMALL/(1 + s/2), with s^2 for s where it is even: what depends on s is the factor of omega alone."""
    power = 2 if divided else 1
    _, (slope,) = newton({(0,): [-SMALL], (1,): [ONE, *[ZERO] * (power - 1), ONE / 2]}, divided=divided)
    # The slope is largest at one end, divided by s at the middle.
    truth = SMALL if divided else SMALL / 2 / (1 - EDGE / 2) ** 2
    assert ball(truth) <= slope
    assert slope < ball(3 * truth)


def test_slopes_are_the_largest_on_each_part() -> None:
    _, (slope,) = newton({(0,): [ZERO, ZERO, -SMALL], (1,): ONE})
    assert slope >= ball(2 * SMALL * EDGE)


@pytest.mark.parametrize("place", [Fraction(1, 3), Fraction(1, 4), ZERO, EDGE], ids=str)
@pytest.mark.parametrize("times", [1, 2])
def test_a_derivative_that_is_singular_at_one_s_is_told_from_a_nearly_singular_one(place: Fraction, times: int) -> None:
    """omega = 0 is a zero for every s; at one s all of a line are, however the parts lie about it."""
    factor = [-place, ONE] if times == 1 else [place**2, -2 * place, ONE]
    with pytest.raises(IntegrationFailure, match=r"singular|changes its sign"):
        newton({(0, 0): [ZERO], (1, 0): ONE}, {(0, 0): [ZERO], (1, 0): [ZERO, ONE], (0, 1): factor})


def test_of_two_curves_in_the_tube_none_is_proved() -> None:
    """(omega - 1/1000)(omega + 9/20), the second derivative being known; with the other zero at -2 it is proved."""
    for other in (Fraction(9, 20), Fraction(2)):
        equation = {(0,): [-SMALL * other], (1,): [other - SMALL], (2,): ONE}
        if other < 1:
            with pytest.raises(IntegrationFailure, match="singular"):
                newton(equation, top=2)
        else:
            (omega,), _ = newton(equation, top=2)
            assert ball(SMALL) <= omega < ball(3 * SMALL)


@pytest.mark.parametrize("grade", [0, 1, 2])
@pytest.mark.parametrize("error", [math.inf, math.nan])
def test_a_return_that_is_not_enclosed_is_told_as_that(error: float, grade: int) -> None:
    _, known, _ = nearly_dependent(random.Random(1), ONE)
    errors = [error if each == grade else 0.0 for each in range(3)]
    with pytest.raises(IntegrationFailure, match="the half return was not enclosed"):
        check_newton(Checklist(), [known[0], known[1].with_errors(errors)], ONE)


def equations(system: ReversibleSystem) -> Callable[[Sequence[Fraction]], list[Any]]:
    """q at the first return, by an independent integrator."""
    if system is FALKNER_SKAN:
        orbits = Orbits(falkner_skan, system.section_index, BITS)
        return lambda point: [number(orbits.crossings([ZERO, point[1], ZERO], [point[0]], 1)[0].state[0])]
    orbits = Orbits(three_body, 1, BITS)
    if system is CR3BP:

        def spatial(point: Sequence[Fraction]) -> list[Any]:
            x, z, vy = point
            state = orbits.crossings([x, ZERO, z, ZERO, vy, ZERO], [MU], 1)[0].state
            return [number(state[3]), number(state[5])]

        return spatial

    def planar(point: Sequence[Fraction]) -> list[Any]:
        eps, vy = point
        start = [libration_point() + eps, ZERO, ZERO, ZERO, eps * vy, ZERO]
        return [number(orbits.crossings(start, [MU], 1)[0].state[3] / eps)]

    return planar


def true_distances(system: ReversibleSystem, piece: Piece, s: Fraction) -> list[Any]:
    """p_j of the orbit at s less the polynomial, by one Newton step with finite differences."""
    function, size = equations(system), len(piece.tube)
    columns = list(zip(*piece.frame, strict=True))[1:]
    point, shift = piece.point(s), Fraction(1, 2**50)
    value = function(point)
    slopes = mpmath.matrix(size, size)
    for j, column in enumerate(columns):
        moved = function([x + shift * direction for x, direction in zip(point, column, strict=True)])
        for i in range(size):
            slopes[i, j] = (moved[i] - value[i]) / number(shift)
    return [-x for x in mpmath.lu_solve(slopes, mpmath.matrix(value))]


CASES = {
    "falkner-skan": (Fraction(-1, 16), Fraction(1, 16)),
    "symmetric": (Fraction(-1, 16), Fraction(1, 16)),
    "lyapunov": (Fraction(1, 4), Fraction(5, 16)),
    "regularised": (Fraction(-1, 32), Fraction(1, 32)),
}


def check_orbits(name: str, interval: tuple[Fraction, Fraction], limits: PieceLimits, count: int) -> None:
    """The true branch, and its slope, at random s."""
    system, parameters, symmetry, piece = known_piece(name)
    result = prove_piece(system, parameters, piece, interval, ORACLE, limits, None, symmetry)
    known = proved_interval(result)
    if name == "regularised":
        assert result.computation.coordinates != "physical"
    step = Fraction(1, 2**20)
    for s in places((known.start, known.end), count)[-count:]:
        s = s or step
        here = true_distances(system, piece, s)
        there = true_distances(system, piece, s + step)
        for j, (value, other) in enumerate(zip(here, there, strict=True)):
            assert abs(value) <= number(known.deviation[j]) * (1 + mpmath.mpf(2) ** -20)
            scale = abs(s) + step if piece.kind == "symmetric" else ONE
            assert abs(other - value) / number(step) <= number(known.slope_deviation[j] * scale) + 1e-20


@pytest.mark.parametrize("name", ["falkner-skan", "symmetric"])
def test_proved_pieces_hold_independent_orbits(name: str) -> None:
    check_orbits(name, CASES[name], PieceLimits(60, 24, 10), 2)


L3 = (Fraction(-1, 512), Fraction(1, 512))
L3_LIMITS = PieceLimits(72, 36, 4), PieceLimits(72, 36, 4, top=2)


@pytest.mark.slow
def test_where_derivatives_are_nearly_singular_the_second_ones_are_followed() -> None:
    """L3 halo orbits: one singular value of the derivative is 36000 times the other."""
    system, parameters, symmetry, piece = known_piece("l3-halo")
    results = [prove_piece(system, parameters, piece, L3, ORACLE, limits, None, symmetry) for limits in L3_LIMITS]
    assert condition_of(results[0].stored) == UNCLEAR_SLOPE
    assert max(proved_interval(results[1]).deviation) < min(piece.tube) / 100


@pytest.mark.slow
def test_l3_halo_orbits_are_independent_ones() -> None:
    check_orbits("l3-halo", L3, L3_LIMITS[1], 1)


@pytest.mark.slow
def test_a_curve_beside_orbits_with_nearly_singular_derivatives_is_refused() -> None:
    """The curve lies outside of the tube."""
    system, parameters, symmetry, piece = known_piece("l3-halo")
    beside = with_terms(piece, {0: 2 * piece.tube[0]})
    assert "tube" in refused(prove_piece(system, parameters, beside, L3, ORACLE, L3_LIMITS[1], None, symmetry))


@pytest.mark.slow
@pytest.mark.parametrize("interval", ["case", "whole", "end"])
@pytest.mark.parametrize("name", CASES)
def test_proved_pieces_hold_many_independent_orbits(name: str, interval: str) -> None:
    ranges = {"case": CASES[name], "whole": WHOLE, "end": (Fraction(3, 4), ONE)}
    check_orbits(name, ranges[interval], PieceLimits(), 8)


@pytest.mark.slow
def test_halo_and_lyapunov_orbits_are_not_one_piece() -> None:
    """The symmetric piece of halo orbits as a regular one, the planar orbits through it, and a jump between them."""
    system, parameters, _, piece = known_piece("symmetric")
    limits, part = PieceLimits(60, 24, 10), (Fraction(-1, 16), Fraction(1, 16))
    for tube in (piece.tube, (Fraction(1, 10**6),) * 2):
        regular = replace(piece, kind="regular", tube=tube)
        reason = refused(prove_piece(system, parameters, regular, part, ORACLE, limits))
        assert "derivative across the curve" in reason or "not well inside" in reason
    # The tangent of the planar orbits at the symmetry breaking, along x.
    for bend in (ZERO, Fraction(1, 1000)):
        planar = Piece(
            "planar", "regular", piece.centre, ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (Fraction(-8), ZERO, ONE)),
            Fraction(1, 10**6), ((ZERO, bend), (ZERO,)), (Fraction(1, 10**4),) * 2, "physical",
        )  # fmt: skip
        refused(prove_piece(system, parameters, planar, WHOLE, ORACLE, limits))
