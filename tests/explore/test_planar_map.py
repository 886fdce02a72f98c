"""Reversible planar maps: what their portraits show is true of the map."""

from __future__ import annotations

import json
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.refusals import refused

from orbitproof.explore.__main__ import main
from orbitproof.explore.portraits import (
    QUADRUPLING,
    TOUCH_AND_GO,
    Portrait,
    Resonance,
    ReversibleMap,
    portrait,
    read_portraits,
    symmetric_periodic_orbits,
    unstable_manifold,
    write_portraits,
)
from orbitproof.shared import InputError

MAPS = [ReversibleMap(0.3, 0.7, -0.4), QUADRUPLING.at(0.02), TOUCH_AND_GO.at(-0.02)]
RESONANCES = [QUADRUPLING, TOUCH_AND_GO]


@pytest.fixture(scope="module")
def portraits() -> list[Portrait]:
    return [portrait(QUADRUPLING, nu, 0.36, 4, 40) for nu in (-0.03, 0.0, 0.03)] + [
        portrait(TOUCH_AND_GO, nu, 0.16, 4, 40) for nu in (-0.03, 0.03)
    ]


@pytest.mark.parametrize("mapping", MAPS)
def test_map_is_reversible_and_preserves_area(mapping: ReversibleMap) -> None:
    points = np.random.default_rng(3).uniform(-0.6, 0.6, (100, 2))
    assert mapping(mapping(points)[:, ::-1])[:, ::-1] == pytest.approx(points, abs=1e-14)
    for point in points[:10]:
        for k in (1, 3):
            derivative = mapping.derivative(point, k)
            assert np.linalg.det(derivative) == pytest.approx(1.0, abs=1e-9)
            steps = 1e-6 * np.eye(2)
            columns = [(mapping.power(point + h, k) - mapping.power(point - h, k)) / 2e-6 for h in steps]
            assert derivative == pytest.approx(np.column_stack(columns), rel=1e-5, abs=1e-6)


def test_iterates_are_those_of_the_map_and_stop_outside_the_disc() -> None:
    mapping = TOUCH_AND_GO.at(0.0)
    rows = mapping.iterates(np.array([0.3, 0.2]), 50, 2.0)
    assert 2 < len(rows) < 50
    assert rows[1:] == pytest.approx(mapping(rows[:-1]), rel=1e-12)
    assert np.hypot(*mapping(rows[-1])) > 2.0


@pytest.mark.parametrize("resonance", RESONANCES)
def test_linear_part_at_the_resonance_is_a_rotation_and_reversor_a_reflection(resonance: Resonance) -> None:
    frame = resonance.frame
    rotation = frame @ resonance.at(0.0).derivative(np.zeros(2), 1) @ np.linalg.inv(frame)
    angle = 2 * np.pi / resonance.k
    assert abs(rotation[0, 0] - np.cos(angle)) < 1e-14
    assert rotation @ rotation.T == pytest.approx(np.eye(2), abs=1e-14)
    swap = np.array([[0.0, 1.0], [1.0, 0.0]])
    assert frame @ swap @ np.linalg.inv(frame) == pytest.approx(np.diag([1.0, -1.0]), abs=1e-14)


def test_period_quadrupling_is_one_sided_and_its_orbit_meets_the_line_in_exactly_two_points() -> None:
    assert symmetric_periodic_orbits(QUADRUPLING.at(-0.03), 4, 0.5) == []
    assert symmetric_periodic_orbits(QUADRUPLING.at(0.0), 4, 0.5) == []
    orbits = symmetric_periodic_orbits(QUADRUPLING.at(0.03), 4, 0.5)
    assert {orbit.line: orbit.elliptic for orbit in orbits} == {"R": True, "R f": False}
    elliptic = next(orbit for orbit in orbits if orbit.elliptic)
    # g(t) = 0 away from 0: t^2 = nu for the odd map x -> -nu x + x^3.
    assert np.abs(elliptic.points) == pytest.approx(np.full((4, 2), sqrt(0.03)), abs=1e-12)
    assert np.count_nonzero(np.abs(elliptic.points[:, 0] - elliptic.points[:, 1]) < 1e-9) == 2


def test_touch_and_go_orbit_is_hyperbolic_on_both_sides_and_passes_the_fixed_point() -> None:
    place = {}
    for nu in (-0.03, 0.03):
        (orbit,) = symmetric_periodic_orbits(TOUCH_AND_GO.at(nu), 3, 0.3)
        assert not orbit.elliptic
        place[nu] = orbit.points[0, 0]
    assert place[-0.03] * place[0.03] < 0
    (near,) = symmetric_periodic_orbits(TOUCH_AND_GO.at(0.003), 3, 0.03)
    assert abs(near.points[0, 0]) < 0.2 * abs(place[0.03])


@pytest.mark.parametrize("resonance", RESONANCES)
def test_periodic_orbits_close_with_their_principal_period(resonance: Resonance) -> None:
    mapping = resonance.at(0.02)
    for orbit in symmetric_periodic_orbits(mapping, resonance.k, 0.6):
        assert mapping(orbit.points) == pytest.approx(np.roll(orbit.points, -1, axis=0), abs=1e-9)
        distances = np.linalg.norm(orbit.points[:, None] - orbit.points[None], axis=2)
        assert distances[~np.eye(resonance.k, dtype=bool)].min() > 1e-3


def test_unstable_manifold_falls_back_to_its_orbit_under_the_inverse() -> None:
    mapping = TOUCH_AND_GO.at(0.03)
    (orbit,) = symmetric_periodic_orbits(mapping, 3, 0.3)
    branches = unstable_manifold(mapping, orbit, 1.0, 0.3)
    assert len(branches) == 6
    for branch in branches:
        back = branch[-1]
        for _ in range(3 * 60):
            back = mapping(back[::-1])[::-1]
        far = np.linalg.norm(orbit.points - branch[-1], axis=1).min()
        assert np.linalg.norm(orbit.points - back, axis=1).min() < 1e-3 < far


def test_invariant_curves_are_mapped_into_each_other(portraits: list[Portrait]) -> None:
    shown = portraits[-1]
    frame = TOUCH_AND_GO.frame
    everything = np.vstack(shown.curves)
    for curve in shown.curves[:4]:
        inside = curve[np.abs(curve).max(axis=1) < 0.1]
        images = shown.map(inside @ np.linalg.inv(frame).T) @ frame.T
        for image in images[:20]:
            assert np.linalg.norm(everything - image, axis=1).min() < 1e-4


def test_portraits_are_symmetric_and_show_the_bifurcations(portraits: list[Portrait]) -> None:
    assert [len(item.periodic) for item in portraits] == [0, 0, 2, 1, 1]
    for item in portraits:
        for orbit in item.periodic:
            mirrored = orbit.points * np.array([1.0, -1.0])
            assert all(np.linalg.norm(orbit.points - row, axis=1).min() < 1e-8 for row in mirrored)
        assert bool(item.manifolds) == any(not orbit.elliptic for orbit in item.periodic)


def test_portrait_file_reads_back_what_was_written(portraits: list[Portrait], tmp_path: Path) -> None:
    path = tmp_path / "portraits.json"
    write_portraits(path, portraits)
    for read, written in zip(read_portraits(path), portraits, strict=True):
        assert (read.k, read.parameter, read.map, read.window) == (
            written.k,
            written.parameter,
            written.map,
            written.window,
        )
        for name in ("orbits", "curves", "manifolds"):
            for one, other in zip(getattr(read, name), getattr(written, name), strict=True):
                assert one == pytest.approx(other, abs=1e-5)
        assert [orbit.line for orbit in read.periodic] == [orbit.line for orbit in written.periodic]


@pytest.mark.parametrize(
    "change",
    [
        lambda entry: entry["orbits"][0][0].append(0.5),
        lambda entry: entry["orbits"][0][0].__setitem__(0, "zero"),
        lambda entry: entry["orbits"][0][1].__setitem__(0, 1e999),
        lambda entry: entry["periodic"][0]["points"].pop(),
        lambda entry: entry.pop("map"),
        lambda entry: entry.update(window=0),
    ],
)
def test_damaged_portrait_file_is_refused_in_one_line(portraits: list[Portrait], tmp_path: Path, change: Any) -> None:
    path = tmp_path / "portraits.json"
    write_portraits(path, portraits[2:3])
    document = json.loads(path.read_text())
    change(document["portraits"][0])
    path.write_text(json.dumps(document).replace("Infinity", "1e999"))
    with pytest.raises(InputError) as caught:
        read_portraits(path)
    assert "portraits" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_command_writes_both_resonances_before_at_and_after(tmp_path: Path) -> None:
    path = tmp_path / "portraits.json"
    assert main(["portraits", "--orbits", "2", "--iterates", "10", "-o", str(path), "--quiet"]) == 0
    found = [(item.k, item.parameter) for item in read_portraits(path)]
    assert found == [(k, nu) for k in (4, 3) for nu in (-0.03, 0.0, 0.03)]


@pytest.mark.parametrize(
    "option", [["--parameter", "0"], ["--parameter", "nan"], ["--orbits", "1"], ["--iterates", "9"]]
)
def test_bad_options_are_one_line_and_exit_code_2(option: list[str], tmp_path: Path, capsys: Any) -> None:
    assert option[0] in refused(main, ["portraits", *option, "-o", str(tmp_path / "p.json")], capsys)
