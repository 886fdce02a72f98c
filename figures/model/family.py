"""What a picture needs: traced families, marked points, and which of these points are certified.

A family file is written by ``orbitproof explore``; candidates and certificates are read with
`shared.formats.candidates`. Everything here is in double precision: pictures prove nothing, and the only
statement that a picture makes, filled or hollow, is copied from the certificates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.three_body.names import Branch, on_branch
from orbitproof.figures.orbits import Array, centre_on_fixed_set, parameter_values, parameters_of, state_on_fixed_set
from orbitproof.shared.formats import Candidate, InputError, candidate_from_json, read_document
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import ReversibleSystem


@dataclass(frozen=True)
class SampledFamily:
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
        coefficients: shape (N, n + 1), polynomial whose roots are the stability parameters
            (lambda + 1/lambda)/2 of the nontrivial pairs of Floquet multipliers, highest power first.
        arclength: shape (N,), along the family, increasing.
        branch: "north" or "south", of two families that are mirror images.
    """

    name: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    points: Array
    second_points: Array
    periods: Array
    levels: Array
    coefficients: Array
    arclength: Array
    branch: Branch | None = None

    @property
    def title(self) -> str:
        """The name, with the side on which the orbits are."""
        return on_branch(self.name, self.branch)

    @cached_property
    def stability(self) -> Array:
        """Stability parameters, shape (N, n), ascending.

        NaN where a pair is complex, that is, where multipliers have left both the unit circle and
        the real axis: there is no resonance there.
        """
        roots = np.array([np.roots(row) for row in self.coefficients])
        return np.sort(np.where(roots.imag == 0, roots.real, np.nan), axis=1)

    @cached_property
    def complex_stability(self) -> Array:
        """Real parts of the complex stability parameters, shape (N, n), NaN where they are real.

        Where they become complex the row of the last real ones stands too, so that a curve of them starts there.
        """
        roots = np.array([np.sort_complex(np.roots(row)) for row in self.coefficients])
        pairs = roots.imag != 0
        beside = pairs.copy()
        beside[1:] |= pairs[:-1]
        beside[:-1] |= pairs[1:]
        # A pair has one real part: next to a pair its two parameters are taken together as well.
        middle = roots.real.copy()
        for row, (own, near) in enumerate(zip(pairs, beside, strict=True)):
            if near.any() and not own.any() and near.sum() > 1:
                middle[row, near] = roots.real[row, near].mean()
        return np.where(beside, middle, np.nan)

    def refined(self, parts: int = 12) -> SampledFamily:
        """This family with each interval of arclength cut into `parts`, by cubic interpolation.

        Finer where two stability parameters meet and become complex: there they change like a square root.
        """
        nodes = self.arclength
        fractions = np.arange(parts) / parts
        dense = np.append((nodes[:-1, None] + np.diff(nodes)[:, None] * fractions).ravel(), nodes[-1])
        # The coefficients, unlike the stability parameters, are smooth also where two parameters meet.
        signs = np.sign(_discriminants(interpolate(nodes, self.coefficients, dense)))
        near = [self._around_meeting(dense[i], dense[i + 1]) for i in np.flatnonzero(signs[:-1] * signs[1:] < 0)]
        dense = np.unique(np.concatenate([dense, *near]))
        names = ("points", "second_points", "periods", "levels", "coefficients")
        return replace(
            self, arclength=dense, **{name: interpolate(nodes, getattr(self, name), dense) for name in names}
        )

    def place(self, mark: MarkedPoint) -> Placement:
        """The nearest place of `mark` on either curve of the family, distances per coordinate range."""
        best: Placement | None = None
        for second, curve in ((False, self.points), (True, self.second_points)):
            extent = np.ptp(curve, axis=0)
            scale = np.where(extent > 0, extent, 1.0)
            start, step = curve[:-1] / scale, np.diff(curve, axis=0) / scale
            offset = mark.point / scale - start
            square = np.maximum((step * step).sum(axis=1), np.finfo(float).tiny)
            along = np.clip((offset * step).sum(axis=1) / square, 0.0, 1.0)
            distances = np.linalg.norm(offset - along[:, None] * step, axis=1)
            i = int(np.argmin(distances))
            s = self.arclength[i] + along[i] * (self.arclength[i + 1] - self.arclength[i])
            found = Placement(mark, second, float(s), float(distances[i]))
            if best is None or found.distance < best.distance:
                best = found
        assert best is not None
        return best

    def stability_at(self, arclength: float) -> Array:
        """Stability parameters, shape (n,), interpolated linearly at an arclength."""
        columns = self.stability.T
        return np.array([np.interp(arclength, self.arclength, column) for column in columns])

    def _around_meeting(self, low: float, high: float) -> Array:
        """Places between two arclengths, ever closer to the one between them where two stability parameters meet."""

        def sign(place: float) -> float:
            return float(_discriminants(interpolate(self.arclength, self.coefficients, np.array([place])))[0])

        left, right, start = low, high, sign(low)
        for _ in range(40):
            middle = 0.5 * (left + right)
            left, right = (middle, right) if sign(middle) * start > 0 else (left, middle)
        steps = 4.0 ** -np.arange(1, 12)
        return np.concatenate([left - (left - low) * steps, right + (high - right) * steps])


def _discriminants(coefficients: Array) -> Array:
    """Discriminants of N polynomials, shape (N, n + 1): positive for quadratics with real roots; 1 for linear ones."""
    roots = np.array([np.roots(row) for row in coefficients])
    result = np.ones(len(roots), dtype=complex)
    for i in range(roots.shape[1]):
        for j in range(i):
            result *= (roots[:, i] - roots[:, j]) ** 2
    return result.real


@dataclass(frozen=True)
class MarkedPoint:
    """A candidate as a picture shows it.

    Attributes:
        candidate: the claim.
        certified: whether its certificate says "proved".
        point: shape (1 + n,), its centre in double precision, without a parameter that varies.
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


def interpolate(nodes: Array, values: Array, positions: Array) -> Array:
    """Piecewise cubic Hermite interpolation with slopes from three neighbours; `values` has N rows."""
    slopes = np.gradient(values, nodes, axis=0, edge_order=2 if len(nodes) > 2 else 1)
    i = np.clip(np.searchsorted(nodes, positions, side="right") - 1, 0, len(nodes) - 2)
    width = nodes[i + 1] - nodes[i]
    shape = (-1,) + (1,) * (values.ndim - 1)
    u, width = ((positions - nodes[i]) / width).reshape(shape), width.reshape(shape)
    return np.asarray(
        values[i] * (1 + 2 * u) * (1 - u) ** 2
        + values[i + 1] * u * u * (3 - 2 * u)
        + width * (slopes[i] * u * (1 - u) ** 2 - slopes[i + 1] * u * u * (1 - u))
    )


def level_of(system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[float]) -> float:
    """Family parameter, or first integral, at a point of Fix(R)."""
    if system.first_integral is None or system.family_parameter is not None:
        return float(point[0])
    values = parameter_values(system, parameters, point)
    return float(system.first_integral(state_on_fixed_set(system, parameters, point), values)[0])


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
        if not _same_claim(entry, by_id[identifier], f"{where}.statement.candidate"):
            raise InputError(
                f"{where}.statement.candidate: differs from {identifier!r} in {candidates_path}; "
                "verify these candidates again"
            )
        proved[identifier] = entry["verdict"] == "proved"
    marks = []
    for candidate in candidates:
        point = np.array([float(ball.mid()) for ball in centre_on_fixed_set(candidate)])
        level = level_of(candidate.system, parameters_of(candidate), list(point))
        marks.append(MarkedPoint(candidate, proved.get(candidate.id, False), point, level))
    return marks


def _same_claim(entry: Mapping[str, Any], candidate: Candidate, where: str) -> bool:
    """Whether a certificate is about this candidate, on its box or on one that was tried in its place."""
    try:
        stated = candidate_from_json(entry["statement"]["candidate"], where)
        given = entry["computation"].get("given_radii")
        stated = stated if given is None else replace(stated, radii=tuple(parse_exact(text) for text in given))
    except (KeyError, TypeError, ValueError, AttributeError):
        return False
    return replace(stated, provenance={}) == replace(candidate, provenance={})


def assign(
    families: Sequence[SampledFamily], marks: Sequence[MarkedPoint], tolerance: float = 1e-2
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
            family.place(mark).distance
            if family.system.name == candidate.system.name and dict(family.parameters) == parameters_of(candidate)
            else np.inf
            for family in families
        ]
        nearest = int(np.argmin(distances)) if distances else 0
        if distances and distances[nearest] < tolerance:
            members[nearest].append(mark)
        else:
            alone.append(mark)
    return members, alone
