"""Engines: where tasks are done side by side, in processes of this machine (here) or on a cluster (`cluster`)."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Mapping
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol

from orbitproof.shared.processes import Answer, Failure, Progress, Report, Source, Task, answers

Work = Callable[[Mapping[str, Any], Report], Mapping[str, Any]]
"""What is done in another process: a function of a module, from a JSON object to a JSON object."""
Finished = Callable[[Answer], None]


class Engine(Protocol):
    """Something that does tasks side by side."""

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """Do what `source` gives until it gives nothing and all is answered.

        Each answer goes to `finished`, in the order in which they come. `source` may be asked for the next task
        before that, and is asked again after it.
        """


@dataclass(frozen=True)
class Processes:
    """At most `jobs` processes of this machine.

    A task takes at most `timeout` and `GRACE_SECONDS`, and a process at most `memory` bytes beyond what it begins with;
    what became of a process that was ended, or that ended by itself, is the `Failure` of its task. Only JSON text
    passes between processes, as on a cluster.
    """

    jobs: int = 1
    timeout: float | None = None
    memory: int | None = None

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        """See `Engine.run`."""
        found = answers(partial(on_text, work), as_text(source), progress, self.jobs, self.timeout, memory=self.memory)
        hand_over(found, finished)


def as_text(source: Source) -> Source:
    """Tasks with JSON text for their arguments."""

    def next_text() -> Task | None:
        task = source()
        return None if task is None else Task(task.name, json.dumps(task.argument))

    return next_text


def hand_over(found: Generator[Answer, None, None], finished: Finished) -> None:
    """Give answers in JSON text to `finished`, read."""
    with closing(found) as all_answers:
        for answer in all_answers:
            task = replace(answer.task, argument=json.loads(answer.task.argument))
            result = answer.result if isinstance(answer.result, Failure) else json.loads(answer.result)
            finished(replace(answer, task=task, result=result))


def on_text(work: Work, argument: str, report: Report) -> str:
    """Do the work with JSON text for its argument; its result as JSON text."""
    return json.dumps(work(json.loads(argument), report))


def engine_of(
    scheduler: str | None, jobs: int, timeout: float | None, memory: int | None = None
) -> AbstractContextManager[Engine]:
    """The cluster of a scheduler if its address is given, otherwise processes of this machine."""
    if scheduler is None:
        return nullcontext(Processes(jobs, timeout, memory))
    from orbitproof.verify.run.cluster import connected

    return connected(scheduler)
