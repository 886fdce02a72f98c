"""Progress on standard error: a bar with a time estimate in a terminal, a line per stage elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from types import TracebackType
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from orbitproof.shared.answers import tell
from orbitproof.shared.printed_tables import BAR_WIDTH, shortened, wrapped
from orbitproof.shared.printing import printable

_REFRESH_SECONDS = 0.1


class Reporter:
    """Messages and progress of one command; everything goes to standard error.

    A context manager. With `quiet` nothing but `error` writes.
    """

    def __init__(self, quiet: bool = False) -> None:
        self._quiet = quiet
        self._console = Console(stderr=True, highlight=False, soft_wrap=True)
        self._live = not quiet and self._console.is_terminal
        self._stage = ""
        self._task: TaskID | None = None
        self._drawn = 0.0
        self._progress = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=BAR_WIDTH),
            TextColumn("{task.percentage:>3.0f}%"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=self._console,
            transient=True,
            redirect_stdout=False,
            # Drawn when something is reported, without a thread of its own, so that processes can be copies of this
            # one (shared.processes).
            auto_refresh=False,
            disable=not self._live,
        )

    def __enter__(self) -> Reporter:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def stage(self, name: str) -> None:
        """Begin a stage of unknown length."""
        self._stage = name
        if self._live:
            if self._task is not None:
                self._progress.remove_task(self._task)
            self._task = self._progress.add_task(shortened(name), total=None)
            self._progress.refresh()
        else:
            self.message(f"{name} ...")

    def update(self, detail: str, fraction: float | None) -> None:
        """Show how far the stage is: `fraction` 0 to 1, or `None` where nobody knows."""
        if self._task is None:
            return
        whole = printable(f"{self._stage}: {detail}" if detail else self._stage)
        description = shortened(whole, printable(detail))
        if fraction is None:
            self._progress.update(self._task, description=description)
        else:
            self._progress.update(self._task, description=description, total=1.0, completed=fraction)
        if time.monotonic() - self._drawn >= _REFRESH_SECONDS:
            self._progress.refresh()
            self._drawn = time.monotonic()

    def message(self, text: str) -> None:
        """A line for information; none with `quiet`."""
        if not self._quiet:
            self.error(text)

    def tell(self, lines: Sequence[str], result: Any) -> None:
        """A result on standard output as soon as it is there, with what it says for programs; also with `quiet`."""
        self._progress.stop()
        tell(wrapped(lines), [result])
        self._progress.start()

    def error(self, text: str) -> None:
        """A line that is written even with `quiet`."""
        if self._live:
            self._console.print(wrapped([printable(text)]), markup=False)
        else:
            print(wrapped([text]) if sys.stderr.isatty() else text, file=sys.stderr, flush=True)
