"""CONTRIBUTING, followed word for word: its kind of theorem, made in a copy, fulfils the contract of all kinds."""

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


def follow(guide: str, folder: Path) -> list[str]:
    """Make the changes that a guide names; returns the files."""
    files = []
    section = guide[guide.index("## A kind of theorem") :]
    for step in _STEP.findall(section):
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
write_certificates(Path("rows.json"), [certify(ROWS["bounded-period"]())])
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
print(certify(replace(ROWS["bounded-period"](), between=(Fraction(1, 99), Fraction(1)))).reason.condition)
"""
"""What fails of a claim whose bounds are wrong."""


@pytest.mark.slow
def test_the_kind_of_the_guide_is_made_as_it_says_and_fulfils_the_contract(tmp_path: Path) -> None:
    faults.copied(tmp_path, ("tests", "docs"))
    files = follow((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), tmp_path)
    assert len(set(files)) == 8
    schemas = in_copy(tmp_path, "docs/schemas.py")
    assert schemas.returncode == 0, schemas.stderr
    schema = (tmp_path / "shared/schemas/candidates.schema.json").read_text(encoding="utf-8")
    assert '"bounded_period"' in schema
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", "bounded-period"]
    found = in_copy(tmp_path, *words, "tests/soundness/test_contract.py", "tests/soundness/test_metamorphic.py")
    assert found.returncode == 0, found.stdout[-4000:]
    assert found.stdout.startswith("." * 5), found.stdout
    chapters = in_copy(
        tmp_path,
        *words[:-1],
        "not broken_links",
        "tests/soundness/test_chapters.py",
        "tests/soundness/test_table_of_faults.py",
    )
    assert chapters.returncode == 0, chapters.stdout[-4000:]
    lint = in_copy(tmp_path, "-m", "ruff", "check", "shared", "verify", "tests")
    assert lint.returncode == 0, lint.stdout
    report = in_copy(tmp_path, "-c", REPORT)
    assert report.returncode == 0, report.stderr
    assert "Orbit with a bounded period" in (tmp_path / "report.md").read_text(encoding="utf-8")
    false = in_copy(tmp_path, "-c", FALSE)
    assert (false.returncode, false.stdout) == (0, "period\n"), false.stderr


def test_a_diff_whose_lines_are_not_there_is_an_error() -> None:
    assert changed("a\nb\n", " a\n-b\n+c\n") == "a\nc\n"
    with pytest.raises(AssertionError):
        changed("a\n", "-b\n+c\n")
