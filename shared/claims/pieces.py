"""Pieces of atlases: tubes about polynomials, and symmetry-breaking boxes that move with the parameters.

A piece of a curve describes the points

    centre + frame * (half_width * s, polynomial_1(s) + tube_1 w_1, .., polynomial_n(s) + tube_n w_n)

for s in [-1, 1] and abs(w_j) <= 1. Its claim: for every s there is exactly one w for which the point lies on a
symmetric periodic orbit, and it depends smoothly on s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeVar, get_args

from orbitproof.shared.claims.fields import (
    Identifier,
    Matrix,
    Numbers,
    Pair,
    PieceId,
    Polynomial,
    Polynomials,
    Rows,
    Vector,
)
from orbitproof.shared.stored import stored

Coordinates = Literal["auto", "physical", "regularised"]
COORDINATES: tuple[Coordinates, ...] = get_args(Coordinates)


@dataclass(frozen=True)
class Piece:
    """A piece of a curve: a tube about a polynomial, in which the symmetric orbits are claimed to be one curve.

    Attributes:
        id: unique name within the atlas.
        kind: "regular"; or "symmetric": the curve meets the points that the claim's symmetry fixes at s = 0, where
            it is a bifurcation of the orbits in them.
        centre: shape (1 + n,), in the order of the system's `centre_coordinates`.
        frame: shape (1 + n, 1 + n), rows, regular; column 0 along the curve, columns 1 to n across.
        half_width: p_0 = half_width * s, positive.
        polynomial: for p_1, .., p_n the coefficients of 1, s, s^2, ..
        tube: shape (n,), half-widths of the tube in p_1, .., p_n, positive.
        coordinates: one of `COORDINATES`, in which the orbits are followed.
    """

    id: PieceId
    kind: Literal["regular", "symmetric"]
    centre: Numbers
    frame: Rows
    half_width: Fraction
    polynomial: Polynomials
    tube: Numbers
    coordinates: Coordinates = stored(always=True, default="auto")
    is_of_curve = can_be_halved = True

    @property
    def is_symmetric(self) -> bool:
        """Whether the curve is claimed to meet the points that the claim's symmetry fixes, at s = 0."""
        return self.kind == "symmetric"

    def local(self, s: Fraction) -> Vector:
        """The coordinates p_0, .., p_n of the polynomial's point at s, exactly."""
        return (self.half_width * s, *(evaluate(coefficients, s) for coefficients in self.polynomial))

    def point(self, s: Fraction) -> Vector:
        """The polynomial's point at s, w = 0, in the system's coordinates, exactly; shape (1 + n,)."""
        p = self.local(s)
        return tuple(
            middle + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
            for middle, row in zip(self.centre, self.frame, strict=True)
        )


@dataclass(frozen=True)
class SurfacePiece:
    """A symmetry-breaking candidate (docs/formats.md) whose parameters and centre are polynomials in s in [-1, 1].

    Its box consists of the points with abs(p_i) <= radii_i in the coordinates p of

        centre(s) + frame * (p_0 + bend_0(s) p_1^2, p_1, p_2 + tilt_2(s) p_0 + bend_2(s) p_1^2).

    Attributes:
        id: unique name within the atlas.
        parameters: for each of the system's fixed parameters the coefficients of 1, s, s^2, ..
        centre: for each of the 1 + n coordinates the coefficients of 1, s, s^2, ..
        frame, kernel_frame, radii: as in `shared.formats.candidates.Candidate`, the same for all s.
        tilt: for p_2, .., p_n the coefficients of 1, s, s^2, .. of what p_0 adds to them; empty: nothing.
        bend: the same for p_0 and p_2, .., p_n and what p_1^2 adds to them; empty: nothing.
    """

    id: PieceId
    parameters: Mapping[Identifier, Polynomial]
    centre: Polynomials
    frame: Rows
    kernel_frame: Rows
    radii: Numbers
    tilt: Polynomials = ()
    bend: Polynomials = ()

    kind = "symmetry_breaking"
    is_symmetric, is_of_curve, can_be_halved = False, False, True


@dataclass(frozen=True)
class LibrationPiece:
    """Planar orbits about L1 or L2 over a rectangle of (b, eps), in the system `shared.systems.OVER_MASSES[point]`.

    For abs(beta) <= 1, s in [-1, 1] and abs(w) <= 1 the points of the piece are

        b = distance_0 + distance_1 beta,   eps = size_0 + size_1 s,   vy = sum_k polynomial_k(s) beta^k + tube w.

    Its claim: for all beta and s there is exactly one w for which the point lies on a symmetric periodic orbit.

    Attributes:
        id: unique name within the atlas.
        point: "L1" or "L2".
        distance: of the libration point from the smaller mass, signed: middle and half-width, the latter positive.
        size: of the orbits, in units of the distance: middle and half-width, the latter positive.
        polynomial: for beta^0, beta^1, .. the coefficients of 1, s, s^2, ..
        tube: half-width in vy, positive.
    """

    id: PieceId
    point: Literal["L1", "L2"]
    distance: Pair
    size: Pair
    polynomial: Polynomials
    tube: Fraction

    kind = "libration"
    is_symmetric, is_of_curve, can_be_halved = False, False, True


@dataclass(frozen=True)
class BirthPiece:
    """Orbits near one from which they are born: axial ones near a vertical orbit, or others near a period doubling.

    For s in [-1, 1] and abs(w_j) <= 1 its points lie in the plane y = 0 and have

        (x, z, vy, b) = (polynomial_j(s) + tube_j w_j),    (vx, vz) = half_width s directions (1, b).

    Its claim: for every s there is exactly one w for which the orbits of the points of s and of -s, when they are in
    that plane next, meet the axis at a right angle (section 16.12), or the plane itself near a doubling (16.14).

    Attributes:
        id: unique name within the atlas.
        directions: shape (2, 2), rows for vx and vz, regular.
        half_width: positive.
        polynomial: for x, z, vy and b the coefficients of 1, s, s^2, ..; those of odd powers are 0.
        tube: half-widths in x, z, vy and b, positive.
    """

    id: PieceId
    directions: Rows
    half_width: Fraction
    polynomial: Polynomials
    tube: Numbers

    kind = "birth"
    is_symmetric = is_of_curve = can_be_halved = False


AnyPiece = Piece | SurfacePiece | LibrationPiece | BirthPiece
OneKind = TypeVar("OneKind", bound=AnyPiece)


def pieces_of(kind: type[OneKind], pieces: Sequence[AnyPiece]) -> tuple[OneKind, ...]:
    """The pieces of one kind, in their order."""
    return tuple(piece for piece in pieces if isinstance(piece, kind))


def evaluate(coefficients: Sequence[Fraction], s: Fraction) -> Fraction:
    """The value at s of the polynomial with these coefficients of 1, s, s^2, .., exactly."""
    value = Fraction(0)
    for coefficient in reversed(coefficients):
        value = value * s + coefficient
    return value


def is_regular(matrix: Matrix) -> bool:
    """Whether an exact square matrix is invertible."""
    rows = [list(row) for row in matrix]
    while rows:
        pivot = next((row for row in rows if row[0] != 0), None)
        if pivot is None:
            return False
        rows.remove(pivot)
        rows = [[b - row[0] / pivot[0] * a for a, b in zip(pivot[1:], row[1:], strict=True)] for row in rows]
    return True
