"""The flow by a method that shares nothing with the code under test, and crossings by that code, to compare."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath

from orbitproof.explore.numerics import working_context
from orbitproof.explore.refinement import Jet, JetBasis, section_crossings, section_jets, start_jets
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS, ReversibleSystem

EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}


def extrapolated_flow(
    system: ReversibleSystem, parameters: Sequence[Any], state: Sequence[Any], time: Any, steps: int, columns: int = 14
) -> list[Any]:
    """The flow by the extrapolated modified midpoint rule, in mpmath: shares nothing with the code under test."""

    def field(x: Sequence[Any]) -> Sequence[Any]:
        return system.vector_field(x, parameters)

    current = list(state)
    for _ in range(steps):
        length = time / steps
        table: list[list[Any]] = []
        for j in range(1, columns + 1):
            n = 2 * j
            h = length / n
            before, here = current, [a + h * b for a, b in zip(current, field(current), strict=True)]
            for _ in range(n - 1):
                before, here = here, [a + 2 * h * b for a, b in zip(before, field(here), strict=True)]
            row = [(a + b + h * c) / 2 for a, b, c in zip(before, here, field(here), strict=True)]
            table.append(row)
            for m in range(j - 2, -1, -1):
                factor = mpmath.mpf(j * j) / ((m + 1) * (m + 1)) - 1
                table[m] = [b + (b - a) / factor for a, b in zip(table[m], table[m + 1], strict=True)]
        current = table[0]
    return current


def extrapolated_crossings(
    system: ReversibleSystem, parameters: Sequence[Any], state: Sequence[Any], times: Sequence[float], steps: int
) -> list[Any]:
    """The state at the last of the crossings whose approximate times are given."""
    current = extrapolated_flow(system, parameters, state, mpmath.mpf(times[-1]), steps)
    section = system.section_index
    for _ in range(3):
        correction = -current[section] / system.vector_field(current, parameters)[section]
        current = extrapolated_flow(system, parameters, current, correction, 1)
    return current


def crossings(
    system: ReversibleSystem, point: Sequence[Any], count: int, bits: int, basis: JetBasis, directions: Any = ()
) -> tuple[list[list[Jet]], list[float]]:
    """The first crossings from a point of Fix(R), in the coordinates (u, q), and their times."""
    context = working_context(bits)
    values = [context.mpf(x.numerator) / x.denominator for x in map(Fraction, point)]
    start, parameter = start_jets(system, values, directions, basis)
    parameters = EARTH_MOON if system is CR3BP else {}
    images, times = [], []
    for crossing in section_crossings(system, parameters, start, parameter, context):
        images.append(section_jets(system, crossing, parameter))
        times.append(crossing.time)
        if len(images) == count:
            break
    return images, times


CONSTANTS = JetBasis.graded((1,), 0)
LINEAR = JetBasis.graded((1, 1, 1), 1)
