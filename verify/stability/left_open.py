"""Whether the list of resonances leaves something open on an interval of a piece (section 18.5). Carries no proof."""

from __future__ import annotations

from fractions import Fraction

from flint import ctx

from orbitproof.shared.formats import Piece
from orbitproof.verify.curve import Interval
from orbitproof.verify.stability.complete_list import PRECISION, orders, resonant_value
from orbitproof.verify.stability.known_functions import segment_of
from orbitproof.verify.stability.stored_stability import StabilityFunctions, StabilityResult
from orbitproof.verify.stability.zeros import Zeros, zeros_beside_double_one, zeros_on

_HOPELESS = 2**10
"""Where the sum of the stability parameters is known worse, a shorter interval helps, and more precision little."""
_BESIDE = Fraction(1, 64)
"""By so much of tau intervals overlap at least."""


def open_on(piece: Piece, result: StabilityResult, order: int) -> str:
    """Why the list is not decided on a proved interval: "stability", the stability matrix, or "zeros"; empty if it is.

    Args:
        result: of the interval.
        order: the largest k.
    """
    known = result.stability
    if not isinstance(known, StabilityFunctions):
        return "stability"
    try:
        reason = _open(piece, result.interval, known, order)
        hopeless = known.characteristic[0].error > _HOPELESS
        return "stability" if reason and hopeless else reason
    except (ArithmeticError, LookupError, ValueError):
        return "zeros"


def _open(piece: Piece, interval: Interval, known: StabilityFunctions, order: int) -> str:
    low, high = interval
    symmetric = piece.is_symmetric and low <= 0 <= high
    start = Fraction(0) if symmetric else low
    with ctx.workprec(PRECISION):
        segment = segment_of(0, (start, start, high), interval, known, False)
        first, last = segment.tau(start), segment.tau(high)
        inner = first if symmetric else first + _BESIDE, last - _BESIDE
        for k, j in orders(max(order, 2)):
            function = segment.at(resonant_value(k, j))
            if symmetric and k == 1:
                _, found = zeros_beside_double_one(function, last)
            else:
                found = zeros_on(function, first, last)
            if _is_open(found, inner):
                return "zeros"
        if segment.discriminant is not None and _is_open(zeros_on(segment.discriminant, first, last), inner):
            return "zeros"
    return ""


def _is_open(found: Zeros, inner: tuple[Fraction, Fraction]) -> bool:
    """Whether something is undecided, not only at the ends, where the curve runs through a neighbour."""
    return any(high > inner[0] and low < inner[1] for low, high in found.undecided)
