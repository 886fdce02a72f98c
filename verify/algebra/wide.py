"""The algebra with one more variable s of weight 0, the *wide* variable (section 15.1).

The coefficients of the monomials are polynomials in theta and s, packed into one integer polynomial with s as the
minor index. Powers are approximations only: `correct_power` bounds how far they are from the power.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce

import numpy as np
from flint import arb, arb_poly, fmpz, fmpz_poly

from orbitproof.verify.algebra.circle import Floats, from_points, power_of_series, to_points
from orbitproof.verify.algebra.grading import Grading, Pairs
from orbitproof.verify.algebra.norms import FLOOR, float_above, inflate
from orbitproof.verify.algebra.series import ZERO, Arithmetic, Products
from orbitproof.verify.evidence import IntegrationFailure

_NEAR_BITS, _MOST_STEPS = 16, 8
"""With fewer right bits a power nearby is not improved; and no power by more than so many steps."""
_SPARE_POWERS = 8
"""So many powers of s beyond the width are found exactly in a product before they are cut off."""
_REMEMBERED = 256
"""Polynomials whose sizes are kept: most of them are factors of several products in a row."""


@dataclass(frozen=True)
class WideArithmetic(Arithmetic):
    """Formats with a wide variable.

    Attributes:
        width: largest degree in the wide variable s that is kept, d >= 1.
    """

    width: int = 1

    @property
    def stride(self) -> int:
        """Distance of the powers of theta in a packed polynomial; higher powers of s of a product run into the next."""
        return self.width + 1 + min(self.width, _SPARE_POWERS)

    def coarser(self, grading: Grading, bits: int, degree: int, width: int) -> WideArithmetic:
        """As for every arithmetic."""
        return replace(
            self,
            grading=grading,
            bits=min(bits, self.bits),
            grade_bits=0,
            degree=min(degree, self.degree),
            width=min(width, self.width),
        )

    def size(self, polynomial: fmpz_poly, scale: int) -> float:
        """A bound for the sum of the absolute values of all coefficients times 2^-scale."""
        return inflate(float(_sizes(polynomial, self.stride, scale).of_times.sum())) if polynomial.length() else 0.0

    def part_for(self, coarse: Arithmetic, polynomial: fmpz_poly) -> tuple[fmpz_poly, int]:
        """What a coarser format keeps of a packed polynomial, and the l1 norm of the rest."""
        stride, length = self.stride, (coarse.degree + 1) * self.stride
        kept, rest = polynomial.truncate(length), polynomial.right_shift(length).coeffs()
        for row in range(0, kept.length(), stride):
            for place in range(row + coarse.width + 1, row + stride):
                if value := kept[place]:
                    rest.append(value)
                    kept[place] = 0
        if coarse.stride < stride:
            coefs = kept.coeffs()
            rows = (coefs[row : row + coarse.stride] for row in range(0, len(coefs), stride))
            kept = fmpz_poly([value for values in rows for value in values])
        return kept, int(sum(map(abs, rest)))

    def round_product(self, exact: fmpz_poly, position: int) -> tuple[fmpz_poly, float]:
        """As for every arithmetic; rounded before it is cut: one unit counts for every coefficient that is read."""
        kept, rest = self.cut(exact // self.one)
        return kept, inflate(float_above(exact.length() + rest, -self.scales[position]))

    def reduced(self, product: fmpz_poly) -> fmpz_poly:
        """As for every arithmetic; powers of s beyond the width stay until they are cut off."""
        return product.truncate((self.degree + 1) * self.stride) // self.one

    def _exact(self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], factors: Pairs) -> fmpz_poly:
        """As for every arithmetic: products up to the largest degree."""
        length = (self.degree + 1) * self.stride
        exact = ZERO
        for i, j, times in _counted(left, right, factors):
            term = left[i].mul_low(right[j], length)
            exact += term if times == 1 else term * times
        return exact

    def _products(
        self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], position: int, factors: Pairs
    ) -> Products:
        """As for every arithmetic; what is not found exactly is bounded by the sizes of the factors."""
        beyond = []
        for i, j, times in _counted(left, right, factors):
            sizes = (_sizes(p, self.stride, self.scales[n]) for p, n in ((left[i], i), (right[j], j)))
            beyond.append(times * self._beyond(*sizes))
        # Sums that underflow to zero are still not zero.
        return self._exact(left, right, factors), inflate(sum(beyond)) if beyond else 0.0

    def _beyond(self, left: _Sizes, right: _Sizes) -> float:
        """A bound of what a packed product of bounded length lacks, and of what runs into the wrong powers."""
        late = np.convolve(left.of_times, right.of_times)[self.degree + 1 :].sum()
        high = np.convolve(left.of_powers, right.of_powers)[self.stride :].sum()
        return float(late + 2 * high)

    def derivative(self, polynomial: fmpz_poly) -> fmpz_poly:
        """The derivative in theta."""
        stride, coefs = self.stride, polynomial.coeffs()
        rows = enumerate(range(stride, len(coefs), stride), 1)
        return fmpz_poly([times * value for times, row in rows for value in coefs[row : row + stride]])

    def at_end(self, polynomial: fmpz_poly) -> fmpz_poly:
        """The value at theta = 1, a polynomial in s."""
        coefs = polynomial.coeffs()
        return fmpz_poly([sum(coefs[power :: self.stride], fmpz(0)) for power in range(self.stride)])

    def balls_in_time(self, polynomial: fmpz_poly, part: arb | None) -> list[arb]:
        """Enclosures of the coefficients of the powers of theta, for s in `part`; in [-1, 1] if that is `None`."""
        coefs = super().balls_in_time(polynomial, None)
        where = arb(0, 1) if part is None else part
        rows = range(0, len(coefs), self.stride)
        return [_mean_value_form(coefs[row : row + self.stride], where) for row in rows]

    def unpack(self, polynomial: fmpz_poly, scale: int, rows: int) -> Floats:
        """The integers of a packed polynomial times 2^-scale, shape (rows, width + 1): powers of theta and of s."""
        try:
            values = np.ldexp(_floats(polynomial.coeffs()[: rows * self.stride]), -scale)
        except OverflowError:
            raise _not_finite() from None
        return _in_rows(values, self.stride, rows)[:, : self.width + 1]

    def pack(self, coefficients: Floats, scale: int) -> fmpz_poly:
        """The packed polynomial with the given coefficients, shape (rows, width + 1), times 2^scale, rounded."""
        if not np.all(np.isfinite(coefficients)):
            raise _not_finite()
        mantissas, exponents = np.frexp(coefficients)
        integers = np.rint(np.ldexp(mantissas, 53)).astype(np.int64).tolist()
        shifts = (exponents.astype(np.int64) - 53 + scale).tolist()
        zeros = [0] * (self.stride - self.width - 1)
        values: list[int] = []
        for row, shift in zip(integers, shifts, strict=True):
            values += [value << by if by >= 0 else value >> -by for value, by in zip(row, shift, strict=True)]
            values += zeros
        return fmpz_poly(values)

    def power(self, base: fmpz_poly, exponent: Fraction, near: fmpz_poly = ZERO) -> fmpz_poly:
        """As for every arithmetic; packed polynomials.

        The power is found in float64, unless there is one nearby, and improved by steps of Newton's method for
        y^q base^p = 1.
        """
        p, q = -exponent.numerator, exponent.denominator
        shared, one = min(p, q), fmpz_poly([self.one])
        power = near if near.length() else self._in_floats(base, exponent)
        for _ in range(_MOST_STEPS):
            mixed = self._reduced_product(power, base)
            factors = [*[mixed] * shared, *[base] * (p - shared), *[power] * (q - shared)]
            defect = one - reduce(self._reduced_product, factors)
            missing = int(defect.height_bits())
            if missing > self.bits - _NEAR_BITS and power is near:
                return self.power(base, exponent)
            if missing > self.bits:
                # From so far off no step leads closer, and each makes the integers longer.
                break
            power = power + self._reduced_product(power, defect) // fmpz(q)
            if 2 * missing <= self.bits:
                break
        return power

    def _in_floats(self, base: fmpz_poly, exponent: Fraction) -> fmpz_poly:
        values = to_points(self.unpack(base, self.bits, self.degree + 1))
        return self.pack(from_points(power_of_series(values, exponent), self.width), self.bits)

    def _reduced_product(self, left: fmpz_poly, right: fmpz_poly) -> fmpz_poly:
        return self.cut(self.reduced(left.mul_low(right, (self.degree + 1) * self.stride)))[0]


def _counted(left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], factors: Pairs) -> Iterator[tuple[int, int, int]]:
    """Pairs of factors that are not zero, and how often they count: in a square, those of both orders at once."""
    square = left is right
    for i, j in factors:
        if left[i].length() and right[j].length() and (i <= j or not square):
            yield i, j, 1 if i == j or not square else 2


@dataclass(frozen=True)
class _Sizes:
    """Bounds of the sums of the absolute values of the coefficients of a packed polynomial.

    Attributes:
        of_times: for each power of theta, over all powers of s.
        of_powers: for each power of s, over all powers of theta.
    """

    of_times: Floats
    of_powers: Floats


_remembered: OrderedDict[tuple[int, int, int], tuple[fmpz_poly, _Sizes]] = OrderedDict()


def _sizes(polynomial: fmpz_poly, stride: int, scale: int) -> _Sizes:
    """Bounds, up to rounding, for a polynomial times 2^-scale: every coefficient counts with its size."""
    key = id(polynomial), stride, scale
    # An entry keeps its polynomial, whose identity therefore is not given to another one.
    known = _remembered.get(key)
    if known is None:
        coefs = polynomial.coeffs()
        try:
            mantissas, exponents = np.abs(_floats(coefs)), np.array(0)
        except OverflowError:
            exponents = np.array([value.bit_length() for value in coefs])
            mantissas = (exponents > 0).astype(float)
        # The floor comes before these are factors: one that underflows may belong to a large other one.
        sizes = np.where(mantissas > 0.0, np.ldexp(mantissas, exponents - scale) + FLOOR, 0.0)
        table = _in_rows(sizes, stride, -(-len(sizes) // stride))
        known = polynomial, _Sizes(table.sum(axis=1), table.sum(axis=0))
        if len(_remembered) >= _REMEMBERED:
            _remembered.popitem(last=False)
        _remembered[key] = known
    return known[1]


def _floats(coefficients: Sequence[fmpz]) -> Floats:
    """Each rounded to the nearest float. Raises `OverflowError` for one that is larger than all."""
    return np.fromiter(map(float, coefficients), np.float64, len(coefficients))


def _in_rows(values: Floats, stride: int, rows: int) -> Floats:
    """Coefficients in a table, with a row for each power of theta."""
    padded = np.zeros(rows * stride)
    padded[: len(values)] = values
    return padded.reshape(rows, stride)


def _mean_value_form(coefficients: list[arb], part: arb) -> arb:
    """Values of a polynomial on a ball."""
    polynomial = arb_poly(coefficients)
    middle = part.mid()
    return polynomial(middle) + polynomial.derivative()(part) * (part - middle)


def _not_finite() -> IntegrationFailure:
    return IntegrationFailure(
        "size", "the orbits of the piece leave the range of floating-point numbers", "give a narrower piece"
    )
