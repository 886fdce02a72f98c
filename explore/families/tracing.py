"""Tracing families and finding their resonances, several families at a time in processes of their own."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

from orbitproof.explore.engines import Job, Lost, Progress, run_all
from orbitproof.explore.families.continuation import Family
from orbitproof.explore.families.detection import Detection, detect
from orbitproof.explore.families.first_orbits import first_family
from orbitproof.explore.families.hemispheres import branch_of
from orbitproof.explore.families.limits import Limits
from orbitproof.explore.families.named import FamilyFailure, continue_both_ways, continue_family, trace_family
from orbitproof.explore.families.step_control import CONTROL, SAMPLING_TIMEOUT, StepControl
from orbitproof.explore.names import DEFAULT_BRANCH, Branch, name_on
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.seeds import FirstOrbit
from orbitproof.shared.systems import ReversibleSystem

TRACING_SHARE = 0.6
"""Part of the time for a family that goes into tracing it; the rest finds its resonances."""


@dataclass(frozen=True)
class TraceTask:
    """A family to trace, or to continue, and to search.

    Attributes:
        name, system, parameters, branch: as for `explore.families.named.trace_family`.
        label: the parameters as the user named them, or "".
        multiplicities: the k to look for.
        folds: whether to look for folds as well.
        start: a part that is traced already.
        both_ways: whether that part is continued at both of its ends.
        of_catalogue: whether that part is a row of a catalogue.
        first: an approximate first orbit, in place of `start`, for a family that has no name of its own.
        control: steps and tolerances.
        sampling_timeout: seconds for sampling the stability.
    """

    system: ReversibleSystem
    name: str
    label: str
    parameters: Mapping[str, Fraction]
    limits: Limits
    multiplicities: tuple[int, ...]
    folds: bool = False
    branch: Branch = DEFAULT_BRANCH
    start: Family | None = None
    both_ways: bool = False
    of_catalogue: bool = False
    first: FirstOrbit | None = None
    control: StepControl = CONTROL
    sampling_timeout: float = SAMPLING_TIMEOUT

    @property
    def called(self) -> str:
        """The name of the family in files: one that is not traced by its name has the one that it is given."""
        return self.name if self.start is not None or self.first is not None else name_on(self.name, self.branch)

    @property
    def title(self) -> str:
        """For messages."""
        return f"{self.label} {self.called}" if self.label else self.called


@dataclass(frozen=True)
class TracedFamily:
    """A family with the name under which it was asked for and what was found on it."""

    name: str
    label: str
    family: Family
    detection: Detection = field(default_factory=lambda: Detection((), ()))

    @property
    def system(self) -> ReversibleSystem:
        """The family's system."""
        return self.family.problem.system

    @cached_property
    def branch(self) -> Branch | None:
        """Whether its orbits are northern or southern ones; `None` for others."""
        return branch_of(self.family)

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
        if start is None and task.first is not None:
            start = first_family(task.system, task.parameters, task.first, task.control)
            both_ways = task.first.direction is None
        if start is None:
            family = trace_family(
                task.system,
                task.name,
                task.parameters,
                task.limits,
                branch=task.branch,
                control=task.control,
                progress=tracing,
            )
        else:
            go_on = continue_both_ways if both_ways else continue_family
            family = go_on(start, task.limits, control=task.control, progress=tracing)
        item = TracedFamily(task.called, task.label, family)
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


def _title(task: TraceTask) -> str:
    return task.title


def _interrupted(result: Traced) -> bool:
    return result.interrupted


def trace_tasks(tasks: Sequence[TraceTask], jobs: int, progress: Progress) -> Iterator[tuple[int, Traced]]:
    """Work on all tasks with `jobs` processes; yields (index, result) in the order of completion.

    After an interrupt the parts of families that are traced by then are yielded as well.
    """
    for index, result in run_all(Job(trace_task, _title, _interrupted), tasks, jobs, progress):
        if isinstance(result, Lost):
            yield index, Traced(tasks[index], None, result.reason, False, 0.0)
        else:
            yield index, result
