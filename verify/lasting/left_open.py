"""What is left open of the twist on an interval of a piece, and what is looked at closer (29.5). Carries no proof."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Piece
from orbitproof.verify.curve import Interval
from orbitproof.verify.evidence import dyadic_above, enclose, exact_value, is_below, is_positive
from orbitproof.verify.functions import REACH, BoundedFunction, StoredFunction
from orbitproof.verify.lasting.stored import CurveIntervalResult, TwistFunctions, may_be_stable, parts_from
from orbitproof.verify.stability import PRECISION, StabilityFunctions, Zeros, between, resonant_value, zeros_on

_HOPELESS = 2**10
"""A shorter interval helps, and more precision little, where a bound is not so many times as small as its function."""
_SHARP, _ISOLATED = Fraction(1, 2**42), Fraction(1, 2**6)
"""What is known worse than by the first, of level or half period, is looked at closer, if tau is known by the second.
"""
_SHORT = Fraction(1, 2**5)
"""A length in tau: where a twist is undecided on no more than that, a closer look decides."""
_AROUND = 4
"""A closer look goes so many times as far as an exception is uncertain: beyond it the first one excludes another, and
with few powers of sigma little is known on a longer interval."""
_LEAST = Fraction(1, 2**16)
"""A length in tau: and no less far than that."""


def twist_open_on(piece: Piece, result: CurveIntervalResult) -> str:
    """Why the twist of linearly stable orbits is not decided on a proved interval, as `stability.open_on` says it."""
    if not isinstance(result.stability, StabilityFunctions):
        return "" if isinstance(result.twist, TwistFunctions) else "stability"
    if not isinstance(result.twist, TwistFunctions):
        return "stability" if may_be_stable(result.stability) else ""
    parts = parts_from(_beginning(piece, result))
    with ctx.workprec(PRECISION):
        s = result.stability.characteristic[0].enclosed
        stored = result.twist.twist, result.twist.exchanged
        for low, high in _elliptic(s, parts[1:-1]):
            found = [zeros_on(function.enclosed, low, high) for function in stored]
            # The second one decides where the first one does not.
            if any(last - first > _SHORT for first, last in _undecided(*found)):
                return "stability" if all(map(_is_wide, stored)) else "zeros"
            decided = min(found, key=lambda zeros: len(zeros.undecided))
            if not all(is_below(zero.place.rad(), enclose(_ISOLATED)) for zero in decided.zeros):
                return "zeros"
    return ""


def exceptions_to_sharpen(piece: Piece, result: CurveIntervalResult) -> list[Interval]:
    """Short intervals of s about resonances 1:3 and 1:4 and orbits without twist that a result knows roughly."""
    known, twist = result.stability, result.twist
    if not (isinstance(known, StabilityFunctions) and isinstance(twist, TwistFunctions)):
        return []
    (low, high), end = result.interval, 1 / REACH
    middle, radius = (low + high) / 2, (high - low) / 2 * REACH
    found: list[Interval] = []

    def look(place: Fraction, far: Fraction) -> None:
        begin, last = (middle + radius * (place + sign * max(far, _LEAST)) for sign in (-1, 1))
        found.append((max(begin, low), min(last, high)))

    with ctx.workprec(PRECISION):
        s, level, half_period = (each.enclosed for each in (known.characteristic[0], known.level, known.half_period))
        functions = [s.shifted(-resonant_value(k, 1)) for k in (3, 4)]
        functions += [twist.twist.enclosed, twist.exchanged.enclosed]
        *resonances, first, second = (zeros_on(function, _beginning(piece, result), end) for function in functions)
        for zeros in (*resonances, first):
            for zero in zeros.zeros:
                value, uncertain = s.value(zero.place), dyadic_above(zero.place.rad())
                sharp = all(_is_sharp(quantity.value(zero.place)) for quantity in (level, half_period))
                if not sharp and uncertain < _ISOLATED and is_positive(1 - value * value):
                    look(round(exact_value(zero.place.mid()) / _SHARP) * _SHARP, _AROUND * uncertain)
        for start, stop in _undecided(first, second):
            value = s.value(between(start, stop))
            if stop - start <= _SHORT and is_positive(1 - value * value):
                look((start + stop) / 2, stop - start)
    return found


def _beginning(piece: Piece, result: CurveIntervalResult) -> Fraction:
    """The first value of tau that counts; those of a symmetric piece are even."""
    return Fraction(0) if piece.is_symmetric and result.interval[0] <= 0 <= result.interval[1] else -1 / REACH


def _elliptic(s: BoundedFunction, parts: Sequence[Interval]) -> list[Interval]:
    """Intervals of tau that are made of those parts on which all orbits are elliptic for certain."""
    found: list[Interval] = []
    for low, high in parts:
        value = s.value(between(low, high))
        if is_positive(1 - value * value):
            found.append((found.pop()[0] if found and found[-1][1] == low else low, high))
    return found


def _undecided(first: Zeros, second: Zeros) -> list[Interval]:
    """Where zeros of Theta are undecided, and those of its other form too."""
    return [
        (low, high)
        for low, high in first.undecided
        if any(start < high and low < end for start, end in second.undecided)
    ]


def _is_sharp(number: arb) -> bool:
    return is_below(number.rad(), enclose(_SHARP) * (1 + abs(number)))


def _is_wide(function: StoredFunction) -> bool:
    return _HOPELESS * function.error > sum(map(abs, function.coefficients), Fraction(0))
