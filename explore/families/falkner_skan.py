"""The family of symmetric periodic orbits of the Falkner-Skan equation, in its parameter beta."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from orbitproof.explore.families.continuation import Family, Start, describe, extend, trace
from orbitproof.explore.families.following import Following
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.seeds import limit_orbit

BETA = (100.0, 1000.0)
"""Range of the parameter of the Falkner-Skan family unless told otherwise; it starts at the lower end."""


def trace_falkner_skan(following: Following) -> Family:
    """The family from beta = 100, or from where the range begins above it, down to its lower end and then up."""
    problem = following.problem((1000.0, 1.0, 1.0), None)
    limits, limit = following.limits, limit_orbit()
    low, high = limits.parameter_min, limits.parameter_max
    limits = replace(
        limits,
        parameter_min=low if np.isfinite(low) else BETA[0],
        parameter_max=high if np.isfinite(high) else BETA[1],
    )
    beta = max(BETA[0], limits.parameter_min)
    start = Start(np.array([beta, limit.upper, limit.half_period / np.sqrt(beta)]), np.array([1.0, 0.0, 0.0]))
    upwards = replace(limits, parameter_min=-np.inf)
    if limits.parameter_min >= beta:
        return trace(problem, start, following.course(problem, upwards))
    downwards = replace(limits, parameter_max=np.inf)
    down = trace(problem, replace(start, direction=-start.direction), following.course(problem, downwards))
    if down.outcome == "limit" and down.orbits[-1].unknowns[0] > limits.parameter_min:
        raise CorrectionFailure(f"beta = {limits.parameter_min:g} is not reached: {down.reason}; allow more orbits")
    family = down.turned()
    if down.outcome == "interrupted":
        return replace(family, outcome="interrupted", reason=down.reason, beginning=None)
    beyond = [i for i, orbit in enumerate(family.orbits) if orbit.unknowns[0] > limits.parameter_max]
    if beyond:
        end = beyond[0]
        reason = f"limit beta = {limits.parameter_max:g} ({describe(problem, family.orbits[end])})"
        orbits, tangents = family.orbits[: end + 1], family.tangents[: end + 1]
        return replace(family, orbits=orbits, tangents=tangents, outcome="limit", reason=reason)
    return extend(family, following.course(problem, upwards, family.orbits))
