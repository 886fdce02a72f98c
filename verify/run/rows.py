"""Certification of several candidates, and checks of several certificates, side by side."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from orbitproof.shared.formats import (
    ArgumentError,
    BoxClaim,
    InputError,
    candidate_to_json,
    check_writable,
    claim_from_json,
)
from orbitproof.shared.processes import answers
from orbitproof.verify.attempt import Limits, first_precision
from orbitproof.verify.certificate import (
    Certificate,
    Recheck,
    broken_off,
    not_checked,
    not_proved,
    read_certificates,
    repeated,
    write_certificates,
)
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.certificate.levels import not_finished
from orbitproof.verify.evidence import Reason, software
from orbitproof.verify.run import (
    Answer,
    CheckLimits,
    Display,
    Engine,
    Failure,
    Processes,
    Progress,
    Report,
    Task,
    Workplace,
)
from orbitproof.verify.run.other_boxes import answers as is_answered
from orbitproof.verify.run.other_boxes import certify_on_some_box

Finished = Callable[[Certificate], None]

_USUAL = CheckLimits()


def certify_all(
    candidates: Sequence[BoxClaim],
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
    # Once, here: processes are copies of this one.
    for candidate in candidates:
        kind_of(candidate)
    software()
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


def expected_work(candidate: BoxClaim, limits: Limits) -> float:
    """What a proof takes, in units that do not matter: one integration more for each crossing."""
    return float(candidate.crossings * candidate.k * first_precision(candidate, limits.digits) ** 2)


class RowRun:
    """The certificates of candidates so far: those of an earlier run that count, and those that are made.

    Attributes:
        selected: the candidates that are asked about.
        certificates: by id; those of other candidates of the same file too, which stay in it.
        kept: ids of the selected that an earlier run proved.
        fresh: ids of those that this run is done with.
    """

    def __init__(
        self,
        everything: Sequence[BoxClaim],
        selected: Sequence[BoxClaim],
        limits: Limits,
        output: Path | None = None,
        again: bool = False,
        replace: bool = False,
    ) -> None:
        """`output` is the file that keeps the certificates of `everything`.

        With `again` all selected are made anew; until one is, the file keeps what it has of it. Raises `InputError` if
        the file cannot be written, or holds something else: with `replace` that is overwritten, else nothing is.
        """
        self.selected = selected
        self._everything, self._limits, self._output = everything, limits, output
        self.certificates: dict[str, Certificate] = {}
        if output is not None:
            check_writable(output)
            if output.is_file():
                self.certificates = _earlier(output, everything, replace)
        earlier = {} if again else self.certificates
        self.kept = frozenset(c.id for c in selected if c.id in earlier and is_answered(earlier[c.id], c))
        self.fresh: set[str] = set()

    @property
    def done(self) -> dict[str, Certificate]:
        """The certificates of those selected that are finished, by id."""
        finished = self.kept | self.fresh
        return {name: certificate for name, certificate in self.certificates.items() if name in finished}

    def prove(self, workplace: Workplace) -> None:
        """Prove what is left; what ends it, an interrupt too, leaves what is done here and in the file."""
        pending = [candidate for candidate in self.selected if candidate.id not in self.kept]
        work = {candidate.id: expected_work(candidate, self._limits) for candidate in pending}
        display = Display(work, workplace.quiet)
        if self.kept:
            count = f"{len(self.kept)} of {len(self.selected)}"
            display.message(f"{count} proved already, kept; a fresh run verifies them again")

        def finished(certificate: Certificate) -> None:
            self.certificates[certificate.id] = certificate
            self.fresh.add(certificate.id)
            self.save()
            display.finish(certificate.id, f"{certificate.verdict}, {certificate.computation.seconds:.1f} s")

        with workplace.engine(self._limits.timeout) as engine, display.shown():
            certify_all(pending, self._limits, workplace.jobs, display.advance, finished, engine)

    def save(self) -> None:
        """Write the file, if there is one."""
        if self._output is not None and self.certificates:
            names = (candidate.id for candidate in self._everything)
            write_certificates(self._output, [self.certificates[n] for n in names if n in self.certificates])


def _earlier(path: Path, candidates: Sequence[BoxClaim], replace: bool) -> dict[str, Certificate]:
    """The certificates of an earlier run. Nothing that belongs to other candidates is overwritten, but to `replace`."""
    try:
        result = read_certificates(path)
    except InputError as error:
        if replace:
            return {}
        raise ArgumentError("{0}; or replace the file with {fresh=True:--fresh}", error) from None
    known = {candidate.id for candidate in candidates}
    foreign = [name for name in result if name not in known]
    if foreign and not replace:
        raise ArgumentError(
            "{0}: holds certificates of other candidates ({1!r}); choose another output, or replace the file with "
            "{fresh=True:--fresh}",
            path,
            foreign[0],
        )
    return result


def certify_task(argument: Mapping[str, Any], report: Report) -> Mapping[str, Any]:
    """What one process does: the certificate, or why there is none."""
    try:
        candidate = claim_from_json(argument["candidate"], "candidate")
        return {"certificate": certify_on_some_box(candidate, Limits(**argument["limits"]), report).document}
    except Exception as error:
        return {"reason": asdict(broken_off("verification", error))}


_REMEDIES = {
    "process": "free memory, or give fewer `jobs` or `max_precision` less",
    "time": "give `timeout` more seconds or `max_precision` less",
    "memory": "give `memory` more",
}


def _certificate(candidate: BoxClaim, answer: Answer) -> Certificate:
    if isinstance(answer.result, Failure):
        reason = Reason(answer.result.kind, answer.result.message, _REMEDIES[answer.result.kind])
        return not_proved(candidate, reason, answer.seconds)
    if "certificate" in answer.result:
        return Certificate.from_json(answer.result["certificate"])
    return not_proved(candidate, Reason(**answer.result["reason"]), answer.seconds)


def rechecks(
    certificates: Sequence[Certificate], integrate: bool, jobs: int, progress: Progress, limits: CheckLimits = _USUAL
) -> Generator[Recheck, None, None]:
    """Check every certificate again: each `Recheck` as soon as it is there.

    Each is checked in a process of its own, within `limits`: what became of a process that was ended, or that ended by
    itself, is why its certificate cannot be checked. With `integrate`, all are first checked without. No process is
    left once the generator is closed. Raises `InputError` if an id appears twice.
    """
    for name in repeated(certificates):
        raise InputError(f"certificates: id {name!r} appears twice; give each certificate once")
    standing: dict[Certificate, Recheck] = {}
    with closing(_checked_apart(certificates, False, jobs, progress, limits)) as found:
        for entry, result in found:
            check = result if isinstance(result, Recheck) else not_checked(entry.id, entry.verdict, result)
            if integrate and check.stands_without_place:
                standing[entry] = check
            else:
                yield check
    with closing(_checked_apart(list(standing), True, jobs, progress, limits)) as found:
        for entry, result in found:
            # What was not brought to an end takes nothing back of what was found before.
            yield result if isinstance(result, Recheck) else not_finished(standing[entry], result)


def _checked_apart(
    certificates: Sequence[Certificate], integrate: bool, jobs: int, progress: Progress, limits: CheckLimits
) -> Generator[tuple[Certificate, Recheck | Failure], None, None]:
    tasks = (Task(entry.id, (entry, integrate)) for entry in certificates)
    timeout = limits.with_integration if integrate else limits.without_integration
    source = partial(next, tasks, None)
    with closing(answers(recheck_task, source, progress, jobs, timeout, memory=limits.memory)) as all_answers:
        for answer in all_answers:
            yield answer.task.argument[0], answer.result


def recheck_task(argument: tuple[Certificate, bool], report: Report) -> Recheck:
    """What one process does."""
    # A proof needs nothing of it.
    from orbitproof.verify.certificate.rechecking import recheck

    return recheck(*argument, partial(_labelled, report))


def _labelled(report: Report, fraction: float) -> None:
    report(fraction, "integrating again")
