"""The table of faults applies to the modules as they stand; its runner tells what is found from what is not."""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "faults"))

import run as faults  # noqa: E402

TABLE = faults.read()


@pytest.mark.parametrize("fault", TABLE, ids=lambda fault: fault.name)
def test_fault_applies_and_names_what_it_breaks(fault: faults.Fault) -> None:
    text = (ROOT / fault.file).read_text(encoding="utf-8")
    compile(fault.applied(text), fault.file, "exec")
    *other, number = fault.section.split(" ", 1) if fault.section[0].islower() else [fault.section]
    folders = [ROOT / "verify" / other[0]] if other else [ROOT / name for name in Path(fault.file).parents[:-1]]
    chapters = [
        (folder / "README.md").read_text(encoding="utf-8") for folder in folders if (folder / "README.md").exists()
    ]
    assert re.search(rf"^#+ {re.escape(number)}(\.? |$)", "\n".join(chapters), re.MULTILINE)
    assert fault.file.startswith(faults.TRUSTED)
    assert all((ROOT / name.partition("::")[0]).exists() for name in (*fault.first, *fault.tests))


def test_no_fault_is_named_twice() -> None:
    assert max(Counter(fault.name for fault in TABLE).values()) == 1


ROOM = """
tests = ["tests/shared/test_selection.py"]
[[faults]]
breaks = "What is not asked for is not selected"
section = "1.1"
file = "shared/formats/selection.py"
old = "if only is None or"
new = "if True or"
[[faults]]
breaks = "Nothing"
section = "1.1"
file = "shared/formats/selection.py"
old = "known = list(names)"
new = "known = [*names]"
harmless = "it is the same list"
"""


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
