"""The twist of reversible maps of the plane: closed forms, any coordinates, rotation numbers (28.3)."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import pytest
from flint import acb, arb, ctx
from support.balls import agree

from orbitproof.verify.evidence import indices_up_to
from orbitproof.verify.newton import Jet, compose, derivatives_of
from orbitproof.verify.newton.jets import increment
from orbitproof.verify.orbit import full_return_jets, inverse_jets
from orbitproof.verify.periodic_bifurcation import coefficients_of_torus
from orbitproof.verify.twist import NotEllipticError, rotation_of, stability_parameter, twist_of

ORDER = 3
ANGLES = [0.3, 1.0, 1.9, 2.2, 2.9]
Map = tuple[Jet, ...]


def _variables(size: int = 2) -> list[Jet]:
    return [increment(size, ORDER, place) for place in range(size)]


def _applied(outer: Sequence[Jet], inner: Sequence[Jet]) -> Map:
    return tuple(compose(derivatives_of(jet), inner) for jet in outer)


def _turn(angle: arb) -> Map:
    x, y = _variables()
    c, s = angle.cos(), angle.sin()
    return x.scaled(c) + y.scaled(-s), x.scaled(s) + y.scaled(c)


def _henon(angle: arb) -> Map:
    """The area-preserving Henon map, in coordinates in which q -> -q reverses it: half a turn, a shear, half a turn."""
    x, y = _variables()
    shear = (x, y + (x * x).scaled(arb(-1)))
    return _applied(_turn(angle / 2), _applied(shear, _turn(angle / 2)))


def _henon_twist(angle: arb) -> arb:
    return -(3 * (angle / 2).cot() + (3 * angle / 2).cot()) / 16


def _random_jet(size: int, chance: random.Random, first: int = 1) -> Jet:
    indices = [index for index in indices_up_to(size, ORDER) if sum(index) >= first]
    return Jet(size, ORDER, {index: arb(chance.randint(-20, 20)) / 16 for index in indices})


def _commuting(chance: random.Random) -> tuple[Map, arb]:
    """A change of coordinates that commutes with q -> -q, and the determinant of its linear part."""
    p, q = _variables()
    a, b = arb(chance.choice([-3, 2, 5])) / 4, arb(chance.choice([-2, 3, 1])) / 2
    even = _random_jet(2, chance, 2)
    odd = _random_jet(2, chance, 2)
    first = Jet(2, ORDER, {index: ball for index, ball in even.coefficients.items() if index[1] % 2 == 0})
    second = Jet(2, ORDER, {index: ball for index, ball in odd.coefficients.items() if index[1] % 2 == 1})
    return (p.scaled(a) + first, q.scaled(b) + second), a * b


def _moved(functions: Map, change: Map) -> Map:
    """The map in the coordinates to which `change` leads."""
    return _applied(change, _applied(functions, inverse_jets(change)))


def _close(left: arb, right: arb) -> bool:
    return bool(agree(left, right)) and float((left - right).abs_upper()) < 1e-30


@pytest.mark.parametrize("angle", ANGLES)
def test_the_twist_of_the_henon_map_is_its_closed_form(angle: float) -> None:
    with ctx.workprec(200):
        value = arb(angle)
        functions = _henon(value)
        rotation = rotation_of(functions)
        found = twist_of(functions, rotation)
        assert _close(rotation.cosine, value.cos())
        assert _close(rotation.sine, value.sin())
        assert _close(found.twist, _henon_twist(value))
        assert _close(found.defect, arb(0))


@pytest.mark.parametrize("seed", range(8))
def test_the_twist_of_a_normal_form_is_found_in_any_coordinates_in_which_the_map_is_reversible(seed: int) -> None:
    chance = random.Random(seed)
    with ctx.workprec(200):
        angle, twist = arb(ANGLES[seed % 5]), arb(chance.choice([-7, 3, 11])) / 8
        u, v = _variables()
        square = (u * u + v * v).scaled(twist)
        bent = (u + (v * square).scaled(arb(-1)), v + u * square)
        change, determinant = _commuting(chance)
        functions = _moved(_applied(_turn(angle), bent), change)
        rotation = rotation_of(functions)
        found = twist_of(functions, rotation)
        assert rotation.orientation == (1 if determinant > 0 else -1)
        assert _close(found.twist, twist / abs(determinant))
        assert _close(found.defect, arb(0))
        assert _close(stability_parameter(functions), angle.cos())


@pytest.mark.parametrize("seed", range(6))
def test_the_return_map_of_any_half_return_is_reversible_and_has_no_defect(seed: int) -> None:
    """F = R P^-1 R P for random P: R F R is the inverse, and Re(conj(lambda) c_1) = 0 where F is elliptic."""
    chance = random.Random(seed)
    elliptic = 0
    with ctx.workprec(200):
        for _ in range(12):
            half = tuple(_random_jet(2, chance) for _ in range(2))
            try:
                functions = full_return_jets(half)
            except ZeroDivisionError:
                continue
            p, q = _variables()
            mirror = (p, q.scaled(arb(-1)))
            back = _applied(mirror, _applied(functions, mirror))
            for place, jet in enumerate(_applied(functions, back)):
                for index in indices_up_to(2, ORDER):
                    assert _close(jet[index], arb(int(index == ((1, 0), (0, 1))[place])))
            assert agree(functions[0][1, 0], functions[1][0, 1])
            try:
                rotation = rotation_of(functions)
            except NotEllipticError:
                continue
            found = twist_of(functions, rotation)
            if not found.twist.is_finite():
                assert rotation.cosine.contains(arb(-0.5))
                continue
            elliptic += 1
            assert found.defect.contains(0)
            assert found.defect.rad() < 1e-30
            again = coefficients_of_torus(
                [{(*index, each): ball if each == 0 else arb(0)
                  for index, ball in derivatives_of(jet).items() for each in range(4) if sum(index) + each <= ORDER}
                 for jet in functions],
                rotation.multiplier,
                rotation.direction,
            )  # fmt: skip
            assert again.lyapunov.contains(0)
    assert elliptic


def test_both_points_of_the_orbit_have_one_twist_sign() -> None:
    """The return map at P(x) is P F P^-1: the same omega and, up to a positive factor, the same tau."""
    chance = random.Random(5)
    compared = 0
    with ctx.workprec(200):
        for _ in range(40):
            half = tuple(_random_jet(2, chance) for _ in range(2))
            try:
                here = full_return_jets(half)
                there = full_return_jets(_applied(_mirror(), _applied(inverse_jets(half), _mirror())))
                rotation, other = rotation_of(here), rotation_of(there)
            except (ZeroDivisionError, NotEllipticError):
                continue
            compared += 1
            determinant = half[0][1, 0] * half[1][0, 1] - half[0][0, 1] * half[1][1, 0]
            assert _close(rotation.cosine, other.cosine)
            assert _close(twist_of(there, other).twist * abs(determinant), twist_of(here, rotation).twist)
    assert compared > 3


def _mirror() -> Map:
    p, q = _variables()
    return p, q.scaled(arb(-1))


@pytest.mark.parametrize("angle", [1.0, 1.9, 2.6])
def test_iterates_at_small_amplitudes_turn_as_the_twist_says(angle: float) -> None:
    """The rotation number of an orbit of the map, in floats, is omega + tau r^2 + .., in the mean."""
    with ctx.workprec(100):
        functions = _henon(arb(angle))
        twist = float(twist_of(functions, rotation_of(functions)).twist)
    slopes = [(_rotation_number(angle, radius) - angle) / radius**2 for radius in (0.02, 0.01)]
    assert abs(slopes[1] - twist) < 0.02 * abs(twist)
    assert abs(slopes[1] - twist) <= abs(slopes[0] - twist) + 1e-4


def _rotation_number(angle: float, radius: float, steps: int = 20000) -> float:
    """The mean angle of a step of the map x -> turn(angle) (x, y - x^2), weighted smoothly."""
    x, y, total, weights = radius, 0.0, 0.0, 0.0
    c, s = math.cos(angle), math.sin(angle)
    for number in range(1, steps):
        kicked = y - x * x
        new = (c * x - s * kicked, s * x + c * kicked)
        t = number / steps
        weight = math.exp(-1 / (t * (1 - t)))
        change = math.atan2(x * new[1] - y * new[0], x * new[0] + y * new[1]) % (2 * math.pi)
        total, weights = total + weight * change, weights + weight
        x, y = new
    return total / weights


@pytest.mark.parametrize("seed", range(6))
def test_balls_that_contain_a_map_give_balls_that_contain_its_twist(seed: int) -> None:
    chance = random.Random(seed)
    with ctx.workprec(100):
        angle = arb(ANGLES[seed % 5])
        wide = tuple(
            Jet(2, ORDER, {index: ball + arb(1e-9 * chance.uniform(-0.9, 0.9), 1e-9)
                           for index, ball in jet.coefficients.items()})
            for jet in _henon(angle)
        )  # fmt: skip
        found = twist_of(wide, rotation_of(wide))
        assert found.twist.contains(_henon_twist(angle))
        assert found.defect.contains(0)
        assert found.twist.rad() < 1e-4


@pytest.mark.parametrize("order", [1, 2, 3])
def test_resonances_up_to_three_have_no_finite_twist(order: int) -> None:
    with ctx.workprec(100):
        functions = _henon(2 * arb.pi() / order)
        if order < 3:
            with pytest.raises(NotEllipticError):
                rotation_of(functions)
        else:
            assert not twist_of(functions, rotation_of(functions)).twist.is_finite()


def test_a_hyperbolic_map_has_no_rotation() -> None:
    x, y = _variables()
    with ctx.workprec(100), pytest.raises(NotEllipticError):
        rotation_of((x.scaled(arb(2)) + y, x.scaled(arb(3)) + y.scaled(arb(2))))


def test_multipliers_are_those_of_the_derivative() -> None:
    with ctx.workprec(100):
        rotation = rotation_of(_henon(arb(1)))
        p, q = rotation.direction
        (a, b), (c, d) = [[jet[1, 0], jet[0, 1]] for jet in _henon(arb(1))]
        for left, right in ((a * p + b * q, p), (c * p + d * q, q)):
            difference = left - rotation.multiplier * right
            assert difference.contains(acb(0))
            assert float(abs(difference).upper()) < 1e-25
        u, v = rotation.component
        assert (u * p + v * q).contains(acb(1))
        assert (u * p.conjugate() + v * q.conjugate()).contains(acb(0))


def test_a_map_that_may_be_parabolic_has_no_rotation() -> None:
    with ctx.workprec(100):
        wide = tuple(
            Jet(2, ORDER, {(1, 0): a, (0, 1): b}) for a, b in ((arb(1, 0.01), arb(-0.1)), (arb(0.1), arb(1, 0.01)))
        )
        with pytest.raises(NotEllipticError):
            rotation_of(wide)
