"""Tracing the families that branch off from the planar families of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from orbitproof.explore.families import (
    LocatedResonance,
    Traced,
    TracedFamily,
    TraceTask,
    branch_seed,
    breaking_at_end,
    symmetry_breakings,
)
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.three_body.families import on_side
from orbitproof.explore.three_body.names import Branch, branch_name, branch_number, name_on


@dataclass(frozen=True)
class Branches:
    """What branches off from the planar families of a run.

    Attributes:
        tasks: one for each symmetry breaking, in order, without what is traced already.
        failures: a line for each planar family whose symmetry breakings could not be located.
    """

    tasks: tuple[TraceTask, ...]
    failures: tuple[str, ...]


def branches_of(results: Sequence[Traced], side: Branch) -> Branches:
    """The families to trace from the symmetry breakings of the planar families among the results, to one side."""
    done = {(result.task.name, result.task.label) for result in results}
    tasks, failures = [], []
    for result, item in _planar(results):
        task, problem = result.task, item.family.problem
        try:
            breakings = symmetry_breakings(item.family)
        except CorrectionFailure as error:
            failures.append(f"{item.title}: no branches: a symmetry breaking could not be located: {error}")
            continue
        for number, breaking in enumerate(breakings, start=1):
            seed = on_side(branch_seed(problem, breaking, 1), side)
            name = name_on(branch_name(item.name, number), side)
            branch = replace(task, name=name, start=seed, both_ways=False)
            if (branch.name, branch.label) not in done:
                tasks.append(branch)
    return Branches(tuple(tasks), tuple(failures))


def shared_branches(results: Sequence[Traced]) -> list[str]:
    """A line for each branch that comes back to its planar family where another branch leaves it."""
    lines = []
    breakings: dict[tuple[str, str], list[LocatedResonance]] = {}
    for _, item in _planar(results):
        with suppress(CorrectionFailure):
            breakings[item.label, _point(item)] = symmetry_breakings(item.family)
    for result in results:
        branch, number = result.item, branch_number(result.task.name)
        if branch is None or number is None:
            continue
        end = breaking_at_end(branch.family, breakings.get((branch.label, _point(branch)), ()))
        if end is not None and end != number - 1:
            lines.append(f"{branch.title}: ends where {branch_name(branch.name, end + 1)} begins; both are one family")
    return lines


def _planar(results: Sequence[Traced]) -> Iterator[tuple[Traced, TracedFamily]]:
    for result in results:
        if result.item is not None and result.item.family.problem.symmetry is not None:
            yield result, result.item


def _point(item: TracedFamily) -> str:
    return item.name.partition("-")[0]
