"""`make check`: a change finds its tests, the nearest first."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

import check  # noqa: E402


def test_the_tests_that_import_a_module_come_before_those_that_lead_to_it() -> None:
    found = check.reached(["verify/krein/normal_form.py"])
    assert found.index("tests/verify/test_krein.py") < len(found) / 4
    assert "tests/explore/test_fold_search.py" not in found[:20]


def test_a_test_is_its_own_and_documents_have_theirs() -> None:
    assert check.reached(["tests/commands/test_check.py"])[0] == "tests/commands/test_check.py"
    assert check.reached(["docs/python.md"]) == ["tests/soundness/test_chapters.py", "tests/commands/test_project.py"]
    assert check.reached(["LICENSE"]) == []
