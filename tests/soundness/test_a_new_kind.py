"""CONTRIBUTING, followed word for word: its kinds of theorems, made in a copy, fulfil the contract of all kinds."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "faults"))

import run as faults  # noqa: E402

_STEP = re.compile(r"\*\*\d\. .*?(?=\*\*\d\. |\n## )", re.DOTALL)
_BLOCK = re.compile(r"```(diff|python)\n(.*?)```", re.DOTALL)
_FILE = re.compile(r"`((?:shared|verify|tests|docs)/[\w/]+\.\w+)`")


def changed(text: str, diff: str) -> str:
    """A text with the lines of a diff, whose old lines stand in it once."""
    lines = diff.splitlines(keepends=True)
    old, new = ("".join(line[1:] for line in lines if line[0] != sign) for sign in "+-")
    assert text.count(old) == 1, old
    return text.replace(old, new)


def follow(guide: str, heading: str, folder: Path) -> list[str]:
    """Make the changes that a section of a guide names; returns the files."""
    files = []
    section = guide[guide.index(f"## {heading}\n") + 1 :]
    for step in _STEP.findall(section[: section.index("\n## ") + 4]):
        for block in _BLOCK.finditer(step):
            # The file that was named last.
            *_, name = _FILE.findall(step[: block.start()])
            path = folder / name
            text = changed(path.read_text(encoding="utf-8"), block[2]) if block[1] == "diff" else block[2]
            path.write_text(text, encoding="utf-8")
            files.append(name)
    return files


def in_copy(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """A command of Python on the copy."""
    environment = {**os.environ, "PYTHONPATH": str(folder / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    environment.pop("PYTEST_ADDOPTS", None)
    return subprocess.run(
        [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


REPORT = """
import sys
sys.path.insert(0, "tests")
from pathlib import Path
from support.metamorphic_cases import ROWS
from orbitproof.figures.commands.report import main
from orbitproof.verify.certificate import certify, write_certificates
write_certificates(Path("rows.json"), [certify(ROWS[sys.argv[1]]())])
sys.exit(main(["rows.json", "-o", "report.md", "--no-pictures", "--quiet"]))
"""
"""A report of a certificate of the new kind."""
FALSE = """
import sys
sys.path.insert(0, "tests")
from dataclasses import replace
from fractions import Fraction
from support.metamorphic_cases import ROWS
from orbitproof.verify.certificate import certify
print(certify(replace(ROWS[sys.argv[1]](), **eval(sys.argv[2]))).reason.condition)
"""
"""What fails of the claim with another field."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("heading", "places", "kind", "words", "false", "condition"),
    [
        (
            "A kind of theorem", 7, "bounded_period", "Orbit with a bounded period",
            "{'between': (Fraction(1, 99), Fraction(1))}", "period",
        ),
        (
            "A kind with a claim of its own", 8, "empty_box", "Box without equilibrium",
            "{'centre': tuple(map(Fraction, (2, 1, 1)))}", "empty",
        ),
    ],
)  # fmt: skip
def test_a_kind_of_the_guide_is_made_as_it_says_and_fulfils_the_contract(
    heading: str, places: int, kind: str, words: str, false: str, condition: str, tmp_path: Path
) -> None:
    faults.copied(tmp_path, ("tests", "docs"))
    files = follow((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), heading, tmp_path)
    assert len(set(files)) == places
    case = kind.replace("_", "-")

    def run(*arguments: str) -> str:
        found = in_copy(tmp_path, *arguments)
        assert found.returncode == 0, found.stdout[-4000:] + found.stderr
        return found.stdout

    run("docs/schemas.py")
    assert f'"{kind}"' in (tmp_path / "shared/schemas/candidates.schema.json").read_text(encoding="utf-8")
    tests = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-k"]
    names = ("contract", "metamorphic", "chapters", "table_of_faults")
    contract, metamorphic, *texts = (f"tests/soundness/test_{name}.py" for name in names)
    assert run(*tests, case, "-m", "slow or not slow", contract, metamorphic).startswith("." * 5)
    run(*tests, "not broken_links", *texts)
    run("-m", "ruff", "check", "shared", "verify", "tests")
    run("tests/sentences.py")
    assert f"== {case} ==" in (tmp_path / "tests/data/sentences.txt").read_text(encoding="utf-8")
    run("-c", REPORT, case)
    assert words in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert run("-c", FALSE, case, false) == f"{condition}\n"


def test_a_diff_whose_lines_are_not_there_is_an_error() -> None:
    assert changed("a\nb\n", " a\n-b\n+c\n") == "a\nc\n"
    with pytest.raises(AssertionError):
        changed("a\n", "-b\n+c\n")
