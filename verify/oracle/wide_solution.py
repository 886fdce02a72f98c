"""Approximate solutions of x' = f(x) with a wide variable (section 3.4).

The Taylor recurrences run in float64 at points on the unit circle of s; the part of grade 0 is then improved
by the solution of the linearised equation with its exact defect as forcing. Higher grades stay at float64.
Nothing here carries proof: `verify.flow.step` bounds the defect of the result, whatever it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, inf, log2

import numpy as np
from flint import fmpz, fmpz_poly

from orbitproof.verify.algebra import (
    Arithmetic,
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
from orbitproof.verify.oracle.breakdowns import breakdowns_told
from orbitproof.verify.oracle.centre import TaylorRecurrence, next_crossing, step_size
from orbitproof.verify.oracle.solution import CentreExpansion

Solution = Sequence[list[fmpz_poly]]
"""Coefficients of all monomials, for every component."""

_MINUS_ONE = Fraction(-1)
_CENTRE_BITS = 60
_FLOAT_BITS, _FLOAT_BITS_OF_HIGHER_GRADES = 52, 56
"""Numbers with more bits are improved by corrections."""
_CORRECTED_BITS = 44
"""So many more bits are right after each of them."""
_BELOW_ERRORS = 10
"""What is so many bits below the errors that the state has already makes no difference."""
_NARROW = 2.0**-26
"""Where orbits are not so close to the curve, bounds of second derivatives limit a step, not its Taylor series."""

_FACTORS = 2.0 ** (np.arange(17) / 8)
"""By one of these a step is lengthened."""


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
        self._unseen = _unseen(state, arithmetic.grading.top)
        if _spread(state) < _NARROW:
            self.step_size *= self._lengthening()

    def _lengthening(self) -> float:
        """By what factor the step may be longer until products of two series lose too much after the last power."""
        arithmetic, degree, grades = self.arithmetic, self.arithmetic.degree, np.array(self.arithmetic.grading.grades)
        sizes = np.abs(from_points(self.taylor, arithmetic.width)).sum(axis=-1)
        series = [sizes[:, :, grades == grade].sum(axis=-1).max(axis=0) for grade in range(len(self._unseen))]
        with np.errstate(all="ignore"):
            steps = (self.step_size * _FACTORS)[:, None] ** np.arange(degree + 1, 2 * degree + 1)
            possible = np.full(len(_FACTORS), fill_value=True)
            for grade, unseen in enumerate(self._unseen):
                late = sum(np.convolve(series[i], series[grade - i])[degree + 1 :] for i in range(grade + 1))
                possible &= steps @ late <= 2.0**unseen
        return float(max(_FACTORS[possible], default=1.0))

    def shortened(self, step: Fraction) -> Fraction:
        """See `Expansion`; its terms are not looked at."""
        return step

    @breakdowns_told()
    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """See `Expansion`."""
        centre = from_points(self.taylor[section, :, 0], self.arithmetic.width)[:, 0]
        scaled = np.ldexp(centre * float(step) ** np.arange(len(centre)), _CENTRE_BITS)
        return next_crossing([int(value) for value in scaled], _CENTRE_BITS, starts_on_section)

    @breakdowns_told()
    def solve(self, along: FieldAlong, step: Fraction) -> None:
        """See `Expansion`."""
        arithmetic = self.arithmetic
        powers = float(step) ** np.arange(arithmetic.degree + 1)
        floats = from_points(self.taylor, arithmetic.width) * powers[None, :, None, None]
        solution = [
            [
                _starting_at(arithmetic, given, floats[component, :, position], scale)
                for position, (given, scale) in enumerate(zip(x.coefs, arithmetic.scales, strict=True))
            ]
            for component, x in enumerate(self.state)
        ]
        grades = arithmetic.grading.grades
        for grade in range(arithmetic.grading.top + 1):
            positions = [position for position, own in enumerate(grades) if own == grade]
            for _ in range(self._corrections(solution, positions, grade)):
                self._correct(along, solution, positions, step)
            for position in positions:
                along.give([row[position] for row in solution])

    def _corrections(self, solution: Solution, positions: Sequence[int], grade: int) -> int:
        """How often a grade is improved: until it is as exact as the format, or as there is a use of."""
        arithmetic = self.arithmetic
        bits, scale = max((int(row[n].height_bits()), arithmetic.scales[n]) for row in solution for n in positions)
        missing = arithmetic.bits - _FLOAT_BITS if grade == 0 else bits - _FLOAT_BITS_OF_HIGHER_GRADES
        useful = bits - scale - self._unseen[grade] - _FLOAT_BITS
        return max(0, ceil(min(missing, useful) / _CORRECTED_BITS))

    def _correct(self, along: FieldAlong, solution: Solution, positions: Sequence[int], step: Fraction) -> None:
        """Improve monomials of one grade by the solutions of the linearised equation with their defects as forcing."""
        arithmetic, taylor = self.arithmetic, self.taylor
        some = [n for n in positions if any(row[n].length() for row in solution)]
        defects = [_defects(along, [row[n] for row in solution], n, step) for n in some]
        shape = 1 + len(some), taylor.shape[-1]
        start, fixed = (np.zeros((len(entries), *shape), complex) for entries in (self.state, self.parameters))
        start[:, 0] = taylor[:, 0, 0]
        fixed[:, 0] = self._fixed[:, 0] if self.parameters else 0.0
        forcing = to_points(np.array(defects).transpose(1, 2, 0, 3))
        variations = Grading((1,) * len(some), 1)
        found = taylor_at_points(self.program, variations, start, fixed, arithmetic.degree, float(step), forcing)
        for row, corrections in zip(solution, from_points(found, arithmetic.width), strict=True):
            for number, n in enumerate(some, 1):
                row[n] = row[n] + arithmetic.pack(corrections[:, number], arithmetic.scales[n])


@breakdowns_told()
def expand(
    program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
) -> Expansion:
    """The expansion in time that suits the arithmetic."""
    if isinstance(arithmetic, WideArithmetic):
        return CircleExpansion(program, arithmetic, state, parameters)
    return CentreExpansion(program, arithmetic, state, parameters)


def _unseen(state: Sequence[Series], top: int) -> list[float]:
    """For each grade, the logarithm of what makes no difference beside the errors that the state has already."""
    errors = [max(x.errors[grade] for x in state) for grade in range(top + 1)]
    # An error of the point is one of the derivatives there.
    least = [max(error, errors[0] * max(x.known[grade] for x in state)) for grade, error in enumerate(errors)]
    return [log2(error) - _BELOW_ERRORS if 0 < error < inf else -inf for error in least]


def _spread(state: Sequence[Series]) -> float:
    """A bound for how far the orbits are from the curve."""
    return max(sum(x.errors) + sum(x.known[1:]) for x in state)


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
        forcing: coefficients in theta, shape (degree, components, monomials, points), added to all but the first.

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
        self.inner = [(position, i, j) for position, pairs in enumerate(grading.factors) for i, j in pairs if i and j]
        self._inverses: dict[int, Points] = {}

    def constant(self, index: int, value: Fraction) -> Points:
        result: Points = np.zeros_like(self.coefs[index][0])
        result[0] = float(value)
        return result

    def scaled(self, index: int, n: int, coefficient: Points, factor: Fraction) -> Points:
        return np.asarray(coefficient * float(factor))

    def product(self, index: int, n: int, left: Sequence[Points], right: Sequence[Points]) -> Points:
        return _product(self.inner, np.asarray(left[: n + 1]), np.asarray(right[n::-1]))

    def power(self, index: int, n: int, base: Sequence[Points], exponent: Fraction) -> Points:
        if n == 0:
            self._inverses[index] = graded_power(base[0], _MINUS_ONE, self.factors, self.grades)
            return graded_power(base[0], exponent, self.factors, self.grades)
        p, q = exponent.numerator, exponent.denominator
        weights = (((p + q) * np.arange(1, n + 1) - q * n) / (q * n)).astype(complex)[:, None, None]
        mixed = _product(self.inner, weights * base[1 : n + 1], self.coefs[index][n - 1 :: -1][:n])
        return _product(self.inner, mixed[None], self._inverses[index][None])

    def integral(self, component: int, n: int, slope: Points) -> Points:
        result = np.asarray(slope * (self.step / (n + 1)))
        if self.forcing is not None:
            result[1:] += self.forcing[n, component] / (n + 1)
        return result


def _product(inner: Sequence[tuple[int, int, int]], left: Points, right: Points) -> Points:
    """The sum over the first axis of products of graded elements, shape (monomials, points).

    Args:
        inner: each place with two other monomials than the constant whose product is there.
    """
    # Most products are those with the constant.
    result: Points = np.einsum("np,nmp->mp", left[:, 0], right)
    if len(result) > 1:
        result[1:] += np.einsum("nmp,np->mp", left[:, 1:], right[:, 0])
    if inner:
        # By symmetries, half of the monomials are often zero.
        some_left, some_right = np.any(left, axis=(0, 2)), np.any(right, axis=(0, 2))
        for position, i, j in inner:
            if some_left[i] and some_right[j]:
                result[position] += np.einsum("np,np->p", left[:, i], right[:, j])
    return result


def _starting_at(arithmetic: WideArithmetic, given: fmpz_poly, coefficients: Floats, scale: int) -> fmpz_poly:
    """The packed polynomial with these coefficients, except that its value at theta = 0 is `given`."""
    later = coefficients.copy()
    later[0] = 0.0
    return arithmetic.pack(later, scale) + given


def _defects(along: FieldAlong, coefficients: Sequence[fmpz_poly], position: int, step: Fraction) -> Floats:
    """step * f(x) - dx/dtheta for a monomial with these coefficients, shape (degree, components, width + 1)."""
    arithmetic = along.arithmetic
    assert isinstance(arithmetic, WideArithmetic)
    numerator, denominator = fmpz(step.numerator), fmpz(step.denominator)
    scale = arithmetic.scales[position] + step.denominator.bit_length() - 1
    rows = []
    for x, slope in zip(coefficients, along.trial(position, coefficients), strict=True):
        difference = slope * numerator - arithmetic.derivative(x) * denominator
        rows.append(arithmetic.unpack(difference, scale, arithmetic.degree))
    return np.array(rows).transpose(1, 0, 2)
