"""Taylor polynomials of order 3 whose coefficients are functions along a curve (section 29.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Generic, Protocol, TypeVar

from orbitproof.verify.evidence import MultiIndex

ORDER = 3


class Function(Protocol):
    """What coefficients are: elements of a commutative ring that contains the rational numbers."""

    def __add__(self, other: Any, /) -> Any:
        """The sum."""

    def __sub__(self, other: Any, /) -> Any:
        """The difference."""

    def __mul__(self, other: Any, /) -> Any:
        """The product."""

    def scaled(self, factor: Fraction) -> Any:
        """The product with a number."""


T = TypeVar("T", bound=Function)


@dataclass(frozen=True)
class FunctionJet(Generic[T]):
    """Taylor coefficients, not derivatives, up to order 3 in some increments; absent ones are zero."""

    coefficients: Mapping[MultiIndex, T]

    def __add__(self, other: FunctionJet[T]) -> FunctionJet[T]:
        found = dict(self.coefficients)
        for index, value in other.coefficients.items():
            found[index] = found[index] + value if index in found else value
        return FunctionJet(found)

    def __mul__(self, other: FunctionJet[T]) -> FunctionJet[T]:
        found: dict[MultiIndex, T] = {}
        for a, left in self.coefficients.items():
            for b, right in other.coefficients.items():
                if sum(a) + sum(b) <= ORDER:
                    index = tuple(i + j for i, j in zip(a, b, strict=True))
                    product = left * right
                    found[index] = found[index] + product if index in found else product
        return FunctionJet(found)

    def times(self, factor: T) -> FunctionJet[T]:
        """The product with a function of the curve alone."""
        return FunctionJet({index: value * factor for index, value in self.coefficients.items()})

    def scaled(self, factor: Fraction) -> FunctionJet[T]:
        """The product with a number."""
        return FunctionJet({index: value.scaled(factor) for index, value in self.coefficients.items()})

    def of_degrees(self, least: int, most: int = ORDER) -> FunctionJet[T]:
        """The terms of these degrees."""
        return FunctionJet({index: v for index, v in self.coefficients.items() if least <= sum(index) <= most})


def compose(outer: FunctionJet[T], inner: Sequence[FunctionJet[T]]) -> FunctionJet[T]:
    """The increment of f(g(.)): `outer` without its constant term, `inner` increments without constant terms."""
    found: FunctionJet[T] = FunctionJet({})
    for index, value in outer.of_degrees(1).coefficients.items():
        factors = [jet for jet, power in zip(inner, index, strict=True) for _ in range(power)]
        term = factors[0]
        for factor in factors[1:]:
            term = term * factor
        found = found + term.times(value)
    return found


def solved(function: FunctionJet[T], inverse: T, known: Sequence[FunctionJet[T]]) -> FunctionJet[T]:
    """y(x) with f(y(x), x) = f(0, 0).

    Args:
        function: f; y is its first increment.
        inverse: 1/(df/dy).
        known: the increments x, in themselves.
    """
    slope = (1, *[0] * len(known))
    rest = FunctionJet({index: value for index, value in function.coefficients.items() if index != slope})
    found: FunctionJet[T] = FunctionJet({})
    for _ in range(ORDER):
        found = compose(rest, [found, *known]).times(inverse).scaled(Fraction(-1))
    return found


def inverse_of_plane_map(
    first: FunctionJet[T], second: FunctionJet[T], inverse_determinant: T
) -> tuple[FunctionJet[T], FunctionJet[T]]:
    """The inverse of a map of the plane, by the increments of the image.

    `inverse_determinant`: 1/det of the derivative.
    """
    (a, b), (c, d) = ([jet.coefficients[unit] for unit in ((1, 0), (0, 1))] for jet in (first, second))
    rows = [
        [entry * inverse_determinant for entry in row]
        for row in ((d, b.scaled(Fraction(-1))), (c.scaled(Fraction(-1)), a))
    ]
    linear = [FunctionJet({(1, 0): left, (0, 1): right}) for left, right in rows]
    bent = [jet.of_degrees(2) for jet in (first, second)]
    found = linear
    for _ in range(ORDER - 1):
        one, other = (compose(jet, found).scaled(Fraction(-1)) for jet in bent)
        found = [own + one.times(left) + other.times(right) for own, (left, right) in zip(linear, rows, strict=True)]
    return found[0], found[1]


def exchanged(function: FunctionJet[T]) -> FunctionJet[T]:
    """A function of two increments, by the second and the first."""
    return FunctionJet({(j, i): value for (i, j), value in function.coefficients.items()})
