"""The vector field on an approximate solution, whoever finds that solution (section 3.2).

Proofs rest on what is computed here from the coefficients that are given; whoever gives them gets copies.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpz_poly

from orbitproof.verify.algebra import Arithmetic, Evaluation, PreparedProgram, Series


class FieldAlong:
    """An approximate solution of x' = f(x), given monomial by monomial, and f evaluated on what is given.

    Args:
        program: the vector field.
        state: initial values, constant in theta.
        parameters: constants of motion that the program takes after the state.
    """

    def __init__(
        self, program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
    ) -> None:
        self.program, self.arithmetic = program, arithmetic
        self.state, self.parameters = tuple(state), tuple(parameters)
        self._evaluation = Evaluation(program, arithmetic)
        self._solution: list[list[fmpz_poly]] = [[] for _ in state]

    @property
    def position(self) -> int:
        """The monomial that is to be given next."""
        return len(self._solution[0])

    def give(self, coefficients: Sequence[fmpz_poly]) -> None:
        """The coefficients of the next monomial, polynomials in theta, one per component.

        Raises `ValueError` unless they are in the format and start at the known part of the state.
        """
        position, arithmetic = self.position, self.arithmetic
        given = [fmpz_poly(polynomial) for polynomial in coefficients]
        if any(arithmetic.cut(polynomial)[1] for polynomial in given):
            raise ValueError("the approximate solution has powers that are not kept")
        starts = [polynomial.truncate(arithmetic.stride) for polynomial in given]
        if starts != [x.coefs[position] for x in self.state]:
            raise ValueError("the approximate solution does not start at the known part of the state")
        self._evaluation.fill(position, [*given, *self._constants(position)])
        for row, polynomial in zip(self._solution, given, strict=True):
            row.append(polynomial)

    def centre(self) -> tuple[list[fmpz_poly], dict[int, fmpz_poly]]:
        """The values of all nodes at the centre, and approximations of 1 / base for those that are powers."""
        values = [fmpz_poly(row[0]) for row in self._evaluation.coefs]
        powers = [index for index, node in enumerate(self.program.nodes) if node.operation == "pow"]
        return values, {index: fmpz_poly(self._evaluation.reciprocal(index)) for index in powers}

    def trial(self, position: int, coefficients: Sequence[fmpz_poly]) -> list[fmpz_poly]:
        """A monomial of the field if these were the coefficients of the solution there.

        Raises `ValueError` unless all monomials of lower grade were given, and this one was not.
        """
        grades = self.arithmetic.grading.grades
        # What is kept of a trial for the monomial itself is made of those of lower grade.
        if not grades.index(grades[position]) <= self.position <= position:
            raise ValueError("a monomial is tried out after those of lower grade were given, and before it is")
        self._evaluation.try_out(position, [*map(fmpz_poly, coefficients), *self._constants(position)])
        return [fmpz_poly(self._evaluation.coefs[output][position]) for output in self.program.outputs]

    def enclosed(self) -> tuple[list[Series], list[Series]]:
        """The solution that was given, exactly, and the field on it.

        Raises `ValueError` unless all monomials were given, `IntegrationFailure` where the field is not bounded.
        """
        arithmetic = self.arithmetic
        if self.position != len(arithmetic.grading.monomials):
            raise ValueError("the approximate solution is not complete")
        solution = [Series(arithmetic, row, arithmetic.zero_errors()) for row in self._solution]
        nodes = self._evaluation.enclose([*solution, *self.parameters])
        return solution, [nodes[output] for output in self.program.outputs]

    def _constants(self, position: int) -> list[fmpz_poly]:
        return [x.coefs[position] for x in self.parameters]
