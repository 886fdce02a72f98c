"""Every command of the first sections of the page on distant retrograde orbits runs, and proves what the page says."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest
from flint import arb
from support.runs import done_here

from orbitproof.verify.evidence import ball_from_json

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "distant-retrograde.md").read_text("utf-8")
COMMANDS = [
    line for block in re.findall(r"^```sh\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL) for line in block.splitlines()
]


@pytest.mark.slow
def test_every_command_of_the_page_runs_and_proves_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert len(COMMANDS) == 6
    for line in COMMANDS:
        code = done_here(shlex.split(line)[1:])
        assert code == 0, capsys.readouterr().err
    (entry,) = json.loads((tmp_path / "orbit-certificate.json").read_text())["certificates"]
    results = entry["results"]
    assert results["stability"] == "linearly stable"
    assert results["stability_parameters"][0]["real"]["decimal"][1:23] in PAGE
    for ball in (results["period"], results["level"], results["least_distance"]["distance"]):
        assert ball["decimal"][1:32] in PAGE
    assert results["greatest_distance"]["distance"]["decimal"][1:27] in PAGE
    (stable,) = json.loads((tmp_path / "stable-certificate.json").read_text())["certificates"]
    assert (stable["verdict"], stable["statement"]["candidate"]["kind"]) == ("proved", "stable_orbit")
    assert "invariant" in (tmp_path / "stable.md").read_text("utf-8")


@pytest.mark.slow
def test_beside_the_1_3_orbit_all_are_stable_for_ever_with_another_twist_on_each_side(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    commands = [line for line in PAGE.splitlines() if re.match("orbitproof .* part.json", line)]
    assert len(commands) == 2
    for line in commands:
        assert done_here(shlex.split(line)[1:]) == 0, capsys.readouterr().err
    certificate = json.loads((tmp_path / "part-certificate.json").read_text())
    lasting = certificate["conclusion"]["complete"]["lasting"]
    (third,) = lasting["exceptions"]
    assert (third["k"], third["fate"]) == (3, "unstable")
    assert [entry["twist"] for entry in lasting["stable"]] == ["positive", "negative"]
    assert lasting["undecided"] == lasting["gaps"] == []
    found = ball_from_json(third["level"])
    first, last = re.search(r"^\| 1:3 \| \[([0-9.]+), ([0-9.]+)\]", PAGE, re.MULTILINE).groups()  # type: ignore[union-attr]
    assert found.overlaps(arb(first).union(arb(last)))
    assert float(found.rad()) < 1e-12
