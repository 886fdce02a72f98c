"""Refining the located bifurcations to high precision, several at a time in processes of their own."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from explore.refine import RefinementFailure, refine
from shared.formats import Candidate
from shared.systems import SYSTEMS

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Task:
    """One point to refine; the fields are those of `explore.refine.refine` and of a candidate.

    Attributes:
        id: of the candidate.
        system: a key of `shared.systems.SYSTEMS`.
        guess: float64 point, in the order of `ReversibleSystem.centre_coordinates`.
        provenance: free-form, for the candidate.
    """

    id: str
    system: str
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    symmetry: str | None
    guess: tuple[float, ...]
    digits: int
    provenance: Mapping[str, Any]


@dataclass(frozen=True)
class Refined:
    """The result of a task: a candidate with its level (first integral or family parameter), or a reason."""

    task: Task
    candidate: Candidate | None
    level: Fraction | None
    failure: str | None
    seconds: float


def refine_task(task: Task, progress: Progress | None = None) -> Refined:
    """Refine one point; a failure is a result, not an exception."""
    started = time.monotonic()
    try:
        point = refine(
            SYSTEMS[task.system], task.parameters, task.kind, task.k, task.guess,
            digits=task.digits, symmetry=task.symmetry, progress=progress,
        )  # fmt: skip
    except RefinementFailure as error:
        return Refined(task, None, None, str(error), time.monotonic() - started)
    except (ArithmeticError, ValueError) as error:
        # One point on which the arithmetic breaks down must not lose the others.
        reason = f"the arithmetic broke down ({type(error).__name__}: {error})"
        return Refined(task, None, None, reason, time.monotonic() - started)
    level = point.first_integral if point.first_integral is not None else point.centre[0]
    return Refined(task, point.to_candidate(task.id, task.provenance), level, None, time.monotonic() - started)


def _work(index: int, task: Task) -> tuple[int, Refined]:
    return index, refine_task(task)


def _leave_interrupts_to_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def refine_tasks(tasks: Sequence[Task], jobs: int, progress: Progress) -> Iterator[tuple[int, Refined]]:
    """Refine all tasks with `jobs` processes; yields (index, result) in the order of completion.

    `progress` is called with a message and the fraction of all tasks done. Closing the iterator,
    or an exception in its consumer, ends the processes.
    """
    total = len(tasks)
    if jobs <= 1 or total <= 1:
        for index, task in enumerate(tasks):
            result = refine_task(
                task,
                lambda message, part, index=index, id=task.id: progress(f"{id}, {message}", (index + part) / total),
            )
            yield index, result
        return
    # Started afresh, not forked: JAX runs threads.
    with multiprocessing.get_context("spawn").Pool(min(jobs, total), _leave_interrupts_to_parent) as pool:
        pending = [pool.apply_async(_work, (index, task)) for index, task in enumerate(tasks)]
        progress(f"0 of {total}", 0.0)
        while pending:
            ready = [job for job in pending if job.ready()]
            pending = [job for job in pending if job not in ready]
            for job in ready:
                index, result = job.get()
                progress(f"{total - len(pending)} of {total}", (total - len(pending)) / total)
                yield index, _with_own_system(result)
            if pending and not ready:
                pending[0].wait(0.1)


def _with_own_system(result: Refined) -> Refined:
    """The system of a candidate that came through a pipe is a copy: put this process's own in its place."""
    if result.candidate is None:
        return result
    return replace(result, candidate=replace(result.candidate, system=SYSTEMS[result.task.system]))
