"""Certification of several candidates in worker processes.

The precision of Arb is global to a process, so rows run side by side only in processes of their own. Even
one row at a time has a process: FLINT ends the process if memory is short, and a step that takes too long
can only be ended with it. Processes are started afresh (no fork) and get and return JSON text.
"""

from __future__ import annotations

import json
import multiprocessing
import signal
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from shared.formats import Candidate, candidate_from_json
from verify.certificate import Certificate
from verify.certify import Limits, broken_off, certify, not_proved
from verify.outcome import Reason
from verify.recheck import Finding, Recheck, recheck

_REPORT_SECONDS = 0.25
_PATIENCE_SECONDS = 2.0
_START_SECONDS = 20.0
GRACE_SECONDS = 2.0
"""A row that has come to its time limit may take so long to hand over what it has; then its process is ended."""

Progress = Callable[[str, float, str], None]
"""Called with a candidate's id, the fraction of its current attempt, and a word on it."""
Finished = Callable[[Certificate], None]


def certify_all(
    candidates: Sequence[Candidate], limits: Limits, jobs: int, progress: Progress, finished: Finished
) -> None:
    """Certify every candidate and hand each certificate to `finished`, in the order in which they are done.

    A row takes at most the time limit and `GRACE_SECONDS`; what became of a process that was ended, or that
    ended by itself, is the reason of its row.
    """
    waiting = deque(candidates)
    workers: dict[int, _Worker] = {}
    with _stopping(workers):
        for _ in range(min(jobs, len(candidates))):
            _start(workers, waiting.popleft(), limits)
        while workers:
            for connection in wait([worker.connection for worker in workers.values()], _REPORT_SECONDS):
                number, worker = next((n, w) for n, w in workers.items() if w.connection is connection)
                try:
                    message: Mapping[str, Any] = json.loads(worker.connection.recv())
                except (EOFError, OSError):
                    worker.process.join(_PATIENCE_SECONDS)
                    _replace(workers, number, waiting, limits, finished, _lost(worker))
                    continue
                if "begun" in message:
                    worker.begin(limits)
                elif "fraction" in message:
                    progress(worker.candidate.id, message["fraction"], message["label"])
                else:
                    certificate = _certificate(worker, message)
                    if waiting:
                        worker.give(waiting.popleft(), limits)
                    else:
                        del workers[number]
                        worker.connection.close()
                        worker.process.join(_PATIENCE_SECONDS)
                    finished(certificate)
            for number, worker in list(workers.items()):
                if worker.deadline is not None and time.monotonic() > worker.deadline:
                    worker.process.kill()
                    worker.process.join(_PATIENCE_SECONDS)
                    _replace(workers, number, waiting, limits, finished, _too_slow(worker, limits))


def recheck_all(
    certificates: Sequence[Certificate],
    integrate: bool,
    jobs: int,
    progress: Progress,
    finished: Callable[[Recheck], None],
) -> None:
    """Check every certificate again and hand each `Recheck` to `finished`, as they are done."""
    jobs = min(jobs, len(certificates))
    if jobs <= 1:
        for entry in certificates:
            report = _for_row(progress, entry["id"])
            finished(recheck(entry, integrate, partial(_labelled, report)))
        return
    context = multiprocessing.get_context("spawn")
    # Ctrl-C reaches every process of the terminal; it ends those of the pool at once.
    with ProcessPoolExecutor(jobs, context, signal.signal, (signal.SIGINT, signal.SIG_DFL)) as pool:
        tasks = {pool.submit(recheck, entry, integrate): entry for entry in certificates}
        try:
            for task in as_completed(tasks):
                entry = tasks[task]
                try:
                    finished(task.result())
                except BrokenProcessPool:
                    finding = Finding("process", "a process that checked certificates ended; give fewer --jobs")
                    finished(Recheck(entry["id"], entry["verdict"], 0, (finding,)))
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _labelled(report: Callable[[float, str], None], fraction: float) -> None:
    report(fraction, "integrating again")


def _for_row(progress: Progress, name: str) -> Callable[[float, str], None]:
    return lambda fraction, label: progress(name, fraction, label)


@dataclass
class _Worker:
    """A process and the candidate that it checks; the deadline counts from when it says that it has begun."""

    process: BaseProcess
    connection: Connection
    candidate: Candidate
    started: float = 0.0
    deadline: float | None = None

    def give(self, candidate: Candidate, limits: Limits) -> None:
        """Send a task."""
        self.candidate = candidate
        self.begin(limits, _START_SECONDS)
        # If the process has died meanwhile, the next look at the connection says so.
        task = {"candidate": candidate.to_json(provenance=False), "limits": asdict(limits)}
        with suppress(OSError):
            self.connection.send(json.dumps(task))

    def begin(self, limits: Limits, delay: float = 0.0) -> None:
        """Start the clock, `delay` seconds from now."""
        self.started = time.monotonic()
        if limits.timeout is not None:
            self.deadline = self.started + delay + limits.timeout + GRACE_SECONDS


def _replace(
    workers: dict[int, _Worker],
    number: int,
    waiting: deque[Candidate],
    limits: Limits,
    finished: Finished,
    certificate: Certificate,
) -> None:
    """Put a new process in the place of one that is gone, and hand over what became of its row."""
    del workers[number]
    if waiting:
        _start(workers, waiting.popleft(), limits)
    finished(certificate)


def _start(workers: dict[int, _Worker], candidate: Candidate, limits: Limits) -> None:
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there,), daemon=True)
    with _holding_interrupts():
        process.start()
    there.close()
    worker = _Worker(process, here, candidate)
    worker.give(candidate, limits)
    workers[max(workers, default=0) + 1] = worker


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


def _certificate(worker: _Worker, message: Mapping[str, Any]) -> Certificate:
    if "certificate" in message:
        certificate: Certificate = message["certificate"]
        return certificate
    return _not_proved(worker, Reason(**message["reason"]))


def _lost(worker: _Worker) -> Certificate:
    code = worker.process.exitcode
    message = f"the process that checked it ended before it was done (exit code {code})"
    return _not_proved(worker, Reason("process", message, "free memory, or give fewer --jobs or --max-precision less"))


def _too_slow(worker: _Worker, limits: Limits) -> Certificate:
    message = f"the time limit of {limits.timeout:g} s passed within one step; the process was ended"
    return _not_proved(worker, Reason("time", message, "give --row-timeout more seconds or --max-precision less"))


def _not_proved(worker: _Worker, reason: Reason) -> Certificate:
    return not_proved(worker.candidate, reason, time.monotonic() - worker.started)


def _serve(connection: Connection) -> None:
    """The work of one process: tasks in, progress and certificates out, until the other end closes."""
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
            task = json.loads(connection.recv())
            connection.send(json.dumps({"begun": True}))
            connection.send(_answer(task, report))
    except (EOFError, OSError):
        return


def _answer(task: Mapping[str, Any], report: Callable[[float, str], None]) -> str:
    """The certificate, or why there is none, as text."""
    try:
        candidate = candidate_from_json(task["candidate"], "candidate")
        return json.dumps({"certificate": certify(candidate, Limits(**task["limits"]), report)})
    except Exception as error:
        return json.dumps({"reason": asdict(broken_off("verification", error))})
