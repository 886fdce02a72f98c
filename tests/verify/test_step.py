"""One step encloses the orbits of all initial values and parameters that its elements stand for."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import fmpz_poly
from support.exact_elements import (
    PRECISION,
    Element,
    Unknown,
    exponents_of_grade,
    is_enclosed,
    number,
    random_point,
)
from support.within import within

from orbitproof.shared.systems import record
from orbitproof.verify.algebra import Arithmetic, Grading, Series, prepare
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import FlowStep, advance
from orbitproof.verify.oracle import ORACLE

Field = Callable[[Sequence[Any], Sequence[Any]], Sequence[Any]]
Flow = Callable[[Any, Any, Any], Any]
FIELDS: dict[str, tuple[Field, Flow]] = {
    "square": (lambda x, p: (p[0] * x[0] * x[0],), lambda x, a, t: x / (1 - a * t * x)),
    "growth": (lambda x, p: (p[0] * x[0],), lambda x, a, t: x * mpmath.exp(a * t)),
    "quotient": (lambda x, p: (p[0] / x[0],), lambda x, a, t: x * mpmath.sqrt(1 + 2 * a * t / (x * x))),
}
"""Fields in x with a parameter a, and their flows."""

_reference_precision = within(lambda: mpmath.workprec(PRECISION))


def constant_element(
    source: random.Random, arithmetic: Arithmetic, centre: float, size: float, unknown: float
) -> Element:
    """An exact element without theta, and its enclosure; its parts are up to `size` and `unknown` in each grade."""
    grading = arithmetic.grading
    middle = Fraction(centre)
    terms = {e: middle if not any(e) else Fraction(source.uniform(-size, size)) for e in grading.monomials}
    parts, errors = [], []
    for slot in range(grading.top + 2):
        errors.append(unknown * 10.0 ** source.uniform(-3, 0))
        parts.append(Unknown(errors[-1], source.choice(exponents_of_grade(grading, slot)), source.randrange(2)))
    series = arithmetic.polynomial(terms)
    return Element(series.with_errors([a + b for a, b in zip(series.errors, errors, strict=True)]), tuple(parts))


def step_of(name: str, state: Series, parameter: Series, step: Fraction) -> FlowStep:
    program = prepare(record(FIELDS[name][0], ("x",), ("a",)))
    expansion = ORACLE.expand(program, state.arithmetic, [state], [parameter])
    return advance(program, [state], [parameter], expansion, step)


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("seed", range(12))
def test_a_step_encloses_the_orbits_of_all_initial_values_and_parameters(name: str, seed: int) -> None:
    """Unknown parts so large that the tube, the derivatives on it and their growth matter; or none, and low degrees."""
    source = random.Random(f"{name} {seed}")
    degree, share = ((20, 1), (3, 1e-20))[seed % 2]
    arithmetic = Arithmetic(Grading((1,), source.choice((1, 2))), 80, 4, degree)
    (centre, size), (middle, width), step = {
        "square": ((source.choice((0.0, 0.3)), 0.05), (0.5, 0.02), Fraction(1, 2)),
        "growth": ((source.choice((0.0, 0.3)), 0.05), (0.5, 0.3), Fraction(2)),
        "quotient": ((0.8, 0.004), (0.5, 0.01), Fraction(1, 8)),
    }[name]
    state = constant_element(source, arithmetic, centre, size, share * size)
    parameter = constant_element(source, arithmetic, middle, width, share * width)
    flow = step_of(name, state.series, parameter.series, step)
    for _ in range(6):
        theta, t, point = random_point(source, arithmetic.grading)
        exact = FIELDS[name][1](state.at(theta, point), parameter.at(theta, point), number(step) * theta)
        assert is_enclosed(flow.solution[0], exact, theta, t, point)
        exact = FIELDS[name][1](state.at(theta, point), parameter.at(theta, point), number(step))
        assert is_enclosed(flow.end[0], exact, theta, t, point)


@pytest.mark.parametrize("share", [Fraction(1, 32), Fraction(1, 20), Fraction(1), Fraction(2)], ids=str)
def test_a_step_on_which_an_orbit_ceases_to_exist_is_refused(share: Fraction) -> None:
    """x' = x^2 from x(0) = e exists up to 1/e; of the shorter steps the enclosure holds all."""
    error = Fraction(1, 16)
    arithmetic = Arithmetic(Grading((1,), 1), 80, 0, 8)
    state = Series(arithmetic, [fmpz_poly([])] * 2, [float(error), 0.0, 0.0])
    whole = share / error
    if share >= 1:
        with pytest.raises(IntegrationFailure) as failure:
            step_of("square", state, arithmetic.constant(Fraction(1)), whole)
        assert failure.value.reason.condition == "tube"
    else:
        flow = step_of("square", state, arithmetic.constant(Fraction(1)), whole)
        assert Fraction(flow.end[0].errors[0]) >= error / (1 - share)
