"""What to change about a box of which a condition fails, derived from the enclosures.

Along the branch of new orbits p_0 and p_2 are of the order p_1^2; so P_0 and P_2 have to be of the order P_1^2. A
touch-and-go crosses the family at an angle (section 9.1): there p_0 is of the order p_1, and P_0 of the order P_1.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, isqrt

from flint import arb

from orbitproof.shared.formats import FOLD, LEADING_POWERS
from orbitproof.verify.evidence import Hypothesis, enclose, excludes_zero, is_inside, is_outside
from orbitproof.verify.newton import is_regular

_MARGIN = Fraction(5, 4)
"""What is advised is so much more than what would have been enough."""
_SHARE = {1: "as much", 2: "its square"}
"""How P_0 follows P_1, by the order of p_0 in p_1."""
_TOO_WIDE = 100
"""P_0 may be so many times wider than the branch needs before that is taken for the reason of a failure."""
_TANGENT = arb(2) ** -20
"""Where p_0 is so many times smaller than P_1 along the new orbits, they do not cross the family."""
_WHERE = "`radii` of the search, for one point"
_LARGE = 1e300
_LOST = 10**15
"""Where an enclosure is so many times wider than its midpoint is large, its scale says nothing."""


@dataclass(frozen=True)
class Advice:
    """What to change about a box.

    Attributes:
        words: the remedy.
        factors: by what to multiply half-widths, by their position, for a box that follows it; none where it is not
            the box that has to change.
    """

    words: str
    factors: Mapping[int, arb] = field(default_factory=dict)


def advice_on(kind: str, radii: Sequence[Fraction], hypotheses: Sequence[Hypothesis]) -> Advice | None:
    """What helps about the condition that failed, the last, from its enclosures and those before; `None` if they do not
    tell. `kind` is that of a bifurcation, `radii` the half-widths of the box that the hypotheses are about.
    """
    last, order = hypotheses[-1], LEADING_POWERS.get(kind, 2)
    if last.name in ("G_11", "h_b'") and order == 1 and (tangent := of_tangency(hypotheses, radii[1])) is not None:
        return tangent
    if last.name in _AT_THE_POINT or (last.name == "point" and kind == FOLD):
        return of_shape(hypotheses, radii[0], order)
    entries = [ball for name, ball in last.enclosures.items() if name.startswith("d q_")]
    size = isqrt(len(entries))
    if entries and not is_regular([entries[size * row : size * (row + 1)] for row in range(size)]):
        return None
    for name, ball in last.enclosures.items():
        if name in _SIGNS and not excludes_zero(ball):
            return _of_narrow_slope(last.enclosures, radii, order) or of_sign(ball, order)
        found = _IMAGE.fullmatch(name)
        if found is not None and not is_inside(ball, radii[int(found[1])]):
            over = found[3] or {"^H": "1", None: "0" if last.name == "family" else None}[found[2]]
            return None if over is None else of_image(int(found[1]), int(over), ball, radii, order)
    return None


_AT_THE_POINT = ("G_11", "G_01", "G_111", "dH/dp_0", "h_fp'", "h_b'", "h_b''")
_SIGNS = ("g_0", "G_01 + G_11 p_1'", "g''(P_1)")
"""Enclosures over the box that have to exclude 0."""
_IMAGE = re.compile(r"p_([0-9]+)(\^H|\(P_([0-9])\))?")
"""Enclosures that have to lie in the box, of p_i over P_j."""


def _of_narrow_slope(enclosures: Mapping[str, arb], radii: Sequence[Fraction], order: int) -> Advice | None:
    """Where P_0 is much too narrow for P_1, errors that the branch needs make the slope g_0 uncertain.

    They do if g(0, P_1) is wider than the errors of g_0 make it, which are what is bounded over the box in both.
    """
    if not {"g_0", "g(0, P_1)"} <= set(enclosures):
        return None
    slope, value = enclosures["g_0"], enclosures["g(0, P_1)"]
    if not is_outside(arb(value.abs_upper()) / slope.rad(), radii[0]):
        return None
    likely = -value / arb(slope.mid())
    return of_image(0, 1, likely, radii, order) if is_outside(arb(likely.abs_upper()), radii[0]) else None


def of_image(axis: int, over: int, ball: arb, radii: Sequence[Fraction], order: int) -> Advice | None:
    """What helps if p_`axis`, as a function over P_`over`, is only known to lie in `ball`, not inside P_`axis`.

    The ball contains 0 if the centre is the bifurcation point. Otherwise the centre has to be nearer to it than the
    narrowest half-width, in all directions. `None` if the ball does not tell. `order` is that of p_0 in p_1.
    """
    if not ball.is_finite():
        return None
    offset, spread, width = abs(arb(ball.mid())), arb(ball.rad()), enclose(radii[axis])
    if offset > 2 * spread:
        digits = max(1, ceil(float((offset / enclose(min(radii))).log() / arb(10).log())) + 1)
        return Advice(
            f"the centre is off by {_times(offset / width)} half-widths of P_{axis}: refine it to {digits} more digits "
            "(`digits` of the search); if they are right, are k and the kind?"
        )
    factor = (offset + spread) / width * enclose(_MARGIN)
    narrower = factor.sqrt() if over == 1 and (axis, order) != (0, 1) else factor
    along = f" and P_0 by {_SHARE[order]}" if (axis, over) == (2, 1) else ""
    words = (
        f"P_{axis} is too narrow for P_{over}: widen P_{axis} by a factor of {_times(factor)}, or make P_{over} "
        f"narrower by {_times(narrower)}{along} ({_WHERE})"
    )
    return Advice(words, {axis: factor})


def of_sign(ball: arb, order: int) -> Advice | None:
    """What helps if `ball` has to exclude 0, and encloses something over the whole box; `None` if it does not tell.

    It becomes narrower as P_1 does if all half-widths keep their orders: over the box G_01 varies by G_011 P_1 + G_001
    P_0 to first order, the second derivative of a fold by the third times P_1. `order` is that of p_0 in p_1.
    """
    offset, spread = abs(arb(ball.mid())), arb(ball.rad())
    if not ball.is_finite() or not spread < _LOST * offset:
        return None
    others = "P_0 and P_2 by its square" if order == 2 else f"P_0 by {_SHARE[order]}, P_2 by its square"
    narrower = 2 * spread / offset
    words = (
        f"the box is too large: make P_1 narrower by a factor of about {_times(narrower)}, {others} "
        f"({_WHERE}); "
        "a value that vanishes belongs to a degenerate bifurcation"
    )
    return Advice(words, {0: narrower**-order, 1: 1 / narrower, 2: narrower**-2})


def of_tangency(hypotheses: Sequence[Hypothesis], radius: Fraction) -> Advice | None:
    """What to say where the new orbits of a touch-and-go, over P_1 of this half-width, seem not to cross the family."""
    found = _values_of_p_0(hypotheses)
    if not found or not found[-1].abs_upper() < _TANGENT * enclose(radius):
        return None
    return Advice(
        "no other box helps: as far as the enclosures show the new orbits are tangent to P_1, where G_11 vanishes. It "
        "does if a symmetry maps the orbits to themselves with a shift in time: such a resonance is no touch-and-go"
    )


def of_shape(hypotheses: Sequence[Hypothesis], radius: Fraction, order: int) -> Advice | None:
    """What helps if P_0, of this half-width, is much wider than the values p_0(P_1) that were found; else `None`."""
    found = _values_of_p_0(hypotheses)
    excess = enclose(radius) / found[-1].abs_upper() if found else arb(0)
    if not excess > _TOO_WIDE:
        return None
    words = (
        f"P_0 is too wide for P_1: make P_0 narrower by a factor of up to {_times(excess)}, or P_1 wider by up to "
        f"{_times(excess.sqrt() if order == 2 else excess)} ({_WHERE})"
    )
    return Advice(words, {0: enclose(_MARGIN) / excess})


def _values_of_p_0(hypotheses: Sequence[Hypothesis]) -> list[arb]:
    return [h.enclosures["p_0(P_1)"] for h in hypotheses if "p_0(P_1)" in h.enclosures]


def _times(factor: arb) -> str:
    value = float(factor.mid())
    return f"{value:.2g}" if value < _LARGE else str(factor.mid().str(2, radius=False))
