"""Catalogues of the short- and long-period families of L4 and L5, whose orbits no reversor maps to themselves."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.periodic import PeriodicFailure, PeriodicRequest, StepControl, find_periodic, followed
from orbitproof.explore.three_body.catalogues.dense import with_distances
from orbitproof.explore.three_body.catalogues.file import Catalogue
from orbitproof.explore.three_body.catalogues.orbits import system_name
from orbitproof.explore.three_body.seeds import triangular_orbit
from orbitproof.shared.systems import CR3BP

_LEVELS = (-20.0, 20.0)

_KINDS = {"short": "short", "long": "longp"}
"""Our names of the kinds, and those of the JPL catalogue."""


def triangular_catalogue(
    name: str, mass: Fraction, label: str, rows: int, progress: Progress | None = None
) -> tuple[Catalogue, str]:
    """At most so many orbits of a family by name, and why it ends. Raises `PeriodicFailure`."""
    try:
        start, period = triangular_orbit(float(mass), name)
    except ValueError as error:
        raise PeriodicFailure(str(error)) from None
    request = PeriodicRequest(CR3BP, {"mu": mass}, tuple(start[key] for key in CR3BP.state), period)
    found = next(iter(find_periodic(request, lambda message, fraction: None)))
    control = StepControl(most=max(2, rows))
    family = next(iter(followed(found, None, _LEVELS, progress=progress, control=control)))
    # It is traced both ways; the way towards the point is short.
    members = sorted(family.members, key=lambda member: member.orbit.size)[:rows]
    point, kind = name.split("-")
    catalogue = Catalogue(
        mass_ratio=mass,
        states=np.array([member.orbit.point for member in members]),
        jacobi_constants=np.array([member.value for member in members]),
        periods=np.array([member.orbit.period for member in members]),
        stability_indices=np.array([_index(member.orbit.multipliers) for member in members]),
        system=system_name(label),
        family=_KINDS[kind],
        point=point[1:],
    )
    return with_distances(catalogue, 2, symmetric=False), family.reason


def _index(multipliers: np.ndarray) -> float:
    sizes = np.abs(np.asarray(multipliers))
    sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
    return float(np.max((sizes + 1 / sizes) / 2, initial=1.0))
