"""Rows of a catalogue, certified by the curve that they lie near (section 32.4)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, Any, Literal

from flint import arb, ctx

from orbitproof.shared.claims.fields import PieceId, Title, Vector
from orbitproof.shared.formats import FIELDS, CatalogueRows, InputError
from orbitproof.shared.stored import Rational, rules
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, TITLE, ReversibleSystem, fits, shown
from orbitproof.verify.branches.its_curve import curve_given, names_its_curve
from orbitproof.verify.branches.kinds import symmetric_curve
from orbitproof.verify.branches.results import on_curve
from orbitproof.verify.certificate import Certificate, Examination, Finding, Given, digest, in_all_data, sealed
from orbitproof.verify.certificate.document import Document, RestsOn
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.curve import conclude
from orbitproof.verify.evidence import Proved, enclose, is_below, software
from orbitproof.verify.orbit_on_curve import PRECISION, OrbitOnCurve, OrbitPlace, OrbitsOfCurve
from orbitproof.verify.words.catalogue import catalogue_in_words

SCHEMA = "catalogue-certificate"

WITHIN = Fraction(1, 10**6)
"""An orbit certifies a row that is no farther from it, unless another distance is given."""

SPATIAL_PROBLEMS: tuple[ReversibleSystem, ...] = (CR3BP, CR3BP_AXIAL, CR3BP_PLANAR)
"""The systems whose orbits catalogues list."""

_STATE = FIELDS[:6]


@dataclass(frozen=True)
class Differences:
    """How far the orbit's numbers are from those of the row, at most: balls that contain the absolute differences.

    Attributes:
        point: of the states, the Euclidean distance.
        stability_index: `None` if the orbit's is not known.
    """

    point: arb
    level: arb
    period: arb
    stability_index: arb | None


@dataclass(frozen=True)
class CertifiedRow:
    """A row of a catalogue, and what the curve says of the orbit that starts near it.

    Attributes:
        number: of the row, from 1.
        given: what the row says: x, y, z, vx, vy, vz, Jacobi constant, period, stability index.
        piece, s, mirrored: the place of the orbit on the curve; nothing if none is shown to start near the row.
        orbit: what is known of it.
        differences: from the row.
        lacks: why none is shown: "functions" or "nearness".
    """

    number: Annotated[int, rules(minimum=1)]
    given: Annotated[Vector, rules(minItems=len(FIELDS), maxItems=len(FIELDS))]
    piece: PieceId | None = None
    s: Fraction | None = None
    mirrored: bool = False
    orbit: OrbitOnCurve | None = None
    differences: Differences | None = None
    lacks: Literal["functions", "nearness"] | None = None


@dataclass(frozen=True, kw_only=True)
class CatalogueStatement:
    """What is stated.

    Attributes:
        title: of the catalogue's family.
        mass_ratio: as the catalogue has it.
        within: an orbit of the curve that starts no farther than that from a row certifies it.
        theorem: in words.
    """

    title: Title
    mass_ratio: Rational
    within: Rational
    theorem: str


@dataclass(frozen=True, kw_only=True)
class CatalogueDocument(Document):
    """Rows of a catalogue, certified by a proved curve.

    Attributes:
        verdict: "proved" if the curve certifies every row.
        rests_on: the certificate of the curve.
        rows: in the order of the catalogue.
    """

    statement: CatalogueStatement
    rests_on: RestsOn
    rows: Annotated[tuple[CertifiedRow, ...], rules(minItems=1, maxItems=1000000)]


def _rows_of(certificate: Certificate) -> tuple[CertifiedRow, ...]:
    return from_json(tuple[CertifiedRow, ...], certificate.document["rows"], "rows")


SAID: Mapping[str, Callable[[Certificate], Any]] = {"rows": _rows_of, "results": _rows_of}
"""What the certificate of a catalogue says besides: its rows, in the order of the catalogue."""


def certified_of(certificate: Certificate) -> str:
    """How many rows are certified, in words."""
    return f"{sum(row.orbit is not None for row in certificate.rows)} of {len(certificate.rows)} rows"


def certified_rows(curve: Certificate, catalogue: CatalogueRows, within: Fraction = WITHIN) -> dict[str, Any]:
    """The certificate of a catalogue, as JSON, by a curve that is proved; that its certificate stands is presupposed.

    Raises `InputError` if the curve is none of the catalogue's system, or not proved, or the family has no title.
    """
    check_title(catalogue)
    orbits = orbits_of(curve)
    mass = orbits.atlas.parameters.get("mu")
    if mass != catalogue.mass_ratio:
        raise InputError(f"the curve {shown(curve.id)}: about another mass parameter than the catalogue; give its own")
    rows = tuple(
        _row(orbits, CertifiedRow(number, given), None, within) for number, given in enumerate(catalogue.rows, start=1)
    )
    return _document(curve, catalogue.title, within, rows)


def check_title(catalogue: CatalogueRows) -> None:
    """Raises `InputError` if the family of a catalogue has no title."""
    if not fits(TITLE, catalogue.title):
        words = "give letters, digits and signs such as . , ' ( ) + - * / ^ =, and no sentences"
        raise InputError(f"the catalogue's family, {catalogue.title[:60]!r}: is no title; {words}")


def orbits_of(curve: Certificate) -> OrbitsOfCurve:
    """The orbits of a certified curve of the three-body problem, one by one. Raises `InputError` for other curves."""
    atlas = symmetric_curve(curve.atlas)
    if atlas is None or atlas.system not in SPATIAL_PROBLEMS:
        known = ", ".join(system.name for system in SPATIAL_PROBLEMS)
        raise InputError(f"the certificate {shown(curve.id)}: is of no curve in {known}; give the family of the rows")
    results = on_curve(atlas, curve.results)
    conclusion = conclude(atlas, results)
    if not (curve.proved and isinstance(conclusion.outcome, Proved)):
        raise InputError(f"the certificate {shown(curve.id)}: proves no curve; prove it first")
    return OrbitsOfCurve.of(atlas, conclusion.outcome.results, results)


def _row(orbits: OrbitsOfCurve, row: CertifiedRow, place: OrbitPlace | None, within: Fraction) -> CertifiedRow:
    """A row with the orbit at a place, or without one at the place next to it."""
    row = CertifiedRow(row.number, row.given)
    state = dict(zip(_STATE, row.given, strict=False))
    place = orbits.near(state) if place is None else place
    try:
        orbit = orbits.at(place)
    except ValueError:
        return replace(row, lacks="functions")
    distance = orbits.distance(orbit, state)
    if not is_below(distance, enclose(within)):
        return replace(row, lacks="nearness")
    level, period, index = row.given[6:]
    with ctx.workprec(PRECISION):
        off = None if orbit.stability_index is None else abs(orbit.stability_index - enclose(index))
        from_row = Differences(distance, abs(orbit.level - enclose(level)), abs(orbit.period - enclose(period)), off)
    return replace(row, piece=place.piece, s=place.s, mirrored=place.mirrored, orbit=orbit, differences=from_row)


def _document(curve: Certificate, title: str, within: Fraction, rows: tuple[CertifiedRow, ...]) -> dict[str, Any]:
    mass, rests_on = curve.atlas.parameters["mu"], RestsOn(curve.id, digest(curve.document))
    found = [row.number for row in rows if row.orbit is not None]
    words = catalogue_in_words(curve.atlas, rests_on.id, rests_on.digest, len(found), len(rows), within)
    statement = CatalogueStatement(title=title, mass_ratio=mass, within=within, theorem=words)
    document = CatalogueDocument(
        id=curve.id, verdict="proved" if len(found) == len(rows) else "not proved", statement=statement,
        rests_on=rests_on, rows=rows, software=software(), digest="",
    )  # fmt: skip
    return sealed(document, SCHEMA)


def form(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether it is about the curve that is given, and its rows are in order."""
    document = certificate.document
    yield from names_its_curve(document, curve_given(given))
    numbers = [row["number"] for row in document["rows"]]
    if numbers != list(range(1, len(numbers) + 1)):
        yield Finding("rows", "are not numbered one after the other")


def conclusion(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether it follows from the curve and the places of the orbits."""
    document, curve = certificate.document, curve_given(given)
    given.all_stand()
    read = from_json(CatalogueDocument, {k: v for k, v in document.items() if k not in ("format", "version")}, "")
    orbits = orbits_of(curve)
    again = tuple(_row(orbits, row, _place(row), read.statement.within) for row in read.rows)
    fresh = _document(curve, read.statement.title, read.statement.within, again)
    examination.hypotheses = len(again)
    yield from in_all_data(document, fresh, examination)


def _place(row: CertifiedRow) -> OrbitPlace | None:
    return None if row.piece is None or row.s is None else OrbitPlace(row.piece, row.s, row.mirrored)


def integration(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Nothing here rests on an integration but the curve, which was integrated again."""
    yield from ()
