"""Exact conditions on a piece, for its proof and for the theorem about the curve (sections 15.2 and 16.12)."""

from __future__ import annotations

from orbitproof.shared.formats import Atlas, BirthPiece, Piece, is_regular
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.claim import determinant, is_adapted, quadratic_coefficient, signs_on
from orbitproof.verify.evidence import Evidence

ACROSS = ("x", "z", "vy", "b")
"""What the columns of a piece of a birth are: coordinates that R fixes, and the direction off Fix(R)."""

_TWICE = 2
"""How often half orbits that are born at a period doubling meet the section."""


def require_piece(evidence: Evidence, system: ReversibleSystem, piece: Piece, symmetry: str | None) -> None:
    """Require that a piece belongs to the system, has a regular frame and a tube, and if symmetric the symmetry."""
    size, across = len(system.centre_coordinates), len(system.kernel_coordinates)
    if system.fixed_level is not None:
        _require_level(evidence, system, piece, symmetry)
    evidence.require(piece.kind in ("regular", "symmetric"), f"piece {piece.id} has the unknown kind {piece.kind}")
    sizes = (len(piece.polynomial), len(piece.tube), len(piece.centre), len(piece.frame), *map(len, piece.frame))
    if sizes != (across, across, *[size] * (size + 2)):
        evidence.require(False, f"piece {piece.id} does not have {size} coordinates, as {system.name} takes")
        return
    evidence.require(determinant(piece.frame) != 0, f"the frame of piece {piece.id} is singular")
    evidence.require(
        min(piece.half_width, *piece.tube) > 0, f"half_width and tube of piece {piece.id} have to be positive"
    )
    if not piece.is_symmetric:
        return
    if symmetry is None or symmetry not in system.symmetries:
        evidence.require(False, f"piece {piece.id} is symmetric, and {symmetry} is no symmetry of {system.name}")
        return
    signs = signs_on(system, symmetry, system.centre_coordinates)
    centred = all(value == 0 for value, sign in zip(piece.centre, signs, strict=True) if sign < 0)
    evidence.require(
        centred and is_adapted(piece.frame, signs, 0),
        f"piece {piece.id} is not symmetric: {symmetry} does not fix its centre and negate column 0 only",
    )
    evidence.require(
        not any(value for coefficients in piece.polynomial for value in coefficients[1::2]),
        f"it is not symmetric: a polynomial of piece {piece.id} has an odd coefficient",
    )
    odd = [index for index in system.kernel_coordinates if system.symmetries[symmetry][index] < 0]
    evidence.require(bool(odd), f"piece {piece.id} is not symmetric: {symmetry} negates no equation")


def is_of_axial_orbits(system: ReversibleSystem) -> bool:
    """Whether points of a system stand for axial orbits in units of their speed across the plane (section 16.9)."""
    if not system.normalised:
        return False
    from orbitproof.shared.systems import LIFTED

    return system is LIFTED


def is_of_doublings(system: ReversibleSystem) -> bool:
    """Whether points of a system stand for period doublings, over the mass (section 15.10)."""
    if not system.normalised:
        return False
    from orbitproof.shared.systems import HILL_VARIED

    return system is HILL_VARIED


def takes_birth(atlas: Atlas) -> bool:
    """Whether a curve can end in a piece of a birth: one of axial orbits, or of half orbits of two crossings."""
    if atlas.claim.is_arc and atlas.claim.crossings == _TWICE:
        from orbitproof.shared.systems import CR3BP

        if atlas.system is CR3BP:
            return True
    return atlas.claim.is_arc and is_of_axial_orbits(atlas.system)


def require_birth_piece(evidence: Evidence, piece: BirthPiece) -> None:
    """Require that a piece of a birth has regular directions, a tube, and polynomials that are even."""
    sizes = (len(piece.polynomial), len(piece.tube), len(piece.directions), *map(len, piece.directions))
    if sizes != (len(ACROSS), len(ACROSS), 2, 2, 2):
        evidence.require(False, f"piece {piece.id} does not have {len(ACROSS)} coordinates and two directions")
        return
    evidence.require(is_regular(piece.directions), f"the directions of piece {piece.id} are singular")
    widths = (piece.half_width, *piece.tube)
    evidence.require(min(widths) > 0, f"half_width and tube of piece {piece.id} have to be positive")
    odd = any(value for coefficients in piece.polynomial for value in coefficients[1::2])
    evidence.require(not odd, f"a polynomial of piece {piece.id} has an odd coefficient")


def _require_level(evidence: Evidence, system: ReversibleSystem, piece: Piece, symmetry: str | None) -> None:
    """Require what gives the points of a fixed level from the others (section 12.5), and that S keeps to its sheet."""
    name, level = str(system.level_coordinate), system.fixed_level
    if level is not None and level.between is not None:
        from orbitproof.verify.claim import LevelEquation

        try:
            LevelEquation.of(system)
        except ValueError as error:
            evidence.require(False, str(error))
    else:
        evidence.require(
            bool(quadratic_coefficient(system)),
            f"the first integral is not shown to be A + b {name}^2, A independent of {name}, b a constant other than 0",
        )
    if piece.is_symmetric and symmetry is not None and symmetry in system.symmetries:
        fixed = system.symmetries[symmetry][system.state.index(name)] == 1
        evidence.require(fixed, f"{symmetry} does not fix {name}, the coordinate that follows from the level")
