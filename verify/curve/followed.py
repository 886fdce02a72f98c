"""What theorems about curves may ask of the integration of one orbit (sections 15.8 and 16.11)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb

from orbitproof.shared.systems import ReversibleSystem

Point = Mapping[str, arb]
"""Enclosures of coordinates, by name."""


class Partner(Protocol):
    """Encloses the point of a symmetric orbit at the end of its half orbit."""

    def __call__(
        self,
        system: ReversibleSystem,
        parameters: Mapping[str, Fraction],
        point: Point,
        crossings: int,
        onto: ReversibleSystem | None = None,
    ) -> Point | None:
        """On the fixed points of R, or of the reversing symmetry of `onto`, a system with the same equations."""


def no_partner(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Point,
    crossings: int,
    onto: ReversibleSystem | None = None,
) -> None:
    """A `Partner` that finds none."""


@dataclass(frozen=True)
class Crossing:
    """Where an orbit meets the section: the state by the names of its coordinates, and the time."""

    state: Mapping[str, arb]
    time: arb


class Follow(Protocol):
    """Encloses crossings of the section by the orbit of a point."""

    def __call__(
        self, system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Mapping[str, arb], crossings: int
    ) -> list[Crossing] | None:
        """The first so many; `None` if they are not enclosed."""


def follow_nothing(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Mapping[str, arb], crossings: int
) -> None:
    """A `Follow` that encloses nothing."""
