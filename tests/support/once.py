"""What is integrated for several tests with the same arguments, integrated once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from fractions import Fraction
from typing import Any

from flint import arb, ctx


def once(work: Callable[..., Any]) -> Callable[..., Any]:
    """The function, which answers as before if it is asked the same with the same precision."""
    found: dict[Hashable, tuple[Any, Any]] = {}

    def asked(*arguments: Any) -> Any:
        key = ctx.prec, *map(_exactly, arguments)
        if key not in found:
            # With the arguments, which are told by where they are.
            found[key] = work(*arguments), arguments
        return found[key][0]

    return asked


def _exactly(value: Any) -> Hashable:
    """What is equal only for equal numbers, and otherwise for the same object."""
    if isinstance(value, arb):
        return exact(value)
    if isinstance(value, Mapping):
        return tuple((name, _exactly(entry)) for name, entry in value.items())
    return value if isinstance(value, (int, Fraction, str)) else ("object", id(value))


def exact(ball: arb) -> tuple[Any, ...]:
    """What tells a finite ball from all others; a text for one that is not finite."""
    return (*ball.mid().man_exp(), *ball.rad().man_exp()) if ball.is_finite() else (repr(ball),)
