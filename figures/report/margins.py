"""How far enclosures are from where they would not do: inside a box or tube, beyond a claimed end, away from 0.

Exact, then rounded to be safe. What a hypothesis asks of an enclosure follows from the claim: names are not read.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import floor

from flint import arb

from orbitproof.shared.formats import AnyAtlas, Candidate
from orbitproof.verify.evidence import bounds

_NOT_ZERO = frozenset({
    "b", "g_0", "G_01", "G_11", "G_111", "G_01 + G_11 p_1'", "dH/dp_0", "h_fp'", "h_b'", "h_b''", "g''", "g''(P_1)",
    "of s", "of y^2", "kappa", "tau",
})  # fmt: skip
"""Enclosures of numbers that a hypothesis about a box wants to differ from 0."""
_ZERO = frozenset({"Re(conj(lambda) c_1)"})
"""Enclosures of numbers that are 0."""


def margin_of(claim: Candidate, candidate: Candidate, hypothesis: str, name: str, ball: arb) -> str:
    """In words; empty where a hypothesis asks for nothing of this enclosure alone.

    Args:
        claim: what the hypotheses are about, the candidate or its level form.
    """
    if not ball.is_finite():
        return ""
    radii = candidate.radii if hypothesis == "candidate-box" else claim.radii
    index = _in_the_box(len(radii)).get(name)
    if index is not None:
        return _part(ball, radii[index], f"R_{index}")
    if name in _ZERO:
        return _with_zero(ball)
    # One number, where one coordinate is left to be solved for.
    slope = f"d q_2(P^{claim.k}) / d p_2" if hypothesis in ("C2", "HC2") and len(radii) == 3 else None
    return _away(ball) if name in _NOT_ZERO or name == slope else ""


def _in_the_box(size: int) -> dict[str, int]:
    """The i of each enclosure that has to lie inside P_i."""
    kinds = ("", "^H", " of the candidate's box", *(f"(P_{j})" for j in range(size)))
    return {f"p_{i}{kind}": i for i in range(size) for kind in kinds}


def margin_on_atlas(atlas: AnyAtlas, hypothesis: str, name: str, ball: arb) -> str:
    """The margin of a hypothesis on the pieces of an atlas, in words."""
    if not ball.is_finite():
        return ""
    covers = atlas.claim.covers
    if hypothesis == "glued":
        for before, after in pairwise(atlas.surface_pieces()):
            for i, radius in enumerate(after.radii):
                if name == f"p_{i} of {before.id} in {after.id}":
                    return _part(ball, radius, f"R_{i}")
    if hypothesis == "planar-family":
        for piece in atlas.libration_pieces():
            if name == f"vy of the symmetry breaking in {piece.id}":
                return _part(ball, piece.tube, "of the tube")
    if hypothesis == "covers" and covers is not None and name in ("beginning", "end"):
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


def _with_zero(ball: arb) -> str:
    """How far 0, which lies in a ball, is from its middle."""
    low, high = bounds(ball)
    if not low <= 0 <= high:
        return ""
    off = abs(low + high) / (high - low) if low < high else Fraction(0)
    return f"0 is in it, {part_of(off, 'of the way out')}" if off else "0 is its middle"


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
