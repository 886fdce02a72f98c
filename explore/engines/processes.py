"""Work on several items side by side, in processes of their own, with progress and a gentle end.

Processes are started afresh, not forked: JAX runs threads. An interrupt does not kill them at once:
their next report of progress raises `KeyboardInterrupt` there, so that they can hand back what they have.
"""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Generic, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

Progress = Callable[[str, float], None]
"""Called with what is being done and the fraction done, 0 to 1."""

GRACE_SECONDS = 20.0
"""How long an interrupted process may take to hand back its result."""

_REPORT_SECONDS = 0.1


@dataclass(frozen=True)
class Lost:
    """In place of a result: the process ended before its work was done."""

    reason: str


@dataclass(frozen=True)
class Job(Generic[Item, Result]):
    """What to do with every item.

    Attributes:
        work: a module-level function of the item and a `Progress`; it may catch `KeyboardInterrupt`.
        name: of an item, for the progress display.
        last: whether a result is one after which nothing further should be started (an interrupted one).
    """

    work: Callable[[Item, Progress], Result]
    name: Callable[[Item], str]
    last: Callable[[Result], bool] = field(default=lambda _result: False)


def run_all(
    job: Job[Item, Result], items: Sequence[Item], jobs: int, progress: Progress
) -> Iterator[tuple[int, Result | Lost]]:
    """Work on all items, at most `jobs` at a time; yields (index, result) in the order of completion.

    `progress` gets a message and the fraction of all items done. After an interrupt the results that
    can still be had are yielded, then `KeyboardInterrupt` is raised. An exception of `work` is raised here.
    Closing the iterator ends the processes.
    """
    if jobs > 1 and len(items) > 1:
        yield from _in_processes(job, items, min(jobs, len(items)), progress)
        return
    for index, item in enumerate(items):
        result = job.work(item, _share(progress, job.name(item), index, len(items)))
        yield index, result
        if job.last(result):
            return


def _share(progress: Progress, name: str, index: int, total: int) -> Progress:
    return lambda message, part: progress(f"{name}: {message}" if message else name, (index + part) / total)


@dataclass
class _Worker:
    process: BaseProcess
    connection: Connection
    index: int


class _Team(Generic[Item, Result]):
    """The processes of one `run_all`, seen from the one that started them."""

    def __init__(self, job: Job[Item, Result], items: Sequence[Item]) -> None:
        self.context = multiprocessing.get_context("spawn")
        self.stop = self.context.Event()
        self.job, self.items = job, items
        self.waiting = deque(range(len(items)))
        self.workers: list[_Worker] = []

    def start(self) -> None:
        here, there = self.context.Pipe()
        process = self.context.Process(target=_serve, args=(there, self.job.work, self.stop), daemon=True)
        process.start()
        there.close()
        worker = _Worker(process, here, -1)
        self.workers.append(worker)
        self.assign(worker)

    def assign(self, worker: _Worker) -> None:
        """Give a worker its next item, or dismiss it."""
        if self.waiting:
            worker.index = self.waiting.popleft()
            with suppress(OSError):  # a worker that has died is noticed when it is waited for
                worker.connection.send(self.items[worker.index])
            return
        self.workers.remove(worker)
        worker.connection.close()
        worker.process.join(1.0)

    def lose(self, worker: _Worker) -> Lost:
        worker.process.join(1.0)
        self.workers.remove(worker)
        if self.waiting:
            self.start()
        return Lost(f"its process ended before it was done (exit code {worker.process.exitcode}); try again")

    def end(self) -> None:
        for worker in self.workers:
            worker.process.terminate()
        for worker in self.workers:
            worker.process.join(2.0)


def _in_processes(
    job: Job[Item, Result], items: Sequence[Item], jobs: int, progress: Progress
) -> Iterator[tuple[int, Result | Lost]]:
    team = _Team(job, items)
    fractions = [0.0] * len(items)
    deadline: float | None = None
    try:
        for _ in range(jobs):
            team.start()
        while team.workers and (deadline is None or time.monotonic() < deadline):
            try:
                ready = wait([worker.connection for worker in team.workers], 0.5)
                for worker in [worker for worker in team.workers if worker.connection in ready]:
                    index = worker.index
                    try:
                        kind, content = worker.connection.recv()
                    except (EOFError, OSError):
                        yield index, team.lose(worker)
                        continue
                    if kind == "progress":
                        message, fractions[index] = content
                        progress(_share_name(job, items[index], message), sum(fractions) / len(items))
                        continue
                    fractions[index] = 1.0
                    progress(job.name(items[index]), sum(fractions) / len(items))
                    if kind == "result" and job.last(content):
                        team.waiting.clear()
                    team.assign(worker)
                    if kind == "error":
                        raise content
                    if kind == "result":
                        yield index, content
            except KeyboardInterrupt:
                if deadline is not None:
                    raise
                # The workers are asked to come to an end, and what they still hand back is kept.
                deadline = time.monotonic() + GRACE_SECONDS
                team.waiting.clear()
                team.stop.set()
        if deadline is not None:
            raise KeyboardInterrupt
    finally:
        team.end()


def _share_name(job: Job[Item, Any], item: Item, message: str) -> str:
    return f"{job.name(item)}: {message}" if message else job.name(item)


def _serve(connection: Connection, work: Callable[[Any, Progress], Any], stop: Any) -> None:
    """The life of one process: items in, progress and results out, until the other end closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    last = 0.0

    def report(message: str, fraction: float) -> None:
        nonlocal last
        if stop.is_set():
            raise KeyboardInterrupt
        now = time.monotonic()
        if now - last >= _REPORT_SECONDS:
            last = now
            connection.send(("progress", (message, fraction)))

    try:
        while True:
            item = connection.recv()
            try:
                connection.send(("result", work(item, report)))
            except KeyboardInterrupt:
                connection.send(("cancelled", None))
            except Exception as error:
                connection.send(("error", error))
    except (EOFError, OSError):
        return
