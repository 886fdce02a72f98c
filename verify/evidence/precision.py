"""Precision of the ball arithmetic: bits beyond those of what the balls come from.

Any precision gives enclosures (section 7.1); these bits keep rounding from widening them.
"""

from __future__ import annotations

from contextlib import AbstractContextManager

from flint import ctx

GUARD_BITS = 64


def guarded(bits: int) -> AbstractContextManager[None]:
    """Ball arithmetic with `GUARD_BITS` more than `bits` in the body of a ``with`` statement."""
    return ctx.workprec(bits + GUARD_BITS)
