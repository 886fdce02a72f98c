"""Commands in this process, and in processes of their own that tests send signals to."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from unittest import mock

from orbitproof.__main__ import main

ROOT = Path(__file__).resolve().parents[2]
SEES_PROCESSES = Path("/proc/self/task").exists()
_PATIENCE_SECONDS = 120.0


def done_here(words: Sequence[str]) -> int:
    """The exit code of ``orbitproof`` with these words, run in this process: what it compiles is compiled once."""
    with mock.patch.object(sys, "argv", ["orbitproof", *words]), mock.patch.dict(os.environ):
        try:
            return main()
        except SystemExit as end:
            return int(end.code or 0)


@contextmanager
def started(
    words: Sequence[str], sigint: Any = signal.default_int_handler, program: str = sys.executable, **options: Any
) -> Iterator[Any]:
    """A process of Python, or another program, in a process group of its own that is ended whatever happens.

    Signals work in it also where they are ignored in the tests (Ctrl-C in the background of a script, SIGHUP under
    nohup); `sigint` may be `signal.SIG_IGN`.
    """
    handling = {signal.SIGINT: sigint, signal.SIGHUP: signal.SIG_DFL, signal.SIGTERM: signal.SIG_DFL}
    before = {number: signal.signal(number, handler) for number, handler in handling.items()}
    try:
        run = subprocess.Popen(
            [program, *words], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            start_new_session=True, **options,
        )  # fmt: skip
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    with run:
        try:
            yield run
        finally:
            with suppress(ProcessLookupError):
                os.killpg(run.pid, signal.SIGKILL)


def wait_until(condition: Callable[[], Any], patience: float = _PATIENCE_SECONDS) -> Any:
    """What `condition` gives once it is true; fails if that takes so many seconds."""
    deadline = time.monotonic() + patience
    while not (result := condition()):
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.05)
    return result


def untimed(path: Path) -> Any:
    """What a file of certificates says, without times, and digests, which are of the times too."""

    def without(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: without(entry) for key, entry in value.items() if key not in ("seconds", "digest")}
        return [without(entry) for entry in value] if isinstance(value, list) else value

    return without(json.loads(path.read_text()))


def children(process: int, word: str) -> list[int]:
    """Its children whose command line contains the word."""
    numbers = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    return [int(number) for number in numbers if word in _command_line(number)]


def workers(process: int) -> list[int]:
    """The worker processes of a command: fresh ones, or copies of it."""
    copies = children(process, _command_line(process))
    return [*children(process, "spawn_main"), *copies]


def is_running(process: int) -> bool:
    """Whether the process exists and is no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def _command_line(number: int | str) -> str:
    try:
        return Path(f"/proc/{number}/cmdline").read_text()
    except OSError:
        return ""
