"""Orbits and families as values: what the command line does with them, Python does."""

from __future__ import annotations

import csv
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from oem import OrbitEphemerisMessage

from orbitproof import explore, verify
from orbitproof.figures.style import close
from orbitproof.shared import CR3BP, FALKNER_SKAN, InputError

DATA = Path(__file__).resolve().parents[1] / "data"
ROWS = Path(__file__).resolve().parents[2] / "docs" / "examples" / "gateway-rows.json"


@pytest.fixture(scope="module")
def family() -> explore.OrbitFamily:
    return explore.trace(FALKNER_SKAN, "odd", beta=(300, 400), quiet=True)


def test_orbits_are_found_by_what_they_have_and_multipliers_are_those_of_the_matrix(
    family: explore.OrbitFamily,
) -> None:
    period = 0.5 * (family[1].period + family[2].period)
    (found,) = family.by_period(period)
    assert found.period == pytest.approx(period, rel=1e-6)
    (same,) = family.by_coordinate("beta", found.parameters["beta"])
    assert same.point == pytest.approx(found.point, rel=1e-5)
    assert family.by_period(100.0) == []
    values = np.linalg.eigvals(found.state_transition())
    for multiplier in found.multipliers:
        assert np.abs(values - multiplier).min() < 1e-5
    half = found.state_transition(found.period / 2)
    step = 1e-6 * np.eye(3)[0]
    moved = explore.Orbit(FALKNER_SKAN, found.parameters, found.point + step, found.period, None, found.stability, 0.0)
    assert moved.state_transition(found.period / 2) == pytest.approx(half, abs=1e-2)


def test_a_claim_about_an_orbit_is_proved(family: explore.OrbitFamily) -> None:
    claim = family[1].claim("beta", Fraction(round(family[1].parameters["beta"])), digits=40)
    assert claim.is_of_orbit
    (proof,) = verify.certify([claim], quiet=True)
    assert proof.proved
    with pytest.raises(ValueError, match="quantity: 'mass' is unknown"):
        family[1].claim("mass", 1)


def test_a_family_is_written_with_all_its_orbits(family: explore.OrbitFamily, tmp_path: Path) -> None:
    family.to_csv(tmp_path / "family.csv")
    rows = list(csv.DictReader((tmp_path / "family.csv").read_text().splitlines()))
    assert [float(row["beta"]) for row in rows] == [orbit.parameters["beta"] for orbit in family]


def test_what_needs_units_says_how_to_give_them(family: explore.OrbitFamily, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="units: not known; give them"):
        family[0].period_days  # noqa: B018
    with pytest.raises(ValueError, match="units: 'saturn' is unknown"):
        family.with_units("saturn")
    with pytest.raises(ValueError, match=r"1e\+07 km\^3/s\^2 .* but 403503 km\^3/s\^2 for Earth-Moon"):
        explore.read_orbit(DATA / "tori-candidates.json").with_units(explore.Units(1000.0, 10.0, "a test"))
    own = explore.read_orbit(DATA / "tori-candidates.json").with_units(explore.Units(384400.0, 375200.0, "a test"))
    assert own.period_days == pytest.approx(1.36 * 375200 / 86400)
    times, places, velocities = own.astropy(5)
    assert (times.unit.to_string(), places.unit.to_string(), velocities.unit.to_string()) == ("s", "km", "km / s")
    assert places.value == pytest.approx(384400 * own.trajectory(5)[1][:, :3])
    with pytest.raises(InputError, match="--origin venus: unknown"):
        own.sample(origin="venus")


def test_an_orbit_of_a_file_is_written_as_an_ephemeris_and_has_tori_and_tubes(tmp_path: Path) -> None:
    near, far = (explore.read_orbit(ROWS, number=number) for number in (2, 1))
    assert near.period_days == pytest.approx(6.5602, abs=1e-4)
    assert near.to_oem(tmp_path / "a.oem", frame="inertial", origin="moon") < 1e-3
    (segment,) = OrbitEphemerisMessage.open(tmp_path / "a.oem").segments
    assert segment.metadata["CENTER_NAME"] == "MOON"
    assert near.to_spk(tmp_path / "a.bsp", origin="moon") < 1e-3
    near.to_csv(tmp_path / "a.csv", count=5)
    assert len((tmp_path / "a.csv").read_text().splitlines()) > 10
    assert far.manifold(("x", 0.98785), side=-1, lines=2).reached.all()
    assert len(explore.read_orbit(DATA / "tori-candidates.json").tori(curves=2).curves) == 2
    assert far.system is CR3BP


def test_pictures_say_that_they_are_numerical(family: explore.OrbitFamily) -> None:
    for figure in (family.plot(orbits=2), family[0].plot(), family.plot_stability()):
        assert "(numerical)" in figure.get_suptitle()
        close(figure)


def test_pictures_have_units_and_name_the_bodies() -> None:
    orbit = explore.read_orbit(ROWS, number=1)
    known, unknown = orbit.plot(), replace(orbit, units=None).plot()
    places = []
    for figure, unit in ((known, "1000 km"), (unknown, "distance of the primaries")):
        axes = figure.axes[0]
        assert (axes.get_xlabel(), axes.get_ylabel()) == (f"x ({unit})", f"y ({unit})")
        assert [text.get_text() for text in axes.get_legend().get_texts()] == ["smaller primary"]
        places.append(axes.get_lines()[-1].get_xdata()[0])
        close(figure)
    assert orbit.units is not None
    assert places[0] == pytest.approx(places[1] * orbit.units.length / 1000)
