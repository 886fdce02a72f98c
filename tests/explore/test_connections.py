"""Homoclinic orbits are found, and claimed so that they are proved."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path

import pytest
from support import homoclinic_cases as cases

from orbitproof.explore import connections
from orbitproof.explore.__main__ import main
from orbitproof.explore.connections import (
    ConnectionFailure,
    Homoclinic,
    Hyperbolic,
    OnLevel,
    homoclinic_claim,
    homoclinic_curve_claim,
    homoclinic_orbits,
    hyperbolic_orbit,
)
from orbitproof.shared.claims import HeteroclinicOrbit, HomoclinicOrbit
from orbitproof.shared.formats import define_system, read_claims
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.certificate import Limits, certify

DESCRIBED = {**cases.DESCRIBED, "R": {"y": -1, "u": -1}, "section": "y", "level_coordinate": "v"}


@pytest.fixture(scope="module")
def orbit() -> Hyperbolic:
    system = define_system(DESCRIBED)
    assert isinstance(system, ReversibleSystem)
    return hyperbolic_orbit(OnLevel(system, {"w": Q(4), "e": Q(1, 4)}, Q(1, 2), 1), Q(101, 100), 1, 20)


def test_the_periodic_orbit_and_its_unstable_direction_are_found(orbit: Hyperbolic) -> None:
    assert abs(orbit.p - 1) < Q(1, 10**20)
    assert abs(float(orbit.multiplier) / cases.MULTIPLIER - 1) < 1e-12
    assert abs(orbit.slope - cases.wells().slope) < Q(1, 10**15)


def test_a_homoclinic_orbit_is_refined_and_claimed(orbit: Hyperbolic) -> None:
    found = Homoclinic(orbit, cases.wells().centre[1] * Q(10001, 10000), 6)
    claim = homoclinic_claim(found, "wells", 1e-3, 20)
    assert claim.arrival == 6
    assert abs(claim.centre[1] / cases.wells().centre[1] - 1) < Q(1, 10**9)


def test_what_is_not_there_is_told_in_a_line(orbit: Hyperbolic) -> None:
    setting = orbit.setting
    with pytest.raises(ConnectionFailure, match="no point of the level"):
        hyperbolic_orbit(OnLevel(setting.system, setting.parameters, Q(-10), 1), Q(1), 1, 20)


def test_a_stopped_command_keeps_its_claims_and_goes_on_with_the_others(
    orbit: Hyperbolic, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    a = cases.wells().centre[1]
    refined: list[str] = []
    # The first from one return later than its claim.
    found = [Homoclinic(orbit, a * orbit.multiplier, 4), Homoclinic(orbit, -a, 6)]

    def claim(each: Homoclinic, name: str, *_: object) -> HomoclinicOrbit:
        refined.append(name)
        if refined == ["two-1", "two-2"]:
            raise KeyboardInterrupt
        claimed = -a if each is found[1] else a
        return replace(cases.wells(), id=name, centre=(Q(1), claimed), system=orbit.setting.system)

    monkeypatch.setattr(connections, "hyperbolic_orbit", lambda *_: orbit)
    monkeypatch.setattr(connections, "homoclinic_orbits", lambda *_: found)
    monkeypatch.setattr(connections, "homoclinic_claim", claim)
    system, claims = tmp_path / "wells.json", tmp_path / "claims.json"
    system.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **DESCRIBED}))
    words = f"connections --system {system} --parameter w=4 e=1/4 --level 1/2 --start x=1.01 --side 1 --id two --quiet"
    command = [*words.split(), "--append", "-o", str(claims)]
    assert main(command) == INTERRUPTED
    assert "interrupted; the same command with --append goes on" in capsys.readouterr().err
    assert [each.id for each in read_claims(claims)] == ["two-1"]
    assert main(command) == 0
    assert [each.id for each in read_claims(claims)] == ["two-1", "two-2"]
    assert refined == ["two-1", "two-2", "two-2"]
    # Another orbit in place of one that is claimed is no reason to leave it out.
    found.reverse()
    assert main(command) == 2
    assert "two-1: is in" in capsys.readouterr().err


def test_what_cannot_be_asked_of_many_levels_is_told_in_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    words = "connections --system cr3bp-planar --parameter mu=0.001 --start x=0.92 --level 3 --level-radius"
    for more, what in (("0", "not positive"), ("1/100 --to x=1.08", "not with --to")):
        assert main([*words.split(), *more.split()]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert f"--level-radius: {what}" in line


@pytest.mark.slow
def test_a_homoclinic_orbit_is_claimed_for_all_levels_near_its_own(
    orbit: Hyperbolic, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The polynomials are right at a level that is none of those through which they were laid.

    Those that are given are rounded to 5e-12 in each coefficient of a.
    """
    found, given = Homoclinic(orbit, cases.wells().centre[1], 6), cases.wells_on_levels()
    claim = homoclinic_curve_claim(found, "wells", 1e-3, 20, given.level_radius)
    assert claim.middle.centre[0] == 1
    for own, other, error in zip(claim.polynomials[1:], given.polynomials[1:], (2e-11, 1e-6), strict=True):
        at_end = [float(sum(row, Q(0))) for row in (own, other)]
        assert abs(at_end[0] - at_end[1]) < error
    monkeypatch.setattr("orbitproof.explore.connections.levels._LEVELS", 3)
    with pytest.raises(ConnectionFailure, match="a smaller --level-radius"):
        homoclinic_curve_claim(found, "wells", 1e-3, 20, Q(1, 3))


@pytest.mark.slow
def test_orbits_of_a_branch_are_found_by_their_crossings(orbit: Hyperbolic) -> None:
    (first,) = homoclinic_orbits(orbit, 1)
    assert first.crossings == 7
    (found,) = homoclinic_orbits(orbit, 1, (8,))
    closer = homoclinic_claim(found, "wells", 1e-7, 20)
    assert closer.arrival == 12
    assert abs(closer.centre[1]) < Q(1, 10**7)
    assert abs(float(found.distance / orbit.multiplier) / 7.62208881e-07 - 1) < 1e-4
    # x - 1 changes its sign with u: the other branch is its mirror image.
    (other,) = homoclinic_orbits(orbit, -1, (8,))
    assert abs(found.distance + other.distance) < Q(1, 10**10)


@pytest.mark.slow
def test_what_the_command_finds_is_proved(tmp_path: Path) -> None:
    system, claims = tmp_path / "wells.json", tmp_path / "claims.json"
    system.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **DESCRIBED}))
    words = f"connections --system {system} --parameter w=4 e=1/4 --level 1/2 --start x=1.01 --side 1"
    assert main([*words.split(), "-o", str(claims), "--quiet"]) == 0
    (claim,) = read_claims(claims)
    found = certify(claim, Limits(digits=10))
    assert found.proved, found.reason


@pytest.mark.slow
def test_orbits_from_one_periodic_orbit_to_another_one_are_found_and_proved(tmp_path: Path) -> None:
    described = {
        **cases.HILLS_DESCRIBED, "R": {"y": -1, "u": -1}, "section": "y", "level_coordinate": "v",
    }  # fmt: skip
    system, claims = tmp_path / "hills.json", tmp_path / "claims.json"
    system.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **described}))
    words = (
        f"connections --system {system} --parameter w=4 e=1/8 d=-1/128 --level 1/2 --start x=-1.01 --side 1 "
        "--to x=1.01 --to-side -1 --near 5e-6 --quiet"
    )
    assert main([*words.split(), "-o", str(claims)]) == 0
    claim = read_claims(claims)[0]
    assert isinstance(claim, HeteroclinicOrbit)
    assert float(claim.centre[0]) == -float(claim.centre[2]) == pytest.approx(-1)
    found = certify(claim, Limits(digits=10))
    assert found.proved, found.reason
    # The same command with --append has nothing left to do.
    before = claims.read_bytes()
    assert main([*words.split(), "--append", "-o", str(claims)]) == 0
    assert claims.read_bytes() == before
    # On the other side nothing leads there within so few crossings.
    assert main([*words.replace("--side 1 --to x", "--side -1 --to x").split(), "--arrivals", "3"]) == 1
