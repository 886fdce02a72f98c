"""All families at several mass parameters: what they start from, their symmetries, their branches and their ends."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.refusals import refused

import orbitproof.explore.search.run
from orbitproof.explore.__main__ import main
from orbitproof.explore.families import (
    CONTROL,
    Family,
    FamilyFailure,
    Limits,
    TracedFamily,
    branch_seed,
    breaking_at_end,
    continue_both_ways,
    continue_family,
    detect,
    family_of,
    symmetry_breakings,
)
from orbitproof.explore.flow import flow_of
from orbitproof.explore.records import read_families
from orbitproof.explore.search import Target
from orbitproof.explore.three_body.families import trace_family
from orbitproof.explore.three_body.seeds import LIBRATION_POINTS, distance_to_primaries, libration_point, vertical_orbit
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS

EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}
MASSES = ("0.5", "0.1", "0.01215", "9.5e-4", "1e-5")


def half_way(family: Family, index: int) -> np.ndarray:
    """The state a quarter of a period after the first point of an orbit."""
    problem, orbit = family.problem, family.orbits[index]
    mass = [float(problem.parameters["mu"])]
    return flow_of(CR3BP).derivative(problem.initial_state(orbit.unknowns), 0.25 * orbit.period, mass).state


@pytest.fixture(scope="module")
def vertical() -> Family:
    return trace_family(CR3BP, "L2-vertical", EARTH_MOON, Limits())


@pytest.fixture(scope="module")
def planar() -> Family:
    return trace_family(CR3BP, "L2-lyapunov", EARTH_MOON, Limits(coordinate_max={"vy": 12.0}))


@pytest.mark.parametrize("mass", MASSES)
@pytest.mark.parametrize("point", LIBRATION_POINTS)
def test_planar_and_vertical_families_start_at_every_point_for_every_mass(point: str, mass: str) -> None:
    parameters = {"mu": Fraction(mass)}
    libration = libration_point(point, parameters["mu"])
    planar = trace_family(CR3BP, f"{point}-lyapunov", parameters, Limits(max_orbits=4))
    assert planar.problem.symmetry == "S"
    if (point, mass) == ("L1", "0.5"):
        # Equal masses: the vertical orbits of L1 are straight lines, on which y = 0 all the time.
        with pytest.raises(FamilyFailure, match="tangent to the section"):
            trace_family(CR3BP, f"{point}-vertical", parameters, Limits(max_orbits=4))
        return
    vertical = trace_family(CR3BP, f"{point}-vertical", parameters, Limits(max_orbits=4))
    for family, crossings in ((planar, 1), (vertical, 2)):
        assert len(family.orbits) == 4
        assert {orbit.crossings for orbit in family.orbits} == {crossings}
        assert all(orbit.first_integral < libration.jacobi_constant for orbit in family.orbits)  # type: ignore[operator]
    assert vertical.orbits[0].half_period == pytest.approx(np.pi / np.sqrt(libration.stiffness), rel=1e-3)
    assert vertical.orbits[-1].unknowns[1] > vertical.orbits[0].unknowns[1] > 0


@pytest.mark.slow
@pytest.mark.parametrize("mass", MASSES)
@pytest.mark.parametrize("kind", ["lyapunov", "vertical", "halo"])
def test_every_family_is_traced_to_a_limit_or_says_where_and_why_not(kind: str, mass: str) -> None:
    for point in LIBRATION_POINTS:
        if (kind, point, mass) == ("vertical", "L1", "0.5"):
            continue
        family = trace_family(CR3BP, f"{point}-{kind}", {"mu": Fraction(mass)}, Limits(max_orbits=600))
        assert len(family.orbits) > 30
        assert "Jacobi constant = " in family.reason
        near = distance_to_primaries(family.problem.samples(family.orbits[-1].unknowns), float(mass))
        ends = ("limit distance", "the family returns to Fix(S)", "600 orbits", "the family closes")
        assert family.reason.startswith(ends) or near < 1e-3


def test_linear_vertical_orbit_solves_the_equations_to_second_order() -> None:
    point = libration_point("L2", EARTH_MOON["mu"])
    defects = []
    for amplitude in (1e-2, 1e-3):
        orbit = vertical_orbit(point, amplitude * point.distance)
        end = flow_of(CR3BP).derivative(orbit.state, orbit.half_period, [point.mu]).state
        defects.append(float(np.linalg.norm(end - orbit.state * [1, 1, -1, 1, 1, 1])))
    assert defects[1] < 0.02 * defects[0]


def test_vertical_orbits_are_symmetric_under_both_reversing_symmetries(vertical: Family) -> None:
    for index in (0, 20, 60):
        orbit = vertical.orbits[index]
        assert half_way(vertical, index)[[1, 2, 3]] == pytest.approx([0, 0, 0], abs=1e-7)
        assert orbit.second_point == pytest.approx(orbit.unknowns[:3] * [1, -1, 1], abs=1e-7)


def test_vertical_family_ends_in_the_plane_at_a_symmetry_breaking(vertical: Family) -> None:
    assert vertical.reason.startswith("the family returns to Fix(S)")
    end = vertical.orbits[-1]
    assert end.unknowns[1] == 0
    assert end.crossings == 2
    inner = replace(vertical.problem, symmetry="S")
    assert abs(inner.symmetry_breaking_function(inner.with_derivative(end))) < 1e-8
    assert np.linalg.norm(half_way(vertical, -1)[[1, 3]]) < 1e-7


def test_change_of_the_number_of_crossings_is_reported_and_ends_a_family_on_request() -> None:
    limits = Limits(max_orbits=60)
    family = trace_family(CR3BP, "L1-vertical", EARTH_MOON, limits)
    assert len(family.orbits) == 60
    line, back = family.tangencies
    assert "4 to 2 crossings" in back
    assert "2 to 4 crossings" in line
    ended = trace_family(CR3BP, "L1-vertical", EARTH_MOON, limits, control=replace(CONTROL, until_tangency=True))
    assert ended.outcome == "limit"
    assert ended.reason == line
    assert [orbit.crossings for orbit in ended.orbits[-2:]] == [2, 4]


def test_every_symmetry_breaking_of_a_planar_family_has_a_branch(planar: Family) -> None:
    breakings = symmetry_breakings(planar)
    assert len(breakings) == 2
    for number, breaking in enumerate(breakings):
        for sign in (1, -1):
            branch = continue_family(branch_seed(planar.problem, breaking, sign), Limits(max_orbits=4))
            assert len(branch.orbits) == 4
            for orbit in branch.orbits[1:]:
                assert np.sign(orbit.unknowns[1]) == sign
                residual, _, _ = branch.problem.evaluate(orbit.unknowns)
                assert np.linalg.norm(residual) < 1e-7
            assert breaking_at_end(branch, breakings) is None
            there = replace(branch, orbits=(*branch.orbits, breaking.orbit))
            assert breaking_at_end(there, breakings) == number


def test_later_branches_have_names_and_a_missing_one_says_so() -> None:
    name, limits = "L1-halo-2", Limits(max_orbits=3)
    family = trace_family(CR3BP, name, {"mu": Fraction("0.5")}, limits)
    assert family.orbits[0].first_integral == pytest.approx(2.5904452, abs=1e-6)
    with pytest.raises(FamilyFailure, match=r"does not break a 2\. time on the planar family: limit distance"):
        trace_family(CR3BP, name, {"mu": Fraction("1e-5")}, replace(limits, min_distance=1e-5))


def test_branches_of_a_planar_family_are_traced_by_the_command(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "families.json"
    arguments = ["--system", "cr3bp", "--mass", "0.01215", "--family", "L1-lyapunov", "--branches", "--jobs", "1"]
    assert main(["family", *arguments, "--max-orbits", "25", "-o", str(path), "--csv", str(tmp_path / "f.csv")]) == 0
    records = read_families(path)
    assert [record.name for record in records] == ["L1-lyapunov", "L1-halo"]
    assert records[1].orbits[1].point[1] < 0
    assert {file.name for file in tmp_path.glob("*.csv")} == {f"f-0.01215-{record.name}.csv" for record in records}
    assert "L1-halo" in capsys.readouterr().err


def test_turned_family_is_the_same_family_from_the_other_end(vertical: Family) -> None:
    part = replace(vertical, orbits=vertical.orbits[:8], tangents=vertical.tangents[:8])
    turned = part.turned()
    assert turned.arclengths[0] == 0
    assert turned.beginning is not None
    assert turned.beginning.reason == part.reason
    for left, right in zip(turned.turned().orbits, part.orbits, strict=True):
        assert left.arclength == pytest.approx(right.arclength, abs=1e-15)
        assert np.array_equal(left.unknowns, right.unknowns)
    orbit = turned.orbit_at(0.5 * (turned.arclengths[2] + turned.arclengths[3]))
    assert turned.orbits[3].unknowns[1] < orbit.unknowns[1] < turned.orbits[2].unknowns[1]


def test_family_traced_both_ways_from_its_middle_has_the_ends_of_the_family(vertical: Family) -> None:
    i = len(vertical.orbits) // 2
    seed = replace(
        vertical,
        orbits=(replace(vertical.orbits[i], arclength=0.0),),
        tangents=(vertical.tangents[i],),
        outcome="limit",
        reason="started",
    )
    family = continue_both_ways(seed, Limits(coordinate_max={"z": 2.0}))
    assert family.reason.startswith("the family returns to Fix(S)")
    assert family.orbits[-1].unknowns == pytest.approx(vertical.orbits[-1].unknowns, abs=1e-8)
    assert np.all(np.diff(family.arclengths) > 0)
    assert family.beginning is not None
    # Back at the libration point the amplitude goes through zero.
    assert family.orbits[0].unknowns[0] == pytest.approx(libration_point("L2", EARTH_MOON["mu"]).x, abs=1e-2)


def test_falkner_skan_family_goes_from_near_1_to_100000_with_a_growing_period(tmp_path: Path) -> None:
    limits = Limits(max_orbits=2000, parameter_min=1.001, parameter_max=1e5)
    family = trace_family(FALKNER_SKAN, "odd", {}, limits)
    beta = np.array([orbit.unknowns[0] for orbit in family.orbits])
    assert beta[0] < 1.001 < beta[1]
    assert beta[-2] < 1e5 < beta[-1]
    assert np.all(np.diff(beta) > 0)
    periods = np.array([orbit.period for orbit in family.orbits])
    assert np.all(np.diff(periods) < 0)
    # As beta tends to 1 the period grows like (beta - 1)^(-1/2).
    products = (periods * np.sqrt(beta - 1))[beta < 1.01]
    assert np.ptp(products) < 0.02 * products[0]
    assert family.beginning is not None
    assert family.beginning.reason.startswith("limit beta = 1.001")


def test_no_resonance_is_reported_where_the_stability_is_lost_in_rounding_errors() -> None:
    family = trace_family(FALKNER_SKAN, "odd", {}, Limits(parameter_min=1.02, parameter_max=400))
    assert max(orbit.stability[0].real for orbit in family.orbits) > 1, "the sign itself is a rounding error"
    detection = detect(family, [2])
    assert [resonance.k for resonance in detection.resonances] == [2]
    assert detection.resonances[0].point[0] == pytest.approx(340.1875, abs=1e-4)
    (line,) = detection.undecided
    assert "float64 does not resolve the stability" in line


def test_end_of_the_family_that_cannot_be_passed_is_a_failure_with_its_place() -> None:
    limits = Limits(parameter_min=1.0 + 1e-9, parameter_max=110.0)
    family = trace_family(FALKNER_SKAN, "odd", {}, limits, control=replace(CONTROL, minimum=1e-3))
    assert family.failed
    assert family.beginning is not None
    assert "no orbit within the smallest step 0.001" in family.beginning.reason
    assert 1.0 < family.orbits[0].unknowns[0] < 1.001
    assert family.outcome == "limit"


def test_both_ends_of_a_family_are_in_its_file(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "family.json"
    arguments = ["--system", "falkner-skan", "--beta-min", "90", "--beta-max", "110", "-o", str(path)]
    assert main(["family", *arguments, "--jobs", "1"]) == 0
    assert "begins: limit beta = 90" in capsys.readouterr().err
    (record,) = read_families(path)
    again = family_of(record)
    assert again.beginning is not None
    assert again.beginning.reason.startswith("limit beta = 90")
    assert again.reason.startswith("limit beta = 110")
    document = json.loads(path.read_text())
    document["families"][0]["beginning"]["outcome"] = "tired"
    path.write_text(json.dumps(document))
    assert main(["family", "--from-family", str(path), "-o", str(tmp_path / "b.json")]) == 2
    assert "beginning.outcome" in capsys.readouterr().err


@pytest.mark.slow
def test_a_resonance_is_refined_with_the_crossings_of_its_orbit_and_with_no_other_number(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half orbits of this family cross once: counted twice, they are no simple resonance."""
    plain = orbitproof.explore.search.run.targets_of

    def crossing_twice(item: TracedFamily, points: str) -> list[Target]:
        return [
            replace(target, resonance=replace(target.resonance, orbit=replace(target.resonance.orbit, crossings=2)))
            for target in plain(item, points)
        ]

    monkeypatch.setattr(orbitproof.explore.search.run, "targets_of", crossing_twice)
    path = tmp_path / "candidates.json"
    arguments = ["--system", "falkner-skan", "--beta-min", "300", "--beta-max", "345", "-k", "2", "-o", str(path)]
    assert main(["candidates", *arguments, "--jobs", "1", "--quiet"]) == 1
    assert "not refined" in capsys.readouterr().err
    assert not path.exists()


def test_steps_and_tolerances_are_options(tmp_path: Path) -> None:
    base = ["family", "--system", "falkner-skan", "--beta-max", "130", "--jobs", "1", "--quiet"]
    counts = []
    for longest in ("0.01", "0.002"):
        path = tmp_path / f"{longest}.json"
        assert main([*base, "--step-max", longest, "--step-initial", "0.002", "-o", str(path)]) == 0
        (record,) = read_families(path)
        counts.append(len(record.orbits))
        assert max(np.diff([orbit.arclength for orbit in record.orbits])) < 1.01 * float(longest)
    assert counts[1] > 3 * counts[0]


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--system", "falkner-skan", "--step-min", "1"], "--step-initial"),
        (["--system", "falkner-skan", "--turning", "2"], "--turning"),
        (["--system", "falkner-skan", "--tolerance", "1e-3"], "--tolerance"),
        (["--system", "falkner-skan", "--step-max", "nan"], "--step-max"),
        (["--system", "falkner-skan", "--branches"], "--branches"),
        (["--system", "falkner-skan", "--csv", "f.csv"], "--csv"),
        (["--system", "cr3bp", "--mass", "0.1", "--family", "L1-halo-1"], "--family L1-halo-1"),
        (["--system", "cr3bp", "--mass", "0.1", "--family", "L4-vertical"], "--family L4-vertical"),
        (["--from-catalogue", "c.json", "--mass", "0.1"], "--mass"),
        (["--from-catalogue", "c.json", "--branch", "north"], "--branch"),
        (["--from-catalogue", "missing.json"], "missing.json"),
        (["--from-catalogue", "c.json", "--catalogue-orbit", "0"], "--catalogue-orbit"),
    ],
)
def test_wrong_options_are_refused_in_one_line(
    arguments: list[str], word: str, tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert word in refused(main, ["family", *arguments, "-o", "family.json", "--quiet"], capsys)
    assert list(tmp_path.iterdir()) == []
