"""A dense catalogue of a traced family: orbits at equal steps along it, all corrected at once."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.families import Family, TracedFamily
from orbitproof.explore.flow import Flags, Matrix, Vector, flow_batch
from orbitproof.explore.numerics import predict
from orbitproof.explore.orbits import ShootingProblem, correct_batch
from orbitproof.explore.three_body.catalogues.columns import (
    ALTITUDE,
    CLOSING,
    GREATEST,
    HITS,
    LEAST,
    LEAST_FROM_LARGER,
    NUMERICAL,
    PROVED,
)
from orbitproof.explore.three_body.catalogues.distances import PARTS, distances_from_primaries
from orbitproof.explore.three_body.catalogues.file import Catalogue
from orbitproof.explore.three_body.catalogues.orbits import catalogue_of
from orbitproof.shared.systems import UNITS

CLOSES = 1e-9
"""Largest closing error of an orbit relative to the growth of errors over its period, the norm of its monodromy."""


def between_hits(item: TracedFamily) -> tuple[float, float]:
    """The arclengths between which lie all orbits that do not hit the smaller primary; the ends where none is known."""
    family, lengths = item.family, item.family.arclengths
    traced = catalogue_of(family, item.name, item.label)
    told = with_distances(traced, max(orbit.crossings for orbit in family.orbits)).more.get(ALTITUDE, ())
    heights = np.array([np.nan if value is None else value for value in told])
    free = np.flatnonzero(heights >= 0)
    if not len(free):
        return lengths[0], lengths[-1]

    def edge(last: int, outside: int) -> float:
        """Where the altitude is 0, between an orbit that flies and the next one."""
        if not 0 <= outside < len(heights) or np.isnan(heights[outside]):
            return lengths[last]
        share = heights[last] / (heights[last] - heights[outside])
        return float(lengths[last] + share * (lengths[outside] - lengths[last]))

    return edge(free[0], free[0] - 1), edge(free[-1], free[-1] + 1)


def dense_catalogue(
    item: TracedFamily, places: Vector, progress: Progress | None = None
) -> tuple[Catalogue, Counter[str]]:
    """The orbits of a family at arclengths, equally far apart, with distances; and how many are missing, by reason."""
    family = item.family
    if len(family.orbits) < 2:
        return with_distances(catalogue_of(family, item.name, item.label), family.orbits[0].crossings), Counter()
    problem = family.problem
    guesses, normals = _predicted(family, places)
    batch = correct_batch(
        problem.system,
        {name: float(value) for name, value in problem.parameters.items()},
        guesses,
        symmetry=problem.symmetry,
        scale=problem.scales,
        normals=normals,
        progress=progress,
    )
    step = places[1] - places[0] if len(places) > 1 else 0.0
    moved = np.linalg.norm((batch.unknowns - guesses) / problem.scales, axis=1)
    near = moved <= max(step, _longest(family))
    errors, closed = _closing(problem, batch.states, np.where(batch.converged, 2 * batch.unknowns[:, -1], 0.0))
    good = np.flatnonzero(batch.converged & near & closed)
    missing = Counter(
        batch.failures[i].partition(" over time ")[0] or ("it does not close" if near[i] else "another orbit was found")
        for i in np.delete(np.arange(len(places)), good)
    )
    assert batch.first_integrals is not None
    catalogue = replace(
        catalogue_of(family, item.name, item.label),
        states=batch.states[good],
        jacobi_constants=batch.first_integrals[good],
        periods=2 * batch.unknowns[good, -1],
        stability_indices=batch.stability_indices[good],
        more={CLOSING: tuple(errors[good].tolist())},
    )
    return with_distances(catalogue, int(max(batch.crossings[good], default=1))), missing


def _closing(problem: ShootingProblem, states: Matrix, periods: Vector) -> tuple[Vector, Flags]:
    """How far from N states their orbits are after their periods, and whether that is no more than errors grow to."""
    parameters = np.tile(problem.parameter_values(np.zeros(problem.size)), (len(states), 1))
    flow = flow_batch(problem.system, states, periods, parameters)
    errors = np.linalg.norm(flow.states - states, axis=1)
    return errors, flow.finished & (errors <= CLOSES * np.linalg.norm(flow.state_transitions, axis=(1, 2)))


def with_distances(catalogue: Catalogue, crossings: int = 1, *, symmetric: bool = True) -> Catalogue:
    """The catalogue with columns of distances, of whether orbits hit the smaller primary, and of what is proved."""
    mass = float(catalogue.mass_ratio)
    times = catalogue.periods / 2 if symmetric else catalogue.periods
    parts = PARTS * min(crossings, 8)
    found = distances_from_primaries(catalogue.states, times, mass, parts)
    more = {
        LEAST: tuple(map(_known, found.least)),
        GREATEST: tuple(map(_known, found.greatest)),
        LEAST_FROM_LARGER: tuple(map(_known, found.least_from_larger)),
    }
    units = UNITS.get(catalogue.mass_ratio)
    about = dict(catalogue.system_details)
    if units is not None:
        about |= {name: value for name, value in units.details.items() if name not in about}
    if "lunit" in about and "radius_secondary" in about:
        altitudes = found.least * float(about["lunit"]) - float(about["radius_secondary"])
        more[ALTITUDE] = tuple(map(_known, altitudes))
        more[HITS] = tuple("unknown" if np.isnan(value) else "yes" if value < 0 else "no" for value in altitudes)
    proved = {PROVED: (NUMERICAL,) * len(catalogue)}
    name = catalogue.system or ("" if units is None else units.name)
    return replace(catalogue, system=name, system_details=about, more={**catalogue.more, **more, **proved})


def _known(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


def _longest(family: Family) -> float:
    return float(np.max(np.diff(family.arclengths)))


def _predicted(family: Family, places: Vector) -> tuple[Matrix, Matrix]:
    """Guesses at arclengths, between the orbits next to them, and the chords there."""
    scales = family.problem.scales
    points = np.array([orbit.unknowns for orbit in family.orbits]) / scales
    lengths = np.array(family.arclengths)
    where = np.clip(np.searchsorted(lengths, places, side="right") - 1, 0, len(points) - 2)
    guesses, normals = np.empty((len(places), len(scales))), np.empty((len(places), len(scales)))
    for i in np.unique(where):
        rows, near = where == i, (i, i + 1)
        step = points[i + 1] - points[i]
        length = float(np.linalg.norm(step))
        chord = step / length
        part = length * (places[rows, None] - lengths[i]) / (lengths[i + 1] - lengths[i])
        guesses[rows] = predict([points[k] for k in near], [family.tangents[k] for k in near], chord, part) * scales
        normals[rows] = chord
    return guesses, normals
