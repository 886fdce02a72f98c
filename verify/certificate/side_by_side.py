"""Certification of several candidates, and checks of several certificates, side by side."""

from __future__ import annotations

import multiprocessing
import signal
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from functools import partial
from typing import Any

from orbitproof.shared.formats import Candidate, candidate_from_json
from orbitproof.verify.certificate.certificate import Certificate
from orbitproof.verify.certificate.certify import Limits, broken_off, certify, not_proved
from orbitproof.verify.certificate.rechecking import Finding, Recheck, recheck
from orbitproof.verify.engines import Answer, Failure, Processes, Progress, Report, Task
from orbitproof.verify.evidence import Reason

Finished = Callable[[Certificate], None]


def certify_all(
    candidates: Sequence[Candidate], limits: Limits, jobs: int, progress: Progress, finished: Finished
) -> None:
    """Certify every candidate and hand each certificate to `finished`, in the order in which they are done.

    A row takes at most the time limit and `engines.GRACE_SECONDS`; what became of a process that was ended, or
    that ended by itself, is the reason of its row.
    """
    known = {candidate.id: candidate for candidate in candidates}
    waiting = deque(candidates)

    def source() -> Task | None:
        if not waiting:
            return None
        candidate = waiting.popleft()
        return Task(candidate.id, {"candidate": candidate.to_json(provenance=False), "limits": asdict(limits)})

    def answered(answer: Answer) -> None:
        finished(_certificate(known[answer.task.name], answer))

    Processes(jobs, limits.timeout).run(certify_task, source, progress, answered)


def certify_task(argument: Mapping[str, Any], report: Report) -> Mapping[str, Any]:
    """What one process does: the certificate, or why there is none."""
    try:
        candidate = candidate_from_json(argument["candidate"], "candidate")
        return {"certificate": certify(candidate, Limits(**argument["limits"]), report)}
    except Exception as error:
        return {"reason": asdict(broken_off("verification", error))}


_REMEDIES = {
    "process": "free memory, or give fewer --jobs or --max-precision less",
    "time": "give --row-timeout more seconds or --max-precision less",
}


def _certificate(candidate: Candidate, answer: Answer) -> Certificate:
    if isinstance(answer.result, Failure):
        reason = Reason(answer.result.kind, answer.result.message, _REMEDIES[answer.result.kind])
        return not_proved(candidate, reason, answer.seconds)
    if "certificate" in answer.result:
        certificate: Certificate = answer.result["certificate"]
        return certificate
    return not_proved(candidate, Reason(**answer.result["reason"]), answer.seconds)


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
