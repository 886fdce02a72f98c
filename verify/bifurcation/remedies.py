"""What to change about a box of which a condition fails, derived from the enclosures.

Along the branch of new orbits p_0 and p_2 are of the order p_1^2; so P_0 and P_2 have to be of the order P_1^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil

from flint import arb

from orbitproof.verify.evidence import Checklist, enclose

_MARGIN = Fraction(5, 4)
"""What is advised is so much more than what would have been enough."""
_TOO_WIDE = 100
"""P_0 may be so many times wider than the branch needs before that is taken for the reason of a failure."""
_LARGE = 1e300
_LOST = 1000
"""Where an enclosure is so many times wider than its midpoint is large, its scale says nothing."""


def of_image(axis: int, over: int, ball: arb, radii: Sequence[Fraction]) -> str | None:
    """What helps if p_`axis`, as a function over P_`over`, is only known to lie in `ball`, not inside P_`axis`.

    The ball contains 0 if the centre is the bifurcation point. Otherwise the centre has to be nearer to it than the
    narrowest half-width, in all directions. `None` if the ball does not tell.
    """
    if not ball.is_finite():
        return None
    offset, spread, width = abs(arb(ball.mid())), arb(ball.rad()), enclose(radii[axis])
    if offset > 2 * spread:
        digits = max(1, ceil(float((offset / enclose(min(radii))).log() / arb(10).log())) + 1)
        return (
            f"the centre is off by {_times(offset / width)} half-widths of P_{axis}: refine it to {digits} more digits "
            "(explore candidates --digits); if they are right, are k and the kind?"
        )
    factor = (offset + spread) / width * enclose(_MARGIN)
    narrower = factor.sqrt() if over == 1 else factor
    along = " and P_0 by its square" if (axis, over) == (2, 1) else ""
    return (
        f"P_{axis} is too narrow for P_{over}: widen P_{axis} by a factor of {_times(factor)}, or make P_{over} "
        f"narrower by {_times(narrower)}{along}"
    )


def of_sign(ball: arb) -> str | None:
    """What helps if `ball` has to exclude 0, and encloses something over the whole box; `None` if it does not tell."""
    offset, spread = abs(arb(ball.mid())), arb(ball.rad())
    if not ball.is_finite() or not spread < _LOST * offset:
        return None
    factor = 2 * spread / offset
    return (
        f"the box is too large: make P_1 narrower by a factor of about {_times(factor)}, P_0 and P_2 by its square; "
        "a value that vanishes belongs to another k or a degenerate bifurcation"
    )


def of_shape(checklist: Checklist, radius: Fraction) -> str | None:
    """What helps if P_0, of this half-width, is much wider than the values p_0(P_1) that were found; else `None`."""
    found = [h.enclosures["p_0(P_1)"] for h in checklist.hypotheses if "p_0(P_1)" in h.enclosures]
    excess = enclose(radius) / found[-1].abs_upper() if found else arb(0)
    if not excess > _TOO_WIDE:
        return None
    return (
        f"P_0 is too wide for P_1: make P_0 narrower by a factor of up to {_times(excess)}, or P_1 wider by up to "
        f"{_times(excess.sqrt())}"
    )


def _times(factor: arb) -> str:
    value = float(factor.mid())
    return f"{value:.2g}" if value < _LARGE else str(factor.mid().str(2, radius=False))
