"""Balls as they are stored: a little wider than they were found, so that another proof finds them inside (13.3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

from flint import acb, arb, ctx

from orbitproof.verify.evidence.comparisons import enclose

_SHARE = Fraction(1, 2**18)
"""Radii are stored larger by this share; FLINT rounds them up to 30 bits."""
_MUCH = Fraction(7)
"""And by so much, of numbers that are negligible: bounds by floats that underflow do not shrink with more bits."""
_BITS = 64

Value = TypeVar("Value")


def spared(value: Value, share: Fraction = _SHARE, negligible: Fraction = Fraction(0)) -> Value:
    """A value in which every ball that is no exact number is wider by a share of its radius.

    A ball that contains zero and has a radius below `negligible` becomes several times as wide.
    """
    factor, much, least = enclose(1 + share), enclose(1 + _MUCH), enclose(negligible)

    def wider(ball: arb) -> arb:
        is_negligible = ball.contains(0) and ball.rad() < least
        return arb(ball.mid(), (ball.rad() * (much if is_negligible else factor)).upper())

    return _with_balls(value, wider)


def as_found(value: Value) -> Value:
    """What `spared` has made this of, without negligible balls: every ball contains the one that was found."""
    factor = enclose(1 + _SHARE)
    return _with_balls(value, lambda ball: arb(ball.mid(), (ball.rad() / factor).upper()))


def _with_balls(value: Value, change: Callable[[arb], arb]) -> Value:
    with ctx.workprec(_BITS):
        found: Value = _changed(value, change)
    return found


def _changed(value: Any, change: Callable[[arb], arb]) -> Any:
    if isinstance(value, arb):
        # Midpoints are copied, whatever the precision.
        return value if value.is_exact() or not value.is_finite() else change(value)
    if isinstance(value, acb):
        return acb(_changed(value.real, change), _changed(value.imag, change))
    if isinstance(value, Mapping):
        return {key: _changed(inner, change) for key, inner in value.items()}
    if isinstance(value, tuple):
        return tuple(_changed(inner, change) for inner in value)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{each.name: _changed(getattr(value, each.name), change) for each in fields(value)})
    return value
