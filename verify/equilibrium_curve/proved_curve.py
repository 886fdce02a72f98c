"""The theorem about a curve of equilibria, from proved pieces (section 37.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import ctx

from orbitproof.shared.claims import EQUILIBRIUM_CURVES, EquilibriumAtlas
from orbitproof.verify.curve import (
    CURVE_PRECISION,
    Chain,
    Conclusion,
    Ends,
    IntervalResult,
    check_covers,
    check_increasing,
    follow,
    read_tube,
)
from orbitproof.verify.equilibrium_curve.counted import SidedPart, sides_along
from orbitproof.verify.equilibrium_curve.folds import Fold, folds_of
from orbitproof.verify.evidence import Checklist, EmptyIntersectionError, NotEstablishedError, NotProved, Proved, Reason
from orbitproof.verify.periodic import check_functions_of
from orbitproof.verify.periodic_curve import require_piece


@dataclass(frozen=True)
class EquilibriumCurveTheorem:
    """The pieces of an atlas are one curve of equilibria, as its claim says (Theorem 37.6)."""

    atlas: EquilibriumAtlas

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        claim = self.atlas.claim
        return (
            *(("functions",) if self.atlas.system.defined else ()),
            "pieces",
            "curve",
            *(f"increasing-{name}" for name in claim.increasing),
            *(("covers",) if claim.covers is not None else ()),
        )


@dataclass(frozen=True)
class ProvedEquilibriumCurve:
    """What is known of a proved curve.

    Attributes:
        chain: its pieces, glued.
        ends: enclosures of the coordinates of its first and last point.
        folds: where the parameter has extrema along the curve, as far as that is certain.
        sides: its parts, by how many eigenvalues lie left and right of the imaginary axis.
    """

    chain: Chain
    ends: Ends
    folds: tuple[Fold, ...] = ()
    sides: tuple[SidedPart, ...] = ()


def conclude_equilibria(
    atlas: EquilibriumAtlas, results: Sequence[IntervalResult]
) -> Conclusion[ProvedEquilibriumCurve]:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    Args:
        atlas: the claim; that the results are about its pieces as they are is for the caller.
        results: one for each interval of each piece.
    """
    checklist = Checklist()
    with ctx.workprec(CURVE_PRECISION):
        try:
            chain = _check_curve(checklist, atlas, results)
            names = atlas.coordinates
            ends = {key: dict(zip(names, end, strict=True)) for key, end in zip(_ENDS, chain.ends, strict=True)}
            curve = ProvedEquilibriumCurve(chain, ends, folds_of(atlas, chain), sides_along(atlas, chain))
        except NotEstablishedError as error:
            return Conclusion(NotProved(error.reason, tuple(checklist.hypotheses)))
        except EmptyIntersectionError as error:
            reason = Reason("results", f"pieces contradict each other: {error}", "report this")
            return Conclusion(NotProved(reason, tuple(checklist.hypotheses)))
    return Conclusion(Proved(EquilibriumCurveTheorem(atlas), curve, tuple(checklist.hypotheses)))


_ENDS = ("start", "end")


def _check_curve(checklist: Checklist, atlas: EquilibriumAtlas, results: Sequence[IntervalResult]) -> Chain:
    """Check every hypothesis of the claim; raises `NotEstablishedError` at the first that is not shown."""
    claim, system, pieces = atlas.claim, atlas.system, atlas.curve_pieces()
    check_functions_of(checklist, system)
    statement = "the pieces have the coordinates of parameter and state, regular frames and tubes"
    with checklist.hypothesis("pieces", "37.1", statement, "write the atlas again") as evidence:
        evidence.require(claim.kind in EQUILIBRIUM_CURVES, f"{claim.kind} is no claim about such a curve")
        given = claim.parameter in system.parameters and {*atlas.parameters, claim.parameter} == {*system.parameters}
        evidence.require(given and claim.parameter not in atlas.parameters, "a parameter has no value, or is none")
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
    with checklist.hypothesis("curve", "37.3", statement, remedy) as evidence:
        found = follow(evidence, claim, tubes)
    assert found is not None
    for name in claim.increasing:
        check_increasing(checklist, atlas.coordinates, system, found, name)
    if claim.covers is not None:
        check_covers(checklist, atlas.coordinates, system, found, claim.covers)
    return found
