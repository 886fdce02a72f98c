"""Newton's method with growing digits, on equations with known solutions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from math import inf, isqrt
from typing import Any

import pytest

from orbitproof.explore.numerics import (
    GrowingDigits,
    Linearised,
    bits_of,
    fraction,
    mpf,
    newton_with_digits,
    working_context,
)

GOAL = bits_of(50)
ROOT = Fraction(isqrt(2 * 10**140), 10**70)


class NoRoot(Exception):
    """What the caller names."""


RULE = GrowingDigits(NoRoot, farthest=0.1)


def square(point: Sequence[Fraction], context: Any) -> Linearised:
    """x^2 = 2."""
    x = mpf(point[0], context)
    return Linearised(context.matrix([x * x - 2]), context.matrix([[2 * x]]), 1.0, context.prec)


def test_a_root_is_found_to_its_digits_with_precision_that_doubles() -> None:
    precisions = []

    def counted(point: Sequence[Fraction], context: Any) -> Linearised:
        precisions.append(context.prec)
        return square(point, context)

    found = newton_with_digits(counted, [Fraction(1.4142)], GOAL, RULE)
    assert abs(found.unknowns[0] - ROOT) < Fraction(1, 10**56)
    assert (found.bits, found.last.found, found.steps) == (GOAL + 40, GOAL + 40, len(precisions))
    assert precisions[0] == 90
    assert precisions == sorted(precisions)
    assert all(after <= 2 * before for before, after in pairwise(precisions))


def test_bits_that_the_equations_lose_are_added() -> None:
    def losing(point: Sequence[Fraction], context: Any) -> Linearised:
        return Linearised(square(point, context).residual, square(point, context).matrix, 2.0**30)

    assert newton_with_digits(losing, [Fraction(1.4142)], GOAL, RULE).bits == GOAL + 70


def test_the_last_step_may_be_as_long_as_the_caller_says() -> None:
    whole = newton_with_digits(square, [Fraction(1.4142)], GOAL, RULE)
    short = newton_with_digits(square, [Fraction(1.4142)], GOAL, RULE, enough=GOAL / 2)
    assert short.steps == whole.steps - 1
    assert abs(short.unknowns[0] - ROOT) < Fraction(1, 10**55)


@pytest.mark.parametrize("wrong", [0, Fraction(1, 2**60)])
def test_derivatives_are_kept_for_the_last_steps_as_long_as_they_lead_on(wrong: Fraction) -> None:
    asked: list[tuple[str, int]] = []

    def counted(point: Sequence[Fraction], context: Any) -> Linearised:
        asked.append(("all", context.prec))
        return square(point, context)

    def residual(point: Sequence[Fraction], context: Any) -> Any:
        asked.append(("residual", context.prec))
        # Other equations than those with derivatives: no step leads on.
        return square([point[0] + wrong], context).residual

    found = newton_with_digits(counted, [Fraction(1.4142)], GOAL, RULE, residual=residual)
    assert abs(found.unknowns[0] - ROOT) < Fraction(1, 10**56)
    kinds = [kind for kind, _ in asked]
    first = kinds.index("residual")
    assert kinds[:first] == ["all"] * first
    assert [bits for _, bits in asked[first:]] == [GOAL + 40] * (len(asked) - first)
    if wrong:
        assert kinds[-1] == "all"
    else:
        assert 1 < first < len(kinds)
        assert set(kinds[first:]) == {"residual"}


def test_more_equations_than_unknowns() -> None:
    def twice(point: Sequence[Fraction], context: Any) -> Linearised:
        x, y = (mpf(value, context) for value in point)
        rows = [[2 * x, 0], [0, 1], [y, x]]
        return Linearised(context.matrix([x * x - 2, y - 1, x * y - context.sqrt(2)]), context.matrix(rows), 1.0)

    found = newton_with_digits(twice, [Fraction(1.41), Fraction(1.01)], GOAL, RULE)
    assert abs(found.unknowns[0] - ROOT) < Fraction(1, 10**56)
    assert abs(found.unknowns[1] - 1) < Fraction(1, 10**56)


@pytest.mark.parametrize(
    ("value", "slope", "guess", "message"),
    [
        (lambda x: x * x + 1, lambda x: 2 * x, 1.0, "leaves the neighbourhood of the guess"),
        (lambda x: x * x - 2, lambda x: 0 * x, 1.4142, "singular"),
        (lambda x: x * x - 2, lambda x: 10 * x, 1.4142, "did not converge in 24 steps"),
        (lambda x: x * inf, lambda x: 2 * x, 1.4142, "singular"),
    ],
)
def test_failures_are_those_of_the_caller(
    value: Callable[[Any], Any], slope: Callable[[Any], Any], guess: float, message: str
) -> None:
    def equations(point: Sequence[Fraction], context: Any) -> Linearised:
        x = mpf(point[0], context)
        return Linearised(context.matrix([value(x)]), context.matrix([[slope(x)]]), 1.0)

    with pytest.raises(NoRoot, match=message):
        newton_with_digits(equations, [Fraction(guess)], GOAL, RULE)


def test_numbers_are_read_exactly() -> None:
    assert fraction(3) == 3
    assert fraction(-working_context(60).mpf("0.15625")) == Fraction(-5, 32)
    with pytest.raises(ValueError, match="not finite"):
        fraction(working_context(60).nan)


def test_bits_that_are_lost_on_the_way_are_made_up_for() -> None:
    """Errors of the equations are 2^45 times those of the arithmetic, and the spread does not tell."""
    signs: list[int] = []

    def noisy(point: Sequence[Fraction], context: Any) -> Linearised:
        here = square(point, context)
        signs.append(-1 if len(signs) % 2 else 1)
        return Linearised(
            here.residual + context.matrix([signs[-1] * context.ldexp(1, 45 - context.prec)]), here.matrix, 1.0
        )

    found = newton_with_digits(noisy, [Fraction(1.4142)], GOAL, RULE)
    assert abs(found.unknowns[0] - ROOT) < Fraction(1, 10**55)
    assert GOAL + 45 < found.bits < GOAL + 2 * 45
