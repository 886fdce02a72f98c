"""The table of faults applies to the modules as they stand; its runner tells what is found from what is not."""

from __future__ import annotations

import ast
import json
import re
import sys
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "faults"))

import run as faults  # noqa: E402

TABLE = faults.read()


ROOMS = sorted({fault.room for fault in TABLE})


@cache
def text_of(file: str) -> str:
    """A module as it stands."""
    return (ROOT / file).read_text(encoding="utf-8")


def problems_of(fault: faults.Fault) -> Iterator[str]:
    """What is wrong with an entry."""
    try:
        ast.parse(fault.applied(text_of(fault.file)), fault.file)
    except (ValueError, SyntaxError) as error:
        yield f"{fault.name}: {error}"
    *other, number = fault.section.split(" ", 1) if fault.section[0].islower() else [fault.section]
    folders = [ROOT / "verify" / other[0]] if other else [ROOT / name for name in Path(fault.file).parents[:-1]]
    if not any(
        re.match(rf"{re.escape(number)}(\.? |$)", heading) for folder in folders for heading in headings(folder)
    ):
        yield f"{fault.name}: there is no section {fault.section}"
    if not fault.file.startswith(faults.TRUSTED):
        yield f"{fault.name}: {fault.file} is not trusted"
    missing = [name for name in (*fault.first, *fault.tests) if not is_there(*name.partition("[")[0].split("::"))]
    yield from (f"{fault.name}: there are no tests {name}" for name in missing)


@cache
def is_there(file: str, *names: str) -> bool:
    """Whether there is a file of tests, and in it what is named."""
    path = ROOT / file
    return path.exists() and all(re.search(rf"(def|class) {name}\b", path.read_text("utf-8")) for name in names)


@cache
def headings(folder: Path) -> list[str]:
    """Of the chapter in a folder."""
    chapter = folder / "README.md"
    return re.findall(r"^#+ (.*)$", chapter.read_text(encoding="utf-8"), re.MULTILINE) if chapter.exists() else []


@pytest.mark.parametrize("room", ROOMS)
def test_faults_apply_and_name_what_they_break(room: str) -> None:
    assert [problem for fault in TABLE if fault.room == room for problem in problems_of(fault)] == []


def test_every_room_has_faults_and_no_name_stands_for_two() -> None:
    chapters = {path.parent.name for path in (ROOT / "verify").glob("*/README.md")}
    assert {*ROOMS} >= {"shared", *chapters} - {
        "oracle",
        "attempt",
        "theorems",
        "stability",
        "distances",
        "functions",
        "out_of_plane",
        "second_proof",
    }
    assert len(TABLE) >= 600
    assert max(Counter(fault.name for fault in TABLE).values()) == 1


ROOM = """
tests = ["tests/shared/test_selection.py"]
["shared/formats/selection.py"]
"What is not asked for is not selected" = ["1.1", 'if only is None or', 'if True or']
"Nothing" = ["1.1", 'known = list(names)', 'known = [*names]', { harmless = "it is the same list" }]
"""


def test_faults_by_rule_are_other_programs_and_say_what_they_break() -> None:
    made = faults.drawn(60, 7, TABLE)
    assert len(made) == 60
    assert made == faults.drawn(60, 7, TABLE)
    assert len({fault.breaks.split(": ")[1] for fault in made}) >= 8
    for fault in made:
        text = text_of(fault.file)
        assert ast.dump(ast.parse(fault.applied(text))) != ast.dump(ast.parse(text))
        assert fault.tests


@pytest.mark.parametrize(
    ("line", "slip"),
    [
        ("if a < b: f()", "if a <= b: f()"),
        ("if a < b: f()", "if True: f()"),
        ("if a < b: f()", "if a < b: pass"),
        ("x = a - b", "x = b"),
        ("x = -a", "x = a"),
        ("x = a and b", "x = a"),
        ("x = a[1]", "x = a[2]"),
        ("x = any(a)", "x = all(a)"),
        ("x = f(a, b)", "x = f(b, a)"),
        ("x = f(a, k=1)", "x = f(a, )"),
        ("x = [a, b, c]", "x = [a, c]"),
        ("x = a if b else c", "x = c"),
        ("x = [f(y) for y in z]", "x = [f(y) for y in list(z)[:-1]]"),
        ("evidence.require(f(a), m)", "evidence.require(True, m)"),
    ],
)
def test_each_rule_makes_its_slip(line: str, slip: str, tmp_path: Path) -> None:
    (tmp_path / "module.py").write_text(line)
    made = {each.applied(line).replace("(", "").replace(")", "") for each in faults.slips.slips(tmp_path, "module.py")}
    assert slip.replace("(", "").replace(")", "") in made


def test_runner_finds_a_fault_goes_on_and_tells_what_survives(tmp_path: Path) -> None:
    (tmp_path / "room.toml").write_text(ROOM)
    entries = faults.read(tmp_path)
    told: list[str] = []
    results = faults.run(entries, tmp_path / "faults.json", 2, False, told.append)
    assert [result["verdict"] for result in results] == ["found", "survives"]
    assert results[0]["by"].startswith("tests/shared/test_selection.py::")
    text = faults.table(entries, results)
    assert "50.0 % by make test" in text
    assert "not found: room: Nothing: it is the same list" in text
    assert faults.run(entries, tmp_path / "faults.json", 2, False, told.append) == results
    assert len(told) == 2


def test_tests_that_fail_without_a_fault_find_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "room.toml").write_text(ROOM)
    monkeypatch.setattr(faults, "failing_anyway", set)
    results = faults.run(faults.read(tmp_path), tmp_path / "faults.json", 1, False, lambda line: None)
    assert [result["verdict"] for result in results] == ["not tried", "survives"]
    assert len(json.loads((tmp_path / "faults.json").read_text())) == 2


def test_a_slow_test_that_an_entry_names_runs_after_the_others(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(TESTS)

    def failed(slow: bool, *first: str) -> tuple[list[str], bool]:
        found = faults.tested(tmp_path, ["test_it.py"], slow, {}, True, [f"test_it.py::{name}" for name in first])
        return [name.partition("::")[2] for name in found["failed"]], found["slow"]

    assert failed(False) == (["test_quick"], False)
    assert failed(False, "test_named") == (["test_quick", "test_named"], True)
    assert failed(True, "test_named") == (["test_named", "test_other"], True)


TESTS = """
import pytest
@pytest.mark.slow
def test_other(): assert False
@pytest.mark.slow
def test_named(): assert False
def test_quick(): assert False
"""
