"""Symmetry breakings over a range of a parameter (section 17)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, cast

from orbitproof.shared.claims import SURFACE, Atlas
from orbitproof.shared.formats import LibrationPiece, SurfacePiece
from orbitproof.verify.branches.certificate import statement_of
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.recheck import OF_ANY_BRANCH, ends_of
from orbitproof.verify.branches.results import Result, covers
from orbitproof.verify.branches.whole_as_json import whole_to_json
from orbitproof.verify.certificate.levels import Finding, confirmed
from orbitproof.verify.curve import Conclusion, IntervalResult
from orbitproof.verify.evidence import Proved, quoted_name
from orbitproof.verify.surface import (
    ProvedPart,
    ProvedSurface,
    SurfaceLimits,
    SurfaceResult,
    SurfaceTheorem,
    conclude_surface,
    unshown,
)
from orbitproof.verify.words.branches import branch_in_full
from orbitproof.verify.words.surface import surface_in_words


def told(found: Conclusion[ProvedSurface]) -> dict[str, Any]:
    """A conclusion as JSON, with its theorem in words."""
    if not isinstance(found.outcome, Proved):
        return whole_to_json(found, "", None)
    theorem, known = cast(SurfaceTheorem, found.outcome.theorem), found.outcome.results
    return whole_to_json(found, surface_in_words(theorem, known), None, known.joints)


def _unshown(atlas: Atlas, result: Result) -> Iterator[tuple[str, str]]:
    """What of the parts of an interval does not follow from what is stored of them."""
    pieces = {piece.id: piece for piece in atlas.surface_pieces()}
    for number, part in enumerate(result.parts):
        yield from ((f"parts[{number}]", text) for text in unshown(pieces[result.piece], part))


def _contradictions(stored: Result, fresh: Result, place: str) -> Iterator[Finding]:
    """Where halo orbits are on other sides of a part."""
    for part in stored.parts:
        for entry in (entry for entry in fresh.parts if covers([part.interval], entry.interval)):
            if part.side != entry.side:
                where = f"{place}, part {ends_of(part.interval)}, side"
                yield Finding(where, f"stored is {part.side!r}, found {entry.side!r}")


def _unconfirmed(stored: Result, fresh: Result, place: str) -> Iterator[Finding]:
    """What is stored of the parts of an interval, and a new proof does not confirm."""
    for part in stored.parts:
        inside = [entry for entry in fresh.parts if covers([part.interval], entry.interval)]
        where = f"{place}, part {ends_of(part.interval)}"
        if not covers([entry.interval for entry in inside], part.interval):
            yield Finding(where, "is not proved again on all of it")
        for entry in inside:
            yield from _part_findings(part, entry, where)


def _part_findings(stored: ProvedPart, fresh: ProvedPart, place: str) -> Iterator[Finding]:
    balls = [(f"p_{i}", old, new) for i, (old, new) in enumerate(zip(stored.point, fresh.point, strict=True))]
    if list(stored.enclosures) != list(fresh.enclosures):
        yield Finding(place, f"stored hypotheses are {', '.join(map(quoted_name, stored.enclosures))}")
        return
    for name, old_balls in stored.enclosures.items():
        new_balls = fresh.enclosures[name]
        if set(old_balls) != set(new_balls):
            yield Finding(f"{place}, {name}", "has other enclosures than the new proof")
            continue
        balls += [(f"{name}, {key}", old, new_balls[key]) for key, old in old_balls.items()]
    for name, old, new in balls:
        yield from confirmed(old, new, f"{place}, {name}")


KIND = BranchKind(
    names=(SURFACE,),
    titles={SURFACE: "Symmetry breaking over a range of parameters"},
    said=lambda k, kind: "a surface",
    **OF_ANY_BRANCH,
    theorem=SurfaceTheorem,
    limits=SurfaceLimits,
    about="a surface",
    results={SurfacePiece: SurfaceResult, LibrationPiece: IntervalResult},
    statement=lambda atlas, results: statement_of(atlas),
    conclude=lambda atlas, results, *_: told(conclude_surface(atlas, results)),
    in_full=branch_in_full,
    unshown=_unshown,
    contradictions=_contradictions,
    unconfirmed=_unconfirmed,
    asked=lambda result: {"parts": tuple(part.interval for part in result.parts)},
)
