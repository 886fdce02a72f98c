"""The engine that hands tasks to a cluster: what passes is JSON text, as between processes of this machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial

from orbitproof.shared import cluster
from orbitproof.shared.processes import Progress, Source
from orbitproof.verify.evidence import software
from orbitproof.verify.run.processes import Engine, Finished, Processes, Work, as_text, hand_over, on_text


@dataclass(frozen=True)
class Cluster:
    """The workers of a dask scheduler; they report finished tasks only."""

    workers: cluster.Cluster

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """See `processes.Engine.run`; there is no progress within a task."""
        hand_over(self.workers.answers(partial(_without_reports, work), as_text(source)), finished)


def _without_reports(work: Work, argument: str) -> str:
    return on_text(work, argument, lambda fraction, label: None)


def engine_of(
    scheduler: str | None, jobs: int, timeout: float | None, memory: int | None = None
) -> AbstractContextManager[Engine]:
    """The cluster of a scheduler if its address is given, otherwise processes of this machine."""
    return nullcontext(Processes(jobs, timeout, memory)) if scheduler is None else connected(scheduler)


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """The cluster whose scheduler listens at `address`, as long as the body runs; see `shared.cluster.connected`."""
    with cluster.connected(address, software) as workers:
        yield Cluster(workers)
