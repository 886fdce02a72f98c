"""How enclosures of a second proof stand to the stored ones. Section 7 of its chapter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb

from orbitproof.verify.evidence import ball_from_json, decimal_above

Pairs = Mapping[str, tuple[arb, Any]]
"""By the names of numbers: the ball of a second proof, and the stored one, or its JSON."""


@dataclass(frozen=True)
class Comparison:
    """`verdict` is ``agrees``, ``disagrees`` or ``cannot follow``; `reason` says where or why."""

    verdict: str
    reason: str


NOT_CONFIRMED = "that the candidate's box holds no other orbits"
"""What the first proof says besides, and no second proof does: its box is another one."""
MARGIN = 8
"""An enclosure narrower by this factor than the stored one has to lie inside it."""


def agreement(
    parts: Sequence[str], pairs: Pairs, left: Sequence[str], is_in_box: bool | None, what: str = "point"
) -> Comparison:
    """What is confirmed of a certificate, which balls and which are not, or the first that does not agree.

    Args:
        parts: what agrees besides.
        left: what is not confirmed besides.
        is_in_box: whether what is in question, usually the point, lies in the box of the candidate; `None`: that is not
            certain.
        what: this; empty where there is no such box.
    """
    inside, beyond = list[str](), list[str]()
    for name, (mine, entry) in pairs.items():
        found = excess(name, mine, entry if isinstance(entry, arb) else ball_from_json(entry))
        if isinstance(found, Comparison):
            return found
        name = name.removeprefix("normal_form.")
        inside.append(name) if found is None else beyond.append(f"{name} {found}")
    if is_in_box is None:
        return Comparison("cannot follow", f"the enclosure of the {what} is too wide to tell whether it is in the box")
    if not is_in_box:
        return Comparison("disagrees", f"the {what} is not in the box of the candidate")
    told = [*parts, *([f"the {what} in the box of the candidate"] if what else [])]
    told += [f"inside the stored balls: {', '.join(inside)}"] if inside else []
    open_still = f"Not confirmed: {', '.join([*beyond, *left])}" if beyond or left else "Nothing is left open"
    return Comparison("agrees", f"{'; '.join(told)}. {open_still}")


def excess(name: str, mine: arb, stored: arb) -> str | Comparison | None:
    """Beyond what this ball reaches out of the stored one, which it overlaps; or why they do not agree.

    `None` if the stored ball contains it.
    """
    if not (mine.is_finite() and stored.is_finite()):
        return Comparison("cannot follow", f"{name}: an enclosure is not finite")
    if not mine.overlaps(stored):
        return Comparison("disagrees", f"{name}: the enclosures have no common point")
    if stored.contains(mine):
        return None
    if arb(mine.rad()) * MARGIN < arb(stored.rad()):
        return Comparison("cannot follow", f"{name}: the enclosure here is narrower and not inside the stored one")
    if name.startswith("normal_form.") and mine.contains(0) and not stored.contains(0):
        return Comparison("cannot follow", f"{name}: its sign is not shown here")
    digits = max(0, int(mine.rel_accuracy_bits() * 0.30103))
    return f"beyond {digits} digits" if digits else f"beyond {decimal_above(mine.abs_upper(), 2)}"
