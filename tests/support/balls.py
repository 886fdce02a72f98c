"""What tests ask of balls."""

from __future__ import annotations

from flint import acb, arb


def agree(one: arb | acb, other: arb | acb) -> bool:
    """Whether two balls are finite and have a point in common: `overlaps` is true of all that is not finite."""
    return bool(one.is_finite() and other.is_finite() and one.overlaps(other))
