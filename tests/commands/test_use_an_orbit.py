"""Every command of the page on what to do with an orbit runs, and gives what the page says."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.runs import done_here

from orbitproof.explore.__main__ import main as explore
from orbitproof.figures.__main__ import main as figures

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "how-to" / "use-an-orbit.md").read_text("utf-8")
BLOCKS = {kind: re.findall(rf"^```{kind}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL) for kind in ("sh", "python")}


@pytest.mark.slow
def test_every_command_of_the_page_runs_and_gives_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(ROOT / "docs" / "examples" / "gateway-rows.json", tmp_path)
    monkeypatch.chdir(tmp_path)
    lines = [line for block in BLOCKS["sh"] for line in block.splitlines()]
    assert len(lines) == 10
    for line in lines:
        program, command, *words = shlex.split(line)
        assert program == "orbitproof"
        assert {"explore": explore, "figures": figures}[command](words) == 0, line
    assert "3 of 3 orbits corrected" in capsys.readouterr().out
    before, after = (json.loads(Path(name).read_text())["system"] for name in ("gateway-rows.json", "corrected.json"))
    assert {name: after[name] for name in before if name != "mass_ratio"} == {
        name: before[name] for name in before if name != "mass_ratio"
    }
    assert len(json.loads(Path("tori.json").read_text())["tori"]) == 8
    tubes = [json.loads(Path(name).read_text()) for name in ("tube.json", "arrivals.json")]
    assert [tube["kind"] for tube in tubes] == ["unstable", "stable"]
    assert [len(tube["lines"]) for tube in tubes] == [60, 20]
    pictures = {path.name for folder in ("figures-out", "tubes-out") for path in Path(folder).glob("*.png")}
    assert pictures == {"tori.png", "tube.png", "arrivals.png"}


def test_the_page_reads_its_ephemeris_by_another_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(ROOT / "docs" / "examples" / "gateway-rows.json", tmp_path)
    (line,) = (line for block in BLOCKS["sh"] for line in block.splitlines() if "--oem" in line)
    monkeypatch.chdir(tmp_path)
    assert done_here(shlex.split(line)[1:]) == 0
    program = [sys.executable, "-c", BLOCKS["python"][0]]
    done = subprocess.run(program, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "EARTH-MOON_ROTATING 66\n"
