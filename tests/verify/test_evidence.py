"""What counts as shown: comparisons that are certain, hypotheses with all their requirements, exact text."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction as F

import pytest
from flint import arb, ctx

from orbitproof.shared import parse_exact
from orbitproof.verify.certificate import MEANINGS, Level
from orbitproof.verify.evidence import (
    Checklist,
    EmptyIntersectionError,
    NotEstablishedError,
    NotProved,
    Proved,
    Reason,
    ball_from_json,
    bounds,
    concluded,
    dyadic_above,
    exact_text,
    is_outside,
    power,
    software,
)


def test_a_fractional_power_is_finite_where_its_base_is_positive_alone() -> None:
    for base in (arb(0), arb(1, 1), arb(0, 1), arb(-1), arb(1, 2), arb("nan")):
        for exponent in (F(1, 2), F(3, 2), F(-1, 2), F(1, 3)):
            assert not power(base, exponent).is_finite()
    assert power(arb(2, 1), F(3, 2)).is_finite()
    assert power(arb(0, 1), F(2)).is_finite()


def test_outside_is_beyond_one_of_the_ends() -> None:
    assert is_outside(arb(-2), F(1))
    assert is_outside(arb(2), F(1))
    for inside in (arb(0), arb(-1) / 2, arb(1) / 2, arb(1), arb(0, 2)):
        assert not is_outside(inside, F(1))


@pytest.mark.parametrize("exponent", [-2000, -30, 0, 5, 300])
@pytest.mark.parametrize("mantissa", [1, 2**24 - 1, 2**24 + 1, 2**60 + 1, 3**50])
def test_a_bound_with_few_bits_is_no_smaller(mantissa: int, exponent: int) -> None:
    with ctx.workprec(200):
        bound = arb((mantissa, exponent)).union(arb(0))
    above = dyadic_above(bound)
    exact = F(mantissa) * F(2) ** exponent
    assert exact <= above <= exact * (1 + F(1, 2**22))
    assert abs(above.numerator).bit_length() <= 24 or above.denominator == 1
    with pytest.raises(ValueError, match="not finite"):
        dyadic_above(arb("nan"))


@pytest.mark.parametrize("exponent", [F(1, 3), F(-1, 7), F(5, 3)])
def test_exponents_that_are_no_binary_fractions_are_exact(exponent: F) -> None:
    with ctx.workprec(300):
        root = power(arb(2), exponent)
        lower, upper = bounds(root**exponent.denominator)
        assert lower <= F(2) ** exponent.numerator <= upper
        assert upper - lower < F(1, 2**250)


@pytest.mark.parametrize("value", [F(1, 3), F(1, 10), F(3, 4), F(10) ** 30 + F(1, 7), F(1, 2**60), F(-5)])
def test_a_number_is_said_exactly(value: F) -> None:
    text = exact_text(value)
    assert parse_exact(text.partition(" (exactly ")[2].removesuffix(")") or text) == value


def is_shown(*requirements: object, error: Exception | None = None) -> bool:
    """Whether a hypothesis with these requirements, whose check ends with this exception, holds."""
    checklist = Checklist()
    try:
        with checklist.hypothesis("name", "1", "statement", "remedy") as evidence:
            for holds in requirements:
                evidence.require(holds, "it is not")  # type: ignore[arg-type]
            if error is not None:
                raise error
    except NotEstablishedError:
        assert not checklist.hypotheses[0].holds
        return False
    return checklist.hypotheses[0].holds


@pytest.mark.parametrize("error", [ZeroDivisionError(), EmptyIntersectionError(), KeyError((0, 1))])
def test_a_check_that_breaks_off_does_not_hold_whatever_was_shown_before(error: Exception) -> None:
    assert not is_shown(True, error=error)


def test_every_requirement_has_to_be_true_and_nothing_else_is() -> None:
    assert is_shown(True, True)
    assert not is_shown()
    for other in (None, 1, "yes", False):
        assert not is_shown(True, other)
        assert not is_shown(other, True)


@dataclass(frozen=True)
class Two:
    """A theorem with two hypotheses."""

    hypotheses: tuple[str, ...] = ("first", "second")


def checked(holds: bool = True, error: Exception | None = None, names: tuple[str, ...] = ("first", "second")) -> object:
    """The outcome of a check of which the first hypothesis was looked at before."""
    checklist = Checklist()
    with checklist.hypothesis(names[0], "1", "statement", "remedy") as evidence:
        evidence.require(True, "it is not")

    def check() -> int:
        for name in names[1:]:
            with checklist.hypothesis(name, "1", "statement", "remedy") as evidence:
                evidence.require(holds, "it is not")
        if error is not None:
            raise error
        return 7

    return concluded(Two(), checklist, check)


def test_a_theorem_is_proved_where_the_check_comes_to_its_end() -> None:
    outcome = checked()
    assert isinstance(outcome, Proved)
    assert (outcome.theorem, outcome.results, len(outcome.hypotheses)) == (Two(), 7, 2)
    with pytest.raises(ValueError, match="hypotheses"):
        checked(names=("first",))


@pytest.mark.parametrize("error", [ZeroDivisionError("0"), OverflowError("inf"), ArithmeticError("none")])
def test_a_result_that_cannot_be_evaluated_proves_nothing(error: Exception) -> None:
    outcome = checked(error=error)
    assert isinstance(outcome, NotProved)
    assert (outcome.reason.condition, outcome.reason.needs_precision, len(outcome.hypotheses)) == ("results", True, 2)


def test_the_first_hypothesis_that_fails_ends_the_check() -> None:
    outcome = checked(holds=False)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "second"
    assert [hypothesis.holds for hypothesis in outcome.hypotheses] == [True, False]


def test_what_is_no_theorem_is_not_looked_at() -> None:
    reason = Reason("theorem", "it is none", "claim another kind")
    assert concluded(reason, Checklist(), lambda: pytest.fail("it was looked at")) == NotProved(reason)


def test_what_computes_is_named_with_its_version_and_as_what_is_left_to_be_believed() -> None:
    # Bounds in float64 are those of numpy.
    remains = MEANINGS[Level.INTEGRATION].remains
    for name in ("FLINT", "numpy", "python"):
        assert software()[name]
        assert name.lower() in remains.lower()


@pytest.mark.parametrize("ball", [("0x1p999999", "0"), ("0x1p-999999", "0"), ("0x1", "0x1p99999")])
def test_a_ball_of_a_size_that_no_computation_gives_is_refused(ball: tuple[str, str]) -> None:
    with pytest.raises(ValueError, match="no computation gives"):
        ball_from_json({"mid": ball[0], "rad": ball[1]})
