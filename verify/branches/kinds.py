"""What is asked of a kind of theorem about branches, curves and surfaces, besides what is asked of any."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, cast

from orbitproof.shared.claims import AnyAtlas, AnyPiece, Atlas
from orbitproof.verify.branches.document import BranchStatement, PeriodicCurveStatement
from orbitproof.verify.branches.results import Result, Settings
from orbitproof.verify.certificate.kind import Kind
from orbitproof.verify.certificate.kinds import kind_named
from orbitproof.verify.certificate.levels import Finding
from orbitproof.verify.evidence import Theorem


@dataclass(frozen=True, kw_only=True)
class BranchKind(Kind):
    """One kind of claim.

    Attributes:
        theorem: that an atlas claims.
        limits: the type of the settings of the integrator for its pieces.
        about: what it is about, in words.
        results: the type of what is found on an interval, by that of the piece.
        statement: the claim in full, but for the theorem, given the results.
        conclude: what results give together, as `conclusion_of` has it.
        in_full: the theorem in words so that it stands alone.
        unshown: of a stored result, what does not follow from what it stores: where in it, and why.
        contradictions, unconfirmed: of the stored result and a new one of an interval at a place, what cannot both be
            true, and what the new one does not confirm besides.
        asked: of a stored result, what is to be looked at besides when it is proved again, as of `ProvedBefore`.
        coordinates: names of those of a point, from the atlas.
        setting: what the proof of a piece depends on beside the piece, the system and its parameters, from the atlas.
        in_question: what the proof of an interval is asked besides, from the atlas.
        prove: an interval of a piece, where no symmetry is used: atlas, piece, interval, settings of the type `limits`,
            and what is called after a step.
        more_at_next: by how much more the settings of a second attempt are than is usual.
        holds_points: whether certified orbits are looked for on such a branch, and resonances listed: a curve of
            symmetric orbits.
        time: what the time that is stored of an interval is called.
    """

    theorem: Callable[[Any], Theorem]
    limits: type[Any]
    about: str
    results: Mapping[type[AnyPiece], type[Result]]
    statement: Callable[[Any, Sequence[Result]], BranchStatement | PeriodicCurveStatement]
    conclude: Callable[..., dict[str, Any]]
    in_full: Callable[[Any, str], str]
    unshown: Callable[[Any, Any], Iterator[tuple[str, str]]] = lambda atlas, result: iter(())
    contradictions: Callable[[Any, Any, str], Iterator[Finding]] = lambda stored, fresh, place: iter(())
    unconfirmed: Callable[[Any, Any, str], Iterator[Finding]] = lambda stored, fresh, place: iter(())
    asked: Callable[[Any], Mapping[str, Any]] = lambda result: {}
    coordinates: Callable[[Any], tuple[str, ...]] = lambda atlas: atlas.system.centre_coordinates
    setting: Callable[[Any], tuple[Any, ...]] = lambda atlas: (atlas.claim.symmetry, atlas.claim.crossings)
    in_question: Callable[[Any], Mapping[str, Any]] = lambda atlas: {}
    prove: Callable[[Any, Any, Any, Any, Callable[[float], None]], Result] | None = None
    more_at_next: Mapping[str, int] = field(default_factory=dict)
    holds_points: bool = False
    time: str = "half period"

    def result(self, piece: AnyPiece) -> type[Result]:
        """The type of what is found for a piece."""
        return self.results.get(type(piece), Result)

    def settings(self, **given: int) -> Settings:
        """Settings of the integrator, those that are not given as it suits. Raises `ValueError` out of range."""
        return asdict(self.limits(**given))


def kind_of(atlas: AnyAtlas) -> BranchKind:
    """The kind of an atlas."""
    return cast(BranchKind, kind_named(atlas.claim.kind))


def symmetric_curve(atlas: AnyAtlas) -> Atlas | None:
    """The atlas, if it is about a curve of symmetric orbits, on which certified orbits may lie."""
    return cast(Atlas, atlas) if kind_of(atlas).holds_points else None
