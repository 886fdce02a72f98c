"""Runs of atlases in this process, and files of atlases."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from support import atlas_work, refusals
from support.chain_cases import parabola

from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import write_atlas
from orbitproof.shared.processes import Answer, Progress, Source
from orbitproof.verify.run import Display, Work
from orbitproof.verify.run.branch_command import main
from orbitproof.verify.run.branch_tasks import RunLimits
from orbitproof.verify.run.branches import AtlasRun
from orbitproof.verify.run.processes import Finished

ROOT = Path(__file__).resolve().parents[2]
CURVE, _ = parabola()
LIMITS = RunLimits({})


class InOrder:
    """An engine without processes; remembers what was asked of it."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, tuple[str, str]]] = []

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        while (task := source()) is not None:
            self.asked.append((task.name, tuple(task.argument["interval"])))  # type: ignore[arg-type]
            report: Callable[[float, str], None] = lambda fraction, label: None  # noqa: E731
            finished(Answer(task, json.loads(json.dumps(work(task.argument, report))), 0.25))


def go(atlas: Atlas, work: Any, limits: RunLimits = LIMITS, earlier: Any = ()) -> tuple[AtlasRun, InOrder]:
    run, engine = AtlasRun(atlas, limits, earlier), InOrder()
    run.run(engine, Display(dict.fromkeys(run.pending, 1.0), quiet=True), lambda results: None, work)
    return run, engine


def write(path: Path, atlas: Atlas = CURVE) -> str:
    write_atlas(path, atlas)
    return str(path)


def refused(capsys: Any, *arguments: str) -> str:
    errors = refusals.refused(lambda words: main(words, atlas_work.proving), list(arguments), capsys)
    assert errors.startswith("error: ")
    return errors
