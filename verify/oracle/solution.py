"""Approximate solution of x' = f(x) in the graded algebra over one step (section 3.2).

The centre is solved by the classical recurrences; a monomial of higher grade solves the linear
equation of the first variation along the centre, forced by products of lower monomials. Nothing here
carries proof: `verify.flow.step` bounds the defect of the result, whatever it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from flint import fmpz, fmpz_poly

from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, partial_derivatives
from orbitproof.verify.evidence import GUARD_BITS
from orbitproof.verify.flow import FieldAlong, dyadic_below, rough
from orbitproof.verify.oracle.breakdowns import breakdowns_told
from orbitproof.verify.oracle.centre import (
    fixed_coefficients,
    next_crossing,
    rescaled,
    step_size,
    variation_coefficients,
)
from orbitproof.verify.oracle.linear_equation import Jacobian, LinearEquation

_ZERO = fmpz_poly([])
_ROUGH_DEGREE = 24
_TOLERATED_BITS = 24
"""The last coefficients of a step may be so many bits long before it is shortened."""


class CentreExpansion:
    """The expansion of the centre's orbit; the monomials are solved for along it."""

    def __init__(
        self, program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
    ) -> None:
        self.program, self.arithmetic, self.state, self.parameters = program, arithmetic, state, parameters
        self._start = [int(x.coefs[0][0]) for x in (*state, *parameters)]
        bits = arithmetic.bits
        start = rough(self._start, bits)
        orbit, variation = variation_coefficients(program, start, _ROUGH_DEGREE)
        self.step_size = step_size(orbit, float(-bits), arithmetic.degree)
        if max(arithmetic.grading.grades) > 0:
            # Nearby orbits may move faster than the centre's, as across a linear mode.
            tolerance = float(_spare_bits(arithmetic, 1) - bits)
            self.step_size = min(self.step_size, step_size(variation, tolerance, arithmetic.degree))
        self._coefficients = cache(self._centre)
        self._longest: tuple[Fraction, Sequence[list[int]]] | None = None

    def _centre(self, step: Fraction) -> Sequence[list[int]]:
        degree, bits = self.arithmetic.degree, self.arithmetic.bits
        if self._longest is not None and step <= self._longest[0]:
            longest, coefficients = self._longest
            return rescaled(coefficients, bits, step / longest)
        self._longest = step, fixed_coefficients(self.program, self._start, degree, bits, step)
        return self._longest[1]

    @breakdowns_told()
    def shortened(self, step: Fraction) -> Fraction:
        """See `Expansion`."""
        last = (abs(value) for row in self._coefficients(step) for value in row[-2:])
        excess = max(last).bit_length()
        if excess <= _TOLERATED_BITS:
            return step
        return dyadic_below(float(step) * 2.0 ** (-excess / self.arithmetic.degree))

    @breakdowns_told()
    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """See `Expansion`."""
        return next_crossing(self._coefficients(step)[section], self.arithmetic.bits, starts_on_section)

    @breakdowns_told()
    def solve(self, along: FieldAlong, step: Fraction) -> None:
        """See `Expansion`."""
        arithmetic, size = self.arithmetic, len(self.state)
        along.give([fmpz_poly(list(row)) for row in self._coefficients(step)])
        jacobian = centre_jacobian(along)
        grades, rest = arithmetic.grading.grades, [_ZERO] * size
        for grade in range(1, arithmetic.grading.top + 1):
            positions = [position for position, own in enumerate(grades) if own == grade]
            forcings = {position: along.trial(position, rest) for position in positions}
            starts = {position: [x.coefs[position] for x in self.state] for position in positions}
            moving = [n for n in positions if any(p.length() for p in (*forcings[n], *starts[n]))]
            found: dict[int, list[fmpz_poly]] = {}
            if moving:
                spare = _spare_bits(arithmetic, grade)
                unit = fmpz(1 << spare)
                rounded = [{j: slope // unit for j, slope in row.items()} for row in jacobian]
                equation = LinearEquation(rounded, arithmetic.bits - spare, arithmetic.degree, step)
                solutions = equation.solutions([forcings[n] for n in moving], [starts[n] for n in moving])
                found = dict(zip(moving, solutions, strict=True))
            for position in positions:
                along.give(found.get(position, rest))


def centre_jacobian(along: FieldAlong) -> Jacobian:
    """Approximate partial derivatives of the vector field along the centre, as polynomials in theta.

    Row i maps j to d f_i / d x_j; entries that vanish are absent.
    """
    arithmetic, program = along.arithmetic, along.program
    centre, reciprocals = along.centre()

    def scaled(slope: fmpz_poly, factor: Fraction) -> fmpz_poly:
        return slope * fmpz(factor.numerator) // fmpz(factor.denominator)

    def dot(pairs: Sequence[tuple[fmpz_poly, fmpz_poly]]) -> fmpz_poly:
        return sum((x.mul_low(y, arithmetic.degree + 1) for x, y in pairs), _ZERO) // arithmetic.one

    def slope_of_power(index: int) -> fmpz_poly:
        return scaled(dot([(centre[index], reciprocals[index])]), program.nodes[index].value)

    one = fmpz_poly([arithmetic.one])
    slopes = partial_derivatives(program, len(along.state), centre, one, scaled, dot, slope_of_power)
    return [{j: slope for j, slope in row.items() if slope.length()} for row in slopes]


def _spare_bits(arithmetic: Arithmetic, grade: int) -> int:
    """Bits by which the significant part of a coefficient of this grade is shorter than grade 0."""
    return min(max(0, arithmetic.bits - GUARD_BITS), grade * arithmetic.grade_loss)
