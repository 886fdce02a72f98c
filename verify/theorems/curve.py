"""Curves of symmetric orbits (sections 15, 16 and 18)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from orbitproof.shared.claims import CLAIMS, SURFACE, Atlas
from orbitproof.shared.formats import BirthPiece, Piece
from orbitproof.verify.branches.certificate import statement_of
from orbitproof.verify.branches.curve_conclusion import conclude_curve
from orbitproof.verify.branches.document import BranchStatement
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.recheck import OF_ANY_BRANCH, ends_of
from orbitproof.verify.branches.results import Result
from orbitproof.verify.certificate.levels import Finding
from orbitproof.verify.curve import CurveTheorem, IntervalResult, PieceLimits
from orbitproof.verify.evidence import NotKnown
from orbitproof.verify.lasting import CurveIntervalResult, unconfirmed_twist
from orbitproof.verify.stability import StabilityFunctions, unconfirmed
from orbitproof.verify.words.branches import branch_in_full


def _statement(atlas: Atlas, results: Sequence[Result]) -> BranchStatement:
    known = [result.stability for result in results if isinstance(result.stability, StabilityFunctions)]
    with_distance, with_variations = (
        any(getattr(functions, name) is not None for functions in known) for name in ("distance", "out_of_plane")
    )
    return statement_of(atlas, with_distance, with_variations)


def _unconfirmed(stored: Result, fresh: Result, place: str) -> Iterator[Finding]:
    """What is stored of stability and twist on an interval, and a new integration does not confirm."""
    known = stored.stability
    if stored.twist is not None and known is None:
        yield Finding(f"{place}, twist", "is stored without the functions of stability beside which it stands")
    if known is not None:
        # Functions of s are written in a variable that runs over the interval: on another one they are others.
        if not isinstance(known, NotKnown) and fresh.interval != stored.interval:
            words = f"its functions are of another interval: that is proved on {ends_of(fresh.interval)}"
            yield Finding(f"{place}, stability", words)
        found = [
            *unconfirmed(known, fresh.stability),
            *unconfirmed_twist(stored.twist, fresh.twist),
        ]
        yield from (Finding(f"{place}, stability", text) for text in found)


KIND = BranchKind(
    names=tuple(name for name in CLAIMS if name != SURFACE),
    titles={
        "arc": "A curve of symmetric periodic orbits",
        "loop": "A closed curve of symmetric periodic orbits",
        "symmetric-arc": "A curve of symmetric periodic orbits, mapped to itself by {symmetry}",
        "symmetric-loop": "A closed curve of symmetric periodic orbits, mapped to itself by {symmetry}",
    },
    said=lambda k, kind: "a curve of symmetric orbits",
    **OF_ANY_BRANCH,
    theorem=CurveTheorem,
    limits=PieceLimits,
    about="a curve of symmetric orbits",
    results={Piece: CurveIntervalResult, BirthPiece: IntervalResult},
    statement=_statement,
    conclude=conclude_curve,
    in_full=branch_in_full,
    unconfirmed=_unconfirmed,
    asked=lambda result: {
        "stability": result.stability is not None,
        "lasting": result.twist is not None,
    },
    holds_points=True,
)
