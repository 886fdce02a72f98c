"""Comparison of a second proof with the certificate. README, section 7."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from .jets import ball, precision
from .proof import NotProved, Proved
from .statement import exact, read


@dataclass(frozen=True)
class Comparison:
    """`verdict` is ``agrees``, ``disagrees`` or ``cannot follow``; `reason` says where or why."""

    verdict: str
    reason: str


def _overlap(certificate: Mapping[str, Any], field: str, mine: arb) -> bool:
    """Whether two balls may have a common point."""
    mid, rad = (read(certificate, f"results.{field}.{name}", exact) for name in ("mid", "rad"))
    return bool(mine.overlaps(ball(mid) + arb(0, ball(rad).upper())))


def _place(certificate: Mapping[str, Any], point: Mapping[str, arb]) -> bool | None:
    """Whether the point certainly lies in the box of the candidate, certainly does not, or None: neither is certain."""
    claim = "statement.candidate"
    centre, radii = (read(certificate, f"{claim}.{name}", exact) for name in ("centre", "radii"))
    frame = arb_mat([[ball(c) for c in row] for row in read(certificate, f"{claim}.frame", exact)])
    away = frame.solve(arb_mat([[x - ball(c)] for x, c in zip(point.values(), centre, strict=True)]))
    sizes = [(abs(away[i, 0]), ball(radius)) for i, radius in enumerate(radii)]
    if any(size > radius for size, radius in sizes):
        return False
    return True if len(sizes) == len(point) and all(size <= radius for size, radius in sizes) else None


def compare(certificate: Mapping[str, Any], result: Proved | NotProved) -> Comparison:
    """Whether a second proof says the same as the certificate: kind, k, side, and enclosures that overlap."""
    if isinstance(result, NotProved):
        return Comparison("cannot follow", result.reason)
    if certificate.get("verdict") != "proved":
        return Comparison("cannot follow", "the certificate proves nothing to compare with")
    claim, side = read(certificate, "statement.candidate", dict), read(certificate, "results.side", str)
    if (result.kind, result.k) != (claim.get("kind"), claim.get("k")):
        return Comparison("disagrees", f"kind or k: {result.kind}, {result.k}")
    if side != result.side:
        return Comparison("disagrees", f"side: {side} in the certificate, {result.side} here")
    with precision(4096):
        pairs = [(f"point.{name}", value) for name, value in result.point.items()] + [("parameter", result.parameter)]
        for field, value in pairs:
            if not _overlap(certificate, field, value):
                return Comparison("disagrees", f"{field}: the enclosures have no common point")
        place = _place(certificate, result.point)
    if place is None:
        return Comparison("cannot follow", "the enclosure of the point is too wide to tell whether it is in the box")
    if not place:
        return Comparison("disagrees", "the point is not in the box of the candidate")
    return Comparison("agrees", "kind, k, side; point and parameter overlap; the point is in the box of the candidate")
