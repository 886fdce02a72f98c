"""Where certified orbits lie on a curve that is proved (sections 15.8 and 19.6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import shown
from orbitproof.verify.branches.certified import certified_point
from orbitproof.verify.branches.curve_conclusion import follow, partner
from orbitproof.verify.branches.kinds import kind_of
from orbitproof.verify.certificate import (
    REWORDED,
    Certificate,
    Examination,
    Finding,
    Level,
    Recheck,
    differences,
    digest,
    recheck,
)
from orbitproof.verify.curve import Bifurcation, conclude
from orbitproof.verify.evidence import ball_to_json, located
from orbitproof.verify.words.place import place_in_words

_DIGITS = 18


@dataclass(frozen=True)
class Placed:
    """A certificate with its place on a curve.

    Attributes:
        certificate: carries the place, or none if it is not shown.
        line: the same in words, for the command line.
    """

    certificate: Certificate
    line: str


def places_on(curve: Certificate, orbits: Sequence[Certificate]) -> list[Placed]:
    """Each certified orbit with the piece of the curve on which it lies, and its s; or with the reason why not shown.

    The certificate of the curve is checked up to its conclusion first, and so is each orbit's.
    """
    examined = recheck(curve) if kind_of(curve.atlas).holds_points else None
    return [Placed(entry.with_place(place), line) for entry, place, line in _placed(curve, examined, orbits)]


def recheck_place(
    curve: Certificate | None, examined: Recheck | None, certificate: Certificate, check: Recheck
) -> Recheck:
    """What checking a certificate again has shown, with the place that it carries.

    Args:
        curve: the certificate that the place rests on; without it it cannot be checked.
        examined: that one, checked as far as the other; without it, or if it is a surface, no place is shown.
        check: of the certificate, which leaves its place open.

    Raises `ValueError` if `examined` is the check of another certificate than the curve's.
    """
    place = certificate.to_json().get("place")
    if curve is None or place is None or not check.stands_without_place:
        return check
    if examined is not None and examined.stands and examined.digest != digest(curve.document):
        raise ValueError(f"examined: is the check of {examined.id!r}, and not of the curve {curve.document['id']!r}")
    rendered, findings = check.rendered, list[Finding]()
    for finding, again in _differences(curve, examined, certificate, place):
        kept = {**(rendered or certificate.to_json()), "place": again}
        examination = Examination(certificate.software)
        findings += examination.in_data([finding], kept)
        rendered = examination.rendered or rendered
    level = min(check.level, Level.FORM if findings or examined is None else examined.level)
    notes = check.notes if rendered is check.rendered else tuple(dict.fromkeys((*check.notes, REWORDED)))
    return replace(check, findings=tuple(findings), level=level, open_place="", rendered=rendered, notes=notes)


def _differences(
    curve: Certificate, examined: Recheck | None, entry: Certificate, stored: Mapping[str, Any]
) -> Iterator[tuple[Finding, Mapping[str, Any] | None]]:
    """What is wrong with a stored place, each with the place that is found, if one is."""
    given = _rests_on(curve)
    if stored["rests_on"] != given:
        old, new = (f"{shown(which['id'])} ({which['digest']})" for which in (stored["rests_on"], given))
        yield Finding("place", f"rests on the curve {old}; given is {new}"), None
        return
    ((_, again, line),) = _placed(curve, examined, [entry])
    if again is None:
        yield Finding("place", line), None
        return
    for finding in differences(stored, again, "place", ("place",)):
        yield finding, again


def _placed(
    curve: Certificate, examined: Recheck | None, orbits: Sequence[Certificate]
) -> Iterator[tuple[Certificate, dict[str, Any] | None, str]]:
    """Each orbit with its place as JSON, if it is shown, and a line about it."""
    name = shown(curve.document["id"])
    if examined is None:
        for orbit in orbits:
            yield orbit, None, f"{shown(orbit.id)}: not shown to lie on {name}: that is no curve of symmetric orbits"
        return
    if not (curve.proved and examined.stands):
        why = examined.why or "it is not proved"
        for orbit in orbits:
            yield orbit, None, f"{shown(orbit.id)}: not shown to lie on {name}: its certificate does not stand: {why}"
        return
    atlas = cast(Atlas, curve.atlas)
    points = [certified_point(atlas, orbit, recheck) for orbit in orbits]
    found = conclude(atlas, curve.results, points, partner, follow).bifurcations
    for orbit, entry in zip(orbits, found, strict=True):
        if entry.place is None:
            yield orbit, None, f"{shown(entry.id)}: not shown to lie on {name}: {entry.reason}"
            continue
        which = "its other point on Fix(R) lies" if entry.place.other_point else "lies"
        mirror = " (as its mirror image)" if entry.place.mirrored else ""
        where = f"piece {entry.place.piece}, {located('s', entry.place.s, _DIGITS)}"
        line = f"{shown(entry.id)}: {which} on the proved curve {name}{mirror}, {where}"
        yield orbit, _to_json(curve, entry), line


def _to_json(curve: Certificate, entry: Bifurcation) -> dict[str, Any]:
    place, rests_on = entry.place, _rests_on(curve)
    assert place is not None
    return {
        "rests_on": rests_on,
        "piece": place.piece,
        "s": ball_to_json(place.s),
        "mirrored": place.mirrored,
        "other_point": place.other_point,
        "statement": place_in_words(cast(Atlas, curve.atlas), place, rests_on["id"], rests_on["digest"]),
    }


def _rests_on(curve: Certificate) -> dict[str, Any]:
    return {"id": curve.document["id"], "digest": curve.document["digest"]}
