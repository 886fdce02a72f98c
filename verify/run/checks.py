"""Limits of a check: how long it may take and how much memory it may have, whatever the file says."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from orbitproof.shared.processes import Failure, Report, Task, answers

GIBIBYTE = 2**30
CHECK_SECONDS = 300.0
"""A check without integration takes so long at most if nothing else is said; it takes seconds."""
LONG_CHECK_SECONDS = 3600.0
"""The same of a curve or surface: its intervals are put together, and all resonances on it are looked for."""

INTEGRATION_SECONDS = 4 * 3600.0
"""The same of an integration again, for each row or each interval of a piece: the slowest that we know take minutes."""


@dataclass(frozen=True)
class CheckLimits:
    """What the check of one certificate may take; it has a process of its own, which is ended there.

    Attributes:
        timeout: seconds, or `None`: `INTEGRATION_SECONDS` for an integration, and `usual` without one.
        memory: bytes beyond what the process begins with.
        usual: seconds for a check that does not integrate.
    """

    timeout: float | None = None
    memory: int = 4 * GIBIBYTE
    usual: float = CHECK_SECONDS

    def __post_init__(self) -> None:
        if self.timeout is not None and not 0 < self.timeout < 1e9:
            raise ValueError(f"timeout: {self.timeout!r} is not a positive number of seconds")
        if not 0 < self.memory < 2**60:
            raise ValueError(f"memory: {self.memory!r} is not a possible number of bytes")

    @property
    def with_integration(self) -> float:
        """Seconds for an integration."""
        return INTEGRATION_SECONDS if self.timeout is None else self.timeout

    @property
    def without_integration(self) -> float:
        """Seconds for a check that does not integrate."""
        return self.usual if self.timeout is None else self.timeout


def apart(work: Callable[[Any, Report], Any], name: str, argument: Any, limits: CheckLimits) -> Any | Failure:
    """Do a check that does not integrate in a process of its own; its result, or why there is none."""
    tasks = iter([Task(name, argument)])
    with closing(
        answers(work, lambda: next(tasks, None), _unheard, 1, limits.without_integration, memory=limits.memory)
    ) as found:
        (answer,) = found
    return answer.result


def _unheard(name: str, fraction: float, label: str) -> None:
    """A check without integration reports nothing."""
