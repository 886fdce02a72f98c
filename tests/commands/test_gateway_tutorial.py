"""Every command of the tutorial on the Gateway orbit runs, and proves what the page says."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest
from support.runs import done_here

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "gateway.md").read_text("utf-8")
COMMANDS = [
    line for block in re.findall(r"^```sh\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL) for line in block.splitlines()
]


@pytest.mark.slow
def test_every_command_of_the_page_runs_and_proves_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "docs" / "examples" / "gateway-rows.json", tmp_path)
    assert len(COMMANDS) == 7
    for line in COMMANDS:
        code = done_here(shlex.split(line)[1:])
        output, errors = capsys.readouterr()
        assert code == 0, errors
        if "--certificates" in line:
            assert "1 of 1 certificates say that an orbit near its row is proved" in output
    (entry,) = json.loads((tmp_path / "gateway-certificate.json").read_text())["certificates"]
    results = entry["results"]
    for ball in (results["period"], results["level"], results["least_distance"]["distance"]):
        assert ball["decimal"][1:32] in PAGE
    for part in ("real", "imaginary"):
        assert results["multipliers"][1][part]["decimal"][1:30] in PAGE
    report = (tmp_path / "gateway-report.md").read_text("utf-8")
    assert "exactly one point $x$ of" in report
    assert "The least distance from the smaller primary over the whole orbit" in report
