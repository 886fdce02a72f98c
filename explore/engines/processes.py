"""Work on several items side by side, with progress and a gentle end: an interrupt lets each hand back what it has."""

from __future__ import annotations

import platform
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cache, partial
from importlib import metadata, resources
from typing import Any, Generic, TypeVar

from orbitproof.shared.cluster import connected
from orbitproof.shared.processes import Answer, Failure, Report, Source, Task, answers
from orbitproof.shared.sources import source_digests

Item = TypeVar("Item")
Result = TypeVar("Result")

Progress = Callable[[str, float], None]
"""Called with what is being done and the fraction done, 0 to 1."""

GRACE_SECONDS = 20.0
"""How long an interrupted process may take to hand back its result."""


@dataclass(frozen=True)
class Lost:
    """In place of a result: the process ended before its work was done."""

    reason: str


@dataclass(frozen=True)
class Job(Generic[Item, Result]):
    """What to do with every item.

    Attributes:
        work: a module-level function of the item and a `Progress`; it may catch `KeyboardInterrupt`.
        name: of an item, for the progress display.
        last: whether a result is one after which nothing further should be started (an interrupted one).
    """

    work: Callable[[Item, Progress], Result]
    name: Callable[[Item], str]
    last: Callable[[Result], bool] = field(default=lambda _result: False)


def run_all(
    job: Job[Item, Result], items: Sequence[Item], jobs: int, progress: Progress, scheduler: str | None = None
) -> Iterator[tuple[int, Result | Lost]]:
    """Work on all items, at most `jobs` at a time; yields (index, result) in the order of completion.

    `progress` gets a message and the fraction of all items done. After an interrupt the results that
    can still be had are yielded, then `KeyboardInterrupt` is raised. An exception of `work` is raised here.
    Closing the iterator ends the processes. With the address of a dask `scheduler` its workers do the work, with no
    progress within an item, and nothing that is not finished can be had after an interrupt. Raises `InputError` where
    there is no such cluster.
    """
    fractions = [0.0] * len(items)

    def advance(index: int, message: str, fraction: float) -> None:
        fractions[index] = fraction
        name = job.name(items[index])
        progress(f"{name}: {message}" if message else name, sum(fractions) / len(items))

    if scheduler is not None:
        with connected(scheduler, software) as cluster:
            work = partial(_without_progress, job.work)
            yield from _results(job, items, lambda source: cluster.answers(work, source), advance)
        return
    if jobs > 1 and len(items) > 1:
        yield from _in_processes(job, items, min(jobs, len(items)), advance)
        return
    for index, item in enumerate(items):
        result = job.work(item, partial(advance, index))
        advance(index, "", 1.0)
        yield index, result
        if job.last(result):
            return


def _in_processes(
    job: Job[Item, Result], items: Sequence[Item], jobs: int, advance: Callable[[int, str, float], None]
) -> Iterator[tuple[int, Result | Lost]]:
    def heard(name: str, fraction: float, label: str) -> None:
        advance(int(name), label, fraction)

    work = partial(_work, job.work)
    yield from _results(
        job, items, lambda source: answers(work, source, heard, jobs, patience=GRACE_SECONDS), advance
    )  # fmt: skip


def _results(
    job: Job[Item, Result],
    items: Sequence[Item],
    answering: Callable[[Source], Generator[Answer, None, None]],
    advance: Callable[[int, str, float], None],
) -> Iterator[tuple[int, Result | Lost]]:
    """The results of all items as they are had; `answering` does tasks elsewhere."""
    waiting = deque(Task(str(index), item) for index, item in enumerate(items))

    def source() -> Task | None:
        return waiting.popleft() if waiting else None

    with closing(answering(source)) as all_answers:
        for answer in all_answers:
            index = int(answer.task.name)
            if not isinstance(answer.result, Failure):
                if job.last(answer.result):
                    waiting.clear()
                advance(index, "", 1.0)
                yield index, answer.result
            elif answer.result.error is not None:
                raise answer.result.error
            else:
                yield index, Lost(f"{answer.result.message}; try again")


def _work(work: Callable[[Any, Progress], Any], item: Any, report: Report) -> Any:
    return work(item, lambda message, fraction: report(fraction, message))


def _without_progress(work: Callable[[Any, Progress], Any], item: Any) -> Any:
    return work(item, lambda message, fraction: None)


@cache
def software() -> dict[str, str]:
    """Names and versions of what searches, with a digest of the sources: what workers of one run have in common."""
    packages = [(name, resources.files(f"orbitproof.{name}")) for name in ("shared", "explore")]
    names = ("orbitproof", "numpy", "jax", "jaxlib", "diffrax", "mpmath", "scipy")
    return {
        "source": source_digests(packages, ())[0],
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in names},
    }
