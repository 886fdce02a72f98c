"""Coefficients of Neimark-Sacker bifurcations: those of known maps, in any coordinates and for any eigenvector."""

from __future__ import annotations

import random
from collections import defaultdict
from fractions import Fraction
from functools import cache

import pytest
from flint import acb, arb, ctx
from support.balls import agree
from support.normal_form_maps import KnownTorus, known_torus

from orbitproof.verify.evidence import MultiIndex, enclose, indices_up_to
from orbitproof.verify.periodic_bifurcation import TorusCoefficients, coefficients_of_torus

CASES = [(2, 0), (2, 1), (2, 2), (2, 3), (3, 0), (3, 1), (3, 2), (4, 0)]


@cache
def _known(size: int, seed: int) -> KnownTorus:
    return known_torus(size, random.Random(f"{size} {seed}"))


def _ball(value: Fraction, chance: random.Random, radius: float) -> arb:
    """A ball of this radius that contains a number, anywhere in it."""
    return enclose(value) + arb(radius * chance.uniform(-0.9, 0.9)) + arb(0, radius)


def _coefficients(known: KnownTorus, factor: acb, radius: float = 0.0, seed: int = 0) -> TorusCoefficients:
    chance, size = random.Random(seed), len(known.derivatives)

    def ball(value: Fraction) -> arb:
        return _ball(value, chance, radius) if radius else enclose(value)

    derivatives: list[dict[MultiIndex, arb]] = [
        {index: ball(each.get(index, Fraction(0))) for index in indices_up_to(size + 1, 3)}
        for each in known.derivatives
    ]
    eigenvector = [acb(ball(x), ball(y)) * factor for x, y in zip(*known.eigenvector, strict=True)]
    return coefficients_of_torus(derivatives, acb(*map(ball, known.multiplier)), eigenvector)


@pytest.mark.parametrize(("size", "seed"), CASES)
def test_coefficients_of_known_maps_are_enclosed_in_any_coordinates(size: int, seed: int) -> None:
    known = _known(size, seed)
    with ctx.workprec(200):
        found = _coefficients(known, acb(1))
        assert agree(found.lyapunov, enclose(known.lyapunov))
        assert agree(found.speed, enclose(known.speed))
        assert found.lyapunov.rad() < 1e-40
        assert found.speed.rad() < 1e-40


@pytest.mark.parametrize(("size", "seed"), CASES)
def test_balls_that_contain_the_derivatives_give_balls_that_contain_the_coefficients(size: int, seed: int) -> None:
    known = _known(size, seed)
    with ctx.workprec(100):
        for trial in range(8):
            found = _coefficients(known, acb(1), 1e-12, trial)
            assert agree(found.lyapunov, enclose(known.lyapunov))
            assert agree(found.speed, enclose(known.speed))
            assert 0 < found.lyapunov.rad() < 1e-3


@pytest.mark.parametrize("factor", [acb(2), acb(0, 1), acb(-1, 1) / 4, acb(3, -5) / 128])
def test_another_eigenvector_changes_the_coefficient_by_the_square_of_its_length(factor: acb) -> None:
    known = _known(3, 2)
    with ctx.workprec(200):
        found = _coefficients(known, factor)
        expected = enclose(known.lyapunov) * abs(factor) * abs(factor)
        assert agree(found.lyapunov, expected)
        assert found.lyapunov.rad() < 1e-40
        assert agree(found.speed, enclose(known.speed))


def test_the_coefficients_of_the_conjugate_pair_are_the_same() -> None:
    known = _known(3, 1)
    turned = KnownTorus(
        known.derivatives,
        (known.multiplier[0], -known.multiplier[1]),
        (known.eigenvector[0], tuple(-value for value in known.eigenvector[1])),
        known.lyapunov,
        known.speed,
        known.others,
    )
    with ctx.workprec(200):
        found = _coefficients(turned, acb(1))
        assert agree(found.lyapunov, enclose(known.lyapunov))
        assert agree(found.speed, enclose(known.speed))


def _linear(rows: list[list[int]]) -> list[defaultdict[MultiIndex, arb]]:
    """A linear map with integer coefficients."""
    size = len(rows)
    units = [tuple(int(i == j) for i in range(size + 1)) for j in range(size)]
    return [defaultdict(arb, {unit: arb(entry) for unit, entry in zip(units, row, strict=True)}) for row in rows]


def test_a_third_or_fourth_root_or_a_double_multiplier_is_refused_where_a_matrix_is_singular() -> None:
    with ctx.workprec(100):
        third = _linear([[0, -1], [1, -1]])
        turn = acb(arb(-1) / 2, arb(3).sqrt() / 2)
        with pytest.raises(ZeroDivisionError):
            coefficients_of_torus(third, turn, [acb(1), -turn.conjugate()])
        double = _linear([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, -1], [0, 0, 1, 0]])
        with pytest.raises(ZeroDivisionError):
            coefficients_of_torus(double, acb(0, 1), [acb(0, 1), acb(1), acb(0), acb(0)])
        one = _linear([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        with pytest.raises(ZeroDivisionError):
            coefficients_of_torus(one, acb(0, 1), [acb(0, 1), acb(1), acb(0)])


def test_the_delayed_logistic_map_has_its_known_coefficient() -> None:
    """x -> a x (1 - y), y -> x at a = 2: lambda = exp(i pi/3), a sixth root, and an attracting curve.

    With u = x - 1/2, v = y - 1/2 it is u -> u - v - 2 u v + b (1/4 + u/2 - v/2 - u v), v -> u, b = a - 2.
    """
    with ctx.workprec(100):
        half = arb(1) / 2
        zero = dict.fromkeys(indices_up_to(3, 3), arb(0))
        first = zero | {
            (1, 0, 0): arb(1),
            (0, 1, 0): arb(-1),
            (1, 1, 0): arb(-2),
            (0, 0, 1): half / 2,
            (1, 0, 1): half,
            (0, 1, 1): -half,
            (1, 1, 1): arb(-1),
        }
        second = zero | {(1, 0, 0): arb(1)}
        turn = acb(half, arb(3).sqrt() / 2)
        found = coefficients_of_torus([first, second], turn, [turn, acb(1)])
        # The absolute value of the eigenvalue of the fixed point 1 - 1/a is sqrt(a - 1).
        assert agree(found.speed, half)
        assert found.lyapunov < 0
