"""Named searches: a preset asks of each of its families what is its own, and the points of all are refined together."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import orbitproof.explore.refinement.tasks
from orbitproof.explore.__main__ import main
from orbitproof.explore.commands.arguments import parser
from orbitproof.explore.families import TraceTask
from orbitproof.explore.records import read_families
from orbitproof.explore.refinement import Refined, Task, refine_tasks
from orbitproof.explore.search import check
from orbitproof.explore.search.run import _trace_tasks
from orbitproof.explore.three_body.names import (
    FAMILY_NAMES,
    WITHOUT_SYMMETRY,
    families_to_give,
    family_name,
    is_family_name,
    system_with,
)
from orbitproof.shared.systems import FALKNER_SKAN


def tasks_of(path: Path, *words: str) -> dict[str, TraceTask]:
    request = check(parser().parse_args(["candidates", "-o", str(path / "candidates.json"), *words]))
    return {task.name: task for task in _trace_tasks(request)}


def test_each_family_of_a_preset_has_its_own_multiplicities_and_limits(tmp_path: Path) -> None:
    tasks = tasks_of(tmp_path, "--preset", "demo")
    assert list(tasks) == ["L1-halo", "odd"]
    assert tasks["L1-halo"].multiplicities == (1, 2, 3, 4)
    assert tasks["L1-halo"].limits.coordinate_max == {"z": 0.3}
    assert tasks["odd"].multiplicities == (2, 3, 4)
    assert tasks["odd"].limits.coordinate_max == {}


def test_multiplicities_on_the_command_line_replace_those_of_every_family(tmp_path: Path) -> None:
    tasks = tasks_of(tmp_path, "--preset", "demo", "-k", "5")
    assert [task.multiplicities for task in tasks.values()] == [(5,), (5,)]


def test_a_preset_of_several_masses_has_a_limit_for_each(tmp_path: Path) -> None:
    words = ["candidates", "--preset", "tables", "-o", str(tmp_path / "candidates.json")]
    limits = {
        (task.label, task.limits.coordinate_max["vy"]) for task in _trace_tasks(check(parser().parse_args(words)))
    }
    assert limits == {("earth-moon", 20.5), ("sun-jupiter", 8.0)}


def test_families_of_two_systems_are_found_by_one_search_with_a_table_for_each(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    path = tmp_path / "families.json"
    assert main(["family", "--preset", "demo", "--jobs", "1", "-o", str(path)]) == 0
    records = {record.name: [resonance.k for resonance in record.resonances] for record in read_families(path)}
    assert records == {"L1-halo": [1, 4, 3, 2, 2, 3, 3, 2, 2, 3, 4], "odd": [2, 3, 4]}
    headers = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("family ")]
    assert len(headers) == 2
    assert "Jacobi" in headers[0]
    assert "beta" in headers[1]


@pytest.mark.parametrize(("jobs", "order"), [(2, ["long", "middle", "short"]), (1, ["short", "long", "middle"])])
def test_several_processes_begin_with_the_longest_points(
    jobs: int, order: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[str] = []

    def all_at_once(job: Any, items: list[Task], jobs: int, progress: Any) -> Iterator[tuple[int, Refined]]:
        begun.extend(item.id for item in items)
        return iter([(place, Refined(item, None, None, "", 0.0)) for place, item in enumerate(items)])

    monkeypatch.setattr(orbitproof.explore.refinement.tasks, "run_all", all_at_once)
    works = {"short": 1.0, "long": 9.0, "middle": 5.0}
    tasks = [Task(id, FALKNER_SKAN, {}, "fold", 1, None, (), 20, {}, work=work) for id, work in works.items()]
    found = {index: result.task.id for index, result in refine_tasks(tasks, jobs, lambda _text, _part: None)}
    assert begun == order
    assert found == dict(enumerate(works))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("dro", "dro"),
        ("DRO", "dro"),
        ("Distant-Retrograde", "dro"),
        ("l1-HALO", "L1-halo"),
        ("l2-halo-3", "L2-halo-3"),
        ("L2-Butterfly", "L2-butterfly"),
        ("nrho", "L2-halo"),
        ("L1-NRHO", "L1-halo"),
        ("butterfly", "L2-butterfly"),
        ("My-Family", "My-Family"),
    ],
)
def test_families_are_named_in_any_case(text: str, name: str) -> None:
    assert family_name(text) == name


def test_names_close_to_one_that_is_not_known_come_first() -> None:
    assert families_to_give("cr3bp", "L2-vertcal").startswith("L1-vertical, L2-vertical, L3-vertical, ")
    assert set(families_to_give("cr3bp", "zzz").split(", ")) == {*FAMILY_NAMES["cr3bp"], *WITHOUT_SYMMETRY}
    assert families_to_give("cr3bp", "L7-halo").split(", ")[:3] == ["L1-halo", "L2-halo", "L3-halo"]
    assert families_to_give("hill", "dro") == ""


def test_a_name_without_a_system_is_one_of_orbits_in_space() -> None:
    assert system_with(["dro"]) == "cr3bp"
    assert is_family_name("cr3bp-planar", "dro")
