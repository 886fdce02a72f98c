"""Taylor coefficients of the orbit of the box's centre (section 3.1).

The classical recurrences, term by term, on floats (to choose the step) or on fixed-point integers
(to have the coefficients). Nothing here carries proof: the defect of whatever comes out is bounded
afterwards.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cache
from math import ceil, inf, isfinite, log2, sqrt
from operator import floordiv, mul, truediv
from typing import Any, TypeVar

import numpy as np
from flint import arb, arb_poly, fmpq

from orbitproof.verify.algebra import Floats, PreparedProgram, Recurrence, integer_part
from orbitproof.verify.evidence import IntegrationFailure, guarded
from orbitproof.verify.flow import rough

_SPARE_BITS = 16
_TINY = 2.0**-100
_LATE_BITS, _FLOAT_BITS, _MOST_BITS = 45, 50, 500
"""Coefficients that are expected to have at most so many bits are found in float64, if they have few enough then."""

Coefficient = TypeVar("Coefficient")


class TaylorRecurrence(Recurrence[Coefficient]):
    """Taylor coefficients of the solution of x' = f(x); the rows of the inputs are those of state and parameters."""

    def solve(self, initial: Sequence[Coefficient], degree: int) -> Sequence[Any]:
        """Rows of degree + 1 coefficients per component, given state and parameters at the start."""
        for row, value in zip(self.coefs, initial, strict=False):
            row[0] = value
        return self.continued(0, degree)

    def continued(self, first: int, degree: int) -> Sequence[Any]:
        """As `solve`, where the components have their coefficients up to `first`, and all nodes those before it."""
        for n in range(first, degree):
            self.extend(n)
            for component, output in enumerate(self.program.outputs):
                self.coefs[component][n + 1] = self.integral(component, n, self.coefs[output][n])
        return self.coefs[: len(self.program.outputs)]

    @abstractmethod
    def integral(self, component: int, n: int, slope: Coefficient) -> Coefficient:
        """Coefficient n + 1 of a component whose slope has coefficient n."""


class _Numbers(TaylorRecurrence[Any]):
    """In theta = t / step, with numbers of one kind.

    Args:
        constant: a number of this kind for an exact one.
        ratio: the quotient of two numbers, rounded.
        reduced: a sum of products, rounded.
        first_power: the power of a number.
    """

    def __init__(
        self,
        program: PreparedProgram,
        degree: int,
        step: Fraction,
        constant: Callable[[Fraction], Any],
        ratio: Callable[[Any, Any], Any],
        reduced: Callable[[Any], Any],
        first_power: Callable[[Any, Fraction], Any],
    ) -> None:
        super().__init__(program, [[0] * (degree + 1) for _ in program.nodes])
        self.step, self.ratio, self.reduced, self.first_power = step, ratio, reduced, first_power
        self._constant = constant
        self._weighted: dict[int, list[Any]] = {}
        self._steady = _steady(program)

    def constant(self, index: int, value: Fraction) -> Any:
        return self._constant(value)

    def scaled(self, index: int, n: int, coefficient: Any, factor: Fraction) -> Any:
        value = coefficient * factor.numerator
        return value if factor.denominator == 1 else self.ratio(value, factor.denominator)

    def product(self, index: int, n: int, left: Sequence[Any], right: Sequence[Any]) -> Any:
        node = self.program.nodes[index]
        if node.left in self._steady:
            return self.reduced(left[0] * right[n])
        if node.right in self._steady:
            return self.reduced(left[n] * right[0])
        backward = right[n::-1]
        if left is not right:
            return self.reduced(sum(map(mul, left, backward)))
        half = (n + 1) // 2
        value = 2 * sum(map(mul, left[:half], backward))
        return self.reduced(value if n % 2 else value + left[half] * left[half])

    def power(self, index: int, n: int, base: Sequence[Any], exponent: Fraction) -> Any:
        if n == 0:
            return self.first_power(base[0], exponent)
        weighted = self._weighted.setdefault(index, [0])
        weighted += [k * base[k] for k in range(len(weighted), n + 1)]
        p, q = exponent.numerator, exponent.denominator
        backward = self.coefs[index][n - 1 :: -1]
        plain = sum(map(mul, base[1:], backward))
        heavy = sum(map(mul, weighted[1:], backward))
        return self.ratio((p + q) * heavy - q * n * plain, q * n * base[0])

    def integral(self, component: int, n: int, slope: Any) -> Any:
        return self.ratio(slope * self.step.numerator, self.step.denominator * (n + 1))


def _steady(program: PreparedProgram) -> set[int]:
    """The nodes that depend on parameters alone."""
    steady: set[int] = set()
    for index, node in enumerate(program.nodes):
        is_input = node.operation == "input"
        if index >= len(program.outputs) if is_input else {node.left, node.right} - {-1} <= steady:
            steady.add(index)
    return steady


def _float_power(base: float, exponent: Fraction) -> float:
    return float(base ** float(exponent))


def float_coefficients(program: PreparedProgram, initial: Sequence[float], degree: int) -> Sequence[list[float]]:
    """Taylor coefficients in time of the orbit, degree + 1 per state coordinate, in float64.

    Args:
        initial: state, then parameters.
    """
    try:
        return _Numbers(program, degree, Fraction(1), float, truediv, float, _float_power).solve(initial, degree)
    except (ZeroDivisionError, OverflowError, TypeError):
        raise _singular() from None


def variation_coefficients(
    program: PreparedProgram, initial: Sequence[float], degree: int
) -> tuple[list[list[float]], list[list[float]]]:
    """Taylor coefficients in time of the orbit and of a solution of the linearised equation along it, in float64.

    This one starts in a direction with a part in every mode; a step that suits it suits the derivatives of the flow.
    By an imaginary part too small to be squared.

    Args:
        initial: state, then parameters; the parameters stay.
    """

    def power(base: complex, exponent: Fraction) -> complex:
        base = complex(base)
        value = _float_power(base.real, exponent)
        return complex(value, float(exponent) * value / base.real * base.imag)

    size = len(program.outputs)
    start = [complex(value, _TINY / (1 + index)) if index < size else value for index, value in enumerate(initial)]
    try:
        rows = _Numbers(program, degree, Fraction(1), float, truediv, complex, power).solve(start, degree)
    except (ZeroDivisionError, OverflowError, TypeError):
        raise _singular() from None
    values = [[complex(value) for value in row] for row in rows]
    return [[value.real for value in row] for row in values], [[value.imag / _TINY for value in row] for row in values]


def fixed_coefficients(
    program: PreparedProgram, initial: Sequence[int], degree: int, bits: int, step: Fraction
) -> Sequence[list[int]]:
    """Taylor coefficients in theta = t / step of the orbit, integers times 2^-bits.

    The last ones, which have few bits, are found in float64.
    """

    def power(base: int, exponent: Fraction) -> int:
        with guarded(bits):
            scale = arb(2) ** bits
            value = integer_part((arb(base) / scale) ** (arb(exponent.numerator) / exponent.denominator) * scale)
        if value is None:
            raise _singular()
        return int(value)

    def constant(value: Fraction) -> int:
        return int(value * 2**bits)

    exact = _Numbers(program, degree, step, constant, floordiv, lambda product: product >> bits, power)
    first = degree * max(0, bits - _LATE_BITS) // bits
    try:
        rows = exact.solve(initial, first)
        last = (abs(value) for row in rows for value in row[: first + 1][-2:])
        if bits <= _MOST_BITS and max(last).bit_length() <= _FLOAT_BITS:
            with suppress(OverflowError, ValueError):
                return _continued_in_floats(exact, first, degree, 2.0**bits)
        return exact.continued(first, degree)
    except ZeroDivisionError:
        raise _singular() from None


def _continued_in_floats(exact: _Numbers, first: int, degree: int, unit: float) -> list[list[int]]:
    """As `TaylorRecurrence.continued`, of integers times 1 / unit; what follows is found in float64."""
    floats = _Numbers(exact.program, degree, exact.step, float, truediv, float, _float_power)
    floats.coefs = [[value / unit for value in row] for row in exact.coefs]
    late = floats.continued(first, degree)
    return [
        before[: first + 1] + [int(value * unit) for value in after[first + 1 :]]
        for before, after in zip(exact.coefs, late, strict=False)
    ]


def rescaled(coefficients: Sequence[Sequence[int]], bits: int, share: Fraction) -> list[list[int]]:
    """Coefficients of the orbit over a part of the step, 0 < share <= 1."""
    unit = bits + _SPARE_BITS
    powers = [1 << unit]
    for _ in coefficients[0][1:]:
        powers.append(powers[-1] * share.numerator // share.denominator)
    return [[value * power >> unit for value, power in zip(row, powers, strict=True)] for row in coefficients]


def _singular() -> IntegrationFailure:
    return IntegrationFailure(
        "singularity",
        "the vector field has no Taylor expansion along the centre's orbit",
        "the orbit meets a singularity of the vector field (a collision): give another centre",
    )


def step_size(coefficients: Sequence[Sequence[float]], log2_tolerance: float, degree: int) -> float:
    """A step for which the Taylor coefficient of order `degree` falls below 2^log2_tolerance.

    The given coefficients may end earlier; their decay is extrapolated. Raises `IntegrationFailure`
    if they are not finite.
    """
    order = len(coefficients[0]) - 1
    half = order // 2
    sizes = []
    for n in (half - 1, half, order - 1, order):
        size = max(abs(series[n]) for series in coefficients)
        if not isfinite(size):
            raise _singular()
        sizes.append(log2(size) if size > 0 else -inf)
    early, late = max(sizes[:2]), max(sizes[2:])
    if late == -inf:
        return 2.0**20
    decay = (late - early) / (order - half) if early > -inf else 0.0
    last = late + decay * (degree - order)
    return float(2.0 ** min((log2_tolerance - last) / degree, 20.0))


def next_crossing(coefficients: Sequence[int], bits: int, starts_on_section: bool) -> Fraction | None:
    """The first root of a time polynomial in (0, 1], dyadic with about `bits` bits; not rigorous."""
    # Without its root at 0 the polynomial shows the next one, however close that is.
    searched = coefficients[1:] if starts_on_section else coefficients
    guess = _first_root(searched, bits)
    return None if guess is None else _polish(coefficients, bits, guess)


_SAMPLES = 64


@cache
def _powers(length: int) -> Floats:
    """Powers of the places where a time polynomial of so many coefficients is looked at, one row per place."""
    return np.power.outer(np.arange(_SAMPLES + 1) / _SAMPLES, np.arange(length))


def _first_root(coefficients: Sequence[int], bits: int) -> float | None:
    floats = np.array(rough(coefficients, bits))
    values = (_powers(len(floats)) @ floats).tolist()
    rises = (_powers(len(floats) - 1) @ (floats * np.arange(len(floats)))[1:] > 0).tolist()
    sizes = [inf, *map(abs, values), inf]
    for index, after in enumerate(values):
        if index and (values[index - 1] < 0) != (after < 0):
            root = _polish(coefficients, bits, (index - 0.5) / _SAMPLES)
            return None if root is None else float(root)
        turns = rises[max(index - 1, 0)] != rises[min(index + 1, _SAMPLES)]
        if turns and sizes[index + 1] <= min(sizes[index], sizes[index + 2]):
            before = _root_before_extremum(coefficients, bits, index, after < 0)
            if before is not None:
                return before
    return None


def _root_before_extremum(coefficients: Sequence[int], bits: int, index: int, negative: bool) -> float | None:
    """The first of two roots close to each other near a sample, if values between them have the other sign."""
    slopes = [power * c for power, c in enumerate(coefficients)][1:]
    extremum = _polish(slopes, bits, index / _SAMPLES)
    if extremum is None or abs(extremum * _SAMPLES - index) > 1:
        return None
    polynomial, place = _in_balls(coefficients, bits), arb(fmpq(extremum.numerator, extremum.denominator))
    height, curvature = (float(each(place)) for each in (polynomial, polynomial.derivative().derivative()))
    if (height < 0) == negative or height * curvature >= 0:
        return None
    root = _polish(coefficients, bits, float(extremum) - sqrt(-2 * height / curvature))
    return None if root is None else float(root)


def _in_balls(coefficients: Sequence[int], bits: int) -> arb_poly:
    return arb_poly([arb(c) * arb(2) ** -bits for c in coefficients])


def _polish(coefficients: Sequence[int], bits: int, guess: float) -> Fraction | None:
    polynomial = _in_balls(coefficients, bits)
    slope = polynomial.derivative()
    root = arb(guess)
    for _ in range(3 + ceil(log2(bits))):
        root = (root - polynomial(root) / slope(root)).mid()
        if not root.is_finite():
            return None
    scaled = integer_part(root * arb(2) ** bits)
    result = Fraction(0 if scaled is None else int(scaled), 2**bits)
    return result if 0 < result <= 1 else None
