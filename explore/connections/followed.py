"""A claimed homoclinic orbit from its box to Fix(R), followed in many digits."""

from __future__ import annotations

from math import log2
from typing import Any

import numpy as np

from orbitproof.explore.connections.homoclinic import ConnectionFailure, OnLevel
from orbitproof.explore.connections.swarm import Array
from orbitproof.explore.numerics import mpf, working_context
from orbitproof.explore.refinement import IntegrationFailure, JetBasis, section_crossings
from orbitproof.shared.claims import HomoclinicOrbit
from orbitproof.shared.systems import ReversibleSystem

_BITS = 128
"""So many bits and those that the orbit loses on its way."""


def setting_of(claim: HomoclinicOrbit) -> OnLevel:
    """The section of a claim on its level. Raises `ConnectionFailure`."""
    system = claim.system
    reversible = ReversibleSystem(
        name=system.name,
        title=system.title,
        state=system.state,
        parameters=system.parameters,
        vector_field=system.vector_field,
        reversing_symmetry=claim.reversing_symmetry,
        section=claim.section,
        level_coordinate=claim.level_coordinate,
        first_integral=system.first_integral,
        first_integral_name=system.first_integral_name,
    )
    assert claim.level is not None
    return OnLevel(reversible, dict(claim.parameters), claim.level, claim.level_sign)


def half_of(claim: HomoclinicOrbit) -> tuple[Array, Array]:
    """The orbit of a claim from the unstable direction at a distance of a to Fix(R), in parts between crossings.

    Returns the states at their starts, shape (k, 4), and their durations, shape (k,), both to double precision. Whether
    the end is on Fix(R) is not looked at. Raises `ConnectionFailure`.
    """
    setting, (c, a) = setting_of(claim), claim.centre
    context = working_context(_BITS - int(log2(abs(a))))
    basis = JetBasis.graded((1,), 0)

    def jet(value: Any) -> Any:
        return basis.constant(mpf(value, context))

    states, times = [], [0.0]
    try:
        start = setting.start(jet(c + a), jet(claim.slope * a), context)
        crossings = section_crossings(setting.system, setting.parameters, start, None, context)
        states.append([float(x.coefficients[0]) for x in start])
        for _ in range(claim.arrival):
            crossing = next(crossings)
            states.append([float(x.coefficients[0]) for x in crossing.jets])
            times.append(crossing.time)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise ConnectionFailure(f"the homoclinic orbit of {claim.id} is not found: {failure}") from None
    return np.array(states[:-1]), np.diff(times)
