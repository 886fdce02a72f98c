"""Work for processes, in a module that is quick to import: each process imports it afresh."""

from __future__ import annotations

import os
import time

from orbitproof.explore.engines.processes import Progress


def squared(item: int, progress: Progress) -> int:
    """Its square, with a report half way."""
    progress("half way", 0.5)
    return item * item


def dying(item: int, progress: Progress) -> int:
    """Item 1 ends its process."""
    if item == 1:
        os._exit(3)
    return item


def endless(item: int, progress: Progress) -> int:
    """Works until it is stopped, then hands back what it has."""
    steps = 0
    try:
        while True:
            time.sleep(0.02)
            steps += 1
            progress("working", 0.1)
    except KeyboardInterrupt:
        return steps


def name_of(item: int) -> str:
    """For the progress display."""
    return f"item {item}"
