"""Tubes of random pieces, exactly: enclosures hold all curves, and what is said of them holds up to the last bit."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, ctx
from support.balls import agree
from support.inclusion import broken_inclusions
from support.random_pieces import coordinates, corners, image, number, random_piece, random_run, values
from support.within import within

from orbitproof.shared.claims import Piece
from orbitproof.verify.curve.gluing import Stretch
from orbitproof.verify.curve.tube import Tube
from orbitproof.verify.evidence import enclose

BITS = 200
SIZES = [1, 2, 3]
LITTLE = Fraction(1, 2**16)

precision = within(lambda: ctx.workprec(BITS))


def holds(balls: Sequence[arb], exact: Sequence[Fraction]) -> bool:
    return len(balls) == len(exact) and all(
        agree(ball, enclose(value)) for ball, value in zip(balls, exact, strict=True)
    )


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("size", SIZES)
def test_enclosures_hold_every_curve_of_the_tube(size: int, symmetric: bool) -> None:
    chance = random.Random(size)
    for _ in range(6):
        piece, other = random_piece(chance, size, 2 + 2 * symmetric, symmetric), random_piece(chance, size)
        run = random_run(chance, size)
        tube, elsewhere = Tube(piece, (run,)), Tube(other, ())
        for _ in range(4):
            part = chance.choice(run.intervals)
            s = part.start + (part.end - part.start) * Fraction(chance.randint(0, 64), 64)
            errors, known = corners(run.at(s).deviation, chance), run.at(s).slope_deviation
            p = [piece.half_width * s, *(values(c, s) + e for c, e in zip(piece.polynomial, errors, strict=True))]
            rates = corners([bound * (abs(s) if symmetric else 1) for bound in known], chance)
            slope = [piece.half_width, *(values(c, s, 1) + e for c, e in zip(piece.polynomial, rates, strict=True))]
            point = coordinates(piece, p)
            assert holds(tube.local(run, s), p)
            assert holds(tube.local_slope(run, s), slope)
            assert holds(tube.point(run, s), point)
            balls = list(map(enclose, p)), list(map(enclose, slope))
            assert holds(tube.to_local(list(map(enclose, point))), p)
            assert agree(tube.parameter(balls[0]), enclose(s))
            assert holds(tube.offsets(enclose(s), balls[0]), errors)
            there, rate = elsewhere.from_piece(piece, *balls)
            assert holds(
                [enclose(c) + each for c, each in zip(other.centre, applied(other, there), strict=True)], point
            )
            assert holds(applied(other, rate), image(piece.frame, slope))
            for each, lower, upper in run.between(s - Fraction(1, 32), s + Fraction(1, 32)):
                beyond = chance.choice([lower, upper, (lower + upper) / 2])
                across = [
                    values(c, beyond) + e
                    for c, e in zip(piece.polynomial, corners(each.deviation, chance), strict=True)
                ]
                assert holds(
                    tube.points(each.deviation, lower, upper), coordinates(piece, [piece.half_width * beyond, *across])
                )


def applied(piece: Piece, p: Sequence[arb]) -> list[arb]:
    """The frame times balls."""
    return [sum((enclose(a) * b for a, b in zip(row, p, strict=True)), arb(0)) for row in piece.frame]


@pytest.mark.parametrize("size", SIZES)
def test_balls_of_points_give_balls(size: int) -> None:
    chance = random.Random(size)
    piece, other = random_piece(chance, size), random_piece(chance, size)
    tube = Tube(piece, (random_run(chance, size),))
    p, s = [enclose(number(chance)) for _ in range(size + 1)], enclose(number(chance))
    assert not broken_inclusions(tube.to_local, (p,), chance)
    assert not broken_inclusions(lambda p, slope: tube.from_piece(other, p, slope), (p, p), chance)
    assert not broken_inclusions(tube.parameter, (p,), chance)
    assert not broken_inclusions(tube.offsets, (s, p), chance)
    edge = [arb(0), *(enclose(c[0] + width - LITTLE) for c, width in zip(piece.polynomial, piece.tube, strict=True))]
    assert tube.contains(arb(0), edge)
    for place in range(1, size + 1):
        for wide in (arb(0, 1) * 2 * enclose(LITTLE), 2 * enclose(LITTLE)):
            assert not tube.contains(arb(0), [ball + wide * (i == place) for i, ball in enumerate(edge)])
    assert not tube.contains(arb(0, 1) / 4, edge)


def least(coefficients: Sequence[Fraction], lower: Fraction, upper: Fraction) -> Fraction:
    """Of a polynomial of degree 2 on an interval, exactly."""
    a, b, c = (*coefficients, *[Fraction(0)] * 3)[:3]
    places = [lower, upper, *([-b / (2 * c)] if c and lower < -b / (2 * c) < upper else [])]
    return min(a + b * s + c * s * s for s in places)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("size", SIZES)
def test_a_coordinate_has_a_sign_where_its_least_value_exceeds_what_is_unknown(size: int, sign: int) -> None:
    chance = random.Random(size)
    for _ in range(6):
        piece, run = random_piece(chance, size), random_run(chance, size)
        lower, upper = sorted(number(chance) for _ in range(2))
        for index in range(size + 1):
            margins = []
            for part, first, last in run.between(lower, upper):
                unknown = image([list(map(abs, piece.frame[index][1:]))], part.deviation)[0]
                margins.append(least([sign * c for c in curve_of(piece, index)], first, last) - unknown)
            for margin, wanted in ((LITTLE, True), (-LITTLE, False)):
                shift = sign * (margin - min(margins))
                centre = tuple(c + shift * (i == index) for i, c in enumerate(piece.centre))
                tube = Tube(replace(piece, centre=centre), (run,))
                assert tube.coordinate_is_beyond_zero(index, sign, run, lower, upper) == wanted


def curve_of(piece: Piece, index: int) -> list[Fraction]:
    """A coordinate of the curve as a polynomial in s."""
    first, *weights = piece.frame[index]
    found = image(list(zip(*piece.polynomial, strict=True)), weights)
    found[0] += piece.centre[index]
    found[1] += first * piece.half_width
    return found


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("size", SIZES)
def test_a_coordinate_increases_where_its_least_slope_exceeds_what_is_unknown(size: int, symmetric: bool) -> None:
    chance = random.Random(size)
    for _ in range(6):
        piece, run = random_piece(chance, size, 4 if symmetric else 3, symmetric), random_run(chance, size)
        lower, upper = sorted(number(chance) for _ in range(2))
        if symmetric and lower < 0 < upper:
            lower = Fraction(0)
        side = 1 if not symmetric or lower >= 0 else -1
        for index in range(int(symmetric), size + 1):
            # The derivative, divided by s on a symmetric piece, and what one coefficient of the polynomials adds to it.
            slope = [n * c for n, c in enumerate(curve_of(piece, index))][1 + symmetric :]
            margins = []
            for part, first, last in run.between(lower, upper):
                unknown = image([list(map(abs, piece.frame[index][1:]))], part.slope_deviation)[0]
                margins.append(least([side * c for c in slope], first, last) - unknown)
            weight = piece.frame[index][1]
            for margin, wanted in ((LITTLE, True), (-LITTLE, False)):
                if not weight:
                    continue
                more = side * (margin - min(margins)) / weight / (1 + symmetric)
                first_row = tuple(c + more * (n == 1 + symmetric) for n, c in enumerate(piece.polynomial[0]))
                changed = replace(piece, polynomial=(first_row, *piece.polynomial[1:]))
                assert Tube(changed, (run,)).coordinate_increases(index, run, lower, upper) == wanted


def test_a_stretch_contains_what_lies_between_where_it_is_surely_entered_and_left() -> None:
    chance = random.Random(1)
    run = random_run(chance, 1)
    tube = Tube(random_piece(chance, 1), (run,))
    stretch = Stretch(tube, run, Fraction(-1, 2), Fraction(-1, 4), Fraction(1, 2))
    for middle, radius, wanted in ((0, 15, True), (0, 24, False), (-24, 0, False), (24, 7, True), (24, 16, False)):
        ball = enclose(Fraction(middle, 64)) + arb(0, 1) * enclose(Fraction(radius, 64))
        assert stretch.contains(ball) == wanted
