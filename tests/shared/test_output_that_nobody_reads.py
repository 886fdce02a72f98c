"""What is printed to a reader that has gone, and files named as standard output."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from orbitproof.shared.formats import InputError, check_writable

PRINTS = """
import sys
from orbitproof.shared.interrupts import run_command
def main():
    for _ in range({lines}):
        print("x" * 1000)
    return 0
sys.exit(run_command(main))
"""
BREAKS = """
import os, sys
from orbitproof.shared.interrupts import run_command
def main():
    read, write = os.pipe()
    os.close(read)
    os.write(write, b"x")
sys.exit(run_command(main))
"""


def ends(program: str, *, is_read: bool) -> tuple[int, str]:
    """The exit code of a program, and what it says, with standard output read to the end or not at all."""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        if is_read:
            process.stdout.read()
        process.stdout.close()
        return process.wait(60), process.stderr.read()


@pytest.mark.parametrize("lines", [1, 1000])
def test_a_reader_that_is_gone_ends_a_command_without_a_word(lines: int) -> None:
    program = PRINTS.format(lines=lines)
    assert ends(program, is_read=True) == (0, "")
    assert ends(program, is_read=False) == (1, "")


def test_another_pipe_that_breaks_is_no_such_end() -> None:
    code, said = ends(BREAKS, is_read=True)
    assert code == 1
    assert "BrokenPipeError" in said


def test_standard_output_is_no_file_to_write() -> None:
    for path in (Path("-"), Path("folder", "-")):
        with pytest.raises(InputError, match="give a path"):
            check_writable(path)
