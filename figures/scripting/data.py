"""The data files of the pictures for scripts and notebooks, each made by its own command."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from orbitproof.figures.collection import STEPS, Step
from orbitproof.figures.scripting.written import Source, Told, Written, folder_of, quietly
from orbitproof.shared.formats import select_ids, write_text
from orbitproof.shared.interrupts import INTERRUPTED, bound_to_this

_UNFINISHED = "unfinished.txt"


@dataclass(frozen=True)
class Made:
    """What became of the data files that were missing.

    Attributes:
        paths: the files that were made.
        not_made: why, by the name of the file.
        incomplete: names of files whose command did not find or prove everything.
        failed: whether a command failed; none is run after it.
    """

    paths: tuple[Path, ...]
    not_made: Mapping[str, str]
    incomplete: tuple[str, ...]
    failed: bool


def make_data(data: Source, *, only: Sequence[str] | None = None, told: Told = quietly, quiet: bool = False) -> Made:
    """The data files of the pictures that are missing in a folder (docs/figures.md), each made by its own command.

    A file that is there is not made again; what was interrupted goes on where it stopped. The search and the proof run
    as processes of their own; all steps together take about an hour and a half on two processors.

    Arguments:
        data: folder of data files, created if need be.
        only: names of files, with * and ?; by default all.
        quiet: nothing on standard error but what is not made.

    Raises `KeyboardInterrupt` if a command was interrupted.
    """
    missing, folder = missing_steps(data, only), folder_of(data)
    unfinished, written = _read_unfinished(folder), Written(told)
    not_made, incomplete, failed = dict[str, str](), list[str](), False
    for number, step in enumerate(missing, 1):
        name, result = step.products[0], 0
        lacking = [need for need in step.needs if not (folder / need).exists()]
        if lacking:
            not_made[name] = f"not made: {lacking[0]} is missing; ask for it as well"
        else:
            if not quiet:
                line = f"[{number}/{len(missing)}] about {step.cost}: {step.text(folder)}"
                print(line, file=sys.stderr, flush=True)
            _write_unfinished(folder, unfinished | {name})
            result = _run(step, folder, quiet)
            failed = result not in (0, 1)
            if failed:
                resume = f"orbitproof figures data {folder}"
                not_made[name] = f"the command ended with code {result}; go on with: {resume}"
            else:
                unfinished.discard(name)
                _write_unfinished(folder, unfinished)
                incomplete += [name] if result else []
                if _is_missing(step, folder):
                    not_made[name] = "the command wrote no such file"
                else:
                    written.add(folder / product for product in step.products)
        if name in not_made:
            print(f"{name}: {not_made[name]}", file=sys.stderr)
        if result == INTERRUPTED:
            raise KeyboardInterrupt
        if failed:
            break
    return Made(tuple(written.paths), not_made, tuple(incomplete), failed)


def missing_steps(data: Source, only: Sequence[str] | None) -> list[Step]:
    """The steps that are still to be run, in order; raises `InputError` for a name that is no data file."""
    known = [name for step in STEPS for name in step.products]
    chosen, folder = set(select_ids(known, None if only is None else list(only), "data file")), folder_of(data)
    steps, unfinished = [step for step in STEPS if chosen.intersection(step.products)], _read_unfinished(folder)
    return [step for step in steps if _is_missing(step, folder) or step.products[0] in unfinished]


def _run(step: Step, folder: Path, quiet: bool) -> int:
    """The exit code of the step's command, run in a process of its own with the same messages, or none."""
    words = [sys.executable, "-m", "orbitproof", *step.words(folder)]
    errors = subprocess.DEVNULL if quiet else None
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=errors, env=bound_to_this()) as process:
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
