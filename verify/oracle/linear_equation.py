"""The linear equation of the first variation along the centre, solved term by term in theta (section 3.2).

Nothing here carries proof: `verify.flow.step` bounds the defect of what comes out.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import fmpz, fmpz_mat, fmpz_poly

_BLOCKS = 8
"""The coefficients in theta are found in about so many blocks; fewer are no faster, and take more to prepare."""

_NOISE = 2
"""Coefficients of at most so many units come from rounding."""

_QUIET = 6
"""So many of them in a row, and no forcing, are taken for the end of the series."""

_ZERO = fmpz(0)
_NONE = fmpz_poly([])

Jacobian = list[dict[int, fmpz_poly]]
Coefficients = Sequence[list[list[fmpz]]]
"""For each component, the coefficients of each solution."""


class LinearEquation:
    """v' = step * (J v + forcing), for one Jacobian J and several forcings.

    Coefficients in theta are found in blocks. Inside a block the convolutions with J are products of a matrix with
    the block's coefficients so far, those of all solutions; what finished blocks contribute to later ones is a
    polynomial product, of blocks that double as often as the position allows (relaxed multiplication). Components on
    which no slope depends are integrated at the end. The higher the grade, the sooner coefficients fall below their
    unit: there the series end.

    Args:
        jacobian: row i maps j to d f_i / d x_j, a polynomial in theta with coefficients times 2^-bits.
        bits: fractional bits of the Jacobian.
        degree: largest degree in theta of a solution.
        step: the time that theta = 1 stands for.
    """

    def __init__(self, jacobian: Jacobian, bits: int, degree: int, step: Fraction) -> None:
        self._bits, self._degree, self._step = bits, degree, step
        self._block = -(-degree // _BLOCKS)
        over_step = [{j: p * step.numerator // step.denominator for j, p in row.items()} for row in jacobian]
        coupled = sorted({j for row in over_step for j in row})
        self._integrated = {i: row for i, row in enumerate(over_step) if i not in coupled}
        varying = {i: {j: p for j, p in over_step[i].items() if p.length() > 1} for i in coupled}
        self._varying = {i: row for i, row in varying.items() if row}
        self._constant = {
            i: [(j, p[0]) for j, p in over_step[i].items() if p.length() == 1]
            for i in sorted(coupled, key=lambda i: i not in self._varying)
        }
        self._columns = sorted({j for row in self._varying.values() for j in row})
        self._matrices = self._convolutions()

    def _convolutions(self) -> list[fmpz_mat]:
        """For each place in a block, the matrix that takes the block's coefficients to the sums of J_k v_(n - k).

        The columns are ordered by place, then by component.
        """
        block, width = self._block, len(self._columns)
        lags = []
        for row in self._varying.values():
            entries = [row.get(j, _NONE) for j in self._columns]
            lags.append([p[k] for k in reversed(range(block)) for p in entries] + [_ZERO] * (block * width))
        return [
            fmpz_mat(len(lags), block * width, [x for row in lags for x in row[skip * width : (skip + block) * width]])
            for skip in reversed(range(block))
        ]

    def solutions(
        self, forcings: Sequence[Sequence[fmpz_poly]], starts: Sequence[Sequence[fmpz_poly]]
    ) -> list[list[fmpz_poly]]:
        """For each forcing, coefficients in theta of the solution with v(0) = start, in the format of the forcing."""
        degree, block, size = self._degree, self._block, len(starts[0])
        solution = [[[start[i][0]] for start in starts] for i in range(size)]
        factor = fmpz(self._step.numerator << self._bits)
        exact = [
            [(forcing[i] * factor // self._step.denominator).coeffs() for forcing in forcings] for i in range(size)
        ]
        forces = [[force + [_ZERO] * (degree - len(force)) for force in row] for row in exact]
        forced = max((p // fmpz(_NOISE)).length() for forcing in forcings for p in forcing)
        for first in range(0, degree, block):
            if first:
                if first >= max(forced, _QUIET) and self._vanishes(solution, first):
                    degree = first
                    break
                self._contribute(solution, forces, first)
            self._solve_block(solution, forces, first)
        self._integrate(solution, forces, degree)
        return [[_without_noise(row[number]) for row in solution] for number in range(len(starts))]

    def _vanishes(self, solution: Coefficients, first: int) -> bool:
        """Whether the last coefficients up to number `first` are noise, so that those after them will be."""
        return all(
            abs(value) <= _NOISE
            for i in self._constant
            for values in solution[i]
            for value in values[first - _QUIET + 1 : first + 1]
        )

    def _contribute(self, solution: Coefficients, forces: Coefficients, first: int) -> None:
        """Add to the forces from coefficient `first` on what the last coefficients before it contribute."""
        number = first // self._block
        width = self._block * (number & -number)
        length = width + min(width, self._degree - first)
        short = {i: {j: p.truncate(length) for j, p in row.items()} for i, row in self._varying.items()}
        for which in range(len(solution[0])):
            blocks = {j: fmpz_poly(solution[j][which][first - width : first]) for j in self._columns}
            for i, row in short.items():
                exact = sum((p.mul_low(blocks[j], length) for j, p in row.items()), _NONE)
                force = forces[i][which]
                for n, value in enumerate(exact.right_shift(width).coeffs(), first):
                    force[n] += value

    def _solve_block(self, solution: Coefficients, forces: Coefficients, first: int) -> None:
        bits, width, number = self._bits, len(self._columns), len(solution[0])
        latest = fmpz_mat(self._block * width, number)
        columns = [
            (place, which, solution[j][which]) for place, j in enumerate(self._columns) for which in range(number)
        ]
        rows = [
            (solution[i][which], forces[i][which], [(entry, solution[j][which]) for j, entry in constant])
            for i, constant in self._constant.items()
            for which in range(number)
        ]
        rest = [_ZERO] * (len(rows) - len(self._varying) * number)
        for n, matrix in zip(range(first, self._degree), self._matrices, strict=False):
            place = (n - first) * width
            for column, which, values in columns:
                latest[place + column, which] = values[n]
            for (values, force, constant), slope in zip(rows, (matrix * latest).entries() + rest, strict=True):
                slope += force[n]
                for entry, other in constant:
                    slope += entry * other[n]
                values.append((slope >> bits) // (n + 1))

    def _integrate(self, solution: Coefficients, forces: Coefficients, degree: int) -> None:
        """The components on which no slope depends, up to the degree."""
        for i, row in self._integrated.items():
            for which, values in enumerate(solution[i]):
                exact = sum((p.mul_low(fmpz_poly(solution[j][which]), degree) for j, p in row.items()), _NONE)
                force = forces[i][which]
                values += [(force[n] + exact[n] >> self._bits) // (n + 1) for n in range(degree)]


def _without_noise(values: list[fmpz]) -> fmpz_poly:
    """A polynomial with these coefficients but the last ones that come from rounding; the first one stays."""
    length = len(values)
    while length > 1 and abs(values[length - 1]) <= _NOISE:
        length -= 1
    return fmpz_poly(values[:length])
