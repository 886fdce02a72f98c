"""Long runs: an interrupt, a full disk, a killed worker or a row without end costs one row and no more."""

from __future__ import annotations

import errno
import json
import os
import re
import shlex
import shutil
import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from support.claims import TOUCH_AND_GO
from support.runs import ROOT, SEES_PROCESSES, children, is_running, started, wait_until, workers

from orbitproof.shared.formats import candidate_from_json
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate, Limits
from orbitproof.verify.run.rows import certify_all

FOLDS = json.loads((ROOT / "tests" / "data" / "known-folds.json").read_text("utf-8"))["candidates"]
TRUE = next({**entry, "id": "true"} for entry in FOLDS if entry["id"].startswith("michelson"))
"""Proved in a twentieth of a second."""
QUICK = {**TOUCH_AND_GO, "id": "quick", "kernel_frame": [["0"]]}
ENDLESS = {**TOUCH_AND_GO, "id": "endless", "kind": "period_tupling", "k": 1000}


def write(path: Path, *entries: dict[str, Any]) -> str:
    path.write_text(json.dumps({"format": "orbitproof-candidates", "version": 1, "candidates": list(entries)}))
    return str(path)


def read(path: Path) -> dict[str, Certificate]:
    return {entry["id"]: entry for entry in json.loads(path.read_text())["certificates"]}


def command(source: Path, target: Path, jobs: str) -> list[str]:
    words = ["-m", "orbitproof.verify", str(source), "-o", str(target), "--jobs", jobs]
    return [*words, "--max-precision", "65536"]


@pytest.mark.parametrize(
    ("jobs", "sent", "everywhere"),
    [
        ("2", "SIGINT", True),
        ("2", "SIGTERM", False),
        ("1", "SIGHUP", True),
        # Each signal, each number of jobs and both ways to send one are above.
        pytest.param("1", "SIGINT", True, marks=pytest.mark.slow),
        pytest.param("2", "SIGTERM", True, marks=pytest.mark.slow),
    ],
)
def test_an_interrupt_keeps_finished_rows_and_the_same_command_goes_on(
    jobs: str, sent: str, everywhere: bool, tmp_path: Path
) -> None:
    """Ctrl-C and a terminal that is closed reach every process of the group; so may SIGTERM."""
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write(source, TRUE, ENDLESS)
    with started(command(source, target, jobs)) as run:
        wait_until(target.exists)
        time.sleep(0.1)
        (os.killpg if everywhere else os.kill)(run.pid, getattr(signal, sent))
        output, errors = run.communicate(timeout=60)
    assert run.returncode == INTERRUPTED
    assert "interrupted: 1 of 2" in errors
    assert "the same command goes on" in errors
    assert "Traceback" not in errors
    assert "not finished" in output
    before = read(target)
    assert list(before) == ["true"]
    assert before["true"]["verdict"] == "proved"

    assert main([str(source), "-o", str(target), "--max-precision", "64", "--quiet"]) == 1
    after = read(target)
    assert after["true"] == before["true"]
    assert list(after) == ["true", "endless"]


def test_where_ctrl_c_is_ignored_from_the_start_it_stays_ignored_and_sigterm_works(tmp_path: Path) -> None:
    """As in the background of a script."""
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write(source, ENDLESS, TRUE)
    with started(command(source, target, "2"), sigint=signal.SIG_IGN) as run:
        wait_until(lambda: workers(run.pid)) if SEES_PROCESSES else time.sleep(2.0)
        os.killpg(run.pid, signal.SIGINT)
        wait_until(target.exists)
        assert run.poll() is None
        run.terminate()
        _, errors = run.communicate(timeout=60)
    assert run.returncode == INTERRUPTED
    assert "interrupted: 1 of 2" in errors


@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
@pytest.mark.parametrize("sent", ["SIGKILL", "SIGTERM"])
def test_workers_end_when_the_command_is_gone(sent: str, tmp_path: Path) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write(source, TRUE, ENDLESS)
    with started(command(source, target, "2")) as run:
        wait_until(target.exists)
        found = wait_until(lambda: workers(run.pid))
        run.send_signal(getattr(signal, sent))
        run.wait(timeout=60)
        wait_until(lambda: not any(map(is_running, found)))
    assert list(read(target)) == ["true"]


def test_a_full_disk_keeps_the_rows_before_it(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    arguments = [write(source, TRUE, QUICK, {**QUICK, "id": "third"}), "-o", str(target)]
    writes = 0

    def full(descriptor: int) -> None:
        nonlocal writes
        writes += 1
        if writes > 1:
            raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        assert main(arguments) == 2
    output, errors = capsys.readouterr()
    assert errors.splitlines()[-1].startswith(f"error: {target}: cannot be written (No space left on device)")
    assert "proved" in output
    assert list(read(target)) == ["true"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["candidates.json", "certificates.json"]

    before = read(target)["true"]
    assert main([*arguments, "--quiet"]) == 1
    assert list(read(target)) == ["true", "quick", "third"]
    assert read(target)["true"] == before


@pytest.mark.usefixtures("little_grace")
@pytest.mark.parametrize("jobs", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_a_row_that_would_never_end_is_ended(jobs: int) -> None:
    rows: list[Certificate] = []
    candidates = [candidate_from_json(entry, "test") for entry in (ENDLESS, QUICK, TRUE)]
    certify_all(candidates, Limits(max_precision=65536, timeout=2.0), jobs, lambda *_: None, rows.append)
    found = {row.id: row for row in rows}
    assert found["endless"].verdict == "not proved"
    assert found["endless"].reason.condition == "time"
    assert "2 s" in found["endless"].reason.message
    assert found["quick"].reason.condition == "frames"
    assert found["true"].verdict == "proved"


@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
def test_a_killed_worker_costs_its_row_only(tmp_path: Path) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write(source, TRUE, ENDLESS, QUICK)
    with started(command(source, target, "2")) as run:
        wait_until(lambda: target.exists() and len(read(target)) == 2)
        found = workers(run.pid)
        assert found
        for worker in found:
            os.kill(worker, signal.SIGKILL)
        output, errors = run.communicate(timeout=60)
    assert run.returncode == 1
    assert "Traceback" not in errors
    rows = read(target)
    assert rows["endless"]["reason"]["condition"] == "process"
    assert "exit code -9" in rows["endless"]["reason"]["message"]
    assert rows["true"]["verdict"] == "proved"
    assert re.search(r"^endless: not proved.*\n.*\n  process: ", output, re.MULTILINE), output


@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
@pytest.mark.parametrize("sent", ["SIGKILL", "SIGTERM"])
def test_a_search_that_is_ended_leaves_nothing_running(sent: str) -> None:
    """SIGTERM lets the tasks hand back what they have; SIGKILL does not."""
    code = f"""
import sys; sys.path.insert(0, {str(ROOT / "tests")!r})
from support.process_work import endless, name_of
from orbitproof.explore.engines import Job, run_all
from orbitproof.shared.interrupts import run_command

def main():
    for index, steps in run_all(Job(endless, name_of), [0, 1, 2], 2, lambda *_: print("report", flush=True)):
        print("handed back", index, flush=True)

raise SystemExit(run_command(main))
"""
    with started(["-c", code]) as run:
        assert run.stdout.readline() == "report\n"
        found = workers(run.pid)
        assert len(found) == 2
        run.send_signal(getattr(signal, sent))
        output, errors = run.communicate(timeout=60)
        wait_until(lambda: not any(map(is_running, found)))
    # A signal that arrives inside a callback of JAX is told of by Python itself.
    assert "Traceback" not in errors or "Exception ignored in" in errors
    if sent == "SIGTERM":
        assert run.returncode == 130
        assert {line for line in output.splitlines() if line != "report"} <= {"handed back 0", "handed back 1"}
        assert "handed back" in output


@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
@pytest.mark.parametrize("sent", [pytest.param("SIGKILL", marks=pytest.mark.slow), "SIGTERM"])
def test_a_step_of_the_data_command_ends_with_it(sent: str, tmp_path: Path) -> None:
    with started(["-m", "orbitproof", "figures", "data", str(tmp_path), "--only", "l3-halo.json"]) as run:
        (step,) = wait_until(lambda: children(run.pid, "explore"))
        # It sees to its signals before anything else, but not in its first instants.
        time.sleep(1.0)
        run.send_signal(getattr(signal, sent))
        _, errors = run.communicate(timeout=60)
        wait_until(lambda: not is_running(step))
    # A signal that arrives inside a callback of JAX is told of by Python itself, or by the C++ around it.
    assert "Traceback" not in errors or "Exception ignored in" in errors or "what():" in errors
    if sent == "SIGTERM":
        assert run.returncode == 130
        assert "go on with: orbitproof figures data" in errors
    assert (tmp_path / "unfinished.txt").exists()


@pytest.mark.skipif(not SEES_PROCESSES or shutil.which("make") is None, reason="needs make and /proc")
@pytest.mark.parametrize("sent", ["SIGKILL", "SIGTERM"])
def test_a_command_that_make_runs_ends_with_make(sent: str, tmp_path: Path) -> None:
    source, target, file = tmp_path / "candidates.json", tmp_path / "certificates.json", tmp_path / "Makefile"
    write(source, TRUE, ENDLESS)
    (bound,) = re.findall(r"^BOUND = .+$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    words = shlex.join([sys.executable, *command(source, target, "2")])
    file.write_text(f"{bound}\nall:\n\t@$(BOUND) {words} || exit $$?\n")
    with started(["-f", str(file)], program="make") as run:
        wait_until(target.exists)
        (shell,) = children(run.pid, "orbitproof")
        (verifier,) = children(shell, "orbitproof")
        found = [verifier, *workers(verifier)]
        assert len(found) > 1
        run.send_signal(getattr(signal, sent))
        run.wait(timeout=60)
        wait_until(lambda: not any(is_running(process) for process in found))
    assert list(read(target)) == ["true"]


def test_every_long_recipe_is_bound_to_make() -> None:
    """All but those that end by themselves in a moment."""
    recipes = re.findall(r"^(\w+):.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    running = {name: text for name, text in recipes if re.search(r"\$\((EXPLORE|VERIFY|FIGURES)\)|orbitproof ", text)}
    assert {"demo", "branches", "figures"} <= set(running)
    for name in ("demo", "branches", "figures"):
        assert running[name].startswith("\t@$(BOUND) "), name
