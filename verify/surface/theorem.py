"""The theorem about halo orbits over a range of the mass parameter, from proved pieces (section 17)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, ctx

from orbitproof.shared.formats import Atlas, evaluate
from orbitproof.verify.claim import check_symmetries, determinant
from orbitproof.verify.evidence import (
    Checklist,
    EmptyIntersectionError,
    Evidence,
    Hypothesis,
    IntegrationFailure,
    NotEstablishedError,
    Reason,
    ball_from_json,
    balls_to_json,
    hull,
    hypothesis_to_json,
)
from orbitproof.verify.surface.gluing import Sheet, SurfaceJoint, glue, read_sheet
from orbitproof.verify.surface.statement import Ends, Height, surface_statement

PRECISION = 256
"""Bits of the ball arithmetic."""

_REMEDY = "write the atlas again with narrower pieces or other radii"


@dataclass(frozen=True)
class SurfaceConclusion:
    """What the pieces of a surface prove together. Raises `ValueError` if it says more than its hypotheses show.

    Attributes:
        atlas: id of the atlas.
        statement: the theorem in words; empty if it is not proved.
        reason: why it is not proved, or `None` if it is.
        hypotheses: what was checked, in order, with enclosures.
        joints: where pieces meet.
        ends: enclosures of the parameter and of the bifurcation point at the ends of the range.
        expected: names of the hypotheses that the claim takes, in order.
    """

    atlas: str
    statement: str
    reason: Reason | None
    hypotheses: tuple[Hypothesis, ...]
    joints: tuple[SurfaceJoint, ...]
    ends: Ends
    expected: tuple[str, ...]

    def __post_init__(self) -> None:
        names = tuple(hypothesis.name for hypothesis in self.hypotheses)
        shown = bool(names) and names == self.expected and all(h.holds is True for h in self.hypotheses)
        if self.is_proved and not shown:
            raise ValueError(f"hypotheses {names} do not prove what takes {self.expected}")
        if self.is_proved != bool(self.statement):
            raise ValueError("a statement belongs to what is proved, and to nothing else")

    @property
    def is_proved(self) -> bool:
        """Whether the surface is proved."""
        return self.reason is None

    def to_json(self) -> dict[str, Any]:
        """The JSON object: exact numbers and balls with decimals beside them."""
        reason = self.reason
        return {
            "verdict": "proved" if self.is_proved else "not proved",
            "statement": self.statement,
            "reason": None
            if reason is None
            else {"condition": reason.condition, "message": reason.message, "remedy": reason.remedy},
            "hypotheses": [hypothesis_to_json(hypothesis) for hypothesis in self.hypotheses],
            "stretches": [],
            "joints": [joint.to_json() for joint in self.joints],
            "ends": {end: balls_to_json(coordinates) for end, coordinates in self.ends.items()},
            "bifurcations": [],
        }


def hypotheses_of(atlas: Atlas) -> tuple[str, ...]:
    """Names of the hypotheses that the claim takes, in the order of checking."""
    return ("symmetries", "frames", "pieces", "parameter", "glued", *(("covers",) if atlas.claim.covers else ()))


def conclude_surface(atlas: Atlas, results: Sequence[Mapping[str, Any]]) -> SurfaceConclusion:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    `results`: the JSON object of one `SurfaceResult` for each interval of each piece; that they are about the pieces
    of the atlas as they are is for the caller.
    """
    checklist = Checklist()
    joints: tuple[SurfaceJoint, ...] = ()
    ends: Ends = {}
    reason, statement = None, ""
    with ctx.workprec(PRECISION):
        try:
            sheets, joints = _check(checklist, atlas, results)
            ends = _ends(atlas, sheets)
            sides = {part.side for sheet in sheets for part in sheet.parts}
            statement = surface_statement(atlas, ends, heights(atlas), sides, _half_period(results))
        except NotEstablishedError as error:
            reason = error.reason
        except (EmptyIntersectionError, ValueError, KeyError) as error:
            reason = Reason("results", f"the results contradict the atlas or each other: {error}", "prove it again")
    return SurfaceConclusion(
        atlas.id, statement, reason, tuple(checklist.hypotheses), joints, ends, hypotheses_of(atlas)
    )


def heights(atlas: Atlas) -> list[Height]:
    """For each piece the ends of its range and the z up to which the halo orbits over it reach: R_1 |A_z1|."""
    system = atlas.system
    signs = system.symmetries[atlas.claim.symmetry or ""]
    odd = next(i for i, name in enumerate(system.centre_coordinates) if signs[system.state.index(name)] < 0)
    rows = [(piece.parameters[system.fixed_parameters[0]], piece) for piece in atlas.surface_pieces()]
    return [
        Height(evaluate(row, Fraction(-1)), evaluate(row, Fraction(1)), abs(piece.frame[odd][1]) * piece.radii[1])
        for row, piece in rows
    ]


def _check(
    checklist: Checklist, atlas: Atlas, results: Sequence[Mapping[str, Any]]
) -> tuple[list[Sheet], tuple[SurfaceJoint, ...]]:
    system, pieces = atlas.system, atlas.surface_pieces()
    with checklist.hypothesis(
        "symmetries", "1.3", "R reverses the system, and the symmetry that breaks commutes with its flow", _REMEDY
    ) as evidence:
        evidence.require(_symmetries_hold(atlas), "the vector field was not shown to have the symmetries")
        evidence.require(
            len(system.fixed_parameters) == 1 and system.family_parameter is None and system.first_integral is not None,
            f"{system.name} is no system with one parameter and a first integral",
        )
    with checklist.hypothesis(
        "frames", "7.1", "the frames of all pieces are regular and adapted to the symmetry", _REMEDY
    ) as evidence:
        for piece in pieces:
            regular = determinant(piece.frame) != 0 and determinant(piece.kernel_frame) != 0
            evidence.require(regular, f"a frame of {piece.id} is singular")
            evidence.require(min(piece.radii) > 0, f"a radius of {piece.id} is not positive")
        _require_adapted(evidence, atlas)
    parameter = system.fixed_parameters[0]
    by_piece: dict[str, list[Mapping[str, Any]]] = {piece.id: [] for piece in pieces}
    for result in results:
        by_piece.setdefault(str(result["piece"]), []).append(result)
    sheets = [read_sheet(piece, parameter, by_piece[piece.id]) for piece in pieces]
    with checklist.hypothesis(
        "pieces", "17.2", "the theorem on symmetry breaking holds on every piece for every s in [-1, 1]", _REMEDY
    ) as evidence:
        for sheet in sheets:
            gap = sheet.gap()
            evidence.require(gap is None, f"piece {sheet.piece.id} is not proved from s = {float(gap or 0):.6g} on")
    with checklist.hypothesis(
        "parameter", "17.3", "the parameter increases with s on every piece", "turn the pieces around"
    ) as evidence:
        for sheet in sheets:
            evidence.require(sheet.increases(), f"the parameter of {sheet.piece.id} is not shown to increase")
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


def _symmetries_hold(atlas: Atlas) -> bool:
    try:
        check_symmetries(atlas.system, atlas.claim.symmetry)
    except (IntegrationFailure, KeyError):
        return False
    return atlas.claim.symmetry is not None


def _require_adapted(evidence: Evidence, atlas: Atlas) -> None:
    """As `verify.claim.frames.check_adapted_frames`, for all s: the centre stays in the set that the symmetry fixes."""
    system = atlas.system
    signs = system.symmetries[atlas.claim.symmetry or ""]
    parity = [signs[system.state.index(name)] for name in system.centre_coordinates]
    kernel = [signs[i] for i in system.kernel_coordinates]
    evidence.require(parity.count(-1) == 1, "the symmetry does not negate exactly one coordinate of Fix(R)")
    for piece in atlas.surface_pieces():
        evidence.require(
            not any(value for row, sign in zip(piece.centre, parity, strict=True) if sign < 0 for value in row)
            and not any(
                value
                for row, sign in zip(piece.frame, parity, strict=True)
                for column, value in enumerate(row)
                if sign != (-1 if column == 1 else 1)
            )
            and not any(
                value
                for number, row in enumerate(piece.kernel_frame)
                for value, sign in zip(row, kernel, strict=True)
                if sign != (-1 if number == 0 else 1)
            ),
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


def _half_period(results: Sequence[Mapping[str, Any]]) -> arb:
    times = [ball_from_json(result["time"]) for result in results if result["verdict"] == "proved"]
    return hull(times[0], *times[1:])
