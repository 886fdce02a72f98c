"""The command of the second proof: files, exit codes, going on, and the end of workers."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from orbitproof.verify.second_proof.runner import main

DATA = Path(__file__).parents[1] / "data" / "figures-certificates.json"
DOUBLING = "falkner-skan-odd-k2-1"


@pytest.fixture
def certificates(tmp_path: Path) -> Path:
    """Two rows that end at once, since no theorem is about them."""
    content = json.loads(DATA.read_text(encoding="utf-8"))
    content["certificates"] = content["certificates"][:2]
    for row in content["certificates"]:
        row["statement"]["candidate"]["kind"] = "fold"
    path = tmp_path / "certificates.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def rows(path: Path) -> dict[str, dict[str, Any]]:
    return {row["id"]: row for row in json.loads(path.read_text(encoding="utf-8"))["rows"]}


def test_rows_are_saved_and_kept(certificates: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "second-proofs.json"
    assert main([str(certificates), "-o", str(output), "--jobs", "2"]) == 1
    text, progress = capsys.readouterr()
    assert text.count("cannot follow") == 2
    assert "2/2" in progress
    assert "left" in progress
    assert len(rows(output)) == 2
    assert main([str(certificates), "-o", str(output)]) == 1
    assert capsys.readouterr().err == "", "rows that are there were tried again"
    content = json.loads(certificates.read_text(encoding="utf-8"))
    content["certificates"][0]["statement"]["candidate"]["k"] = 6
    certificates.write_text(json.dumps(content), encoding="utf-8")
    assert main([str(certificates), "-o", str(output)]) == 1
    assert "1/1" in capsys.readouterr().err, "only the row that changed is tried again"


def test_bad_input_is_named(certificates: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    broken = tmp_path / "broken.json"
    content = json.loads(certificates.read_text(encoding="utf-8"))
    content["certificates"][1]["statement"]["section"] = "w"
    for text, word in (
        ("{", "broken.json"),
        ("[]", "certificates"),
        ('{"certificates": [{}]}', "certificates"),
        (json.dumps(content), "statement.section"),
    ):
        broken.write_text(text, encoding="utf-8")
        assert main([str(broken)]) == 2
        message = capsys.readouterr().err
        assert "broken.json" in message
        assert word in message
        assert "Traceback" not in message
    assert main([str(tmp_path / "absent.json")]) == 2
    assert main([str(certificates), "--only", "nothing"]) == 2
    assert main([str(certificates), "-o", str(certificates)]) == 2
    assert main([str(certificates), "--jobs", "0"]) == 2


def children(pid: int) -> list[int]:
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
                command = (entry / "cmdline").read_bytes()
            except OSError:
                continue
            if parent == pid and b"spawn_main" in command:
                found.append(int(entry.name))
    return found


def alive(pid: int) -> bool:
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_their_parent(how: signal.Signals) -> None:
    root = Path(__file__).parents[2]
    command = [sys.executable, "-m", "orbitproof.verify.second_proof", str(DATA), "--only", DOUBLING]
    parent = subprocess.Popen(command, cwd=root, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    workers: list[int] = []
    while not workers and time.monotonic() < deadline:
        time.sleep(0.2)
        workers = children(parent.pid)
    assert workers
    time.sleep(3)
    os.kill(parent.pid, how)
    parent.wait(timeout=30)
    while any(alive(worker) for worker in workers) and time.monotonic() < deadline:
        time.sleep(0.2)
    assert not any(alive(worker) for worker in workers)
