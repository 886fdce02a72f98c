"""All zeros of a smooth curve are found, dips included; near misses are not reported."""

from __future__ import annotations

from collections.abc import Callable
from math import acos, cos, exp, pi, sqrt, tanh

import numpy as np
import pytest

from orbitproof.explore.numerics import Zeros, bracketed_zero, find_zeros, resolve

DIP = 0.437


def zeros_of(function: Callable[[float], float], intervals: int = 11, noise: float = 1e-9) -> Zeros:
    """The whole procedure on [0, 1], from equally spaced nodes."""
    samples = resolve(lambda place: np.array([function(place)]), np.linspace(0.0, 1.0, intervals + 1).tolist())
    return find_zeros(function, samples.places, [float(value[0]) for value in samples.values], noise=noise)


@pytest.mark.parametrize("depth", [2e-2, 2e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("place", [0.437, 0.5, 0.03, 0.98])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_curve_that_only_dips_through_zero_has_both_zeros(depth: float, place: float, sign: float) -> None:
    half = sqrt(depth / 5)
    result = zeros_of(lambda x: sign * (5 * (x - place) ** 2 - depth))
    expected = [x for x in (place - half, place + half) if 0 < x < 1]
    assert result.zeros == pytest.approx(expected, abs=1e-9)
    assert result.undecided == ()


@pytest.mark.parametrize("gap", [2e-2, 2e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_curve_that_comes_near_zero_without_reaching_it_is_not_reported(gap: float, sign: float) -> None:
    result = zeros_of(lambda x: sign * (5 * (x - DIP) ** 2 + gap))
    assert result == Zeros((), ())


def test_minimum_within_the_noise_is_undecided_not_a_zero() -> None:
    for shift in (-1e-11, 0.0, 1e-11):
        result = zeros_of(lambda x, shift=shift: (x - DIP) ** 2 + shift)
        assert result.zeros == ()
        assert [touch.place for touch in result.undecided] == pytest.approx([DIP], abs=1e-4)


def test_dip_narrower_than_the_nodes_is_resolved() -> None:
    width, place = 0.02, 0.613
    result = zeros_of(lambda x: 1.0 - 1.001 * exp(-(((x - place) / width) ** 2)))
    half = width * sqrt(np.log(1.001))
    assert result.zeros == pytest.approx([place - half, place + half], abs=1e-9)


def test_three_dips_and_a_steep_curve() -> None:
    result = zeros_of(lambda x: cos(17 * x) + 0.999)
    angle = acos(-0.999)
    expected = [x / 17 for turn in range(3) for x in (2 * pi * turn + angle, 2 * pi * (turn + 1) - angle)]
    assert result.zeros == pytest.approx([x for x in expected if x < 1], abs=1e-9)
    steep = zeros_of(lambda x: 1e3 * exp(-8 * x) - 1 + 0.3 * tanh(50 * (x - 0.9)))
    assert len(steep.zeros) == 1


def test_resolved_samples_predict_the_curve_between_them() -> None:
    def curve(x: float) -> float:
        return 3 * cos(20 * x * x) + 5 * x

    samples = resolve(lambda x: np.array([curve(x)]), [0.0, 0.3, 0.6, 1.0])
    places = np.array(samples.places)
    assert np.all(np.diff(places) > 0)
    values = [float(value[0]) for value in samples.values]
    between = 0.5 * (places[1:] + places[:-1])
    linear = np.interp(between, places, values)
    assert max(abs(curve(x) - y) for x, y in zip(between, linear, strict=True)) < 0.1


def test_bracketed_zero_is_found_in_few_evaluations_even_if_flat_at_one_end() -> None:
    count = 0

    def flat(x: float) -> float:
        nonlocal count
        count += 1
        return x**9 - 1e-5

    assert bracketed_zero(flat, (0.0, 1.0), (flat(0.0), flat(1.0)), 1e-13) == pytest.approx(1e-5 ** (1 / 9), abs=1e-12)
    assert count < 60
