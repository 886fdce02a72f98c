"""Tori around elliptic halo orbits and tubes of unstable ones: numerics, held against the flow itself."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from math import acos
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.three_body.invariants import (
    NoCurve,
    NoManifold,
    Plane,
    TorusFamily,
    curve,
    manifold_of,
    read_manifold,
    read_tori,
    trace_tori,
    write_manifold,
    write_tori,
)
from orbitproof.explore.three_body.invariants.curve import measured
from orbitproof.explore.three_body.invariants.torus_family import first_curve
from orbitproof.explore.three_body.trajectories import Choice, SourceOrbit, Trajectory, find_orbit, trajectory_of
from orbitproof.shared import InputError
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.systems import CR3BP

CATALOGUE = Path(__file__).parents[2] / "data" / "catalogue-halo.json"
MASS = Fraction("1.215058560962404e-2")
HALO = [1.1380985313, -0.1661640169, -0.2240501116, 1.5452867791]
"""An L2 halo orbit with an elliptic pair (stability parameter -0.434) and a hyperbolic one (57.8), to ten digits."""


@pytest.fixture(scope="module")
def halo() -> Trajectory:
    source = SourceOrbit(CR3BP, {"mu": MASS}, np.array(HALO), "a halo orbit", "not proved")
    return trajectory_of(source)


@pytest.fixture(scope="module")
def tori(halo: Trajectory) -> TorusFamily:
    return trace_tori(halo.orbit, float(MASS), most=5)


def next_return(state: np.ndarray) -> np.ndarray:
    """The next crossing of y = 0 with the same sign of vy, by another integrator."""

    def field(_: float, x: np.ndarray) -> list[float]:
        return list(CR3BP.vector_field(x.tolist(), [float(MASS)]))

    def section(_: float, x: np.ndarray) -> float:
        return float(x[1])

    section.direction = float(np.sign(state[4]))  # type: ignore[attr-defined]
    solution = solve_ivp(field, (0, 5), state, method="DOP853", rtol=1e-12, atol=1e-12, events=section)
    return np.array(solution.y_events[0][solution.t_events[0] > 0.1][0])


def test_points_of_an_invariant_curve_return_to_it_turned_by_its_rotation_number(tori: TorusFamily) -> None:
    curve = tori.curves[-1]
    angles = np.array([0.3, 2.0, 4.5])
    ahead = curve.states(angles + curve.rotation)
    for state, expected in zip(curve.states(angles), ahead, strict=True):
        assert next_return(state) == pytest.approx(expected, abs=1e-7)
    assert curve.error < 1e-8
    # The same cannot be said of another rotation number.
    off = replace(curve, rotation=curve.rotation + 0.01)
    assert measured(off) > 1e-5


def test_tori_grow_from_the_periodic_orbit_at_its_jacobi_constant(halo: Trajectory, tori: TorusFamily) -> None:
    amplitudes = [curve.amplitude for curve in tori.curves]
    assert amplitudes == sorted(amplitudes)
    assert tori.curves[0].rotation == pytest.approx(acos(tori.stability), abs=1e-4)
    assert tori.stability == pytest.approx(-0.4340894546, abs=1e-6)
    states = tori.curves[-1].states(np.linspace(0, 6, 9))
    assert CR3BP.first_integral is not None
    levels = np.asarray(CR3BP.first_integral(states.T, [float(MASS)])[0])
    assert levels == pytest.approx(np.full(9, halo.first_integral), abs=1e-12)
    assert tori.reason == "5 curves"


def test_an_orbit_without_that_elliptic_pair_has_no_torus(halo: Trajectory) -> None:
    with pytest.raises(NoCurve, match=r"pairs of multipliers: 1; stability parameters: -?0\.[0-9]+, [0-9.]+$"):
        first_curve(halo.orbit, float(MASS), 1, 1e-3)


def test_an_interrupted_family_is_written_as_far_as_it_came(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def interrupted(*_: Any) -> float:
        calls.append(0)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return 1e-12

    monkeypatch.setattr("orbitproof.explore.three_body.invariants.torus_family.measured", interrupted)
    written = tmp_path / "tori.json"
    words = ["tori", str(CATALOGUE), "--orbit", "4", "-o", str(written), "--quiet"]
    assert main(words) == INTERRUPTED
    record = read_tori(written)
    assert len(record.tori) == 2
    assert record.reason == "interrupted"


def test_tori_are_read_back_as_they_were(halo: Trajectory, tori: TorusFamily, tmp_path: Path) -> None:
    path = tmp_path / "tori.json"
    write_tori(path, halo, tori, surfaces=1)
    record = read_tori(path)
    assert len(record.tori) == 5
    assert np.array_equal(record.tori[2].curve.unknowns, tori.curves[2].unknowns)
    assert [torus.surface is None for torus in record.tori] == [True] * 4 + [False]
    surface = record.tori[-1].surface
    assert surface is not None
    ahead = tori.curves[-1].states(np.array([tori.curves[-1].rotation]))[0, :3]
    assert surface[0, -1] == pytest.approx(ahead, abs=1e-4)
    document = json.loads(path.read_text())
    assert "nothing is proved" in document["status"]
    document["tori"][0]["times"].append(1.0)
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"tori\[0\].times"):
        read_tori(path)


@pytest.mark.parametrize("kind", ["unstable", "stable"])
def test_a_tube_tends_to_the_periodic_orbit(kind: str, halo: Trajectory, tmp_path: Path) -> None:
    tube = manifold_of(halo.solution, float(MASS), kind=kind, side=-1, plane=Plane(0, 1 - float(MASS)), count=4)
    assert np.all(tube.reached)
    assert tube.ends[:, 0] == pytest.approx(np.full(4, 1 - float(MASS)), abs=1e-9)
    assert tube.drift < 1e-9
    assert abs(tube.multiplier) == pytest.approx(115.57 if kind == "unstable" else 1 / 115.57, rel=1e-3)
    # Against its direction of time the start comes closer to the periodic orbit by the multiplier each period.
    back = -1 if kind == "unstable" else 1
    state = flow_of(CR3BP).derivative(tube.starts[0], back * halo.period, [float(MASS)]).state
    assert np.linalg.norm((state - halo.start)[:3]) < 2 * tube.offset / 115
    # Places are close enough for smooth lines: with equal times they turn by 23 degrees near the Moon.
    steps = np.diff(tube.paths, axis=1)
    steps /= np.linalg.norm(steps, axis=2, keepdims=True)
    assert np.degrees(np.arccos(np.min(np.sum(steps[:, 1:] * steps[:, :-1], axis=2)))) < 14
    path = tmp_path / "tube.json"
    write_manifold(path, halo, tube)
    again = read_manifold(path).manifold
    assert np.array_equal(again.ends, tube.ends)
    assert (again.kind, again.side, again.plane) == (kind, -1, tube.plane)


def test_a_stable_orbit_has_no_tube() -> None:
    calm = trajectory_of(find_orbit(CATALOGUE.parent / "tori-candidates.json", Choice()))
    with pytest.raises(NoManifold, match="not unstable"):
        manifold_of(
            calm.solution,
            float(MASS),
            index=calm.stability_index,
            kind="unstable",
            side=1,
            plane=Plane(0, 1.0),
            count=2,
        )


@pytest.mark.parametrize("plane", ["w=3", "x=many", "x", "y=inf"])
def test_a_plane_that_is_none_is_refused(plane: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["manifold", str(tmp_path / "f.json"), "-o", str(tmp_path / "m.json"), "--plane", plane]
    assert main(words) == 2
    assert capsys.readouterr().err.startswith(f"error: --plane {plane}")


def test_a_tube_that_does_not_reach_the_plane_is_said_to(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = Path(__file__).parents[3] / "docs" / "examples" / "gateway-rows.json"
    words = ["--orbit", "1", "--plane", "x=0.5", "--lines", "2", "--longest", "0.1"]
    assert main(["manifold", str(rows), *words, "-o", str(tmp_path / "m.json")]) == 1
    said = capsys.readouterr().err
    assert "0 of them reach x = 0.5" in said
    assert "nan" not in said


@pytest.mark.parametrize("plane", ["y=0", "x=1.1"])
def test_a_plane_through_the_periodic_orbit_is_refused(
    plane: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = Path(__file__).parents[3] / "docs" / "examples" / "gateway-rows.json"
    written = tmp_path / "m.json"
    assert main(["manifold", str(rows), "--orbit", "1", "-o", str(written), "--plane", plane, "--quiet"]) == 2
    assert f"--plane {plane}: meets the periodic orbit itself" in capsys.readouterr().err
    assert not written.exists()


@pytest.mark.parametrize(("noise", "found"), [(5e-10, True), (1e-7, False)])
def test_a_curve_is_found_where_rounding_errors_end_the_gain_and_not_where_they_hide_it(
    noise: float, found: bool, tori: TorusFamily, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As near a primary, where the equations cannot be evaluated to more digits."""
    exact, generator = curve.equations, np.random.default_rng(3)

    def rough(guess: curve.InvariantCurve) -> tuple[Any, ...]:
        residual, *rest = exact(guess)
        return residual + noise * generator.uniform(-1, 1, residual.shape), *rest

    monkeypatch.setattr(curve, "equations", rough)
    last = tori.curves[-1]
    guess = last.with_unknowns(last.unknowns + 1e-4, last.times)
    normal = np.zeros(len(last.unknowns))
    normal[1] = 1.0
    if found:
        assert measured(curve.correct(guess, normal)) < 1e-8
    else:
        with pytest.raises(NoCurve, match="does not converge"):
            curve.correct(guess, normal)
