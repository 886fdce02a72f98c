"""Graded norms in float64 and the exponential of a non-negative matrix are upper bounds of exact numbers."""

from __future__ import annotations

import math
import random
import warnings
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from orbitproof.verify.algebra import convolve, float_above, fraction_above, geometric, inflate, total
from orbitproof.verify.algebra.norms import add
from orbitproof.verify.flow import exponential_bound

# Non-negative floats of every size: subnormal, tiny, ordinary, and so large that products overflow.
SIZES = st.one_of(
    st.just(0.0),
    st.floats(min_value=0.0, max_value=2.0),
    st.floats(min_value=1e-320, max_value=1e-290),
    st.floats(min_value=1e-165, max_value=1e-150),
    st.floats(min_value=1e-30, max_value=1e30),
    st.floats(min_value=1e150, max_value=1e308),
)


@st.composite
def norms(draw: st.DrawFn, count: int = 1, sizes: st.SearchStrategy[float] = SIZES) -> list[list[float]]:
    """`count` graded norms with a common number of slots, 2 to 6."""
    slots = draw(st.integers(2, 6))
    return [draw(st.lists(sizes, min_size=slots, max_size=slots)) for _ in range(count)]


def at_least(bound: float, exact: Fraction) -> bool:
    """Whether a float is a bound; infinity is one."""
    return bound == math.inf or (math.isfinite(bound) and Fraction(bound) >= exact)


def exact_product(left: list[Fraction], right: list[Fraction]) -> list[Fraction]:
    """The graded convolution in rational arithmetic."""
    last = len(left) - 1
    result = [Fraction(0)] * len(left)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            result[min(i + j, last)] += a * b
    return result


@given(st.integers(min_value=0, max_value=10**400), st.integers(min_value=-3000, max_value=1200))
def test_float_above_is_above(numerator: int, exponent: int) -> None:
    exact = Fraction(numerator) * Fraction(2) ** exponent
    bound = float_above(numerator, exponent)
    assert at_least(bound, exact)
    if bound != math.inf:
        assert Fraction(bound) <= exact * (1 + Fraction(1, 2**50)) + Fraction(1, 2**900)


@given(st.fractions(min_value=0, max_value=10**400, max_denominator=10**400))
def test_fraction_above_is_above(value: Fraction) -> None:
    bound = fraction_above(value)
    assert at_least(bound, value)
    assert bound == math.inf or Fraction(bound) <= value * (1 + Fraction(1, 2**50)) + Fraction(1, 2**900)


def test_float_above_overflows_to_infinity() -> None:
    assert float_above(1, 1100) == math.inf
    assert float_above(10**400, 0) == math.inf


@given(norms(2))
def test_sum_is_bounded(pair: list[list[float]]) -> None:
    left, right = pair
    for bound, a, b in zip(add(left, right), left, right, strict=True):
        assert at_least(bound, Fraction(a) + Fraction(b))


@given(st.lists(SIZES, max_size=60))
def test_total_is_bounded(values: list[float]) -> None:
    assert at_least(total(values), sum(map(Fraction, values), Fraction(0)))


@given(norms(2))
def test_convolution_bounds_the_exact_one(pair: list[list[float]]) -> None:
    exact = exact_product(*([Fraction(value) for value in norm] for norm in pair))
    for bound, value in zip(convolve(*pair), exact, strict=True):
        assert at_least(bound, value)


@given(norms(2, st.floats(min_value=1e-100, max_value=1e100)))
def test_convolution_is_not_wasteful(pair: list[list[float]]) -> None:
    exact = exact_product(*([Fraction(value) for value in norm] for norm in pair))
    for bound, value in zip(convolve(*pair), exact, strict=True):
        assert Fraction(bound) <= value * (1 + Fraction(1, 2**38))


def test_products_of_tiny_numbers_stay_positive() -> None:
    assert min(convolve([1e-200, 1e-200], [1e-200, 1e-300])) > 0.0
    assert inflate(0.0) > 0.0


def test_what_a_product_has_above_the_top_grade_is_in_the_last_slot() -> None:
    lower, last = convolve([0.0, 1.0, 0.0], [0.0, 1.0, 0.0])[1:]
    assert lower < 1.0 <= last


def test_what_is_not_finite_never_becomes_finite() -> None:
    assert convolve([math.inf, 0.0], [1.0, 1.0])[0] == math.inf
    assert not math.isfinite(convolve([math.inf, 1.0], [0.0, 1.0])[0])
    assert not math.isfinite(convolve([math.nan, 1.0], [1.0, 1.0])[0])
    assert total([math.inf, 1.0]) == math.inf
    assert geometric([math.nan, 0.0, 0.0]) is None
    assert geometric([0.0, 0.0, math.nan]) is None
    assert geometric([0.0, math.inf, 0.0]) is None


@given(norms(1, st.one_of(st.floats(0.0, 0.12), st.floats(1e-320, 1e-290), st.just(0.0))))
def test_geometric_bounds_every_partial_sum(single: list[list[float]]) -> None:
    (ratio,) = single
    bound = geometric(ratio)
    exact = [Fraction(value) for value in ratio]
    if bound is None:
        assert sum(exact) > Fraction(499, 1000)
        return
    power, partial = exact, exact
    for _ in range(8):
        power = exact_product(power, exact)
        partial = [a + b for a, b in zip(partial, power, strict=True)]
    for value, term in zip(bound, partial, strict=True):
        assert at_least(value, term)


def test_geometric_solves_its_equation() -> None:
    """The exact sum F = E + E F, solved grade by grade, is attained up to rounding."""
    ratio = [0.25, 0.0625, 0.03125, 0.015625]
    bound = geometric(ratio)
    assert bound is not None
    exact = [Fraction(value) for value in ratio]
    power, partial = exact, exact
    for _ in range(120):
        power = exact_product(power, exact)
        partial = [a + b for a, b in zip(partial, power, strict=True)]
    for value, term in zip(bound, partial, strict=True):
        assert term <= Fraction(value) <= term * (1 + Fraction(1, 2**36))


def test_geometric_refuses_half() -> None:
    assert geometric([0.5, 0.0, 0.0]) is None
    assert geometric([0.25, 0.25, 0.0]) is None
    assert geometric([0.1, 0.1, 0.1]) is not None


def exact_exponential(matrix: np.ndarray, start: np.ndarray, terms: int) -> list[Fraction]:
    """A partial sum of exp(M) v in rational arithmetic: a lower bound, since nothing is negative."""
    size = len(start)
    rows = [[Fraction(float(value)) for value in row] for row in matrix]
    term = [Fraction(float(value)) for value in start]
    result = list(term)
    for n in range(1, terms):
        term = [sum((rows[i][j] * term[j] for j in range(size)), Fraction(0)) / n for i in range(size)]
        # Rounded down, to keep the numerators short: the sum stays a lower bound.
        term = [Fraction(int(value * 2**1400), 2**1400) for value in term]
        result = [a + b for a, b in zip(result, term, strict=True)]
    return result


@pytest.mark.parametrize("seed", range(12))
def test_exponential_bound_is_above_the_exact_exponential(seed: int) -> None:
    source = random.Random(seed)
    size = source.randint(1, 6)
    scale = 10.0 ** source.uniform(-4, 0.6)
    matrix = np.array([[source.random() * scale * (source.random() < 0.6) for _ in range(size)] for _ in range(size)])
    start = np.array([10.0 ** source.uniform(-280, 0) if source.random() < 0.8 else 0.0 for _ in range(size)])
    bound = exponential_bound(matrix, start)
    exact = exact_exponential(matrix, start, 60)
    for value, lower in zip(bound, exact, strict=True):
        assert math.isfinite(value)
        assert Fraction(float(value)) >= lower


def test_exponential_bound_is_close_when_all_entries_are_alike() -> None:
    matrix = np.array([[0.5, 0.25], [0.125, 0.75]])
    start = np.array([1.0, 2.0])
    for value, lower in zip(exponential_bound(matrix, start), exact_exponential(matrix, start, 60), strict=True):
        assert float(value) <= float(lower) * (1 + 1e-7)


@pytest.mark.parametrize("size", [1e3, 1e10, 1e200, 1e308, math.inf, math.nan])
def test_exponential_bound_of_a_huge_matrix_is_infinite(size: float) -> None:
    matrix = np.full((3, 3), size)
    with warnings.catch_warnings():
        # Numpy may report the overflow; the value is what matters here.
        warnings.simplefilter("ignore")
        bound = exponential_bound(matrix, np.ones(3))
    assert bool(np.all(bound == np.inf))


@pytest.mark.parametrize("size", [5.0, 20.0, 40.0])
def test_exponential_bound_of_a_large_matrix_is_infinite_or_a_bound(size: float) -> None:
    matrix = np.array([[size, 1.0], [2.0, size]])
    start = np.array([1e-30, 1.0])
    bound = exponential_bound(matrix, start)
    exact = exact_exponential(matrix, start, 200)
    assert all(at_least(float(value), lower) for value, lower in zip(bound, exact, strict=True))
