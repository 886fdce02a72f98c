"""Of claims about a box: what is computed of balls contains what is computed of each of their points."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from operator import attrgetter
from typing import Any

import pytest
from flint import arb
from support.inclusion import Path, broken_inclusions
from support.within import within

from orbitproof.verify.double_resonance.equations import ResonanceEquations
from orbitproof.verify.evidence import DerivativeTable, MultiIndex, guarded, indices_of_degree, indices_up_to
from orbitproof.verify.krein.equations import CollisionEquations
from orbitproof.verify.krein.normal_form import _cubic_part, _solved, cubic_coefficient
from orbitproof.verify.newton import BoxFunction, Jet
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.reversor_breaking.equations import LossEquations
from orbitproof.verify.tori.normal_form import (
    EllipticPoint,
    combination,
    determinant_of,
    elliptic_point,
    in_coordinates,
    torsion,
    trace_and_determinant,
)
from orbitproof.verify.twist import rotation_of, twist_of

BITS = 160
SLACK = arb(0, 1) / 2**16

precision = within(lambda: guarded(BITS))


@pytest.mark.parametrize("seed", range(16))
def test_normal_forms_of_maps_with_one_pair(seed: int) -> None:
    chance = random.Random(seed)
    bent = [sparse(2, chance, 1) for _ in range(2)]

    def functions(cosine: arb, up: arb) -> tuple[Jet, ...]:
        linear = {(1, 0): cosine, (0, 1): (cosine * cosine - 1) / up}, {(1, 0): up, (0, 1): cosine}
        return tuple(Jet(2, 3, {**first, **rest}) for first, rest in zip(linear, bent, strict=True))

    arguments = arb(chance.uniform(0.3, 2.9)).cos(), arb(chance.choice([-1, 1]) * chance.uniform(0.2, 3))
    jets = functions(*arguments)
    rotation = rotation_of(jets)
    assert not broken_inclusions(lambda *linear: rotation_of(functions(*linear)), arguments, chance)
    assert not broken_inclusions(twist_of, (jets, rotation), chance, 30)
    for choice in ("multiplier", "direction", "component"):
        assert not broken_inclusions(attrgetter(choice), (rotation,), chance), choice


@pytest.mark.parametrize("seed", range(6))
def test_normal_forms_of_maps_with_two_pairs(seed: int) -> None:
    chance = random.Random(seed)
    block = [[chance.uniform(-1, 1) for _ in range(4)] for _ in range(4)]
    # The p, p part has two different eigenvalues in (-1, 1).
    block[0][0], block[1][1], block[0][1], block[1][0] = (chance.uniform(*ends) for ends in SPLIT)
    jets = tuple(
        Jet(4, 3, {**{unit(4, j): arb(value) for j, value in enumerate(row)}, **sparse(4, chance, 2)}) for row in block
    )
    point = elliptic_point(jets)
    moved = in_coordinates(jets, point)

    linear = of_degrees((1,))
    assert not broken_inclusions(elliptic_point, (jets,), chance, 16, where=linear)
    assert not broken_inclusions(trace_and_determinant, (jets,), chance, 8, where=linear)
    assert not broken_inclusions(determinant_of, (jets,), chance, 8, where=linear)
    assert not broken_inclusions(lambda jets: in_coordinates(jets, point), (jets,), chance, 4)
    assert not broken_inclusions(lambda covectors: moved_by(covectors, jets, point), (point.covectors,), chance, 4)
    assert not broken_inclusions(lambda moved: torsion(moved, point.multipliers), (moved,), chance, 6)
    assert not broken_inclusions(lambda multipliers: torsion(moved, multipliers), (point.multipliers,), chance, 4)
    for k in ((1, 2), (3, -1), (0, -4)):
        assert not broken_inclusions(partial(combination, k=k), (point.multipliers,), chance), k
    cosine = arb(chance.uniform(-0.8, 0.8))
    assert not broken_inclusions(lambda jets: cubic_coefficient(jets, cosine), (jets,), chance, 16, where=linear)
    assert not broken_inclusions(lambda jets: cubic_coefficient(jets, cosine), (jets,), chance, 3)
    assert not broken_inclusions(lambda cosine: cubic_coefficient(jets, cosine), (cosine,), chance)
    matrix, vector = [[jet[unit(4, j)] for j in range(4)] for jet in jets], list(point.covectors[0])
    whole = point.multipliers[0]
    assert not broken_inclusions(lambda right: _cubic_part(jets, matrix, right, whole), (vector,), chance, 4)
    assert not broken_inclusions(lambda right: _solved(matrix, whole * whole, right), (vector,), chance, 4)


def of_degrees(degrees: tuple[int, ...]) -> Callable[[Path], bool]:
    """Whether a number is of a term of one of these degrees."""
    return lambda path: sum(path[-1]) in degrees


SPLIT = ((0.3, 0.6), (-0.6, -0.3), (-0.4, -0.1), (-0.4, -0.05))


def moved_by(covectors: Any, jets: tuple[Jet, ...], point: EllipticPoint) -> Any:
    return in_coordinates(jets, replace(point, covectors=covectors))


def sparse(variables: int, chance: random.Random, count: int) -> dict[MultiIndex, arb]:
    """So many terms of degree 2 and 3 each: with more of them every error is small beside their bounds."""
    terms = [index for degree in (2, 3) for index in chance.sample(indices_of_degree(variables, degree), count)]
    return {index: arb(chance.uniform(-1, 1)) for index in terms}


class AtPoint(BoxFunction):
    """A function that is known at one point, and asked for it there only."""

    def derivative(self, index: MultiIndex, where: Sequence[arb]) -> arb:
        return self.table.centre[index]


def functions_of(derivatives: list[dict[MultiIndex, arb]], where: list[arb]) -> tuple[BoxFunction, ...]:
    """Functions that are known at a point; nearly so about it, if they are asked for elsewhere."""
    if all(ball.is_zero() for ball in where):
        return tuple(AtPoint(DerivativeTable({}, each)) for each in derivatives)
    boxes = [{index: ball + SLACK * (sum(index) < 3) for index, ball in each.items()} for each in derivatives]
    return tuple(BoxFunction(DerivativeTable(box, each)) for box, each in zip(boxes, derivatives, strict=True))


def at_a_point(count: int, variables: int, first: int, chance: random.Random) -> list[dict[MultiIndex, arb]]:
    """Derivatives of so many functions, random ones, with a regular block from the variable `first` on."""
    found = []
    for row in range(count):
        derivatives = {index: arb(chance.uniform(-1, 1)) for index in indices_up_to(variables, 3)}
        derivatives[unit(variables, first + row)] += arb(chance.choice([-2, 2]))
        found.append(derivatives)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_equations_of_a_collision(seed: int) -> None:
    chance = random.Random(seed)

    def found(choice: str, derivatives: Any, where: Any) -> Any:
        functions = functions_of(derivatives, where)
        return getattr(CollisionEquations(functions[2:], functions[:2]), choice)(where)

    derivatives, where = at_a_point(4, 5, 1, chance), [arb(0)] * 3
    for choice, most, degrees in (
        ("values", 3, (0,)), ("slopes", 3, (1,)), ("half", 4, (1,)), ("discriminant", 16, (1,)), ("matrix", 20, (1,)),
        ("matrix", 12, (2,)), ("jets", 3, (1, 2, 3)),
    ):  # fmt: skip
        of_point = partial(found, choice, where=where)
        assert not broken_inclusions(of_point, (derivatives,), chance, most, where=of_degrees(degrees))
        assert not broken_inclusions(partial(found, choice, derivatives), (where,), chance), choice


@pytest.mark.parametrize("size", [1, 2])
def test_equations_of_a_loss_of_r(size: int) -> None:
    chance = random.Random(size)
    derivatives, where = at_a_point(2 * size, 2 * size + 1, 1, chance), [arb(0)] * (size + 1)

    def found(choice: str, derivatives: Any, where: Any) -> Any:
        functions = functions_of(derivatives, where)
        equations = LossEquations(functions[:size], functions[size:], size - 1)
        answer = getattr(equations, choice)(where)
        return (answer, answer.opening) if choice == "coefficients" else answer

    for choice, most in (("values", 2), ("kernel_over", 9), ("matrix", 12), ("coefficients", 24)):
        degrees = {"values": (0,), "kernel_over": (1,), "matrix": (1, 2)}.get(choice, (1, 2, 3))
        of_point = partial(found, choice, where=where)
        assert not broken_inclusions(of_point, (derivatives,), chance, most, where=of_degrees(degrees))
        assert not broken_inclusions(partial(found, choice, derivatives), (where,), chance), choice


@pytest.mark.parametrize("size", [1, 2])
def test_equations_of_a_double_resonance(size: int) -> None:
    chance = random.Random(size)
    variables = size + 2
    kernel, image = (at_a_point(count, variables, 1, chance) for count in (size, size + 1))
    directions = tuple(tuple(Fraction(chance.randint(-8, 8), 8) for _ in range(variables)) for _ in range(variables))

    def found(choice: str, kernel: Any, image: Any, level: Any, where: Any) -> Any:
        equations = ResonanceEquations(functions_of(kernel, where), functions_of(image, where), directions, level, size)
        answer = getattr(equations, choice)(where)
        return (answer, answer.opening) if choice == "unfolding" else answer

    level, where = arb(chance.uniform(-0.9, 0.9)), [arb(0)] * variables
    for choice, most in (("values", 4), ("matrix", 3), ("across_slopes", 2), ("stability_matrix", 2), ("unfolding", 8)):
        degrees = {"values": (0, 1, 2), "across_slopes": (1,), "stability_matrix": (1,)}.get(choice, (1, 2, 3))

        if choice != "stability_matrix":
            of_kernel = partial(found, choice, image=image, level=level, where=where)
            assert not broken_inclusions(of_kernel, (kernel,), chance, most, where=of_degrees(degrees)), choice
        if choice != "across_slopes":
            of_image = partial(found, choice, kernel, level=level, where=where)
            assert not broken_inclusions(of_image, (image,), chance, most, where=of_degrees(degrees)), choice
        if choice in ("values", "matrix", "unfolding"):
            of_level = partial(found, choice, kernel, image, where=where)
            assert not broken_inclusions(of_level, (level,), chance), choice
        assert not broken_inclusions(partial(found, choice, kernel, image, level), (where,), chance), choice
