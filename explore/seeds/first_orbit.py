"""Where a family starts that has no name of its own."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FirstOrbit:
    """An approximate first orbit of a family.

    Attributes:
        point: where it meets Fix(R), in the order of `centre_coordinates`.
        half_period: `None`: the time of the first crossing of the section close to Fix(R).
        direction: in which the family is followed, in the order of `centre_coordinates`; `None`: both ways.
    """

    point: tuple[float, ...]
    half_period: float | None
    direction: tuple[float, ...] | None = None
