"""How far enclosures are from where they would not do: inside a box or tube, beyond a claimed end, away from 0.

Exact, then rounded to be safe.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import floor

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.verify.evidence import bounds

_IN_THE_BOX = re.compile(r"p_(?P<index>[0-9])(\^H|\(P_[0-9]\)|$| of the candidate's box$)")
_GLUED = re.compile(r"p_(?P<index>[0-9]+) of .+ in (?P<piece>\S+)")
_BREAKING = re.compile(r"vy of the symmetry breaking in (?P<piece>\S+)")
_NOT_ZERO = re.compile(r"b|g_0|G_[01]+|G_01 \+ .*|d q_2\(P\^[0-9]+\) / d p_2|dH/dp_0|h_.*|g''.*")


def margin_of(hypothesis: str, name: str, ball: arb, radii: Mapping[str, Sequence[Fraction]]) -> str:
    """In words; empty where a hypothesis asks for nothing of this enclosure alone.

    Args:
        radii: R_0, R_1, .. of the box that a hypothesis speaks of; under "" those of all others.
    """
    if not ball.is_finite():
        return ""
    found = _IN_THE_BOX.match(name)
    if found is not None:
        index, sizes = int(found["index"]), radii.get(hypothesis, radii[""])
        return _part(ball, sizes[index], f"R_{index}") if index < len(sizes) else ""
    return _away(ball) if _NOT_ZERO.fullmatch(name) else ""


def margin_on_atlas(atlas: Atlas, hypothesis: str, name: str, ball: arb) -> str:
    """The same for a hypothesis on the pieces of an atlas."""
    if not ball.is_finite():
        return ""
    glued, breaking, covers = _GLUED.fullmatch(name), _BREAKING.fullmatch(name), atlas.claim.covers
    if glued is not None and hypothesis == "glued" and atlas.is_surface:
        index, radii = int(glued["index"]), {piece.id: piece.radii for piece in atlas.surface_pieces()}
        return _part(ball, radii[glued["piece"]][index], f"R_{index}")
    if breaking is not None and hypothesis == "planar-family":
        tubes = {piece.id: piece.tube for piece in atlas.libration_pieces()}
        return _part(ball, tubes[breaking["piece"]], "of the tube")
    if covers is not None and hypothesis == "covers" and name in ("beginning", "end"):
        low, high = bounds(ball)
        beyond = covers.start - high if name == "beginning" else low - covers.end
        return f"at least {_scientific(beyond, up=False)} beyond" if beyond > 0 else ""
    return _away(ball) if hypothesis == "two-points" else ""


def _part(ball: arb, radius: Fraction, name: str) -> str:
    """Which part of a radius a ball reaches."""
    low, high = bounds(ball)
    return part_of(max(abs(low), abs(high)) / radius, name)


def part_of(part: Fraction, name: str) -> str:
    """At most this part, rounded up."""
    return f"at most {_scientific(part, up=True)} {name}" if part else "exactly 0"


def _away(ball: arb) -> str:
    """At least so many widths away from 0, rounded down."""
    low, high = bounds(ball)
    if low <= 0 <= high:
        return ""
    if low == high:
        return "exact, not 0"
    return f"at least {_scientific(min(abs(low), abs(high)) / (high - low), up=False)} widths from 0"


def _scientific(value: Fraction, up: bool) -> str:
    """A positive number with two significant digits, rounded up or down."""
    exponent = 0
    while value >= 10:
        value, exponent = value / 10, exponent + 1
    while value < 1:
        value, exponent = value * 10, exponent - 1
    digits = -floor(-value * 10) if up else floor(value * 10)
    if digits == 100:
        digits, exponent = 10, exponent + 1
    if -3 <= exponent <= 2:
        return f"{float(Fraction(digits, 10) * Fraction(10) ** exponent):.{max(0, 1 - exponent)}f}"
    return f"{digits // 10}.{digits % 10}e{exponent}"
