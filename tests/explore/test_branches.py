"""Bifurcating branches: new orbits close after k half returns, on the side that the certificates say."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import chebyshev
from support.refusals import refused

from orbitproof.explore.__main__ import main
from orbitproof.explore.branches import (
    Branch,
    BranchPoint,
    BranchRecord,
    branch_point,
    follow,
    read_branches,
    write_branches,
)
from orbitproof.explore.flow import flow_of
from orbitproof.explore.names import NoOrbit
from orbitproof.explore.orbits import MultipleShooting, SegmentedOrbit, ShootingProblem
from orbitproof.explore.records import read_families
from orbitproof.explore.refinement import refine
from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
from orbitproof.figures.certified import CertifiedCurves
from orbitproof.figures.model import read_families as read_sampled
from orbitproof.figures.pictures import draw_branch, draw_certified, draw_overview
from orbitproof.figures.pictures.branches import write as write_pictures
from orbitproof.figures.pictures.certified_boxes import write as write_certified
from orbitproof.figures.style import close, use_style
from orbitproof.shared import InputError
from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import FALKNER_SKAN
from orbitproof.verify.certificate import Certificate, certify, write_certificates

DATA = Path(__file__).parents[1] / "data"
CANDIDATES = {candidate.id: candidate for candidate in read_candidates(DATA / "figures-candidates.json")}
K1, K2, K3, K4 = (f"earth-moon-L1-halo-{name}" for name in ("k1-1", "k2-1", "k3-2", "k4-1"))
FIRST_K2, FIRST_K4 = "falkner-skan-odd-k2-1", "falkner-skan-odd-k4-1"


@pytest.fixture(scope="module")
def second_k4() -> Candidate:
    """The 1:4 resonance of the Falkner-Skan family at the other point of the orbit on Fix(R)."""
    point = refine(FALKNER_SKAN, {}, "period_tupling", 4, (679.95415507296, -1.99634181), digits=30)
    return point.to_candidate("falkner-skan-odd-k4-1-second", {})


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    """A proof of the 1:2 resonance of the Falkner-Skan family."""
    result = certify(CANDIDATES[FIRST_K2])
    assert result.proved
    return result


@pytest.fixture(scope="module")
def branches(second_k4: Candidate) -> Callable[[str], Branch]:
    """Branches by the id of their candidate, each followed once."""
    known = {**CANDIDATES, second_k4.id: second_k4}
    done: dict[str, Branch] = {}

    def branch(name: str) -> Branch:
        if name not in done:
            done[name] = follow(branch_point(known[name]), length=0.02, orbits=12)
        return done[name]

    return branch


@pytest.mark.parametrize("name", [K1, K2, K3, K4, "falkner-skan-odd-k3-1", FIRST_K4])
def test_new_orbits_are_on_fix_r_half_a_period_later_and_not_before(name: str, branches: Any) -> None:
    branch: Branch = branches(name)
    start, system = branch.start, branch.start.system
    problem = ShootingProblem(system, start.parameters)
    assert len(branch.sides) == 2
    for side in branch.sides:
        orbit = side.orbits[-1]
        assert orbit.half_period == pytest.approx(start.k * start.half_period, rel=0.05)
        unknowns = np.append(orbit.point, orbit.half_period)
        end = (
            flow_of(system)
            .derivative(problem.initial_state(unknowns), orbit.half_period, problem.parameter_values(unknowns))
            .state
        )
        odd = [i for i, sign in enumerate(system.reversing_symmetry) if sign == -1]
        # One integration over the whole half period amplifies its rounding errors by a few thousand a return.
        assert np.abs(end[odd]).max() < 1e-6
        assert end[list(system.fixed_coordinates)] == pytest.approx(
            orbit.second_point[-len(system.fixed_coordinates) :], abs=1e-6
        )
        assert orbit.crossings.shape == (start.k - 1, len(system.state))
        for state in orbit.crossings:
            assert state[system.section_index] == 0.0
            # On Fix(R) before, the orbit would have a smaller period.
            assert np.abs(state[odd]).max() > 1e-5


def test_orbits_of_both_sides_of_a_branch_file_become_trajectories_and_families(branches: Any, tmp_path: Path) -> None:
    path, made = tmp_path / "branches.json", tmp_path / "family.json"
    write_branches(path, [branches(name).record(None, None) for name in (K2, K3)])
    for number in (4, -4):
        orbit = branches(K3).sides[int(number > 0)].orbits[3]
        found = trajectory_of(find_orbit(path, Choice(K3, None, number)))
        assert found.period == pytest.approx(2 * orbit.half_period)
        assert found.stability == orbit.stability
        after = found.states([orbit.times[0], orbit.half_period, 2 * orbit.half_period])
        assert after[0] == pytest.approx(orbit.crossings[0], abs=1e-9)
        assert after[1][[0, 2, 4]] == pytest.approx(orbit.second_point, abs=1e-8)
        assert after[2] == pytest.approx(found.start, abs=1e-9)
        with pytest.raises(NoOrbit, match="R does not map"):
            replace(found, source=replace(found.source, unknowns=None)).crossings  # noqa: B018
        words = ["--id", K3, "--orbit", str(number), "--max-orbits", "3", "--quiet"]
        assert main(["family", "--from-orbit", str(path), *words, "-o", str(made)]) == 0
        (family,) = read_families(made)
        assert min(np.abs(each.point - orbit.point).max() for each in family.orbits) < 1e-4
    assert main(["trajectory", str(path), "--id", K2, "--orbit", "-99", "-o", str(tmp_path / "a.csv")]) == 2


@pytest.mark.parametrize("name", [K2, K4, FIRST_K4])
def test_for_even_k_both_sides_are_the_same_orbits(name: str, branches: Any) -> None:
    branch: Branch = branches(name)
    problem = MultipleShooting(branch.start.system, branch.start.parameters, branch.start.k)
    orbit = branch.sides[1].orbits[-1]
    row = branch.start.amplitude_form
    assert row @ (orbit.point - branch.start.point) > 0 > row @ (orbit.second_point - branch.start.point)
    # The second point is the start of the same orbit on the other side; its crossings are those of the way back.
    signs = np.array(branch.start.system.reversing_symmetry)
    back = problem.assemble(orbit.second_point, orbit.crossings[::-1] * signs, orbit.times[::-1])
    found = problem.correct(back, row)
    assert found.unknowns[: problem.point_size] == pytest.approx(orbit.second_point, abs=1e-7)
    assert problem.end(found) == pytest.approx(orbit.point, abs=1e-7)
    assert problem.times(found.unknowns).sum() == pytest.approx(orbit.half_period, abs=1e-6)


def test_new_orbits_lie_on_the_side_that_is_certified(branches: Any) -> None:
    sides = {K1: "below", K2: "below", K3: "both", K4: "below", "falkner-skan-odd-k2-1": "below", FIRST_K4: "above"}
    for name, side in sides.items():
        branch: Branch = branches(name)
        assert branch.birth is not None
        assert branch.birth.side == side
        differences = [[orbit.level_difference for orbit in part.orbits] for part in branch.sides]
        if side != "both":
            assert all((value > 0) == (side == "above") for part in differences for value in part[:2])


def test_orbits_of_the_two_points_on_opposite_sides_are_all_hyperbolic(branches: Any, second_k4: Candidate) -> None:
    """The 1:4 normal form H = nu I + (A + B cos 4 phi) I^2: see docs/formats.md, Branches."""
    pair: list[Branch] = [branches(FIRST_K4), branches(second_k4.id)]
    assert [branch.birth.side for branch in pair if branch.birth is not None] == ["above", "below"]
    assert all(branch.sides[1].orbits[1].stability[0].real > 1 for branch in pair)


def test_the_orbit_of_the_family_passed_k_times_has_the_chebyshev_polynomial_of_its_stability() -> None:
    for name in (K2, K4, FIRST_K4):
        start = branch_point(CANDIDATES[name])
        single, several = (_resonant(start, k) for k in (1, start.k))
        for s, t in zip(single, several, strict=True):
            expected = chebyshev.chebval(s, [0.0] * start.k + [1.0])
            assert abs(t - expected) < 1e-6 * max(1.0, abs(expected))


def _resonant(start: BranchPoint, k: int) -> tuple[complex, ...]:
    """Stability of the resonant orbit, its half period passed k times."""
    problem = MultipleShooting(start.system, start.parameters, k)
    first = problem.initial_state(start.point)
    second = flow_of(start.system).derivative(first, start.half_period, problem.parameter_values(start.point)).state
    states = np.array([second if i % 2 == 0 else first for i in range(k - 1)]).reshape(-1, len(first))
    unknowns = problem.assemble(start.point, states, np.full(k, start.half_period))
    return problem.stability(SegmentedOrbit(unknowns, problem.evaluate(unknowns), np.zeros_like(unknowns)))


def test_level_along_the_branch_has_the_coefficient_of_the_normal_form(certificate: Certificate, branches: Any) -> None:
    # beta of the certificates: the parameter is its value at the bifurcation plus beta p_1 (k = 3) or beta p_1^2.
    betas = {K1: -8.61643118904961, K3: -0.0005523373978898561, FIRST_K2: None}
    for name, beta in betas.items():
        branch: Branch = branches(name)
        assert branch.birth is not None
        if beta is None:
            beta = float(certificate.normal_form["beta"].mid())
        order = branch.start.order
        measured = branch.birth.slope if order == 1 else branch.birth.curvature
        per_p_1 = float(branch.start.amplitude_form @ branch.start.frame[:, 1])
        assert measured * per_p_1**order == pytest.approx(beta, rel=0.02)


def test_a_multiplicity_of_orbits_with_a_smaller_period_is_not_followed() -> None:
    wrong = replace(CANDIDATES["falkner-skan-odd-k2-1"], k=4)
    branch = follow(branch_point(wrong), length=0.02, orbits=6)
    assert branch.birth is None
    assert "smaller period" in branch.failure
    assert not branch.sides


def test_an_orbit_that_is_not_resonant_has_no_branch() -> None:
    candidate = CANDIDATES[FIRST_K4]
    beta, y = candidate.centre
    elsewhere = replace(candidate, centre=(beta - 5, y))
    assert follow(branch_point(elsewhere), length=0.02, orbits=6).birth is None


@pytest.mark.slow
def test_command_compares_with_certificates(
    certificate: Certificate, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, wrong, output = (tmp_path / name for name in ("certificates.json", "wrong.json", "branches.json"))
    write_certificates(source, [certificate])
    entry = certificate.to_json()
    entry["results"]["side"] = "above"
    write_certificates(wrong, [Certificate.from_json(entry)])
    options = ["-o", str(output), "--length", "0.01", "--orbits", "6"]
    assert main(["branches", str(source), *options]) == 0
    (branch,) = read_branches(output)
    assert (branch.verdict, branch.certified_side, branch.contradicts) == ("proved", "below", False)
    assert FIRST_K2 in capsys.readouterr().out

    assert main(["branches", str(wrong), *options]) == 1
    assert "CONTRADICTION" in capsys.readouterr().err
    assert read_branches(output)[0].contradicts

    folder = tmp_path / "out"
    pictures = write_pictures(output, [DATA / "figures-falkner-skan-family.json"], folder)
    pictures += write_certified(source, [output], folder)
    assert sorted(path.suffix for path in pictures) == [".pdf"] * 3 + [".png"] * 3
    assert all(path.stat().st_size > 5000 for path in pictures)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--only", "nothing"], "--only nothing"),
        (["--length", "-1"], "--length"),
        (["--length", "nan"], "--length"),
        (["--orbits", "1"], "--orbits"),
    ],
)
def test_bad_options_are_one_line(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = DATA / "figures-candidates.json"
    assert said in refused(main, ["branches", str(source), "-o", str(tmp_path / "out.json"), *arguments], capsys)
    assert not (tmp_path / "out.json").exists()


def test_file_that_is_neither_candidates_nor_certificates_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "other.json"
    source.write_text('{"format": "something"}')
    assert main(["branches", str(source), "-o", str(tmp_path / "out.json")]) == 2
    assert "other.json" in capsys.readouterr().err


def test_branches_survive_the_file(tmp_path: Path, branches: Any) -> None:
    path = tmp_path / "branches.json"
    records = [branches(name).record("proved", "below") for name in (K1, K2, FIRST_K4)]
    write_branches(path, records)
    for before, after in zip(records, read_branches(path), strict=True):
        assert _plain(before) == _plain(after)


def _plain(record: BranchRecord) -> list[Any]:
    orbits = [
        [*orbit.point, *orbit.second_point, *orbit.crossings.ravel(), *orbit.times, *orbit.stability]
        + [orbit.arclength, orbit.half_period, orbit.level, orbit.level_difference]
        for side in record.sides
        for orbit in side.orbits
    ]
    claim = [record.id, record.system.name, dict(record.parameters), record.kind, record.k, record.symmetry]
    outcomes = [(side.outcome, side.reason) for side in record.sides]
    return [*claim, record.verdict, record.certified_side, record.birth, outcomes, orbits]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda b: b.update(system="pendulum"), "unknown system"),
        (lambda b: b["sides"].pop(), "sides"),
        (lambda b: b["sides"][0]["orbits"][0].update(point=[1.0]), "point"),
        (lambda b: b["sides"][0]["orbits"][0]["crossings"].pop(), "crossings"),
        (lambda b: b.update(extra=1), "extra"),
    ],
)
def test_bad_branch_files_name_the_field(
    change: Callable[[dict[str, Any]], object], said: str, tmp_path: Path, branches: Any
) -> None:
    path = tmp_path / "branches.json"
    write_branches(path, [branches(FIRST_K4).record(None, None)])
    document = json.loads(path.read_text())
    change(document["branches"][0])
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=said):
        read_branches(path)


def test_certified_curves_contain_the_leading_parabola_and_the_family_is_thin(certificate: Certificate) -> None:
    curves = CertifiedCurves.of(certificate.to_json(), "certificate")
    assert curves.beta is not None
    first, second = (float(radius) for radius in curves.radii)
    # In the units of the picture the next term of the parabola is smaller than the boxes by far.
    left, right, low, high = curves.branch.T
    nearest, farthest = np.minimum(low**2, high**2), np.maximum(low**2, high**2)
    coefficient = float(curves.beta.mid()) * second**2 / first
    point = float(curves.point[:2].mean())
    assert np.all(left <= np.maximum(coefficient * nearest, coefficient * farthest) + point + 1e-3)
    assert np.all(right >= np.minimum(coefficient * nearest, coefficient * farthest) + point - 1e-3)
    assert np.ptp(curves.branch[:, :2]) < 1.0
    assert np.abs(curves.family[:, 2:]).max() < 0.1
    with use_style():
        figure = draw_certified(curves, None)
        (mark,) = [line for line in figure.axes[0].lines if line.get_gid() == f"candidate {FIRST_K2}"]
        assert mark.get_markerfacecolor() == mark.get_color()
        close(figure)


def test_nothing_certified_is_drawn_without_a_proof(certificate: Certificate) -> None:
    with pytest.raises(InputError, match="not proved"):
        CertifiedCurves.of({**certificate.to_json(), "verdict": "not proved"}, "certificate")


def test_points_with_one_coordinate_in_common_are_not_drawn_across_rounding_errors(branches: Any) -> None:
    """Both points of the new orbits at 1:2 resonance have x = 0, up to rounding: no scale of 1e-17."""
    with use_style():
        figure = draw_branch(branches(FIRST_K2).record("proved", "below"), None)
        (section,) = (axes for axes in figure.axes if "section" in axes.get_title(loc="left"))
        (left, right), (low, high) = section.get_xlim(), section.get_ylim()
        assert right - left == pytest.approx(high - low)
        close(figure)


def test_a_family_over_decades_of_its_parameter_is_drawn_over_its_logarithm(branches: Any) -> None:
    (family,) = read_sampled(DATA / "figures-falkner-skan-family.json")
    stretched = np.linspace(1.0, 1e4, len(family.levels))
    wide = replace(
        family,
        points=np.column_stack([stretched, family.points[:, 1]]),
        second_points=np.column_stack([stretched, family.second_points[:, 1]]),
    )
    with use_style():
        for drawn, scale in ((family, "linear"), (wide, "log")):
            figure = draw_overview(drawn, [branches(FIRST_K2).record("proved", "below")])
            assert {axes.get_xscale() for axes in figure.axes} == {scale}
            close(figure)
