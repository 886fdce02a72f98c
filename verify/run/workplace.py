"""Where tasks are done, and what they may take."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass

from orbitproof.verify.run.checks import CHECK_SECONDS, LONG_CHECK_SECONDS, CheckLimits
from orbitproof.verify.run.cluster import engine_of
from orbitproof.verify.run.processes import Engine


@dataclass(frozen=True)
class Workplace:
    """Where tasks are done, and what they may take.

    Attributes:
        jobs: processes side by side on this machine.
        scheduler: address of a dask scheduler, whose cluster does the proofs in their place; or `None`.
        timeout: seconds for one task or one check; `None` for what is usual.
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
