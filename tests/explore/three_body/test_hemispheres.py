"""Northern and southern orbits: one default for all families, and every table, caption and file says the side."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orbitproof import explore
from orbitproof.explore.__main__ import main
from orbitproof.explore.families import Family, Limits
from orbitproof.explore.records import read_families
from orbitproof.explore.three_body.catalogues import catalogue_of, read_catalogue
from orbitproof.explore.three_body.families import branch_at, branch_of, mirrored, on_side, trace_family
from orbitproof.explore.three_body.names import FAMILY_NAMES, Branch, family_name, has_branches, name_on
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
from orbitproof.figures.model import read_families as read_sampled
from orbitproof.figures.pictures.halo_plane import family_title
from orbitproof.figures.tables import build_tables, read_rows
from orbitproof.shared.formats import read_atlas, read_candidates
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

DATA = Path(__file__).resolve().parents[2] / "data"
MASS = {"mu": MASS_PARAMETERS["jpl-earth-moon"]}


def height_far_away(family: Family, index: int) -> float:
    """z of an orbit where it is farthest from the smaller primary, over all of it."""
    orbit, mass = family.orbits[index], float(MASS["mu"])
    states = family.problem.samples(orbit.unknowns)
    _, smaller = primaries(mass)
    return float(states[int(np.argmax(np.linalg.norm(states[:, :3] - smaller, axis=1))), 2])


@pytest.mark.parametrize("name", ["L1-halo", "L2-halo", "L3-halo", "L2-butterfly", "L2-dragonfly"])
def test_every_family_is_southern_unless_the_northern_one_is_asked_for(name: str) -> None:
    limits = Limits(max_orbits=12)
    found = trace_family(CR3BP, name, MASS, limits)
    assert branch_of(found) == "south"
    assert all(height_far_away(found, index) < 0 for index in range(2, 12))
    northern = trace_family(CR3BP, name, MASS, limits, branch="north")
    assert branch_of(northern) == "north"
    assert all(height_far_away(northern, index) > 0 for index in range(2, 12))
    for left, right in zip(found.orbits, northern.orbits, strict=True):
        assert left.unknowns == pytest.approx(right.unknowns * [1, -1, 1, 1], abs=1e-9)
        assert left.second_point == pytest.approx(right.second_point * [1, -1, 1], abs=1e-9)


def test_a_mirror_image_is_a_family_with_its_derivatives() -> None:
    family = trace_family(CR3BP, "L2-halo", MASS, Limits(max_orbits=5))
    image = mirrored(family)
    assert branch_of(image) == "north"
    for index in range(1, 5):
        orbit = image.orbits[index]
        residual, jacobian, _ = image.problem.evaluate(orbit.unknowns)
        assert np.abs(residual).max() < 1e-9
        assert np.abs(jacobian @ (image.tangents[index] * image.problem.scales)).max() < 1e-4
        assert orbit.derivative is not None
        again = image.problem.with_derivative(type(orbit)(**{**vars(orbit), "derivative": None})).derivative
        assert again is not None
        assert orbit.derivative.derivative == pytest.approx(again.derivative, rel=1e-5, abs=1e-5)
    assert on_side(image, "north") is image
    assert branch_of(on_side(image, "south")) == "south"


@pytest.mark.parametrize("name", ["L1-lyapunov", "L1-vertical", "dro"])
def test_families_that_are_their_own_mirror_images_have_no_side(name: str) -> None:
    family = trace_family(CR3BP, name, MASS, Limits(max_orbits=4))
    assert branch_of(family) is None
    assert catalogue_of(family, name, "jpl-earth-moon").branch == ""


def test_the_side_is_that_of_the_point_farther_from_the_smaller_primary() -> None:
    far, near, image = [1.02, 0.0, -0.18], [0.99, 0.0, 0.01], [1.02, 0.0, 0.18]
    assert branch_at([far, near], 0.01) == branch_at([near, far], 0.01) == "south"
    assert branch_at([near, far, near], 0.01) == "south"
    assert branch_at([image, near], 0.01) == "north"
    assert branch_at([image, near, far], 0.01) is None
    assert branch_at([[1.02, 0.0, 0.0], [1.2, 0.0, 0.0]], 0.01) is None


def test_names_tell_the_two_apart() -> None:
    for name in (name for names in FAMILY_NAMES.values() for name in names):
        sides: tuple[Branch, Branch] = ("north", "south")
        names = {name_on(name, side) for side in sides}
        assert len(names) == (2 if has_branches(name) else 1)
        assert name_on(name, "south") == name
    assert has_branches(family_name("nrho"))
    assert has_branches("L1-halo-2")


@pytest.mark.parametrize(("words", "side"), [([], "south"), (["--branch", "north"], "north")])
def test_tables_and_files_of_the_search_say_the_side(
    words: list[str],
    side: Branch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    output, family, table = (tmp_path / name for name in ("c.json", "f.json", "rows.json"))
    arguments = ["candidates", "--system", "cr3bp", "--mass", "jpl-earth-moon", "--family", "nrho", "--vy-max", "0.6"]
    arguments += ["-k", "3", "--digits", "15", "--jobs", "1", *words]
    assert main([*arguments, "-o", str(output), "--family-output", str(family)]) == 0
    shown = capsys.readouterr()
    header, row = shown.out.splitlines()
    assert row[header.index("branch") :].startswith(f"{side} ")
    assert f"{side}ern orbits, ends" in shown.err
    (candidate,) = read_candidates(output)
    assert candidate.provenance["branch"] == side
    assert candidate.id == f"jpl-earth-moon-{name_on('L2-halo', side)}-k3-1"
    (record,) = read_families(family)
    assert (record.branch, record.name) == (side, name_on("L2-halo", side))
    (sampled,) = read_sampled(family)
    assert family_title(sampled) == f"{side}ern $L_2$ halo orbits"
    assert sampled.title == f"{side}ern jpl-earth-moon-L2-halo"
    orbit = trajectory_of(find_orbit(family, Choice(number=5)))
    assert orbit.source.title.endswith(f", {side}ern")
    words = ["--family", "L2-halo", "--mass", "jpl-earth-moon", "--rows", "5", "--max-orbits", "10", *words]
    assert main(["catalogue", *words, "-o", str(table), "--jobs", "1"]) == 0
    assert f"5 {side}ern rows written" in capsys.readouterr().err
    assert read_catalogue(table).branch == side[0].upper()


def test_an_orbit_by_its_period_is_the_one_of_the_side_that_was_asked_for(tmp_path: Path) -> None:
    """The 4:1 orbit of the Gateway's page: a southern one has its apolune below the plane."""
    found = {}
    for side in ("south", "north"):
        output = tmp_path / f"{side}.json"
        words = ["orbit", "--family", "L2-halo", "--mass", "jpl-earth-moon", "--period", "synodic_month/4"]
        assert main([*words, "--branch", side, "--digits", "15", "-o", str(output)]) == 0
        (candidate,) = read_candidates(output)
        found[side] = explore.read_orbit(output)
        assert candidate.id == f"jpl-earth-moon-{name_on('L2-halo', side)}"  # type: ignore[arg-type]
    for side, sign in (("south", -1), ("north", 1)):
        heights = found[side].states(np.linspace(0, found[side].period, 801))[:, 2]
        assert max(heights, key=abs) * sign == pytest.approx(0.1903, abs=2e-4)


def test_families_of_python_say_their_side() -> None:
    options: dict[str, Any] = {"mu": MASS["mu"], "max_orbits": 5, "quiet": True}
    family = explore.trace(CR3BP, "L1-halo", **options)
    assert (family.branch, family.name) == ("south", "L1-halo")
    assert "5 southern orbits" in repr(family)
    northern = explore.trace(CR3BP, "L1-halo", branch="north", **options)
    assert (northern.branch, northern.name) == ("north", "L1-halo-north")
    assert northern[4].point[2] == pytest.approx(-family[4].point[2], abs=1e-9)
    with pytest.raises(ValueError, match="branch: 'up' is unknown; there are north and south"):
        explore.trace(CR3BP, "L1-halo", branch="up", **options)  # type: ignore[arg-type]


def test_tables_of_certificates_say_the_side() -> None:
    """The stored certificates are about northern orbits, with z > 0 at the point that is far from the Moon."""
    rows = read_rows([DATA / "figures-certificates.json"])
    sides = {row.id: row.branch for row in rows if row.system is CR3BP and row.k > 1}
    assert sides
    assert set(sides.values()) == {"north"}
    tables = build_tables(rows, [])
    labels = [section.label for table in tables for section in table.sections if table.system is CR3BP]
    assert labels == ["mu Earth-Moon, northern orbits"]


@pytest.mark.parametrize(
    "words",
    [
        ["family", "--system", "cr3bp", "--mass", "0.1", "--family", "L1-lyapunov", "--branch", "north", "-o", "OUT"],
        ["orbit", "--family", "L1-vertical", "--mass", "0.1", "--at", "z=0.1", "--branch", "north", "-o", "OUT"],
        ["catalogue", "--family", "dro", "--mass", "0.1", "--branch", "north", "-o", "OUT"],
        ["family", "--from-catalogue", "c.json", "--branch", "north", "-o", "OUT"],
        ["atlas", "--preset", "l2-arc-earth-moon", "--branch", "north", "-o", "OUT"],
        ["atlas", "--family", "L1-lyapunov", "--mass", "0.1", "--branch", "north", "-o", "OUT"],
    ],
    ids=lambda words: " ".join(words[:3]),
)
def test_a_side_of_families_that_have_none_is_refused(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "out.json") if word == "OUT" else word for word in words]) == 2
    assert "--branch" in capsys.readouterr().err


def test_branches_of_planar_families_are_on_the_side_that_was_asked_for(tmp_path: Path) -> None:
    output = tmp_path / "families.json"
    words = ["family", "--system", "cr3bp", "--mass", "0.1", "--family", "L1-lyapunov", "--branches", "--jobs", "1"]
    assert main([*words, "--branch", "north", "--jacobi-min", "3.5", "-o", str(output)]) in (0, 1)
    records = {record.name: record for record in read_families(output)}
    assert records["L1-lyapunov"].branch is None
    assert records["L1-halo-north"].branch == "north"


@pytest.mark.parametrize(("height", "side"), [("0.1", "north"), ("-0.1", "south")])
def test_a_height_that_singles_out_an_orbit_says_the_side(
    height: str, side: Branch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output, other = tmp_path / "orbit.json", "south" if side == "north" else "north"
    words = [
        "orbit",
        "--family",
        "L1-halo",
        "--mass",
        "earth-moon",
        "--at",
        f"z={height}",
        "--digits",
        "15",
        "--jobs",
        "1",
    ]
    assert main([*words, "-o", str(output)]) == 0
    assert f"{side}ern earth-moon-L1-halo: 2 orbits with z = {height}" in capsys.readouterr().err
    found = read_candidates(output)
    assert {float(each.centre[1]) for each in found} == {float(height)}
    assert {each.provenance["branch"] for each in found} == {side}
    assert found[0].id == f"earth-moon-{name_on('L1-halo', side)}-1"
    assert main([*words, "--branch", other, "-o", str(tmp_path / "none.json")]) == 1
    assert f"{other}ern earth-moon-L1-halo: no orbit with z = {height}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("ends", "side"), [(("0", "0.01"), "north"), (("0.02", "0.05"), "north"), (("-0.05", "-0.02"), "south")]
)
def test_heights_that_an_atlas_covers_say_the_side(
    ends: tuple[str, str], side: Branch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "atlas.json"
    words = ["atlas", "--family", "L1-halo", "--system", "cr3bp", "--mass", "earth-moon", "--covers", "z", *ends]
    assert main([*words, "-o", str(output)]) == 0
    assert f"{name_on('L1-halo', side)}: " in capsys.readouterr().err
    atlas = read_atlas(output)
    assert atlas.title.startswith(f"{side}ern L1-halo orbits")
    assert atlas.provenance["branch"] == side
