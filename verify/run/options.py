"""What the command lines of the verifier have in common: one-line errors, options of runs, types of options."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from orbitproof.shared.answers import add_json_option
from orbitproof.shared.help_text import HelpFormatter, Parser
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.processes import GRACE_SECONDS
from orbitproof.verify.run.workplace import GIBIBYTE, INTEGRATION_SECONDS, CheckLimits


class ArgumentParser(Parser):
    """What all parsers of the verifier share."""

    def __init__(self, prog: str, description: str, examples: str) -> None:
        super().__init__(prog=prog, description=description, epilog=examples, formatter_class=HelpFormatter)
        add_json_option(self)

    def number(self, name: str, metavar: str, words: str, of: Callable[[str], float], default: int | None) -> None:
        """An option that takes a number of this type."""
        self.add_argument(name, type=of, default=default, metavar=metavar, help=words)

    def memory_option(self, of: str) -> None:
        """The option that limits the memory of each process that does something of this kind."""
        words = f"memory for {of}, each in a process of its own (default: {CheckLimits.memory / GIBIBYTE:g})"
        self.add_argument("--memory", type=gibibytes, default=CheckLimits.memory, metavar="GIB", help=words)

    def run_options(self, tasks: str, timeout: str, one: str, usual: float) -> None:
        """The options of every run of `tasks`; `timeout` is the option that ends `one` of them.

        Without it, a check that does not integrate has the `usual` time, and one that does `INTEGRATION_SECONDS`.
        """
        self.number(
            "--jobs", "N", f"{tasks} side by side, each in a process of its own (default: 1)", whole_number(1), 1
        )
        self.add_argument(
            "--scheduler", metavar="ADDRESS", help="use the cluster of this dask scheduler in place of --jobs"
        )
        words = (
            f"give {one} up after this processor time; it has {GRACE_SECONDS:g} s more to end by itself; with "
            f"--recheck, each check as well (default: {usual:g}, with --integrate {INTEGRATION_SECONDS:g})"
        )
        self.number(timeout, "SECONDS", words, positive_seconds, None)
        self.add_argument("--fresh", action="store_true", help="prove again what an earlier run proved")
        self.add_argument("--recheck", action="store_true", help="check what is in a certificates file again")
        self.add_argument(
            "--integrate", action="store_true", help="with --recheck: integrate and prove again, in another way"
        )
        self.memory_option("each check with --recheck")
        self.add_argument("--quiet", action="store_true", help="no progress on stderr")


def interrupted(done: int, total: int, things: str, output: Path | None = None) -> int:
    """Say how far a run has come that was ended; the exit code for it.

    `output` is the file from which it goes on, if anything is in it.
    """
    is_kept = output is not None and output.is_file()
    saved = f", saved in {output}; the same command goes on from there" if is_kept else ""
    print(f"interrupted: {done} of {total} {things}{saved}", file=sys.stderr)
    return INTERRUPTED


def whole_number(first: int, last: int = 10**9 - 1) -> Callable[[str], int]:
    """The type of an option: a whole number from `first` to `last`."""

    def number(text: str) -> int:
        if not text.isascii() or not text.isdigit() or not first <= int(text[:10]) <= last:
            raise argparse.ArgumentTypeError(f"{text!r}: give a whole number from {first} to {last}")
        return int(text)

    return number


def positive_seconds(text: str) -> float:
    """The type of an option: a time."""
    return _positive(text, 1e9, "seconds")


def gibibytes(text: str) -> int:
    """The type of an option: memory in GiB, as bytes."""
    return max(1, int(_positive(text, 1e6, "GiB") * GIBIBYTE))


def _positive(text: str, limit: float, unit: str) -> float:
    with suppress(ValueError):
        if 0 < float(text) < limit:
            return float(text)
    raise argparse.ArgumentTypeError(f"{text!r} is not a positive number of {unit}")
