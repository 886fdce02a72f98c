"""The orbits of a tube about a piece, up to their return to the section (section 26.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb

from orbitproof.shared.formats import PeriodicAtlas, Piece
from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.curve import tube_points
from orbitproof.verify.evidence import IntegrationFailure, hull
from orbitproof.verify.maps import FramedOrbits, FramingOracle
from orbitproof.verify.periodic import functions_at_start, section_of, stops_of
from orbitproof.verify.poincare import (
    WIDE_PARTS,
    Coordinates,
    WideOracle,
    WideOrbits,
    at_start,
    defined_values,
    range_of,
    wide_parts,
)


class FramingWideOracle(WideOracle, FramingOracle, Protocol):
    """What may be asked about the orbits of a tube."""


class _FramedOrbits(FramedOrbits, WideOrbits):
    """As `WideOrbits`, the errors in a frame that the steps hand on (section 4.4)."""


@dataclass(frozen=True)
class Returns:
    """What becomes of the points of a tube.

    Attributes:
        images: after each number of crossings that was asked for, the state but for the pivot, in order.
        time: of the last of them.
    """

    images: Mapping[int, tuple[Series, ...]]
    time: Series

    def time_of_all(self) -> arb:
        """Encloses the time for all orbits of the tube."""
        times = ranges(self.time)
        return hull(times[0], *times[1:])


class TubeOfOrbits:
    """The points of a tube about a piece's polynomial, on the section, as elements in (sigma, omega).

    Attributes:
        point: the coordinates of the curve, by name.
        state: those of the state; 0 in place of the pivot, as the coordinate across the section.
        constants: all parameters, in the vector field's order.
    """

    def __init__(
        self,
        atlas: PeriodicAtlas,
        piece: Piece,
        interval: tuple[Fraction, Fraction],
        widths: Sequence[Fraction],
        arithmetic: Arithmetic,
    ) -> None:
        """`interval`: middle and ds/dsigma; `widths`: dp_j/domega_j."""
        claim, system = atlas.claim, atlas.system
        self.claim, self.system, self.arithmetic = claim, system, arithmetic
        self.section = section_of(system, claim.normal, claim.offset)
        self.point = tube_points(arithmetic, atlas.coordinates, piece, interval, widths)
        zero = arithmetic.constant(Fraction(0))
        given = [zero if i == claim.pivot else self.point[name] for i, name in enumerate(system.given_state)]
        self.constants = [
            self.point[name] if name == claim.parameter else arithmetic.constant(atlas.parameters[name])
            for name in system.parameters
        ]
        # The functions are those of the state itself, on the section.
        own = self.section.own_state(given) if system.defined else given
        self.state = [*given, *defined_values(functions_at_start(system), own, self.constants)]

    def others(self, state: Sequence[Series]) -> tuple[Series, ...]:
        """The given coordinates of the state but for the pivot."""
        given = state[: len(self.claim.normal)]
        return tuple(element for i, element in enumerate(given) if i != self.claim.pivot)

    def across(self, coordinates: Coordinates) -> Series:
        """normal . f at the points of the tube."""
        return at_start(coordinates.field, [*self.state, *self.constants])[self.claim.pivot]

    def follow(
        self, coordinates: Coordinates, oracle: FramingWideOracle, progress: Callable[[int], None] | None = None
    ) -> Returns:
        """The crossings in the direction that tell whether a point returns, and whether it does so before.

        The orbits leave the section in the direction, so crossing number j in it is number 2j in both directions
        (23.3). Raises `IntegrationFailure`.
        """
        last = self.claim.crossings
        orbits = _FramedOrbits(coordinates, self.arithmetic, self.state, self.constants, oracle, 0, 2 * last)
        images: dict[int, tuple[Series, ...]] = {}
        for stop in stops_of(last):
            self._reach(orbits, 2 * stop, stop, progress)
            images[stop] = self.others(orbits.crossing(2 * stop)[0])
        return Returns(images, orbits.return_time)

    def _reach(self, orbits: _FramedOrbits, number: int, stop: int, progress: Callable[[int], None] | None) -> None:
        """Follow the orbits until crossing `number` can be told, of which `stop` are in the direction."""
        while orbits.may_step(number, stop):
            try:
                arrived = orbits.step()
            except IntegrationFailure as failure:
                raise failure.at(float(orbits.time)) from None
            if progress is not None:
                progress(orbits.steps)
            if arrived and all(counter.arrival(number) is not None for counter in orbits.counters):
                return
            if any(counter.crossings > number for counter in orbits.counters):
                raise IntegrationFailure(
                    "crossing count",
                    f"orbits of the piece are beyond crossing {number}, and no step ended there for all of them",
                    "give a narrower piece",
                )
        raise IntegrationFailure(
            "steps",
            f"crossing {number} of the section was not reached in {orbits.steps} steps",
            "claim another section",
        )


def ranges(element: Series) -> list[arb]:
    """Enclosures of the values of an element without theta, one for each part of the interval of sigma."""
    return [range_of(element, part) for part in wide_parts(WIDE_PARTS)]
