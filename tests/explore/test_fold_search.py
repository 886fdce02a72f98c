"""Folds: found along families, refined to many digits, refused elsewhere."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from support.claims import EARTH_MOON

from orbitproof import explore, shared
from orbitproof.explore.__main__ import main
from orbitproof.explore.branches import NoBranch, branch_point
from orbitproof.explore.commands.branches import read_claims
from orbitproof.explore.families import Limits, folds
from orbitproof.explore.refinement import RefinementFailure, refine, resonance_slope
from orbitproof.explore.refinement.resonance import Resonance, linearise
from orbitproof.explore.three_body.families import trace_family
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import CR3BP

MICHELSON = Path(__file__).resolve().parents[2] / "docs" / "examples" / "michelson.py"
KNOWN = {item.id: item for item in read_candidates(Path(__file__).parents[1] / "data" / "known-folds.json")}
HALO = (0.871956, 0.190171, 0.237271)


def test_the_extremum_of_the_jacobi_constant_is_found_and_the_birth_of_the_family_is_none() -> None:
    family = trace_family(CR3BP, "L1-halo", EARTH_MOON, Limits(coordinate_max={"z": 0.195}))
    levels = [orbit.first_integral for orbit in family.orbits]
    (fold,) = folds(family)
    assert (fold.k, fold.kind, fold.symmetry) == (1, "fold", None)
    assert fold.orbit.first_integral == pytest.approx(2.9978432075945873, abs=1e-11)
    assert fold.orbit.first_integral == pytest.approx(min(levels), abs=1e-3)
    assert fold.orbit.first_integral < min(levels)
    # Before the minimum there is none.
    assert folds(replace(family, orbits=family.orbits[:10], tangents=family.tangents[:10])) == []


def test_a_refined_fold_is_known_to_the_digits_that_were_asked_for() -> None:
    point = refine(CR3BP, EARTH_MOON, "fold", 1, HALO, digits=40)
    assert point.residual < 1e-40
    known = KNOWN["earth-moon-L1-halo-fold-1"].centre
    assert max(abs(a - b) for a, b in zip(point.centre, known, strict=True)) < Fraction(1, 10**35)
    assert point.geometry.level_branch == pytest.approx(6.18924666357, abs=1e-10)


@pytest.mark.slow
def test_the_slope_of_the_equation_is_its_derivative() -> None:
    problem = Resonance(CR3BP, dict(EARTH_MOON), 1, True, None)
    point = [Fraction(value) for value in HALO]
    slope = resonance_slope(problem, point, linearise(problem, point, 120), 120)
    h = Fraction(1, 2**40)
    for i, value in enumerate(slope):
        ends = []
        for sign in (1, -1):
            moved = [u + sign * h * (i == j) for j, u in enumerate(point)]
            ends.append(linearise(problem, moved, 120).g)
        difference = (ends[0] - ends[1]) / (2 * mpmath.mpf(2) ** -40)
        assert float(abs(difference - value)) < 1e-15


@pytest.mark.parametrize(
    "guess", [(0.8426, 0.1639, 0.2635), (0.823391, 0.0, 0.126326)], ids=["regular point", "symmetry breaking"]
)
def test_where_the_parameter_has_no_extremum_nothing_is_refined(guess: tuple[float, ...]) -> None:
    with pytest.raises(RefinementFailure):
        refine(CR3BP, EARTH_MOON, "fold", 1, guess)


def test_no_branch_begins_at_a_fold() -> None:
    with pytest.raises(NoBranch, match="fold"):
        branch_point(KNOWN["earth-moon-L1-halo-fold-1"])


def test_folds_are_left_out_where_branches_are_followed() -> None:
    assert read_claims(Path(__file__).parents[1] / "data" / "known-folds.json") == []


def test_the_command_finds_the_fold_of_an_own_system(tmp_path: Path, capsys: Any) -> None:
    output = tmp_path / "folds.json"
    start = ["--system", str(MICHELSON), "--start", "c=0.1", "y=0.2"]
    limits = ["--parameter-min", "c", "0.05", "--parameter-max", "c", "1.3"]
    files = ["-o", str(output), "--family-output", str(tmp_path / "family.json")]
    # c has a second extremum at the period doubling at which the family comes back to its own orbits.
    assert main(["candidates", *start, *limits, "--folds", "--digits", "25", "--jobs", "1", *files]) == 0
    assert "fold-2" not in capsys.readouterr().err
    (found,) = read_candidates(output)
    assert (found.id, found.kind, found.k) == ("michelson-family-fold-1", "fold", 1)
    known = KNOWN["michelson-family-fold-1"].centre
    assert np.allclose([float(value) for value in found.centre], [float(value) for value in known], atol=1e-15)


def test_a_script_has_folds_only_if_it_asks_for_them() -> None:
    start = {"c": 1.2662323, "y": 1.359106}
    family = explore.trace_from(shared.load_system(MICHELSON), start, max_orbits=8, quiet=True)
    assert explore.resonances(family, (), quiet=True) == []
    found = explore.resonances(family, (), folds=True, quiet=True)
    assert [(item.kind, item.k) for item in found] == [("fold", 1)]
    assert explore.refine(found[0], digits=20, quiet=True).kind == "fold"


def test_a_point_near_a_fold_is_refined_by_the_command(tmp_path: Path) -> None:
    output = tmp_path / "fold.json"
    point = ["--point", "c=1.26623", "y=1.35911"]
    command = ["refine", "--system", str(MICHELSON), "-k", "1", "--kind", "fold", *point, "--digits", "20"]
    assert main([*command, "--quiet", "-o", str(output)]) == 0
    (found,) = read_candidates(output)
    assert found.id == "michelson-fold"
    assert found.frame[0] == (1, 0)


def test_a_part_without_a_fold_is_said_to_have_none(tmp_path: Path, capsys: Any) -> None:
    start = ["--system", str(MICHELSON), "--start", "c=0.1", "y=0.2", "--max-orbits", "5"]
    assert main(["candidates", *start, "--folds", "--jobs", "1", "-o", str(tmp_path / "none.json")]) == 1
    assert "no fold found" in capsys.readouterr().err
