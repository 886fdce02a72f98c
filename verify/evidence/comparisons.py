"""Certain comparisons of balls (section 7.1).

A ball `arb` stands for every real number of a closed interval. A comparison here is True only if it
holds for all of them and the balls are finite; NaN, infinities and undecided cases are False, which
means "not shown", never "shown to be false". Elsewhere a proof compares exact rational ends of finite balls only,
or asks whether two enclosures of one number overlap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction

from flint import arb, arb_poly, fmpq

from orbitproof.shared.numbers import dyadic


class EmptyIntersectionError(ArithmeticError):
    """Two enclosures of one number are disjoint: one of them cannot be right, so nothing is proved."""


def enclose(value: Fraction) -> arb:
    """A ball that contains `value`."""
    return arb(fmpq(value.numerator, value.denominator))


def exact_value(point: arb) -> Fraction:
    """The exact value of a ball of radius zero, for example a midpoint or a radius."""
    mantissa, exponent = point.man_exp()
    return dyadic(int(mantissa), int(exponent))


def bounds(ball: arb) -> tuple[Fraction, Fraction]:
    """Exact lower and upper end of a finite ball. Raises `ValueError` for others."""
    if not ball.is_finite():
        raise ValueError("the ball is not finite")
    middle, radius = exact_value(ball.mid()), exact_value(ball.rad())
    return middle - radius, middle + radius


def symmetric(radius: Fraction) -> arb:
    """A ball that contains [-radius, radius], for radius >= 0."""
    return arb(0, enclose(radius).upper())


def dyadic_above(bound: arb) -> Fraction:
    """A dyadic number with at most 24 bits that is at least a finite bound. Raises `ValueError` for others."""
    if not bound.is_finite():
        raise ValueError("a bound is not finite")
    mantissa, exponent = bound.abs_upper().man_exp()
    shift = max(0, int(mantissa).bit_length() - 24)
    return Fraction(-(-int(mantissa) >> shift)) * Fraction(2) ** (int(exponent) + shift)


def power(base: arb, exponent: Fraction) -> arb:
    """A ball that contains the powers of the points of a ball; not finite where one is not defined (claim 12.6)."""
    if exponent.denominator > 1 and not is_positive(base):
        # FLINT has square roots of balls that begin at 0, where a program is not defined.
        return arb("nan")
    # FLINT takes them as exp(exponent log base) where the midpoint is 0, which is not finite; here they are products.
    if base.mid() == 0 and exponent.denominator == 1 and exponent > 0:
        return (arb_poly([base]) ** exponent.numerator)[0]
    return base ** enclose(exponent)


FUNCTIONS: Mapping[str, Callable[[arb], arb]] = {"sin": arb.sin, "cos": arb.cos, "exp": arb.exp, "log": arb.log}
"""Functions of balls: what contains their values at the points of a ball."""


def is_below(left: arb, right: arb) -> bool:
    """Whether left < right for every choice of points of two finite balls."""
    return left.is_finite() and right.is_finite() and (left < right) is True


def is_positive(ball: arb) -> bool:
    """Whether the ball is finite and all of it is positive."""
    return is_below(arb(0), ball)


def excludes_zero(ball: arb) -> bool:
    """Whether the ball is finite and does not contain zero."""
    return is_positive(ball) or is_positive(-ball)


def sign(ball: arb) -> int:
    """1 or -1 if the whole ball has this sign, else 0 for "not known"."""
    return 1 if is_positive(ball) else -1 if is_positive(-ball) else 0


def is_inside(ball: arb, radius: Fraction) -> bool:
    """Whether the ball lies in the open interval (-radius, radius)."""
    bound = enclose(radius)
    return is_below(ball, bound) and is_below(-bound, ball)


def is_outside(ball: arb, radius: Fraction) -> bool:
    """Whether the ball is disjoint from [-radius, radius]."""
    bound = enclose(radius)
    return is_below(bound, ball) or is_below(ball, -bound)


def all_finite(balls: Iterable[arb]) -> bool:
    """Whether there is at least one ball and none is NaN or infinite."""
    checks = [ball.is_finite() for ball in balls]
    return bool(checks) and all(checks)


def meet(first: arb, *others: arb) -> arb:
    """A ball that contains the intersection: every argument must enclose the same numbers.

    Arguments that are not finite say nothing and are skipped. Raises `EmptyIntersectionError` if the
    finite ones have no point in common.
    """
    result = first
    for ball in others:
        if not ball.is_finite():
            continue
        if not result.is_finite():
            result = ball
            continue
        try:
            result = result.intersection(ball)
        except ValueError:
            raise EmptyIntersectionError("two enclosures of the same quantity are disjoint") from None
    return result


def hull(first: arb, *others: arb) -> arb:
    """A ball that contains the convex hull of all arguments."""
    result = first
    for ball in others:
        result = result.union(ball)
    return result


def up_to(bound: arb) -> arb:
    """A ball that contains [0, b] for every b in `bound`."""
    return hull(arb(0), bound)


def total(terms: Iterable[arb]) -> arb:
    """Enclosure of the sum; zero for no terms."""
    result = arb(0)
    for term in terms:
        result = result + term
    return result


def dot(left: Sequence[arb], right: Sequence[arb]) -> arb:
    """Enclosure of the inner product of two vectors of the same length."""
    return total(a * b for a, b in zip(left, right, strict=True))
