"""Certificates checked again, of any kind (section 13); and the three levels of those of candidates.

The form: digest, schema, the names of the hypotheses. The conclusion: every hypothesis is evaluated again from the
stored tables of derivatives, by the functions that made the certificate, and the certificate that results is compared
with the stored one in all data; its words are those that are told. The integration: the tables are enclosed again, at
another precision and order; they have to prove the claim again, and to lie within the stored ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from orbitproof.shared.formats import BoxClaim, Candidate, claim_from_json, validate_document
from orbitproof.shared.systems import SYSTEMS, shown
from orbitproof.verify.certificate.certificate import (
    Certificate,
    certified,
    digest,
    rows_document,
    schema_of,
)
from orbitproof.verify.certificate.document import Computation
from orbitproof.verify.certificate.earlier import taken_names
from orbitproof.verify.certificate.kind import Given
from orbitproof.verify.certificate.kinds import (
    Found,
    Results,
    check_exactly,
    contradictions,
    enclose,
    kind_named,
    level_form,
    prove,
    tables_from_json,
    theorem_of,
    unconfirmed,
)
from orbitproof.verify.certificate.levels import (
    Examination,
    Finding,
    Level,
    NothingToCheckError,
    Recheck,
    climb,
    differences,
    other_hypotheses,
    other_software,
    unknown_reason,
)
from orbitproof.verify.certificate.own_box import broken_off, for_origin
from orbitproof.verify.certificate.stated_system import named_as, systems_with
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.evidence import (
    GREATEST_PRECISION,
    LEAST_PRECISION,
    Checklist,
    IntegrationFailure,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    guarded,
    quoted_name,
)
from orbitproof.verify.poincare import PHYSICAL, REGULARISED, IntegratorSettings

_MORE_PRECISION = 8
_LEAST_MORE_PRECISION = 32
_MORE_ORDER = 6
"""The second integration has an eighth more bits, and a sixth more terms in time."""

_STILL_MORE_PRECISION = 64
"""What it does not confirm is enclosed once more, with so many more bits and in the stored coordinates, then with
these at the stored order, and at last as it was."""

CertificateJson = Mapping[str, Any]
"""A certificate as JSON."""

_WITHOUT_INTEGRATION = ("symmetries", "frames", "adapted-frames")

_NOTHING_STORED = "nothing is stored from which it could be evaluated"

_WORDS = ("theorem", "in_full")
"""What a statement has if its claim is proved."""

UNCHECKED_REASON = "it claims nothing, and why it is not proved is told as by the run, which nothing checks"
"""What is said of a certificate that proves nothing."""

NOT_INTEGRATED = "nothing was integrated again: it stores no {what}"
"""What is said of one that there is nothing to integrate of."""


def recheck(
    certificate: Certificate,
    integrate: bool = False,
    progress: Callable[[float], None] | None = None,
    given: Given | None = None,
) -> Recheck:
    """Check a certificate of any kind again, up to the conclusion; with `integrate`, the last level too.

    One that rests on others is checked as far as these were, which `given` says, whatever `integrate` is. An exception
    of any kind is a finding: what could not be checked does not stand. Raises `ValueError` if a check that is given is
    that of another certificate.
    """
    given = Given(progress=progress) if given is None else given
    below = [given.check_of(entry) for entry in given.certificates] if given.checks else []
    if below:
        fallen = not all(check.stands_without_place for check in below)
        reached = max(Level.CONCLUSION if fallen else Level.FORM, min(check.level for check in below))
    else:
        reached = Level.INTEGRATION if integrate else Level.CONCLUSION
    return climb(certificate.document, [partial(_level, number, certificate, given) for number in range(reached)])


def _level(number: int, certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """One of the levels, from 0 on; a form fits its schema and its digest, whatever the kind."""
    if number == 0:
        yield from digest_findings(certificate.document)
        document = certificate.document
        is_row = "format" not in document
        wrapped = {**rows_document([document]), "software": {}} if is_row else document
        validate_document(wrapped, "certificates" if is_row else schema_of(document), "the certificate")
    elif number == 2 and given.checks:
        examination.precision = min(check.precision for check in given.checks.values())
    levels = kind_named(certificate.kind).levels or (_form, _conclusion, _integration)
    yield from levels[number](certificate, given, examination)


def digest_findings(document: Mapping[str, Any]) -> Iterator[Finding]:
    """Whether a certificate of any kind was changed after it was written."""
    if "digest" not in document:
        yield Finding("digest", "is missing; prove the claim again to have a certificate that can be checked")
    elif document["digest"] != digest(document):
        yield Finding("digest", "does not fit the content: the certificate was changed after it was written")


@dataclass(frozen=True)
class _Stated:
    """A certificate's claim and tables, read.

    Attributes:
        candidate: the claim.
        form: its level form, if the hypotheses are about that.
        enclosures: the tables, if there are any.
    """

    candidate: BoxClaim
    form: Candidate | None
    enclosures: Found | None

    @property
    def claim(self) -> BoxClaim:
        """What the hypotheses are about."""
        return self.form or self.candidate


def _read(certificate: CertificateJson) -> _Stated:
    """Raises `ValueError` or `InputError` for what cannot be read, `CannotBeCheckedError` as `systems_with`."""
    statement = certificate["statement"]
    entry = statement["candidate"]
    document = {"format": "orbitproof-candidates", "version": 1, "candidates": [entry]}
    validate_document(document, "candidates", "statement.candidate")
    systems = systems_with(SYSTEMS, statement, entry)
    candidate = claim_from_json(dict(entry), "statement.candidate", systems)
    form = level_form(candidate) if "level_form" in statement else None
    return _Stated(candidate, form, _stored_enclosures(certificate, candidate))


def _stored_enclosures(certificate: CertificateJson, candidate: BoxClaim) -> Found | None:
    entry, computation = certificate.get("enclosures"), _computation(certificate)
    if entry is None:
        return None
    if not LEAST_PRECISION <= computation.precision <= GREATEST_PRECISION:
        raise ValueError(f"computation.precision: {computation.precision} bits are not possible")
    if not 1 <= computation.order <= GREATEST_PRECISION:
        raise ValueError(f"computation.order: {computation.order} is not possible")
    return tables_from_json(entry, candidate, computation)


def _computation(certificate: CertificateJson) -> Computation:
    return from_json(Computation, certificate["computation"], "computation")


def _form(entry: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    certificate = entry.document
    stated = examination.stated = _read(certificate)
    yield from taken_names(stated.candidate.system, certificate["software"])
    theorem = theorem_of(stated.candidate, stated.form)
    names = tuple(hypothesis["name"] for hypothesis in certificate["hypotheses"])
    if certificate["verdict"] != "proved":
        known = () if isinstance(theorem, Reason) else theorem.hypotheses
        yield from unknown_reason(certificate["reason"], known)
        if names != known[: len(names)]:
            stored = ", ".join(map(quoted_name, names))
            yield Finding("hypotheses", f"stored are {stored}; the theorem takes {', '.join(known)}")
        return
    if stated.enclosures is None:
        yield Finding("enclosures", "there are none, so nothing shows that the claim is proved")
    if isinstance(theorem, Reason):
        yield Finding("statement.candidate", f"{theorem.message}: {theorem.remedy}")
        return
    yield from other_hypotheses(names, theorem.hypotheses, certificate)


def _conclusion(entry: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    certificate, stated = entry.document, examination.stated
    again = _derived(certificate, stated)
    examination.hypotheses = len(again["hypotheses"])
    if stated.candidate.system.name not in SYSTEMS:
        examination.notes += (f"{stated.candidate.system.name}: {UNKNOWN}",)
    if certificate["verdict"] != "proved":
        examination.notes += (UNCHECKED_REASON,)
    if "place" in certificate:
        curve = certificate["place"]["rests_on"]
        examination.open_place = (
            f"its place rests on the curve {shown(curve['id'])} ({curve['digest']}): give its certificate as `curve`"
        )
    kept = {key: certificate[key] for key in ("software", "digest", "place") if key in certificate}
    found = _compare(certificate, again, stated.enclosures is not None)
    data = list(examination.in_data(found, {**again, **kept}))
    yield from data
    if data:
        yield from other_software(certificate)


def derived(certificate: CertificateJson) -> dict[str, Any]:
    """The certificate that follows from the claim and the tables of one. Raises as reading them does."""
    return _derived(certificate, _read(certificate))


def _derived(certificate: CertificateJson, stated: _Stated) -> dict[str, Any]:
    computation = _computation(certificate)
    precision = computation.precision
    outcome = _conclude(stated.claim, precision if stated.enclosures else LEAST_PRECISION, stated.enclosures)
    if stated.form is not None:
        outcome = for_origin(stated.candidate, outcome, precision)
    again = certified(stated.candidate, outcome, computation, stated.enclosures, stated.form)
    return {**again, "statement": named_as(certificate["statement"], again["statement"])}


UNKNOWN = "not known here; checked as the file's own program describes it, its name is a name only"
"""What is said of a system that this installation does not know."""


def _conclude(candidate: BoxClaim, precision: int, enclosures: Found | None) -> Outcome[Results]:
    """What follows from `enclosures`; without them, from what needs none."""
    checklist = Checklist()
    with guarded(precision):
        try:
            check_exactly(checklist, candidate)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        return prove(candidate, checklist, enclosures)


def _compare(stored: CertificateJson, again: CertificateJson, from_tables: bool) -> Iterator[Finding]:
    """Differences between a certificate and the one that its tables give."""
    yield from differences(stored["id"], again["id"], "id")
    is_proved = stored["verdict"] == again["verdict"] == "proved"
    left, right = (
        {key: value for key, value in entry["statement"].items() if is_proved or key not in _WORDS}
        for entry in (stored, again)
    )
    yield from differences(left, right, "statement", ("statement",))
    old, new = stored["hypotheses"], again["hypotheses"]
    if from_tables:
        yield from _verdict_differences(stored, again)
        if len(old) != len(new):
            names = (", ".join(quoted_name(entry["name"]) for entry in entries) for entries in (old, new))
            yield Finding("hypotheses", "stored are {}; evaluated again: {}".format(*names))
    elif len(old) > len(new):
        yield Finding(f"hypothesis {quoted_name(old[len(new)]['name'])}", _NOTHING_STORED)
    for left, right in zip(old, new, strict=False):
        if from_tables or right["name"] in _WITHOUT_INTEGRATION:
            yield from differences(left, right, f"hypothesis {right['name']}", ("hypotheses",))
        elif left["holds"] != right["holds"]:
            yield Finding(f"hypothesis {right['name']}", _NOTHING_STORED)
    if is_proved:
        yield from differences(stored["results"], again["results"], "results")


def _verdict_differences(stored: CertificateJson, again: CertificateJson) -> Iterator[Finding]:
    if stored["verdict"] != again["verdict"]:
        reason = again["reason"]
        found = f": {reason['condition']}: {reason['message']}" if reason else ""
        yield Finding("verdict", f"stored is {stored['verdict']!r}, but the tables give {again['verdict']!r}{found}")
    elif stored["reason"] and stored["reason"]["condition"] not in ("time", again["reason"]["condition"]):
        yield Finding(
            "reason", f"stored is {stored['reason']['condition']!r}, the tables give {again['reason']['condition']!r}"
        )


def _integration(entry: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether other integrations contradict nothing that is stored, prove the claim again, and confirm all of it.

    Each enclosure has to be confirmed by one of them; what is said of hypotheses and results follows from these.
    """
    certificate, stated = entry.document, examination.stated
    stored = stated.enclosures
    if stored is None:
        raise NothingToCheckError(NOT_INTEGRATED.format(what="enclosures"))
    remaining: dict[str, Finding] = {}
    for number, settings in enumerate(_settings(stored)):
        place = f"integration with {settings.precision} bits and order {settings.order}"
        examination.precision = examination.precision or settings.precision
        try:
            with np.errstate(all="ignore"):
                fresh = enclose(stated.claim, settings, given.progress)
        except IntegrationFailure as error:
            yield Finding(place, error.reason.message)
            return
        except Exception as error:
            yield Finding(place, broken_off("integration", error).message)
            return
        if against := list(contradictions(stored, fresh, place)):
            yield from against
            return
        found = {finding.place: finding for finding in unconfirmed(stored, fresh, "not confirmed")}
        if certificate["verdict"] == "proved":
            outcome = _conclude(stated.claim, settings.precision, fresh)
            if stated.form is not None:
                outcome = for_origin(stated.candidate, outcome, settings.precision)
            if not isinstance(outcome, Proved):
                reason = outcome.reason
                yield Finding(place, f"the claim is not proved again: {reason.condition}: {reason.message}")
                return
        remaining = {key: finding for key, finding in found.items() if number == 0 or key in remaining}
        if not remaining:
            return
    yield from remaining.values()


def _settings(stored: Found) -> Iterator[IntegratorSettings]:
    """The settings of the integrations, one after the other.

    The first may choose other coordinates than those of the stored tables; the third has their order too: in other
    coordinates, and in a higher order, true enclosures can be wider. The last is the one that the certificate says it
    was made with: more bits do not make every bound smaller.
    """
    more = stored.precision + max(_LEAST_MORE_PRECISION, stored.precision // _MORE_PRECISION)
    higher = stored.order + max(1, stored.order // _MORE_ORDER)
    coordinates = PHYSICAL if stored.coordinates == PHYSICAL else REGULARISED
    yield IntegratorSettings(more, higher)
    yield IntegratorSettings(more + _STILL_MORE_PRECISION, higher, coordinates=coordinates)
    yield IntegratorSettings(more + _STILL_MORE_PRECISION, stored.order, coordinates=coordinates)
    yield IntegratorSettings(stored.precision, stored.order, coordinates=coordinates)
