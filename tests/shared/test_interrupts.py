"""A command that a signal came to ends as interrupted, wherever the signal found it, and says no more than it did."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support.claims import TOUCH_AND_GO

from orbitproof.explore import __main__ as explore
from orbitproof.explore import refinement
from orbitproof.explore.commands import orbit
from orbitproof.explore.search import run as search
from orbitproof.shared.formats import candidate_from_json, read_candidates, write_text
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.verify.run import rows, second_proofs
from orbitproof.verify.run.row_command import main as verify
from orbitproof.verify.run.second_proofs import main as prove_again

ROOT = Path(__file__).resolve().parents[2]
FOLDS = ROOT / "tests" / "data" / "known-folds.json"
CERTIFICATES = ROOT / "tests" / "data" / "figures-certificates.json"


def asked_to_end() -> None:
    os.kill(os.getpid(), signal.SIGTERM)


class Finalized:
    """Is asked to end while Python finalizes it, where an exception is told of and otherwise passed over."""

    def __del__(self) -> None:
        asked_to_end()
        for _ in range(100):
            pass


def in_a_finalizer() -> int:
    Finalized()
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        pass
    return 0


def caught() -> int:
    try:
        asked_to_end()
        time.sleep(1.0)
    except KeyboardInterrupt:
        return 0
    return 1


def made_another_exception() -> int:
    """As callbacks of libraries do."""
    try:
        asked_to_end()
        time.sleep(1.0)
    except BaseException:
        return 1
    return 0


def option_refused() -> int:
    try:
        asked_to_end()
        time.sleep(1.0)
    except KeyboardInterrupt:
        raise SystemExit(0) from None
    return 1


@pytest.mark.parametrize("main", [in_a_finalizer, caught, made_another_exception, option_refused])
def test_a_command_that_was_asked_to_end_is_interrupted(main: Callable[[], int], capsys: Any) -> None:
    before, hook = signal.getsignal(signal.SIGTERM), sys.unraisablehook
    start = time.monotonic()
    assert run_command(main) == INTERRUPTED
    assert time.monotonic() - start < 50.0
    assert "Traceback" not in capsys.readouterr().err
    assert (signal.getsignal(signal.SIGTERM), sys.unraisablehook) == (before, hook)


def told(lines: list[str]) -> Any:
    return SimpleNamespace(stage=lambda text: None, message=lines.append, error=lines.append, update=lambda *_: None)


def refined(*ends: object) -> Callable[..., Iterator[Any]]:
    """Points that are refined one after the other; what is an exception is raised."""

    def tasks(missing: list[Any], jobs: int, progress: Any) -> Iterator[Any]:
        for position, end in enumerate(ends):
            if isinstance(end, BaseException):
                raise end
            yield position, SimpleNamespace(task=missing[position], candidate=end, failure=None, seconds=1.0)

    return tasks


def point(name: str) -> Any:
    return candidate_from_json({**TOUCH_AND_GO, "id": name}, "a test")


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_search_that_is_interrupted_while_refining_says_what_is_written(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = [point("a"), point("b")]
    targets = [SimpleNamespace(task=lambda digits, each=each: each) for each in points]
    monkeypatch.setattr(search, "targets_of", lambda item, points: targets)
    monkeypatch.setattr(search, "refine_tasks", refined(*points[:number], KeyboardInterrupt()))
    monkeypatch.setattr(search, "_exact_row", lambda target, candidate: SimpleNamespace(level="3"))
    monkeypatch.setattr(search, "_in_words", lambda target, level: level)
    lines: list[str] = []
    path = tmp_path / "candidates.json"
    options = SimpleNamespace(digits=50, jobs=2, output=path)
    request: Any = SimpleNamespace(options=options, points=points)
    code, _ = search._refine_all(request, [object()], [], told(lines))  # type: ignore[list-item]
    assert code == INTERRUPTED
    text = "\n".join(lines)
    assert f"interrupted; {number} of 2 points are refined" in text
    assert "no candidates found" not in text
    assert path.exists() is (number > 0)
    assert not path.exists() or [each.id for each in read_candidates(path)] == ["a", "b"][:number]


@dataclass(frozen=True)
class Wanted:
    """An orbit to be refined."""

    id: str
    system: str = ""
    kind: str = ""


@pytest.mark.parametrize("number", [0, 1, 2])
def test_orbits_that_are_refined_when_a_signal_comes_are_written_and_no_others(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = [point("a"), point("b")]
    monkeypatch.setattr(orbit, "kind_of", lambda options, system: "orbit")
    monkeypatch.setattr(refinement, "refine_orbits", refined(*points[:number], KeyboardInterrupt()))
    lines: list[str] = []
    options: Any = SimpleNamespace(jobs=2, output=tmp_path / "orbits.json")
    tasks: list[Any] = [Wanted("a"), Wanted("b")]
    assert orbit._refined(options, tasks, told(lines)) == INTERRUPTED
    text = "\n".join(lines)
    assert f"interrupted: {number} of 2 orbits refined" in text
    assert ("goes on from there" in text) is options.output.exists() is (number > 0)
    assert number == 0 or [each.id for each in read_candidates(options.output)] == ["a", "b"][:number]


def test_a_search_that_is_interrupted_after_its_last_family_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """All results are there: nothing more is begun with them."""

    def traced(tasks: Any, jobs: int, progress: Any) -> Iterator[Any]:
        yield 0, SimpleNamespace(item=None, interrupted=False, failure="", task=SimpleNamespace(title="family"))
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "trace_tasks", traced)
    options = SimpleNamespace(jobs=2, branches=False, from_catalogue=None)
    request: Any = SimpleNamespace(options=options, command="candidates", family_output=None)
    lines: list[str] = []
    code, rows = search._search(request, [SimpleNamespace(title="family")], [], told(lines))  # type: ignore[list-item]
    assert (code, rows) == (INTERRUPTED, [])
    assert "interrupted while tracing; nothing is written" in lines


@pytest.mark.parametrize("is_written", [True, False])
def test_a_command_of_the_search_says_what_it_has_written(
    is_written: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    path = tmp_path / "file.csv"

    def run(options: Any) -> int:
        if is_written:
            write_text(path, "a,b\n")
        raise KeyboardInterrupt

    parser = SimpleNamespace(parse_args=lambda arguments: SimpleNamespace(command="family", json=False, run=run))
    monkeypatch.setattr(explore, "parser", lambda: parser)
    assert run_command(lambda: explore.main([])) == INTERRUPTED
    said = capsys.readouterr().err
    assert (f"written before: {path}" in said) is is_written
    assert ("nothing was written" in said) is not is_written


@pytest.mark.parametrize("earlier", ["none", "old"])
def test_nothing_is_said_to_be_saved_where_nothing_was(
    earlier: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    def ended(*_: Any, **more: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(rows, "certify_all", ended)
    monkeypatch.setattr(second_proofs.Processes, "run", ended)
    path = tmp_path / "v.json"
    for command, source in ((verify, FOLDS), (prove_again, CERTIFICATES)):
        path.unlink(missing_ok=True)
        if earlier == "old":
            content = {"format": "orbitproof-certificates", "version": 1, "certificates": []}
            path.write_text(str(content).replace("'", '"'))
        if earlier == "old" and command is prove_again:
            continue
        words = [str(source), "-o", str(path), "--quiet"]
        assert command([*words, "--fresh"] if earlier == "old" else words) == INTERRUPTED
        assert "saved" not in capsys.readouterr().err
