"""Truncated Taylor polynomials in few variables with balls as coefficients (section 7.3).

A `Jet` holds enclosures of the Taylor coefficients d^alpha f / alpha! of a function at a point, for
|alpha| up to its order. If all inputs enclose the coefficients at some point, so do sums, products,
compositions and implicit solutions. The point may be any point of a box: the statement then holds
at each of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from orbitproof.verify.evidence import MultiIndex, index_factorial, indices_of_degree, indices_up_to


def unit(variables: int, position: int) -> MultiIndex:
    """The multi-index of the first derivative in one variable."""
    return tuple(int(i == position) for i in range(variables))


def plus(left: MultiIndex, right: MultiIndex) -> MultiIndex:
    """Sum of two multi-indices."""
    return tuple(a + b for a, b in zip(left, right, strict=True))


@dataclass(frozen=True)
class Jet:
    """Enclosures of Taylor coefficients; absent coefficients are exactly zero."""

    variables: int
    order: int
    coefficients: Mapping[MultiIndex, arb]

    def __getitem__(self, index: MultiIndex) -> arb:
        return self.coefficients.get(index, arb(0))

    def derivative(self, *index: int) -> arb:
        """Enclosure of the partial derivative with this multi-index."""
        if len(index) != self.variables or sum(index) > self.order:
            raise ValueError(f"no derivative {index} in a jet of {self.variables} variables and order {self.order}")
        return self[index] * index_factorial(index)

    def __add__(self, other: Jet) -> Jet:
        keys = {**self.coefficients, **other.coefficients}
        return Jet(self.variables, self.order, {index: self[index] + other[index] for index in keys})

    def __mul__(self, other: Jet) -> Jet:
        result: dict[MultiIndex, arb] = {}
        for a, left in self.coefficients.items():
            for b, right in other.coefficients.items():
                if sum(a) + sum(b) <= self.order:
                    index = plus(a, b)
                    result[index] = result.get(index, arb(0)) + left * right
        return Jet(self.variables, self.order, result)

    def scaled(self, factor: arb) -> Jet:
        """The jet times a number."""
        return Jet(self.variables, self.order, {index: value * factor for index, value in self.coefficients.items()})


def increment(variables: int, order: int, position: int) -> Jet:
    """The jet of (x_position - its base point)."""
    return Jet(variables, order, {unit(variables, position): arb(1)})


def compose(derivatives: Mapping[MultiIndex, arb], increments: Sequence[Jet]) -> Jet:
    """Jet of F(x + u), given enclosures of the derivatives of F at x and jets u without constant term."""
    variables, order = increments[0].variables, increments[0].order
    one = Jet(variables, order, {(0,) * variables: arb(1)})
    powers: list[list[Jet]] = []
    for jet in increments:
        column = [one]
        for _ in range(order):
            column.append(column[-1] * jet)
        powers.append(column)
    result = Jet(variables, order, {})
    for index in indices_up_to(len(increments), order):
        term = one.scaled(derivatives[index] / index_factorial(index))
        for column, power in zip(powers, index, strict=True):
            if power:
                term = term * column[power]
        result = result + term
    return result


def implicit_jets(functions: Sequence[Mapping[MultiIndex, arb]], independent: int, order: int) -> tuple[Jet, ...]:
    """Jets of all coordinates (x, y(x)) minus their base point, on the graph of F(x, y(x)) = 0.

    `functions` holds enclosures of the derivatives of the components of F at a point of the graph;
    the first `independent` coordinates are x, the others y, as many as there are functions. Degree by
    degree, the unknown coefficients solve a linear system with the matrix D_y F (differentiation of
    the identity F(x, y(x)) = 0). Raises `ZeroDivisionError` if D_y F is not shown to be regular.
    """
    known = [increment(independent, order, position) for position in range(independent)]
    size = len(functions)
    if size == 0:
        return tuple(known)
    columns = [unit(independent + size, independent + j) for j in range(size)]
    matrix = arb_mat([[function[column] for column in columns] for function in functions])
    unknown = [Jet(independent, order, {}) for _ in range(size)]
    for degree in range(1, order + 1):
        residuals = [compose(function, [*known, *unknown]) for function in functions]
        for index in indices_of_degree(independent, degree):
            solution = matrix.solve(arb_mat([[-residual[index]] for residual in residuals]))
            unknown = [
                Jet(independent, order, {**jet.coefficients, index: solution[i, 0]}) for i, jet in enumerate(unknown)
            ]
    return (*known, *unknown)


def derivatives_of(jet: Jet) -> dict[MultiIndex, arb]:
    """The derivatives of which a jet holds the Taylor coefficients; 0 of order 0."""
    indices = indices_up_to(jet.variables, jet.order)
    return {index: jet.derivative(*index) if any(index) else arb(0) for index in indices}
