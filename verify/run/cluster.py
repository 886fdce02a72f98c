"""The engine that hands tasks to a cluster: what passes is JSON text, as between processes of this machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

from orbitproof.shared import cluster
from orbitproof.shared.processes import Progress, Source
from orbitproof.verify.evidence import software
from orbitproof.verify.run.processes import Finished, Work, as_text, hand_over, on_text


@dataclass(frozen=True)
class Cluster:
    """The workers of a dask scheduler; they report finished tasks only."""

    workers: cluster.Cluster

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """See `processes.Engine.run`; there is no progress within a task."""
        hand_over(self.workers.answers(partial(_without_reports, work), as_text(source)), finished)


def _without_reports(work: Work, argument: str) -> str:
    return on_text(work, argument, lambda fraction, label: None)


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """The cluster whose scheduler listens at `address`, as long as the body runs; see `shared.cluster.connected`."""
    with cluster.connected(address, software) as workers:
        yield Cluster(workers)
