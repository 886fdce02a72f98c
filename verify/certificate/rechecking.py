"""Certificates checked again (section 13): from what they carry, or by another integration.

The first level integrates nothing. It evaluates every hypothesis again from the stored tables of
derivatives, by the functions that made the certificate, and compares all that is stored with what
comes out. The second level encloses the tables again, at another precision and order: the new
enclosures have to overlap the stored ones and to prove the claim again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb

from orbitproof.shared.formats import Candidate, InputError, candidate_from_json, validate_document
from orbitproof.verify.bifurcation import BifurcationResults, check_exactly, level_form, prove
from orbitproof.verify.certificate.certificate import Certificate, digest, make_certificate
from orbitproof.verify.certificate.certify import (
    GREATEST_PRECISION,
    LEAST_PRECISION,
    broken_off,
    for_origin,
)
from orbitproof.verify.certificate.tables import derivative_name, tables_from_json
from orbitproof.verify.evidence import (
    Checklist,
    IntegrationFailure,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    ball_from_json,
    decimal_interval,
    guarded,
    software,
)
from orbitproof.verify.poincare import DerivativeTable, Enclosures, IntegratorSettings, enclose_iterates

_MORE_PRECISION = 8
_LEAST_MORE_PRECISION = 32
_MORE_ORDER = 6
"""The second integration has an eighth more bits, and a sixth more terms in time."""

Entry = dict[str, Any]
"""A certificate as JSON."""

_WITHOUT_INTEGRATION = ("symmetries", "frames", "adapted-frames")


@dataclass(frozen=True)
class Finding:
    """Something in a certificate that is not as it should be: where it stands, and what is wrong."""

    place: str
    message: str


@dataclass(frozen=True)
class Recheck:
    """What checking one certificate again has shown; it stands if there is no finding.

    Attributes:
        id: the certificate's id.
        verdict: the stored verdict.
        hypotheses: how many hypotheses were evaluated again.
        findings: everything that is not as it should be, in the order of checking.
        precision: bits of the second integration, 0 without one.
    """

    id: str
    verdict: str
    hypotheses: int
    findings: tuple[Finding, ...]
    precision: int = 0

    @property
    def stands(self) -> bool:
        """Whether all that was checked is as it should be."""
        return not self.findings


def recheck(
    certificate: Certificate, integrate: bool = False, progress: Callable[[float], None] | None = None
) -> Recheck:
    """Check a certificate again; with `integrate`, the second level too.

    An exception of any kind is a finding: what could not be checked does not stand.
    """
    try:
        return _recheck(certificate.to_json(), integrate, progress)
    except Exception as error:
        finding = Finding("the check", broken_off("check", error).message)
        return Recheck(certificate.id, certificate.verdict, 0, (finding,))


def _recheck(certificate: Entry, integrate: bool, progress: Callable[[float], None] | None) -> Recheck:
    name, verdict = str(certificate["id"]), str(certificate["verdict"])
    findings = list(_digest_findings(certificate))
    try:
        candidate = candidate_from_json(_stored_candidate(certificate), "statement.candidate")
        form = level_form(candidate) if "level_form" in certificate["statement"] else None
        stored = _stored_enclosures(certificate, candidate)
    except (InputError, ValueError) as error:
        return Recheck(name, verdict, 0, (*findings, Finding("the certificate", str(error))))
    if verdict == "proved" and stored is None:
        findings.append(Finding("enclosures", "there are none, so nothing shows that the claim is proved"))
        return Recheck(name, verdict, 0, tuple(findings))
    precision = certificate["computation"]["precision"]
    claim = form or candidate
    outcome = _conclude(claim, precision if stored else LEAST_PRECISION, stored)
    if form is not None:
        outcome = for_origin(candidate, outcome, precision)
    again = make_certificate(candidate, outcome, certificate["computation"], stored, form).to_json()
    differences = list(_compare(certificate, again, stored is not None))
    findings += [*differences, *_other_software(certificate)] if differences else []
    if not integrate or stored is None or findings:
        return Recheck(name, verdict, len(outcome.hypotheses), tuple(findings))
    settings = IntegratorSettings(
        precision + max(_LEAST_MORE_PRECISION, precision // _MORE_PRECISION),
        stored.order + max(1, stored.order // _MORE_ORDER),
    )
    findings += _integrate_again(certificate, claim, stored, settings, progress)
    return Recheck(name, verdict, len(outcome.hypotheses), tuple(findings), settings.precision)


def _digest_findings(certificate: Entry) -> Iterator[Finding]:
    if "digest" not in certificate:
        yield Finding("digest", "is missing; verify the candidates again to have certificates that can be checked")
    elif certificate["digest"] != digest(certificate):
        yield Finding("digest", "does not fit the content: the certificate was changed after it was written")


def _stored_candidate(certificate: Entry) -> dict[str, Any]:
    """The candidate of the statement. Raises `ValueError` if it does not fit the schema of candidates."""
    entry = certificate["statement"]["candidate"]
    document = {"format": "orbitproof-candidates", "version": 1, "candidates": [entry]}
    validate_document(document, "candidates", "statement.candidate")
    return dict(entry)


def _stored_enclosures(certificate: Entry, candidate: Candidate) -> Enclosures | None:
    entry, computation = certificate.get("enclosures"), certificate["computation"]
    if entry is None:
        return None
    if not LEAST_PRECISION <= computation["precision"] <= GREATEST_PRECISION:
        raise ValueError(f"computation.precision: {computation['precision']} bits are not possible")
    if not 1 <= computation["order"] <= GREATEST_PRECISION:
        raise ValueError(f"computation.order: {computation['order']} is not possible")
    return tables_from_json(entry, len(candidate.radii), computation)


def _conclude(candidate: Candidate, precision: int, enclosures: Enclosures | None) -> Outcome[BifurcationResults]:
    """What follows from `enclosures`; without them, from what needs none."""
    checklist = Checklist()
    with guarded(precision):
        try:
            check_exactly(checklist, candidate)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        if enclosures is None:
            return prove(candidate, checklist, (), None)
        return prove(candidate, checklist, enclosures.iterates, enclosures.first_integral, enclosures.return_times)


def _compare(stored: Entry, again: Entry, from_tables: bool) -> Iterator[Finding]:
    """Differences between a certificate and the one that its tables give."""
    yield from _differences(stored["id"], again["id"], "id")
    claim = {key: value for key, value in stored["statement"].items() if key != "theorem"}
    expected = {key: value for key, value in again["statement"].items() if key != "theorem"}
    yield from _differences(claim, expected, "statement")
    old, new = stored["hypotheses"], again["hypotheses"]
    if from_tables:
        yield from _verdict_differences(stored, again)
        if len(old) != len(new):
            names = (", ".join(entry["name"] for entry in entries) for entries in (old, new))
            yield Finding("hypotheses", "stored are {}; evaluated again: {}".format(*names))
    elif len(old) > len(new):
        yield Finding(f"hypothesis {old[len(new)]['name']}", "nothing is stored from which it could be evaluated")
    for left, right in zip(old, new, strict=False):
        if from_tables or right["name"] in _WITHOUT_INTEGRATION:
            yield from _differences(left, right, f"hypothesis {right['name']}")
    if stored["verdict"] == "proved" and again["verdict"] == "proved":
        yield from _differences(stored["statement"].get("theorem"), again["statement"]["theorem"], "theorem")
        yield from _differences(stored["results"], again["results"], "results")


def _other_software(certificate: Entry) -> Iterator[Finding]:
    """What may explain differences: another version rounds or words differently."""
    made_by = certificate.get("software", {})
    other = [f"{name} {made_by.get(name)}, here {version}" for name, version in software().items()
             if made_by.get(name) != version]  # fmt: skip
    if other:
        yield Finding("software", f"the certificate was made with {'; '.join(other)}: verify the candidates again")


def _verdict_differences(stored: Entry, again: Entry) -> Iterator[Finding]:
    if stored["verdict"] != again["verdict"]:
        reason = again["reason"]
        found = f": {reason['condition']}: {reason['message']}" if reason else ""
        yield Finding("verdict", f"stored is {stored['verdict']!r}, but the tables give {again['verdict']!r}{found}")
    elif stored["reason"] and stored["reason"]["condition"] not in ("time", again["reason"]["condition"]):
        yield Finding(
            "reason", f"stored is {stored['reason']['condition']!r}, the tables give {again['reason']['condition']!r}"
        )


def _differences(stored: Any, again: Any, place: str) -> Iterator[Finding]:
    """Where two JSON values differ; a ball is one value."""
    if stored == again and type(stored) is type(again):
        return
    if isinstance(stored, dict) and isinstance(again, dict) and "rad" not in stored:
        for key in sorted({*stored, *again}):
            inner = f"{place}, {key}"
            if key not in stored:
                yield Finding(inner, "is missing")
            elif key not in again:
                yield Finding(inner, "does not belong here")
            else:
                yield from _differences(stored[key], again[key], inner)
        return
    yield Finding(place, f"stored is {_shown(stored)}, evaluated again it is {_shown(again)}")


def _shown(value: Any) -> str:
    if isinstance(value, dict) and {"mid", "rad"} <= set(value):
        try:
            return decimal_interval(ball_from_json(value), _SHOWN_DIGITS)
        except ValueError:
            return "not a ball"
    text = repr(value)
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]} ..."


_SHOWN_DIGITS = 45
_LONGEST_SHOWN = 100


def _integrate_again(
    certificate: Entry,
    candidate: Candidate,
    stored: Enclosures,
    settings: IntegratorSettings,
    progress: Callable[[float], None] | None,
) -> Iterator[Finding]:
    """Whether another integration gives enclosures that overlap the stored ones and prove the claim."""
    place = f"integration with {settings.precision} bits and order {settings.order}"
    try:
        with np.errstate(all="ignore"):
            fresh = enclose_iterates(candidate, settings, progress)
    except IntegrationFailure as error:
        yield Finding(place, error.reason.message)
        return
    except Exception as error:
        yield Finding(place, broken_off("integration", error).message)
        return
    tables = list(_pairs(stored, fresh))
    if len(tables) != sum(len(components) for components in stored.iterates) + (stored.first_integral is not None):
        yield Finding(place, "the tables do not belong to each other")
    for name, old, new in tables:
        for part, before, now in (("box", old.box, new.box), ("centre", old.centre, new.centre)):
            for index, ball in before.items():
                yield from _overlap(ball, now[index], f"{place}, {derivative_name(index)} of {name}, {part}")
    if len(stored.return_times) != len(fresh.return_times):
        yield Finding(place, "another number of crossings")
    for number, (left, right) in enumerate(zip(stored.return_times, fresh.return_times, strict=False), start=1):
        yield from _overlap(left, right, f"{place}, time of crossing {number}")
    if certificate["verdict"] != "proved":
        return
    outcome = _conclude(candidate, settings.precision, fresh)
    if not isinstance(outcome, Proved):
        yield Finding(place, f"the claim is not proved again: {outcome.reason.condition}: {outcome.reason.message}")
        return
    results, found = certificate["results"], outcome.results
    if results["side"] != found.side:
        yield Finding(f"{place}, side", f"stored is {results['side']!r}, found {found.side!r}")
    yield from _overlap(ball_from_json(results["parameter"]), found.parameter, f"{place}, {found.parameter_name}")
    for group, balls in (("point", found.point), ("normal_form", found.normal_form)):
        for name, ball in balls.items():
            if name in results[group]:
                yield from _overlap(ball_from_json(results[group][name]), ball, f"{place}, {name}")


def _pairs(stored: Enclosures, fresh: Enclosures) -> Iterator[tuple[str, DerivativeTable, DerivativeTable]]:
    for i, (old, new) in enumerate(zip(stored.iterates, fresh.iterates, strict=False), start=1):
        for j, (left, right) in enumerate(zip(old, new, strict=False), start=1):
            yield f"q_{j}(P^{i})", left, right
    if stored.first_integral is not None and fresh.first_integral is not None:
        yield "the first integral", stored.first_integral, fresh.first_integral


def _overlap(stored: arb, fresh: arb, place: str) -> Iterator[Finding]:
    if stored.overlaps(fresh) is not True or not fresh.is_finite():
        shown = (decimal_interval(ball, _SHOWN_DIGITS) for ball in (stored, fresh))
        yield Finding(place, "stored is {}, disjoint from {}".format(*shown))
