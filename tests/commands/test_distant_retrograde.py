"""Every command of the first sections of the page on distant retrograde orbits runs, and proves what the page says."""

from __future__ import annotations

import json
import re
import shlex
import signal
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import arb
from support.balls import agree
from support.runs import SEES_PROCESSES, done_here, started, untimed, wait_until

from orbitproof.shared.claims import Covers
from orbitproof.shared.formats import read_atlas, write_atlas
from orbitproof.shared.interrupts import INTERRUPTED
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
    assert agree(found, arb(first).union(arb(last)))
    assert float(found.rad()) < 1e-12


@pytest.mark.slow
@pytest.mark.skipif(not SEES_PROCESSES, reason="looks for processes in /proc")
def test_the_curve_that_is_ended_while_it_is_proved_ends_as_an_undisturbed_one(tmp_path: Path) -> None:
    """Of the documented curve the ninth piece, with the orbit without twist: all of it takes four times as long."""
    source, paths = tmp_path / "dro.json", [tmp_path / "a.json", tmp_path / "b.json"]
    explore, prove, *_ = (line for line in PAGE.splitlines() if re.match("orbitproof .* dro.json", line))
    assert done_here([*shlex.split(explore)[1:-1], str(source)]) == 0
    atlas = read_atlas(source)
    covers = Covers("x", Fraction("1.47"), Fraction("1.73"))
    write_atlas(source, replace(atlas, claim=replace(atlas.claim, covers=covers), pieces=atlas.pieces[8:9]))
    options = [word for word in shlex.split(prove)[3:] if not word.endswith(".json") and word != "-o"]
    assert options == ["--complete", "4", "--lasting", "--jobs", "2"]
    command = ["-m", "orbitproof", "verify", "atlas", str(source), *options, "--quiet", "-o"]
    with started([*command, str(paths[0])]) as run:
        wait_until(lambda: paths[0].exists() and len(json.loads(paths[0].read_text())["results"]) >= 2, 3600.0)
        run.send_signal(signal.SIGTERM)
        assert run.wait(120) == INTERRUPTED
    assert json.loads(paths[0].read_text())["reason"]["condition"] == "unfinished"
    for path in paths:
        with started([*command, str(path)]) as run:
            run.communicate(timeout=7200)
            assert run.returncode == 0
    disturbed, undisturbed = map(untimed, paths)
    assert disturbed == undisturbed
    lasting = disturbed["conclusion"]["complete"]["lasting"]
    assert lasting["undecided"] == lasting["gaps"] == []
    assert [entry["kind"] for entry in lasting["exceptions"]] == ["resonance", "twistless"]
    for entry, row in zip(lasting["exceptions"], ("1:4", "no twist"), strict=True):
        ends = re.findall(rf"^\| {row} \| \[([0-9.]+), ([0-9.]+)\]", PAGE, re.MULTILINE)
        found = ball_from_json(entry["level"])
        assert any(agree(arb(first).union(arb(last)), found) for first, last in ends)
        assert float(found.rad()) < 1e-10
