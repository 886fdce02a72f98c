"""First integrals are proved from the programs, and what is not conserved is refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from orbitproof.shared.systems import AROUND, CR3BP, HILL, REGULARISATIONS, SYSTEMS, Program, ReversibleSystem, record
from orbitproof.verify.claim import check_symmetries, derivative_terms, is_first_integral, level_program
from orbitproof.verify.evidence import Checklist, NotEstablishedError

Function = Callable[[Sequence[Any], Sequence[Any]], Any]
HAMILTONIAN = {name: system for name, system in SYSTEMS.items() if system.first_integral is not None}


def integral_of(system: ReversibleSystem, change: Callable[[Any, Sequence[Any], Sequence[Any]], Any]) -> Program:
    """A function of the first integral, state and parameters."""
    integral = system.first_integral
    assert integral is not None
    return record(lambda x, p: (change(integral(x, p)[0], x, p),), system.state, tuple(system.parameters))


def plane(field: Function, integral: Function) -> bool:
    """Whether a function of (x, y) is shown to be a first integral of a field in the plane with parameter a."""
    names = ("x", "y"), ("a",)
    return is_first_integral(record(field, *names), record(lambda x, p: (integral(x, p),), *names))


@pytest.mark.parametrize("name", HAMILTONIAN)
def test_the_first_integrals_of_the_systems_are_conserved(name: str) -> None:
    system = HAMILTONIAN[name]
    assert system.first_integral_program is not None
    assert is_first_integral(system.program, system.first_integral_program)


@pytest.mark.parametrize("name", HAMILTONIAN)
@pytest.mark.parametrize(
    "change",
    [
        lambda h, x, p: h + x[2] * x[2],
        lambda h, x, p: h + Fraction(1, 10**300) * x[0],
        lambda h, x, p: h - p[0] * x[-1] * x[-1],
        lambda h, x, p: x[0],
    ],
)
def test_what_is_not_conserved_is_refused(name: str, change: Callable[..., Any]) -> None:
    system = HAMILTONIAN[name]
    assert not is_first_integral(system.program, integral_of(system, change))


@pytest.mark.parametrize("name", HAMILTONIAN)
def test_functions_of_a_first_integral_and_of_the_parameters_are_conserved(name: str) -> None:
    system = HAMILTONIAN[name]
    assert is_first_integral(system.program, integral_of(system, lambda h, x, p: h * h * h - p[0] * h + p[0] ** 2))


@pytest.mark.parametrize(
    "wrong",
    [
        replace(CR3BP, vector_field=lambda x, p: (*CR3BP.vector_field(x, p)[:5], -x[2])),
        replace(CR3BP, first_integral=lambda x, p: CR3BP.first_integral(x, [p[0] * p[0]])),  # type: ignore[misc]
        replace(HILL, first_integral=CR3BP.first_integral),
    ],
)
def test_a_system_whose_first_integral_is_not_conserved_is_refused(wrong: ReversibleSystem) -> None:
    with pytest.raises(NotEstablishedError, match="not shown to be constant along its orbits"):
        check_symmetries(Checklist(), wrong, "S")


@pytest.mark.parametrize("system", [*AROUND.values(), SYSTEMS["falkner-skan"]])
def test_a_system_without_a_first_integral_claims_none(system: ReversibleSystem) -> None:
    check_symmetries(Checklist(), system)


def test_the_bilinear_relation_is_conserved_in_regularised_coordinates() -> None:
    """u4 w1 - u3 w2 + u2 w3 - u1 w4 in the coordinates of section 14; |u|^2 is none."""
    names = REGULARISATIONS["cr3bp"].state, ("mu",), ("level",)
    field = REGULARISATIONS["cr3bp"].program

    def bilinear(v: Sequence[Any], _: Sequence[Any], __: Sequence[Any]) -> Sequence[Any]:
        return (v[3] * v[4] - v[2] * v[5] + v[1] * v[6] - v[0] * v[7],)

    assert is_first_integral(field, record(bilinear, *names))
    assert not is_first_integral(field, record(lambda v, _, __: (v[0] * v[0] + v[1] * v[1],), *names))


def test_powers_and_quotients_of_every_kind() -> None:
    def rotation(x: Sequence[Any], p: Sequence[Any]) -> Sequence[Any]:
        square = x[0] * x[0] + x[1] * x[1]
        rate = square ** Fraction(-1, 3) + p[0] / (1 + square) + square**-0.5
        return (-x[1] * rate, x[0] * rate)

    def square(x: Sequence[Any], _: Sequence[Any]) -> Any:
        return x[0] * x[0] + x[1] * x[1]

    assert plane(rotation, square)
    assert plane(rotation, lambda x, p: square(x, p) ** Fraction(2, 3) + 1 / square(x, p) + (1 + square(x, p)) ** -2)
    assert not plane(rotation, lambda x, p: square(x, p) ** Fraction(2, 3) + x[0])
    assert not plane(rotation, lambda x, p: (1 + square(x, p)) ** -2 * x[1])


def test_a_first_integral_that_is_not_defined_along_all_orbits_is_refused() -> None:
    """y/x is constant along x' = x, y' = y, but the orbits through x = 0 leave where it is defined; so for roots."""
    assert not plane(lambda x, p: (x[0], x[1]), lambda x, p: x[1] / x[0])
    assert not plane(lambda x, p: (p[0], p[0] - p[0]), lambda x, p: (x[1] * x[1]) ** 0.5)
    assert plane(lambda x, p: (p[0] / x[1], p[0] - p[0]), lambda x, p: 1 / x[1])
    assert not plane(lambda x, p: (p[0] / x[1], p[0] - p[0]), lambda x, p: x[1] ** -0.5)


def test_a_division_by_zero_proves_nothing() -> None:
    assert not plane(lambda x, p: (x[0] / (p[0] - p[0]), x[1]), lambda x, p: x[0])
    assert not plane(lambda x, p: (p[0] - p[0], x[1] / (p[0] - p[0])), lambda x, p: x[0])


@pytest.mark.parametrize(
    "function, terms",
    [
        (lambda x, a: x[0] * x[0] + 1 / x[1] - 1 / x[1], {(1, 0, 0): Fraction(2)}),
        (lambda x, a: x[0] * x[0] + 1 / x[0] - 1 / x[0], None),
        (lambda x, a: x[0] * x[0] + 1 / (x[1] - x[1]), None),
        (lambda x, a: x[0] * x[0] + x[0] / x[1], None),
        (lambda x, a: x[0] * x[1] + a[0], {(0, 1, 0): Fraction(1)}),
    ],
    ids=["without x below", "x below, cancelled", "defined nowhere", "no polynomial", "polynomial"],
)
def test_a_derivative_is_a_polynomial_only_where_the_function_is_defined_for_all_values(
    function: Function, terms: dict[tuple[int, ...], Fraction] | None
) -> None:
    assert derivative_terms(record(lambda x, a: (function(x, a),), ("x", "y"), ("a",)), "x") == terms


@pytest.mark.parametrize("sign", [1, -1])
def test_the_level_coordinate_does_not_depend_on_what_is_given_in_its_place(sign: int) -> None:
    state, mu = [0.7, 0.0, 0.2, 0.0, 0.3, 0.0], 0.01
    integral = CR3BP.first_integral
    assert integral is not None
    (level,) = integral(state, [mu])
    for other in (0.3, 0.0, 5.0):
        (found,) = level_program(CR3BP, sign).evaluate([*state[:4], other, state[5], mu, level])
        assert found == pytest.approx(sign * 0.3)


def test_a_quotient_by_a_number_is_that_quotient() -> None:
    energy: Function = lambda x, a: x[1] * x[1] / 2 + x[0] * x[0]  # noqa: E731
    assert plane(lambda x, a: (x[1], -2 * x[0]), energy)
    assert not plane(lambda x, a: (x[1], x[0] * Fraction(-1, 2)), energy)
