"""Whether the twist is left open on an interval of a piece (section 29.5). Carries no proof."""

from __future__ import annotations

from fractions import Fraction

from flint import ctx

from orbitproof.shared.formats import Piece
from orbitproof.verify.evidence import enclose, is_below, is_positive
from orbitproof.verify.functions import REACH, StoredFunction
from orbitproof.verify.lasting.stored import LastingResult, TwistFunctions, may_be_stable, parts_from
from orbitproof.verify.stability import PRECISION, StabilityFunctions, between, zeros_on

_HOPELESS = 2**10
"""A shorter interval helps, and more precision little, where a bound is not so many times as small as its function."""
_SHARP = Fraction(1, 2**44)
"""Of tau: orbits without twist shall be enclosed as well as that."""


def twist_open_on(piece: Piece, result: LastingResult) -> str:
    """Why the twist of linearly stable orbits is not decided on a proved interval, as `stability.open_on` says it."""
    if not isinstance(result.stability, StabilityFunctions):
        return "" if isinstance(result.twist, TwistFunctions) else "stability"
    if not isinstance(result.twist, TwistFunctions):
        return "stability" if may_be_stable(result.stability) else ""
    symmetric = piece.kind == "symmetric" and result.interval[0] <= 0 <= result.interval[1]
    parts = parts_from(Fraction(0) if symmetric else -1 / REACH)
    with ctx.workprec(PRECISION):
        s = result.stability.characteristic[0].enclosed
        stored = result.twist.twist, result.twist.exchanged
        functions = [each.enclosed for each in stored]
        for low, high in parts[1:-1]:
            values = s.value(between(low, high))
            if not is_positive(1 - values * values):
                continue
            found = [zeros_on(function, low, high) for function in functions]
            if all(zeros.undecided for zeros in found):
                return "stability" if all(map(_is_wide, stored)) else "zeros"
            decided = next(zeros for zeros in found if not zeros.undecided)
            if not all(is_below(zero.place.rad(), enclose(_SHARP)) for zero in decided.zeros):
                return "zeros"
    return ""


def _is_wide(function: StoredFunction) -> bool:
    return _HOPELESS * function.error > sum(map(abs, function.coefficients), Fraction(0))
