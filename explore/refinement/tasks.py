"""Refining the located bifurcations to high precision, several at a time in processes of their own."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from operator import attrgetter
from typing import Any

from orbitproof.explore.engines import Job, Lost, Progress, run_all
from orbitproof.explore.refinement.breaking import refine_breaking
from orbitproof.explore.refinement.double_resonance import refine_double_resonance
from orbitproof.explore.refinement.krein import refine_collision
from orbitproof.explore.refinement.newton import RefinementFailure, refine
from orbitproof.shared.formats import DOUBLE_RESONANCE, KREIN_COLLISION, REVERSOR_BREAKING, Candidate
from orbitproof.shared.systems import ReversibleSystem

_ONE_POINT = {REVERSOR_BREAKING: refine_breaking, KREIN_COLLISION: refine_collision}


@dataclass(frozen=True)
class Task:
    """One point to refine; the fields are those of `explore.refinement.newton.refine` and of a candidate.

    Attributes:
        id: of the candidate.
        guess: float64 point, in the order of `ReversibleSystem.centre_coordinates`.
        provenance: free-form, for the candidate.
        work: a measure of how long it takes.
    """

    id: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    symmetry: str | None
    guess: tuple[float, ...]
    digits: int
    provenance: Mapping[str, Any]
    crossings: int = 1
    work: float = 1.0


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
        double = partial(refine_double_resonance, k=task.k)
        refined_alone = double if task.kind == DOUBLE_RESONANCE else _ONE_POINT.get(task.kind)
        if refined_alone is not None:
            candidate = refined_alone(
                task.system,
                task.parameters,
                task.guess,
                digits=task.digits,
                crossings=task.crossings,
                id=task.id,
                provenance=task.provenance,
                progress=progress,
            )
            return Refined(task, candidate, candidate.centre[0], None, time.monotonic() - started)
        point = refine(
            task.system,
            task.parameters,
            task.kind,
            task.k,
            task.guess,
            digits=task.digits,
            symmetry=task.symmetry,
            crossings=task.crossings,
            progress=progress,
        )
    except RefinementFailure as error:
        return Refined(task, None, None, str(error), time.monotonic() - started)
    except (ArithmeticError, ValueError) as error:
        # One point on which the arithmetic breaks down must not lose the others.
        reason = f"the arithmetic broke down ({type(error).__name__}: {error})"
        return Refined(task, None, None, reason, time.monotonic() - started)
    level = point.first_integral if point.first_integral is not None else point.centre[0]
    candidate = point.to_candidate(task.id, {**task.provenance, "level": decimal(level, task.digits)})
    return Refined(task, candidate, level, None, time.monotonic() - started)


def decimal(value: Fraction, digits: int) -> str:
    """A number in decimal notation, rounded to `digits` places."""
    scaled = round(value * 10**digits)
    whole, part = divmod(abs(scaled), 10**digits)
    return f"{'-' if scaled < 0 else ''}{whole}.{part:0{digits}d}"


def refine_tasks(tasks: Sequence[Task], jobs: int, progress: Progress) -> Iterator[tuple[int, Refined]]:
    """Refine all tasks with `jobs` processes; yields (index, result) in the order of completion.

    Of several processes none shall wait long for the last one: they begin with the tasks of most work. `progress` is
    called with a message and the fraction of all tasks done.
    """
    order = sorted(range(len(tasks)), key=lambda index: -tasks[index].work if jobs > 1 else index)
    for place, result in run_all(Job(refine_task, attrgetter("id")), [tasks[index] for index in order], jobs, progress):
        index = order[place]
        if isinstance(result, Lost):
            yield index, Refined(tasks[index], None, None, result.reason, 0.0)
        else:
            yield index, result
