"""The search's command line: tables, files, exit codes, resuming, interrupts."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.refusals import refused

import orbitproof.explore.search.run
import orbitproof.explore.three_body.families.named
from orbitproof.explore.__main__ import main
from orbitproof.explore.commands.arguments import parser
from orbitproof.explore.families import Limits, TracedFamily, family_of, family_record
from orbitproof.explore.records import read_families, write_families
from orbitproof.explore.refinement import Refined, Task, refine_tasks
from orbitproof.explore.search import check
from orbitproof.explore.three_body.families import trace_family
from orbitproof.shared import InputError, format_exact, parse_exact
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import FALKNER_SKAN, MASS_PARAMETERS


@pytest.fixture(scope="module")
def family_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A family file of the Falkner-Skan family that holds k = 2 and 3 but not k = 4."""
    path = tmp_path_factory.mktemp("family") / "family.json"
    arguments = ["--beta-min", "300", "--beta-max", "460", "-o", str(path), "--quiet"]
    assert main(["family", "--system", "falkner-skan", "-k", "2", *arguments]) == 0
    return path


def failing(tasks: Sequence[Task], jobs: int, progress: Any) -> Iterator[tuple[int, Refined]]:
    """Every refinement fails."""
    for index, task in enumerate(tasks):
        yield index, Refined(task, None, None, "for a reason", 0.0)


def interrupted(tasks: Sequence[Task], jobs: int, progress: Any) -> Iterator[tuple[int, Refined]]:
    """The first point is refined, then comes Ctrl-C."""
    yield next(refine_tasks(tasks, 1, progress))
    raise KeyboardInterrupt


def test_candidates_are_found_refined_and_written(family_path: Path, tmp_path: Path, capsys: Any) -> None:
    output = tmp_path / "candidates.json"
    arguments = ["--from-family", str(family_path), "--beta-max", "460", "--jobs", "1", "-o", str(output)]
    assert main(["candidates", "-k", "2", *arguments]) == 0
    table, messages = capsys.readouterr()
    assert "340.1875349891435" in table
    assert "falkner-skan-odd-k2-1" in table
    found = "falkner-skan-odd-k2-1: period doubling (k = 2), beta = 340.18753"
    assert f"{found}\n" in messages
    assert f"{found}49891435344, refined to 50 digits" in messages
    (candidate,) = read_candidates(output)
    assert (candidate.id, candidate.kind, candidate.k) == ("falkner-skan-odd-k2-1", "period_tupling", 2)
    assert float(candidate.centre[0]) == pytest.approx(340.18753498914353, abs=1e-12)
    assert candidate.provenance["point_on_fix_r"] == "first"

    assert main(["candidates", "-k", "3", "--append", "--quiet", *arguments]) == 0
    assert [entry.k for entry in read_candidates(output)] == [2, 3]
    assert main(["candidates", "-k", "3", "--append", "--quiet", *arguments]) == 0
    assert [entry.k for entry in read_candidates(output)] == [2, 3]


def test_resonance_that_is_not_there_gives_exit_code_1_and_says_so(
    family_path: Path, tmp_path: Path, capsys: Any
) -> None:
    output = tmp_path / "candidates.json"
    arguments = ["--from-family", str(family_path), "--beta-max", "460", "-o", str(output)]
    assert main(["candidates", "-k", "4", *arguments]) == 1
    assert "no 1:4 resonance found on the part traced" in capsys.readouterr().err
    assert not output.exists()


def test_family_from_a_file_is_continued_to_a_further_limit(family_path: Path, tmp_path: Path) -> None:
    output = tmp_path / "more.json"
    arguments = ["--from-family", str(family_path), "--beta-max", "700", "-o", str(output), "--quiet"]
    assert main(["family", "-k", "4", *arguments]) == 0
    (short,), (long,) = read_families(family_path), read_families(output)
    assert len(long.orbits) > len(short.orbits)
    assert long.orbits[len(short.orbits) - 1].point == pytest.approx(short.orbits[-1].point, abs=0)
    assert [resonance.k for resonance in long.resonances] == [4]
    assert long.resonances[0].point[0] == pytest.approx(679.95415507, abs=1e-6)


def test_failed_refinements_are_reported_and_the_output_is_left_alone(
    family_path: Path, tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(orbitproof.explore.search.run, "refine_tasks", failing)
    output = tmp_path / "candidates.json"
    arguments = ["--from-family", str(family_path), "--beta-max", "460", "-o", str(output), "--quiet"]
    assert main(["candidates", "-k", "2", "3", *arguments]) == 1
    messages = capsys.readouterr().err
    assert "falkner-skan-odd-k2-1: not refined: for a reason" in messages
    assert "falkner-skan-odd-k3-1: not refined: for a reason" in messages
    assert not output.exists()


def test_interrupt_keeps_what_was_found(
    family_path: Path, tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(orbitproof.explore.search.run, "refine_tasks", interrupted)
    output = tmp_path / "candidates.json"
    arguments = ["--from-family", str(family_path), "--beta-max", "460", "-o", str(output), "--quiet"]
    assert main(["candidates", "-k", "2", "3", *arguments]) == 130
    assert [entry.k for entry in read_candidates(output)] == [2]
    assert "interrupted; 1 of 2 points are refined" in capsys.readouterr().err


def test_interrupt_while_tracing_writes_the_part_that_can_be_resumed(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = orbitproof.explore.three_body.families.named.trace_family

    def stopped(*arguments: Any, progress: Any, **options: Any) -> Any:
        def interrupt(message: str, fraction: float) -> None:
            if fraction > 0.3:
                raise KeyboardInterrupt

        return plain(*arguments, progress=interrupt, **options)

    monkeypatch.setattr(orbitproof.explore.three_body.families.named, "trace_family", stopped)
    output, family = tmp_path / "candidates.json", tmp_path / "family.json"
    arguments = ["-k", "2", "-o", str(output), "--family-output", str(family), "--quiet"]
    assert main(["candidates", "--system", "falkner-skan", *arguments]) == 130
    assert f"resume with --from-family {family}" in capsys.readouterr().err
    (record,) = read_families(family)
    assert record.outcome == "interrupted"
    assert len(record.orbits) > 2
    assert not output.exists()


def test_family_file_reads_back_what_was_written(tmp_path: Path) -> None:
    family = trace_family(FALKNER_SKAN, "odd", {}, Limits(parameter_max=150.0))
    path = tmp_path / "family.json"
    write_families(path, [family_record(TracedFamily("odd", "", family))])
    (record,) = read_families(path)
    again = family_of(record)
    assert again.reason == family.reason
    for left, right in zip(again.orbits, family.orbits, strict=True):
        assert np.array_equal(left.unknowns, right.unknowns)
        assert np.array_equal(left.coefficients, right.coefficients)
        assert left.arclength == right.arclength
        assert left.first_integral == right.first_integral


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"system": "pendulum"}, "pendulum"),
        ({"symmetry": "S"}, "symmetry"),
        ({"parameters": {"mu": "0.1"}}, "parameters"),
        ({"scale": [1.0, 2.0]}, "scale"),
        ({"orbits": []}, "orbits"),
        ({"comment": "mine"}, "comment"),
    ],
)
def test_damaged_family_file_is_refused_in_one_line(
    family_path: Path, tmp_path: Path, change: dict[str, Any], word: str
) -> None:
    document = json.loads(family_path.read_text())
    document["families"][0].update(change)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=word) as error:
        read_families(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("change", [{"point": [1.0]}, {"arclength": 0.0}, {"half_period": 1e999}, {"crossings": 0}])
def test_damaged_orbit_in_a_family_file_is_refused(family_path: Path, tmp_path: Path, change: dict[str, Any]) -> None:
    document = json.loads(family_path.read_text())
    document["families"][0]["orbits"][1].update(change)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(document).replace("Infinity", "1e999"))
    with pytest.raises(InputError, match=r"orbits\[1\]|1e999 is too large"):
        read_families(path)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--system", "cr3bp", "--mass", "0.01"], "--family"),
        (["--system", "cr3bp", "--family", "L1-halo"], "--mass"),
        (["--system", "falkner-skan", "--mass", "0.01"], "--mass"),
        (["--system", "falkner-skan", "-k", "1"], "-k 1"),
        (["--system", "falkner-skan", "--beta-min", "500", "--beta-max", "400"], "--beta-min"),
        (["--system", "falkner-skan", "--beta-min", "0.5"], "--beta-min"),
        (["--system", "falkner-skan", "--z-max", "-1"], "--z-max"),
        (["--system", "falkner-skan", "--z-max", "1"], "--z-max"),
        (["--system", "falkner-skan", "--vy-max", "1"], "--vy-max"),
        (["--preset", "tables", "--mass", "0.1"], "--mass"),
        (["--preset", "tables", "--vy-max", "3"], "--vy-max"),
        (["--preset", "demo", "--z-max", "0.1"], "--z-max"),
        (["--preset", "demo", "-k", "1"], "-k 1"),
        (["--preset", "figures"], "--preset"),
        (["--system", "cr3bp", "--family", "L1-halo", "--mass", "0.1", "0.2", "--vy-max", "1", "2", "3"], "--vy-max"),
        (["--system", "cr3bp", "--family", "L1-halo", "--mass", "0.1", "2"], "--mass 2"),
        (["--system", "falkner-skan", "--jobs", "0"], "--jobs"),
        (["--system", "cr3bp", "--mass", "0x1p-2000", "--family", "L1-halo"], "--mass"),
        ([], "--system"),
    ],
)
def test_contradictory_options_are_refused_in_one_line(
    arguments: list[str], word: str, tmp_path: Path, capsys: Any
) -> None:
    assert word in refused(main, ["candidates", *arguments, "-o", str(tmp_path / "candidates.json")], capsys)
    assert list(tmp_path.iterdir()) == []


def test_family_file_of_another_system_is_refused(family_path: Path, tmp_path: Path, capsys: Any) -> None:
    arguments = ["--system", "cr3bp", "--from-family", str(family_path), "-o", str(tmp_path / "c.json")]
    assert main(["candidates", *arguments]) == 2
    assert "--system cr3bp" in capsys.readouterr().err
    both = ["--from-family", str(family_path), "--family", "even", "-o", str(tmp_path / "c.json")]
    assert main(["candidates", *both]) == 2
    assert "--from-family" in capsys.readouterr().err


def test_refinement_in_processes_gives_the_same_candidates_as_in_this_one(family_path: Path) -> None:
    (record,) = read_families(family_path)
    (resonance,) = record.resonances
    task = Task("a", FALKNER_SKAN, {}, "period_tupling", 2, None, tuple(resonance.point.tolist()), 20, {"n": 1})
    far = replace(task, id="b", guess=(330.0, 0.9))
    here = dict(refine_tasks([task, far], 1, lambda message, fraction: None))
    there = dict(refine_tasks([task, far], 2, lambda message, fraction: None))
    assert here[0].candidate == there[0].candidate
    assert there[0].candidate is not None
    assert there[0].candidate.system is FALKNER_SKAN
    assert here[1].failure == there[1].failure is not None


def test_exact_text_of_a_number_reads_back() -> None:
    for value in (MASS_PARAMETERS["earth-moon"], parse_exact("0.01215"), parse_exact("-3e2"), parse_exact("0")):
        assert parse_exact(format_exact(value)) == value
    with pytest.raises(ValueError, match="neither dyadic nor decimal"):
        format_exact(parse_exact("1") / 3)


@pytest.mark.parametrize(
    ("family", "mass", "system"),
    [
        ("L2-halo", ["--mass", "0.01"], "cr3bp"),
        ("L3-axial", ["--mass", "0.01"], "cr3bp-axial"),
        ("odd", [], "falkner-skan"),
    ],
)
def test_the_name_of_a_family_says_which_system(family: str, mass: list[str], system: str, tmp_path: Path) -> None:
    words = ["family", *mass, "--family", family, "-o", str(tmp_path / "family.json")]
    (request,) = check(parser().parse_args(words)).families
    assert (request.system.name, request.name) == (system, family)
