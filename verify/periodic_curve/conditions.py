"""Exact conditions on the pieces of a curve of periodic orbits, and the hypotheses about the curve (26.1, 26.4)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from orbitproof.shared.formats import PERIODIC_CURVES, PeriodicAtlas, Piece
from orbitproof.verify.claim import determinant, keeps_integral
from orbitproof.verify.curve import Chain, IntervalResult, check_covers, check_increasing, follow, read_tube
from orbitproof.verify.evidence import Checklist, Evidence
from orbitproof.verify.periodic import check_functions_of


def hypotheses_of(atlas: PeriodicAtlas) -> tuple[str, ...]:
    """Names of the hypotheses that the claim takes, in the order of checking."""
    claim = atlas.claim
    return (
        *(("functions",) if atlas.system.defined else ()),
        "section",
        *(("first-integral",) if claim.uses_integral else ()),
        "pieces",
        "curve",
        *(f"increasing-{name}" for name in claim.increasing),
        *(("covers",) if claim.covers is not None else ()),
    )


def require_piece(evidence: Evidence, atlas: PeriodicAtlas, piece: Piece) -> None:
    """Require that a piece has the coordinates of the atlas, a regular frame and a tube."""
    size = len(atlas.coordinates)
    evidence.require(piece.kind == "regular", f"piece {piece.id} is {piece.kind}, and no symmetry is used")
    sizes = (len(piece.polynomial) + 1, len(piece.tube) + 1, len(piece.centre), len(piece.frame))
    if {*sizes, *map(len, piece.frame)} != {size}:
        evidence.require(False, f"piece {piece.id} does not have {size} coordinates, as the section takes")
        return
    evidence.require(determinant(piece.frame) != 0, f"the frame of piece {piece.id} is singular")
    positive = min(piece.half_width, *piece.tube) > 0
    evidence.require(positive, f"half_width and tube of piece {piece.id} have to be positive")
    if atlas.claim.parameter is not None:
        allowed = atlas.system.parameters.get(atlas.claim.parameter)
        evidence.require(
            allowed is not None and all(map(allowed.contains, _parameter_bounds(piece))),
            f"values of {atlas.claim.parameter} on piece {piece.id} are not shown to lie inside {allowed}",
        )


def _parameter_bounds(piece: Piece) -> tuple[Fraction, Fraction]:
    """Numbers between which the first coordinate lies at all points of a piece (section 26.1)."""
    along, *across = piece.frame[0]
    middle, spread = piece.centre[0], abs(along) * piece.half_width
    for factor, row, width in zip(across, piece.polynomial, piece.tube, strict=True):
        constant, *others = row or (Fraction(0),)
        middle += factor * constant
        spread += abs(factor) * (sum(map(abs, others), Fraction(0)) + width)
    return middle - spread, middle + spread


def check_section(checklist: Checklist, atlas: PeriodicAtlas) -> None:
    """The section is one of the system, and every parameter has a value or varies (section 26.1)."""
    claim, system = atlas.claim, atlas.system
    statement = "the section is an affine plane across the state space, and every parameter is given or varies"
    with checklist.hypothesis("section", "26.1", statement, "correct the claim") as evidence:
        evidence.require(claim.kind in PERIODIC_CURVES, f"{claim.kind} is no claim about such a curve")
        fits = len(claim.normal) == len(system.given_state)
        evidence.require(fits and any(claim.normal), "the normal is 0, or no normal")
        evidence.require(claim.direction in (1, -1) and claim.crossings >= 1, "no such crossings")
        varies = {claim.parameter} - {None}
        evidence.require(
            {*atlas.parameters} | varies == {*system.parameters} and not varies & {*atlas.parameters},
            "a parameter has no value, or is none of the system",
        )
        evidence.require(claim.level is None or claim.parameter is not None, "a level is given, and varies")


def check_integral(checklist: Checklist, atlas: PeriodicAtlas) -> None:
    """H is a first integral, by the identity grad H . f = 0 (section 1.4)."""
    statement = "grad H . f = 0 identically, H the first integral that takes the place of an equation (1.4)"
    remedy = "correct the description of the system"
    with checklist.hypothesis("first-integral", "26.1", statement, remedy) as evidence:
        integral = atlas.system.first_integral_program
        evidence.require(integral is not None, "the system has no first integral")
        if integral is not None:
            evidence.require(keeps_integral(atlas.system), "H was not shown to be constant along orbits")


def check_periodic_curve(checklist: Checklist, atlas: PeriodicAtlas, results: Sequence[IntervalResult]) -> Chain:
    """Check every hypothesis of the claim; raises `NotEstablishedError` at the first that is not shown.

    `results`: one for each interval of each piece.
    """
    claim, pieces = atlas.claim, atlas.curve_pieces()
    check_functions_of(checklist, atlas.system)
    check_section(checklist, atlas)
    if claim.uses_integral:
        check_integral(checklist, atlas)
    statement = "the pieces have the coordinates of the section, regular frames and tubes"
    with checklist.hypothesis("pieces", "26.1", statement, "write the atlas again") as evidence:
        evidence.require(len(pieces) == len(atlas.pieces) > int(claim.is_closed), "there are too few pieces of a curve")
        evidence.require(len({piece.id for piece in pieces}) == len(pieces), "two pieces have the same id")
        for piece in pieces:
            require_piece(evidence, atlas, piece)
    by_piece: dict[str, list[IntervalResult]] = {piece.id: [] for piece in pieces}
    for result in results:
        by_piece.setdefault(result.piece, []).append(result)
    tubes = [read_tube(piece, by_piece[piece.id]) for piece in pieces]
    statement = "every piece is proved where the curve uses it and leads into the tube of the next one"
    remedy = "write the atlas again with more overlap, wider tubes, or narrower pieces where they are not proved"
    found: Chain | None = None
    with checklist.hypothesis("curve", "26.4", statement, remedy) as evidence:
        found = follow(evidence, claim, tubes)
    assert found is not None
    for name in claim.increasing:
        check_increasing(checklist, atlas.coordinates, atlas.system, found, name)
    if claim.covers is not None:
        check_covers(checklist, atlas.coordinates, atlas.system, found, claim.covers)
    return found
