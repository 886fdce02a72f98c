"""What is wrong with a system: symmetries, first integral and distance at sample points.

No proof: the verifier shows the same as identities. This finds a mistake before a search does, and names it. Symmetries
and distance are compared in floating point, the rate of change of the first integral in decimal numbers of 50 digits.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import chain
from math import isfinite

from orbitproof.shared.systems.completion import functions_in_floats
from orbitproof.shared.systems.defined_coordinates import with_functions
from orbitproof.shared.systems.program import Program
from orbitproof.shared.systems.system import ReversibleSystem, System

_POINTS = 12
_TRIES = 600
_TOLERANCE = 1e-8
_FEW, _LARGEST = 4, 200
_DIGITS, _SMALL, _LEAST = 50, Decimal("1e-30"), Decimal("1e-40")
"""The rate of change of a first integral is computed with so many digits; it counts as 0 up to this part of its terms,
and up to this number."""

Numbers = Sequence[float]


def fault(system: System) -> str | None:
    """The first thing that is wrong, in one line that begins with the key and ends with the remedy; or `None`."""
    if not isinstance(system, ReversibleSystem) and system.first_integral_program is None:
        return None
    points = list(_points(system))
    if not points:
        return "field: it could not be evaluated at any sample point; correct the formulas, or the ranges of parameters"
    faults = chain(_faults(system, points) if isinstance(system, ReversibleSystem) else (), _changes(system, points))
    return next(faults, None)


def _changes(system: System, points: Sequence[tuple[Numbers, Numbers]]) -> Iterator[str]:
    """Where the first integral changes along the field."""
    integral = system.first_integral_program
    if integral is None:
        return
    with localcontext(prec=_DIGITS):
        for x, parameters in points[:_FEW]:
            try:
                parts = _rates(system, integral, x, parameters)
            except (ArithmeticError, ValueError):
                continue
            change, terms = sum(parts, Decimal(0)), sum(map(abs, parts), Decimal(0))
            if abs(change) > _LEAST + _SMALL * terms:
                yield (
                    f"first_integral: it is not conserved: its rate of change is {float(change):.6g} at "
                    f"{_place(system, x)}; correct it or the field"
                )


def _faults(system: ReversibleSystem, points: Sequence[tuple[Numbers, Numbers]]) -> Iterator[str]:
    integral, distance = system.first_integral_program, system.squared_distance_program
    if distance is not None:
        for x, parameters in points:
            image = [sign * value for sign, value in zip(system.reversing_symmetry, x, strict=True)]
            (value,), (other,) = (_values(distance, [*state, *parameters]) for state in (x, image))
            if not _agree(value, other):
                yield f"squared_distance: R changes it, at {_place(system, x)}; correct it or R"
            if value < 0:
                yield f"squared_distance: it is negative at {_place(system, x)}; give the sum of squares"
    for label, signs, orientation in (
        ("R", system.reversing_symmetry, -1),
        *((f"reversors.{name}", reversor.signs, -1) for name, reversor in system.reversors.items()),
        *((name, signs, 1) for name, signs in system.symmetries.items()),
    ):
        wanted = tuple(orientation * sign for sign in signs)
        rule = f"f({label} x) = -{label} f(x)" if orientation < 0 else f"f({label} x) = {label} f(x)"
        what = f"is not reversible under {label}" if orientation < 0 else f"does not commute with {label}"
        for x, parameters in points:
            image = [sign * value for sign, value in zip(signs, x, strict=True)]
            here, there = (_values(system.program, [*state, *parameters]) for state in (x, image))
            for name, sign, value, other in zip(system.state, wanted, here, there, strict=True):
                if not _agree(other, sign * value):
                    yield (
                        f"field.{name}: {what}: {rule} fails in this component, {other:.6g} is not {sign * value:.6g} "
                        f"at {_place(system, x)}; correct the formula or {label}"
                    )
            if integral is not None:
                (value,), (other,) = (_values(integral, [*state, *parameters]) for state in (x, image))
                if not _agree(value, other):
                    yield f"first_integral: {label} changes it, at {_place(system, x)}; correct it or {label}"
    level = system.fixed_level
    if integral is not None and system.level_coordinate is not None and (level is None or level.between is None):
        index = system.state.index(system.level_coordinate)
        factors = [factor for x, parameters in points for factor in _square_factors(integral, x, parameters, index)]
        if not all(_agree(factor, factors[0]) for factor in factors):
            form = f"A + b {system.level_coordinate}^2"
            remedy = "choose another or leave it out"
            if level is not None:
                remedy = "choose another, or give fixed_level an interval of it (between) in place of sign"
            yield f"level_coordinate: the first integral is not {form} with b constant; {remedy}"


def _square_factors(integral: Program, x: Numbers, parameters: Numbers, index: int) -> Iterator[float]:
    """b at some points, if the integral is A + b w^2 with a constant b in the coordinate w of that index."""
    places = ([*x[:index], w, *x[index + 1 :], *parameters] for w in (0.0, 1.0, -1.0, 0.5))
    try:
        base, one, other, half = (_values(integral, place)[0] for place in places)
    except (ArithmeticError, ValueError):
        return
    yield from (one - base, other - base, 4 * (half - base))


def _agree(value: float, other: float) -> bool:
    return abs(value - other) <= _TOLERANCE * (1 + abs(value) + abs(other))


def _place(system: System, x: Numbers) -> str:
    return ", ".join(f"{name} = {value:.3g}" for name, value in zip(system.state, x, strict=True))


def _points(system: System) -> Iterator[tuple[Numbers, Numbers]]:
    """Points at which the field, its images and the first integral can be evaluated."""
    source = random.Random(1)
    programs = [program for program in (system.program, system.first_integral_program) if program is not None]
    images: list[Sequence[int]] = []
    if isinstance(system, ReversibleSystem):
        programs += [] if system.squared_distance_program is None else [system.squared_distance_program]
        further = [reversor.signs for reversor in system.reversors.values()]
        images = [system.reversing_symmetry, *further, *system.symmetries.values()]
    found = 0
    for attempt in range(_TRIES):
        size = 2.0 if attempt % 2 else 0.5
        # Many coordinates may have to be positive, for logarithms and roots.
        least = 0.0 if attempt % 4 == 3 else -size
        x = [source.uniform(least, size) for _ in system.state]
        parameters = [_sample(source, interval.lower, interval.upper) for interval in system.parameters.values()]
        x = functions_in_floats(system, x, parameters)
        states = [x, *([sign * value for sign, value in zip(signs, x, strict=True)] for signs in images)]
        try:
            values = [_values(program, [*state, *parameters]) for program in programs for state in states]
        except (ArithmeticError, ValueError):
            continue
        if all(isfinite(value) for row in values for value in row):
            yield x, parameters
            found += 1
        if found == _POINTS:
            return


def _sample(source: random.Random, lower: Fraction | None, upper: Fraction | None) -> float:
    low = float(lower) if lower is not None else (float(upper) - 2.0 if upper is not None else -1.5)
    high = float(upper) if upper is not None else low + 3.0
    return source.uniform(low, high)


def _values(program: Program, arguments: Sequence[float]) -> list[float]:
    return [float(value) for value in program.evaluate(arguments, power=_power)]


def _power(base: float, exponent: Fraction) -> float:
    """Raises `ValueError` for a fractional power of a negative number."""
    if exponent.denominator == 1:
        return float(base ** int(exponent))
    if base <= 0:
        raise ValueError("a fractional power of a number that is not positive")
    return float(base ** float(exponent))


@dataclass(frozen=True)
class _Dual:
    """A decimal number and its derivative."""

    value: Decimal
    rate: Decimal

    def __add__(self, other: _Dual) -> _Dual:
        return _Dual(self.value + other.value, self.rate + other.rate)

    def __sub__(self, other: _Dual) -> _Dual:
        return _Dual(self.value - other.value, self.rate - other.rate)

    def __mul__(self, other: _Dual) -> _Dual:
        return _Dual(self.value * other.value, self.value * other.rate + self.rate * other.value)

    def __truediv__(self, other: _Dual) -> _Dual:
        value = self.value / other.value
        return _Dual(value, (self.rate - value * other.rate) / other.value)

    def power(self, exponent: Fraction) -> _Dual:
        """By d(u^a) = a u^(a - 1) du."""
        if exponent == 0:
            return _Dual(Decimal(1), Decimal(0))
        slope = _decimal(exponent) * _decimal_power(self.value, exponent - 1)
        return _Dual(_decimal_power(self.value, exponent), slope * self.rate)


def _rates(system: System, function: Program, x: Numbers, parameters: Numbers) -> list[Decimal]:
    """dH/dx_i times the velocity of x_i, for each i."""
    values = [Decimal(value) for value in parameters]
    state = with_functions(system, [Decimal(value) for value in x], values, _DECIMALS, _decimal, _decimal_power)
    velocity = system.program.evaluate([*state, *values], _decimal, _decimal_power)
    rates = []
    for chosen, speed in enumerate(velocity):
        arguments = [_Dual(value, speed if i == chosen else Decimal(0)) for i, value in enumerate(state)]
        arguments += [_Dual(value, Decimal(0)) for value in values]
        (result,) = function.evaluate(arguments, lambda value: _Dual(_decimal(value), Decimal(0)), _Dual.power)
        rates.append(result.rate)
    return rates


def _decimal(value: Fraction) -> Decimal:
    return Decimal(value.numerator) / value.denominator


def _decimal_power(base: Decimal, exponent: Fraction) -> Decimal:
    if exponent == 0:
        return Decimal(1)
    return base ** (int(exponent) if exponent.denominator == 1 else _decimal(exponent))


def _turned(x: Decimal, first: int) -> Decimal:
    """The Taylor series of cos (`first` 0) or sin (1), with more digits as its terms are larger than its sum."""
    if abs(x) > _LARGEST:
        raise ValueError("an argument is large")
    with localcontext(prec=_DIGITS + int(abs(x))):
        term, total, order = x**first if first else Decimal(1), Decimal(0), first
        while total + term != total:
            total += term
            order += 2
            term *= -x * x / (order * (order - 1))
    return +total


_DECIMALS: Mapping[str, Callable[[Decimal], Decimal]] = {
    "sin": lambda x: _turned(x, 1), "cos": lambda x: _turned(x, 0), "exp": Decimal.exp, "log": Decimal.ln,
}  # fmt: skip
