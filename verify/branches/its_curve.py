"""The curve that the certificate of an index or of a catalogue's rows rests on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import Certificate, Finding, Given, digest


def its_curve(certificate: Certificate, given: Sequence[Certificate]) -> tuple[Certificate, ...]:
    """The curve among certificates: the one with its digest, of its id, or the only one. Raises `InputError`."""
    stored = certificate.document["rests_on"]
    curves = [each for each in given if each.key[0] == "arc"]
    found = [each for each in curves if each.digest == stored["digest"]]
    found = found or [each for each in curves if each.id == stored["id"]] or (curves if len(curves) == 1 else [])
    if not found:
        where = f"rests on the curve {shown(stored['id'])} ({stored['digest']})"
        raise InputError(f"the certificate {certificate.called}: {where}, which is not given; give its file")
    return (found[0],)


def curve_given(given: Given) -> Certificate:
    """The certificate of the curve, which is the one that is given."""
    (curve,) = given.certificates
    return curve


def names_its_curve(document: Mapping[str, Any], curve: Certificate) -> Iterator[Finding]:
    """Whether a certificate names the curve that is given, by its id and digest."""
    given, stored = {"id": curve.id, "digest": digest(curve.document)}, document["rests_on"]
    if stored != given:
        words = f"rests on the curve {shown(stored['id'])} ({stored['digest']}); given is {shown(curve.id)}"
        yield Finding("rests_on", f"{words} ({given['digest']})")
