"""Comparison of a second proof with what the certificate says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from .jets import ball, precision
from .proof import NotProved, Proved
from .statement import BadCertificate, exact


@dataclass(frozen=True)
class Comparison:
    """`verdict` is ``agrees``, ``disagrees`` or ``cannot follow``; `reason` says where or why."""

    verdict: str
    reason: str


def _apart(mine: arb, stored: Mapping[str, Any], field: str) -> bool:
    """Whether two balls certainly have no common point."""
    try:
        mid, rad = exact(stored["mid"], field), exact(stored["rad"], field)
    except (KeyError, TypeError):
        raise BadCertificate(f"{field}: not a ball") from None
    with precision(4096):
        return not mine.overlaps(ball(mid) + arb(0, ball(rad).upper()))


def _place(result: Proved, claim: Mapping[str, Any]) -> bool | None:
    """Whether the point certainly lies in the box of the candidate, certainly does not, or None: neither is certain."""
    try:
        frame = [[exact(c, "frame") for c in row] for row in claim["frame"]]
        centre = [exact(c, "centre") for c in claim["centre"]]
        radii = [exact(c, "radii") for c in claim["radii"]]
    except (KeyError, TypeError):
        raise BadCertificate("statement.candidate: frame, centre or radii are missing") from None
    with precision(4096):
        away = [[v - ball(c)] for v, c in zip(result.point.values(), centre, strict=True)]
        coordinates = arb_mat([[ball(c) for c in row] for row in frame]).solve(arb_mat(away))
        sizes = [(abs(coordinates[i, 0]), ball(r)) for i, r in enumerate(radii)]
        if any(size > radius for size, radius in sizes):
            return False
        return True if all(size <= radius for size, radius in sizes) else None


def compare(certificate: Mapping[str, Any], result: Proved | NotProved) -> Comparison:
    """Whether a second proof says the same as the certificate: kind, k, side, and enclosures that overlap."""
    if isinstance(result, NotProved):
        return Comparison("cannot follow", result.reason)
    results, claim = certificate.get("results"), certificate["statement"]["candidate"]
    if certificate.get("verdict") != "proved" or not isinstance(results, Mapping):
        return Comparison("cannot follow", "the certificate proves nothing to compare with")
    if (result.kind, result.k) != (claim["kind"], claim["k"]):
        return Comparison("disagrees", f"kind or k: {result.kind}, {result.k}")
    if results.get("side") != result.side:
        return Comparison("disagrees", f"side: {results.get('side')} in the certificate, {result.side} here")
    for name, value in result.point.items():
        if name not in results["point"] or _apart(value, results["point"][name], f"results.point.{name}"):
            return Comparison("disagrees", f"{name}: the enclosures have no common point")
    if _apart(result.parameter, results["parameter"], "results.parameter"):
        return Comparison("disagrees", "parameter: the enclosures have no common point")
    place = _place(result, claim)
    if place is None:
        return Comparison("cannot follow", "the enclosure of the point is too wide to tell whether it is in the box")
    if not place:
        return Comparison("disagrees", "the point is not in the box of the candidate")
    return Comparison("agrees", "kind, k, side; point and parameter overlap; the point is in the box of the candidate")
