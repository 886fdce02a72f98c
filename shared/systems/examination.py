"""What is wrong with a system: symmetries, first integral and distance at sample points, in floating point.

No proof: the verifier shows the same as identities. This finds a mistake before a search does, and names it.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite

from orbitproof.shared.systems.completion import functions_in_floats
from orbitproof.shared.systems.program import Program
from orbitproof.shared.systems.system import ReversibleSystem

_POINTS = 12
_TRIES = 600
_TOLERANCE = 1e-8

Numbers = Sequence[float]


def fault(system: ReversibleSystem) -> str | None:
    """The first thing that is wrong, in one line that begins with the key and ends with the remedy; or `None`."""
    points = list(_points(system))
    if not points:
        return "field: it could not be evaluated at any sample point; correct the formulas, or the ranges of parameters"
    return next(_faults(system, points), None)


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
    if integral is not None:
        for x, parameters in points:
            parts = _rates(integral, x, _values(system.program, [*x, *parameters]), parameters)
            if abs(sum(parts)) > _TOLERANCE * (1 + sum(map(abs, parts))):
                yield (
                    f"first_integral: it is not conserved: its rate of change is {sum(parts):.6g} at "
                    f"{_place(system, x)}; correct it or the field"
                )
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


def _place(system: ReversibleSystem, x: Numbers) -> str:
    return ", ".join(f"{name} = {value:.3g}" for name, value in zip(system.state, x, strict=True))


def _points(system: ReversibleSystem) -> Iterator[tuple[Numbers, Numbers]]:
    """Points at which the field, its images and the first integral can be evaluated."""
    source = random.Random(1)
    named = (system.program, system.first_integral_program, system.squared_distance_program)
    programs = [program for program in named if program is not None]
    further = [reversor.signs for reversor in system.reversors.values()]
    images = (system.reversing_symmetry, *further, *system.symmetries.values())
    found = 0
    for attempt in range(_TRIES):
        size = 2.0 if attempt % 2 else 0.5
        x = [source.uniform(-size, size) for _ in system.state]
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
    """A value and its derivative."""

    value: float
    rate: float

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
            return _Dual(1.0, 0.0)
        return _Dual(_power(self.value, exponent), float(exponent) * _power(self.value, exponent - 1) * self.rate)


def _rates(function: Program, x: Numbers, velocity: Numbers, parameters: Numbers) -> list[float]:
    """dH/dx_i times the velocity of x_i, for each i."""
    rates = []
    for chosen, speed in enumerate(velocity):
        arguments = [_Dual(value, speed if i == chosen else 0.0) for i, value in enumerate(x)]
        arguments += [_Dual(value, 0.0) for value in parameters]
        (result,) = function.evaluate(arguments, lambda value: _Dual(float(value), 0.0), _Dual.power)
        rates.append(result.rate)
    return rates
