"""What to change about a box of which a condition fails, derived from the enclosure that fails.

Along the branch of new orbits p_0 and p_2 are of the order p_1^2. So P_0 and P_2 have to be of the order P_1^2.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil

from flint import arb

from orbitproof.verify.evidence import enclose

_MARGIN = 1.25
"""What is advised is so much more than what would have been enough."""


def remedy_outside(axis: int, over: int, ball: arb, radius: Fraction) -> str | None:
    """What helps if p_`axis`, as a function over P_`over`, is only known to lie in `ball`, not in (-radius, radius).

    The ball would contain 0 if the centre were the bifurcation point. `None` if the ball does not tell.
    """
    if not ball.is_finite():
        return None
    offset, spread, width = arb(ball.mid()).__abs__(), arb(ball.rad()), enclose(radius)
    if (offset > 2 * spread) is True:
        digits = ceil(float((offset / width).log() / arb(10).log())) + 1
        return (
            f"the centre is off by {_times(offset / width)} half-widths of P_{axis}: refine it to {max(digits, 1)} more "
            "digits (explore candidates --digits); if that does not help, is k right, and the kind?"
        )
    factor = (offset + spread) / width * _MARGIN
    powers = {axis: 2 if axis != 1 else 1, over: 2 if over != 1 else 1}
    narrower = factor if powers[axis] == powers[over] else factor.sqrt()
    return (
        f"P_{axis} is too narrow for P_{over}: widen it by a factor of {_times(factor)}, or make P_{over} narrower by "
        f"{_times(narrower)}"
    )
