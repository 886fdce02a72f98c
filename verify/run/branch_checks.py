"""Checks of curves and surfaces, and of places on curves, in processes of their own with limits of time and memory."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace

from orbitproof.shared.formats import AnyAtlas
from orbitproof.shared.systems import shown
from orbitproof.verify.branches import Means, Placed, ProvedBefore, Result, Watch, kind_of, places_on, recheck_place
from orbitproof.verify.branches.interval_proof import prove_task
from orbitproof.verify.certificate import Certificate, Given, Level, Recheck, not_checked, recheck
from orbitproof.verify.certificate.kinds import kind_named
from orbitproof.verify.run import Answer, CheckLimits, Display, Failure, Work, Workplace, apart
from orbitproof.verify.run.branch_tasks import result_of, task_again
from orbitproof.verify.run.rows import rechecks


def examined(
    certificate: Certificate,
    given: Sequence[Certificate],
    integrate: bool,
    workplace: Workplace,
    work: Work = prove_task,
) -> Recheck:
    """The certificate of a branch checked again, up to its conclusion, or with `integrate` to the end.

    `given` are certificates of bifurcations from elsewhere, which have to be those that the file carries.
    """
    # What follows is done here; it takes what this has taken, and integrations have processes of their own.
    concluded = check_apart(certificate, Given(given), workplace.branch_checks)
    if not (integrate and concluded.stands):
        return concluded
    limit = workplace.branch_checks.with_integration

    def prove_again(atlas: AnyAtlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Result], str]) -> None:
        display = Display(dict.fromkeys([each.name for each in intervals], 1.0), workplace.quiet)
        pieces = {each.name: each.piece for each in intervals}
        waiting = deque(task_again(atlas, each, limit) for each in intervals)

        def answered(answer: Answer) -> None:
            display.finish(
                answer.task.name,
                finished(answer.task.name, result_of(answer, pieces[answer.task.name], kind_of(atlas))),
            )

        with workplace.engine(limit, workplace.memory) as engine, display.shown():
            engine.run(work, lambda: waiting.popleft() if waiting else None, display.advance, answered)

    means = Means(
        lambda entries, again: checked_side_by_side(entries, again, workplace), prove_again, watching(workplace.quiet)
    )
    return recheck(certificate, True, given=Given(given, means=means))


def holds_points(certificate: Certificate) -> bool:
    """Whether it is about a branch on which certified orbits may lie, as far as it says."""
    return bool(getattr(kind_named(certificate.kind), "holds_points", False))


def checked_side_by_side(entries: Sequence[Certificate], integrate: bool, workplace: Workplace) -> Sequence[Recheck]:
    """Certificates of bifurcations, checked again, in their order."""
    checks: dict[str, Recheck] = {}
    display = Display({entry.id: 1.0 for entry in entries}, workplace.quiet)
    found = rechecks(entries, integrate, workplace.jobs, display.advance, workplace.branch_checks)
    with display.shown(), closing(found):
        for check in found:
            checks[check.id] = check
            word = "certificate stands" if check.stands_without_place else "certificate does not stand"
            display.finish(check.id, word)
    return [checks[entry.id] for entry in entries]


def watching(quiet: bool) -> Watch:
    """Shows what is done of a conclusion, one after the other: certificates looked for on a curve, parts of a list."""

    @contextmanager
    def shown_while(names: Sequence[str], word: str) -> Iterator[Callable[[str], None]]:
        display, waiting = Display(dict.fromkeys(names, 1.0), quiet), list(names)

        def begin(name: str) -> None:
            # What is passed over was nothing to look at.
            while waiting and waiting[0] != name:
                display.finish(waiting.pop(0), word)
            if waiting:
                display.advance(name, 0.0, word)

        with display.shown():
            yield begin
            begin("")

    return shown_while


def check_apart(certificate: Certificate, given: Given, limits: CheckLimits) -> Recheck:
    """A check that does not integrate in a process of its own; what is not brought to an end cannot be checked."""
    found = apart(recheck, certificate.id, (certificate, False, None, given), limits)
    return not_checked(certificate.id, certificate.verdict, found) if isinstance(found, Failure) else found


def places_on_apart(curve: Certificate, orbits: Sequence[Certificate], limits: CheckLimits) -> list[Placed]:
    """As `places_on`; what is not brought to an end is not shown."""
    name = str(curve.document["id"])
    result = apart(places_on, name, (curve, orbits), limits)
    if isinstance(result, Failure):
        words = f"not shown to lie on {shown(name)}: {result.message}"
        return [Placed(entry.with_place(None), f"{shown(entry.id)}: {words}") for entry in orbits]
    return result


def place_apart(
    curve: Certificate | None,
    examined: Recheck | None,
    certificate: Certificate,
    check: Recheck,
    limits: CheckLimits,
) -> Recheck:
    """As `recheck_place`; what is not brought to an end cannot be checked."""
    if not check.stands_without_place or "place" not in certificate.to_json():
        return check
    result = apart(recheck_place, certificate.id, (curve, examined, certificate, check), limits)
    if isinstance(result, Failure):
        obstacle = not_checked(certificate.id, certificate.verdict, result).obstacle
        return replace(check, obstacle=f"its place: {obstacle}", level=min(check.level, Level.FORM))
    return result


def places_checked(
    curve: Certificate | None,
    certificates: Sequence[Certificate],
    checks: Mapping[str, Recheck],
    integrate: bool,
    workplace: Workplace,
) -> Iterator[Recheck]:
    """The checks of certificates that say where on a curve they lie, with that of the place, one after the other.

    Args:
        curve: the certificate that the places rest on, which is checked as far as the others; without it they cannot
            be checked.
    """
    is_curve = curve is not None and holds_points(curve)
    checked = examined(curve, (), integrate, workplace) if curve is not None and is_curve else None
    for entry in certificates:
        yield place_apart(curve, checked, entry, checks[entry.id], workplace.row_checks)
