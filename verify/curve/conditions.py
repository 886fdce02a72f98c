"""The hypotheses of theorems about curves (sections 15.3 to 15.7)."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from orbitproof.shared.formats import Atlas, Covers
from orbitproof.shared.systems import System
from orbitproof.verify.claim import check_symmetries, names_in_words, signs_on
from orbitproof.verify.curve.gluing import Chain, follow
from orbitproof.verify.curve.piece_claim import (
    is_of_axial_orbits,
    is_of_doublings,
    require_birth_piece,
    require_piece,
    takes_birth,
)
from orbitproof.verify.curve.piece_result import IntervalResult
from orbitproof.verify.curve.tube import lower_end, read_tube, upper_end
from orbitproof.verify.evidence import Checklist, Evidence, all_finite, exact_text, excludes_zero

KINDS = ("arc", "symmetric-arc", "symmetric-loop", "loop")
_REMEDY = "write the atlas again with more overlap, wider tubes, or narrower pieces where they are not proved"


def hypotheses_of(atlas: Atlas) -> tuple[str, ...]:
    """Names of the hypotheses that the claim takes, in the order of checking."""
    claim = atlas.claim
    return (
        "symmetries",
        "pieces",
        "curve",
        *(("plane",) if claim.is_of_symmetric_curve else ()),
        *(("two-points",) if claim.is_of_symmetric_curve and claim.is_closed else ()),
        *(f"increasing-{name}" for name in claim.increasing),
        *(("covers",) if claim.covers is not None else ()),
        *(("vertical",) if _is_of_vertical_orbits(atlas) else ()),
        *(("from-plane",) if is_of_axial_orbits(atlas.system) else ()),
        *(("doubled",) if is_of_doublings(atlas.system) else ()),
        *(("birth",) if atlas.birth_pieces() else ()),
    )


def check_curve(checklist: Checklist, atlas: Atlas, results: Sequence[IntervalResult]) -> Chain:
    """Check every hypothesis of the claim; raises `NotEstablishedError` at the first that is not shown.

    `results`: one for each interval of each piece, see `verify.curve.proved_intervals.read_results`.
    """
    claim = atlas.claim
    check_symmetries(checklist, atlas.system, claim.symmetry)
    statement = "the pieces are of the kinds that the claim takes, regular, and adapted to its symmetry"
    with checklist.hypothesis("pieces", "15.3", statement, "write the atlas again") as evidence:
        _check_pieces(evidence, atlas)
    by_piece: dict[str, list[IntervalResult]] = {piece.id: [] for piece in atlas.curve_pieces()}
    for result in results:
        by_piece.setdefault(result.piece, []).append(result)
    tubes = [read_tube(piece, by_piece[piece.id]) for piece in atlas.curve_pieces()]
    found: Chain | None = None
    statement = "every piece is proved where the curve uses it and leads into the tube of the next one"
    with checklist.hypothesis("curve", "15.5", statement, _REMEDY) as evidence:
        found = follow(evidence, claim, tubes)
    assert found is not None
    if claim.is_of_symmetric_curve:
        _check_plane(checklist, atlas, found)
    if claim.is_of_symmetric_curve and claim.is_closed:
        check_two_points(checklist, atlas.system.centre_coordinates, *found.ends)
    names, system = atlas.system.centre_coordinates, atlas.system
    for name in claim.increasing:
        check_increasing(checklist, names, system, found, name)
    if claim.covers is not None:
        check_covers(checklist, names, system, found, claim.covers)
    if _is_of_vertical_orbits(atlas):
        from orbitproof.verify.curve.vertical_family import check_vertical

        check_vertical(checklist, atlas, found)
    if is_of_axial_orbits(atlas.system):
        from orbitproof.verify.curve.lifted_family import check_from_plane

        check_from_plane(checklist, atlas)
    if is_of_doublings(atlas.system):
        from orbitproof.verify.curve.doubled_family import check_doubled

        check_doubled(checklist, atlas, found)
    return found


def _is_of_vertical_orbits(atlas: Atlas) -> bool:
    """Whether the curve is one of vertical orbits around a libration point (16.7)."""
    if not atlas.system.derived_parameters:
        return False
    from orbitproof.verify.curve.vertical_family import vertical_point

    return vertical_point(atlas.system) is not None


def _check_pieces(evidence: Evidence, atlas: Atlas) -> None:
    claim, pieces = atlas.claim, atlas.pieces
    evidence.require(claim.kind in KINDS, f"{claim.kind} is not a claim about a curve")
    evidence.require(
        not claim.is_of_symmetric_curve or claim.symmetry in atlas.system.symmetries,
        f"a {claim.kind} needs a symmetry of the system",
    )
    evidence.require(len(pieces) > (1 if claim.is_closed else 0), "there are too few pieces")
    if not evidence.holds:
        return
    at_ends = {"symmetric-arc": (0,), "symmetric-loop": (0, len(pieces) - 1)}.get(claim.kind, ())
    evidence.require(len({piece.id for piece in pieces}) == len(pieces), "two pieces have the same id")
    births = atlas.birth_pieces()
    at_end = len(births) <= 1 and len(atlas.curve_pieces()) == len(pieces) - len(births) > 0
    last = at_end and (not births or (pieces[-1] is births[0] and takes_birth(atlas)))
    evidence.require(last, "pieces of another kind are among them, or a piece of a birth is not the last one")
    for birth in births:
        require_birth_piece(evidence, birth)
    for number, piece in enumerate(atlas.curve_pieces()):
        wanted = "symmetric" if number in at_ends else "regular"
        why = f"piece {piece.id} is {piece.kind}, in a {claim.kind} it has to be {wanted}"
        evidence.require(piece.is_symmetric == (number in at_ends), why)
        require_piece(evidence, atlas.system, piece, claim.symmetry)


def _negated(atlas: Atlas) -> int:
    """Index of the coordinate that the symmetry negates: exactly one, since it negates one column of a frame."""
    return signs_on(atlas.system, str(atlas.claim.symmetry), atlas.system.centre_coordinates).index(-1)


def _check_plane(checklist: Checklist, atlas: Atlas, chain: Chain) -> None:
    index, symmetry = _negated(atlas), atlas.claim.symmetry
    name = atlas.system.centre_coordinates[index]
    said = names_in_words(atlas.system).get(name, name)
    with checklist.hypothesis(
        "plane", "15.6", f"{said} has one sign on the curve except at s = 0 of symmetric pieces", _REMEDY
    ) as evidence:
        side = 1 if chain.stretches[0].tube.piece.frame[index][0] > 0 else -1
        for stretch in chain.stretches:
            tube = stretch.tube
            if tube.is_symmetric:
                # There the coordinate is frame[index][0] half_width s exactly, and s has the sign of the stretch.
                sign = (1 if tube.piece.frame[index][0] > 0 else -1) * (1 if stretch.leaves > 0 else -1)
                holds = sign == side
            else:
                holds = tube.coordinate_is_beyond_zero(index, side, stretch.run, stretch.enters, stretch.leaves)
            evidence.require(
                holds,
                f"{name} is not shown to keep its sign on piece {tube.piece.id}, so the curve may meet Fix({symmetry})",
            )


def check_two_points(checklist: Checklist, names: Sequence[str], first: Sequence[arb], last: Sequence[arb]) -> None:
    """The symmetric points at which a symmetric loop begins and ends are different."""
    with checklist.hypothesis(
        "two-points", "15.6", "the two symmetric points are different", "write the atlas again"
    ) as evidence:
        distances = [a - b for a, b in zip(first, last, strict=True)]
        for name, distance in zip(names, distances, strict=True):
            evidence.record(f"difference in {name}", distance)
        evidence.require(any(excludes_zero(distance) for distance in distances), "they may be the same point")


def check_increasing(checklist: Checklist, names: Sequence[str], system: System, chain: Chain, name: str) -> None:
    """A coordinate increases along the curve; `names` are those of all coordinates of its points."""
    index, said = names.index(name), names_in_words(system).get(name, name)
    with checklist.hypothesis(
        f"increasing-{name}", "15.7", f"the derivative of {said} along the curve is positive", "leave out the claim"
    ) as evidence:
        for stretch in chain.stretches:
            evidence.require(
                stretch.tube.coordinate_increases(index, stretch.run, stretch.enters, stretch.leaves),
                f"{name} is not shown to increase on piece {stretch.tube.piece.id}",
            )


def check_covers(checklist: Checklist, names: Sequence[str], system: System, chain: Chain, covers: Covers) -> None:
    """A coordinate takes a range along the curve."""
    index, said = names.index(covers.coordinate), names_in_words(system).get(covers.coordinate, covers.coordinate)
    low, high = exact_text(covers.start), exact_text(covers.end)
    statement = f"{said} is at most {low} where the curve begins and at least {high} where it ends"
    with checklist.hypothesis("covers", "15.7", statement, "let the pieces reach further") as evidence:
        first, last = (end[index] for end in chain.ends)
        evidence.record("beginning", first)
        evidence.record("end", last)
        evidence.require(all_finite([first, last]), "the ends are not known")
        if evidence.holds:
            evidence.require(upper_end(first) <= covers.start, "it is not shown to begin so low")
            evidence.require(covers.end <= lower_end(last), "it is not shown to end so high")
