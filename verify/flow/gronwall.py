"""Propagation of graded errors: a componentwise comparison system (section 4).

Errors of m components in grades 0 .. G and above form one vector of m (G + 2) non-negative numbers.
Along the flow it satisfies E(t) <= E(0) + integral of (M E + delta), entrywise, where M collects bounds
of the partial derivatives of the vector field by grade; hence E(h) <= exp(h M) (E(0) + h delta).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import starmap
from math import comb
from operator import add, mul

import numpy as np
from flint import fmpz_poly
from numpy.typing import NDArray

from orbitproof.verify.algebra import (
    Arithmetic,
    Grading,
    PreparedProgram,
    Series,
    correct_power,
    enclose_nodes,
    float_above,
    fraction_above,
    inflate,
    partial_derivatives,
)
from orbitproof.verify.evidence import IntegrationFailure

_NORM_BITS = 96
_NORM_DEGREE = 24
_NORM_WIDTH = 8
_RATIO = 2.0**-40

PARTS = 8
"""The number of equal parts of a step on each of which the derivatives are bounded anew."""
_SLACK = 1.0 + 2.0**-30
LEAST_ERROR = 2.0**-960
"""No error of a step is smaller: no precision helps where that is too much."""

_MINUS_ONE = Fraction(-1)

Floats = NDArray[np.float64]


def norm_arithmetic(arithmetic: Arithmetic) -> Arithmetic:
    """The format of the norm computation: only the centre is known, every grade is bounded."""
    return arithmetic.coarser(Grading((), arithmetic.grading.top), _NORM_BITS, _NORM_DEGREE, _NORM_WIDTH)


def centre_and_norms(coarse: Arithmetic, element: Series, tube: Sequence[float]) -> Series:
    """`element` widened by `tube`, with everything but a coarse centre turned into error bounds."""
    fine = element.arithmetic
    errors = [inflate(e + t) for e, t in zip(element.errors, tube, strict=True)]
    centre, beyond = fine.part_for(coarse, element.coefs[0])
    if beyond:
        errors[0] = inflate(errors[0] + float_above(beyond, -fine.bits))
    if fine.bits > coarse.bits and centre.length():
        centre = centre // (1 << fine.bits - coarse.bits)
        errors[0] = inflate(errors[0] + coarse.rounding[0])
    for polynomial, grade, scale in zip(element.coefs[1:], fine.grading.grades[1:], fine.scales[1:], strict=True):
        if polynomial.length():
            errors[grade] = inflate(errors[grade] + fine.size(polynomial, scale))
    return Series(coarse, [centre], errors)


def derivative_bounds(
    program: PreparedProgram, size: int, inputs: Sequence[Series]
) -> tuple[list[dict[int, Series]], list[Series]]:
    """Enclosures of all partial derivatives of the vector field on a tube, and of its values there.

    Args:
        size: number of state components; derivatives are taken with respect to these inputs.
        inputs: state and parameters over the tube, in the norm arithmetic.

    Returns:
        for each output, a map from component to derivative (absent: zero), and the outputs.
    """
    coarse = inputs[0].arithmetic
    values = enclose_nodes(program, inputs, _unbounded)

    def slope_of_power(index: int) -> Series:
        base, exponent = values[program.nodes[index].left], program.nodes[index].value
        approximate = coarse.power(base.coefs[0], _MINUS_ONE)
        inverse = correct_power(Series(coarse, [approximate], coarse.zero_errors()), base, _MINUS_ONE)
        if inverse is None:
            raise _unbounded()
        return (values[index] * inverse).scaled(exponent)

    derivatives = partial_derivatives(
        program,
        size,
        values,
        one=Series(coarse, [fmpz_poly([coarse.one])], coarse.zero_errors()),
        scaled=Series.scaled,
        dot=lambda pairs: reduce(add, starmap(mul, pairs)),
        slope_of_power=slope_of_power,
    )
    return derivatives, [values[output] for output in program.outputs]


def _unbounded() -> IntegrationFailure:
    return IntegrationFailure(
        "tube",
        "a power or quotient of the vector field could not be bounded on the tube around the approximate solution",
        "give smaller radii, or more precision",
        needs_precision=True,
    )


def comparison_matrices(derivatives: Sequence[dict[int, Series]], slots: int) -> list[Floats]:
    """The matrix M of the comparison system on each part of the step, shape (m * slots, m * slots).

    slots = G + 2. The grade 0 of a derivative is bounded on each part by the sum of the coefficients
    of its polynomial recentred there, the other grades on the whole step.
    """
    size = len(derivatives)
    matrices = np.zeros((PARTS, size, slots, size, slots))
    for i, row in enumerate(derivatives):
        for j, derivative in row.items():
            errors = derivative.errors
            bounds = np.empty((PARTS, slots))
            bounds[:, 0] = bounds_on_parts(derivative) + errors[0]
            bounds[:, 1:] = errors[1:]
            for source in range(slots):
                for grade in range(slots):
                    matrices[:, i, min(source + grade, slots - 1), j, source] += bounds[:, grade]
    return [matrix.reshape(size * slots, size * slots) * _SLACK for matrix in matrices]


def bounds_on_parts(derivative: Series) -> Floats:
    """Bounds of the known part, of grade 0, on each of `PARTS` equal parts of [0, 1].

    With c the coefficients (of one power of the wide variable), those of p(middle + half t) are S c for S of
    non-negative entries whose columns sum to at most 1, and |p| <= sum |S c| for |t| <= 1. Rounding is below
    10^-13 sum |c|.
    """
    arithmetic = derivative.arithmetic
    integers = derivative.coefs[0].coeffs()
    if not integers:
        return np.zeros(PARTS)
    scale = 2.0**-arithmetic.bits
    stride = arithmetic.stride
    length = -(-len(integers) // stride)
    padded = np.zeros(length * stride)
    try:
        padded[: len(integers)] = [float(int(value)) * scale for value in integers]
    except OverflowError:
        return np.full(PARTS, np.inf)
    coefficients = padded.reshape(length, stride)
    recentred = np.abs(_recentring(length) @ coefficients).sum(axis=(1, 2))
    return np.asarray((recentred + 1e-13 * np.abs(coefficients).sum()) * _SLACK)


@lru_cache(maxsize=64)
def _recentring(length: int) -> Floats:
    """The matrices S, shape (PARTS, length, length); for a degree of 400 they have ten megabytes."""
    half = 1.0 / (2 * PARTS)
    matrices = np.zeros((PARTS, length, length))
    for part in range(PARTS):
        middle = (2 * part + 1) * half
        for n in range(length):
            for j in range(n + 1):
                matrices[part, j, n] = comb(n, j) * middle ** (n - j) * half**j
    return matrices


def grown(derivatives: Sequence[dict[int, Series]], start: Floats, step: Fraction) -> Floats:
    """Bounds of the errors on a whole step, from those before it with the defects, both of shape (m, slots)."""
    bound = start.reshape(-1)
    for matrix in comparison_matrices(derivatives, start.shape[1]):
        # What underflows in the product is less than what is added, however small the step.
        bound = exponential_bound(matrix * (fraction_above(step) / PARTS) + LEAST_ERROR, bound)
    return bound.reshape(start.shape)


@np.errstate(over="ignore", invalid="ignore")
def exponential_bound(matrix: Floats, start: Floats) -> Floats:
    """An upper bound, entrywise, of ``exp(matrix) @ start`` for non-negative entries.

    The series is summed until the next term is below 2^-40 of `start`, entrywise; then so is the
    whole remainder relative to the result. Entries of `start` that are too small for this are
    enlarged, which only weakens the bound. Infinite entries where no bound is found.
    """
    vector = start + LEAST_ERROR
    for _ in range(4):
        term = vector
        result = vector.copy()
        for n in range(1, 80):
            term = (matrix @ term) * (_SLACK / n)
            if n > 4 and bool(np.all(term <= _RATIO * vector)):
                return np.asarray(result * _SLACK / (1.0 - 2.0 * _RATIO) + LEAST_ERROR)
            result = result + term
        if not bool(np.all(np.isfinite(term))):
            break
        vector = np.maximum(vector, term / _RATIO)
    return np.full_like(start, np.inf)
