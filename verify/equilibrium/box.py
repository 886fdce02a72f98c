"""The box of a claim: that the field is enclosed there, and one zero in it (sections 36.2 and 36.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import acb, arb

from orbitproof.shared.claims import AroundPoint
from orbitproof.verify.evidence import (
    Checklist,
    Evidence,
    all_finite,
    enclose,
    is_inside,
    is_outside,
    meet,
    show,
    symmetric,
)
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.periodic import Linearised

NARROWER = "move the centre to the zero, or choose smaller radii"

_ROUGH = 2.0**-6
"""A derivative that is known better than this and may be singular is near one that is."""


def check_field(
    checklist: Checklist,
    section: str,
    field: Sequence[Linearised],
    size: int,
    variables: int,
    further: Mapping[str, tuple[Sequence[Sequence[arb | acb]], int]],
) -> None:
    """Every enclosure that is used is there and finite.

    Args:
        field: the components of f, `size` of them in so many variables.
        further: tables beside it, by name, each with the length that its `size` rows have.
    """
    statement = "the field and its derivatives are defined on the box, with finite enclosures"
    with checklist.hypothesis("field", section, statement, "smaller radii, or a box where it is defined") as evidence:
        evidence.require(len(field) == size, "a component is missing")
        evidence.require(all(len(f.slopes) == variables for f in field), "a derivative is missing")
        for name, (rows, length) in further.items():
            there = len(rows) == size and all(len(row) == length for row in rows)
            evidence.require(there, f"of the {name} some are missing")
        balls = [ball for f in field for ball in f.balls]
        parts = [value for rows, _ in further.values() for row in rows for value in row]
        balls += [part for value in parts for part in (acb(value).real, acb(value).imag)]
        evidence.require(all_finite(balls), "an enclosure is not finite", needs_precision=True)


def require_zero(
    evidence: Evidence,
    names: Sequence[str],
    matrix: Sequence[Sequence[arb]],
    residual: Sequence[arb],
    radii: Sequence[Fraction],
) -> list[arb]:
    """Require that equations have exactly one zero in the box |p_i| <= radii_i, by Lemma 5; where it is.

    Args:
        names: of the p_i.
        matrix: encloses the derivative of the equations at all points of the box.
        residual: encloses their values at p = 0.
    """
    widest = max((ball.rad() for row in matrix for ball in row), default=arb(0))
    vague = f"the derivative over the box is known too roughly, up to {show(widest)}: smaller radii or more bits"
    message = "the derivative may be singular in the box" if widest < _ROUGH else vague
    evidence.require(is_regular(matrix), message, needs_precision=True)
    image = newton_image(matrix, residual)
    for name, ball, radius in zip(names, image, radii, strict=True):
        evidence.record(name, ball)
        outside = is_outside(ball, radius)
        message = f"{name} in {show(ball)} is not inside its interval"
        evidence.require(is_inside(ball, radius), message, needs_precision=not outside, excluded=outside)
    evidence.require(len(image) == len(radii), "an equation is missing")
    return [meet(symmetric(radius), ball) for ball, radius in zip(image, radii, strict=True)]


def point_of(claim: AroundPoint, where: Sequence[arb]) -> dict[str, arb]:
    """The coordinates by name, from those in the box."""
    values = [enclose(middle) + ball for middle, ball in zip(claim.centre, where, strict=True)]
    return dict(zip(claim.system.given_state, values, strict=True))
