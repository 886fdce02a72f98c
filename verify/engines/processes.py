"""Engines: where tasks are done side by side, in processes of this machine or on a cluster.

The precision of Arb is global to a process, so no process ever works on two tasks at once. Even one task at
a time has a process: FLINT ends the process if memory is short, and a step that takes too long can only be
ended with it. Processes are started afresh (no fork) and get and return JSON text.
"""

from __future__ import annotations

import json
import multiprocessing
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Literal, Protocol

_REPORT_SECONDS = 0.25
_PATIENCE_SECONDS = 2.0
_START_SECONDS = 20.0
GRACE_SECONDS = 2.0
"""A task that has come to its time limit may take so long to hand over what it has; then its process is ended."""

Report = Callable[[float, str], None]
"""Called with the fraction of the current attempt, and a word on it."""
Work = Callable[[Mapping[str, Any], Report], Mapping[str, Any]]
"""What is done in another process: a function of a module, from a JSON object to a JSON object."""


@dataclass(frozen=True)
class Task:
    """An argument of the work, and the name by which progress on it is reported."""

    name: str
    argument: Mapping[str, Any]


@dataclass(frozen=True)
class Failure:
    """Why a task has no result: its process was lost, or was ended at the time limit; in words without remedy."""

    kind: Literal["process", "time"]
    message: str


@dataclass(frozen=True)
class Answer:
    """A task with its result, or with the reason why there is none, and the seconds since it began."""

    task: Task
    result: Mapping[str, Any] | Failure
    seconds: float


Source = Callable[[], Task | None]
"""Called when a process is free: the next task, or `None` if there is none until another one is answered."""
Progress = Callable[[str, float, str], None]
"""Called with a task's name, the fraction of its current attempt, and a word on it."""
Finished = Callable[[Answer], None]


class Engine(Protocol):
    """Something that does tasks side by side."""

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """Do what `source` gives until it gives nothing and all is answered.

        Each answer goes to `finished`, in the order in which they come. `source` may be asked for the next task
        before that, and is asked again after it.
        """


@dataclass(frozen=True)
class Processes:
    """At most `jobs` processes of this machine.

    A task takes at most `timeout` and `GRACE_SECONDS`; what became of a process that was ended, or that ended by
    itself, is the `Failure` of its task.
    """

    jobs: int = 1
    timeout: float | None = None

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """See `Engine.run`."""
        workers: dict[int, _Worker] = {}

        def start(task: Task) -> None:
            workers[max(workers, default=0) + 1] = _start(work, task, self.timeout)

        def lost(number: int, failure: Failure) -> None:
            worker = workers.pop(number)
            following = source()
            if following is not None:
                start(following)
            finished(worker.answer(failure))

        with _stopping(workers):
            while True:
                while len(workers) < self.jobs and (task := source()) is not None:
                    start(task)
                if not workers:
                    return
                for connection in wait([worker.connection for worker in workers.values()], _REPORT_SECONDS):
                    number, worker = next((n, w) for n, w in workers.items() if w.connection is connection)
                    try:
                        message: Mapping[str, Any] = json.loads(worker.connection.recv())
                    except (EOFError, OSError):
                        worker.process.join(_PATIENCE_SECONDS)
                        code = worker.process.exitcode
                        text = f"the process that checked it ended before it was done (exit code {code})"
                        lost(number, Failure("process", text))
                        continue
                    if "begun" in message:
                        worker.begin()
                    elif "fraction" in message:
                        progress(worker.task.name, message["fraction"], message["label"])
                    else:
                        # The process goes on with the next task while this answer is taken care of.
                        answer = worker.answer(message["result"])
                        following = source()
                        if following is not None:
                            worker.give(following)
                        finished(answer)
                        if following is None:
                            following = source()
                            if following is not None:
                                worker.give(following)
                            else:
                                del workers[number]
                                worker.connection.close()
                                worker.process.join(_PATIENCE_SECONDS)
                for number, worker in list(workers.items()):
                    if worker.deadline is not None and time.monotonic() > worker.deadline:
                        worker.process.kill()
                        worker.process.join(_PATIENCE_SECONDS)
                        text = f"the time limit of {self.timeout:g} s passed within one step; the process was ended"
                        lost(number, Failure("time", text))


@dataclass
class _Worker:
    """A process and its task; the deadline counts from when the process says that it has begun."""

    process: BaseProcess
    connection: Connection
    task: Task
    timeout: float | None
    started: float = 0.0
    deadline: float | None = None

    def give(self, task: Task) -> None:
        """Send a task."""
        self.task = task
        self.begin(_START_SECONDS)
        # If the process has died meanwhile, the next look at the connection says so.
        with suppress(OSError):
            self.connection.send(json.dumps(task.argument))

    def begin(self, delay: float = 0.0) -> None:
        """Start the clock, `delay` seconds from now."""
        self.started = time.monotonic()
        if self.timeout is not None:
            self.deadline = self.started + delay + self.timeout + GRACE_SECONDS

    def answer(self, result: Mapping[str, Any] | Failure) -> Answer:
        """The answer to the current task."""
        return Answer(self.task, result, time.monotonic() - self.started)


def _start(work: Work, task: Task, timeout: float | None) -> _Worker:
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there, work), daemon=True)
    with _holding_interrupts():
        process.start()
    there.close()
    worker = _Worker(process, here, task, timeout)
    worker.give(task)
    return worker


@contextmanager
def _holding_interrupts() -> Iterator[None]:
    """Keep Ctrl-C back; a process that is started meanwhile never sees it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _stopping(workers: Mapping[int, _Worker]) -> Iterator[None]:
    """Leave no worker behind, whatever happens."""
    try:
        yield
    finally:
        for worker in workers.values():
            worker.process.terminate()
        for worker in workers.values():
            worker.process.join(_PATIENCE_SECONDS)


def _serve(connection: Connection, work: Work) -> None:
    """The life of one process: tasks in, progress and results out, until the other end closes."""
    # Ctrl-C reaches every process of the terminal; only the parent reacts, and stops its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    last = 0.0

    def report(fraction: float, label: str) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _REPORT_SECONDS:
            last = now
            connection.send(json.dumps({"fraction": fraction, "label": label}))

    try:
        while True:
            argument = json.loads(connection.recv())
            connection.send(json.dumps({"begun": True}))
            connection.send(json.dumps({"result": work(argument, report)}))
    except (EOFError, OSError):
        return
