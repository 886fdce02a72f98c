"""Coordinates that are functions of others, in units of the amplitude, where orbits begin (section 38.7)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import factorial

from orbitproof.shared.systems import System, blown_up_program, record
from orbitproof.verify.algebra import Series, convolve, fraction_above, geometric, inflate, total, without_time
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.periodic import functions_at_start
from orbitproof.verify.poincare import at_start, function_of

_MOST_TERMS = 200


def slopes_at_start(
    system: System, y: Sequence[Series], parameters: Sequence[Series], amplitude: Series, rest: Sequence[Series]
) -> list[Series]:
    """(w(c + eps y) - w(c))/eps for the coordinates w that are functions of others; at eps = 0 the derivative along y.

    Args:
        y: of the given coordinates.
        rest: c and w(c), all coordinates of the state.

    Raises `IntegrationFailure` where they are not enclosed.
    """
    whole, amplitude = amplitude.arithmetic, without_time(amplitude)
    y, parameters, rest = (list(map(without_time, each)) for each in (y, parameters, rest))
    found, missing = list(y), amplitude.arithmetic.constant(Fraction(0))
    for function, argument in functions_at_start(system):
        later = [missing] * (len(rest) - len(found))
        (before,) = at_start(argument, [*rest, *parameters])
        inputs = [*found, *later, *parameters, amplitude, *rest]
        (slope,) = at_start(blown_up_program(argument, len(rest)), inputs)
        found.append(slope * mean_slope(function, before, amplitude * slope))
    return [Series(whole, each.coefs, each.errors) for each in found[len(y) :]]


def mean_slope(function: str, at: Series, change: Series) -> Series:
    """(phi(e + d) - phi(e))/d for sin, cos, exp or log of elements that do not depend on time; phi'(e) where d is 0.

    Raises `IntegrationFailure` unless its series converge well on the whole set.
    """
    half = change.scaled(Fraction(1, 2))
    match function:
        case "exp":
            return function_of("exp", at + half) * _sine_over(half, 1)
        case "sin":
            return function_of("cos", at + half) * _sine_over(half, -1)
        case "cos":
            return function_of("sin", at + half).scaled(Fraction(-1)) * _sine_over(half, -1)
        case "log":
            inverse = _inverse(at + half)
            ratio = half * inverse
            return inverse * _sum(ratio * ratio, lambda k: Fraction(1, 2 * k + 1))
    raise ValueError(f"{function!r} is no function of a field")


def _sine_over(half: Series, sign: int) -> Series:
    """sin(u)/u, or sinh(u)/u for the sign 1."""
    return _sum(half * half, lambda k: Fraction(sign**k, factorial(2 * k + 1)), lambda k: Fraction(1, (2 * k + 2) ** 2))


def _sum(
    element: Series, coefficient: Callable[[int], Fraction], falls: Callable[[int], Fraction] = lambda k: Fraction(1)
) -> Series:
    """The sum of c_k u^k; from c_k on each coefficient is at most `falls(k)` times the one before."""
    arithmetic = element.arithmetic
    power, number = arithmetic.constant(Fraction(1)), 0
    result = power.scaled(coefficient(0))
    while number < _MOST_TERMS:
        power, number = power * element, number + 1
        if total(power.norm()) * float(abs(coefficient(number))) < 2.0**-arithmetic.bits:
            break
        result = result + power.scaled(coefficient(number))
    else:
        power, number = power * element, number + 1
    # The terms from u^number on.
    factor = fraction_above(falls(number))
    tail = geometric([inflate(factor * value) for value in element.norm()])
    if tail is None:
        raise IntegrationFailure("start", "differences of a function are not enclosed on the set", "a narrower piece")
    size, rest = fraction_above(abs(coefficient(number))), convolve(power.norm(), [1.0 + tail[0], *tail[1:]])
    return result.with_errors([inflate(e + size * r) for e, r in zip(result.errors, rest, strict=True)])


def _inverse(element: Series) -> Series:
    (found,) = at_start(record(lambda values: [values[0] ** -1], ["u"]), [element])
    return found
