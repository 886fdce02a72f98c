"""Orbits carried over to bodies that move as kernels say: they solve Newton's equations, and say what they are."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import spiceypy
from scipy.integrate import solve_ivp
from support import written_kernels as kernels

from orbitproof.explore.__main__ import main
from orbitproof.explore.three_body.ephemeris_model import bodies_named, carry_over, kernels_loaded
from orbitproof.explore.three_body.trajectories import Choice, Frame, Units, find_orbit, sample, trajectory_of
from orbitproof.shared import InputError

ROWS = Path(__file__).resolve().parents[3] / "docs" / "examples" / "gateway-rows.json"
GIVEN = [f"{name}={value}" for name, value in kernels.GRAVITY.items()]


@pytest.fixture(scope="module")
def circle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return kernels.write_kernel(tmp_path_factory.mktemp("circle") / "bodies.bsp", 0.0)


@pytest.fixture(scope="module")
def ellipse(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return kernels.write_kernel(tmp_path_factory.mktemp("ellipse") / "bodies.bsp", 0.055)


def test_between_two_bodies_on_circles_the_orbit_is_that_of_the_restricted_problem(circle: Path) -> None:
    trajectory = trajectory_of(find_orbit(ROWS, Choice(number=2)))
    earth_moon = {name: kernels.GRAVITY[name] for name in ("Earth", "Moon")}
    with kernels_loaded([circle]):
        found = carry_over(trajectory, bodies_named(["Earth", "Moon"], earth_moon), 0.0, periods=0.6)
        turn = np.sqrt(kernels.LENGTH**3 / sum(earth_moon.values()))
        units = Units(kernels.LENGTH, turn, "of the kernel")
        assert found.times[-1] == pytest.approx(0.6 * trajectory.period * turn, rel=1e-9)
        expected = sample(trajectory, frame=Frame("inertial", "smaller"), units=units, periods=0.6, count=40)
        states = found.states_at(np.minimum(expected.times, found.times[-1]))
    gaps = np.linalg.norm((states - expected.states)[:, :3], axis=1)
    # The masses of the kernel and of the catalogue agree to 8 digits.
    assert gaps.max() < 0.01
    assert found.gaps[0] < 1e-6


def test_with_the_sun_the_orbit_solves_newton_s_equations_and_stays_near(ellipse: Path) -> None:
    """Integrated in one go, with places of the bodies from Kepler's formulas instead of the kernel."""
    trajectory = trajectory_of(find_orbit(ROWS, Choice(number=2)))
    with kernels_loaded([ellipse]):
        found = carry_over(trajectory, bodies_named(list(kernels.GRAVITY), kernels.GRAVITY), 1e4, periods=0.7)

    def field(time: float, state: np.ndarray) -> np.ndarray:
        now = np.array([1e4 + time])
        earth = -kernels.moon(now, 0.055)[0, :3]
        centre = -(1 - kernels.MASS) * kernels.moon(now, 0.055)[0, :3]
        others = ((kernels.GRAVITY["Earth"], earth), (kernels.GRAVITY["Sun"], centre + kernels.sun(now)[0, :3]))
        pull = -kernels.GRAVITY["Moon"] * state[:3] / np.linalg.norm(state[:3]) ** 3
        for gravity, where in others:
            gap = where - state[:3]
            pull += gravity * (gap / np.linalg.norm(gap) ** 3 - where / np.linalg.norm(where) ** 3)
        return np.append(state[3:], pull)

    times = found.times[::4]
    solution = solve_ivp(
        field, (0.0, times[-1]), found.starts[0], method="DOP853", rtol=1e-11, atol=1e-9, t_eval=times
    )  # fmt: skip
    assert np.linalg.norm((solution.y.T - found.starts[::4])[:, :3], axis=1).max() < 0.05
    assert found.gaps[0] < 1e-6
    assert 100 < found.moved < 2e4


def test_every_file_says_that_it_is_numerical_and_is_read_back(
    ellipse: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, message, kernel = (tmp_path / name for name in ("a.csv", "a.oem", "a.bsp"))
    words = ["ephemeris", str(ROWS), "--orbit", "2", "--kernels", str(ellipse), "--gm", *GIVEN, "--quiet"]
    words += ["--epoch", "2000-01-02T00:00:00", "--periods", "0.3", "--origin", "earth"]
    assert main([*words, "-o", str(table), "--oem", str(message), "--spk", str(kernel)]) == 0
    handle = spiceypy.spkopa(str(kernel))
    comments = " ".join(spiceypy.dafec(handle, 50, 1000)[1])
    spiceypy.spkcls(handle)
    for text in (table.read_text(), message.read_text(), comments, capsys.readouterr().out):
        assert "NUMERICAL" in text
        assert "nothing about these states is proved" in text
    assert re.search(r"CENTER_NAME += EARTH\n", message.read_text())
    rows = np.loadtxt(table, delimiter=",", skiprows=sum(line[0] in "#t" for line in table.read_text().splitlines()))
    start = 43200.0
    spiceypy.furnsh(str(kernel))
    try:
        states = np.array([spiceypy.spkgeo(-100000, start + row[0], "J2000", 399)[0] for row in rows[1:-1]])
    finally:
        spiceypy.unload(str(kernel))
    assert states == pytest.approx(rows[1:-1, 1:], rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (["--gm", *GIVEN[:2]], "--gm Sun: missing; no kernel has its GM"),
        (["--gm", *GIVEN, "Mars=3"], "--gm Mars: is none of --bodies"),
        (["--gm", "Moon=heavy"], "--gm Moon=heavy: give a name"),
        (["--epoch", "2031-01-01T00:00:00"], "--kernels: nothing about Moon and Earth at 2031-01-01"),
        (["--kernels", "nowhere.bsp"], "--kernels nowhere.bsp: cannot be read"),
        (["--kernels", str(ROWS)], "--kernels: nothing about Moon and Earth"),
        (["--bodies", "Earth"], "--bodies Earth: give the larger primary"),
        (["--bodies", "Earth", "Vulcan"], "--bodies Vulcan: SPICE knows no such body"),
        (["--origin", "Venus"], "--origin Venus: give one of Earth, Moon, Sun"),
    ],
)
def test_what_is_missing_is_one_line(
    change: list[str], said: str, circle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["ephemeris", str(ROWS), "--orbit", "2", "--kernels", str(circle), "--gm", *GIVEN, "--quiet"]
    words += ["--epoch", "2000-01-02T00:00:00", *change, "-o", str(tmp_path / "a.csv")]
    assert main(words) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert said in lines[0]
    assert spiceypy.ktotal("ALL") == 0


def test_kernels_are_unloaded_also_where_one_is_bad(circle: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.bsp"
    bad.write_bytes(b"DAF/SPK nothing")
    with pytest.raises(InputError, match="no kernel for SPICE"), kernels_loaded([circle, bad]):
        pass
    assert spiceypy.ktotal("ALL") == 0
