"""Straight-line programs on graded Taylor models enclose what the program computes."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import ctx
from support.exact_elements import PRECISION, is_enclosed, number, random_arithmetic, random_element, random_point

from orbitproof.shared.systems import Program, record
from orbitproof.verify.algebra import Arithmetic, Grading, Series, evaluate, prepare
from orbitproof.verify.evidence import IntegrationFailure

Formula = Callable[[Sequence[Any]], Sequence[Any]]

# x and y stay near positive numbers, u is anything.
FORMULAS: dict[str, Formula] = {
    "constants": lambda v: (v[0] + Fraction(1, 3), Fraction(2, 7) - v[2], v[2] * Fraction(5, 11), Fraction(1, 7) * 3),
    "polynomial": lambda v: (v[0] * v[1] - v[2] * v[2] + 3, (v[0] + v[1]) * (v[0] - v[2]) * v[2]),
    "quotients": lambda v: (v[2] / v[0], 1 / (v[0] + v[1]), (v[0] - v[1]) / (v[0] * v[1]), v[0] / 3),
    "powers": lambda v: (v[0] ** -1.5, v[1] ** 0.5, v[0] ** Fraction(-2, 3), v[1] ** 3, v[0] ** -2, v[2] ** 0),
    "positive roots": lambda v: (v[0] ** 1.5, v[1] ** Fraction(1, 3), v[0] ** Fraction(7, 3)),
    "nested": lambda v: ((v[0] ** 0.5 + v[2] / v[1]) * (v[0] + v[1]) ** -1.5, ((v[0] + 1) ** -0.5 + v[1]) ** -1),
}


@pytest.fixture(autouse=True)
def _reference_precision() -> Iterator[None]:
    with mpmath.workprec(PRECISION), ctx.workprec(300):
        yield


def recorded(formula: Formula) -> Program:
    """The formula as a program of x, y, u."""
    return record(formula, ("x", "y", "u"))


def enclose(program: Program, arithmetic: Arithmetic, inputs: Sequence[Series]) -> list[Series]:
    """Enclosures of the outputs."""
    assert all(x.arithmetic is arithmetic for x in inputs)
    return evaluate(prepare(program), inputs)


@pytest.mark.parametrize("name", FORMULAS)
@pytest.mark.parametrize("seed", range(12))
def test_programs_enclose_the_exact_values(name: str, seed: int) -> None:
    source = random.Random(f"{name} {seed}")
    arithmetic = random_arithmetic(source)
    inputs = [
        random_element(source, arithmetic, centre=source.uniform(0.5, 3)),
        random_element(source, arithmetic, centre=source.uniform(0.5, 3)),
        random_element(source, arithmetic),
    ]
    program = recorded(FORMULAS[name])
    results = enclose(program, arithmetic, [x.series for x in inputs])
    for _ in range(10):
        theta, t, point = random_point(source, arithmetic.grading)
        exact = program.evaluate([x.at(theta, point) for x in inputs], number,
                                 lambda base, exponent: mpmath.power(base, number(exponent)))  # fmt: skip
        for result, value in zip(results, exact, strict=True):
            assert is_enclosed(result, value, theta, t, point)


def test_an_exact_program_has_narrow_enclosures() -> None:
    """Rounding is all that is left where the inputs are exact numbers."""
    arithmetic = Arithmetic(Grading((1, 1), 3), 100, 0, 3)
    inputs = [arithmetic.constant(Fraction(value)) for value in ("1.25", "0.5", "-2.75")]
    for formula in FORMULAS.values():
        for result in enclose(recorded(formula), arithmetic, inputs):
            assert sum(result.errors) < 2.0**-80


@pytest.mark.parametrize("formula", [lambda v: (1 / v[2],), lambda v: (v[2] ** -0.5,), lambda v: (v[2] ** 0.5,)])
@pytest.mark.parametrize("value", ["0", "1e-30"])
def test_singularities_are_failures(formula: Formula, value: str) -> None:
    arithmetic = Arithmetic(Grading((1, 1), 2), 60, 0, 3)
    inputs = [arithmetic.constant(Fraction(1))] * 2 + [
        arithmetic.polynomial({(0, 0): Fraction(value), (1, 0): Fraction(1, 1000)})
    ]
    with pytest.raises(IntegrationFailure) as failure:
        enclose(recorded(formula), arithmetic, inputs)
    assert failure.value.reason.condition == "singularity"
