"""Commands that are interrupted, at a result that is named, and given again: the certificates of undisturbed ones.

All is integrated, on small parts of a curve and of a surface.
"""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.runs import untimed

from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.verify.run import branch_checks, branches, web_command
from orbitproof.verify.run.branch_command import main as prove
from orbitproof.verify.run.web_command import main as join

DATA = Path(__file__).parents[1] / "data"
CURVE, SURFACE = DATA / "atlas-touch-and-go.json", DATA / "surface-axial.json"
ROUGHLY = ("--precision", "32", "--order", "16", "--width", "6")
"""Not enough on the curve: a second attempt proves it."""
RUNS = {
    "a curve": (CURVE, ROUGHLY, 2),
    "--complete": (CURVE, ("--complete", "4", *ROUGHLY), 2),
    # Two halves, and a closer look at the 1:3 resonance.
    "--lasting": (CURVE, ("--complete", "4", "--lasting", "--precision", "56", "--order", "22", "--width", "14"), 3),
    "a surface": (SURFACE, ("--precision", "16", "--order", "16", "--width", "1", "--top", "3"), 2),
}  # fmt: skip


def asked_to_end_after(done: Callable[..., Any]) -> Callable[..., Any]:
    """The function, with SIGTERM to this process after each call."""

    def then_ended(*arguments: Any) -> Any:
        result = done(*arguments)
        os.kill(os.getpid(), signal.SIGTERM)
        return result

    return then_ended


def prove_here(name: str, path: Path) -> int:
    source, options, _ = RUNS[name]
    return run_command(lambda: prove([str(source), *options, "-o", str(path), "--quiet"]))


@pytest.fixture
def proved_twice(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """The files of a run that was ended after each result, until nothing was left, and of an undisturbed one."""
    disturbed, undisturbed = tmp_path / "a.json", tmp_path / "b.json"
    with monkeypatch.context() as patch:
        patch.setattr(branches, "write_certificate", asked_to_end_after(branches.write_certificate))
        for count in range(1, RUNS[request.param][2] + 1):
            assert prove_here(request.param, disturbed) == INTERRUPTED
            assert len(untimed(disturbed)["results"]) == count
            assert untimed(disturbed)["reason"]["condition"] == "unfinished"
    assert [prove_here(request.param, path) for path in (disturbed, undisturbed)] == [0, 0]
    return disturbed, undisturbed


@pytest.mark.parametrize("proved_twice", RUNS, indirect=True)
def test_a_proof_that_is_ended_after_each_result_ends_as_an_undisturbed_one(proved_twice: tuple[Path, Path]) -> None:
    disturbed, undisturbed = map(untimed, proved_twice)
    assert disturbed == undisturbed
    assert disturbed["verdict"] == "proved"


@pytest.mark.parametrize("proved_twice", ["a curve"], indirect=True)
def test_a_web_that_is_ended_after_each_step_ends_as_an_undisturbed_one(
    proved_twice: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    """The web of the curve alone: its certificate is checked, the web is put together and written."""
    source = tmp_path / "web.json"
    web = {"format": "orbitproof-web", "version": 1, "id": "web", "title": "a web", "arcs": [{"id": "touch-and-go"}]}
    source.write_text(json.dumps(web))
    paths = [curve.with_name(f"web-{curve.name}") for curve in proved_twice]

    def join_here(number: int) -> int:
        words = [str(source), "--certificates", str(proved_twice[number]), "-o", str(paths[number]), "--quiet"]
        return run_command(lambda: join(words))

    for module, step in ((branch_checks, "examined"), (web_command, "apart"), (web_command, "write_certificate")):
        assert not paths[0].exists()
        with monkeypatch.context() as patch:
            patch.setattr(module, step, asked_to_end_after(getattr(module, step)))
            assert join_here(0) == INTERRUPTED
        said = capsys.readouterr().err
        assert (f"written before: {paths[0]}" in said) is paths[0].exists()
        assert ("nothing was written" in said) is not paths[0].exists()
    assert untimed(paths[0])["verdict"] == "proved"
    written = paths[0].read_bytes()
    assert [join_here(number) for number in (0, 1)] == [0, 0]
    assert paths[0].read_bytes() == written
    # They name their curves by digests.
    assert undigested(untimed(paths[0])) == undigested(untimed(paths[1]))


def undigested(value: Any) -> str:
    return re.sub("sha256:[0-9a-f]+", "", json.dumps(value))
