"""The engine that hands tasks to a cluster, through dask.distributed (an optional extra).

What the workers of the cluster compute goes into a certificate as if it were computed here, so they have to run
exactly this software. A worker with several threads is no danger: in each process one task runs at a time,
because the precision of Arb is global to it.
"""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from importlib import import_module
from typing import Any

from orbitproof.shared.formats import ArgumentError
from orbitproof.shared.processes import Answer, Failure, Progress, Source, Task
from orbitproof.verify.evidence import installed
from orbitproof.verify.run.processes import Engine, Finished, Processes, Work, on_text

_CONNECT_SECONDS = 10
_TASKS_PER_WORKER = 2
"""Tasks that a worker has at most, so that it need not wait for the next one."""

_ADDRESS = re.compile(r"((tcp|tls|ws|wss|ucx)://)?(\[[0-9a-fA-F:]+\]|[^\s/:]+):[0-9]{1,5}")

_one_task = threading.Lock()


class Cluster:
    """The workers of a dask scheduler.

    Tasks are not ended by force here: a worker's own time limit has to do. A worker that dies has its tasks given to
    others a few times.
    """

    def __init__(self, client: Any) -> None:
        """`client` is a `distributed.Client`; see `connected`."""
        self._client = client

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """See `engines.Engine.run`; there is no progress within a task."""
        completed = import_module("distributed").as_completed(loop=self._client.loop)
        open_tasks: dict[Any, tuple[Task, float]] = {}
        try:
            while True:
                room = _TASKS_PER_WORKER * len(self._client.nthreads())
                while len(open_tasks) < max(1, room) and (task := source()) is not None:
                    future = self._client.submit(run_on_worker, work, json.dumps(task.argument), pure=False)
                    open_tasks[future] = (task, time.monotonic())
                    completed.add(future)
                if not open_tasks:
                    return
                future = next(completed)
                task, started = open_tasks.pop(future)
                result = _result(future)
                # What is not released the cluster keeps, and computes again if it is lost.
                future.release()
                finished(Answer(task, result, time.monotonic() - started))
        finally:
            self._client.cancel(list(open_tasks))


def run_on_worker(work: Work, argument: str) -> str:
    """Do a task in a process of the cluster; text in, text out."""
    with _one_task:
        return json.dumps({"software": installed(), "result": on_text(work, argument, _no_report)})


def _no_report(fraction: float, label: str) -> None:
    """A cluster reports finished tasks only."""


def _result(future: Any) -> Mapping[str, Any] | Failure:
    try:
        answer: Mapping[str, Any] = json.loads(future.result())
    except Exception as error:
        return Failure("process", f"the cluster has no result for it ({type(error).__name__})")
    # Workers may join during a run.
    if answer["software"] != installed():
        return Failure("process", "a worker of the cluster has another version of the software")
    result: Mapping[str, Any] = json.loads(answer["result"])
    return result


def engine_of(
    scheduler: str | None, jobs: int, timeout: float | None, memory: int | None = None
) -> AbstractContextManager[Engine]:
    """The cluster of a scheduler if its address is given, otherwise processes of this machine."""
    return nullcontext(Processes(jobs, timeout, memory)) if scheduler is None else connected(scheduler)


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """The cluster whose scheduler listens at `address`, as long as the body runs.

    Raises `InputError` if dask.distributed is not installed, no scheduler answers, there is no worker, or a worker
    has another version of the software.
    """
    if _ADDRESS.fullmatch(address) is None:
        raise ArgumentError("{scheduler} {0}: not an address; give HOST:PORT or tcp://HOST:PORT", address)
    try:
        distributed = import_module("distributed")
    except ImportError:
        raise ArgumentError(
            "{scheduler}: dask.distributed is not installed; install orbitproof[cluster], or use {jobs} instead"
        ) from None
    try:
        client = distributed.Client(address, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ArgumentError("{scheduler} {0}: {1}; give the address of a dask scheduler", address, reason) from None
    try:
        _check(client, address)
        yield Cluster(client)
    finally:
        client.close()


def _check(client: Any, address: str) -> None:
    try:
        versions: Mapping[str, Mapping[str, str]] = client.run(installed)
    except Exception as error:
        raise ArgumentError(
            "{scheduler} {0}: a worker cannot run the verifier ({1}); install orbitproof where the workers run",
            address,
            type(error).__name__,
        ) from None
    if not versions:
        raise ArgumentError("{scheduler} {0}: has no workers; start some with: dask worker {0}", address)
    here = installed()
    for worker, version in versions.items():
        for name in sorted({*here, *version}):
            if here.get(name) != version.get(name):
                raise ArgumentError(
                    "{scheduler} {0}: worker {1} has {2} {3}, here it is {4}; install the same version everywhere",
                    *(address, worker, name, version.get(name), here.get(name)),
                )
