"""What is enclosed of a set of orbits: states and times as functions on the set (sections 6 and 23.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from orbitproof.verify.algebra import Series
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, all_finite
from orbitproof.verify.maps.starting_set import StartingSet
from orbitproof.verify.poincare import BOX_RATIO, derivative_table


@dataclass(frozen=True)
class Image:
    """Functions on a set of initial values, of the variables p_j of the set.

    Attributes:
        state: derivatives of each state coordinate.
        time: those of the time that the orbits take.
        steps: number of integration steps.
    """

    state: tuple[DerivativeTable, ...]
    time: DerivativeTable
    steps: int


def image_of(start: StartingSet, state: Sequence[Series], time: Series, steps: int) -> Image:
    """The derivatives of elements that do not depend on time. Raises `IntegrationFailure` unless all are finite."""
    tables = [derivative_table(element, start.scales, BOX_RATIO) for element in (*state, time)]
    if not all(all_finite([*table.box.values(), *table.centre.values()]) for table in tables):
        raise IntegrationFailure(
            "derivatives", "a bound of the image is not finite", "give smaller radii, or more precision", True
        )
    return Image(tuple(tables[:-1]), tables[-1], steps)
