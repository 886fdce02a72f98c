"""The theorem about halo orbits over a range of the mass parameter, from proved pieces (section 17)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import cast

from flint import arb, ctx

from orbitproof.shared.formats import Atlas, evaluate
from orbitproof.shared.systems import HILL
from orbitproof.verify.claim import check_symmetries, determinant, is_adapted, signs_on
from orbitproof.verify.curve import Conclusion, Ends, IntervalResult
from orbitproof.verify.evidence import (
    Checklist,
    EmptyIntersectionError,
    Evidence,
    NotEstablishedError,
    NotProved,
    Proved,
    Reason,
    hull,
)
from orbitproof.verify.surface.gluing import Sheet, SurfaceJoint, glue, read_sheet
from orbitproof.verify.surface.planar_family import PlanarFamily, require_family
from orbitproof.verify.surface.proved_parts import SurfaceResult

PRECISION = 256
"""Bits of the ball arithmetic."""

_REMEDY = "write the atlas again with narrower pieces or other radii"


@dataclass(frozen=True)
class Height:
    """The z up to which the halo orbits reach over a range [start, end] of the parameter."""

    start: Fraction
    end: Fraction
    z: Fraction


@dataclass(frozen=True)
class SurfaceTheorem:
    """Over a range of the parameter there are symmetry breakings, and orbits that branch off (Theorem 17.5)."""

    atlas: Atlas

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        covers = ("covers",) if self.atlas.claim.covers else ()
        planar = ("planar-family",) if self.atlas.libration_pieces() else ()
        return ("symmetries", "frames", "pieces", "parameter", "glued", *covers, *planar)


@dataclass(frozen=True)
class ProvedSurface:
    """What is known of a proved surface.

    Attributes:
        joints: where its pieces meet.
        ends: enclosures of the parameter and the bifurcation point at the ends of the range.
        heights: of the halo orbits over each piece, in order.
        sides: of the levels of the first integral at which the new orbits live, from all pieces.
        half_period: contains all half periods.
        family: where the planar orbits are shown to be the Lyapunov family of a libration point.
    """

    joints: tuple[SurfaceJoint, ...]
    ends: Ends
    heights: tuple[Height, ...]
    sides: frozenset[str]
    half_period: arb
    family: PlanarFamily | None = None


def conclude_surface(atlas: Atlas, results: Sequence[IntervalResult]) -> Conclusion[ProvedSurface]:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    `results`: one for each interval of each piece; that they are about the pieces of the atlas as they are is for the
    caller.
    """
    checklist = Checklist()
    with ctx.workprec(PRECISION):
        try:
            sheets, joints = _check(checklist, atlas, results)
            family = _check_family(checklist, atlas, sheets, results)
            sides = frozenset(part.side for sheet in sheets for part in sheet.parts)
            ends, half_period = _ends(atlas, sheets), _half_period(atlas, results)
            surface = ProvedSurface(joints, ends, heights(atlas), sides, half_period, family)
        except NotEstablishedError as error:
            return Conclusion(NotProved(error.reason, tuple(checklist.hypotheses)))
        except (EmptyIntersectionError, ValueError, KeyError) as error:
            reason = Reason("results", f"the results contradict the atlas or each other: {error}", "prove it again")
            return Conclusion(NotProved(reason, tuple(checklist.hypotheses)))
    return Conclusion(Proved(SurfaceTheorem(atlas), surface, tuple(checklist.hypotheses)))


def heights(atlas: Atlas) -> tuple[Height, ...]:
    """For each piece the ends of its range and the z up to which the halo orbits over it reach: R_1 |A_z1|."""
    system = atlas.system
    signs = system.symmetries[atlas.claim.symmetry or ""]
    odd = next(i for i, name in enumerate(system.centre_coordinates) if signs[system.state.index(name)] < 0)
    rows = [(piece.parameters[system.fixed_parameters[0]], piece) for piece in atlas.surface_pieces()]
    return tuple(
        Height(evaluate(row, Fraction(-1)), evaluate(row, Fraction(1)), abs(piece.frame[odd][1]) * piece.radii[1])
        for row, piece in rows
    )


def _check(
    checklist: Checklist, atlas: Atlas, results: Sequence[IntervalResult]
) -> tuple[list[Sheet], tuple[SurfaceJoint, ...]]:
    system, pieces = atlas.system, atlas.surface_pieces()
    check_symmetries(checklist, system, atlas.claim.symmetry)
    with checklist.hypothesis(
        "frames", "7.1", "the frames of all pieces are regular and adapted to the symmetry", _REMEDY
    ) as evidence:
        for piece in pieces:
            regular = determinant(piece.frame) != 0 and determinant(piece.kernel_frame) != 0
            evidence.require(regular, f"a frame of {piece.id} is singular")
            evidence.require(min(piece.radii) > 0, f"a radius of {piece.id} is not positive")
        evidence.require(
            len(system.fixed_parameters) == 1 and system.family_parameter is None and system.first_integral is not None,
            f"{system.name} is no system with one parameter and a first integral",
        )
        evidence.require(atlas.claim.symmetry is not None, "the claim names no symmetry")
        if atlas.claim.symmetry is not None:
            _require_adapted(evidence, atlas)
    parameter = system.fixed_parameters[0]
    by_piece: dict[str, list[SurfaceResult]] = {piece.id: [] for piece in pieces}
    for result in results:
        if result.piece in by_piece:
            by_piece[result.piece].append(cast(SurfaceResult, result))
    sheets = [read_sheet(piece, parameter, by_piece[piece.id]) for piece in pieces]
    with checklist.hypothesis(
        "pieces", "17.2", "the theorem on symmetry breaking holds on every piece for every s in [-1, 1]", _REMEDY
    ) as evidence:
        for sheet in sheets:
            gap = sheet.gap()
            evidence.require(gap is None, f"piece {sheet.piece.id} is not proved from s = {float(gap or 0):.6g} on")
    with checklist.hypothesis(
        "parameter",
        "17.3",
        "the parameter increases with s on every piece, within the range of the system",
        "turn the pieces around",
    ) as evidence:
        for sheet in sheets:
            evidence.require(sheet.increases(), f"the parameter of {sheet.piece.id} is not shown to increase")
            admissible = system.parameters[parameter]
            ends = (evaluate(sheet.parameter, Fraction(end)) for end in (-1, 1))
            evidence.require(
                all(map(admissible.contains, ends)), f"{parameter} leaves {admissible} on {sheet.piece.id}"
            )
    joints: list[SurfaceJoint] = []
    with checklist.hypothesis(
        "glued",
        "17.3",
        "neighbouring pieces overlap and have the same bifurcation point at a common parameter",
        _REMEDY,
    ) as evidence:
        evidence.require(bool(sheets), "there is no piece")
        for before, after in pairwise(sheets):
            joint = glue(evidence, before, after)
            if joint is not None:
                joints.append(joint)
    if atlas.claim.covers is not None:
        _check_covers(checklist, atlas, sheets)
    return sheets, tuple(joints)


def _check_covers(checklist: Checklist, atlas: Atlas, sheets: Sequence[Sheet]) -> None:
    covers = atlas.claim.covers
    assert covers is not None
    with checklist.hypothesis(
        "covers", "17.3", "the pieces reach both ends of the range that is claimed", "add pieces"
    ) as evidence:
        evidence.require(covers.coordinate == atlas.system.fixed_parameters[0], "the range is not one of the parameter")
        first = evaluate(sheets[0].parameter, Fraction(-1))
        last = evaluate(sheets[-1].parameter, Fraction(1))
        evidence.require(first <= covers.start, f"the first piece begins at {float(first):.17g}, above the range")
        evidence.require(last >= covers.end, f"the last piece ends at {float(last):.17g}, below the range's end")


def _check_family(
    checklist: Checklist, atlas: Atlas, sheets: Sequence[Sheet], results: Sequence[IntervalResult]
) -> PlanarFamily | None:
    """For an atlas with pieces of the planar family: over which masses it is that of the libration point."""
    if not atlas.libration_pieces():
        return None
    with checklist.hypothesis(
        "planar-family",
        "17.6",
        "the planar orbits of the surface are those of pieces that go down to the libration point",
        "write the atlas again, or leave out the libration pieces",
    ) as evidence:
        evidence.require(atlas.system is HILL, f"{atlas.system.name} is not in Hill's units")
        family = require_family(evidence, atlas, sheets, results)
    return family


def _require_adapted(evidence: Evidence, atlas: Atlas) -> None:
    """As `verify.claim.frames.check_adapted_frames`, for all s: the centre stays in the set that the symmetry fixes."""
    system = atlas.system
    signs = system.symmetries[atlas.claim.symmetry or ""]
    parity = signs_on(system, atlas.claim.symmetry or "", system.centre_coordinates)
    kernel = [signs[i] for i in system.kernel_coordinates]
    evidence.require(parity.count(-1) == 1, "the symmetry does not negate exactly one coordinate of Fix(R)")
    for piece in atlas.surface_pieces():
        centred = not any(value for row, sign in zip(piece.centre, parity, strict=True) if sign < 0 for value in row)
        evidence.require(
            centred
            and is_adapted(piece.frame, parity, 1)
            and is_adapted(tuple(zip(*piece.kernel_frame, strict=True)), kernel, 0),
            f"centre or frames of {piece.id} are not adapted to the symmetry",
        )


def _ends(atlas: Atlas, sheets: Sequence[Sheet]) -> Ends:
    names = atlas.system.centre_coordinates
    parameter = atlas.system.fixed_parameters[0]
    result = {}
    for key, sheet, s in (("start", sheets[0], Fraction(-1)), ("end", sheets[-1], Fraction(1))):
        value = evaluate(sheet.parameter, s)
        exact = arb(value.numerator) / arb(value.denominator)
        result[key] = {parameter: exact, **dict(zip(names, sheet.point(s, s), strict=True))}
    return result


def _half_period(atlas: Atlas, results: Sequence[IntervalResult]) -> arb:
    names = {piece.id for piece in atlas.surface_pieces()}
    proved = [result for result in results if result.piece in names and result.is_proved]
    times = [result.time for result in proved if result.time is not None]
    if len(times) < len(proved):
        raise ValueError("a result has no half periods")
    return hull(times[0], *times[1:])
