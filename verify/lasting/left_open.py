"""What is left open of the twist on an interval of a piece, and what is looked at closer (29.5). Carries no proof."""

from __future__ import annotations

from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Piece
from orbitproof.verify.curve import Interval
from orbitproof.verify.evidence import dyadic_above, enclose, exact_value, is_below, is_positive
from orbitproof.verify.functions import REACH, StoredFunction
from orbitproof.verify.lasting.stored import LastingResult, TwistFunctions, may_be_stable, parts_from
from orbitproof.verify.stability import PRECISION, StabilityFunctions, between, resonant_value, zeros_on

_HOPELESS = 2**10
"""A shorter interval helps, and more precision little, where a bound is not so many times as small as its function."""
_SHARP, _ISOLATED = Fraction(1, 2**42), Fraction(1, 2**6)
"""What is known worse than by the first, of level or half period, is looked at closer, if tau is known by the second.
"""
_AROUND = 16
"""A closer look goes so many times as far as an exception is uncertain: beyond it the first one excludes another."""
_LEAST = Fraction(1, 2**16)
"""Of tau: and no less far than that."""


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
            if not all(is_below(zero.place.rad(), enclose(_ISOLATED)) for zero in decided.zeros):
                return "zeros"
    return ""


def exceptions_to_sharpen(result: LastingResult) -> list[Interval]:
    """Short intervals of s about resonances 1:3 and 1:4 and orbits without twist that a result knows roughly."""
    known, twist = result.stability, result.twist
    if not (isinstance(known, StabilityFunctions) and isinstance(twist, TwistFunctions)):
        return []
    (low, high), end = result.interval, 1 / REACH
    middle, radius = (low + high) / 2, (high - low) / 2 * REACH
    found = []
    with ctx.workprec(PRECISION):
        s, level, half_period = (each.enclosed for each in (known.characteristic[0], known.level, known.half_period))
        resonances = [s.shifted(-resonant_value(k, 1)) for k in (3, 4)]
        for function in (*resonances, twist.twist.enclosed):
            for zero in zeros_on(function, -end, end).zeros:
                value, uncertain = s.value(zero.place), dyadic_above(zero.place.rad())
                sharp = all(_is_sharp(quantity.value(zero.place)) for quantity in (level, half_period))
                if not sharp and uncertain < _ISOLATED and is_positive(1 - value * value):
                    place = round(exact_value(zero.place.mid()) / _SHARP) * _SHARP
                    far = max(_LEAST, _AROUND * uncertain)
                    begin, last = (middle + radius * (place + sign * far) for sign in (-1, 1))
                    found.append((max(begin, low), min(last, high)))
    return found


def _is_sharp(number: arb) -> bool:
    return is_below(number.rad(), enclose(_SHARP) * (1 + abs(number)))


def _is_wide(function: StoredFunction) -> bool:
    return _HOPELESS * function.error > sum(map(abs, function.coefficients), Fraction(0))
