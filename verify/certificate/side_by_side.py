"""Certification of several candidates, and checks of several certificates, side by side."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict
from functools import partial
from typing import Any

from orbitproof.shared.formats import Candidate, InputError, candidate_from_json, candidate_to_json
from orbitproof.shared.processes import answers
from orbitproof.verify.certificate.certificate import Certificate, repeated
from orbitproof.verify.certificate.certify import broken_off, certify, not_proved
from orbitproof.verify.certificate.levels import Recheck, not_checked, not_finished
from orbitproof.verify.certificate.rechecking import recheck
from orbitproof.verify.engines import Answer, CheckLimits, Engine, Failure, Processes, Progress, Report, Task
from orbitproof.verify.evidence import Reason
from orbitproof.verify.oracle.precision import Limits, first_precision

Finished = Callable[[Certificate], None]

_USUAL = CheckLimits()


def certify_all(
    candidates: Sequence[Candidate],
    limits: Limits,
    jobs: int,
    progress: Progress,
    finished: Finished,
    engine: Engine | None = None,
) -> None:
    """Certify every candidate and hand each certificate to `finished`, in the order in which they are done.

    They are done by `engine`, or by `jobs` processes of this machine. There a row takes at most the time limit and
    `engines.GRACE_SECONDS`; what became of a process that was ended, or that ended by itself, is the reason of its
    row. Where several are done at a time, those come first that are thought to take longest.
    """
    known = {candidate.id: candidate for candidate in candidates}
    engine = engine or Processes(jobs, limits.timeout)
    waiting = deque(candidates)
    if not isinstance(engine, Processes) or engine.jobs > 1:
        waiting = deque(sorted(candidates, key=lambda row: expected_work(row, limits), reverse=True))

    def source() -> Task | None:
        if not waiting:
            return None
        candidate = waiting.popleft()
        return Task(
            candidate.id, {"candidate": candidate_to_json(candidate, provenance=False), "limits": asdict(limits)}
        )

    def answered(answer: Answer) -> None:
        finished(_certificate(known[answer.task.name], answer))

    engine.run(certify_task, source, progress, answered)


def expected_work(candidate: Candidate, limits: Limits) -> float:
    """What a proof takes, in units that do not matter: one integration more for each crossing."""
    return float(candidate.crossings * candidate.k * first_precision(candidate, limits.digits) ** 2)


def certify_task(argument: Mapping[str, Any], report: Report) -> Mapping[str, Any]:
    """What one process does: the certificate, or why there is none."""
    try:
        candidate = candidate_from_json(argument["candidate"], "candidate")
        return {"certificate": certify(candidate, Limits(**argument["limits"]), report).to_json()}
    except Exception as error:
        return {"reason": asdict(broken_off("verification", error))}


_REMEDIES = {
    "process": "free memory, or give fewer --jobs or --max-precision less",
    "time": "give --row-timeout more seconds or --max-precision less",
    "memory": "give --memory more",
}


def _certificate(candidate: Candidate, answer: Answer) -> Certificate:
    if isinstance(answer.result, Failure):
        reason = Reason(answer.result.kind, answer.result.message, _REMEDIES[answer.result.kind])
        return not_proved(candidate, reason, answer.seconds)
    if "certificate" in answer.result:
        return Certificate.from_json(answer.result["certificate"])
    return not_proved(candidate, Reason(**answer.result["reason"]), answer.seconds)


def recheck_all(
    certificates: Sequence[Certificate],
    integrate: bool,
    jobs: int,
    progress: Progress,
    finished: Callable[[Recheck], None],
    limits: CheckLimits = _USUAL,
) -> None:
    """Check every certificate again and hand each `Recheck` to `finished`, as they are done.

    Each is checked in a process of its own, within `limits`: what became of a process that was ended, or that ended by
    itself, is why its certificate cannot be checked. With `integrate`, all are first checked without.
    Raises `InputError` if an id appears twice.
    """
    for name in repeated(certificates):
        raise InputError(f"certificates: id {name!r} appears twice; give each certificate once")
    standing = []
    for entry, result in _checked_apart(certificates, False, jobs, progress, limits):
        check = result if isinstance(result, Recheck) else not_checked(entry.id, entry.verdict, result)
        if integrate and check.stands_without_place:
            standing.append((entry, check))
        else:
            finished(check)
    concluded = dict(standing)
    for entry, result in _checked_apart(list(concluded), True, jobs, progress, limits):
        # What was not brought to an end takes nothing back of what was found before.
        finished(result if isinstance(result, Recheck) else not_finished(concluded[entry], result))


def _checked_apart(
    certificates: Sequence[Certificate], integrate: bool, jobs: int, progress: Progress, limits: CheckLimits
) -> Iterator[tuple[Certificate, Recheck | Failure]]:
    tasks = (Task(entry.id, (entry, integrate)) for entry in certificates)
    timeout = limits.with_integration if integrate else limits.without_integration
    source = partial(next, tasks, None)
    with closing(answers(recheck_task, source, progress, jobs, timeout, memory=limits.memory)) as all_answers:
        for answer in all_answers:
            yield answer.task.argument[0], answer.result


def recheck_task(argument: tuple[Certificate, bool], report: Report) -> Recheck:
    """What one process does."""
    return recheck(*argument, partial(_labelled, report))


def _labelled(report: Report, fraction: float) -> None:
    report(fraction, "integrating again")
