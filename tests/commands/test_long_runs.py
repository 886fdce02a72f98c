"""Long runs: an interrupt, a full disk, a killed worker or a row without end costs one row and no more."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import orbitproof.shared.formats.candidates
from orbitproof.shared.formats.candidates import candidate_from_json
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate.certificate import Certificate
from orbitproof.verify.certificate.certify import Limits
from orbitproof.verify.certificate.side_by_side import certify_all

ROOT = Path(__file__).resolve().parents[2]

TRUE: dict[str, Any] = {
    "id": "true",
    "system": "falkner-skan",
    "parameters": {},
    "kind": "touch_and_go",
    "k": 3,
    "centre": ["453.4425868213848226445176819322243780749336", "0.9398485857159715765408704789027875627762"],
    "frame": [["1", "0"], ["3.69989960370449e-7", "1"]],
    "kernel_frame": [["1"]],
    "radii": ["1e-11", "1e-15"],
}
QUICK = {**TRUE, "id": "quick", "kernel_frame": [["0"]]}
ENDLESS = {**TRUE, "id": "endless", "radii": ["1e-9000", "1e-9000"]}


def write(path: Path, *entries: dict[str, Any]) -> str:
    path.write_text(json.dumps({"format": "orbitproof-candidates", "version": 1, "candidates": list(entries)}))
    return str(path)


def read(path: Path) -> dict[str, Certificate]:
    return {entry["id"]: entry for entry in json.loads(path.read_text())["certificates"]}


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_interrupt_keeps_finished_rows_and_the_same_command_goes_on(jobs: str, tmp_path: Path) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write(source, TRUE, ENDLESS)
    command = [sys.executable, "-m", "orbitproof.verify", str(source), "-o", str(target), "--jobs", jobs]
    command += ["--max-precision", "65536"]
    run = subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    deadline = time.monotonic() + 120
    while not target.exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    time.sleep(0.5)
    # As a terminal does: to every process of the group.
    os.killpg(run.pid, signal.SIGINT)
    output, errors = run.communicate(timeout=60)
    assert run.returncode == 1
    assert "interrupted: 1 of 2" in errors
    assert "the same command goes on" in errors
    assert "Traceback" not in errors
    assert "not finished" in output
    before = read(target)
    assert list(before) == ["true"]
    assert before["true"]["verdict"] == "proved"

    assert main([str(source), "-o", str(target), "--max-precision", "256", "--quiet"]) == 1
    after = read(target)
    assert after["true"] == before["true"]
    assert list(after) == ["true", "endless"]


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
        patch.setattr(orbitproof.shared.formats.candidates.os, "fsync", full)
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


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_row_that_would_never_end_is_ended(jobs: int) -> None:
    rows: list[Certificate] = []
    candidates = [candidate_from_json(entry, "test") for entry in (ENDLESS, QUICK, TRUE)]
    start = time.monotonic()
    certify_all(candidates, Limits(max_precision=65536, timeout=8.0), jobs, lambda *_: None, rows.append)
    assert time.monotonic() - start < 60
    found = {row["id"]: row for row in rows}
    assert found["endless"]["verdict"] == "not proved"
    assert found["endless"]["reason"]["condition"] == "time"
    assert "8 s" in found["endless"]["reason"]["message"]
    assert found["quick"]["reason"]["condition"] == "frames"
    assert found["true"]["verdict"] == "proved"


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
def test_a_killed_worker_costs_its_row_only(tmp_path: Path) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write(source, TRUE, ENDLESS, QUICK)
    command = [sys.executable, "-m", "orbitproof.verify", str(source), "-o", str(target), "--jobs", "2"]
    run = subprocess.Popen(
        [*command, "--max-precision", "65536"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 120
    while (not target.exists() or len(read(target)) < 2) and time.monotonic() < deadline:
        time.sleep(0.1)
    children = Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split()
    names = {child: Path(f"/proc/{child}/cmdline").read_text() for child in children}
    workers = [int(child) for child, name in names.items() if "spawn_main" in name]
    assert workers
    for worker in workers:
        os.kill(worker, signal.SIGKILL)
    output, errors = run.communicate(timeout=60)
    assert run.returncode == 1
    assert "Traceback" not in errors
    rows = read(target)
    assert rows["endless"]["reason"]["condition"] == "process"
    assert "exit code -9" in rows["endless"]["reason"]["message"]
    assert rows["true"]["verdict"] == "proved"
    assert "endless: not proved, process" in output
