"""One zero of a function in a box, and nearly singular matrices with a border."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction

import pytest
from flint import arb

from orbitproof.verify.evidence import Checklist, NotEstablishedError, enclose
from orbitproof.verify.newton import bordered, enclose_zero, left_kernel

Matrix = list[list[arb]]


def found(matrix_over: Callable[[Sequence[arb]], Matrix], residual: Sequence[arb], *radii: Fraction) -> list[arb]:
    names = [f"p_{place}" for place in range(len(radii))]
    with Checklist().hypothesis("point", "7.5", "there is one zero", "move the centre") as evidence:
        return enclose_zero(evidence, matrix_over, residual, radii, names)
    raise AssertionError


@pytest.mark.parametrize("seed", range(12))
def test_the_zero_is_enclosed(seed: int) -> None:
    """f_i(x) = A (x - z) + b_i (x_i^2 - z_i^2), the slopes of which are A and 2 b_i x_i."""
    source, size = random.Random(seed), 1 + seed % 3
    zero = [Fraction(source.randint(-60, 60), 1000) for _ in range(size)]
    bent = [Fraction(source.randint(-20, 20), 100) for _ in range(size)]
    rows = [
        [Fraction(source.randint(-20, 20), 100) + 2 * (i == j) * source.choice((1, -1)) for j in range(size)]
        for i in range(size)
    ]

    def matrix_over(where: Sequence[arb]) -> Matrix:
        slopes = [2 * enclose(b) * x for b, x in zip(bent, where, strict=True)]
        return [
            [enclose(value) + (slopes[i] if i == j else 0) for j, value in enumerate(row)] for i, row in enumerate(rows)
        ]

    residual = [
        enclose(-sum((value * z for value, z in zip(row, zero, strict=True)), Fraction(0)) - b * zero[i] ** 2)
        for i, (row, b) in enumerate(zip(rows, bent, strict=True))
    ]
    first = Fraction(1, 5)
    balls = found(matrix_over, residual, *[first] * size)
    for ball, z in zip(balls, zero, strict=True):
        assert ball.contains(enclose(z))
        assert float(ball.rad()) < 0.05


def test_of_two_zeros_in_a_box_neither_is_the_only_one() -> None:
    """(x - 1/8)(x - 7/8): Newton's step from 0 stays in the box, and the derivative vanishes in it."""

    def matrix_over(where: Sequence[arb]) -> Matrix:
        return [[2 * where[0] - 1]]

    checklist = Checklist()
    with (
        pytest.raises(NotEstablishedError, match="singular"),
        checklist.hypothesis("point", "7.5", "there is one zero", "move the centre") as evidence,
    ):
        enclose_zero(evidence, matrix_over, [arb(7) / 64], [Fraction(1)], ["p_0"])
    assert list(checklist.hypotheses[-1].enclosures) == ["derivative 0, 0"]
    (ball,) = found(matrix_over, [arb(7) / 64], Fraction(1, 4))
    assert ball.contains(arb(1) / 8)


@pytest.mark.parametrize("zero", [Fraction(1), Fraction(-1), Fraction(2)])
def test_a_zero_on_the_border_or_beyond_is_not_inside(zero: Fraction) -> None:
    with pytest.raises(NotEstablishedError, match="not inside"):
        found(lambda where: [[arb(1)]], [-enclose(zero)], Fraction(1))


def test_a_border_is_a_unit_column_and_a_row() -> None:
    numbers = [[1, 2], [3, 4]]
    whole = bordered([[arb(value) for value in row] for row in numbers], 1, [arb(5), arb(6)])
    assert [[int(float(value)) for value in row] for row in whole] == [[1, 2, 0], [3, 4, 1], [5, 6, 0]]


@pytest.mark.parametrize("seed", range(6))
def test_the_left_kernel_is_one(seed: int) -> None:
    source = random.Random(seed)
    column, size = seed % 3, 3
    left = [Fraction(source.randint(-9, 9), 4) for _ in range(size)]
    left[column] = Fraction(1)
    rows = [[Fraction(source.randint(-9, 9), 4) for _ in range(size)] for _ in range(size)]
    rows[column] = [-sum((left[i] * rows[i][j] for i in range(size) if i != column), Fraction(0)) for j in range(size)]
    matrix = [[enclose(value) for value in row] for row in rows]
    balls = left_kernel(matrix, column, [arb(source.randint(1, 9)) for _ in range(size)])
    for ball, value in zip(balls, left, strict=True):
        assert ball.contains(enclose(value))
