"""Approximate solution of x' = f(x) in the graded algebra over one step (section 3.2).

The centre is solved by the classical recurrences; a monomial of higher grade solves the linear
equation of the first variation along the centre, forced by products of lower monomials. Nothing here
carries proof: `verify.flow.step` bounds the defect of the result, whatever it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from itertools import starmap
from operator import mul
from typing import Protocol

from flint import fmpz, fmpz_poly

from orbitproof.verify.algebra import Arithmetic, Evaluation, PreparedProgram, Series, partial_derivatives
from orbitproof.verify.flow.centre import (
    dyadic_below,
    fixed_coefficients,
    float_coefficients,
    next_crossing,
    rough,
    step_size,
)

_ZERO = fmpz_poly([])
_BLOCK = 12
_ROUGH_DEGREE = 24
_TOLERATED_BITS = 24
"""The last coefficients of a step may be so many bits long before it is shortened."""

Jacobian = list[dict[int, list[int]]]


class Expansion(Protocol):
    """The solutions from one state, expanded in time, before a step is chosen. Nothing here carries proof.

    Attributes:
        program: the vector field.
        state: initial values, constant in theta.
        parameters: constants of motion that the program takes after the state.
        step_size: a step that suits the format.
    """

    program: PreparedProgram
    state: Sequence[Series]
    parameters: Sequence[Series]
    step_size: float

    @property
    def arithmetic(self) -> Arithmetic:
        """The format."""

    def shortened(self, step: Fraction) -> Fraction:
        """The step, or less of it where its last terms are much larger than the first ones say that they are."""

    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """The first zero of a component of the centre's orbit in (0, step], as a fraction of the step, dyadic."""

    def solution(self, step: Fraction) -> tuple[list[list[fmpz_poly]], Evaluation]:
        """Known parts of a solution over a step, per component and monomial, and the vector field on them.

        The solution starts at the known parts of the state exactly.
        """


class CentreExpansion:
    """The expansion of the centre's orbit; the monomials are solved for along it."""

    def __init__(
        self, program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
    ) -> None:
        self.program, self.arithmetic, self.state, self.parameters = program, arithmetic, state, parameters
        self._start = [int(x.coefs[0][0]) for x in (*state, *parameters)]
        bits = arithmetic.bits
        series = float_coefficients(program, rough(self._start, bits), _ROUGH_DEGREE)
        self.step_size = step_size(series, float(-bits), arithmetic.degree)
        self._coefficients = cache(self._centre)

    def _centre(self, step: Fraction) -> Sequence[list[int]]:
        return fixed_coefficients(self.program, self._start, self.arithmetic.degree, self.arithmetic.bits, step)

    def shortened(self, step: Fraction) -> Fraction:
        """See `Expansion`."""
        last = (abs(value) for row in self._coefficients(step) for value in row[-2:])
        excess = max(last).bit_length()
        if excess <= _TOLERATED_BITS:
            return step
        return dyadic_below(float(step) * 2.0 ** (-excess / self.arithmetic.degree))

    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """See `Expansion`."""
        return next_crossing(self._coefficients(step)[section], self.arithmetic.bits, starts_on_section)

    def solution(self, step: Fraction) -> tuple[list[list[fmpz_poly]], Evaluation]:
        """See `Expansion`."""
        initial, parameters = [x.coefs for x in self.state], [p.coefs for p in self.parameters]
        return solve(self.program, self.arithmetic, self._coefficients(step), initial, parameters, step)


def solve(
    program: PreparedProgram,
    arithmetic: Arithmetic,
    centre: Sequence[Sequence[int]],
    initial: Sequence[Sequence[fmpz_poly]],
    parameters: Sequence[Sequence[fmpz_poly]],
    step: Fraction,
) -> tuple[list[list[fmpz_poly]], Evaluation]:
    """Time polynomials of all state components, and the vector field evaluated on them.

    Args:
        centre: coefficients in theta of the centre's orbit, per component.
        initial: known parts of the initial value (constant in theta), per component and monomial.
        parameters: the same for the parameters.
        step: the time that theta = 1 stands for.

    Returns:
        known parts per component and monomial, and the filled evaluation of the program.
    """
    evaluation = Evaluation(program, arithmetic)
    size = len(initial)
    monomials = range(len(arithmetic.grading.monomials))
    solution: list[list[fmpz_poly]] = [[_ZERO for _ in monomials] for _ in range(size)]
    for component in range(size):
        solution[component][0] = fmpz_poly(list(centre[component]))
    evaluation.fill(0, [row[0] for row in (*solution, *parameters)])
    jacobian = centre_jacobian(evaluation, size)
    rounded: dict[int, Jacobian] = {}
    for position in monomials[1:]:
        constants = [row[position] for row in parameters]
        factors = arithmetic.grading.factors[position]
        forced = any(p.length() for p in constants) or any(i and j for i, j in factors)
        if forced:
            evaluation.try_out(position, [_ZERO] * size + constants)
            forcing = [evaluation.coefs[output][position] for output in program.outputs]
        else:
            forcing = [_ZERO] * size
        start = [row[position] for row in initial]
        if forced or any(p.length() for p in start):
            grade = arithmetic.grading.grades[position]
            if grade not in rounded:
                rounded[grade] = _rounded(jacobian, arithmetic.spare_bits(grade))
            columns = linear_solution(arithmetic, rounded[grade], forcing, start, step, arithmetic.spare_bits(grade))
            for component in range(size):
                solution[component][position] = columns[component]
        evaluation.fill(position, [row[position] for row in solution] + constants)
    return solution, evaluation


def centre_jacobian(evaluation: Evaluation, size: int) -> Jacobian:
    """Approximate partial derivatives of the vector field along the centre, as coefficient lists.

    Row i maps j to the coefficients in theta of d f_i / d x_j; entries that vanish are absent.
    """
    arithmetic, nodes = evaluation.arithmetic, evaluation.program.nodes
    centre = [row[0] for row in evaluation.coefs]

    def scaled(slope: fmpz_poly, factor: Fraction) -> fmpz_poly:
        return slope * fmpz(factor.numerator) // fmpz(factor.denominator)

    def dot(pairs: Sequence[tuple[fmpz_poly, fmpz_poly]]) -> fmpz_poly:
        return sum(starmap(mul, pairs), _ZERO).truncate(arithmetic.degree + 1) // arithmetic.one

    def slope_of_power(index: int) -> fmpz_poly:
        return scaled(dot([(centre[index], evaluation.reciprocal(index))]), nodes[index].value)

    one = fmpz_poly([arithmetic.one])
    slopes = partial_derivatives(evaluation.program, size, centre, one, scaled, dot, slope_of_power)
    return [{j: [int(c) for c in value.coeffs()] for j, value in row.items() if value.length()} for row in slopes]


def _rounded(jacobian: Jacobian, bits: int) -> Jacobian:
    return [{j: [entry >> bits for entry in entries] for j, entries in row.items()} for row in jacobian]


def linear_solution(
    arithmetic: Arithmetic,
    jacobian: Jacobian,
    forcing: Sequence[fmpz_poly],
    start: Sequence[fmpz_poly],
    step: Fraction,
    spare: int = 0,
) -> list[fmpz_poly]:
    """Coefficients in theta of the solution of v' = step * (J v + forcing), v(0) = start.

    `jacobian` has `spare` fractional bits less than the format.

    Coefficients are found in blocks. Inside a block the convolutions with J are sums term by term;
    what a finished block contributes to later ones is one polynomial product, of blocks that double
    as often as the position allows (relaxed multiplication). Components on which no slope depends are
    integrated at the end.
    """
    bits = arithmetic.bits - spare
    degree = arithmetic.degree
    numerator, denominator = step.numerator, step.denominator
    solution: list[list[int]] = [[int(p[0])] if p.length() else [0] for p in start]
    forces = [[int(c) << bits for c in p.coeffs()] + [0] * (degree + 1 - p.length()) for p in forcing]
    coupled = sorted({j for row in jacobian for j in row})
    varying = [
        [(j, entries) for j, entries in row.items() if len(entries) > 1] if i in coupled else []
        for i, row in enumerate(jacobian)
    ]
    factors = [[(j, fmpz_poly(entries)) for j, entries in row] for row in varying]
    for first in range(0, degree, _BLOCK):
        if first:
            width = _BLOCK * (first // _BLOCK & -(first // _BLOCK))
            blocks = [fmpz_poly(values[first - width : first]) for values in solution]
            for force, row in zip(forces, factors, strict=True):
                if row:
                    terms = (entries.truncate(2 * width).mul_low(blocks[j], 2 * width) for j, entries in row)
                    exact = sum(terms, _ZERO)
                    for n in range(first, min(first + width, degree)):
                        force[n] += int(exact[n - first + width])
        # The block's coefficients so far, latest first, as the convolutions need them.
        latest: list[list[int]] = [[values[-1]] for values in solution]
        rows = [
            (
                forces[i],
                [(entries[0], latest[j]) for j, entries in jacobian[i].items() if len(entries) == 1],
                [(entries, latest[j]) for j, entries in varying[i]],
            )
            for i in coupled
        ]
        for n in range(first, min(first + _BLOCK, degree)):
            divisor = denominator * (n + 1)
            slopes = []
            for force, constants, convolutions in rows:
                slope = force[n]
                for entry, values in constants:
                    slope += entry * values[0]
                for entries, values in convolutions:
                    slope += sum(map(mul, entries, values))
                slopes.append((slope >> bits) * numerator // divisor)
            for component, slope in zip(coupled, slopes, strict=True):
                solution[component].append(slope)
                latest[component].insert(0, slope)
    for component in set(range(len(solution))).difference(coupled):
        terms = (fmpz_poly(e).mul_low(fmpz_poly(solution[j]), degree) for j, e in jacobian[component].items())
        exact = sum(terms, _ZERO)
        slopes = [(int(exact[n]) + forces[component][n] >> bits) * numerator for n in range(degree)]
        solution[component] += [slope // (denominator * (n + 1)) for n, slope in enumerate(slopes)]
    return [fmpz_poly(values) for values in solution]
