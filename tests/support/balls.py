"""What tests ask of balls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flint import acb, arb


def agree(one: arb | acb, other: arb | acb) -> bool:
    """Whether two balls are finite and have a point in common: `overlaps` is true of all that is not finite."""
    return bool(one.is_finite() and other.is_finite() and one.overlaps(other))


def first_of(function: Callable[[Any, Any], Any], second: Any, first: Any) -> Any:
    """A function of two arguments, of the first with the second given."""
    return function(first, second)
