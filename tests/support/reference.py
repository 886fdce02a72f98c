"""An independent integrator for tests: Taylor recurrences written by hand, in plain fixed-point integers.

It shares nothing with shared/program.py or verify/. Numbers are integers times 2^-bits. Steps are taken so small
that the truncation is of the size of the rounding; the orbits of the tests are good to about 2^-(bits - 20).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import isqrt
from operator import mul

Series = list[int]
Recurrence = Callable[[Sequence[int], Sequence[int], int, int], list[Series]]


@dataclass(frozen=True)
class Crossing:
    """Where an orbit meets the section."""

    time: Fraction
    state: tuple[Fraction, ...]


def convolution(left: Series, right: Series, bits: int) -> int:
    """Coefficient of the order len(left) - 1 of a product."""
    return sum(map(mul, left, reversed(right))) >> bits


def square(series: Series, bits: int) -> int:
    """Coefficient of the order len(series) - 1 of a square."""
    half = len(series) // 2
    value = 2 * sum(map(mul, series[:half], reversed(series)))
    if len(series) % 2:
        value += series[half] ** 2
    return value >> bits


def inverse_cube(distance: int, bits: int) -> int:
    """distance^(-3/2) for a squared distance."""
    root = isqrt(distance << bits)
    return (1 << 3 * bits) // (distance * root)


def append_inverse_cube(cube: Series, distance: Series, slope: Series, bits: int) -> None:
    """Next coefficient of u = s^(-3/2) from s u' = -3/2 s' u; `slope` holds j s_j, j from 1."""
    n = len(distance) - 1
    if n == 0:
        cube.append(inverse_cube(distance[0], bits))
        return
    slope.append(n * distance[n])
    backward = cube[::-1]
    total = sum(map(mul, slope, backward)) + 2 * n * sum(map(mul, distance[1:], backward))
    cube.append(-total // (2 * n * distance[0]))


def three_body(state: Sequence[int], parameters: Sequence[int], degree: int, bits: int) -> list[Series]:
    """Taylor coefficients of the CR3BP in rotating coordinates, (x, y, z, vx, vy, vz); parameter mu."""
    (mu,) = parameters
    one = 1 << bits
    x, y, z, vx, vy, vz = ([value] for value in state)
    s1: Series = []
    s2: Series = []
    u1: Series = []
    u2: Series = []
    slope1: Series = []
    slope2: Series = []
    both: Series = []
    to_larger: Series = []
    for n in range(degree):
        to_larger.append(x[n] + mu if n == 0 else x[n])
        s1.append(square(to_larger, bits) + square(y, bits) + square(z, bits))
        # The smaller primary is at a distance of one from the larger.
        s2.append(s1[n] - 2 * to_larger[n] + (one if n == 0 else 0))
        append_inverse_cube(u1, s1, slope1, bits)
        append_inverse_cube(u2, s2, slope2, bits)
        both.append(((one - mu) * u1[n] + mu * u2[n]) >> bits)
        ax = x[n] + 2 * vy[n]
        ax -= convolution(both, to_larger, bits) - (mu * u2[n] >> bits)
        ay = y[n] - 2 * vx[n] - convolution(both, y, bits)
        az = -convolution(both, z, bits)
        for position, velocity, acceleration in ((x, vx, ax), (y, vy, ay), (z, vz, az)):
            position.append(velocity[n] // (n + 1))
            velocity.append(acceleration // (n + 1))
    return [x, y, z, vx, vy, vz]


def falkner_skan(state: Sequence[int], parameters: Sequence[int], degree: int, bits: int) -> list[Series]:
    """Taylor coefficients of x' = y, y' = z, z' = beta (y^2 - 1) - x z; parameter beta."""
    (beta,) = parameters
    x, y, z = ([value] for value in state)
    for n in range(degree):
        growth = square(y, bits) - ((1 << bits) if n == 0 else 0)
        slope = (beta * growth >> bits) - convolution(x, z, bits)
        x.append(y[n] // (n + 1))
        y.append(z[n] // (n + 1))
        z.append(slope // (n + 1))
    return [x, y, z]


def value_at(series: Series, time: int, bits: int) -> int:
    """The value of a Taylor polynomial."""
    result = 0
    for coefficient in reversed(series):
        result = (result * time >> bits) + coefficient
    return result


def _step(coefficients: Sequence[Series], bits: int) -> int:
    """A step after which the last Taylor terms are about 2^-bits."""
    last = len(coefficients[0]) - 1
    logs = [max(max(abs(series[n]) for series in coefficients), 1).bit_length() / n for n in (last - 1, last)]
    return max(1, int(2.0 ** (60 - max(logs)))) << (bits - 60)


@dataclass(frozen=True)
class Orbits:
    """Orbits of one system.

    Attributes:
        recurrence: its Taylor recurrence.
        section: index of the coordinate whose vanishing is the section.
        bits: fractional bits; the degree of the expansions follows.
    """

    recurrence: Recurrence
    section: int
    bits: int = 170

    @property
    def degree(self) -> int:
        """Degree of the expansions."""
        return self.bits * 3 // 8

    def fixed(self, value: Fraction) -> int:
        """A number in fixed point."""
        return (value.numerator << self.bits) // value.denominator

    def exact(self, values: Sequence[int]) -> tuple[Fraction, ...]:
        """The fractions that fixed-point numbers stand for."""
        return tuple(Fraction(value, 1 << self.bits) for value in values)

    def flow(self, start: Sequence[Fraction], parameters: Sequence[Fraction], time: Fraction) -> tuple[Fraction, ...]:
        """The state after a positive time."""
        state = [self.fixed(value) for value in start]
        constants = [self.fixed(value) for value in parameters]
        left = self.fixed(time)
        while left:
            coefficients = self.recurrence(state, constants, self.degree, self.bits)
            step = min(left, _step(coefficients, self.bits))
            state = [value_at(series, step, self.bits) for series in coefficients]
            left -= step
        return self.exact(state)

    def crossings(self, start: Sequence[Fraction], parameters: Sequence[Fraction], count: int) -> list[Crossing]:
        """The first `count` crossings of the section, in either direction, of an orbit that starts on it."""
        state = [self.fixed(value) for value in start]
        constants = [self.fixed(value) for value in parameters]
        found: list[Crossing] = []
        time = 0
        samples = 16
        side = 0
        while len(found) < count:
            coefficients = self.recurrence(state, constants, self.degree, self.bits)
            step = _step(coefficients, self.bits)
            across = coefficients[self.section]
            for index in range(1, samples + 1):
                value = value_at(across, step * index // samples, self.bits)
                sign = (value > 0) - (value < 0)
                if side and sign == -side:
                    root = self._root(across, step * (2 * index - 1) // (2 * samples))
                    image = [value_at(series, root, self.bits) for series in coefficients]
                    found.append(Crossing(Fraction(time + root, 1 << self.bits), self.exact(image)))
                side = sign or side
            state = [value_at(series, step, self.bits) for series in coefficients]
            time += step
        return found[:count]

    def _root(self, series: Series, guess: int) -> int:
        slope = [n * value for n, value in enumerate(series)][1:]
        for _ in range(60):
            correction = (value_at(series, guess, self.bits) << self.bits) // value_at(slope, guess, self.bits)
            guess -= correction
            if abs(correction) <= 4:
                return guess
        raise ArithmeticError("no root where the section coordinate changes sign")


def finite_differences(
    function: Callable[[tuple[Fraction, ...]], Sequence[Fraction]], point: Sequence[Fraction], step: Fraction
) -> dict[tuple[int, ...], list[Fraction]]:
    """All partial derivatives up to order 3 by central differences, with errors of order step^2."""
    size = len(point)
    seen: dict[tuple[int, ...], Sequence[Fraction]] = {}

    def at(shift: tuple[int, ...]) -> Sequence[Fraction]:
        if shift not in seen:
            seen[shift] = function(tuple(x + step * n for x, n in zip(point, shift, strict=True)))
        return seen[shift]

    # Weights of the central difference of each order, by shift; they are multiplied over the variables.
    half = Fraction(1, 2)
    stencils: dict[int, dict[int, Fraction]] = {
        0: {0: Fraction(1)},
        1: {1: half, -1: -half},
        2: {1: Fraction(1), 0: Fraction(-2), -1: Fraction(1)},
        3: {2: half, 1: Fraction(-1), -1: Fraction(1), -2: -half},
    }
    result: dict[tuple[int, ...], list[Fraction]] = {}
    for alpha in product(range(4), repeat=size):
        if sum(alpha) > 3:
            continue
        values: list[Fraction] | None = None
        for shift in product(*(stencils[order] for order in alpha)):
            weight = Fraction(1)
            for order, n in zip(alpha, shift, strict=True):
                weight *= stencils[order][n]
            terms = [weight * value for value in at(shift)]
            values = terms if values is None else [a + b for a, b in zip(values, terms, strict=True)]
        assert values is not None
        result[alpha] = [value / step ** sum(alpha) for value in values]
    return result
