"""How many steps returns take, and in which coordinates they take less time: estimates in float64 (14.4 and 23.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import rough
from orbitproof.verify.oracle.centre import float_coefficients, step_size
from orbitproof.verify.poincare import PHYSICAL, Coordinates, coordinates_of

_ROUGH_DEGREE = 24
_MOST_STEPS = 400
_MOST_FURTHER = 10_000
_AT_REST = 2.0**-44
_COST = 2.0
"""A step in regularised coordinates was found to take about so many times as long as one in the system's own."""


def regularised_steps(
    own: Coordinates,
    other: Coordinates,
    point: Sequence[float],
    parameters: Sequence[float],
    level: float,
    bits: int,
    degree: int,
) -> int:
    """See `poincare.Oracle`."""
    if other.embedding is None:
        return 0
    embedded = [float(value) for value in other.embedding.evaluate([*point, *parameters])]
    few = steps_to_section(other, embedded, [*parameters, level], bits, degree, _MOST_STEPS)
    if few is None:
        return 0
    return 0 if steps_to_section(own, point, parameters, bits, degree, int(_COST * few)) is not None else few


def steps_about(
    system: ReversibleSystem, points: Sequence[Mapping[str, float]], bits: int, degree: int
) -> Sequence[int]:
    """About how many steps half returns take in the system's own coordinates; 0 if that is not found.

    Args:
        points: coordinates on Fix(R) and parameters of each, by name; what is not given is 0.
    """
    if system.normalised or system.defined or system.fixed_level is not None or system.derived_parameters:
        return [0] * len(points)
    own = coordinates_of(PHYSICAL, system.program, len(system.state), system.section_index)
    found = []
    for point in points:
        state, constants = ([point.get(name, 0.0) for name in names] for names in (system.state, system.parameters))
        try:
            found.append(steps_to_section(own, state, constants, bits, degree, _MOST_STEPS) or _MOST_STEPS)
        except (ArithmeticError, ValueError):
            found.append(0)
    return found


def further_steps(
    coordinates: Coordinates,
    arithmetic: Arithmetic,
    state: Sequence[Series],
    constants: Sequence[Series],
    crossings: int,
) -> int:
    """See `maps.FramingOracle`."""
    bits, degree = arithmetic.bits, arithmetic.degree
    now, fixed = (rough([int(x.coefs[0][0]) for x in values], bits) for values in (state, constants))
    return steps_to_section(coordinates, now, fixed, bits, degree, _MOST_FURTHER * crossings, crossings) or 0


def steps_to_section(
    coordinates: Coordinates,
    state: Sequence[float],
    constants: Sequence[float],
    bits: int,
    degree: int,
    most: int,
    crossings: int = 1,
) -> int | None:
    """Number of steps to a crossing of the section, the next one at first, in float64.

    `None` if it is above `most` or not found, or if the orbit comes to rest.
    """
    section = coordinates.section
    state = list(state)
    before, farthest = 0.0, [0.0] * len(state)
    for count in range(1, most + 1):
        try:
            series = float_coefficients(coordinates.program, [*state, *constants], _ROUGH_DEGREE)
            size = step_size(series, -float(bits), degree)
        except (IntegrationFailure, TypeError):
            return None
        farthest = [max(far, abs(row[0])) for far, row in zip(farthest, series, strict=True)]
        if all(abs(row[1]) * size <= _AT_REST * far for far, row in zip(farthest, series, strict=True)):
            return None
        state = [_horner(row, size) for row in series]
        after = state[section]
        if before and (after < 0) != (before < 0):
            crossings -= 1
            if not crossings:
                return count
        before = after
    return None


def _horner(coefficients: Sequence[float], at: float) -> float:
    result = 0.0
    for c in reversed(coefficients):
        result = result * at + c
    return result
