"""Orbits at places along a family from their neighbours, where Newton's method fails or leads away over long steps."""

from __future__ import annotations

import pytest

from orbitproof.explore.atlases import LibrationFailure
from orbitproof.explore.atlases.neighbours import orbit_at


def beside(near: float, place: float) -> float:
    if abs(place - near) > 0.3:
        raise LibrationFailure("too far")
    return place


def test_steps_are_halved_and_what_lies_on_the_way_is_known() -> None:
    known = [0.0, -5.0]
    assert orbit_at(2.0, known, 1.0, float, beside) == 2.0
    assert known == [0.0, -5.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0]


def test_an_orbit_that_is_far_from_its_neighbour_is_not_kept() -> None:
    known = [0.0]
    assert orbit_at(0.25, known, 1.0, float, beside, lambda found, near: abs(found - near) > 0.2) == 0.25
    assert known == [0.0, 0.125, 0.25]


def test_a_family_that_ends_is_a_failure() -> None:
    def ended(near: float, place: float) -> float:
        if place > 1:
            raise LibrationFailure("no orbit")
        return place

    with pytest.raises(LibrationFailure, match="no orbit"):
        orbit_at(2.0, [0.0], 1.0, float, ended)
