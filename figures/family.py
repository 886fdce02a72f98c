"""What a picture needs: traced families, marked points, and which of these points are certified.

A family file is written by ``python -m explore``; candidates and certificates are read with
`shared.formats`. Everything here is in double precision: pictures prove nothing, and the only
statement that a picture makes, filled or hollow, is copied from the certificates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from shared.formats import Candidate, InputError, candidate_from_json, read_document
from shared.systems import ReversibleSystem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Family:
    """A traced family of N symmetric periodic orbits.

    Attributes:
        name: what the family is called, for example ``L1-halo``.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters.
        points: shape (N, 1 + n), a point of each orbit on Fix(R), in the order of
            `ReversibleSystem.centre_coordinates`, nondimensional.
        second_points: shape (N, 1 + n), the point on Fix(R) half a period later.
        periods: shape (N,), full periods, nondimensional time.
        levels: shape (N,), Jacobi constant (first integral) or family parameter.
        stability: shape (N, n), (lambda + 1/lambda)/2 of each nontrivial pair of Floquet
            multipliers; NaN where a pair is complex (off the unit circle and off the real axis).
        arclength: shape (N,), length along the curve of `points`.
    """

    name: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    points: Array
    second_points: Array
    periods: Array
    levels: Array
    stability: Array
    arclength: Array


@dataclass(frozen=True)
class MarkedPoint:
    """A candidate as a picture shows it.

    Attributes:
        candidate: the claim.
        certified: whether its certificate says "proved".
        point: shape (1 + n,), its centre in double precision.
        level: Jacobi constant (first integral) or family parameter at the centre.
    """

    candidate: Candidate
    certified: bool
    point: Array
    level: float

    @property
    def k(self) -> int:
        """Multiplicity: the new orbits have k times the period; 1 for symmetry breaking."""
        return self.candidate.k


@dataclass(frozen=True)
class Placement:
    """Where a marked point sits on a family: on which of the two curves, and at which arclength."""

    mark: MarkedPoint
    second: bool
    arclength: float
    distance: float


def state_on_fixed_set(system: ReversibleSystem, point: Sequence[float]) -> list[float]:
    """The full state, length m, of a point given by the coordinates of Fix(R) (family parameter dropped)."""
    values = list(point)[len(point) - len(system.fixed_coordinates) :]
    state = [0.0] * len(system.state)
    for index, value in zip(system.fixed_coordinates, values, strict=True):
        state[index] = float(value)
    return state


def parameter_values(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[float]
) -> list[float]:
    """All parameters of the vector field in its order, the family parameter taken from `point`."""
    return [
        float(point[0]) if name == system.family_parameter else float(parameters[name]) for name in system.parameters
    ]


def level_of(system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[float]) -> float:
    """Family parameter, or first integral, at a point of Fix(R)."""
    if system.first_integral is None:
        return float(point[0])
    values = parameter_values(system, parameters, point)
    return float(system.first_integral(state_on_fixed_set(system, point), values)[0])


def mark_candidates(
    candidates: Sequence[Candidate], certificates: Path | None, candidates_path: Path
) -> list[MarkedPoint]:
    """The candidates with the verdicts of a certificates file; without a certificate: not certified.

    Raises `InputError` if the certificates cannot be read, repeat an id, name no candidate, or carry
    a statement that differs from the candidate of that id.
    """
    proved: dict[str, bool] = {}
    by_id = {candidate.id: candidate for candidate in candidates}
    entries = [] if certificates is None else read_document(certificates, "certificates")["certificates"]
    for index, entry in enumerate(entries):
        where = f"{certificates}: field certificates[{index}]"
        identifier = entry["id"]
        if identifier in proved:
            raise InputError(f"{where}.id: {identifier!r} appears twice; keep one certificate for each candidate")
        if identifier not in by_id:
            raise InputError(
                f"{where}.id: no candidate {identifier!r} in {candidates_path}; "
                "give the candidates file that was verified"
            )
        if not _same_claim(entry["statement"]["candidate"], by_id[identifier], f"{where}.statement.candidate"):
            raise InputError(
                f"{where}.statement.candidate: differs from {identifier!r} in {candidates_path}; "
                "verify these candidates again"
            )
        proved[identifier] = entry["verdict"] == "proved"
    marks = []
    for candidate in candidates:
        point = np.array([float(value) for value in candidate.centre])
        level = level_of(candidate.system, candidate.parameters, list(point))
        marks.append(MarkedPoint(candidate, proved.get(candidate.id, False), point, level))
    return marks


def _same_claim(entry: Mapping[str, object], candidate: Candidate, where: str) -> bool:
    try:
        stated = candidate_from_json(entry, where)
    except (KeyError, TypeError, ValueError, AttributeError):
        return False
    return replace(stated, provenance={}) == replace(candidate, provenance={})


def place(family: Family, mark: MarkedPoint) -> Placement:
    """The nearest place of `mark` on either curve of `family`, distances per coordinate range."""
    best: Placement | None = None
    for second, curve in ((False, family.points), (True, family.second_points)):
        extent = np.ptp(curve, axis=0)
        scale = np.where(extent > 0, extent, 1.0)
        start, step = curve[:-1] / scale, np.diff(curve, axis=0) / scale
        offset = mark.point / scale - start
        square = np.maximum((step * step).sum(axis=1), np.finfo(float).tiny)
        along = np.clip((offset * step).sum(axis=1) / square, 0.0, 1.0)
        distances = np.linalg.norm(offset - along[:, None] * step, axis=1)
        i = int(np.argmin(distances))
        s = family.arclength[i] + along[i] * (family.arclength[i + 1] - family.arclength[i])
        found = Placement(mark, second, float(s), float(distances[i]))
        if best is None or found.distance < best.distance:
            best = found
    assert best is not None
    return best


def assign(
    families: Sequence[Family], marks: Sequence[MarkedPoint], tolerance: float = 1e-2
) -> tuple[list[list[MarkedPoint]], list[MarkedPoint]]:
    """The marks of each family, and the marks that lie on none.

    A mark belongs to the nearest family of its system and parameters, if one of the two curves of
    that family passes within `tolerance` of it (distances per coordinate range).
    """
    members: list[list[MarkedPoint]] = [[] for _ in families]
    alone: list[MarkedPoint] = []
    for mark in marks:
        candidate = mark.candidate
        distances = [
            place(family, mark).distance
            if family.system.name == candidate.system.name and dict(family.parameters) == dict(candidate.parameters)
            else np.inf
            for family in families
        ]
        nearest = int(np.argmin(distances)) if distances else 0
        if distances and distances[nearest] < tolerance:
            members[nearest].append(mark)
        else:
            alone.append(mark)
    return members, alone


def stability_at(family: Family, arclength: float) -> Array:
    """Stability parameters, shape (n,), interpolated linearly at an arclength."""
    columns = family.stability.T
    return np.array([np.interp(arclength, family.arclength, column) for column in columns])
