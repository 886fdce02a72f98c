"""What is known of the returns of a box while a parameter varies (section 25.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from flint import arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.evidence import MAX_ORDER, DerivativeTable, MultiIndex, all_finite, indices_up_to
from orbitproof.verify.periodic import SectionReturn


@dataclass(frozen=True)
class BifurcationEnclosures:
    """What one proof is evaluated from. The variables of all functions are p and, if a parameter varies, s.

    Attributes:
        earlier: the returns after m / q crossings for each prime divisor q of m, the largest q first; with a symmetry
            S their images under S.
        image: the coordinates p of crossing m, or of its image under S; N - 1 functions, with derivatives to order 3.
        time: of crossing m.
        integral: the first integral at the points of the box, if one is used.
        order: degree of the time expansions.
        precision: bits of the fixed-point format.
        steps: number of integration steps.
        coordinates: in which the orbits were followed.
    """

    earlier: Annotated[tuple[SectionReturn, ...], rules(maxItems=32)]
    image: Annotated[tuple[DerivativeTable, ...], rules(minItems=1, maxItems=32)]
    time: DerivativeTable
    integral: DerivativeTable | None
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")

    @property
    def tables(self) -> tuple[DerivativeTable, ...]:
        """All of them."""
        return (*self.image, self.time, *(() if self.integral is None else (self.integral,)))


def variables_of(claim: PeriodicBifurcation) -> int:
    """How many variables the functions among the enclosures of a claim have."""
    return len(claim.radii) + (claim.parameter is not None)


def is_complete(table: DerivativeTable, indices: Sequence[MultiIndex]) -> bool:
    """Whether a table has exactly these derivatives, on the box and at its centre, and all are finite."""
    wanted = set(indices)
    return set(table.box) == wanted == set(table.centre) and all_finite([*table.box.values(), *table.centre.values()])


def with_variable(table: DerivativeTable, wanted: int) -> DerivativeTable:
    """The function as one of `wanted` variables; on the last of them it does not depend if it had one less."""

    def extended(source: Mapping[MultiIndex, arb]) -> dict[MultiIndex, arb]:
        return {index: source[index[:-1]] if index[-1] == 0 else arb(0) for index in indices}

    if all(len(index) == wanted for index in table.box):
        return table
    indices = indices_up_to(wanted, MAX_ORDER)
    return DerivativeTable(extended(table.box), extended(table.centre))
