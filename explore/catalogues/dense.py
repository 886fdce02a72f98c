"""A dense catalogue of a traced family: orbits at equal steps along it, all corrected at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from orbitproof.explore.catalogues.columns import (
    ALTITUDE,
    GREATEST,
    HITS,
    LEAST,
    LEAST_FROM_LARGER,
    NUMERICAL,
    PROVED,
)
from orbitproof.explore.catalogues.distances import PARTS, distances
from orbitproof.explore.catalogues.file import Catalogue
from orbitproof.explore.catalogues.orbits import catalogue_of
from orbitproof.explore.engines import Progress
from orbitproof.explore.families import Family, TracedFamily
from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.numerics import predict
from orbitproof.explore.orbits import correct_batch, stability_index
from orbitproof.shared.systems import UNITS


def dense_catalogue(item: TracedFamily, rows: int, progress: Progress | None = None) -> tuple[Catalogue, int]:
    """So many orbits of a family at equal arclengths, with their distances; and how many were not found."""
    family = item.family
    if len(family.orbits) < 2:
        return with_distances(catalogue_of(family, item.name, item.label), family.orbits[0].crossings), 0
    problem = family.problem
    places = np.linspace(0.0, family.orbits[-1].arclength, rows)
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
    step = places[1] - places[0]
    moved = np.linalg.norm((batch.unknowns - guesses) / problem.scales, axis=1)
    good = np.flatnonzero(batch.converged & (moved <= max(step, _longest(family))))
    stability = batch.stability
    assert batch.first_integrals is not None
    catalogue = replace(
        catalogue_of(family, item.name, item.label),
        states=np.array([problem.initial_state(batch.unknowns[i]) for i in good]),
        jacobi_constants=batch.first_integrals[good],
        periods=2 * batch.unknowns[good, -1],
        stability_indices=np.array([stability_index(stability[i]) for i in good]),
    )
    return with_distances(catalogue, int(max(batch.crossings[good], default=1))), rows - len(good)


def with_distances(catalogue: Catalogue, crossings: int = 1, *, symmetric: bool = True) -> Catalogue:
    """The catalogue with columns of distances, of whether orbits hit the smaller primary, and of what is proved."""
    mass = float(catalogue.mass_ratio)
    times = catalogue.periods / 2 if symmetric else catalogue.periods
    parts = PARTS * min(crossings, 8)
    found = distances(catalogue.states, times, mass, parts)
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
    return replace(catalogue, system=name, system_details=about, more={**more, **proved})


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
    for row, (place, i) in enumerate(zip(places, where, strict=True)):
        step = points[i + 1] - points[i]
        length = float(np.linalg.norm(step))
        chord = step / length
        part = length * (place - lengths[i]) / (lengths[i + 1] - lengths[i])
        near = (i, i + 1)
        guesses[row] = predict([points[k] for k in near], [family.tangents[k] for k in near], chord, part) * scales
        normals[row] = chord
    return guesses, normals
