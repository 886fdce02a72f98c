"""What comes from elsewhere counts only if this software computed it; a task without a result has none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import pytest
from support import atlas_work

from orbitproof.shared import cluster
from orbitproof.shared.formats import InputError
from orbitproof.shared.processes import Answer, Failure, Task
from orbitproof.verify.evidence import software
from orbitproof.verify.run import Engine, Processes, connected

HERE = software()
OTHER = {**HERE, "orbitproof": "0"}
LESS = dict(list(HERE.items())[:-1])
MORE = {**HERE, "another": "1"}
TASKS = [Task(name, {"piece": {"id": name, "tube": ["1"]}, "interval": ["-0x1", "0x1"], "integrator": {}})
         for name in ("p000", "p001")]  # fmt: skip


class Future:
    """What a worker of some software answers."""

    def __init__(self, result: str, version: Mapping[str, str]) -> None:
        self._answer = version, result

    def result(self) -> tuple[Mapping[str, str], str]:
        return self._answer

    def release(self) -> None:
        pass


class Client:
    """A cluster that does each task here at once, as workers do whose software says `tells` and then `works`."""

    loop = None

    def __init__(self, tells: list[Mapping[str, str]], works: list[Mapping[str, str]]) -> None:
        self.tells, self.works = tells, iter(works)

    def run(self, function: Callable[[], Any]) -> dict[str, Mapping[str, str]]:
        return {f"worker {number}": version for number, version in enumerate(self.tells)}

    def nthreads(self) -> dict[str, int]:
        return {"worker 0": 1}

    def submit(self, function: Callable[..., tuple[Mapping[str, str], str]], *arguments: Any, pure: bool) -> Future:
        return Future(function(*arguments)[1], next(self.works))

    def cancel(self, futures: list[Future]) -> None:
        assert not futures

    def close(self) -> None:
        pass


class Completed(list[Future]):
    """The futures in their order."""

    def add(self, future: Future) -> None:
        self.append(future)

    def __next__(self) -> Future:
        return self.pop(0)


def with_client(monkeypatch: pytest.MonkeyPatch, client: Client) -> None:
    distributed = SimpleNamespace(Client=lambda *_, **__: client, as_completed=lambda loop: Completed())
    monkeypatch.setattr(cluster, "import_module", lambda name: distributed)


def answers_of(engine: Engine, work: Callable[..., Any]) -> dict[str, Any]:
    waiting: Iterator[Task] = iter(TASKS)
    found: dict[str, Any] = {}

    def finished(answer: Answer) -> None:
        found[answer.task.name] = answer.result

    engine.run(work, lambda: next(waiting, None), lambda *_: None, finished)
    return found


@pytest.mark.parametrize("version", [OTHER, LESS, MORE], ids=["other", "less", "more"])
def test_a_result_counts_only_if_the_worker_has_this_software(
    version: Mapping[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with_client(monkeypatch, Client([HERE], [HERE, version]))
    with connected("host:1") as engine:
        found = answers_of(engine, atlas_work.proving)
    assert found["p000"]["verdict"] == "proved"
    assert isinstance(found["p001"], Failure)


@pytest.mark.parametrize("version", [OTHER, LESS, MORE], ids=["other", "less", "more"])
def test_a_cluster_is_refused_if_a_worker_has_other_software(
    version: Mapping[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with_client(monkeypatch, Client([HERE, version], []))
    with pytest.raises(InputError, match=r"worker 1 has .* install the same"), connected("host:1"):
        pass


def test_a_task_whose_process_ends_has_no_result() -> None:
    found = answers_of(Processes(1), atlas_work.dying)
    assert found["p000"]["verdict"] == "proved"
    assert isinstance(found["p001"], Failure)
