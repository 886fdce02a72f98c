"""In which coordinates a half return takes less time, by an estimate in float64 (section 14)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.oracle.centre import float_coefficients, step_size
from orbitproof.verify.poincare import Coordinates

_ROUGH_DEGREE = 24
_MOST_STEPS = 400
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


def steps_to_section(
    coordinates: Coordinates, state: Sequence[float], constants: Sequence[float], bits: int, degree: int, most: int
) -> int | None:
    """Number of steps to the next crossing of the section, in float64; `None` if above `most` or not found."""
    section = coordinates.section
    state = list(state)
    before = 0.0
    for count in range(1, most + 1):
        try:
            series = float_coefficients(coordinates.program, [*state, *constants], _ROUGH_DEGREE)
            size = step_size(series, -float(bits), degree)
        except (IntegrationFailure, TypeError):
            return None
        state = [_horner(row, size) for row in series]
        after = state[section]
        if before and (after < 0) != (before < 0):
            return count
        before = after
    return None


def _horner(coefficients: Sequence[float], at: float) -> float:
    result = 0.0
    for c in reversed(coefficients):
        result = result * at + c
    return result
