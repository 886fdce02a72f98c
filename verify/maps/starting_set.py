"""Sets of initial values, exact, and their elements in the algebra (section 23.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.shared.systems import Program
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import LEAST_ERROR
from orbitproof.verify.poincare import BOX_RATIO, default_order, grade_bits


@dataclass(frozen=True)
class Format:
    """How a set is followed.

    Attributes:
        precision: fractional bits.
        degree: of the polynomials in the variables of the set, at least 1.
        order: degree of the expansions in time; `None` chooses it from the precision.
    """

    precision: int
    degree: int
    order: int | None = None


@dataclass(frozen=True)
class StartingSet:
    """The points centre + frame p with abs(p_j) <= radii_j, exactly.

    Attributes:
        size: number of state coordinates that are given; parameters follow them.
        centre: state, then parameters.
        frame: a row for each of these, a column for each variable p_j.
        radii: positive, one for each variable; none if the set is a point.
        defined: further state coordinates, functions of those before them (see `defined_values`).
    """

    size: int
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    radii: tuple[Fraction, ...]
    defined: tuple[tuple[str, Program], ...] = ()

    @property
    def scales(self) -> tuple[Fraction, ...]:
        """p_j at the edge of the polydisc."""
        return tuple(radius / BOX_RATIO for radius in self.radii)

    def arithmetic(self, chosen: Format) -> Arithmetic:
        """The algebra in which the set is followed. Raises `IntegrationFailure` for radii that floats cannot bound."""
        grading = Grading((1,) * len(self.radii), chosen.degree)
        if self.radii and min(self.scales) ** chosen.degree < Fraction(LEAST_ERROR):
            raise IntegrationFailure(
                "radii", f"errors are bounded by floats of at least {LEAST_ERROR:.0e}", "give larger radii"
            )
        further, loss = grade_bits(grading, self.scales, chosen.precision) if self.radii else (0, 0)
        order = default_order(chosen.precision) if chosen.order is None else chosen.order
        return Arithmetic(grading, chosen.precision, further, order, loss)

    def element(self, arithmetic: Arithmetic, factors: Sequence[Fraction], constant: Fraction) -> Series:
        """The function factors . (state and parameters) + constant on the set."""
        variables = len(self.radii)
        terms = {(0,) * variables: constant + _dot(factors, self.centre)}
        for j, scale in enumerate(self.scales):
            column = [row[j] for row in self.frame]
            terms[tuple(int(i == j) for i in range(variables))] = _dot(factors, column) * scale
        return arithmetic.polynomial(terms)

    def elements(self, arithmetic: Arithmetic) -> tuple[list[Series], list[Series]]:
        """State and parameters. Raises `IntegrationFailure` where a defined coordinate is not enclosed."""
        rows = range(len(self.centre))
        values = [self.element(arithmetic, [Fraction(int(i == row)) for i in rows], Fraction(0)) for row in rows]
        state, parameters = values[: self.size], values[self.size :]
        if self.defined:
            from orbitproof.verify.poincare.functions import defined_values

            state = [*state, *defined_values(self.defined, state, parameters)]
        return state, parameters


def _dot(left: Sequence[Fraction], right: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(left, right, strict=True)), Fraction(0))
