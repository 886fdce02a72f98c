"""Vectors along a step of an orbit, as polynomials in time with bounds of what is unknown (section 35.2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, arb_poly

from orbitproof.verify.algebra import Series
from orbitproof.verify.evidence import enclose


@dataclass(frozen=True)
class Moving:
    """A vector at the times theta in [0, 1] of a step.

    Attributes:
        known: polynomials in theta, one per coordinate.
        errors: the vector differs from these by at most so much, at any of the times.
    """

    known: tuple[arb_poly, ...]
    errors: tuple[arb, ...]

    def over(self, theta: arb) -> tuple[arb, ...]:
        """The coordinates of the vector over a ball of times."""
        return tuple(
            _over(known, theta) + error * arb(0, 1) for known, error in zip(self.known, self.errors, strict=True)
        )

    def less(self, share: arb, other: Moving) -> Moving:
        """What is left of it without a multiple of another vector of the same step."""
        return Moving(
            tuple(a - share * b for a, b in zip(self.known, other.known, strict=True)),
            tuple(a + abs(share) * b for a, b in zip(self.errors, other.errors, strict=True)),
        )


def moving(elements: Sequence[Series], place: int, unit: Fraction) -> Moving:
    """The coefficients of one monomial of grade 0 or 1 over a step, divided by `unit`.

    Args:
        place: 0 for the constant term, j + 1 for variable j, in an arithmetic of grade 1.
    """
    arithmetic = elements[0].arithmetic
    variables = len(arithmetic.grading.weights)
    monomial = tuple(int(place == number + 1) for number in range(variables))
    index, divisor = arithmetic.grading.index[monomial], enclose(unit)
    scale = arb(2) ** -arithmetic.scales[index] / divisor
    return Moving(
        tuple(arb_poly([arb(value) * scale for value in element.coefs[index].coeffs()]) for element in elements),
        tuple(arb(element.errors[1 if place else 0]) / divisor for element in elements),
    )


def reduced(vectors: Sequence[Moving], canonical: Callable[[Moving, arb], tuple[acb, ...]], theta: arb) -> list[Moving]:
    """The vectors less real multiples of those before them (35.3), about orthogonal in the middle of a ball of times.

    Which multiples these are is of no account: numbers that rounding has made.
    """
    middle = theta.mid()
    found: list[tuple[Moving, tuple[acb, ...]]] = []
    for vector in vectors:
        rest = vector
        for other, direction in found:
            share = _product(canonical(rest, middle), direction) / _product(direction, direction)
            rest = rest.less(share.mid(), other)
        found.append((rest, canonical(rest, middle)))
    return [vector for vector, _ in found]


def _product(first: Sequence[acb], second: Sequence[acb]) -> arb:
    """The Euclidean product of the real vectors behind complex ones."""
    return sum(((a * b.conjugate()).real for a, b in zip(first, second, strict=True)), arb(0))


def _over(polynomial: arb_poly, theta: arb) -> arb:
    """By the mean value theorem."""
    middle = theta.mid()
    return polynomial(middle) + polynomial.derivative()(theta) * (theta - middle)
