"""A function along a curve with the sign of the twist, without roots and without denominators (section 29.3)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, TypeVar

from orbitproof.verify.evidence import index_factorial
from orbitproof.verify.lasting.jets import Function, FunctionJet

T = TypeVar("T", bound=Function)


@dataclass(frozen=True)
class _Ring(Generic[T]):
    """a + i S b with S^2 = 1 - s^2, S = sin omega.

    Attributes:
        square: S^2.
    """

    real: T
    imaginary: T
    square: T

    def _of(self, real: T, imaginary: T) -> _Ring[T]:
        return _Ring(real, imaginary, self.square)

    def __add__(self, other: _Ring[T]) -> _Ring[T]:
        return self._of(self.real + other.real, self.imaginary + other.imaginary)

    def __mul__(self, other: _Ring[T]) -> _Ring[T]:
        return self._of(
            self.real * other.real - self.square * self.imaginary * other.imaginary,
            self.real * other.imaginary + self.imaginary * other.real,
        )

    def times(self, factor: T) -> _Ring[T]:
        """The product with a real function."""
        return self._of(self.real * factor, self.imaginary * factor)

    def scaled(self, factor: int) -> _Ring[T]:
        """The product with a number."""
        return self._of(self.real.scaled(Fraction(factor)), self.imaginary.scaled(Fraction(factor)))

    @property
    def turned(self) -> _Ring[T]:
        """i S times it."""
        return self._of((self.square * self.imaginary).scaled(Fraction(-1)), self.real)

    @property
    def conjugate(self) -> _Ring[T]:
        """The complex conjugate."""
        return self._of(self.real, self.imaginary.scaled(Fraction(-1)))

    @property
    def norm(self) -> T:
        """The square of the absolute value."""
        result: T = self.real * self.real + self.square * self.imaginary * self.imaginary
        return result


@dataclass(frozen=True)
class NormalForm(Generic[T]):
    """The normal form of a reversible map of the plane, as functions along a curve (29.3), (29.4).

    Attributes:
        twist: Theta; where -1 < s < 1 and s is not -1/2, it has the sign of (1 + 2 s) tau. Of an odd map Theta_0, with
            the sign of tau where -1 < s < 1.
        defect: 0, by reversibility.
        fourth: Delta; where s = 0, it is positive if the orbit is unstable by its 1:4 resonance.
    """

    twist: T
    defect: T
    fourth: T


def normal_form(first: FunctionJet[T], second: FunctionJet[T], s: T, one: T, odd: bool = False) -> NormalForm[T]:
    """The functions of section 29.3, of a map whose derivative is [[s, b], [c, s]] with s^2 - b c = 1.

    With the two components, and the two increments, exchanged the result is the same times a positive function where
    b and c are not 0.

    Args:
        first, second: its components, in both increments; 1 is `one`.
        odd: whether the map is odd, without terms of order 2 (29.7).
    """
    square, zero = one - s * s, one - one
    c = second.coefficients[1, 0]
    cc = c * c

    def d(jet: FunctionJet[T], *index: int) -> T:
        result: T = jet.coefficients.get(index, zero).scaled(Fraction(index_factorial(index)))
        return result

    def element(real: T, imaginary: T) -> _Ring[T]:
        return _Ring(real, imaginary, square)

    def component(p: _Ring[T], q: _Ring[T]) -> _Ring[T]:
        """The component of (p, q) along the coordinate, (c, i S)."""
        return p.times(c) + q.turned

    def along(jet: FunctionJet[T]) -> _Ring[T]:
        """D^2[e, e], e = (S, - i c)."""
        return element(square * d(jet, 2, 0) - cc * d(jet, 0, 2), (c * d(jet, 1, 1)).scaled(Fraction(-2)))

    def between(jet: FunctionJet[T]) -> _Ring[T]:
        """D^2[e, conj e]."""
        real = square * d(jet, 2, 0) + cc * d(jet, 0, 2)
        return element(real, real - real)

    def cubic(jet: FunctionJet[T]) -> _Ring[T]:
        """i D^3[e, e, conj e]."""
        return element(c * (square * d(jet, 2, 1) + cc * d(jet, 0, 3)), square * d(jet, 3, 0) + cc * d(jet, 1, 2))

    def resonant(jet: FunctionJet[T]) -> _Ring[T]:
        """- i D^3[conj e, conj e, conj e]."""
        real = c * ((square * d(jet, 2, 1)).scaled(Fraction(3)) - cc * d(jet, 0, 3))
        return element(real, (cc * d(jet, 1, 2)).scaled(Fraction(3)) - square * d(jet, 3, 0))

    g20, g11, g21, g03 = (component(of(first), of(second)) for of in (along, between, cubic, resonant))
    g02 = component(along(first).conjugate, along(second).conjugate)
    plain, value = element(one, zero), element(s, one)
    back = value.conjugate
    minus = back + plain.scaled(-1)
    # Of an odd map 1 + 2 s is a factor of all that is left.
    third = one if odd else one + s.scaled(Fraction(2))
    pairs = g20 * g11 * (plain + value.scaled(-2)) * back * back * minus
    sizes = minus.times(g11.norm).scaled(2)
    own = (back * g21.turned).times(c * (one - s)).scaled(-4)
    total = (pairs + sizes + own).times(third) + (back * minus).times(g02.norm)
    quarter = g03.turned.times(c).scaled(4) + (g11 * g02 * (plain.scaled(-1) + value)).scaled(3)
    quarter = quarter + (g02 * g20.conjugate * (plain.scaled(-1) + back)).scaled(3)
    fourth = quarter.norm - (total.imaginary * total.imaginary).scaled(Fraction(9))
    return NormalForm(total.imaginary, total.real, fourth)
