"""Where tasks are done, and what they and checks may take, whatever a file says."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass
from typing import Any, TypeVar

from orbitproof.shared.processes import Failure, Report, Task, answers
from orbitproof.verify.run.processes import Engine, engine_of

Result = TypeVar("Result")

GIBIBYTE = 2**30
CHECK_SECONDS = 300.0
"""A check without integration takes so long at most if nothing else is said; it takes seconds."""
LONG_CHECK_SECONDS = 3600.0
"""Seconds for a curve or surface: its intervals are put together, and all resonances on it are looked for."""

INTEGRATION_SECONDS = 4 * 3600.0
"""Seconds for an integration again, of each row or each interval of a piece: the slowest that we know take minutes."""


@dataclass(frozen=True)
class CheckLimits:
    """What the check of one certificate may take; it has a process of its own, which is ended there.

    Attributes:
        timeout: seconds of processor time, or `None`: `INTEGRATION_SECONDS` for an integration, else `usual`.
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


def apart(work: Callable[..., Result], name: str, arguments: tuple[Any, ...], limits: CheckLimits) -> Result | Failure:
    """Do a check that does not integrate in a process of its own; its result, or why there is none."""
    tasks = iter([Task(name, (work, arguments))])
    found = answers(
        _called, lambda: next(tasks, None), lambda *_: None, 1, limits.without_integration, memory=limits.memory
    )
    with closing(found):
        (answer,) = found
    result: Result | Failure = answer.result
    return result


def _called(task: tuple[Callable[..., Any], tuple[Any, ...]], report: Report) -> Any:
    """A check without integration reports nothing."""
    work, arguments = task
    return work(*arguments)


@dataclass(frozen=True)
class Workplace:
    """Where tasks are done, and what they may take.

    Attributes:
        jobs: processes side by side on this machine.
        scheduler: address of a dask scheduler, whose cluster does the proofs in their place; or `None`.
        timeout: seconds of processor time for one task or one check; `None` for what is usual.
        memory: bytes of each check beyond what its process begins with.
        quiet: whether nothing is shown on standard error.
    """

    jobs: int = 1
    scheduler: str | None = None
    timeout: float | None = None
    memory: int = CheckLimits.memory
    quiet: bool = False

    def engine(self, timeout: float | None, memory: int | None = None) -> AbstractContextManager[Engine]:
        """What does tasks of this time, as long as the body runs."""
        return engine_of(self.scheduler, self.jobs, timeout, memory)

    @property
    def row_checks(self) -> CheckLimits:
        """Limits of the check of a row."""
        return CheckLimits(self.timeout, self.memory, CHECK_SECONDS)

    @property
    def branch_checks(self) -> CheckLimits:
        """Limits of the check of a curve or surface, and of each of its bifurcations."""
        return CheckLimits(self.timeout, self.memory, LONG_CHECK_SECONDS)
