"""Taylor coefficients of the orbit of the box's centre (section 3.1).

The classical recurrences, term by term, on floats (to choose the step) or on fixed-point integers
(to have the coefficients). Nothing here carries proof: the defect of whatever comes out is bounded
afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor, inf, isfinite, log2
from operator import mul
from typing import Any

from flint import arb, arb_poly

from orbitproof.verify.algebra import PreparedProgram, integer_part
from orbitproof.verify.evidence import IntegrationFailure, guarded

_STEP_BITS = 12


def float_coefficients(
    program: PreparedProgram, state: Sequence[float], parameters: Sequence[float], degree: int
) -> list[list[float]]:
    """Taylor coefficients in time of the orbit, degree + 1 per state coordinate, in float64."""

    def power(base: float, exponent: Fraction) -> float:
        return float(base ** float(exponent))

    try:
        return _coefficients(program, list(state), list(parameters), degree, None, Fraction(1), power)
    except (ZeroDivisionError, OverflowError, TypeError):
        raise _singular() from None


def fixed_coefficients(
    program: PreparedProgram,
    state: Sequence[int],
    parameters: Sequence[int],
    degree: int,
    bits: int,
    step: Fraction,
) -> list[list[int]]:
    """Taylor coefficients in theta = t / step of the orbit, integers times 2^-bits."""

    def power(base: int, exponent: Fraction) -> int:
        with guarded(bits):
            scale = arb(2) ** bits
            value = integer_part((arb(base) / scale) ** (arb(exponent.numerator) / exponent.denominator) * scale)
        if value is None:
            raise _singular()
        return int(value)

    try:
        return _coefficients(program, list(state), list(parameters), degree, bits, step, power)
    except ZeroDivisionError:
        raise _singular() from None


def _singular() -> IntegrationFailure:
    return IntegrationFailure(
        "singularity",
        "the vector field has no Taylor expansion along the centre's orbit",
        "the orbit meets a singularity of the vector field (a collision): give another centre",
    )


def _coefficients(
    program: PreparedProgram,
    state: list[Any],
    parameters: list[Any],
    degree: int,
    bits: int | None,
    step: Fraction,
    power: Any,
) -> list[list[Any]]:
    size = len(state)
    nodes = program.nodes
    series: list[list[Any]] = [[] for _ in nodes]
    weighted: dict[int, list[Any]] = {}
    solution = [[value] for value in state]
    length, numerator, denominator = float(step), step.numerator, step.denominator
    for n in range(degree + 1):
        for index, node in enumerate(nodes):
            own = series[index]
            match node.operation:
                case "input":
                    if node.left < size:
                        own.append(solution[node.left][n])
                    else:
                        own.append(parameters[node.left - size] if n == 0 else 0)
                case "constant":
                    if n:
                        own.append(0)
                    else:
                        own.append(float(node.value) if bits is None else int(node.value * 2**bits))
                case "add":
                    own.append(series[node.left][n] + series[node.right][n])
                case "sub":
                    own.append(series[node.left][n] - series[node.right][n])
                case "scale":
                    value = series[node.left][n] * node.value.numerator
                    if node.value.denominator != 1:
                        value = value / node.value.denominator if bits is None else value // node.value.denominator
                    own.append(value)
                case "mul":
                    left = series[node.left]
                    if node.left == node.right:
                        half = (n + 1) // 2
                        value = 2 * sum(map(mul, left[:half], reversed(left)))
                        if n % 2 == 0:
                            value += left[half] * left[half]
                    else:
                        value = sum(map(mul, left, reversed(series[node.right])))
                    own.append(value if bits is None else value >> bits)
                case "pow":
                    base = series[node.left]
                    if n == 0:
                        own.append(power(base[0], node.value))
                        weighted[index] = [0]
                    else:
                        weighted[index].append(n * base[n])
                        p, q = node.value.numerator, node.value.denominator
                        backward = own[::-1]
                        plain = sum(map(mul, base[1:], backward))
                        heavy = sum(map(mul, weighted[index][1:], backward))
                        value = (p + q) * heavy - q * n * plain
                        divisor = q * n * base[0]
                        own.append(value / divisor if bits is None else value // divisor)
        if n < degree:
            for component, output in enumerate(program.outputs):
                slope = series[output][n]
                if bits is None:
                    solution[component].append(slope * length / (n + 1))
                else:
                    solution[component].append(slope * numerator // (denominator * (n + 1)))
    return solution


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


def rough(values: Sequence[int], bits: int) -> list[float]:
    """Fixed-point numbers in float64."""
    try:
        return [value / (1 << bits) for value in values]
    except OverflowError:
        raise IntegrationFailure(
            "size", "the orbit leaves the range of floating-point numbers", "give another centre"
        ) from None


def dyadic_below(size: float) -> Fraction:
    """A dyadic number just below `size` with few bits."""
    exponent = floor(log2(size)) - _STEP_BITS
    return Fraction(floor(size / 2.0**exponent)) * Fraction(2) ** exponent


def next_crossing(coefficients: Sequence[int], bits: int, starts_on_section: bool) -> Fraction | None:
    """The first root of a time polynomial in (0, 1], dyadic with about `bits` bits; not rigorous."""
    values = rough(coefficients, bits)
    samples = 64

    def value(theta: float) -> float:
        result = 0.0
        for c in reversed(values):
            result = result * theta + c
        return result

    first = 1 if starts_on_section else 0
    before = value(first / samples)
    for index in range(first + 1, samples + 1):
        after = value(index / samples)
        if (before < 0) != (after < 0):
            return _polish(coefficients, bits, (index - 0.5) / samples)
        before = after
    return None


def _polish(coefficients: Sequence[int], bits: int, guess: float) -> Fraction | None:
    polynomial = arb_poly([arb(c) * arb(2) ** -bits for c in coefficients])
    slope = polynomial.derivative()
    root = arb(guess)
    for _ in range(3 + ceil(log2(bits))):
        root = (root - polynomial(root) / slope(root)).mid()
        if not root.is_finite():
            return None
    scaled = integer_part(root * arb(2) ** bits)
    result = Fraction(0 if scaled is None else int(scaled), 2**bits)
    return result if 0 < result <= 1 else None
