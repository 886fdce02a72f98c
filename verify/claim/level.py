"""The level of the first integral as bifurcation parameter (section 12).

If H = A + b w^2 with A independent of the coordinate w and a constant b, then on Fix(R) w follows from
the level h of H and the other coordinates: w = +-((h - A) / b)^(1/2). With w formed in this way the
Poincare maps on the levels of H are a family of maps with the parameter h.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import LEVEL_NAME, Program, ReversibleSystem, record
from orbitproof.verify.claim.first_integral import derivative_terms
from orbitproof.verify.evidence import Checklist, enclose, power


def quadratic_coefficient(system: ReversibleSystem) -> Fraction | None:
    """The constant b if the program of H shows H = A + b w^2, w the level coordinate; else `None`."""
    program, name = system.first_integral_program, system.level_coordinate
    if program is None or name is None:
        return None
    if system.defined:
        from orbitproof.verify.claim.functions import behind_functions

        if name in behind_functions(system, program):
            return None
    terms = derivative_terms(program, name)
    linear = tuple(int(argument == name) for argument in program.inputs)
    return terms.get(linear, Fraction(0)) / 2 if terms is not None and set(terms) <= {linear} else None


def level_program(system: ReversibleSystem, sign: int) -> Program:
    """The level coordinate w; inputs: state (its own entry is not used), parameters, level of H.

    Raises `ValueError` if H was not shown to be A + b w^2 with b != 0.
    """
    coefficient = quadratic_coefficient(system)
    integral, name = system.first_integral, system.level_coordinate
    if not coefficient or integral is None or name is None:
        raise ValueError(f"the first integral of {system.name} was not shown to be quadratic in a coordinate")
    position = system.state.index(name)

    def coordinate(state: Sequence[Any], parameters: Sequence[Any], level: Sequence[Any]) -> Sequence[Any]:
        (rest,) = integral([0 if i == position else value for i, value in enumerate(state)], parameters)
        return (((level[0] - rest) * (1 / coefficient)) ** Fraction(1, 2) * sign,)

    return record(coordinate, system.state, tuple(system.parameters), (LEVEL_NAME,))


def check_level(checklist: Checklist, candidate: Candidate) -> None:
    """Check that w follows from the level at all points of the box; S leaves the sheet alone (`adapted-frames`)."""
    fixed = candidate.system.fixed_level
    if fixed is not None and fixed.between is not None:
        from orbitproof.verify.claim.fixed_level import check_interval

        check_interval(checklist, candidate, fixed)
        return
    statement = "the first integral is A + b w^2, w the level coordinate, A independent of w, b a constant other than 0"
    with checklist.hypothesis(
        "level", "12", statement, "give the candidate in the coordinates of Fix(R), without parameter"
    ) as evidence:
        coefficient = quadratic_coefficient(candidate.system)
        evidence.require(bool(coefficient), "the program of the first integral does not show it")
        if coefficient:
            evidence.record("b", enclose(coefficient))


def point_on_fixed_set(candidate: Candidate, where: Mapping[str, arb]) -> dict[str, arb]:
    """Enclosures of all coordinates of Fix(R), from those of the level and the other coordinates."""
    system, sign = candidate.system, candidate.level_sign
    if sign is None:
        raise ValueError("the candidate is given in the coordinates of Fix(R)")
    program = level_program(system, sign)
    state = [where.get(name, arb(0)) for name in system.state]
    parameters = [enclose(candidate.parameters[name]) for name in system.parameters]
    if system.defined:
        from orbitproof.verify.claim.functions import enclose_functions

        state = enclose_functions(system, state, parameters)
    (value,) = program.evaluate([*state, *parameters, where[candidate.coordinates[0]]], enclose, power)
    named = {**where, str(system.level_coordinate): value}
    return {name: named[name] for name in system.centre_coordinates}
