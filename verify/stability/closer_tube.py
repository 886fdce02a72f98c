"""A narrower tube about a polynomial that is closer to the curve (section 18.2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil, log2

import numpy as np

from orbitproof.verify.algebra import ball_polynomial, plus, recentred, values_around
from orbitproof.verify.curve import HalfReturn, parts_of_interval
from orbitproof.verify.evidence import IntegrationFailure, dyadic_above, guarded
from orbitproof.verify.stability.along import about_zero
from orbitproof.verify.stability.matrix import SPARE_BITS, TubeOfOrbits

_SHARPER, _ABOVE_NOISE, _WORTH_SHARPENING = 2.0**-32, 2.0**12, 2.0**-8
"""A tube so many times as narrow is followed about a polynomial that is closer to the curve, or of so many times the
error of the first return, if that makes it narrower than the last one says."""
_PARTS = 64
"""Parts of the interval, on which the distance of two polynomials is bounded."""


def sharpened(
    tube: TubeOfOrbits, half: HalfReturn | None, progress: Callable[[float], None] | None = None
) -> tuple[TubeOfOrbits, HalfReturn | None]:
    """A narrower tube with the same curve, about a closer polynomial, and its return; what is given, if there is none.

    Arguments as `orbit_functions`.
    """
    with guarded(tube.limits.precision + SPARE_BITS), np.errstate(all="ignore"):
        try:
            return (tube, half) if half is None else _closer(tube, half, progress)
        except (IntegrationFailure, ArithmeticError, ValueError):
            return tube, half


def about_closer_polynomial(tube: TubeOfOrbits, half: HalfReturn | None) -> tuple[TubeOfOrbits, HalfReturn | None]:
    """A tube of the same curve about a closer polynomial, its return to be found; what is given, if there is none.

    Where derivatives across the curve grow by hundreds, the distance of the polynomial from the curve at complex s,
    times second derivatives, is too much of them.
    """
    with guarded(tube.limits.precision + SPARE_BITS), np.errstate(all="ignore"):
        try:
            return (tube, half) if half is None else (_recentred(tube, half), None)
        except (IntegrationFailure, ArithmeticError, ValueError):
            return tube, half


def _closer(
    orbits: TubeOfOrbits, half: HalfReturn, progress: Callable[[float], None] | None
) -> tuple[TubeOfOrbits, HalfReturn]:
    """A narrower tube about a closer polynomial, inside of this one, and its return (section 18.2)."""
    followed = _recentred(orbits, half)
    equations = [half.state[index] for index in orbits.system.kernel_coordinates]
    noise = max(equation.errors[0] / (equation.known[1] or 1.0) for equation in equations)
    share = Fraction(2) ** ceil(log2(max(_SHARPER, _ABOVE_NOISE * noise)))
    if share > _WORTH_SHARPENING:
        raise _no_tube()
    return followed, followed.follow([width * share for width in half.widths], progress)


def _recentred(orbits: TubeOfOrbits, half: HalfReturn) -> TubeOfOrbits:
    """The part of the tube about a closer polynomial that is certainly in it (section 18.2)."""
    polynomials, tube = [], []
    for j, known in enumerate(about_zero(orbits.arithmetic, orbits.equations(half))):
        width = half.widths[j]
        # Rounding changes which polynomial this is, and nothing else.
        unit = Fraction(1, 2 ** (orbits.limits.precision + SPARE_BITS))
        change = [round(width * value / unit) * unit for value in known]
        if orbits.divided:
            change[1::2] = [Fraction(0)] * len(change[1::2])
        polynomials.append(plus(orbits.piece.polynomial[j], _by_s(change, orbits.middle, orbits.radius), Fraction(1)))
        tube.append(orbits.piece.tube[j] - _largest(change))
    if not min(tube) > 0:
        raise _no_tube()
    return replace(orbits, piece=replace(orbits.piece, polynomial=tuple(polynomials), tube=tuple(tube)))


def _largest(coefficients: Sequence[Fraction]) -> Fraction:
    """A bound of a polynomial in sigma on the interval of the proof, where sigma is real."""
    polynomial = ball_polynomial(coefficients)
    return max(dyadic_above(values_around(polynomial, part.mid(), part.rad())) for part in parts_of_interval(_PARTS))


def _no_tube() -> IntegrationFailure:
    return IntegrationFailure("stability", "the curve is not shown to be in its tube", "give a wider tube")


def _by_s(coefficients: Sequence[Fraction], middle: Fraction, radius: Fraction) -> list[Fraction]:
    """Coefficients in s = middle + radius sigma of a polynomial in sigma, exactly."""
    return recentred([value / radius**n for n, value in enumerate(coefficients)], -middle, Fraction(1))
