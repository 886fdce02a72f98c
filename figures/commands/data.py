"""``orbitproof figures data``: make the data files of the pictures that are missing, each by its own command."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from typing import Any

from orbitproof.figures.collection import STEPS, Step
from orbitproof.figures.files import check_folder
from orbitproof.shared.formats import select_ids, write_text
from orbitproof.shared.interrupts import INTERRUPTED, bound_to_this

_EXAMPLES = """\
examples:
  orbitproof figures data data/
  orbitproof figures data data/ --only portraits.json lyapunov.json
  orbitproof figures data data/ --dry-run                (print the commands, run nothing)

A file that is there is not made again: delete it to have it made, or put your own in its place. What was interrupted
goes on where it stopped. The search and the proof run as commands of their own; docs/figures.md has the times.
Exit codes: 0 all files there; 1 a command did not find or prove everything; 2 bad input or a failed command;
130 interrupted.
"""

_UNFINISHED = "unfinished.txt"


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = commands.add_parser(
        "data",
        help="make the data files of the pictures that are missing",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of data files, created if need be")
    parser.add_argument("--only", nargs="+", metavar="FILE", help="these files, by name (with * and ?; default: all)")
    parser.add_argument("--dry-run", action="store_true", help="print the commands that would be run, run nothing")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the commands whose products are missing; returns the exit code. Raises `InputError`."""
    known = [name for step in STEPS for name in step.products]
    chosen = set(select_ids(known, options.only, "data file"))
    check_folder(options.data)
    unfinished = _read_unfinished(options.data)
    steps = [step for step in STEPS if chosen.intersection(step.products)]
    missing = [step for step in steps if _is_missing(step, options.data) or step.products[0] in unfinished]
    if options.dry_run:
        for step in missing:
            print(step.text(options.data))
        return 0
    code = 0
    for number, step in enumerate(missing, 1):
        lacking = [name for name in step.needs if not (options.data / name).exists()]
        if lacking:
            print(f"{step.products[0]}: not made: {lacking[0]} is missing; add it to --only", file=sys.stderr)
            code = max(code, 1)
            continue
        print(f"[{number}/{len(missing)}] about {step.cost}: {step.text(options.data)}", file=sys.stderr, flush=True)
        _write_unfinished(options.data, unfinished | {step.products[0]})
        result = _run(step, options.data)
        if result not in (0, 1):
            resume = f"orbitproof figures data {options.data}"
            print(f"{step.products[0]}: the command ended with code {result}; go on with: {resume}", file=sys.stderr)
            return INTERRUPTED if result == INTERRUPTED else 2
        unfinished.discard(step.products[0])
        _write_unfinished(options.data, unfinished)
        code = max(code, result)
        if _is_missing(step, options.data):
            print(f"{step.products[0]}: the command wrote no such file", file=sys.stderr)
            code = max(code, 1)
    return code


def _run(step: Step, folder: Path) -> int:
    """The exit code of the step's command, run in a process of its own with the same messages."""
    words = [sys.executable, "-m", "orbitproof", *step.words(folder)]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, env=bound_to_this()) as process:
        try:
            return process.wait()
        except KeyboardInterrupt:
            # The command saves what it has. In a terminal it got Ctrl-C too; then this changes nothing.
            process.terminate()
            process.wait()
            return INTERRUPTED


def _is_missing(step: Step, folder: Path) -> bool:
    return not all((folder / name).exists() for name in step.products)


def _read_unfinished(folder: Path) -> set[str]:
    """First products of the steps that were begun and not ended: their files are there, but not whole."""
    path = folder / _UNFINISHED
    return set(path.read_text("utf-8").split()) if path.exists() else set()


def _write_unfinished(folder: Path, names: set[str]) -> None:
    path = folder / _UNFINISHED
    if names:
        write_text(path, "".join(f"{name}\n" for name in sorted(names)))
    else:
        path.unlink(missing_ok=True)
