"""How much time a process may take for a task: processor time, which does not depend on what else the machine does."""

from __future__ import annotations

import sys
import time

_LONGEST_LOOK = 1.0
"""Seconds that count at most between two looks: whoever looks may have been stopped, and the process with it."""


def processor_seconds(process: int) -> float | None:
    """What a process here has used of the processors; `None` where the system does not tell, or it is gone."""
    if sys.platform != "linux":
        return None
    try:
        # The clock of a process by its number, as clock_getcpuclockid gives it.
        return time.clock_gettime((~process << 3) | 2)
    except OSError:
        return None


class Allowance:
    """The time for one task of a process.

    What counts is processor time. A process that uses none at all, because it waits for something that does not come,
    is over after so many seconds without any; so is every process where the system does not tell what one has used.
    """

    def __init__(self, process: int, seconds: float) -> None:
        """The time begins now; `seconds` is how much there is."""
        self._process, self._seconds = process, seconds
        self._first = self._last = processor_seconds(process)
        self._looked, self._idle = time.monotonic(), 0.0

    def is_over(self) -> bool:
        """To be asked every now and then."""
        used, now = processor_seconds(self._process), time.monotonic()
        self._idle += min(now - self._looked, _LONGEST_LOOK)
        self._looked = now
        if used is None or self._first is None:
            return self._idle > self._seconds
        if used != self._last:
            self._last, self._idle = used, 0.0
        return used - self._first > self._seconds or self._idle > self._seconds
