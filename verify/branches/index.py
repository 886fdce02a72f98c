"""Certificates of the index of the orbits of a proved curve (section 35.7)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, Any, cast

from flint import arb

from orbitproof.shared.claims.fields import PieceId, Title
from orbitproof.shared.formats import Atlas, InputError
from orbitproof.shared.stored import rules
from orbitproof.shared.systems import shown
from orbitproof.shared.wording import counted
from orbitproof.verify.branches.conclusion_as_json import shortened
from orbitproof.verify.branches.curve_conclusion import follow
from orbitproof.verify.branches.its_curve import curve_given, names_its_curve
from orbitproof.verify.branches.kinds import symmetric_curve
from orbitproof.verify.branches.results import on_curve
from orbitproof.verify.certificate import (
    UNCHECKED_REASON,
    CannotBeCheckedError,
    Certificate,
    Examination,
    Finding,
    Given,
    confirmed,
    digest,
    in_all_data,
    numbers,
    other_hypotheses,
    overlap,
    sealed,
    unknown_reason,
)
from orbitproof.verify.certificate.document import Document, RestsOn
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.curve import ProvedCurve, conclude, vertical_point
from orbitproof.verify.evidence import Hypothesis, IntegrationFailure, Outcome, Proved, Reason, software, spared
from orbitproof.verify.index import (
    SYSTEMS,
    CountedOrbit,
    HalfTurns,
    IndexTheorem,
    Interval,
    ProvedIndex,
    Start,
    conclude_index,
    followed,
    intervals_with_orbits,
    places_in,
    start_at,
    stretch_of,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import Bound, IntervalEnd, ProvedList, conclude_list
from orbitproof.verify.words.index import index_in_words

SCHEMA = "index-certificate"

_BITS = (128, 192, 288)
"""Bits with which an orbit is followed, one after the other."""
_SPARE = Fraction(1, 4)
"""Angles are stored wider by this share of their radius: with more bits steps are more, and bounds a little larger."""
_MORE_BITS = 32
"""Bits of another integration; what it does not confirm is followed with the bits above."""
_ORDER = 2
"""Order of the list: points with k = 1 are all that is wanted."""
_MOST_ORBITS = 6
"""So many orbits of an interval are tried."""


@dataclass(frozen=True)
class IndexedOrbit:
    """An orbit whose index was counted, and between which places of the curve all orbits have the same.

    Attributes:
        piece, s: its place.
        turns: half turns; of a planar orbit in the plane, then across it.
        index: the Conley-Zehnder index: of a planar orbit the sum of both.
        begin, end: of the interval; absent for a curve without a list.
    """

    piece: PieceId
    s: Fraction
    turns: Annotated[tuple[HalfTurns, ...], rules(minItems=1, maxItems=2)]
    index: int
    begin: IntervalEnd | None = None
    end: IntervalEnd | None = None


@dataclass(frozen=True, kw_only=True)
class IndexStatement:
    """What is proved, in words; absent if that is nothing."""

    system: Title
    theorem: str | None = None


@dataclass(frozen=True, kw_only=True)
class IndexDocument(Document):
    """The Conley-Zehnder index of the orbits of a proved curve.

    Attributes:
        rests_on: the certificate of the curve.
        orbits: in order along the curve.
        small: the index of small orbits of a curve that reaches a libration point; of planar ones in the plane, across.
    """

    reason: Reason | None
    statement: IndexStatement
    rests_on: RestsOn
    hypotheses: tuple[Hypothesis, ...]
    orbits: Annotated[tuple[IndexedOrbit, ...], rules(maxItems=100000)] = ()
    small: Annotated[tuple[int, ...], rules(maxItems=2)] = ()


def _counted_orbits(certificate: Certificate) -> tuple[IndexedOrbit, ...]:
    return from_json(tuple[IndexedOrbit, ...], certificate.document["orbits"], "orbits")


SAID: Mapping[str, Callable[[Certificate], Any]] = {
    "orbits": _counted_orbits,
    "small": lambda certificate: tuple(certificate.document.get("small", ())),
    "results": lambda certificate: certificate.orbits,
}
"""What a certificate of an index says besides: the orbits at which it was counted, with their intervals, in order along
the curve; and that of small orbits of a curve that reaches a libration point, of planar ones in the plane, across."""


def extent_of(certificate: Certificate) -> str:
    """Of how many orbits it holds the index, in words."""
    return f"index of {counted(len(certificate.orbits), 'orbit')}"


@dataclass(frozen=True)
class _Known:
    """What the certificate of a curve proves, as far as it stands."""

    atlas: Atlas
    curve: ProvedCurve
    found: ProvedList | None

    @property
    def intervals(self) -> tuple[Interval, ...]:
        return () if self.found is None else intervals_with_orbits(self.atlas, self.curve, self.found)


def indexed_atlas(certificate: Certificate, source: str = "") -> Atlas:
    """What a certificate claims of a curve whose orbits have an index here; `source` names it in errors.

    Raises `InputError` for others, and for one that says "not proved".
    """
    atlas = certificate.atlas
    source = source or f"the certificate {shown(certificate.id)}"
    field, remedy = f"{source}: field statement.atlas", "give the certificate of a curve of symmetric orbits in"
    systems = ", ".join(system.name for system in SYSTEMS)
    curve = symmetric_curve(atlas)
    if curve is None:
        raise InputError(f"{field}.claim.kind: no index is counted of {atlas.claim.kind!r}; {remedy} {systems}")
    if atlas.system not in SYSTEMS:
        raise InputError(f"{field}.system: no index is counted of {atlas.system.name}; {remedy} {systems}")
    if not certificate.proved:
        raise InputError(f"{source}: field verdict: proves no curve; prove it first")
    return curve


def _known(certificate: Certificate) -> _Known:
    """Raises `InputError` for curves whose orbits have no index here, or that are not proved."""
    atlas = indexed_atlas(certificate)
    conclusion = conclude(atlas, certificate.results, follow=follow)
    if not isinstance(conclusion.outcome, Proved):
        raise InputError(f"the certificate {shown(certificate.id)}: proves no curve; prove it first")
    found = None
    if vertical_point(atlas.system) is None and (certificate.document["conclusion"] or {}).get("complete") is not None:
        listed = conclude_list(atlas, on_curve(atlas, certificate.results), conclusion, _ORDER)
        found = listed.outcome.results if isinstance(listed.outcome, Proved) else None
    return _Known(atlas, conclusion.outcome.results, found)


def certified_index(certificate: Certificate, progress: Callable[[float], None] | None = None) -> dict[str, Any]:
    """The certificate of the index along a curve, as JSON; that the curve's certificate stands is presupposed.

    `progress` is called with the share of the orbits that were followed. Raises `InputError` for other curves.
    """
    known = _known(certificate)
    wanted: Sequence[Interval | None] = known.intervals or (None,)
    orbits: list[CountedOrbit] = []
    for number, interval in enumerate(wanted):
        counted = _counted(known, interval)
        if isinstance(counted, str):
            return _document(certificate, known, orbits, counted)
        orbits.append(counted)
        if progress is not None:
            progress((number + 1) / len(wanted))
    return _document(certificate, known, orbits)


def _counted(known: _Known, interval: Interval | None) -> CountedOrbit | str:
    """An orbit in an interval with its half turns, or why there is none."""
    why = "there is no orbit to follow"
    starts: list[tuple[str, Fraction, Start]] = []
    for number, s in places_in(known.curve, interval):
        stretch = known.curve.chain.stretches[number]
        start = start_at(known.atlas, stretch, s)
        if start is not None and len(starts) < _MOST_ORBITS:
            starts.append((stretch.tube.piece.id, s, start))
    # Another orbit costs less than more bits.
    for bits in _BITS:
        for place in tuple(starts):
            piece, s, start = place
            try:
                turns = spared(followed(start, bits, ORACLE), _SPARE)
                if all(each.are_known for each in turns):
                    return CountedOrbit(piece, s, turns)
                why = f"{shown(piece)}, s = {float(s):.6g}: the orbit ends too close to a whole half turn"
            except IntegrationFailure as failure:
                why = f"{shown(piece)}, s = {float(s):.6g}: {failure.reason.message}"
                if not failure.reason.needs_precision:
                    starts.remove(place)
    return why


def _document(
    certificate: Certificate, known: _Known, orbits: Sequence[CountedOrbit], problem: str = ""
) -> dict[str, Any]:
    outcome = conclude_index(known.atlas, known.curve, known.found, orbits, problem)
    reason = None if isinstance(outcome, Proved) else outcome.reason
    rests_on = RestsOn(certificate.id, digest(certificate.document))
    more, words = _told(outcome, known, rests_on)
    document = IndexDocument(
        id=certificate.id, verdict="not proved" if reason else "proved", reason=reason,
        statement=IndexStatement(system=known.atlas.system.title, theorem=words), rests_on=rests_on,
        hypotheses=outcome.hypotheses, **more, software=software(), digest="",
    )  # fmt: skip
    return sealed(document, SCHEMA, ("orbits",))


def _told(outcome: Outcome[ProvedIndex], known: _Known, rests_on: RestsOn) -> tuple[dict[str, Any], str | None]:
    """What is stored of a theorem, and its words."""
    if not isinstance(outcome, Proved):
        return {}, None
    theorem, found = cast(IndexTheorem, outcome.theorem), outcome.results
    ends: list[tuple[IntervalEnd | None, IntervalEnd | None]] = [
        (_listed(known, each.begin), _listed(known, each.end)) for each in found.intervals
    ] or [(None, None)] * len(found.orbits)
    orbits = tuple(
        IndexedOrbit(orbit.piece, orbit.s, orbit.turns, orbit.index, *both)
        for orbit, both in zip(found.orbits, ends, strict=True)
    )
    words = index_in_words(theorem, found, known.curve, rests_on.id, rests_on.digest)
    return {"orbits": orbits, "small": found.small}, words


def _listed(known: _Known, bound: Bound) -> IntervalEnd:
    place = IntervalEnd.of(bound, known.curve.chain)
    return replace(place, interval=(shortened(bound.lower, -1), shortened(bound.upper, 1)))


def form(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether it is about the curve that is given."""
    document, curve = certificate.document, curve_given(given)
    yield from names_its_curve(document, curve)
    if document["id"] != curve.id:
        yield Finding("id", f"is {shown(document['id'])}; the curve is {shown(curve.id)}")
    if document["verdict"] != "proved":
        yield from unknown_reason(document["reason"] or {"condition": ""}, _HYPOTHESES)
        examination.notes += (UNCHECKED_REASON,)


_HYPOTHESES = ("curve", "counts", "parity", "neighbours", "libration-point")


def conclusion(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether it follows from the curve and from the half turns that were counted."""
    document, curve = certificate.document, curve_given(given)
    given.all_stand()
    if document["verdict"] != "proved":
        return
    known = _known(curve)
    expected = IndexTheorem(known.atlas, known.found is not None).hypotheses
    yield from other_hypotheses([each["name"] for each in document["hypotheses"]], expected, document)
    fresh = _document(curve, known, _stored(document))
    examination.hypotheses = len(fresh["hypotheses"])
    yield from in_all_data(document, fresh, examination)


def _stored(document: Mapping[str, Any]) -> tuple[CountedOrbit, ...]:
    orbits = from_json(tuple[IndexedOrbit, ...], document["orbits"], "orbits")
    return tuple(CountedOrbit(orbit.piece, orbit.s, orbit.turns) for orbit in orbits)


def integration(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """The curve was integrated again; the orbits are followed again."""
    document, curve = certificate.document, curve_given(given)
    if document["verdict"] != "proved":
        return
    known = _known(curve)
    for number, orbit in enumerate(_stored(document)):
        place = f"orbits[{number}]"
        stretch = stretch_of(known.curve, orbit.piece, orbit.s)
        start = None if stretch is None else start_at(known.atlas, known.curve.chain.stretches[stretch], orbit.s)
        if start is None:
            yield Finding(place, "is no orbit of the curve that can be followed")
            continue
        yield from _unconfirmed(start, orbit, place)


def _unconfirmed(start: Start, orbit: CountedOrbit, place: str) -> Iterator[Finding]:
    """What other integrations contradict of an orbit, or none of them confirms (section 35.7).

    Raises `CannotBeCheckedError` if the orbit is not followed again.
    """
    stored, why, remaining = numbers(orbit.turns), "", list[Finding]()
    for bits in (*(bits + _MORE_BITS for bits in _BITS), *_BITS):
        try:
            again = numbers(followed(start, bits, ORACLE))
        except IntegrationFailure as failure:
            why = why or failure.reason.message
            continue
        exact = [{key: value for key, value in each.items() if not isinstance(value, arb)} for each in (stored, again)]
        if exact[0] != exact[1]:
            yield Finding(place, "another integration finds other half turns")
            return
        angles = [(f"{place}, {name}", value, again[name]) for name, value in stored.items() if name not in exact[0]]
        if against := [found for name, old, new in angles for found in overlap(old, new, name)]:
            yield from against
            return
        remaining = [found for name, old, new in angles for found in confirmed(old, new, name)]
        if not remaining:
            return
    if not remaining:
        raise CannotBeCheckedError(f"{place}: {why}")
    yield from remaining
