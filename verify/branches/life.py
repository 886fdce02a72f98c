"""Certificates of lives: which proved curves of equilibria and of periodic orbits are joined (section 39.6)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, cast

from flint import arb

from orbitproof.shared.claims import BirthAtlas, EquilibriumAtlas
from orbitproof.shared.claims.fields import Id, Identifier, PieceId
from orbitproof.shared.claims.life import Joining, Life
from orbitproof.shared.formats.life import life_from_json
from orbitproof.shared.stored import rules
from orbitproof.shared.wording import counted
from orbitproof.verify.birth_curve import ProvedBirthCurve, conclude_births
from orbitproof.verify.branches.joined import RestsOn, levels_of, problem_of
from orbitproof.verify.branches.rests_on import RestingError
from orbitproof.verify.certificate import Certificate, Given, Key, Recheck, sealed
from orbitproof.verify.certificate.document import Document
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.equilibrium_curve import Fold, ProvedEquilibriumCurve, Sides, conclude_equilibria
from orbitproof.verify.evidence import Hypothesis, Proved, Reason, software
from orbitproof.verify.life import Birthplace, LifeCurve, LifeTheorem, ProvedLife, conclude_life
from orbitproof.verify.periodic_curve import Turn
from orbitproof.verify.words.life import life_in_words

SCHEMA = "life-certificate"

_CONCLUDED: Mapping[type, Callable[[Any, Any], Any]] = {
    EquilibriumAtlas: conclude_equilibria,
    BirthAtlas: conclude_births,
}
"""How the theorem about an arc follows from what is stored of its pieces, by the type of its atlas."""


@dataclass(frozen=True, kw_only=True)
class StoredBirthplace:
    """Where an arc of orbits begins or ends.

    Attributes:
        arc: the id of the arc of equilibria.
        piece, s: the place of the equilibrium on it.
        value: of the parameter.
        point: the equilibrium, in the order of the state but for functions of other coordinates.
        frequency: omega of its eigenvalues i omega and -i omega.
        before, after: how many eigenvalues are left and right of the imaginary axis on the nearest parts of the arc of
            equilibria where that is decided, before the place and after it.
    """

    arc: Id
    how: Joining
    piece: PieceId
    s: arb
    value: arb
    point: tuple[arb, ...]
    frequency: arb
    before: Sides | None = None
    after: Sides | None = None


@dataclass(frozen=True, kw_only=True)
class StoredLifeArc:
    """An arc.

    Attributes:
        id: of its certificate.
        kind: of its claim.
        parameter: the one that varies.
        values: contain those of the parameter on it.
        period: contains the least periods of its orbits, where these are known.
        folds: of equilibria.
        turns: extrema of the parameter along orbits.
    """

    id: Id
    kind: Annotated[str, rules(enum=("equilibrium-arc", "equilibrium-loop", "birth-arc", "birth-to-birth"))]
    parameter: Identifier
    values: arb
    period: arb | None = None
    joints: tuple[StoredBirthplace, ...] = ()
    folds: tuple[Fold, ...] = ()
    turns: tuple[Turn, ...] = ()


@dataclass(frozen=True, kw_only=True)
class LifeStatement:
    """The claim, and what is proved, in words; absent if that is nothing."""

    claim: Life
    theorem: str | None = None


@dataclass(frozen=True, kw_only=True)
class LifeDocument(Document):
    """A graph of proved curves of equilibria and of periodic orbits.

    Attributes:
        rests_on: the certificates of its arcs.
        arcs: what is proved of them; nothing if the claim is not proved.
        parts: the ids of arcs that hang together.
    """

    reason: Reason | None
    statement: LifeStatement
    rests_on: Annotated[tuple[RestsOn, ...], rules(minItems=1, maxItems=1000)]
    hypotheses: tuple[Hypothesis, ...]
    arcs: tuple[StoredLifeArc, ...] = ()
    parts: tuple[tuple[Id, ...], ...] = ()


SAID: Mapping[str, Callable[[Certificate], Any]] = {
    "claim": lambda certificate: life_from_json(
        certificate.document["statement"]["claim"], f"certificate {certificate.id!r}: statement.claim"
    ),
    "arcs": lambda certificate: from_json(tuple[StoredLifeArc, ...], certificate.document["arcs"], "arcs"),
    "results": lambda certificate: certificate.arcs,
}
"""What the certificate of a life says besides: its claim, and its arcs in the order of that."""


def extent_of(certificate: Certificate) -> str:
    """How large it is, in words."""
    return counted(len(certificate.document["arcs"]), "arc")


def certified_life(life: Life, certificates: Sequence[Certificate], checks: Mapping[Key, Recheck]) -> dict[str, Any]:
    """The certificate of a life, as JSON.

    Args:
        certificates: as `resting` gives them.
        checks: of each, up to the conclusion or further. Raises `ValueError` if one is that of another.
    """
    for entry in certificates:
        Given(checks=checks).check_of(entry)
    outcome = conclude_life(life, [_curve(entry, checks) for entry in certificates])
    rests_on = tuple(RestsOn(entry.id, "arc", entry.digest) for entry in certificates)
    claim, reason = LifeStatement(claim=life), None if isinstance(outcome, Proved) else outcome.reason
    known: dict[str, Any] = {}
    if isinstance(outcome, Proved):
        theorem, found = cast(LifeTheorem, outcome.theorem), outcome.results
        words = life_in_words(theorem, found, {entry.id: entry.digest for entry in certificates})
        claim = LifeStatement(claim=life, theorem=words)
        known = {"arcs": tuple(_stored(found, number) for number in range(len(found.arcs))), "parts": found.parts}
    document = LifeDocument(
        id=life.id, verdict="not proved" if reason else "proved", reason=reason, statement=claim, rests_on=rests_on,
        hypotheses=outcome.hypotheses, **known, software=software(), digest="",
    )  # fmt: skip
    return sealed(document, SCHEMA, ("arcs", "parts"))


def _curve(certificate: Certificate, checks: Mapping[Key, Recheck]) -> LifeCurve:
    """What a certificate proves of an arc."""
    atlas = certificate.atlas
    conclude = _CONCLUDED.get(type(atlas))
    if conclude is None:
        raise RestingError(certificate.key, "is about no equilibria and no orbits from their birth on; leave it out")
    if problem := problem_of(certificate, checks, "the certificate"):
        return LifeCurve(atlas, None, problem)
    outcome = conclude(atlas, certificate.results).outcome
    if not isinstance(outcome, Proved):
        return LifeCurve(atlas, None, outcome.reason.message)
    return LifeCurve(atlas, outcome.results)


def _stored(life: ProvedLife, number: int) -> StoredLifeArc:
    arc, values = life.arcs[number], life.values[number]
    known: dict[str, Any] = {}
    if isinstance(arc.curve, ProvedEquilibriumCurve):
        known["folds"] = arc.curve.folds
    elif isinstance(arc.curve, ProvedBirthCurve):
        period = arc.curve.period
        known |= {"turns": arc.curve.turns, "period": period if period.is_finite() else None}
    return StoredLifeArc(
        id=arc.id,
        kind=arc.atlas.claim.kind,
        parameter=arc.atlas.claim.parameter,
        values=values,
        joints=tuple(_birthplace(arc, joint) for joint in life.joints if joint.arc == arc.id),
        **known,
    )


def _birthplace(arc: LifeCurve, found: Birthplace) -> StoredBirthplace:
    point = found.birth.point
    return StoredBirthplace(
        arc=found.on,
        how=found.how,
        piece=found.place.piece,
        s=found.place.s,
        value=point[arc.atlas.claim.parameter],
        point=tuple(point[name] for name in arc.atlas.system.given_state),
        frequency=found.birth.frequency,
        before=found.before,
        after=found.after,
    )


LEVELS = levels_of(life_from_json, LifeTheorem, certified_life)
