"""Approximate solutions of x' = f(x) with a wide variable (section 3.4).

The Taylor recurrences run in float64 at points on the unit circle of s; the part of grade 0 is then improved
by the solution of the linearised equation with its exact defect as forcing. Higher grades stay at float64.
Nothing here carries proof: `verify.flow.step` bounds the defect of the result, whatever it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from flint import fmpz, fmpz_poly

from orbitproof.verify.algebra import (
    Arithmetic,
    Evaluation,
    Factors,
    Floats,
    Grading,
    Points,
    PreparedProgram,
    Series,
    WideArithmetic,
    from_points,
    graded_power,
    to_points,
)
from orbitproof.verify.flow import Expansion, FieldAlong
from orbitproof.verify.oracle.centre import TaylorRecurrence, next_crossing, step_size
from orbitproof.verify.oracle.solution import CentreExpansion

_MINUS_ONE = Fraction(-1)
_CENTRE_BITS = 60
_VARIATION = Grading((1,), 1)
_BITS_OF_ONE = 112
"""Up to so many bits one correction is enough: each adds about those of a double number."""


def element_at_points(arithmetic: WideArithmetic, element: Series) -> Points:
    """The known part of an element that does not depend on theta, shape (monomials, points)."""
    rows = [arithmetic.unpack(p, scale, 1)[0] for p, scale in zip(element.coefs, arithmetic.scales, strict=True)]
    return to_points(np.array(rows))


class CircleExpansion:
    """The expansion of all orbits at points on the unit circle of s; the step suits all of them."""

    def __init__(
        self,
        program: PreparedProgram,
        arithmetic: WideArithmetic,
        state: Sequence[Series],
        parameters: Sequence[Series],
    ) -> None:
        self.program, self.arithmetic, self.state, self.parameters = program, arithmetic, state, parameters
        start, self._fixed = (
            np.array([element_at_points(arithmetic, x) for x in elements]) for elements in (state, parameters)
        )
        self.taylor = taylor_at_points(program, arithmetic.grading, start, self._fixed, arithmetic.degree)
        # The last coefficient of grade 0 falls below the unit of the format, for all |s| <= 1.
        sizes = np.abs(from_points(self.taylor[:, :, 0], arithmetic.width)).sum(axis=-1)
        self.step_size = step_size(sizes.tolist(), float(-arithmetic.bits), arithmetic.degree)

    def shortened(self, step: Fraction) -> Fraction:
        """See `Expansion`; its terms are not looked at."""
        return step

    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """See `Expansion`."""
        centre = from_points(self.taylor[section, :, 0], self.arithmetic.width)[:, 0]
        scaled = np.ldexp(centre * float(step) ** np.arange(len(centre)), _CENTRE_BITS)
        return next_crossing([int(value) for value in scaled], _CENTRE_BITS, starts_on_section)

    def solve(self, along: FieldAlong, step: Fraction) -> None:
        """See `Expansion`."""
        program, arithmetic, taylor = self.program, self.arithmetic, self.taylor
        degree, width, bits = arithmetic.degree, arithmetic.width, arithmetic.bits
        size = len(self.state)
        powers = float(step) ** np.arange(degree + 1)
        floats = from_points(taylor, width) * powers[None, :, None, None]
        solution = [
            [
                _starting_at(arithmetic, given, floats[component, :, position], scale)
                for position, (given, scale) in enumerate(zip(x.coefs, arithmetic.scales, strict=True))
            ]
            for component, x in enumerate(self.state)
        ]
        constants = [p.coefs for p in self.parameters]
        start = np.zeros((size, 2, taylor.shape[-1]), complex)
        start[:, 0] = taylor[:, 0, 0]
        fixed = np.zeros((len(constants), 2, taylor.shape[-1]), complex)
        fixed[:, 0] = self._fixed[:, 0] if constants else 0.0
        for _ in range(1 if bits <= _BITS_OF_ONE else 2):
            trial = Evaluation(program, arithmetic)
            trial.fill(0, [row[0] for row in (*solution, *constants)])
            forcing = _defects(arithmetic, trial, [row[0] for row in solution], step)
            variation = taylor_at_points(program, _VARIATION, start, fixed, degree, float(step), to_points(forcing))
            corrections = from_points(variation[:, :, 1], width)
            for component in range(size):
                solution[component][0] = solution[component][0] + arithmetic.pack(corrections[component], bits)
        for column in zip(*solution, strict=True):
            along.give(column)


def expand(
    program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
) -> Expansion:
    """The expansion in time that suits the arithmetic."""
    if isinstance(arithmetic, WideArithmetic):
        return CircleExpansion(program, arithmetic, state, parameters)
    return CentreExpansion(program, arithmetic, state, parameters)


def taylor_at_points(
    program: PreparedProgram,
    grading: Grading,
    state: Points,
    parameters: Points,
    degree: int,
    step: float = 1.0,
    forcing: Points | None = None,
) -> Points:
    """Taylor coefficients of the solution of dx/dtheta = step * f(x) + forcing at every point.

    Args:
        state: initial values, shape (components, monomials, points).
        parameters: constants, shape (number, monomials, points).
        forcing: coefficients in theta, shape (degree, components, points), added to the last monomial.

    Returns:
        shape (components, degree + 1, monomials, points).
    """
    with np.errstate(all="ignore"):
        recurrence = _PointsRecurrence(program, grading, (degree + 1, *state.shape[1:]), step, forcing)
        return np.array(recurrence.solve([*state, *parameters], degree))


class _PointsRecurrence(TaylorRecurrence[Points]):
    """See `taylor_at_points`."""

    def __init__(
        self, program: PreparedProgram, grading: Grading, shape: tuple[int, ...], step: float, forcing: Points | None
    ) -> None:
        super().__init__(program, [np.zeros(shape, complex) for _ in program.nodes])
        self.factors, self.grades, self.step, self.forcing = grading.factors, grading.grades, step, forcing
        self._inverses: dict[int, Points] = {}

    def constant(self, index: int, value: Fraction) -> Points:
        result: Points = np.zeros_like(self.coefs[index][0])
        result[0] = float(value)
        return result

    def scaled(self, index: int, n: int, coefficient: Points, factor: Fraction) -> Points:
        return np.asarray(coefficient * float(factor))

    def product(self, index: int, n: int, left: Sequence[Points], right: Sequence[Points]) -> Points:
        return _product(self.factors, np.asarray(left[: n + 1]), np.asarray(right[n::-1]))

    def power(self, index: int, n: int, base: Sequence[Points], exponent: Fraction) -> Points:
        if n == 0:
            self._inverses[index] = graded_power(base[0], _MINUS_ONE, self.factors, self.grades)
            return graded_power(base[0], exponent, self.factors, self.grades)
        p, q = exponent.numerator, exponent.denominator
        weights = (((p + q) * np.arange(1, n + 1) - q * n) / (q * n)).astype(complex)[:, None, None]
        mixed = _product(self.factors, weights * base[1 : n + 1], self.coefs[index][n - 1 :: -1][:n])
        return _product(self.factors, mixed[None], self._inverses[index][None])

    def integral(self, component: int, n: int, slope: Points) -> Points:
        result = np.asarray(slope * (self.step / (n + 1)))
        if self.forcing is not None:
            result[-1] += self.forcing[n, component] / (n + 1)
        return result


def _product(factors: Factors, left: Points, right: Points) -> Points:
    """The sum over the first axis of products of graded elements, shape (monomials, points)."""
    result = np.zeros(left.shape[1:], complex)
    # By symmetries, half of the monomials are often zero.
    some_left, some_right = np.any(left, axis=(0, 2)), np.any(right, axis=(0, 2))
    for position, pairs in enumerate(factors):
        for i, j in pairs:
            if some_left[i] and some_right[j]:
                result[position] += np.einsum("np,np->p", left[:, i], right[:, j])
    return result


def _starting_at(arithmetic: WideArithmetic, given: fmpz_poly, coefficients: Floats, scale: int) -> fmpz_poly:
    """The packed polynomial with these coefficients, except that its value at theta = 0 is `given`."""
    later = coefficients.copy()
    later[0] = 0.0
    return arithmetic.pack(later, scale) + given


def _defects(
    arithmetic: WideArithmetic, evaluation: Evaluation, solution: Sequence[fmpz_poly], step: Fraction
) -> Floats:
    """step * f(x) - dx/dtheta at grade 0, shape (degree, components, width + 1)."""
    numerator, denominator = fmpz(step.numerator), fmpz(step.denominator)
    shift = step.denominator.bit_length() - 1
    rows = []
    for x, output in zip(solution, evaluation.program.outputs, strict=True):
        difference = evaluation.coefs[output][0] * numerator - arithmetic.derivative(x) * denominator
        rows.append(arithmetic.unpack(difference, arithmetic.bits + shift, arithmetic.degree))
    return np.array(rows).transpose(1, 0, 2)
