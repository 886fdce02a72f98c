"""The equations of every system are Newton's, written down here once more, at random points with sixty digits."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from support.exact_elements import number
from support.within import within

from orbitproof.shared.systems import (
    AROUND,
    CR3BP,
    CR3BP_AXIAL,
    CR3BP_PLANAR,
    FALKNER_SKAN,
    HILL,
    OVER_MASSES,
    SIDES,
    Program,
    mass_of_distance,
)

CLOSE = mpmath.mpf(10) ** -45

_sixty_digits = within(lambda: mpmath.workdps(60))


def values(program: Program | None, *arguments: Any) -> list[Any]:
    assert program is not None
    return program.evaluate(arguments, number, lambda base, exponent: mpmath.power(base, number(exponent)))


def newton(state: Sequence[Any], mu: Any) -> list[Any]:
    """Two masses at rest in a frame that turns once in 2 pi: attraction, centrifugal and Coriolis force."""
    place, speed = state[:3], state[3:]
    force = [place[0] + 2 * speed[1], place[1] - 2 * speed[0], mpmath.mpf(0)]
    for mass, along in ((1 - mu, -mu), (mu, 1 - mu)):
        way = [along - place[0], -place[1], -place[2]]
        distance = mpmath.sqrt(sum(x * x for x in way))
        force = [f + mass * x / distance**3 for f, x in zip(force, way, strict=True)]
    return [*speed, *force]


def jacobi(state: Sequence[Any], mu: Any) -> Any:
    x, y, z, *speed = state
    away = [(1 - mu, mpmath.sqrt((x + mu) ** 2 + y * y + z * z)), (mu, mpmath.sqrt((x + mu - 1) ** 2 + y * y + z * z))]
    return x * x + y * y + 2 * sum(mass / distance for mass, distance in away) - sum(v * v for v in speed)


def assert_close(left: Sequence[Any], right: Sequence[Any]) -> None:
    assert len(left) == len(right)
    assert all(abs(a - b) < CLOSE * (1 + abs(b)) for a, b in zip(left, right, strict=True))


def random_state(source: random.Random, size: int) -> list[Any]:
    return [mpmath.mpf(source.uniform(-1, 1)) for _ in range(size)]


@pytest.mark.parametrize("seed", range(3))
def test_the_three_body_problem(seed: int) -> None:
    source = random.Random(seed)
    state, mu = random_state(source, 6), mpmath.mpf(source.uniform(0.01, 0.9))
    for system in (CR3BP, CR3BP_AXIAL):
        assert_close(values(system.program, *state, mu), newton(state, mu))
        assert_close(values(system.first_integral_program, *state, mu), [jacobi(state, mu)])
        x, y, z, *_ = state
        assert_close(values(system.squared_distance_program, *state, mu), [(x - (1 - mu)) ** 2 + y * y + z * z])


@pytest.mark.parametrize("seed", range(3))
def test_the_three_body_problem_in_the_plane(seed: int) -> None:
    source = random.Random(seed)
    (x, y, vx, vy), mu = random_state(source, 4), mpmath.mpf(source.uniform(0.01, 0.9))
    plane, space = (x, y, vx, vy, mu), [x, y, mpmath.mpf(0), vx, vy, mpmath.mpf(0)]
    rates = newton(space, mu)
    assert_close(values(CR3BP_PLANAR.program, *plane), [rates[i] for i in (0, 1, 3, 4)])
    assert_close(values(CR3BP_PLANAR.first_integral_program, *plane), [jacobi(space, mu)])
    assert_close(values(CR3BP_PLANAR.squared_distance_program, *plane), [(x - (1 - mu)) ** 2 + y * y])
    small = mpmath.mpf(10) ** -30
    (pull,) = [newton([x, y, small, vx, vy, 0], mu)[5]]
    assert_close(values(CR3BP_PLANAR.stiffness_across_program, *plane), [-pull / small])


def test_the_two_reversors_of_the_three_body_problem() -> None:
    assert CR3BP.reversing_symmetry == (1, -1, 1, -1, 1, -1)
    assert CR3BP_AXIAL.reversing_symmetry == CR3BP.under("axial").reversing_symmetry == (1, -1, -1, -1, 1, 1)


@pytest.mark.parametrize("seed", range(3))
def test_hills_units(seed: int) -> None:
    source = random.Random(seed)
    state, h = random_state(source, 6), mpmath.mpf(source.uniform(0.01, 0.5))
    mu = h**3
    own = [1 - mu + h * state[0], *(h * x for x in state[1:])]
    assert_close([h * x for x in values(HILL.program, *state, h)], newton(own, mu))
    wanted = (jacobi(own, mu) - (1 - mu) * (3 - mu)) / h**2
    assert_close(values(HILL.first_integral_program, *state, h), [wanted])


@pytest.mark.parametrize("point", AROUND)
@pytest.mark.parametrize("seed", range(2))
def test_the_units_of_an_orbit_around_a_libration_point(point: str, seed: int) -> None:
    """The mass is the one whose force on the axis is balanced there."""
    source = random.Random(f"{point} {seed}")
    if point == "L3":
        away = mpmath.mpf(source.uniform(0.8, 0.95))
        mu = (1 / away**2 - away) / (1 + 1 / away**2 - 1 / (1 + away) ** 2)
        x_l, shortest = -mu - away, away
    else:
        b = SIDES[point] * mpmath.mpf(source.uniform(0.05, 0.3))
        mu = (1 - 1 / (1 + b) ** 2 + b) / (1 - 1 / (1 + b) ** 2 + SIDES[point] / b**2)
        x_l, shortest = 1 - mu + b, abs(b)
        assert_close([mass_of_distance(SIDES[point], b)], [mu / b**3])
    assert 0 < mu < 1
    assert abs(newton([x_l, 0, 0, 0, 0, 0], mu)[3]) < CLOSE
    for eps in (mpmath.mpf(source.uniform(-0.2, 0.2)) * shortest, mpmath.mpf(10) ** -30):
        x, y, vx, vy = random_state(source, 4)
        own = [x_l + eps * x, eps * y, 0, eps * vx, eps * vy, 0]
        full = newton(own, mu)
        wanted = [full[i] / eps for i in (0, 1, 3, 4)]
        found = values(AROUND[point].program, x, y, vx, vy, mu, x_l, eps)
        assert all(abs(a - c) < mpmath.mpf(10) ** -20 for a, c in zip(found, wanted, strict=True))
        across = newton([*own[:2], mpmath.mpf(10) ** -25, 0, 0, 0], mu)[5] * mpmath.mpf(10) ** 25
        (stiffness,) = values(AROUND[point].stiffness_across_program, x, y, vx, vy, mu, x_l, eps)
        assert abs(stiffness + across) < mpmath.mpf(10) ** -40
        if point in OVER_MASSES:
            found = values(OVER_MASSES[point].program, x, y, vx, vy, b, eps / b)
            assert all(abs(a - c) < mpmath.mpf(10) ** -20 for a, c in zip(found, wanted, strict=True))


@pytest.mark.parametrize("point, above, below", [("L1", "-mu", "1 - mu"), ("L2", "1 - mu", ""), ("L3", "", "-mu")])
def test_a_libration_point_is_where_the_force_on_the_axis_vanishes(point: str, above: str, below: str) -> None:
    mu, x = Fraction(1, 5), Fraction(17, 10)
    ends = {"-mu": -mu, "1 - mu": 1 - mu, "": None}
    derived = AROUND[point].derived_parameters["x_l"]
    assert derived.interval((mu,)) == (ends[above], ends[below])
    for place in (x, -x, Fraction(1, 2)):
        (force,) = derived.equation((number(place),), (number(mu),))
        assert_close([force], [newton([number(place), 0, 0, 0, 0, 0], number(mu))[3]])


def test_the_falkner_skan_equation() -> None:
    """f''' = -f f'' - beta (1 - f'^2) for (x, y, z) = (f, f', f'')."""
    f, slope, bend, beta = (mpmath.mpf(value) for value in ("0.3", "0.7", "-1.1", "453.5"))
    found = values(FALKNER_SKAN.program, f, slope, bend, beta)
    assert_close(found, [slope, bend, -f * bend - beta * (1 - slope**2)])
