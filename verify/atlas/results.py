"""What was found on the intervals of the pieces of an atlas, as JSON: the interval, and why it is not proved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.curve import Interval

Result = Mapping[str, Any]
"""What was found on one interval of a piece; the definition ``result`` of the schema."""

Settings = Mapping[str, int]
"""Of the integrator, by name, as they stand in a result's ``computation``."""


def covers(intervals: Sequence[Interval], wanted: Interval) -> bool:
    """Whether closed intervals cover another one."""
    reached, end = wanted
    for first, last in sorted(intervals):
        if first > reached:
            break
        reached = max(reached, last)
        if reached >= end:
            return True
    return False


def interval_of(result: Mapping[str, Any]) -> Interval:
    """The interval of s that a result is about."""
    start, end = result["interval"]
    return parse_exact(start), parse_exact(end)


def condition_of(result: Mapping[str, Any]) -> str:
    """What stopped a proof, in one word; empty if the result does not say."""
    reason = result.get("reason")
    return str(reason.get("condition", "")) if isinstance(reason, Mapping) else ""
