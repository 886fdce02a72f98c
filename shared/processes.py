"""Tasks in processes of this machine, side by side.

A process has one task at a time: the precision of Arb is global to it, FLINT ends it if memory is short, and a step
that takes too long can only be ended with it. Processes are started afresh, and forked only by a process that has a
single thread (`_start_method`): JAX runs many. Each has
a pipe of its own, so that nothing it held when it was lost keeps the others waiting, and its end is the failure of
its own task; `pebble` gives up all tasks if one process ends before it has a task (`BrokenProcessPool`), has no
reports from inside a task, and its processes outlive a parent that was killed.

These processes hear no signal that ends a run (see `shared.interrupts`): the one that started them ends them, and
when that is gone, they end by themselves.

A limit of memory counts what a process takes beyond what it has at its start. Where it is met, Python raises
`MemoryError`, and FLINT and GMP end the process: both are the failure of one task. Systems that know no such limit
(`resource.RLIMIT_DATA`, which Linux has) do without.
"""

from __future__ import annotations

import atexit
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from types import ModuleType
from typing import Any, Literal

from orbitproof.shared.allowance import Allowance
from orbitproof.shared.interrupts import ENDING_SIGNALS, held_back

GRACE_SECONDS = 2.0
"""A task that has come to its time limit may take so long to hand over what it has; then its process is ended.
Limits of tasks are of processor time (`shared.allowance`)."""

_REPORT_SECONDS = 0.2
_START_SECONDS = 20.0
_END_SECONDS = 5.0
_WORKER = "orbitproof-worker"
_STOP: tuple[Any, ...] = ()
"""In place of a task, which comes as a tuple of one."""

Report = Callable[[float, str], None]
"""Called with the fraction of the task that is done, and a word on it."""
Work = Callable[[Any, Report], Any]
"""What is done in another process: a function of a module; its argument and its result can be pickled."""


@dataclass(frozen=True)
class Task:
    """An argument of the work, and the name by which progress on it is reported."""

    name: str
    argument: Any


@dataclass(frozen=True)
class Failure:
    """Why a task has no result, in words without remedy.

    Its process was lost or the work raised an exception (`error`), the process was ended at the time limit, or it
    asked for more memory than it may have.
    """

    kind: Literal["process", "time", "memory"]
    message: str
    error: Exception | None = None


@dataclass(frozen=True)
class Answer:
    """A task with its result, or with the reason why there is none, and the seconds since it began."""

    task: Task
    result: Any | Failure
    seconds: float


Source = Callable[[], Task | None]
"""Called when a process is free: the next task, or `None` if there is none until another one is answered."""
Progress = Callable[[str, float, str], None]
"""Called with a task's name, the fraction of it that is done, and a word on it."""


def answers(
    work: Work,
    source: Source,
    progress: Progress,
    jobs: int,
    timeout: float | None = None,
    patience: float = 0.0,
    memory: int | None = None,
) -> Generator[Answer, None, None]:
    """Do what `source` gives with at most `jobs` processes, until it gives nothing and all is answered.

    Answers come in the order in which they are had. `source` is asked for the next task before the consumer sees an
    answer, so that no process waits for it, and again after it. A task takes at most `timeout` and `GRACE_SECONDS` of
    processor time, and a process at most `memory` bytes more than it begins with.

    After an interrupt the tasks at hand are told to come to an end: their next report raises `KeyboardInterrupt`
    there, and what they hand back within `patience` seconds is yielded. Then `KeyboardInterrupt` is raised. However
    it ends, no process is left.
    """
    workers: list[_Worker] = []
    give_up: float | None = None

    def assign() -> None:
        """Tasks for the processes that have none, and new processes for more."""
        for worker in workers:
            if worker.task is None and (task := source()) is not None:
                worker.give(task)
        while len(workers) < jobs and (task := source()) is not None:
            worker = _Worker(work, timeout, memory)
            workers.append(worker)
            worker.give(task)

    try:
        while True:
            found: list[Answer] = []
            try:
                if give_up is None:
                    assign()
                if all(worker.task is None for worker in workers) or (give_up and time.monotonic() > give_up):
                    break
                ready = wait([worker.connection for worker in workers], _REPORT_SECONDS)
                for worker in list(workers):
                    answer = worker.hear(progress) if worker.connection in ready else worker.overdue()
                    if answer is not None:
                        found.append(answer)
                    if worker.is_over:
                        workers.remove(worker)
                if found and give_up is None:
                    assign()
            except KeyboardInterrupt:
                if give_up is not None:
                    raise
                give_up = time.monotonic() + patience
                for worker in workers:
                    worker.stop()
            yield from found
    finally:
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join(_END_SECONDS)
    if give_up is not None:
        raise KeyboardInterrupt


@contextmanager
def _without_main() -> Iterator[None]:
    """Without a main module, so that a process that is started meanwhile does not run the user's script again.

    The work is a function of a module that can be imported. A script, a notebook, ``python -c`` and standard input
    are all the same then, with and without ``if __name__ == "__main__"``.
    """
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _start_method() -> str:
    """How a process is started: a copy of this one if nothing else runs in it, else a fresh one.

    A copy has everything imported. It is safe where there is a single thread, counted by the system, so that threads of
    libraries count as well: no lock can be held by a thread that the copy does not have.
    """
    try:
        alone = sys.platform == "linux" and len(os.listdir("/proc/self/task")) == 1
    except OSError:
        alone = False
    return "fork" if alone else "spawn"


class _Worker:
    """A process, seen from the one that started it; its time counts from when the task has begun there."""

    def __init__(self, work: Work, timeout: float | None, memory: int | None) -> None:
        context: Any = multiprocessing.get_context(_start_method())
        self.connection, there = context.Pipe()
        self.process = context.Process(target=_serve, args=(there, work, memory), daemon=True, name=_WORKER)
        with held_back(), _without_main():
            self.process.start()
        there.close()
        self.task: Task | None = None
        self.is_over = False
        self._timeout, self._memory = timeout, memory
        self._started = 0.0
        self._allowance: Allowance | None = None

    def give(self, task: Task) -> None:
        """Send a task."""
        self.task = task
        self._begin(_START_SECONDS)
        # If the process has died meanwhile, the next look at the connection says so.
        with suppress(OSError):
            self.connection.send((task.argument,))

    def _begin(self, delay: float) -> None:
        self._started = time.monotonic()
        if self._timeout is not None:
            self._allowance = Allowance(int(self.process.pid or 0), delay + self._timeout + GRACE_SECONDS)

    def stop(self) -> None:
        """Have its next report raise `KeyboardInterrupt`."""
        with suppress(OSError):
            self.connection.send(_STOP)

    def hear(self, progress: Progress) -> Answer | None:
        """Take its next message; the answer to its task if that is it."""
        try:
            kind, content = self.connection.recv()
        except (EOFError, OSError):
            self.process.join(_END_SECONDS)
            self.is_over = True
            code = self.process.exitcode
            text = f"its process ended before it was done (exit code {code}{_signal_name(code)})"
            return self._answer(Failure("process", text))
        if kind == "begun":
            self._begin(0.0)
        elif kind == "report":
            if self.task is not None:
                progress(self.task.name, *content)
        elif kind == "error" and isinstance(content, MemoryError) and self._memory is not None:
            return self._answer(Failure("memory", out_of_memory(self._memory), content))
        elif kind == "error":
            message = " ".join(f"broke off: {type(content).__name__}: {content}".split())
            return self._answer(Failure("process", message, content))
        elif kind == "result":
            return self._answer(content)
        else:
            self.task = None
        return None

    def overdue(self) -> Answer | None:
        """If the time limit has passed, end the process; the answer is that."""
        if self.task is None or self._allowance is None or not self._allowance.is_over():
            return None
        self.process.kill()
        self.process.join(_END_SECONDS)
        self.is_over = True
        text = f"the time limit of {self._timeout:g} s passed within one step; the process was ended"
        return self._answer(Failure("time", text))

    def _answer(self, result: Any | Failure) -> Answer | None:
        task, self.task = self.task, None
        return None if task is None else Answer(task, result, time.monotonic() - self._started)


def _signal_name(code: int | None) -> str:
    """Which signal ended a process: a library that gives up does so by SIGABRT."""
    with suppress(ValueError):
        return f", {signal.Signals(-code).name}" if code is not None and code < 0 else ""
    return ""


def out_of_memory(memory: int) -> str:
    """What is said of a task that needs more than so many bytes."""
    return f"it needs more memory than {memory / 2**30:g} GiB"


def _limit_memory(memory: int) -> None:
    """Give this process and those it starts at most so many bytes more; no memory is written to disk at its end."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        limit = _data_bytes() + memory
        if most != resource.RLIM_INFINITY:
            limit = min(limit, most)
        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))


def _data_bytes() -> int:
    """What this process has of the memory that `RLIMIT_DATA` counts; a copy of another one has all of that."""
    with suppress(OSError), open("/proc/self/status", encoding="ascii") as lines:
        return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmData:"))
    return 0


def _serve(connection: Connection, work: Work, memory: int | None) -> None:
    """The life of a worker: tasks in, reports and results out, until the other end closes."""
    if memory is not None:
        _limit_memory(memory)
    for number in ENDING_SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    last = 0.0

    def report(fraction: float, label: str) -> None:
        nonlocal last
        # While a task is worked on, nothing but `_STOP` is sent.
        if connection.poll():
            raise KeyboardInterrupt
        now = time.monotonic()
        if now - last >= _REPORT_SECONDS:
            last = now
            connection.send(("report", (fraction, label)))

    with suppress(EOFError, OSError):
        while message := connection.recv():
            (argument,) = message
            connection.send(("begun", None))
            try:
                answer = ("result", work(argument, report))
            except KeyboardInterrupt:
                answer = ("stopped", None)
            except Exception as error:
                answer = ("error", _portable(error))
            connection.send(answer)


def _portable(error: Exception) -> Exception:
    """The exception, or one that says the same if it does not survive a pipe."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


@atexit.register
def _leave_no_worker() -> None:
    """Before multiprocessing asks them by SIGTERM, which they do not hear, and waits."""
    for process in multiprocessing.active_children():
        if process.name == _WORKER:
            process.kill()
