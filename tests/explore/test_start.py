"""What the command line of the search loads before it has anything to compute."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = {"jax", "diffrax", "numpy", "mpmath", "matplotlib", "flint"}
SCRIPT = """
import sys
from orbitproof.explore.__main__ import main
try:
    code = main(sys.argv[1:])
except SystemExit as end:
    code = end.code
print(code, *sorted(set({heavy}) & set(sys.modules)), file=sys.stderr)
"""


def loaded(*words: str) -> list[str]:
    """The exit code of a command in a process of its own, and which of the heavy packages it loaded."""
    script = SCRIPT.format(heavy=sorted(HEAVY))
    result = subprocess.run([sys.executable, "-c", script, *words], capture_output=True, text=True, check=True)
    return result.stderr.splitlines()[-1].split()


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["candidates", "--help"],
        ["branches", "--help"],
        ["portraits", "--help"],
        ["atlas", "--help"],
    ],
    ids=" ".join,
)
def test_help_loads_nothing_heavy(words: list[str]) -> None:
    assert loaded(*words) == ["0"]


@pytest.mark.parametrize(
    "words",
    [
        ["candidates", "--system", "nothing", "-o", "never.json"],
        ["family", "--system", "cr3bp", "--mass", "moon", "--family", "L1-halo", "-o", "never.json"],
        ["mass-curve", "--mu-max", "3", "-o", "never.json"],
        ["atlas", "--system", "cr3bp", "--mass", "2", "--family", "L1-halo", "-o", "never.json"],
        ["atlas-libration", "--point", "L1", "--mass", "1", "-o", "never.json"],
        ["atlas-mass", "--point", "L1", "--mu-max", "0.9", "-o", "never.json"],
    ],
    ids=" ".join,
)
def test_bad_options_are_refused_before_anything_heavy_is_loaded(words: list[str]) -> None:
    assert loaded(*words) == ["2"]


def test_a_command_that_computes_loads_numpy(tmp_path: Path) -> None:
    words = ["portraits", "--orbits", "2", "--iterates", "10", "--quiet", "-o", str(tmp_path / "portraits.json")]
    assert loaded(*words) == ["0", "numpy"]
