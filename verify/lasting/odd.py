"""Curves whose orbits a symmetry of the system fixes, so that their return maps are odd (section 29.7)."""

from __future__ import annotations

from fractions import Fraction

from orbitproof.shared.formats import Piece
from orbitproof.shared.systems import ReversibleSystem, has_parities, parities
from orbitproof.verify.claim import signs_on


def odd_coordinate(system: ReversibleSystem, piece: Piece) -> str | None:
    """The coordinate of Fix(R) that is 0 on the curve of a piece and that, with q, a symmetry negates, if there is one.

    The system is one with n = 1.
    """
    names = system.centre_coordinates
    if piece.is_symmetric or len(piece.frame) != len(names) or system.defined:
        return None
    for symmetry in system.symmetries:
        signs = signs_on(system, symmetry, names)
        if signs.count(-1) == 1 and _is_shown(system, symmetry) and _is_fixed(piece, signs.index(-1)):
            return names[signs.index(-1)]
    return None


def _is_shown(system: ReversibleSystem, symmetry: str) -> bool:
    """Whether the symmetry is one of the system, by the parities of its programs (1.3), and negates q."""
    signs, integral = system.symmetries[symmetry], system.first_integral_program
    return (
        signs[system.kernel_coordinates[0]] == -1
        and has_parities(system.program, signs, signs)
        and (integral is None or parities(integral, signs) == [1])
    )


def _is_fixed(piece: Piece, index: int) -> bool:
    """Whether over each s the tube of a piece contains the point at which the coordinate is 0 (Lemma 29.10)."""
    along, *across = piece.frame[index]
    (polynomial,), (radius,) = piece.polynomial, piece.tube
    return piece.centre[index] == along == 0 and all(across) and sum(map(abs, polynomial), Fraction(0)) < radius
