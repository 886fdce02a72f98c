"""What is known of the returns of a box to its section (section 24.2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

from flint import arb

from orbitproof.shared.claims.fields import Crossings
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.evidence import dot


@dataclass(frozen=True)
class Linearised:
    """A function on the box |p_i| <= R_i.

    Attributes:
        centre: encloses its value at p = 0.
        slopes: enclose its derivatives at every point of the box, one for each p_i.
    """

    centre: arb
    slopes: tuple[arb, ...]

    def value(self, where: Sequence[arb]) -> arb:
        """Encloses the values at all points of the box with p in `where`, by the mean value theorem."""
        return self.centre + dot(self.slopes, where)

    @property
    def balls(self) -> Iterator[arb]:
        """All of them."""
        yield self.centre
        yield from self.slopes


@dataclass(frozen=True)
class SectionReturn:
    """The point at which the orbits of the box cross the section for the j-th time, in the direction.

    Attributes:
        crossings: j.
        image: its coordinates p, N - 1 functions.
        time: when it happens.
    """

    crossings: Crossings
    image: Annotated[tuple[Linearised, ...], rules(minItems=1, maxItems=32)]
    time: Linearised


@dataclass(frozen=True)
class PeriodicEnclosures:
    """What one proof is evaluated from.

    Attributes:
        returns: first those after m / q crossings for each prime divisor q of m, the largest q first, then the m-th.
        order: degree of the time expansions.
        precision: bits of the fixed-point format.
        steps: number of integration steps.
        coordinates: in which the orbits were followed.
    """

    returns: Annotated[tuple[SectionReturn, ...], rules(minItems=1, maxItems=32)]
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")


def stops_of(crossings: int) -> tuple[int, ...]:
    """The numbers of crossings after which the returns are needed: m / q for each prime q that divides m, and m."""
    primes = [
        q for q in range(2, crossings + 1) if crossings % q == 0 and all(q % other for other in range(2, q))
    ]  # fmt: skip
    return (*sorted(crossings // q for q in primes), crossings)
