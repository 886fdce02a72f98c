"""Standard streams: what is printed to a reader that has gone, closed and full ones, files named as one of them."""

from __future__ import annotations

import os
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


RUNS = """
import argparse, sys
from orbitproof.shared.interrupts import run_command
sys.exit(run_command(lambda: {expression}))
"""
PROGRAMS = {
    "a line": ("out", 0, PRINTS.format(lines=1)),
    "more than a buffer": ("out", 0, PRINTS.format(lines=100)),
    "help": ("out", 0, RUNS.format(expression="argparse.ArgumentParser().parse_args(['--help'])")),
    "bad option": ("err", 2, RUNS.format(expression="argparse.ArgumentParser().parse_args(['--bad'])")),
    "progress": ("err", 0, RUNS.format(expression="print('done', file=sys.stderr) or 0")),
}
"""The stream that each writes to, its exit code, and the program."""


def redirected(program: str, how: str, **environment: str) -> tuple[int, str]:
    """The exit code of a program whose streams a shell redirects, and what it says yet."""
    run = subprocess.run(
        ["sh", "-c", f'exec "$0" -c "$1" {how}', sys.executable, program],
        capture_output=True, text=True, timeout=60, env={**os.environ, **environment},
    )  # fmt: skip
    return run.returncode, run.stdout + run.stderr


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_full_stream_is_bad_input(name: str, unbuffered: str) -> None:
    """Told in one line where there is a stream for it, and never as a traceback."""
    stream, usual, program = PROGRAMS[name]
    for how, full in ((">/dev/full", ["out"]), ("2>/dev/full", ["err"]), (">/dev/full 2>/dev/full", ["out", "err"])):
        code, said = redirected(program, how, PYTHONUNBUFFERED=unbuffered)
        # What is full and not written to nobody knows of.
        assert code == (2 if stream in full else usual)
        assert "Traceback" not in said
        if full == [stream] == ["out"]:
            assert said == "error: standard output cannot be written (No space left on device); give it another file\n"


@pytest.mark.parametrize(("how", "lines"), [("2>&-", 0), (">&-", 1), (">&- 2>&-", 0)])
def test_a_closed_stream_is_bad_input(how: str, lines: int) -> None:
    code, said = redirected(PRINTS.format(lines=1), how)
    assert (code, said.count("\n")) == (2, lines)
    assert said == "" or said.startswith("error: standard output is closed; give it a file, or ")


@pytest.mark.slow
@pytest.mark.parametrize("room", ["verify", "explore", "figures", "report"])
def test_every_command_is_bad_input_with_a_closed_or_full_stream(room: str) -> None:
    for redirected in ("2>&-", ">&-", ">/dev/full"):
        words = f'exec "$0" -m orbitproof {room} --help {redirected}'
        run = subprocess.run(["sh", "-c", words, sys.executable], capture_output=True, text=True, timeout=60)
        assert run.returncode == 2
        assert run.stderr.count("\n") == ("2>&-" not in redirected)


def test_no_file_takes_the_place_of_a_closed_stream() -> None:
    """What a library prints to it would be written there."""
    program = RUNS.format(expression="print(open('/dev/null').fileno()) or 0")
    code, said = redirected(program, "<&-")
    assert code == 0
    assert int(said) > 2


def test_standard_output_is_no_file_to_write() -> None:
    for path in (Path("-"), Path("folder", "-")):
        with pytest.raises(InputError, match="give a path"):
            check_writable(path)
