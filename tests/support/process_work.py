"""Work for processes, in a module that is quick to import: each process imports it afresh."""

from __future__ import annotations

import os
import time
from typing import Any

from flint import fmpz, fmpz_mpoly_ctx

from orbitproof.explore.engines import Progress


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


def hanging(*_: Any) -> None:
    """Does not end, and hears nothing."""
    while True:
        time.sleep(1.0)


def aborting(*_: Any) -> None:
    """What FLINT cannot represent ends the process."""
    x, y = fmpz_mpoly_ctx.get(("x", "y")).gens()
    print((x + y) ** 999_999_999)


def growing(*_: Any) -> None:
    """Takes all memory there is, in Python."""
    held = []
    while True:
        held.append(bytearray(2**24))


def growing_in_flint(*_: Any) -> None:
    """Takes a gibibyte in FLINT."""
    print(len(str(fmpz(2) ** (2**33))))
