"""The box that a failure asks for (section 10.3); a guess like any other: what is proved is proved of the box tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isqrt

from flint import arb

from orbitproof.shared.formats import KINDS, LEADING_POWERS, BoxClaim
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.attempt.remedies import advice_on
from orbitproof.verify.evidence import Hypothesis, Reason, enclose, exact_value, is_inside, is_outside
from orbitproof.verify.newton import is_regular

_OF_A_WIDE_BOX = ("tube", "crossing count", "section", "collision", "derivatives", "poincare-map", "return-map")
"""Conditions that fail where orbits of the box part too far, if no enclosure says more."""
_NARROWER, _MUCH_NARROWER = arb(2) ** -8, arb(2) ** -12
"""For orbits, and for P_1 of a bifurcation, whose third derivatives have to be known."""
_SLACK = 1 + arb(2) ** -4
_ROOM = 4
"""A box that an image reaches out of becomes so many times as wide as the image."""
_RADIUS_BITS = 12


def box_asked_for(
    claim: BoxClaim, reason: Reason, hypotheses: Sequence[Hypothesis], radii: Sequence[Fraction]
) -> tuple[Fraction, ...] | None:
    """Half-widths of a box about the same centre that a claim may be proved on which was not; `None` if none is near.

    Args:
        claim: what was claimed, whose half-widths the result is for.
        reason, hypotheses: why it is not proved, and what was looked at.
        radii: of the box that the hypotheses are about; the claim's, or those of its level form.
    """
    factors = _factors(claim, reason, hypotheses, radii)
    if not factors or not all(factor.is_finite() and factor > 0 for factor in factors.values()):
        return None
    return tuple(
        round_dyadic(radius * exact_value(factors[axis].mid()), _RADIUS_BITS) if axis in factors else radius
        for axis, radius in enumerate(claim.radii)
    )


def _factors(
    claim: BoxClaim, reason: Reason, hypotheses: Sequence[Hypothesis], radii: Sequence[Fraction]
) -> Mapping[int, arb]:
    """By what to multiply the half-widths, by position; none if nothing tells."""
    failed = hypotheses[-1] if hypotheses and hypotheses[-1].name == reason.condition else None
    if claim.kind in KINDS:
        advice = advice_on(claim.kind, radii, hypotheses) if failed is not None else None
        if advice is not None:
            return {axis: _SLACK * factor if factor > 1 else factor / _SLACK for axis, factor in advice.factors.items()}
        order = LEADING_POWERS[claim.kind]
        narrower = {axis: _MUCH_NARROWER**power for axis, power in enumerate((order, 1, 2)[: len(radii)])}
    else:
        narrower = dict.fromkeys(range(len(radii)), _NARROWER)
        if failed is not None and failed.enclosures:
            matrix = [ball for name, ball in failed.enclosures.items() if name.startswith("d ")]
            size = isqrt(len(matrix))
            if matrix and is_regular([matrix[size * row : size * (row + 1)] for row in range(size)]):
                return _wide_enough(failed.enclosures, radii)
    wide = reason.condition in _OF_A_WIDE_BOX or (failed is not None and bool(failed.enclosures))
    return narrower if wide else {}


def _wide_enough(enclosures: Mapping[str, arb], radii: Sequence[Fraction]) -> Mapping[int, arb]:
    """For a Newton image that reaches out of its box: wide enough to hold it; nothing if no zero is in the box."""
    images = {axis: enclosures[f"p_{axis}"] for axis in range(len(radii)) if f"p_{axis}" in enclosures}
    if any(is_outside(ball, radii[axis]) for axis, ball in images.items()):
        return {}
    return {
        axis: _ROOM * ball.abs_upper() / enclose(radii[axis])
        for axis, ball in images.items()
        if not is_inside(ball, radii[axis])
    }
