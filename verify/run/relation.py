"""How an enclosure of a second proof stands to the stored one. Section 7 of its chapter."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb


@dataclass(frozen=True)
class Comparison:
    """`verdict` is ``agrees``, ``disagrees`` or ``cannot follow``; `reason` says where or why."""

    verdict: str
    reason: str


NOT_CONFIRMED = "that the candidate's box holds no other orbits"
"""What the first proof says besides, and no second proof does: its box is another one."""
MARGIN = 8
"""An enclosure narrower by this factor than the stored one has to lie inside it."""


def relation(name: str, mine: arb, stored: arb) -> str | Comparison:
    """Empty if the stored ball contains this one, a remark if they overlap, or why they do not agree."""
    if not (mine.is_finite() and stored.is_finite()):
        return Comparison("cannot follow", f"{name}: an enclosure is not finite")
    if not mine.overlaps(stored):
        return Comparison("disagrees", f"{name}: the enclosures have no common point")
    if stored.contains(mine):
        return ""
    if arb(mine.rad()) * MARGIN < arb(stored.rad()):
        return Comparison("cannot follow", f"{name}: the enclosure here is narrower and not inside the stored one")
    if name.startswith("normal_form.") and mine.contains(0) and not stored.contains(0):
        return Comparison("cannot follow", f"{name}: its sign is not shown here")
    return f" (here to {max(0, int(mine.rel_accuracy_bits() * 0.30103))} digits)"
