"""A homoclinic orbit is drawn from its periodic orbit to Fix(R) and back, with both manifolds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support import homoclinic_cases as cases

from orbitproof.figures.orbits import OrbitNotClosed, connection_of
from orbitproof.figures.pictures import draw_connection
from orbitproof.figures.style import close


def test_a_homoclinic_orbit_leads_from_its_periodic_orbit_to_the_fixed_set_and_back() -> None:
    found = connection_of(cases.wells())
    x, y, u, v = found.orbit.T
    assert found.meeting[:3] == pytest.approx([2.365652526599, 0, 0], abs=1e-8)
    assert np.allclose(
        (u**2 + v**2) / 2 - (x - 1) ** 2 / 2 + (x - 1) ** 4 / 4 + 2 * y**2 + (x - 1) ** 2 * y**2 / 4, 0.5
    )
    for end in (found.orbit[0], found.orbit[-1]):
        assert np.abs(found.periodic - end).max(axis=1).min() < 1e-3
    assert np.abs(found.periodic[:, 0] - 1).max() < 1e-9
    assert found.unstable[0, 2] * found.unstable[-1, 2] < 0


def test_only_what_is_enclosed_is_filled_and_what_is_no_connection_is_not_drawn() -> None:
    figure = draw_connection(cases.wells())
    labels = {line.get_label(): line for line in figure.axes[1].get_lines()}
    assert labels["in Fix(R), numerical"].get_markerfacecolor() == "white"
    close(figure)
    with pytest.raises(OrbitNotClosed):
        connection_of(replace(cases.wells(), arrival=1))
