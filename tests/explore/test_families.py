"""Families: branch switching, folds, limits, and the resonances that the paper lists."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.claims import PUBLISHED_POINTS

from orbitproof.explore.families import (
    Detection,
    Family,
    FamilyFailure,
    Limits,
    StabilityCurve,
    StepControl,
    continue_family,
    detect,
    symmetry_breakings,
)
from orbitproof.explore.families.continuation import Course, Start, trace
from orbitproof.explore.flow import flow_of
from orbitproof.explore.orbits import CorrectionFailure, ShootingProblem
from orbitproof.explore.three_body.families import trace_family
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, FALKNER_SKAN, MASS_PARAMETERS

EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}
BIRTH = (3.1743503, 3.1743536)
ROWS = [
    (4, 3.08384097317512242),
    (3, 3.05888641252983517),
    (2, 3.02161924792642019),
    (3, 2.99998691164245632),
    (3, 2.99791950160021651),
]
LATER_ROWS = [
    (3, 2.94132864491556775),
    (4, 2.94068392276693138),
    (2, -0.98650909103850289),
    (3, -0.99679533512816265),
    (4, -1.00472734964887814),
]
FALKNER_SKAN_POINTS = {k: tuple(map(float, point)) for k, point in PUBLISHED_POINTS.items()}


@pytest.fixture(scope="session")
def halo_family() -> Family:
    return trace_family(CR3BP, "L1-halo", EARTH_MOON, Limits(coordinate_max={"z": 0.195}))


@pytest.fixture(scope="session")
def halo_resonances(halo_family: Family) -> Detection:
    return detect(halo_family, [1, 2, 3, 4])


@pytest.fixture(scope="session")
def odd_family() -> Family:
    return trace_family(FALKNER_SKAN, "odd", {}, Limits(parameter_min=300.0))


def test_halo_family_is_born_where_the_paper_says(halo_resonances: Detection) -> None:
    birth = halo_resonances.resonances[0]
    assert (birth.k, birth.kind, birth.symmetry) == (1, "symmetry_breaking", "S")
    assert birth.orbit.first_integral is not None
    assert BIRTH[0] < birth.orbit.first_integral < BIRTH[1]
    assert birth.point[1] == 0.0


def test_every_row_of_the_papers_table_up_to_j_5_is_found_to_1e_8(halo_resonances: Detection) -> None:
    found = [(r.k, r.orbit.first_integral) for r in halo_resonances.resonances if r.side == "first" and r.k > 1]
    assert [k for k, _ in found] == [k for k, _ in ROWS]
    assert [c for _, c in found] == pytest.approx([c for _, c in ROWS], abs=1e-10)
    assert halo_resonances.undecided == ()
    kinds = {r.k: r.kind for r in halo_resonances.resonances}
    assert kinds == {1: "symmetry_breaking", 2: "period_tupling", 3: "touch_and_go", 4: "period_tupling"}


@pytest.mark.slow
def test_halo_loop_returns_to_the_plane_and_has_every_row_of_the_papers_table() -> None:
    family = trace_family(CR3BP, "L1-halo", EARTH_MOON, Limits())
    assert family.reason.startswith("the family returns to Fix(S)")
    assert family.orbits[-1].unknowns[1] == 0
    assert -1.01614 < (family.orbits[-1].first_integral or 0) < -1.01609
    resonances = detect(family, [1, 2, 3, 4]).resonances
    found = [(r.k, r.orbit.first_integral) for r in resonances if r.side == "first" and r.k > 1]
    assert [k for k, _ in found] == [k for k, _ in ROWS + LATER_ROWS]
    assert [c for _, c in found] == pytest.approx([c for _, c in ROWS + LATER_ROWS], abs=1e-9)
    assert [r.k for r in resonances if r.k == 1] == [1, 1]


def test_doublings_that_show_at_the_second_point_only_are_found(halo_resonances: Detection) -> None:
    second = [r for r in halo_resonances.resonances if r.side == "second"]
    assert {r.k for r in second} == {2}
    assert all(not r.other_side for r in second)
    for resonance in second:
        assert resonance.point == pytest.approx(resonance.orbit.second_point)
        assert any(s == pytest.approx(-1, abs=1e-8) for s in resonance.orbit.stability)


def test_doubling_pair_whose_stability_parameter_dips_by_less_than_a_step_is_found(
    halo_family: Family, halo_resonances: Detection
) -> None:
    coarse = replace(
        halo_family,
        orbits=halo_family.orbits[::6] + halo_family.orbits[-1:],
        tangents=halo_family.tangents[::6] + halo_family.tangents[-1:],
    )
    if coarse.orbits[-1] is coarse.orbits[-2]:
        coarse = replace(coarse, orbits=coarse.orbits[:-1], tangents=coarse.tangents[:-1])
    sampled = [min(s.real for s in orbit.stability) for orbit in coarse.orbits if 0.15 < -orbit.unknowns[1] < 0.18]
    assert sampled
    assert all(value > -1 for value in sampled)
    dense = [r.orbit.first_integral for r in halo_resonances.resonances if r.k == 2]
    assert [r.orbit.first_integral for r in detect(coarse, [2]).resonances] == pytest.approx(dense, abs=1e-9)


def test_family_passes_folds_in_velocity_jacobi_constant_and_period(halo_family: Family) -> None:
    columns = {
        "vy": [orbit.unknowns[2] for orbit in halo_family.orbits],
        "half period": [orbit.half_period for orbit in halo_family.orbits],
        "Jacobi constant": [orbit.first_integral for orbit in halo_family.orbits],
    }
    for name, column in columns.items():
        slopes = np.sign(np.diff(np.array(column, dtype=float)))
        assert {-1.0, 1.0} <= set(slopes[5:]), name
    lengths = np.diff(halo_family.arclengths)
    assert np.all(lengths > 0)
    assert np.all(lengths < 0.2)


def test_every_orbit_of_the_family_solves_the_shooting_equations(halo_family: Family) -> None:
    for orbit in halo_family.orbits[::7]:
        residual, _, _ = halo_family.problem.evaluate(orbit.unknowns)
        assert np.linalg.norm(residual) < 1e-9
    assert all(orbit.crossings == 1 for orbit in halo_family.orbits)
    assert halo_family.outcome == "limit"
    assert "limit z = 0.195" in halo_family.reason


def test_mirror_image_has_the_opposite_z_and_the_same_constants(halo_family: Family) -> None:
    mirrored = trace_family(CR3BP, "L1-halo", EARTH_MOON, Limits(max_orbits=5), branch="north")
    signs = np.array([1, -1, 1, 1])
    for left, right in zip(mirrored.orbits, halo_family.orbits, strict=False):
        assert left.unknowns == pytest.approx(signs * right.unknowns, abs=1e-10)
        assert left.first_integral == pytest.approx(right.first_integral, abs=1e-12)


def test_orbit_between_two_computed_ones_lies_on_the_family(halo_family: Family) -> None:
    left, right = halo_family.orbits[20:22]
    orbit = halo_family.orbit_at(0.5 * (left.arclength + right.arclength))
    residual, _, _ = halo_family.problem.evaluate(orbit.unknowns)
    assert np.linalg.norm(residual) < 1e-10
    assert min(left.unknowns[1], right.unknowns[1]) < orbit.unknowns[1] < max(left.unknowns[1], right.unknowns[1])
    again = halo_family.orbit_at(right.arclength)
    assert again.unknowns == pytest.approx(right.unknowns, abs=1e-10)


def test_family_is_continued_from_where_it_ended(halo_family: Family) -> None:
    part = replace(halo_family, orbits=halo_family.orbits[:30], tangents=halo_family.tangents[:30])
    more = continue_family(part, Limits(max_orbits=33))
    assert len(more.orbits) == 33
    assert more.orbits[:30] == part.orbits
    z = [orbit.unknowns[1] for orbit in more.orbits]
    assert z == sorted(z, reverse=True)
    assert continue_family(halo_family, Limits(coordinate_max={"z": 0.195})) is halo_family


def test_planar_family_breaks_its_symmetry_at_the_birth_of_the_halo_family(halo_family: Family) -> None:
    planar = trace_family(CR3BP, "L1-lyapunov", EARTH_MOON, Limits(integral_min=3.17))
    assert planar.problem.symmetry == "S"
    assert all(orbit.unknowns[1] == 0 for orbit in planar.orbits)
    (breaking,) = symmetry_breakings(planar)
    assert breaking.orbit.unknowns == pytest.approx(halo_family.orbits[0].unknowns, abs=1e-9)


@pytest.mark.parametrize("name", ["L2-halo", "L3-halo"])
def test_halo_families_of_l2_and_l3_are_born_from_their_planar_families(name: str) -> None:
    family = trace_family(CR3BP, name, EARTH_MOON, Limits(max_orbits=6))
    assert len(family.orbits) == 6
    assert family.orbits[0].unknowns[1] == 0
    assert family.orbits[-1].unknowns[1] > 0
    assert {resonance.k for resonance in symmetry_breakings(family)} == {1}
    assert (family.orbits[0].unknowns[2] > 0) == (name == "L2-halo")


def test_falkner_skan_resonances_agree_with_the_paper(odd_family: Family) -> None:
    detection = detect(odd_family, [2, 3, 4])
    assert [r.k for r in detection.resonances] == [2, 3, 4]
    for resonance in detection.resonances:
        beta, y = FALKNER_SKAN_POINTS[resonance.k]
        assert resonance.point[0] == pytest.approx(beta, abs=1e-6)
        assert resonance.point[1] == pytest.approx(y, abs=1e-10)


def test_fifth_order_resonances_are_found_for_both_rotations(odd_family: Family) -> None:
    values = [resonance.value for resonance in detect(odd_family, [5]).resonances]
    assert values == pytest.approx([np.cos(4 * np.pi / 5), np.cos(2 * np.pi / 5)])


def test_stability_that_stays_away_from_a_resonance_gives_no_report(odd_family: Family) -> None:
    end = next(i for i, orbit in enumerate(odd_family.orbits) if orbit.unknowns[0] > 400)
    part = replace(odd_family, orbits=odd_family.orbits[:end], tangents=odd_family.tangents[:end])
    detection = detect(part, [3, 4])
    assert (detection.resonances, detection.undecided) == ((), ())


def test_a_family_that_cannot_start_says_why() -> None:
    problem = ShootingProblem(FALKNER_SKAN, {})
    start = Start(np.array([100.0, 5.0, 3.0]), np.array([1.0, 0.0, 0.0]))
    with pytest.raises(CorrectionFailure):
        trace(problem, start, Course(lambda orbit, states: None))
    with pytest.raises(FamilyFailure, match=r"beta = 1\.001 is not reached: 3 orbits"):
        trace_family(FALKNER_SKAN, "odd", {}, Limits(max_orbits=3, parameter_min=1.001))


def test_a_family_whose_steps_become_too_small_ends_with_reason_and_place(odd_family: Family) -> None:
    control = StepControl(initial=1e-3, minimum=1e-3, maximum=1e-3, turning=1e-9)
    start = Start(odd_family.orbits[0].unknowns, np.array([0.0, 0.0, 1.0]))
    family = trace(odd_family.problem, start, Course(lambda orbit, states: None, control, max_orbits=5))
    assert family.outcome == "failed"
    assert "beta = " in family.reason


def test_unknown_stability_at_many_orbits_is_one_line(halo_family: Family, monkeypatch: pytest.MonkeyPatch) -> None:
    short = replace(halo_family, orbits=halo_family.orbits[:12], tangents=halo_family.tangents[:12])
    assert StabilityCurve(short).unknown == ()

    def lost(family: Family, arclength: float) -> None:
        raise CorrectionFailure(f"nothing at {arclength}")

    monkeypatch.setattr(Family, "orbit_at", lost)
    places = short.arclengths[:-1] + 0.5 * np.diff(short.arclengths)
    curve = StabilityCurve(short)
    for place in places:
        curve.coefficients(float(place))
    (line,) = curve.unknown
    assert f"unknown at {len(places)} orbits" in line
    assert f"nothing at {places[0]}" in line


CATALOGUE_MASS = {"mu": MASS_PARAMETERS["jpl-earth-moon"]}


def closes(family: Family, index: int) -> bool:
    """Whether the flow brings an orbit back after its period, to six digits times its instability."""
    orbit = family.orbits[index]
    start = family.problem.initial_state(orbit.unknowns)
    end = flow_of(family.problem.system).derivative(start, orbit.period, [float(CATALOGUE_MASS["mu"])]).state
    return bool(np.linalg.norm(end - start) < 1e-9 * (1 + max(abs(s) for s in orbit.stability)))


def test_distant_retrograde_orbits_circle_the_smaller_primary_against_its_turning() -> None:
    family = trace_family(CR3BP, "dro", CATALOGUE_MASS, Limits(max_orbits=90))
    assert family.outcome == "limit"
    mass = float(CATALOGUE_MASS["mu"])
    for index in (0, 40, 89):
        orbit = family.orbits[index]
        path = family.problem.samples(orbit.unknowns)
        x, y, vx, vy = path[:, 0] - (1 - mass), path[:, 1], path[:, 3], path[:, 4]
        assert np.all(x * vy - y * vx < 0)
        assert closes(family, index)
        assert all(abs(s) <= 1 + 1e-9 for s in orbit.stability)
    assert family.orbits[0].half_period < 0.1
    assert family.orbits[89].half_period > 1.0


def test_distant_retrograde_orbits_are_the_same_in_the_plane_by_their_other_point() -> None:
    orbit = trace_family(CR3BP, "dro", CATALOGUE_MASS, Limits(max_orbits=40)).orbits[-1]
    x, _, vy = orbit.second_point
    planar = trace_family(CR3BP_PLANAR, "dro", CATALOGUE_MASS, Limits(max_orbits=200, coordinate_max={"x": float(x)}))
    assert planar.outcome == "limit"
    places = np.array([other.unknowns[:2] for other in planar.orbits])
    assert np.all(np.diff(places[:, 0]) > 0)
    assert places[0, 0] - (1 - float(CATALOGUE_MASS["mu"])) < 0.01 * (float(CATALOGUE_MASS["mu"]) / 3) ** (1 / 3) + 1e-5
    assert np.interp(x, *places.T) == pytest.approx(vy, abs=1e-4)
    assert planar.orbits[-1].half_period == pytest.approx(orbit.half_period, rel=0.05)


def test_axial_family_joins_two_lyapunov_families_and_is_symmetric_about_the_x_axis() -> None:
    family = trace_family(CR3BP_AXIAL, "L1-axial", CATALOGUE_MASS, Limits(max_orbits=200))
    assert family.reason.startswith("the family returns to Fix(S)")
    middle = family.orbits[len(family.orbits) // 2]
    turned = np.array(CR3BP_AXIAL.reversing_symmetry)
    flow, mass = flow_of(CR3BP_AXIAL), [float(CATALOGUE_MASS["mu"])]
    start = family.problem.initial_state(middle.unknowns)
    ahead, behind = (flow.derivative(start, sign * 0.4, mass).state for sign in (1, -1))
    assert behind == pytest.approx(turned * ahead, abs=1e-9)
    assert abs(middle.unknowns[2]) > 0.1
    # No mirror image of itself under R: the highest point lies off the plane y = 0.
    mirrored = np.array(CR3BP.reversing_symmetry)
    assert np.max(np.abs(behind - mirrored * ahead)) > 0.05
    assert closes(family, len(family.orbits) // 2)
    # Born on a planar family where an eigenvalue is 1.
    assert min(abs(s - 1) for s in family.orbits[0].stability) < 1e-9


@pytest.mark.slow
def test_butterfly_branches_off_the_halo_family_with_twice_its_period() -> None:
    family = trace_family(CR3BP, "L2-butterfly", CATALOGUE_MASS, Limits(max_orbits=25))
    first = family.orbits[0]
    assert closes(family, 0)
    start = family.problem.initial_state(first.unknowns)
    flow, mass = flow_of(CR3BP), [float(CATALOGUE_MASS["mu"])]
    assert flow.derivative(start, 0.5 * first.period, mass).state == pytest.approx(start, abs=1e-8)
    for index in (10, 24):
        orbit = family.orbits[index]
        start = family.problem.initial_state(orbit.unknowns)
        assert closes(family, index)
        half = flow.derivative(start, 0.5 * orbit.period, mass).state
        assert np.linalg.norm(half - start) > 1e-3
