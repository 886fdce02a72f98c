"""sin, cos, exp and log of elements of the algebra, and coordinates that are such functions (section 5.5)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import factorial, log2

from flint import arb, fmpz_poly

from orbitproof.shared.systems import Program, System
from orbitproof.verify.algebra import Series, at_start, convolve, geometric, inflate, without_time
from orbitproof.verify.evidence import IntegrationFailure, enclose, exact_value

_MOST_TERMS = 120


def function_of(name: str, argument: Series) -> Series:
    """Enclosure of sin, cos, exp or log of an element that does not depend on time.

    Raises `IntegrationFailure` unless its series converges well on the whole set.
    """
    whole, argument = argument.arithmetic, without_time(argument)
    arithmetic = argument.arithmetic
    middle = Fraction(int(argument.coefs[0][0]), int(arithmetic.one))
    # Of the constant coefficient only what does not depend on the wide variable is the middle.
    rest = Series(arithmetic, [_without_constant(argument.coefs[0]), *argument.coefs[1:]], argument.errors)
    if name == "log":
        if middle <= 0:
            raise _too_far(name)
        rest = rest.scaled(1 / middle)
    norm = rest.norm()
    last = _last_power(arithmetic.grading.top, norm[0], arithmetic.bits)
    coefficients, bound = _taylor(name, middle, last)
    tail = geometric(norm)
    if tail is None:
        raise _too_far(name)
    result, power = _constant(argument, coefficients[0]), rest
    for coefficient in coefficients[1:]:
        result = result + power * _constant(argument, coefficient)
        power = power * rest
    # All terms after these are rest^last + 1 times a coefficient times a power of rest.
    remainder = convolve(power.norm(), [1.0 + tail[0], *tail[1:]])
    errors = [inflate(e + bound * r) for e, r in zip(result.errors, remainder, strict=True)]
    return Series(whole, result.coefs, errors)


def defined_values(
    defined: Sequence[tuple[str, Program]], state: Sequence[Series], parameters: Sequence[Series]
) -> list[Series]:
    """State coordinates that are functions of those before them, each as (function, program of its argument).

    The programs take all of the state and the parameters.
    """
    values = list(state)
    zero = parameters[0] if parameters else state[0]
    missing = zero.arithmetic.constant(Fraction(0))
    for place, (function, argument) in enumerate(defined):
        later = [missing] * (len(defined) - place)
        values.append(function_of(function, at_start(argument, (*values, *later, *parameters))[0]))
    return values[len(state) :]


def with_functions(system: System, values: Sequence[Series]) -> list[Series]:
    """State and parameters with the state coordinates that are functions of others; their own entries are not used."""
    given, size = len(system.given_state), len(system.state)
    defined = [
        (each.function, argument) for each, argument in zip(system.defined, system.argument_programs, strict=True)
    ]
    return [*values[:given], *defined_values(defined, values[:given], values[size:]), *values[size:]]


def _last_power(top: int, size: float, bits: int) -> int:
    """Beyond this power the rest of the series is small where the argument depends on the wide variable."""
    last, left = max(2, top + 1), float(bits)
    while 0 < size < 1 and last < _MOST_TERMS and -(last - top) * log2(size) < left:
        last += 1
    return last


def _without_constant(polynomial: fmpz_poly) -> fmpz_poly:
    return fmpz_poly([0, *polynomial.coeffs()[1:]])


def _taylor(name: str, middle: Fraction, last: int) -> tuple[list[arb], float]:
    """Taylor coefficients up to order `last`, and a bound of the absolute values of all later ones.

    Those of log are by the relative distance from the middle.
    """
    at = enclose(middle)
    if name == "log":
        return [at.log(), *(arb((-1) ** (k + 1)) / k for k in range(1, last + 1))], 1.0
    if name == "exp":
        value = at.exp()
        size = value
        derivatives = [value] * (last + 1)
    else:
        sine, cosine, size = at.sin(), at.cos(), arb(1)
        cycle = [sine, cosine, -sine, -cosine]
        derivatives = [cycle[(k + (name == "cos")) % 4] for k in range(last + 1)]
    bound = float((size.upper() / factorial(last + 1)).upper())
    return [value / factorial(k) for k, value in enumerate(derivatives)], inflate(bound)


def _constant(like: Series, value: arb) -> Series:
    return like.arithmetic.constant(exact_value(value.mid())).widened(exact_value(value.rad()))


def _too_far(name: str) -> IntegrationFailure:
    return IntegrationFailure("start", f"{name} of the initial values is not enclosed on the set", "give smaller radii")
