"""Orbits at and beside an extremum of a stability parameter, for the verifier."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from orbitproof.explore.__main__ import main as explore
from orbitproof.explore.numerics import working_context
from orbitproof.explore.refinement import SIDES, OrbitTask, refine_turn, stability_parameters
from orbitproof.explore.refinement.half_return import half_return
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS, REGULARISATIONS

FAMILY = Path(__file__).resolve().parents[1] / "data" / "figures-halo-family.json"
NEAR_DOUBLE = OrbitTask(
    "near-double",
    CR3BP,
    {"mu": MASS_PARAMETERS["earth-moon"]},
    None,
    (1.00696895, 0.06335876, 0.54118895),
    22,
    {"stability_parameter": -1.0000674},
)
"""The near-double pair of 1:2 resonances of the L2 halo family."""


@pytest.mark.slow
def test_the_middle_one_of_three_orbits_is_at_the_extremum() -> None:
    """The quick tests prove the extremum from such orbits, near-double-orbits.json."""
    orbits = refine_turn(NEAR_DOUBLE, lambda _message, _fraction: None)
    assert [orbit.id for orbit in orbits] == [f"near-double-{side}" for side in SIDES]
    places = [orbit.equation.value for orbit in orbits if orbit.equation is not None]
    assert places[1] - places[0] == places[2] - places[1] == Fraction(1, 2**30)
    context = working_context(110)
    values = []
    for orbit in orbits:
        half = half_return(CR3BP, orbit.parameters, orbit.centre, context, REGULARISATIONS["cr3bp"])
        near, far = sorted(map(context.re, stability_parameters(half.derivative, context)), key=lambda v: abs(v + 1))
        assert abs(far) > 2
        values.append(near)
    low, middle, high = values
    assert middle < min(low, high)
    assert float(middle) == pytest.approx(-1.000067440045391, abs=1e-14)


def test_extrema_that_are_none_are_named_and_the_exit_code_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = json.loads(FAMILY.read_text())
    family = document["families"][0]
    orbit = family["orbits"][len(family["orbits"]) // 2]
    family["extrema"] = [
        {"arclength": orbit["arclength"], "first_integral": 3.1, "stability_parameter": 0.5, "k": 2, "level": -1.0}
    ]
    path = tmp_path / "families.json"
    path.write_text(json.dumps(document))
    words = ["orbit", "--from-family", str(path), "--family", "earth-moon-L1-halo", "--extrema", "--digits", "16"]
    assert explore([*words, "-o", str(tmp_path / "orbits.json"), "--jobs", "1"]) == 1
    assert "earth-moon-L1-halo-extremum-1: not refined: " in capsys.readouterr().err
    assert not (tmp_path / "orbits.json").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--extrema", "-o", "o.json"], "--extrema: needs a family file"),
        (["--extrema", "--from-family", str(FAMILY)], "--extrema: needs a family file and a file to write"),
        (["--extrema", "--from-family", str(FAMILY), "-o", "o.json", "--period", "3"], "--period: --extrema says"),
        (["--extrema", "--from-family", str(FAMILY), "-o", "o.json", "--family", "x"], "holds earth-moon-L1-halo"),
    ],
)
def test_what_does_not_go_together_is_refused(
    words: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert explore(["orbit", *words]) == 2
    assert message in capsys.readouterr().err
