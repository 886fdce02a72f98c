"""A certified curve as the pictures draw it: its polynomials evaluated along it, piece by piece, in double precision.

Which pieces are proved, in which coordinates they were followed and which bifurcations lie on the curve is copied from
the certificate; the pictures prove nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path

import numpy as np

from orbitproof.figures.orbits import Array
from orbitproof.shared.formats import AnyAtlas, InputError, Piece
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import System
from orbitproof.verify.branches.kinds import kind_of
from orbitproof.verify.certificate import Certificate, read_certificate
from orbitproof.verify.poincare import PHYSICAL

_SAMPLES = 200


@dataclass(frozen=True)
class Stretch:
    """The part of a piece that the curve runs along, from where it enters it to where it goes over to the next.

    Attributes:
        piece: its id.
        s: shape (M,), increasing.
        points: shape (M, 1 + n), in the order of the curve's coordinates.
        arclength: shape (M,), from the beginning of the curve, in these coordinates.
        half_width: length of the piece's half from its centre along its column 0, in the same unit.
        first_half_width: how far the first coordinate goes on this way.
        intervals: s-intervals that are proved.
        coordinates: in which orbits were followed, `PHYSICAL` or the name of the regularisation; empty if unproved.
        tube: geometric mean of the tube's half-widths.
        deviation: the same of the proved distances from the polynomial, the largest on the piece; 0 if unproved.
    """

    piece: str
    s: Array
    points: Array
    arclength: Array
    half_width: float
    first_half_width: float
    intervals: tuple[tuple[float, float], ...]
    coordinates: str
    tube: float
    deviation: float

    @property
    def is_proved(self) -> bool:
        """Whether the proved intervals cover what the curve runs along."""
        reached = self.s[0]
        for start, end in sorted(self.intervals):
            if start <= reached:
                reached = max(reached, end)
        return bool(reached >= self.s[-1])

    def arclength_at(self, s: float) -> float:
        """Arclength of the point at s."""
        return float(np.interp(s, self.s, self.arclength))


@dataclass(frozen=True)
class CertifiedPoint:
    """A certified bifurcation on the curve: id, kind, multiplicity, its piece and s; whether S brings it there."""

    id: str
    kind: str
    k: int
    piece: str
    s: float
    mirrored: bool


@dataclass(frozen=True)
class Curve:
    """A curve of periodic orbits from its certificate.

    Attributes:
        atlas: id, title, system, parameters, claim.
        is_proved: whether the certificate says so.
        stretches: in order along the curve.
        marks: the certified bifurcations on these, in order along the curve; not that of the piece of a birth.
    """

    atlas: AnyAtlas
    is_proved: bool
    stretches: tuple[Stretch, ...]
    marks: tuple[CertifiedPoint, ...]

    @classmethod
    def read(cls, path: Path) -> Curve:
        """Read the certificate of a curve. Raises `InputError` if it is not one."""
        certificate = read_certificate(path, "atlas-certificate")
        if certificate.atlas.is_surface:
            raise InputError(f"{path}: field statement.atlas.claim.kind: a surface; give certificates of curves")
        return cls.of(certificate)

    @classmethod
    def of(cls, certificate: Certificate) -> Curve:
        """The curve of a certificate that is about a curve."""
        atlas = certificate.atlas
        pieces = atlas.curve_pieces()
        symmetric = atlas.claim.is_of_symmetric_curve
        begin = 0.0 if pieces[0].is_symmetric and symmetric else -1.0
        length = 0.0
        stretches: list[Stretch] = []
        for number, piece in enumerate(pieces):
            following = pieces[number + 1] if number + 1 < len(pieces) else None
            closes = following is None and symmetric and atlas.claim.is_closed and piece.is_symmetric
            s = np.linspace(begin, 0.0 if closes else 1.0, _SAMPLES)
            stretch = _stretch(certificate, piece, s, length)
            stretches.append(stretch)
            length = float(stretch.arclength[-1])
            if following is not None:
                begin = float(_parameter(following, stretch.points[-1]))
        order = {piece.id: number for number, piece in enumerate(pieces)}
        marks = sorted(
            (mark for mark in _marks(certificate) if mark.piece in order), key=lambda mark: (order[mark.piece], mark.s)
        )
        return cls(atlas, certificate.proved, tuple(stretches), tuple(marks))

    @property
    def system(self) -> System:
        """The system of the atlas."""
        return self.atlas.system

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of its points."""
        return kind_of(self.atlas).coordinates(self.atlas)

    @property
    def has_parameter(self) -> bool:
        """Whether the first of them is a parameter."""
        return self.coordinates[0] in self.system.parameters

    @property
    def parameters(self) -> Mapping[str, Fraction]:
        """The parameters of the atlas."""
        return self.atlas.parameters

    @cached_property
    def signs(self) -> Array | None:
        """The claim's symmetry on the centre coordinates, or `None`."""
        atlas, names = self.atlas, self.coordinates
        if atlas.claim.symmetry is None:
            return None
        signs, state = atlas.system.symmetries[atlas.claim.symmetry], atlas.system.state
        return np.array([signs[state.index(name)] if name in state else 1 for name in names], dtype=float)

    def place_of(self, mark: CertifiedPoint) -> tuple[float, Array]:
        """Arclength and coordinates of a bifurcation; those of one that S brings there are its own."""
        stretch = next(stretch for stretch in self.stretches if stretch.piece == mark.piece)
        piece = next(piece for piece in self.atlas.curve_pieces() if piece.id == mark.piece)
        point = _points(piece, np.array([mark.s]))[0]
        if mark.mirrored and self.signs is not None:
            point = point * self.signs
        return stretch.arclength_at(mark.s), point


def _stretch(certificate: Certificate, piece: Piece, s: Array, length: float) -> Stretch:
    points = _points(piece, s)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    results = [entry for entry in certificate.results if entry.piece == piece.id and entry.is_proved]
    intervals = [(float(start), float(end)) for start, end in (entry.interval for entry in results)]
    if piece.is_symmetric:
        intervals += [(-b, -a) for a, b in intervals]
    names = [entry.computation.coordinates or PHYSICAL for entry in results]
    deviations = np.array([[float(value) for value in entry.deviation] for entry in results])
    return Stretch(
        piece=piece.id,
        s=s,
        points=points,
        arclength=length + np.concatenate([[0.0], np.cumsum(steps)]),
        half_width=float(piece.half_width) * float(np.linalg.norm([float(row[0]) for row in piece.frame])),
        first_half_width=float(piece.half_width * abs(piece.frame[0][0])),
        intervals=tuple(sorted(set(intervals))),
        coordinates=next((name for name in names if name != PHYSICAL), names[0] if names else ""),
        tube=_mean(np.array([float(width) for width in piece.tube])),
        deviation=_mean(deviations.max(axis=0)) if results else 0.0,
    )


def _mean(values: Array) -> float:
    return float(np.exp(np.log(values).mean())) if (values > 0).all() else 0.0


def _points(piece: Piece, s: Array) -> Array:
    """The polynomial's points, shape (M, 1 + n)."""
    local = [float(piece.half_width) * s]
    local += [np.polynomial.polynomial.polyval(s, [float(value) for value in row]) for row in piece.polynomial]
    return _vector(piece.centre) + np.stack(local, axis=1) @ _matrix(piece).T


def _parameter(piece: Piece, point: Array) -> float:
    """The s of a point in the coordinates of a piece."""
    return float(np.linalg.solve(_matrix(piece), point - _vector(piece.centre))[0]) / float(piece.half_width)


def _vector(values: Sequence[Fraction]) -> Array:
    return np.array([float(value) for value in values])


def _matrix(piece: Piece) -> Array:
    return np.array([[float(value) for value in row] for row in piece.frame])


def _marks(certificate: Certificate) -> list[CertifiedPoint]:
    conclusion = certificate.document["conclusion"] or {}
    return [
        CertifiedPoint(
            entry["id"],
            entry["kind"],
            entry["k"],
            entry["piece"],
            float(parse_exact(entry["s"]["mid"])),
            entry["mirrored"],
        )
        for entry in conclusion.get("bifurcations", [])
        if entry["on_curve"]
    ]
