"""Certification of several candidates, in this process or in worker processes.

The precision of Arb is global to a process, so rows run side by side only in processes of their own.
These are started afresh (no fork) and get and return JSON text.
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
from verify.certificate import Certificate, make_certificate
from verify.certify import Limits, certify
from verify.outcome import NotProved, Reason
from verify.recheck import Finding, Recheck, recheck

_REPORT_SECONDS = 0.25
_PATIENCE_SECONDS = 2.0
_START_SECONDS = 3.0

Progress = Callable[[str, float, str], None]
"""Called with a candidate's id, the fraction of its current attempt, and a word on it."""
Finished = Callable[[Certificate], None]


def certify_all(
    candidates: Sequence[Candidate], limits: Limits, jobs: int, progress: Progress, finished: Finished
) -> None:
    """Certify every candidate and hand each certificate to `finished`, in the order in which they are done.

    A time limit is kept from outside: only another process can end an integration step that takes too long.
    """
    jobs = min(jobs, len(candidates))
    if jobs > 1 or (jobs == 1 and limits.timeout is not None):
        _in_processes(candidates, limits, jobs, progress, finished)
        return
    for candidate in candidates:
        finished(certify(candidate, limits, _for_row(progress, candidate.id)))


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
    process: BaseProcess
    connection: Connection
    candidate: Candidate
    started: float


def _in_processes(
    candidates: Sequence[Candidate], limits: Limits, jobs: int, progress: Progress, finished: Finished
) -> None:
    waiting = deque(candidates)
    workers: dict[int, _Worker] = {}
    with _stopping(workers):
        for _ in range(jobs):
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
                if "certificate" not in message:
                    progress(worker.candidate.id, message["fraction"], message["label"])
                    continue
                if waiting:
                    worker.candidate, worker.started = waiting.popleft(), time.monotonic()
                    # If the process has died meanwhile, the next look at the connection says so.
                    with suppress(OSError):
                        worker.connection.send(_task(worker.candidate, limits))
                else:
                    del workers[number]
                    worker.connection.close()
                    worker.process.join(_PATIENCE_SECONDS)
                finished(message["certificate"])
            for number, worker in list(workers.items()):
                if limits.timeout is not None and time.monotonic() - worker.started > _longest(limits.timeout):
                    worker.process.kill()
                    worker.process.join(_PATIENCE_SECONDS)
                    _replace(workers, number, waiting, limits, finished, _too_slow(worker, limits.timeout))


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


def _longest(timeout: float) -> float:
    """Seconds after which a process is ended that has not kept the time limit by itself; it takes some to start."""
    return timeout + max(_PATIENCE_SECONDS + _START_SECONDS, timeout / 10)


def _start(workers: dict[int, _Worker], candidate: Candidate, limits: Limits) -> None:
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there,), daemon=True)
    process.start()
    there.close()
    with suppress(OSError):
        here.send(_task(candidate, limits))
    workers[max(workers, default=0) + 1] = _Worker(process, here, candidate, time.monotonic())


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


def _task(candidate: Candidate, limits: Limits) -> str:
    return json.dumps({"candidate": candidate.to_json(provenance=False), "limits": asdict(limits)})


def _lost(worker: _Worker) -> Certificate:
    code = worker.process.exitcode
    message = f"the process that checked it ended before it was done (exit code {code})"
    return _not_proved(worker, Reason("process", message, "free memory or give fewer --jobs"))


def _too_slow(worker: _Worker, timeout: float) -> Certificate:
    message = f"the time limit of {timeout:g} s passed within one step; the process was ended"
    return _not_proved(worker, Reason("time", message, "give --row-timeout more seconds or --max-precision less"))


def _not_proved(worker: _Worker, reason: Reason) -> Certificate:
    seconds = round(time.monotonic() - worker.started, 3)
    computation = {"precision": 0, "order": 0, "steps": 0, "attempts": 1, "seconds": seconds}
    return make_certificate(worker.candidate, NotProved(reason), computation)


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
            candidate = candidate_from_json(task["candidate"], "candidate")
            certificate = certify(candidate, Limits(**task["limits"]), report)
            connection.send(json.dumps({"certificate": certificate}))
    except (EOFError, OSError):
        return
