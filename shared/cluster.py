"""The workers of a dask scheduler, through dask.distributed (an optional extra), for tasks of the search and of proofs.

What they compute is taken as if it were computed here, so they have to run exactly this software. A worker with several
threads is no danger: in each process one task runs at a time, because the precision of Arb is global to it.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from orbitproof.shared.formats import ArgumentError
from orbitproof.shared.processes import Answer, Failure, Source, Task

Software = Callable[[], Mapping[str, str]]
"""Names and versions of what computes, where it is called."""

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

    def __init__(self, client: Any, software: Software) -> None:
        """`client` is a `distributed.Client`; see `connected`."""
        self._client = client
        self._software = software

    def answers(self, work: Callable[[Any], Any], source: Source) -> Generator[Answer, None, None]:
        """Do what `source` gives until it gives nothing and all is answered, in the order in which answers are had.

        `work` is a function of a module; it and what passes can be pickled. `source` is asked again after each answer.
        """
        completed = import_module("distributed").as_completed(loop=self._client.loop)
        open_tasks: dict[Any, tuple[Task, float]] = {}
        try:
            while True:
                room = _TASKS_PER_WORKER * len(self._client.nthreads())
                while len(open_tasks) < max(1, room) and (task := source()) is not None:
                    future = self._client.submit(run_on_worker, work, self._software, task.argument, pure=False)
                    open_tasks[future] = (task, time.monotonic())
                    completed.add(future)
                if not open_tasks:
                    return
                future = next(completed)
                task, started = open_tasks.pop(future)
                result = self._result(future)
                # What is not released the cluster keeps, and computes again if it is lost.
                future.release()
                yield Answer(task, result, time.monotonic() - started)
        finally:
            self._client.cancel(list(open_tasks))

    def _result(self, future: Any) -> Any | Failure:
        try:
            software, result = future.result()
        except Exception as error:
            return Failure("process", f"the cluster has no result for it ({type(error).__name__})")
        # Workers may join during a run.
        if software != self._software():
            return Failure("process", "a worker of the cluster has another version of the software")
        return result


def run_on_worker(work: Callable[[Any], Any], software: Software, argument: Any) -> tuple[Mapping[str, str], Any]:
    """Do a task in a process of the cluster: what software did it, and the result."""
    with _one_task:
        return software(), work(argument)


@contextmanager
def connected(address: str, software: Software) -> Iterator[Cluster]:
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
        _check(client, address, software)
        yield Cluster(client, software)
    finally:
        client.close()


def _check(client: Any, address: str, software: Software) -> None:
    try:
        versions: Mapping[str, Mapping[str, str]] = client.run(software)
    except Exception as error:
        raise ArgumentError(
            "{scheduler} {0}: a worker cannot run this software ({1}); install orbitproof where the workers run",
            address,
            type(error).__name__,
        ) from None
    if not versions:
        raise ArgumentError("{scheduler} {0}: has no workers; start some with: dask worker {0}", address)
    here = software()
    for worker, version in versions.items():
        for name in sorted({*here, *version}):
            if here.get(name) != version.get(name):
                raise ArgumentError(
                    "{scheduler} {0}: worker {1} has {2} {3}, here it is {4}; install the same version everywhere",
                    *(address, worker, name, version.get(name), here.get(name)),
                )
