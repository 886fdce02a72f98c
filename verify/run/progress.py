"""What people see of a run: progress with a time estimate on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

from orbitproof.shared.printed_tables import BAR_WIDTH, shortened, wrapped
from orbitproof.shared.printing import printable
from orbitproof.shared.systems import ID, fits, shown

if TYPE_CHECKING:
    from rich.progress import Progress


class Display:
    """Progress of a run, on stderr: a bar on a terminal, a line for each finished row elsewhere."""

    def __init__(self, work: Mapping[str, float], quiet: bool) -> None:
        """`work` is a measure of the work for each row, by its name."""
        self._weights = dict(work)
        self._fractions = dict.fromkeys(self._weights, 0.0)
        self._done = 0
        self._start = time.monotonic()
        self._quiet = quiet
        self._bar: Progress | None = None

    @contextmanager
    def shown(self) -> Iterator[Display]:
        """Show progress while the body runs."""
        if self._quiet or not sys.stderr.isatty() or not self._weights:
            yield self
            return
        # A twentieth of a second to load, for terminals alone.
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        columns = (
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=BAR_WIDTH),
            TextColumn("{task.percentage:>3.0f}%"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        console = Console(stderr=True, highlight=False, soft_wrap=True)
        # Drawn when something is reported, without a thread of its own, so that processes can be copies of this one.
        with Progress(*columns, console=console, transient=True, auto_refresh=False) as bar:
            bar.add_task("verify", total=sum(self._weights.values()))
            self._bar = bar
            try:
                yield self
            finally:
                self._bar = None

    def advance(self, name: str, fraction: float, label: str) -> None:
        """A row has come so far in its current attempt."""
        self._fractions[name] = min(max(fraction, 0.0), 1.0)
        self._refresh(f"{_shown(name)} ({label})")

    def finish(self, name: str, word: str) -> None:
        """A row is finished, with this outcome."""
        self._fractions[name] = 1.0
        self._done += 1
        line = f"[{self._done}/{len(self._weights)}] {_shown(name)}: {word}"
        if self._bar is None and self._done < len(self._weights):
            line += f"; about {self._remaining():.0f} s left"
        self.message(line)
        self._refresh(_shown(name))

    def message(self, text: str) -> None:
        """A message on stderr, unless quiet."""
        if self._quiet:
            return
        if self._bar is not None:
            self._bar.console.print(wrapped([printable(text)]), markup=False)
        else:
            print(text, file=sys.stderr, flush=True)

    def _work_done(self) -> float:
        return sum(weight * self._fractions[name] for name, weight in self._weights.items())

    def _remaining(self) -> float:
        done = self._work_done()
        return (time.monotonic() - self._start) * (sum(self._weights.values()) - done) / done if done else 0.0

    def _refresh(self, description: str) -> None:
        if self._bar is not None:
            self._bar.update(
                self._bar.task_ids[0], completed=self._work_done(), description=shortened(description), refresh=True
            )


def _shown(name: str) -> str:
    """An id as tables have it; names of intervals, which are no ids, as they are."""
    return shown(name) if fits(ID, name) else name
