"""Births of axial orbits over ranges of the mass: the surfaces of section 17 with the half turn for R."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import arb, ctx
from support.balls import agree
from support.stored import entry_of, values

from orbitproof.explore.__main__ import main
from orbitproof.explore.three_body.masses import AXIAL, chart_of, correct_at
from orbitproof.shared.claims import Candidate, evaluate
from orbitproof.shared.formats import read_atlas, read_candidates
from orbitproof.shared.systems import HILL, HILL_AXIAL
from orbitproof.verify.evidence import Proved, enclose, is_inside
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.surface import SurfaceLimits, conclude_surface, prove_surface_piece
from orbitproof.verify.surface.gluing import read_sheet
from orbitproof.verify.words.surface import surface_in_words

DATA = Path(__file__).parents[1] / "data"
WHOLE = (Fraction(-1), Fraction(1))


@pytest.fixture(scope="module")
def births() -> dict[str, Candidate]:
    """Births of axial orbits at single masses, as they were certified in the CR3BP."""
    return {each.id: each for each in read_candidates(DATA / "axial-births.json")}


@pytest.mark.parametrize("point", ["L1", "L2"])
def test_the_curve_passes_through_certified_births(births: dict[str, Candidate], point: str) -> None:
    known = births[f"earth-moon-{point}-axial-k1-1"]
    x, vy = (float(known.centre[i]) for i in (0, 1))
    mu = float(known.parameters["mu"])
    chart = chart_of(point, AXIAL)
    found = correct_at(chart, chart.unknowns(x + 1e-4, vy, {"L1": 1.97, "L2": 2.15}[point], mu))
    assert (found.x, found.vy) == pytest.approx((x, vy), abs=1e-11)


def test_axial_orbits_are_born_for_all_masses_of_a_piece(births: dict[str, Candidate]) -> None:
    """Around the mass of the Earth and the Moon; the certified birth of that mass is the surface's."""
    atlas = read_atlas(DATA / "surface-axial.json")
    (piece,) = atlas.surface_pieces()
    assert atlas.system is HILL_AXIAL
    proved = prove_surface_piece(HILL_AXIAL, piece, WHOLE, ORACLE, SurfaceLimits(60, 22, 2, 4))
    results = values([entry_of(proved)])
    conclusion = conclude_surface(atlas, results)
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    known = births["earth-moon-L1-axial-k1-1"]
    mu = known.parameters["mu"]
    sheet = read_sheet(piece, "h", results)
    with ctx.workprec(160):
        low, high = WHOLE
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if evaluate(piece.parameters["h"], middle) ** 3 <= mu else (low, middle)
        xi, veta, vzeta = sheet.point(low, high)
        h = enclose(mu).root(3)
        x, vy, _ = known.centre
        assert is_inside(vzeta, Fraction(1, 10**30))
        assert agree(1 - enclose(mu) + h * xi, enclose(x) + arb(0, 1e-25))
        assert agree(h * veta, enclose(vy) + arb(0, 1e-25))
        assert max(xi.rad(), veta.rad()) < 1e-6
    text = surface_in_words(conclusion.outcome.theorem, conclusion.outcome.results)
    assert "reversible under the half turn about the xi axis, and the map P" in text
    assert "(x, vy, vz) = (1 - mu + h xi, h veta, h vzeta)" in text
    assert "axial orbits up to the identification of the family with that of Lyapunov, for |vz| <= 0.001" in text


def test_the_other_reversor_has_other_births() -> None:
    """The same piece of the system whose R is the reflection: its centre is not one of Fix(R) and Fix(S)."""
    (piece,) = read_atlas(DATA / "surface-axial.json").surface_pieces()
    outcome = prove_surface_piece(HILL, piece, WHOLE, ORACLE, SurfaceLimits(52, 16, 1, 3)).outcome
    assert not isinstance(outcome, Proved)
    assert "negates zeta" in outcome.reason.message
    moved = replace(piece, centre=(piece.centre[0], (piece.centre[1][0] * Fraction(1001, 1000),), piece.centre[2]))
    outcome = prove_surface_piece(
        HILL_AXIAL, moved, (Fraction(0), Fraction(1)), ORACLE, SurfaceLimits(52, 20, 1, 3)
    ).outcome
    assert not isinstance(outcome, Proved)


@pytest.mark.parametrize("arguments", [["--point", "L3"], ["--point", "L1", "--lyapunov"]])
def test_what_there_is_not_of_axial_orbits_is_one_line(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["atlas-mass", *arguments, "--family", "axial", "-o", str(tmp_path / "x.json")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.slow
@pytest.mark.parametrize("point", ["L1", "L2"])
def test_the_theorem_on_births_of_axial_orbits_for_all_masses(point: str, tmp_path: Path) -> None:
    """For all mass parameters up to 1/2; some minutes: orbitproof explore atlas-mass --point L1 --family axial."""
    path = tmp_path / "mass.json"
    assert main(["atlas-mass", "--point", point, "--family", "axial", "--quiet", "-o", str(path)]) == 0
    atlas = read_atlas(path)
    results = [entry_of(prove_surface_piece(HILL_AXIAL, piece, WHOLE, ORACLE)) for piece in atlas.surface_pieces()]
    conclusion = conclude_surface(atlas, values(results))
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    text = surface_in_words(conclusion.outcome.theorem, conclusion.outcome.results)
    assert "for all mu in (0, 0.500188017]" in text
