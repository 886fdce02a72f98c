"""`make check`: a change finds its tests, the nearest first. `make test`: what it leaves out, `make test-slow` runs."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support import quick

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

import check  # noqa: E402
import heavy  # noqa: E402


def test_the_tests_that_import_a_module_come_before_those_that_lead_to_it() -> None:
    found = check.reached(["verify/krein/normal_form.py"])
    assert found.index("tests/verify/test_krein.py") < len(found) / 4
    assert "tests/explore/test_fold_search.py" not in found[:20]


def test_a_test_is_its_own_and_documents_have_theirs() -> None:
    assert check.reached(["tests/commands/test_check.py"])[0] == "tests/commands/test_check.py"
    texts = ["tests/soundness/test_chapters.py", "tests/commands/test_project.py"]
    assert check.reached(["docs/architecture.md"])[:2] == texts
    assert check.reached(["shared/" + "nobody" + "-names-it.bin"]) == []


def test_what_is_loaded_by_name_what_lies_beside_a_test_and_data_are_reached() -> None:
    assert "tests/verify/test_web.py" in check.reached(["verify/theorems/web.py"])
    beside = check.reached(["tests/second_proof/closed_forms.py"])
    assert beside == ["tests/second_proof/test_second_proof_properties.py"]
    assert "tests/soundness/test_false_claims.py" in check.reached(["tests/data/known-bifurcations.json"])
    assert len(check.reached(["tests/conftest.py"])) > 300


def made(name: str, *marks: str, **numbers: int) -> Any:
    """A test as pytest collects it, a case with these numbers of its parameters' values."""
    item = SimpleNamespace(nodeid=name, keywords=set(marks))
    item.add_marker = lambda mark: item.keywords.add(mark.name)
    if numbers:
        item.callspec = SimpleNamespace(params=numbers)
        item.iter_markers = lambda name: iter(())
    return item


def is_slow(item: Any) -> bool:
    """Whether `make test` leaves it out."""
    return "slow" in item.keywords


CASES = """
import pytest

@pytest.mark.parametrize("kind", "ab")
@pytest.mark.parametrize("seed", range(9))
def test_random(seed, kind): pass

@pytest.mark.parametrize("seed", range(9))
def test_alone(seed): pass

@pytest.mark.quick
@pytest.mark.parametrize("seed", range(9))
def test_kept(seed): pass

@pytest.mark.parametrize(("one", "other"), [(1, 2), (2, 1), (2, 2)])
def test_of_a_table(one, other): pass
"""


def test_first_seeds_and_every_other_value_are_quick_and_the_rest_is_slow(tmp_path: Path) -> None:
    file, found = tmp_path / "test_cases.py", list[pytest.Item]()
    file.write_text(CASES)

    class Chosen:
        def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
            quick.choose(items)
            found.extend(item for item in items if not is_slow(item))

    words = ["--collect-only", "-qq", "-p", "no:cacheprovider", "--noconftest", "-c", str(tmp_path / "none.ini")]
    (tmp_path / "none.ini").write_text("[pytest]\nmarkers = quick")
    assert pytest.main([*words, str(file)], plugins=[Chosen()]) == 0
    names = [item.name.removeprefix("test_") for item in found]
    assert [name for name in names if "random" in name] == ["random[0-a]", "random[0-b]", "random[1-a]", "random[2-a]"]
    assert [name for name in names if "alone" in name] == ["alone[0]", "alone[1]", "alone[2]"]
    assert sum("kept" in name for name in names) == 9
    assert sum("table" in name for name in names) == 3


def test_tests_that_take_long_are_slow_but_for_those_that_stay(monkeypatch: Any) -> None:
    monkeypatch.setattr(quick, "heavy", lambda: frozenset({"a.py::test", "b.py::test[x]"}))
    names = ("a.py::test[y]", "b.py::test[x]", "b.py::test[y]", "a.py::test[z]")
    marks = [(), (), (), ("quick",)]
    items = [made(name, *given, value=number) for number, (name, given) in enumerate(zip(names, marks, strict=True))]
    quick.choose(items)
    assert list(map(is_slow, items)) == [True, True, False, False]
    items = [made(name, value=number) for number, name in enumerate(names)]
    quick.choose(items, with_heavy=True)
    assert not any(map(is_slow, items))


def test_the_longest_are_left_out_with_the_fixtures_that_nobody_else_needs() -> None:
    lines = [
        '{"fixture": "::shared", "seconds": 5}', '{"test": "a", "seconds": 1, "fixtures": ["::shared"]}',
        '{"test": "b", "seconds": 2, "fixtures": ["::shared"]}', '{"test": "c", "seconds": 3, "fixtures": []}',
    ]  # fmt: skip
    costs = heavy.read(lines)
    assert heavy.longest(*costs, 11) == []
    assert heavy.longest(*costs, 9) == ["b"]
    assert heavy.longest(*costs, 3.5) == ["a", "b"]
    assert heavy.longest(*costs, 0.5) == ["a", "b", "c"]
    costs = heavy.read([*lines, '{"test": "b", "seconds": 2, "fixtures": ["::shared"], "quick": true}'])
    assert heavy.longest(*costs, 0.5) == ["a", "c"]


def test_the_list_of_long_tests_names_tests_that_there_are() -> None:
    for name in sorted({name.partition("[")[0] for name in quick.heavy()}):
        file, _, test = name.partition("::")
        nodes = ast.walk(ast.parse((ROOT / file).read_text()))
        assert test in {node.name for node in nodes if isinstance(node, ast.FunctionDef)}, name
