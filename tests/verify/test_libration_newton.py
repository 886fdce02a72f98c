"""The Newton operator over sizes and masses holds every function that an element encloses, everywhere on a piece."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx, fmpq, fmpq_poly
from support.flow_checks import ball

from orbitproof.shared.formats import read_atlas
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.evidence import NotEstablishedError, NotProved, Proved, hull
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.surface import libration_piece as chapter
from orbitproof.verify.surface import prove_libration_piece
from orbitproof.verify.surface.libration_piece import BOX, _Newton

ONE = Fraction(1)
WHOLE = (-ONE, ONE)


def value_of(terms: Sequence[tuple[Fraction, int, int, int]], s: Fraction, x: Fraction, w: Fraction) -> Fraction:
    """The sum of c s^l x^i w^j."""
    return sum((c * s**k * x**i * w**j for c, k, i, j in terms), Fraction(0))


def slope_of(terms: Sequence[tuple[Fraction, int, int, int]], s: Fraction, x: Fraction, w: Fraction) -> Fraction:
    return sum((c * s**k * x**i * j * w ** (j - 1) for c, k, i, j in terms if j), Fraction(0))


@pytest.mark.parametrize("grading", [Grading((1, 4), 6), Grading((1, 1), 3)], ids=["that of pieces", "another"])
def test_an_image_holds_the_newton_steps_of_every_function_that_is_enclosed(grading: Grading) -> None:
    """Of sums of known and unknown terms, at points where each unknown term is as large as it may be."""
    source = random.Random(3)
    weight = grading.weights[1]
    for number in range(80):
        arithmetic = WideArithmetic(grading, 60, 0, 4, width=4)
        known = {
            exponents: [Fraction(source.randint(-16, 16), 512) for _ in range(3)] for exponents in grading.monomials
        }
        # Large, so that an image is as wide as the derivative is unknown.
        known[0, 0] = [Fraction(source.choice((-32, 32))), *known[0, 0][1:]]
        known[0, 1] = [Fraction(source.choice((-4, 4))), *known[0, 1][1:]]
        errors = [0.0] * (grading.top + 2)
        errors[number % len(errors)] = source.random() / 4
        terms = [(c, k, i, j) for (i, j), row in known.items() for k, c in enumerate(row)]
        for grade, error in enumerate(errors):
            j = source.randint(0, grade // weight if grade <= grading.top else 8)
            size, k = source.choice((-1, 1)) * Fraction(error), source.choice((0, 1, 6))
            terms.append((size, k, max(0, grade - weight * j), j))
        newton = _Newton(arithmetic.polynomial(known).with_errors(errors))
        # Narrow parts at the edges, where nothing but the unknown terms makes an image wide, and wide ones.
        width = source.choice((ONE / 2**40, ONE))
        sigma, across = source.choice(((-ONE, width - ONE), (ONE - width, ONE))), source.choice((-1, 1))
        across = tuple(sorted((across * BOX, across * (BOX - width))))
        with ctx.workprec(100):
            image = newton.image(sigma, across)  # type: ignore[arg-type]
            assert image is not None
            for s, x, w in product(sigma, across, (-BOX, Fraction(0), BOX)):
                assert image.contains(ball(-value_of(terms, s, x, Fraction(0)) / slope_of(terms, s, x, w)))


def peaked(height: Fraction, s: Fraction, x: Fraction, slope: Sequence[Fraction] = (ONE,)) -> Series:
    """w + height P(sigma) Q(xi), where P and Q have their greatest value, 1, at s and x."""
    rows = []
    for place, power in ((s, 6), (x, 3)):
        away = fmpq_poly([-fmpq(place.numerator, 2 * place.denominator), fmpq(1, 2)])
        rows.append([Fraction(int(c.p), int(c.q)) for c in ((1 - away**2) ** power).coeffs()])
    along, across = rows
    terms: dict[Any, Any] = {(i, 0): [height * a * b for a in along] for i, b in enumerate(across)}
    arithmetic = WideArithmetic(Grading((1, 4), 6), 80, 0, 4, width=16)
    return arithmetic.polynomial({**terms, (0, 1): list(slope)})


PLACES = [(s, x * BOX) for s, x in product((-ONE, -ONE / 3, ONE / 5, ONE), repeat=2)]


@pytest.mark.parametrize("place", PLACES, ids=str)
def test_what_leaves_the_tube_at_one_point_of_the_piece_is_refused(place: tuple[Fraction, Fraction]) -> None:
    with ctx.workprec(100):
        inside = [*_Newton(peaked(BOX * Fraction(7, 8), *place)).images()]
        assert all(abs(image) < ball(BOX) for image in inside)
        assert hull(*inside).contains(ball(-BOX * Fraction(7, 8)))
        with pytest.raises(NotEstablishedError, match="leaves the tube"):
            [*_Newton(peaked(BOX * Fraction(65, 64), *place)).images()]


def test_where_the_derivative_may_vanish_there_is_no_image() -> None:
    """At sigma = s, even if the function does not."""
    for s in (-ONE, ONE / 7, ONE):
        element = peaked(Fraction(0), s, Fraction(0), (-s, ONE))
        with ctx.workprec(100):
            assert _Newton(element).image(WHOLE, (-BOX, BOX)) is None
            with pytest.raises(NotEstablishedError, match="may vanish"):
                [*_Newton(element).images()]


@pytest.mark.parametrize("place", PLACES[::5], ids=str)
def test_the_deviation_is_that_of_the_point_that_is_farthest_off(
    place: tuple[Fraction, Fraction], monkeypatch: pytest.MonkeyPatch
) -> None:
    piece = read_atlas(Path(__file__).parents[1] / "data" / "surface-planar.json").libration_pieces()[0]
    element = peaked(BOX * Fraction(7, 8), *place)
    monkeypatch.setattr(chapter, "_half_return", lambda *_: (element, arb(1), 1))
    found = prove_libration_piece(piece, WHOLE, ORACLE)
    assert isinstance(found.outcome, Proved)
    deviation = found.outcome.results.deviation
    assert Fraction(7, 8) * piece.tube <= deviation < piece.tube
    element = peaked(BOX * Fraction(65, 64), *place)
    beyond = prove_libration_piece(piece, WHOLE, ORACLE)
    assert isinstance(beyond.outcome, NotProved)
    assert beyond.outcome.reason.condition == "newton"
