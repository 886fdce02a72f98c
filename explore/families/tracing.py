"""Tracing families and finding their resonances, several families at a time in processes of their own."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from operator import attrgetter

from orbitproof.explore.engines import Job, Lost, Progress, run_all
from orbitproof.explore.families.continuation import Family
from orbitproof.explore.families.detection import Detection, detect
from orbitproof.explore.families.first_orbits import first_family
from orbitproof.explore.families.following import FamilyFailure, Following, continue_both_ways, continue_family
from orbitproof.explore.families.limits import Limits
from orbitproof.explore.families.step_control import CONTROL, SAMPLING_TIMEOUT, StepControl
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.seeds import FirstOrbit
from orbitproof.shared.systems import ReversibleSystem

TRACING_SHARE = 0.6
"""Part of the time for a family that goes into tracing it; the rest finds its resonances."""


@dataclass(frozen=True)
class TraceTask:
    """A family to trace, or to continue, and to search.

    Attributes:
        name: of the family in files.
        label: the parameters as the user named them, or "".
        parameters: exact fixed parameters of the system.
        multiplicities: the k to look for.
        folds: whether to look for folds as well.
        start: a part that is traced already, an approximate first orbit, or what traces the family from its birth. The
            last goes to another process.
        both_ways: whether a part is continued at both of its ends.
        of_catalogue: whether that part is a row of a catalogue.
        control: steps and tolerances.
        sampling_timeout: seconds for sampling the stability.
    """

    system: ReversibleSystem
    name: str
    label: str
    parameters: Mapping[str, Fraction]
    limits: Limits
    multiplicities: tuple[int, ...]
    start: Family | FirstOrbit | Callable[[Following], Family]
    folds: bool = False
    both_ways: bool = False
    of_catalogue: bool = False
    control: StepControl = CONTROL
    sampling_timeout: float = SAMPLING_TIMEOUT

    @property
    def title(self) -> str:
        """For messages."""
        return f"{self.label} {self.name}" if self.label else self.name


@dataclass(frozen=True)
class TracedFamily:
    """A family with the name under which it was asked for and what was found on it.

    Attributes:
        branch: which of two mirror images it is, if it is one of two.
    """

    name: str
    label: str
    family: Family
    detection: Detection = field(default_factory=lambda: Detection((), ()))
    branch: str | None = None

    @property
    def system(self) -> ReversibleSystem:
        """The family's system."""
        return self.family.problem.system

    @property
    def title(self) -> str:
        """For messages."""
        return f"{self.label} {self.name}" if self.label else self.name


@dataclass(frozen=True)
class Traced:
    """The result of a task.

    Attributes:
        item: `None` if not even a first orbit was found, or interrupted before.
        failure: why there is no item.
        interrupted: whether the family could be longer, or its resonances were not looked for, because of that.
    """

    task: TraceTask
    item: TracedFamily | None
    failure: str | None
    interrupted: bool
    seconds: float


def trace_task(task: TraceTask, progress: Progress) -> Traced:
    """Trace and search one family; failures and interrupts are results, not exceptions."""
    started = time.monotonic()
    item: TracedFamily | None = None

    def result(failure: str | None = None, interrupted: bool = False) -> Traced:
        return Traced(task, item, failure, interrupted, time.monotonic() - started)

    def tracing(message: str, fraction: float) -> None:
        progress(message, TRACING_SHARE * fraction)

    try:
        start, both_ways = task.start, task.both_ways
        if isinstance(start, FirstOrbit):
            both_ways = start.direction is None
            start = first_family(task.system, task.parameters, start, task.control)
        if isinstance(start, Family):
            go_on = continue_both_ways if both_ways else continue_family
            family = go_on(start, task.limits, control=task.control, progress=tracing)
        else:
            family = start(Following(task.system, task.parameters, task.limits, task.control, tracing))
        item = TracedFamily(task.name, task.label, family)
        if family.outcome == "interrupted":
            return result(interrupted=True)
        if task.multiplicities or task.folds:
            length = family.orbits[-1].arclength or 1.0

            def searching(place: float) -> None:
                progress("resonances", TRACING_SHARE + (1 - TRACING_SHARE) * place / length)

            detection = detect(
                family, task.multiplicities, with_folds=task.folds, timeout=task.sampling_timeout, progress=searching
            )
            item = replace(item, detection=detection)
        return result()
    except (FamilyFailure, CorrectionFailure) as error:
        return result(failure=str(error))
    except KeyboardInterrupt:
        return result(interrupted=True)


def _interrupted(result: Traced) -> bool:
    return result.interrupted


def trace_tasks(tasks: Sequence[TraceTask], jobs: int, progress: Progress) -> Iterator[tuple[int, Traced]]:
    """Work on all tasks with `jobs` processes; yields (index, result) in the order of completion.

    After an interrupt the parts of families that are traced by then are yielded as well.
    """
    for index, result in run_all(Job(trace_task, attrgetter("title"), _interrupted), tasks, jobs, progress):
        if isinstance(result, Lost):
            yield index, Traced(tasks[index], None, result.reason, False, 0.0)
        else:
            yield index, result
