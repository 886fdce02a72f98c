"""Where R is lost: the new orbits are periodic, no images of themselves, where the theorem says, and become claims."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb
from scipy.integrate import solve_ivp
from scipy.special import mathieu_b
from support import breaking_cases as cases
from support.balls import agree
from support.picture_texts import unreadable

from orbitproof import explore
from orbitproof.explore.__main__ import main
from orbitproof.explore.branches import Branch, branch_point, follow, read_branches, task_of, write_branches
from orbitproof.explore.periodic import refine_periodic
from orbitproof.explore.points import refine_at
from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
from orbitproof.figures.orbits import loop_through
from orbitproof.figures.pictures import draw_branch
from orbitproof.figures.style import close, use_style
from orbitproof.shared import InputError
from orbitproof.shared.formats import REVERSOR_BREAKING, PeriodicOrbit, read_claims, write_candidates
from orbitproof.shared.systems import CR3BP, FixedLevel
from orbitproof.verify.certificate import certify
from orbitproof.verify.periodic import PeriodicResults
from orbitproof.verify.reversor_breaking import BreakingResults

DATA = Path(__file__).parents[1] / "data"
SIGNS = np.array(cases.MODES.reversing_symmetry, dtype=float)


@pytest.fixture(scope="module")
def branch() -> Branch:
    return follow(branch_point(cases.modes()), length=0.24, orbits=12)


def test_the_level_along_the_new_orbits_is_that_of_another_integrator(branch: Branch) -> None:
    assert branch.birth is not None
    assert branch.birth.side == "above"
    h = float(cases.level_of(odd=True))
    for orbit in branch.sides[1].orbits[2::4]:
        y = orbit.crossings[0][2]
        assert orbit.level == pytest.approx(cases.level_beside(y), abs=1e-11)
        assert orbit.level_difference == pytest.approx(orbit.level - h, abs=1e-14)
    a = branch.birth.amplitude / 2
    assert branch.birth.curvature == pytest.approx((cases.level_beside(a) - h) / a**2, rel=1e-3)


def test_new_orbits_close_and_r_exchanges_the_two_sides(branch: Branch) -> None:
    for negative, positive in zip(branch.sides[0].orbits[::3], branch.sides[1].orbits[::3], strict=True):
        assert negative.crossings[0] == pytest.approx(SIGNS * positive.crossings[0], abs=1e-10)
        assert negative.crossings[1] == pytest.approx(SIGNS * positive.crossings[1], abs=1e-10)
        assert abs(positive.crossings[0][2]) > 1e-4
        end = _flow(positive.crossings[0], float(positive.times.sum()))
        assert end == pytest.approx(positive.crossings[0], abs=1e-10)
        assert positive.arclength > 0 > negative.arclength


def test_new_orbits_become_trajectories_from_the_file_but_no_family_under_r(
    branch: Branch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "branches.json"
    write_branches(path, [branch.record("proved", "above")])
    orbit = branch.sides[0].orbits[2]
    found = trajectory_of(find_orbit(path, Choice(number=-3)))
    assert found.period == pytest.approx(float(orbit.times.sum()))
    assert found.states([found.period, orbit.times[0]]) == pytest.approx(orbit.crossings[:2], abs=1e-9)
    assert main(["family", "--from-orbit", str(path), "-o", str(tmp_path / "family.json")]) == 2
    assert "explore periodic follows such orbits" in capsys.readouterr().err


def test_stability_is_that_of_the_monodromy_matrix(branch: Branch) -> None:
    orbit = branch.sides[1].orbits[-1]
    start, period, step = orbit.crossings[0], float(orbit.times.sum()), 1e-5
    columns = [_flow(start + step * e, period) - _flow(start - step * e, period) for e in np.eye(4)]
    # Two multipliers are 1, the others inverse to each other.
    trace = float(np.trace(np.array(columns).T / (2 * step)))
    assert orbit.stability[0].real == pytest.approx((trace - 2) / 2, abs=1e-6)
    assert orbit.stability[0].imag == 0


def _flow(state: Any, time: float) -> Any:
    field = cases.MODES.vector_field
    rates = lambda _t, s: field(s.tolist(), [float(cases.A)])  # noqa: E731
    return solve_ivp(rates, (0.0, time), state, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]


def test_a_point_at_which_r_is_not_lost_has_no_such_branch() -> None:
    h, x = cases.modes().centre
    elsewhere = replace(cases.modes(), centre=(h + Fraction(1, 2), x))
    found = follow(branch_point(elsewhere), length=0.1, orbits=6)
    assert found.birth is None
    assert not found.sides


def test_they_survive_the_file_and_a_file_with_half_an_orbit_is_refused(branch: Branch, tmp_path: Path) -> None:
    path = tmp_path / "branches.json"
    write_branches(path, [branch.record("proved", "above")])
    (read,) = read_branches(path)
    assert read.loses_reversor
    for before, after in zip(branch.sides[1].orbits, read.sides[1].orbits, strict=True):
        assert np.array_equal(before.crossings, after.crossings)
        assert np.array_equal(before.times, after.times)
    document = json.loads(path.read_text())
    for name in ("crossings", "times"):
        document["branches"][0]["sides"][0]["orbits"][0][name].pop()
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="even number"):
        read_branches(path)


def test_a_new_orbit_is_proved_and_r_does_not_map_it_to_itself(branch: Branch) -> None:
    task = task_of(branch.record(None, None), -6, digits=25)
    proof = certify(refine_periodic(task))
    assert proof.proved, proof.reason
    found = proof.results
    assert isinstance(found, PeriodicResults)
    assert task.crossings == 1
    # One crossing in this direction: were the orbit its own image, this point would be in Fix(R).
    assert not found.point["vx"].contains(0)
    assert not certify(replace(refine_periodic(task), level=task.level + 1)).proved  # type: ignore[operator]


def test_with_a_parameter_on_a_level_the_parameter_follows_the_normal_form() -> None:
    h = Fraction(1, 5)
    system = replace(cases.MODES, name="modes-level", family_parameter="a", fixed_level=FixedLevel(h, 1))
    a = float(mathieu_b(1, float(h) / 4)) - float(h) / 2
    claim = refine_at(system, {"a": a, "x": 0.0}, 1, kind=REVERSOR_BREAKING, digits=30, quiet=True)
    proof = certify(claim)
    assert isinstance(proof.results, BreakingResults)
    branch = follow(branch_point(claim), length=0.1, orbits=5)
    assert branch.birth is not None
    assert branch.birth.side == proof.results.side
    assert branch.birth.curvature == pytest.approx(float(proof.results.opening.mid()), rel=1e-4)
    last = branch.sides[1].orbits[-1]
    for state in last.crossings:
        assert cases.MODES.first_integral is not None
        assert cases.MODES.first_integral(state, [last.level])[0] == pytest.approx(float(h), abs=1e-11)
    # It comes to the section with vy of either sign.
    assert last.crossings[0][3] > 0 > last.crossings[1][3]
    assert task_of(branch.record(None, None), 5).level == h


def test_python_does_what_the_commands_do(branch: Branch) -> None:
    record = explore.follow_branch(cases.modes(), length=0.24, orbits=12, side="below", quiet=True)
    assert record.contradicts
    assert [len(side.orbits) for side in record.sides] == [len(side.orbits) for side in branch.sides]
    claim = explore.refine_new_orbit(record, 5, digits=20, quiet=True)
    assert claim.id == "modes-orbit5"
    assert claim == replace(
        refine_periodic(task_of(branch.record(None, None), 5, digits=20)), provenance=claim.provenance
    )
    with pytest.raises(ValueError, match="length"):
        explore.follow_branch(cases.modes(), length=-1, quiet=True)


def test_there_are_claims_of_such_orbits_only(branch: Branch) -> None:
    record = branch.record(None, None)
    for number in (0, 13, -13):
        with pytest.raises(ValueError, match=f"no orbit {number}"):
            task_of(record, number)
    with pytest.raises(ValueError, match="symmetric"):
        task_of(replace(record, kind="period_tupling"), 1)


def test_the_picture_has_both_new_orbits_beside_the_family(branch: Branch) -> None:
    record = branch.record("proved", "above")
    orbit = branch.sides[1].orbits[-1]
    loop = loop_through(record.system, record.parameters, list(orbit.point), orbit.crossings)
    assert loop[0] == pytest.approx(loop[-1])
    assert np.ptp(loop[:, 1]) > 0.5
    with use_style():
        figure = draw_branch(record, None)
        assert unreadable(figure) == []
        diagram, beside, *_ = figure.axes
        levels = np.concatenate([np.asarray(line.get_ydata()) for line in diagram.lines])
        assert np.nanmin(levels) == 0
        assert np.nanmax(levels) == pytest.approx(orbit.level_difference)
        (dots,) = [line for line in beside.lines if line.get_marker() == "."]
        assert sorted(dots.get_ydata()) == pytest.approx(sorted([orbit.crossings[0][2], -orbit.crossings[0][2]]))
        close(figure)


def test_commands_from_the_claim_to_claims_about_new_orbits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, branches, orbits = (tmp_path / name for name in ("claims.json", "branches.json", "orbits.json"))
    write_candidates(source, [cases.modes()])
    assert main(["branches", str(source), "-o", str(branches), "--length", "0.1", "--orbits", "6"]) == 0
    take = ["periodic", "--from-branches", str(branches), "--digits", "20", "-o", str(orbits)]
    assert main([*take, "--orbits", "-4", "5"]) == 0
    found = json.loads(orbits.read_text())["candidates"]
    assert [each["id"] for each in found] == ["modes-orbit-4", "modes-orbit5"]
    assert all(each["kind"] == "periodic" for each in found)
    capsys.readouterr()
    for arguments, said in (
        ([*take, "--orbits", "99"], "--orbits: there is no orbit 99"),
        ([*take, "--system", "cr3bp"], "--system"),
        ([*take, "--only", "nothing"], "--only nothing"),
        (take[:-2], "-o: missing"),
        (["periodic", "--start", "x=1", "--orbits", "1"], "--orbits: belongs to --from-branches"),
        (["periodic", "--start", "x=1"], "--system: missing"),
    ):
        assert main(arguments) == 2
        message = capsys.readouterr().err
        assert said in message
        assert message.count("\n") == 1


@pytest.mark.slow
def test_the_halo_orbits_of_l1_lose_r_where_the_theorem_says(tmp_path: Path) -> None:
    found = follow(branch_point(cases.halo()), length=0.2, orbits=20)
    assert found.birth is not None
    assert found.birth.side == "below"
    assert found.birth.curvature == pytest.approx(-0.0070036, rel=1e-3)
    with use_style():
        figure = draw_branch(found.record("proved", "below"), None)
        assert unreadable(figure) == []
        close(figure)


CLAIMED = {claim.id: claim for claim in read_claims(DATA / "orbits-without-reversor.json")}
BIRTHS = {"earth-moon-L1-loss-orbit28": "2.947009569188494", "sun-jupiter-L1-loss-orbit70": "2.995335576627487"}


@pytest.mark.slow
@pytest.mark.parametrize("name", CLAIMED)
def test_orbits_born_on_the_halo_loops_are_proved_below_the_births_and_are_no_images_of_themselves(name: str) -> None:
    claim = CLAIMED[name]
    assert isinstance(claim, PeriodicOrbit)
    proof = certify(claim)
    assert proof.proved, proof.reason
    found = proof.results
    assert isinstance(found, PeriodicResults)
    assert claim.crossings == 1
    assert claim.level is not None
    assert claim.level < Fraction(BIRTHS[name])
    for coordinate in ("vx", "vz"):
        assert not found.point[coordinate].contains(0)
    assert not certify(replace(claim, level=claim.level + Fraction(1, 10**12))).proved


@pytest.mark.slow
def test_planar_orbits_lose_r_where_the_axial_ones_are_born() -> None:
    point = {"x": 0.781573938, "z": 0.0, "vy": 0.443197786}
    claim = refine_at(CR3BP, point, 1, parameters={"mu": "earth-moon"}, kind=REVERSOR_BREAKING, digits=30, quiet=True)
    proof = certify(claim)
    assert proof.proved, proof.reason
    assert isinstance(proof.results, BreakingResults)
    # The value of the table of births of axial families.
    assert agree(proof.results.parameter, arb("3.02139212923076323216679724 +/- 1e-26"))
    branch = follow(branch_point(claim), length=0.1, orbits=8)
    assert branch.birth is not None
    assert branch.birth.side == proof.results.side == "below"
    # The new orbits are images of themselves under S R, the half turn about the x axis.
    _, y, z, vx, _, vz = branch.sides[1].orbits[-1].crossings[0]
    assert [y, z, vx] == pytest.approx([0, 0, 0], abs=1e-9)
    assert abs(vz) > 1e-2
