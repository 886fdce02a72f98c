"""A homoclinic orbit is drawn from its periodic orbit to Fix(R) and back, with its cone and both manifolds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support import homoclinic_cases as cases

from orbitproof.figures import draw_periodic
from orbitproof.figures.orbits import Connection, OrbitNotClosed, connection_of
from orbitproof.figures.pictures import connection as pictures
from orbitproof.figures.pictures import draw_connection
from orbitproof.figures.style import close
from orbitproof.shared.formats import write_candidates


@pytest.fixture(scope="module")
def found() -> Connection:
    return connection_of(cases.wells())


def test_a_homoclinic_orbit_leads_from_its_periodic_orbit_to_the_fixed_set_and_back(
    found: Connection,
) -> None:
    x, y, u, v = found.orbit.T
    assert found.meeting[:3] == pytest.approx([2.365652526599, 0, 0], abs=1e-8)
    assert np.allclose(
        (u**2 + v**2) / 2 - (x - 1) ** 2 / 2 + (x - 1) ** 4 / 4 + 2 * y**2 + (x - 1) ** 2 * y**2 / 4, 0.5
    )
    for end in (found.orbit[0], found.orbit[-1]):
        assert np.abs(found.periodic - end).max(axis=1).min() < 1e-3
    assert np.abs(found.periodic[:, 0] - 1).max() < 1e-9
    assert found.unstable[0, 2] * found.unstable[-1, 2] < 0


def test_only_what_is_enclosed_is_filled_and_what_is_no_connection_is_not_drawn(
    found: Connection, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pictures, "connection_of", lambda _: found)
    figure = draw_connection(cases.wells())
    _, cone, section = figure.axes
    labels = {line.get_label(): line for line in section.get_lines()}
    assert labels["in Fix(R), numerical"].get_markerfacecolor() == "white"
    # The sliver lies inside of the box, and is twice as wide as the cone is there.
    (at, _), (low, high) = next(line for line in cone.get_lines() if line.get_label() == "sliver").get_data()
    assert 0 < at < 1
    assert (low, high) == (-2 * at, 2 * at)
    close(figure)
    write_candidates(tmp_path / "wells.json", [cases.wells()])
    drawn = draw_periodic([tmp_path / "wells.json"], tmp_path)
    assert {path.stem for path in drawn.paths} == {"homoclinic-wells"}
    assert not drawn.not_drawn
    with pytest.raises(OrbitNotClosed):
        connection_of(replace(cases.wells(), arrival=1))
