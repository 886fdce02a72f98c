"""A claim that is not proved on its box, on boxes that its failures ask for (section 10.3)."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import BoxClaim, claim_from_json
from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.attempt import Limits
from orbitproof.verify.attempt.boxes import box_asked_for
from orbitproof.verify.certificate import Certificate, certify, digest, is_proof_of

_SHOWN_DIGITS = 4


def certify_on_some_box(
    claim: BoxClaim, limits: Limits, progress: Callable[[float, str], None] | None = None
) -> Certificate:
    """The certificate of a claim, or, if it is not proved and the same claim on a box that is tried then is, of that.

    A certificate is about the box in its statement. If that is not the box of the claim, the certificate says which
    half-widths were given. If none is proved, it is that of the claim as it was given.
    """
    start = time.process_time()
    first = found = certify(claim, limits, progress)
    tried, last = {claim.radii}, claim
    while not found.proved and len(tried) <= limits.other_boxes:
        left = None if limits.timeout is None else limits.timeout - (time.process_time() - start)
        radii = _next_box(last, found)
        if radii is None or radii in tried or (left is not None and left <= 0):
            break
        tried.add(radii)
        last = replace(claim, radii=radii)
        found = certify(last, replace(limits, timeout=left), progress)
    if not found.proved or found is first:
        return first
    return _made(found, claim, time.process_time() - start)


def _next_box(claim: BoxClaim, failed: Certificate) -> tuple[Fraction, ...] | None:
    statement = failed.statement
    form = claim_from_json(statement["level_form"], "level_form") if "level_form" in statement else claim
    reason = failed.reason
    return None if reason is None else box_asked_for(claim, reason, failed.hypotheses, form.radii)


def _made(found: Certificate, claim: BoxClaim, seconds: float) -> Certificate:
    entry = found.to_json()
    computation = replace(found.computation, given_radii=claim.radii, seconds=round(seconds, 3))
    entry["computation"] = to_json(computation)
    return Certificate.from_json(entry | {"digest": digest(entry)}, f"certificate {found.id!r}")


def given_radii(certificate: Certificate) -> tuple[Fraction, ...] | None:
    """The half-widths that the claim was given with, if another box was tried instead; `None` otherwise."""
    return certificate.computation.given_radii


def answers(certificate: Certificate, claim: BoxClaim) -> bool:
    """Whether a stored certificate proves this claim, on its box or on one that was tried in its place."""
    if given_radii(certificate) != claim.radii:
        return is_proof_of(certificate, claim)
    return is_proof_of(certificate, replace(claim, radii=_radii(certificate)))


def remark(certificate: Certificate) -> str | None:
    """A line about the box that a certificate is about, if it is not the one that was given."""
    given = given_radii(certificate)
    if given is None:
        return None
    pairs = list(zip(given, _radii(certificate), strict=True))
    axes = ", ".join(f"P_{i} {_short(old)} -> {_short(new)}" for i, (old, new) in enumerate(pairs) if old != new)
    inside, around = (all(new <= old for old, new in pairs), all(new >= old for old, new in pairs))
    where = "inside the one given" if inside else "around the one given" if around else "about the same centre"
    return f"the box in the certificate is another, {where}: half-widths {axes}"


def _radii(certificate: Certificate) -> tuple[Fraction, ...]:
    candidate: Any = certificate.statement["candidate"]
    return tuple(parse_exact(text) for text in candidate["radii"])


def _short(radius: Fraction) -> str:
    return f"{float(radius):.{_SHOWN_DIGITS}g}"
