"""Which monomials are kept: weights, grades and the product table (section 2.1)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

Exponents = tuple[int, ...]
Pairs = tuple[tuple[int, int], ...]
Factors = tuple[Pairs, ...]


@dataclass(frozen=True)
class Grading:
    """The monomials in xi_1 .. xi_r of grade (weighted degree) at most `top`.

    Attributes:
        weights: positive weight of each variable, length r.
        top: the largest grade kept, G.
    """

    weights: tuple[int, ...]
    top: int

    def __post_init__(self) -> None:
        if any(weight < 1 for weight in self.weights) or self.top < 0:
            raise ValueError("weights are positive and the top grade is not negative")

    @cached_property
    def monomials(self) -> tuple[Exponents, ...]:
        """Exponents of the kept monomials, by grade; the first is the constant."""
        ranges = [range(self.top // weight + 1) for weight in self.weights]
        kept = [exponents for exponents in product(*ranges) if self.grade(exponents) <= self.top]
        return tuple(sorted(kept, key=lambda exponents: (self.grade(exponents), exponents)))

    @cached_property
    def index(self) -> dict[Exponents, int]:
        """Position of each kept monomial."""
        return {exponents: position for position, exponents in enumerate(self.monomials)}

    @cached_property
    def grades(self) -> tuple[int, ...]:
        """Grade of each kept monomial."""
        return tuple(self.grade(exponents) for exponents in self.monomials)

    @cached_property
    def factors(self) -> Factors:
        """For each kept monomial, the ordered pairs of kept monomials whose product it is."""
        table: list[list[tuple[int, int]]] = [[] for _ in self.monomials]
        for i, left in enumerate(self.monomials):
            for j, right in enumerate(self.monomials):
                position = self.index.get(tuple(a + b for a, b in zip(left, right, strict=True)))
                if position is not None:
                    table[position].append((i, j))
        return tuple(tuple(pairs) for pairs in table)

    @cached_property
    def inner_factors(self) -> Factors:
        """The pairs without the constant."""
        return tuple(tuple(pair for pair in pairs if 0 not in pair) for pairs in self.factors)

    @cached_property
    def outer_factors(self) -> Factors:
        """The pairs with the constant."""
        return tuple(tuple(pair for pair in pairs if 0 in pair) for pairs in self.factors)

    def grade(self, exponents: Exponents) -> int:
        """Weighted degree of a monomial."""
        return sum(weight * exponent for weight, exponent in zip(self.weights, exponents, strict=True))

    def variable(self, position: int) -> int | None:
        """Index of the monomial xi_position, or `None` if its weight exceeds the top grade."""
        return self.index.get(tuple(int(i == position) for i in range(len(self.weights))))
