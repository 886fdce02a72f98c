"""Precision of the ball arithmetic: that of proofs, and bits beyond it that keep rounding from widening them.

Any precision gives enclosures (section 7.1)."""

from __future__ import annotations

from contextlib import AbstractContextManager

from flint import ctx

GUARD_BITS = 64
LEAST_PRECISION, GREATEST_PRECISION = 64, 65536


def guarded(bits: int) -> AbstractContextManager[None]:
    """Ball arithmetic with `GUARD_BITS` more than `bits` in the body of a ``with`` statement."""
    return ctx.workprec(bits + GUARD_BITS)
