"""The verifier's command line: verdicts, exit codes, saved rows, several processes."""

from __future__ import annotations

import json
import multiprocessing
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from flint import ctx
from support.claims import TOUCH_AND_GO
from support.refusals import refused

import orbitproof.verify.run.rows
from orbitproof.shared.formats import candidate_from_json
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, not_proved
from orbitproof.verify.evidence import Reason, ball_from_json, count_certain_digits
from orbitproof.verify.run.rows import certify_all

ROOT = Path(__file__).resolve().parents[2]

TRUE = {**TOUCH_AND_GO, "id": "k=3"}
FALSE = {**TRUE, "id": "k=2 at the k=3 point", "kind": "period_tupling", "k": 2}
HOPELESS = {**TRUE, "id": "singular frame", "kernel_frame": [["0"]]}
WITHOUT_THEOREM = {**TRUE, "id": "k=5", "k": 5}


def write(path: Path, *entries: dict[str, Any]) -> str:
    document = {"format": "orbitproof-candidates", "version": 1, "candidates": list(entries)}
    path.write_text(json.dumps(document))
    return str(path)


def read(path: Path) -> dict[str, Any]:
    return {entry["id"]: entry for entry in json.loads(path.read_text())["certificates"]}


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A candidates file and the certificates file of a whole run: one row proved, three not."""
    folder = tmp_path_factory.mktemp("run")
    source, target = folder / "candidates.json", folder / "certificates.json"
    arguments = [write(source, TRUE, FALSE, HOPELESS, WITHOUT_THEOREM), "-o", str(target), "--quiet"]
    assert main([*arguments, "--max-precision", "256"]) == 1
    return source, target


def copies(finished: tuple[Path, Path], folder: Path) -> tuple[Path, Path]:
    pair = folder / "candidates.json", folder / "certificates.json"
    for old, new in zip(finished, pair, strict=True):
        new.write_text(old.read_text())
    return pair


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the candidates that are certified; what is certified is not proved, at once."""
    names: list[str] = []

    def stub(candidates: Any, limits: Limits, jobs: int, progress: Any, finished: Any, engine: Any) -> None:
        for candidate in candidates:
            names.append(candidate.id)
            finished(not_proved(candidate, Reason("stub", "message", "remedy"), 0.0))

    monkeypatch.setattr(orbitproof.verify.run.rows, "certify_all", stub)
    return names


def test_rows_are_proved_or_not_with_their_reasons(finished: tuple[Path, Path]) -> None:
    rows = read(finished[1])
    assert list(rows) == [TRUE["id"], FALSE["id"], HOPELESS["id"], WITHOUT_THEOREM["id"]]
    assert rows["k=3"]["verdict"] == "proved"
    assert rows[FALSE["id"]]["reason"]["condition"] == "C3"
    assert rows["singular frame"]["reason"]["condition"] == "frames"
    assert rows["k=5"]["reason"]["condition"] == "theorem"
    assert count_certain_digits(ball_from_json(rows["k=3"]["results"]["parameter"])) >= 30


def test_table_shows_every_row_and_what_is_proved_is_kept(
    finished: tuple[Path, Path], tmp_path: Path, capsys: Any, counted: list[str]
) -> None:
    source, target = copies(finished, tmp_path)
    before = read(target)["k=3"]
    assert main([str(source), "-o", str(target)]) == 1
    output, errors = capsys.readouterr()
    assert counted == [FALSE["id"], HOPELESS["id"], WITHOUT_THEOREM["id"]]
    assert read(target)["k=3"] == before
    lines = output.splitlines()
    assert all(len(line) <= 80 for line in lines[:-1])
    assert lines[:2] == ["k=3: proved by an earlier run", "  touch-and-go (k = 3), new orbits on both sides"]
    assert lines[2].startswith("  beta = 453.44258682138482264451768193")
    assert sum(": not proved in" in line for line in lines) == 3
    assert sum("stub: message; remedy" in line for line in lines) == 3
    assert re.fullmatch(rf"1 of 4 proved in \d+ s; certificates: {re.escape(str(target))}", lines[-1])
    assert "kept" in errors


def test_what_is_proved_is_printed_as_json(finished: tuple[Path, Path], tmp_path: Path, capsys: Any) -> None:
    source, target = copies(finished, tmp_path)
    assert main([str(source), "-o", str(target), "--quiet", "--json", "--only", "k=3"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["results"]
    assert (row["id"], row["kind"], row["k"], row["verdict"]) == ("k=3", "touch_and_go", 3, "proved")
    assert row["results"]["side"] == "both"


def test_a_changed_candidate_is_verified_again(finished: tuple[Path, Path], tmp_path: Path, counted: list[str]) -> None:
    source, target = copies(finished, tmp_path)
    write(source, {**TRUE, "radii": ["1e-11", "2e-15"]}, FALSE, HOPELESS, WITHOUT_THEOREM)
    assert main([str(source), "-o", str(target), "--quiet"]) == 1
    assert "k=3" in counted


def test_provenance_does_not_matter(finished: tuple[Path, Path], tmp_path: Path, counted: list[str]) -> None:
    source, target = copies(finished, tmp_path)
    write(source, {**TRUE, "provenance": {"found": "by hand"}}, FALSE, HOPELESS, WITHOUT_THEOREM)
    assert main([str(source), "-o", str(target), "--quiet", "--only", "k=3"]) == 0
    assert counted == []


def test_other_software_does_not_keep_a_proof(finished: tuple[Path, Path], tmp_path: Path, counted: list[str]) -> None:
    source, target = copies(finished, tmp_path)
    document = json.loads(target.read_text())
    document["certificates"][0]["software"]["FLINT"] = "2.0"
    target.write_text(json.dumps(document))
    assert main([str(source), "-o", str(target), "--quiet", "--only", "k=3"]) == 1
    assert counted == ["k=3"]


def test_fresh_verifies_again_and_only_leaves_the_other_rows(
    finished: tuple[Path, Path], tmp_path: Path, counted: list[str]
) -> None:
    source, target = copies(finished, tmp_path)
    before = read(target)
    assert main([str(source), "-o", str(target), "--quiet", "--fresh", "--only", HOPELESS["id"]]) == 1
    assert counted == [HOPELESS["id"]]
    after = read(target)
    assert after.pop(HOPELESS["id"])["reason"]["condition"] == "stub"
    before.pop(HOPELESS["id"])
    assert after == before
    assert main([str(source), "-o", str(target), "--quiet", "--fresh"]) == 1
    assert len(counted) == 5


def test_a_fresh_run_that_is_interrupted_leaves_what_was_proved(
    finished: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stub(candidates: Any, limits: Limits, jobs: int, progress: Any, finished: Any, engine: Any) -> None:
        finished(not_proved(candidates[1], Reason("stub", "message", "remedy"), 0.0))
        raise KeyboardInterrupt

    source, target = copies(finished, tmp_path)
    before = read(target)
    monkeypatch.setattr(orbitproof.verify.run.rows, "certify_all", stub)
    assert main([str(source), "-o", str(target), "--quiet", "--fresh"]) == INTERRUPTED
    after = read(target)
    assert after.pop(FALSE["id"])["reason"]["condition"] == "stub"
    assert before.pop(FALSE["id"])
    assert after == before


def test_certificates_of_other_candidates_are_not_overwritten(
    finished: tuple[Path, Path], tmp_path: Path, capsys: Any, counted: list[str]
) -> None:
    source, target = copies(finished, tmp_path)
    before = target.read_bytes()
    write(source, FALSE)
    assert main([str(source), "-o", str(target), "--quiet"]) == 2
    assert "--fresh" in capsys.readouterr().err
    assert target.read_bytes() == before
    assert counted == []


@pytest.mark.parametrize("text", ["", "{}", '{"format": "orbitproof-candidates"}', "a text of somebody else"])
def test_a_file_that_holds_no_certificates_is_not_overwritten(
    text: str, tmp_path: Path, capsys: Any, counted: list[str]
) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "notes.txt"
    target.write_text(text)
    assert str(target) in refused(main, [write(source, TRUE), "-o", str(target)], capsys)
    assert target.read_text() == text
    assert counted == []


def test_finished_rows_survive_an_interrupt(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"

    def interrupted(candidates: Any, limits: Limits, jobs: int, progress: Any, finished: Any, engine: Any) -> None:
        finished(certify(candidates[0], limits))
        raise KeyboardInterrupt

    monkeypatch.setattr(orbitproof.verify.run.rows, "certify_all", interrupted)
    assert main([write(source, HOPELESS, TRUE, FALSE), "-o", str(target), "--quiet"]) == INTERRUPTED
    output, errors = capsys.readouterr()
    assert list(read(target)) == [HOPELESS["id"]]
    assert "1 of 3" in errors
    assert "the same command goes on" in errors
    assert output.count("not finished") == 2


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--max-precision", "0"], "--max-precision"),
        (["--max-precision", "1e3"], "--max-precision"),
        (["--max-precision", "9" * 5000], "--max-precision"),
        (["--row-timeout", "-1"], "--row-timeout"),
        (["--row-timeout", "nan"], "--row-timeout"),
        (["--row-timeout", "soon"], "--row-timeout"),
        (["--jobs", "0"], "--jobs"),
        (["--jobs", "two"], "--jobs"),
        (["--digits", "-3"], "--digits"),
        (["--only", "no such row"], "no such row"),
        (["--unknown"], "--unknown"),
        (["-o", "no/such/folder/certificates.json"], "no/such/folder"),
        (["-o", "."], "folder"),
    ],
)
def test_bad_options_are_refused_in_one_line(
    options: list[str], word: str, tmp_path: Path, capsys: Any, counted: list[str]
) -> None:
    assert word in refused(main, [write(tmp_path / "candidates.json", TRUE), *options], capsys)
    assert counted == []


def test_help_shows_examples_and_exit_codes(capsys: Any) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    text = capsys.readouterr().out
    assert "examples:" in text
    assert "exit codes: 0 everything proved, 1 something not proved, 2 bad input, 130 interrupted" in " ".join(
        text.split()
    )


def test_worker_processes_give_the_same_certificates(finished: tuple[Path, Path], tmp_path: Path) -> None:
    target = tmp_path / "certificates.json"
    command = [sys.executable, "-m", "orbitproof.verify", str(finished[0]), "-o", str(target), "--jobs", "2"]
    run = subprocess.run(
        [*command, "--max-precision", "256"], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )
    assert run.returncode == 1, run.stderr
    assert "Traceback" not in run.stderr
    assert "[4/4]" in run.stderr
    assert "left" in run.stderr
    one, two = read(finished[1]), read(target)
    for rows in (one, two):
        for row in rows.values():
            del row["computation"]["seconds"], row["digest"]
    assert one == two


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_gives_the_same_certificates(finished: tuple[Path, Path], tmp_path: Path) -> None:
    import distributed

    target = tmp_path / "certificates.json"
    options = {"n_workers": 2, "threads_per_worker": 2, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(**options) as cluster:
        arguments = [str(finished[0]), "-o", str(target), "--scheduler", cluster.scheduler_address]
        assert main([*arguments, "--max-precision", "256"]) == 1
    one, two = read(finished[1]), read(target)
    assert list(one) == list(two)
    for rows in (one, two):
        for row in rows.values():
            del row["computation"]["seconds"], row["digest"]
    assert one == two


def test_a_cluster_that_is_not_there_is_refused_and_rows_are_checked_again_here(tmp_path: Path, capsys: Any) -> None:
    source = write(tmp_path / "candidates.json", TRUE)
    for arguments, word in (
        ([source, "--scheduler", "somewhere"], "not an address"),
        (["--recheck", source, "--scheduler", "127.0.0.1:8786"], "give --jobs instead"),
    ):
        assert word in refused(main, arguments, capsys)


def test_a_row_whose_process_dies_is_not_proved_and_the_others_go_on() -> None:
    candidates = [candidate_from_json({**TRUE, "id": name}, "test") for name in ("first", "second")]
    candidates += [candidate_from_json(entry, "test") for entry in (HOPELESS, WITHOUT_THEOREM)]
    rows: list[Certificate] = []
    killed: list[str] = []

    def progress(name: str, fraction: float, label: str) -> None:
        if not killed:
            killed.append(name)
            process = next(p for p in multiprocessing.active_children() if p.pid is not None)
            os.kill(process.pid or 0, 9)

    certify_all(candidates, Limits(), 2, progress, rows.append)
    assert len(rows) == 4
    lost = [row for row in rows if row.reason and row.reason.condition == "process"]
    assert len(lost) == 1
    assert lost[0].verdict == "not proved"
    proved = {row.id for row in rows if row.proved}
    assert proved == {"first", "second"} - {lost[0].id}
    assert multiprocessing.active_children() == []


def test_rows_that_take_longest_come_first() -> None:
    """So that none of them is left over when all others are done; a narrower box takes more bits."""
    quick = candidate_from_json(TRUE, "test")
    narrow = replace(quick, id="narrow", radii=tuple(radius / 2**200 for radius in quick.radii))
    twice = replace(quick, id="twice", crossings=2)
    order: list[str] = []

    class Reader:
        def run(self, _work: Any, source: Any, _progress: Any, _finished: Any) -> None:
            order.extend(task.name for task in iter(source, None))

    certify_all([quick, twice, narrow], Limits(), 1, lambda *_: None, lambda _: None, Reader())
    assert order == ["narrow", "twice", quick.id]


def test_the_precision_of_arb_is_left_as_it_was(finished: tuple[Path, Path]) -> None:
    assert ctx.prec == 53
