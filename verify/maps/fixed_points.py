"""Functions of a set whose zeros are fixed points of a map, and interval Newton for them (section 23.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.verify.evidence import (
    DerivativeTable,
    IntegrationFailure,
    MultiIndex,
    enclose,
    is_inside,
    is_outside,
    symmetric,
    total,
    without_result,
)
from orbitproof.verify.maps.affine_section import AffineSection
from orbitproof.verify.maps.image import Image
from orbitproof.verify.maps.starting_set import StartingSet
from orbitproof.verify.newton import BoxFunction, ImplicitGraph


def combination(
    start: StartingSet,
    tables: Sequence[DerivativeTable],
    factors: Sequence[Fraction],
    variables: Sequence[Fraction],
    constant: Fraction,
) -> DerivativeTable:
    """Derivatives of factors . functions + variables . p + constant on a set.

    Args:
        tables: of the functions.
        variables: a number for each variable p_j of the set.
    """
    units = [tuple(int(i == j) for i in range(len(start.radii))) for j in range(len(start.radii))]
    own = {unit: enclose(value) for unit, value in zip(units, variables, strict=True)}
    zero = (0,) * len(start.radii)
    reach = total(enclose(value) * symmetric(r) for value, r in zip(variables, start.radii, strict=True))

    def combined(values: Sequence[arb], index: MultiIndex, at: arb) -> arb:
        result = total(enclose(factor) * value for factor, value in zip(factors, values, strict=True) if factor)
        return result + (enclose(constant) + at if index == zero else own.get(index, arb(0)))

    indices = tables[0].box
    return DerivativeTable(
        {index: combined([table.box[index] for table in tables], index, reach) for index in indices},
        {index: combined([table.centre[index] for table in tables], index, arb(0)) for index in indices},
    )


def displacement(start: StartingSet, section: AffineSection, image: Image) -> tuple[DerivativeTable, ...]:
    """P(x) - x on a set in the section, in all given state coordinates but the section's `pivot`.

    Zeros are the points with P(x) = x. Raises `ValueError` for a set that does not lie on the section.
    """
    if not section.holds(start):
        raise ValueError("the set does not lie on the section: give a centre on it and a frame whose columns lie in it")
    return tuple(
        combination(start, [table], [Fraction(1)], [-value for value in start.frame[index]], -start.centre[index])
        for index, table in enumerate(image.state[: start.size])
        if index != section.pivot
    )


@dataclass(frozen=True)
class Zeros:
    """The zeros of as many functions as there are unknowns: one for each value of the other variables.

    Attributes:
        graph: the functions; the independent variables come first.
        at: enclosures of the variables p_j at all zeros.
    """

    graph: ImplicitGraph
    at: tuple[arb, ...]


def enclose_zeros(functions: Sequence[DerivativeTable], radii: Sequence[Fraction]) -> Zeros:
    """Show that functions on abs(p_j) <= radii_j have exactly one zero there for each value of the first variables.

    The unknowns are the last variables, as many as there are functions. Raises `IntegrationFailure` if that is not
    shown, with what is known: the zeros that there are lie in the image of the Newton operator.
    """
    independent = len(radii) - len(functions)
    box = tuple(symmetric(radius) for radius in radii)
    graph = ImplicitGraph(tuple(map(BoxFunction, functions)), box, independent)
    if not functions or not graph.is_regular():
        raise IntegrationFailure(
            "newton",
            "the derivative by the unknowns may be singular on the set",
            "give smaller radii, or a point that is no bifurcation",
        )
    try:
        image = graph.image(box[:independent])
        outside = [is_outside(ball, radius) for ball, radius in zip(image, radii[independent:], strict=True)]
        if not all(is_inside(ball, radius) for ball, radius in zip(image, radii[independent:], strict=True)):
            raise IntegrationFailure(
                "newton",
                "there is no zero in the set" if any(outside) else "a zero may lie outside the set",
                "give a better centre" if any(outside) else "give a better centre, or more precision and other radii",
                needs_precision=not any(outside),
            )
        return Zeros(graph, graph.over(box[:independent]))
    except (ArithmeticError, ValueError) as error:
        raise IntegrationFailure("newton", without_result(error), "give smaller radii, or more precision") from None
