"""Runs over an atlas: splitting, keeping, going on, and what comes of them, with provers that integrate nothing."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import atlas_work
from support.chain_cases import parabola, symmetric_loop
from support.runs import started, wait_until

from orbitproof.shared.formats.atlas import Atlas, write_atlas
from orbitproof.shared.formats.candidates import InputError
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.processes import Answer, Progress, Source, Task
from orbitproof.verify.atlas.__main__ import _parser, main
from orbitproof.verify.atlas.certificate import make_atlas_certificate, read_atlas_certificate, write_atlas_certificate
from orbitproof.verify.atlas.run import AtlasRun
from orbitproof.verify.atlas.splitting import covers, halves, interval_of, plan, whole
from orbitproof.verify.atlas.task import RunLimits
from orbitproof.verify.certificate.certificate import digest
from orbitproof.verify.engines.processes import Finished, Processes, Work
from orbitproof.verify.engines.progress import Display

ROOT = Path(__file__).resolve().parents[2]
CURVE, _ = parabola()
LIMITS = RunLimits({})


class InOrder:
    """An engine without processes; remembers what was asked of it."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, tuple[str, str]]] = []

    def run(self, work: Work, source: Source, progress: Progress, finished: Finished) -> None:
        while (task := source()) is not None:
            self.asked.append((task.name, tuple(task.argument["interval"])))  # type: ignore[arg-type]
            report: Callable[[float, str], None] = lambda fraction, label: None  # noqa: E731
            finished(Answer(task, json.loads(json.dumps(work(task.argument, report))), 0.25))


def go(atlas: Atlas, work: Any, limits: RunLimits = LIMITS, earlier: Any = ()) -> tuple[AtlasRun, InOrder]:
    run, engine = AtlasRun(atlas, limits, earlier), InOrder()
    run.run(engine, Display(dict.fromkeys(run.pending, 1.0), quiet=True), lambda results: None, work)
    return run, engine


def write(path: Path, atlas: Atlas = CURVE) -> str:
    write_atlas(path, atlas)
    return str(path)


# Splitting


@given(st.lists(st.booleans(), max_size=6))
def test_halves_cover_their_interval_and_overlap(turns: list[bool]) -> None:
    interval = (Fraction(-1), Fraction(1))
    for turn in turns:
        left, right = halves(interval)
        assert covers([left, right], interval)
        assert left[1] > right[0]
        assert interval[0] == left[0] < left[1] < right[1] == interval[1]
        interval = (left, right)[turn]


def test_intervals_with_a_gap_cover_nothing_beyond_it() -> None:
    half = Fraction(1, 2)
    assert covers([(half, Fraction(1)), (Fraction(0), half)], (Fraction(0), Fraction(1)))
    assert not covers([(Fraction(0), half), (half + Fraction(1, 10**30), Fraction(1))], (Fraction(0), Fraction(1)))
    assert not covers([], (Fraction(0), Fraction(1)))


def test_of_a_symmetric_piece_one_half_is_asked_for() -> None:
    atlas, _ = symmetric_loop()
    run, engine = go(atlas, atlas_work.proving)
    asked = dict(engine.asked)
    assert asked["p000"] == ("0x0", "0x1")
    assert asked["p001"] == ("-0x1", "0x1")
    assert not run.pending


def test_a_piece_that_fails_is_split_and_the_others_are_left_whole() -> None:
    run, engine = go(CURVE, atlas_work.short_only)
    # Both attempts at the whole and at its halves, one at their halves.
    assert [name for name, _ in engine.asked].count("p001") == 2 * (1 + 2) + 4
    assert [name for name, _ in engine.asked].count("p000") == 1
    assert run.plan_of("p001").is_proved
    assert covers([interval_of(r) for r in run.results_of("p001") if r["verdict"] == "proved"], whole(CURVE.pieces[1]))
    proved = [interval_of(result) for result in run.results_of("p001") if result["verdict"] == "proved"]
    assert all(left[1] > right[0] for left, right in pairwise(sorted(proved)))


@pytest.mark.parametrize("splits", [0, 1, 3])
def test_a_piece_is_given_up_at_the_first_interval_that_may_not_be_split(splits: int) -> None:
    run, engine = go(CURVE, atlas_work.not_the_second, RunLimits({}, None, splits))
    assert [name for name, _ in engine.asked].count("p001") == 2 * (splits + 1)
    assert run.plan_of("p001").failed
    assert not run.plan_of("p001").is_proved
    assert run.plan_of("p002").is_proved
    assert run.pending == []


def test_more_splits_go_on_where_fewer_ended() -> None:
    run, _ = go(CURVE, atlas_work.short_only, RunLimits({}, None, 1))
    assert not run.plan_of("p001").is_proved
    more, engine = go(CURVE, atlas_work.short_only, RunLimits({}, None, 2), run.results)
    assert more.plan_of("p001").is_proved
    assert ("p001", ("-0x1", "0x1")) not in engine.asked
    assert {name for name, _ in engine.asked} == {"p001"}


def test_a_proved_interval_counts_only_if_it_covers_what_is_asked() -> None:
    piece = CURVE.pieces[1]
    nearly = {"piece": "p001", "interval": ["-0x1", format_exact(1 - Fraction(1, 2**40))], "verdict": "proved"}
    assert plan(piece, [nearly], [{}], 3).missing == (((Fraction(-1), Fraction(1)), 0),)
    assert plan(piece, [{**nearly, "interval": ["-0x1", "0x1"]}], [{}], 3).is_proved


def test_more_precision_is_tried_before_an_interval_is_split() -> None:
    run, engine = go(CURVE, atlas_work.precise_only)
    assert not run.pending
    assert [name for name, _ in engine.asked].count("p001") == 2
    precisions = [result["computation"]["precision"] for result in run.results_of("p001")]
    assert precisions[0] < precisions[1]
    assert run.plan_of("p001").is_proved


def test_what_takes_too_long_is_split_at_once() -> None:
    piece = CURVE.pieces[1]
    late = {
        "piece": "p001", "interval": ["-0x1", "0x1"], "verdict": "not proved",
        "reason": {"condition": "time", "message": "", "remedy": ""}, "computation": {"precision": 80},
    }  # fmt: skip
    missing = plan(piece, [late], [{"precision": 80}, {"precision": 128}], 3).missing
    assert missing == tuple((half, 0) for half in halves(whole(piece)))


# Certificates


def certificate_of(atlas: Atlas, work: Any) -> dict[str, Any]:
    run, _ = go(atlas, work)
    return make_atlas_certificate(atlas, run.results, None)


def test_a_certificate_is_written_and_read_again(tmp_path: Path) -> None:
    path = tmp_path / "curve.json"
    certificate = certificate_of(CURVE, atlas_work.short_only)
    write_atlas_certificate(path, certificate)
    stored = read_atlas_certificate(path)
    assert stored.document == certificate
    assert replace(stored.atlas, provenance=CURVE.provenance) == CURVE
    assert not stored.is_proved
    keys = [(result["piece"], interval_of(result)) for result in stored.results]
    assert keys == sorted(keys)


def test_a_changed_certificate_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "curve.json"
    write_atlas_certificate(path, certificate_of(CURVE, atlas_work.proving))
    text = path.read_text()
    path.write_text(text.replace('"0x1p-30"', '"0x1p-31"', 1))
    with pytest.raises(InputError, match="digest"):
        read_atlas_certificate(path)
    document = json.loads(text)
    document["results"][0]["piece"] = "p777"
    document["digest"] = digest(document)
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"results\[0\]\.piece"):
        read_atlas_certificate(path)


def test_what_is_not_proved_carries_no_theorem(tmp_path: Path) -> None:
    certificate = certificate_of(CURVE, atlas_work.proving)
    certificate["statement"]["theorem"] = "all is well"
    with pytest.raises(InputError):
        write_atlas_certificate(tmp_path / "curve.json", certificate)


# The command


def test_the_theorem_is_proved_printed_and_stored(tmp_path: Path, capsys: Any) -> None:
    target = tmp_path / "curve.json"
    code = main([write(tmp_path / "atlas.json"), "-o", str(target)], atlas_work.short_only)
    output, errors = capsys.readouterr()
    assert code == 0, output + errors
    stored = read_atlas_certificate(target)
    assert stored.is_proved
    assert stored.document["statement"]["theorem"] in output
    assert stored.document["conclusion"]["joints"]
    assert "p001: again with more precision, not proved for s in [-1, 1]: the tube is empty" in errors
    assert "p001: split, not proved for s in [-1, 1]: the tube is empty" in errors
    assert "[3/3]" in errors
    assert "s left" in errors
    row = next(line for line in output.splitlines() if line.startswith("p001"))
    assert row.split() == ["p001", "regular", "proved", "4", "physical", "28", "4.0", "s"]

    assert main(["--recheck", str(target)]) == 0
    assert "stands" in capsys.readouterr().out


def test_a_conclusion_that_the_results_do_not_give_does_not_stand(tmp_path: Path, capsys: Any) -> None:
    target = tmp_path / "curve.json"
    assert main([write(tmp_path / "atlas.json"), "-o", str(target), "--quiet"], atlas_work.proving) == 0
    document = json.loads(target.read_text())
    document["results"] = [result for result in document["results"] if result["piece"] != "p001"]
    document["digest"] = digest(document)
    target.write_text(json.dumps(document))
    capsys.readouterr()
    assert main(["--recheck", str(target)]) == 1
    output, errors = capsys.readouterr()
    assert "DOES NOT STAND" in output
    assert "verdict: stored is 'proved', evaluated again it is 'not proved'" in errors


def test_every_interval_is_proved_again_with_more_precision(tmp_path: Path, capsys: Any) -> None:
    target = str(tmp_path / "curve.json")
    assert main([write(tmp_path / "atlas.json"), "-o", target, "--quiet"], atlas_work.short_only) == 0
    capsys.readouterr()
    assert main(["--recheck", "--integrate", target], atlas_work.precise_only) == 0
    output, errors = capsys.readouterr()
    assert "stands  3 integration" in output
    assert "[6/6]" in errors
    assert main(["--recheck", "--integrate", target], atlas_work.not_the_second) == 1
    output, errors = capsys.readouterr()
    assert "DOES NOT STAND" in output
    assert output.count("parabola: piece p001, s in") == 4
    assert "FAILED parabola: piece p001, s in" in errors
    assert main(["--recheck", "--integrate", target], atlas_work.other_times) == 1
    assert "half period: stored is [2.75, 3.25], which the new integration does not confirm" in capsys.readouterr().err


def test_a_piece_that_cannot_be_proved_is_named_and_the_rest_is_kept(tmp_path: Path, capsys: Any) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    assert main([source, "-o", str(target), "--max-splits", "1"], atlas_work.not_the_second) == 1
    output, errors = capsys.readouterr()
    assert "NOT PROVED" in output
    assert errors.count("p001: not proved: the tube is empty") == 1
    assert "[4/3]" not in errors
    assert "Traceback" not in errors
    stored = read_atlas_certificate(target)
    assert {r["piece"] for r in stored.results if r["verdict"] == "proved"} == {"p000", "p002"}

    # The same command with more splits proves p001 and nothing else.
    assert main([source, "-o", str(target), "--max-splits", "2"], atlas_work.short_only) == 0
    output, errors = capsys.readouterr()
    assert "2 of 3 pieces settled already" in errors
    assert [line.split()[-1] for line in output.splitlines() if line.startswith(("p000", "p002"))] == ["kept", "kept"]


def test_a_process_that_ends_costs_its_piece_only_and_is_tried_again(tmp_path: Path, capsys: Any) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    assert main([source, "-o", str(target), "--jobs", "2"], atlas_work.dying) == 1
    assert "exit code 3" in capsys.readouterr().err
    assert {r["piece"] for r in read_atlas_certificate(target).results if r["verdict"] == "proved"} == {"p000", "p002"}
    assert main([source, "-o", str(target), "--quiet"], atlas_work.proving) == 0


def test_an_interval_without_end_is_ended_at_the_time_limit(tmp_path: Path, capsys: Any) -> None:
    source = write(tmp_path / "atlas.json")
    assert main([source, "--timeout", "0.2", "--max-splits", "0"], atlas_work.endless) == 1
    errors = capsys.readouterr().err
    assert "p001: not proved: the time limit of 0.2 s passed within one step" in errors
    assert "p002: proved" in errors


def test_a_piece_that_changed_is_proved_again_and_only_that(tmp_path: Path, capsys: Any) -> None:
    target = tmp_path / "curve.json"
    assert main([write(tmp_path / "atlas.json"), "-o", str(target), "--quiet"], atlas_work.proving) == 0
    first, second, third = CURVE.curve_pieces()
    changed = replace(CURVE, pieces=(first, replace(second, tube=(second.tube[0] / 2,)), third))
    assert main([write(tmp_path / "atlas.json", changed), "-o", str(target)], atlas_work.proving) == 0
    errors = capsys.readouterr().err
    assert "2 of 3 pieces settled already" in errors
    assert "[1/1] p001: proved" in errors
    assert read_atlas_certificate(target).atlas.curve_pieces()[1] == changed.curve_pieces()[1]
    assert main([write(tmp_path / "atlas.json", changed), "-o", str(target), "--fresh"], atlas_work.proving) == 0
    assert "[3/3]" in capsys.readouterr().err


def test_results_of_other_software_are_not_kept(tmp_path: Path, capsys: Any) -> None:
    target = tmp_path / "curve.json"
    certificate = certificate_of(CURVE, atlas_work.proving)
    certificate["software"] = {**certificate["software"], "source": "sha256:other"}
    certificate["digest"] = digest(certificate)
    write_atlas_certificate(target, certificate)
    assert main([write(tmp_path / "atlas.json"), "-o", str(target)], atlas_work.proving) == 0
    assert "[3/3]" in capsys.readouterr().err


def test_an_interrupt_keeps_finished_pieces_and_the_same_command_goes_on(tmp_path: Path, capsys: Any) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    call = f"main({[source, '-o', str(target)]!r}, atlas_work.endless)"
    code = (
        f"from support import atlas_work; from orbitproof.verify.atlas.__main__ import main; raise SystemExit({call})"
    )
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}"}
    with started(["-c", code], env=environment) as run:
        wait_until(target.exists)
        time.sleep(0.3)
        # As a terminal does: to every process of the group.
        os.killpg(run.pid, signal.SIGINT)
        output, errors = run.communicate(timeout=60)
    assert run.returncode == 1
    assert "interrupted: 1 of 3 pieces finished, saved in" in errors
    assert "Traceback" not in errors
    assert "not finished" in output
    stored = read_atlas_certificate(target)
    assert stored.document["reason"]["condition"] == "unfinished"
    assert [result["piece"] for result in stored.results] == ["p000"]
    assert main(["--recheck", str(target)]) == 1

    assert main([source, "-o", str(target)], atlas_work.proving) == 0
    assert "1 of 3 pieces settled already" in capsys.readouterr().err
    assert read_atlas_certificate(target).is_proved


def test_examples_of_the_help_parse(capsys: Any) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    text = capsys.readouterr().out.partition("examples:")[2]
    commands = [shlex.split(line) for line in re.findall(r"orbitproof verify atlas (.+)", text)]
    assert len(commands) >= 5
    for command in commands:
        assert _parser().parse_args(command).file.suffix == ".json"


def refused(capsys: Any, *arguments: str) -> str:
    assert main(list(arguments), atlas_work.proving) == 2
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("error: ")
    assert errors.count("\n") == 1
    return str(errors)


def test_bad_input_is_one_line_and_exit_code_2(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    assert "cannot be read" in refused(capsys, str(tmp_path / "none.json"))
    assert "does not exist" in refused(capsys, source, "-o", str(tmp_path / "none" / "curve.json"))
    assert "--only" in refused(capsys, source, "--only", "x")
    certificates = str(ROOT / "tests" / "data" / "figures-certificates.json")
    text = refused(capsys, source, "--bifurcations", certificates, "--only", "halo-*", "none-such")
    assert "--only none-such: no such bifurcation; the ids are: " in text
    assert "is in another file too" in refused(capsys, source, "--bifurcations", certificates, certificates)
    assert "--integrate" in refused(capsys, source, "--integrate")
    assert "too small" in refused(capsys, source, "--precision", "3")
    assert "not an address" in refused(capsys, source, "--scheduler", "somewhere")
    assert "--output: --recheck writes no file" in refused(capsys, "--recheck", source, "-o", str(target))
    assert "the file holds an atlas" in refused(capsys, "--recheck", source)
    write_atlas_certificate(target, certificate_of(replace(CURVE, id="another"), atlas_work.proving))
    assert "certificate of another atlas ('another')" in refused(capsys, source, "-o", str(target))
    target.write_text("{")
    assert "or replace the file with --fresh" in refused(capsys, source, "-o", str(target))
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "install orbitproof[cluster]" in refused(capsys, source, "--scheduler", "127.0.0.1:8786")
    for arguments in (["--jobs", "0"], ["--max-splits", "x"], ["--timeout", "-1"], ["--width"]):
        with pytest.raises(SystemExit) as stopped:
            main([source, *arguments])
        assert stopped.value.code == 2


def test_a_full_disk_ends_the_run_in_one_line(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"

    def full(*arguments: Any) -> None:
        raise InputError(f"{target}: cannot be written (No space left on device); free space")

    monkeypatch.setattr("orbitproof.verify.atlas.__main__.write_atlas_certificate", full)
    assert main([source, "-o", str(target)], atlas_work.proving) == 2
    errors = capsys.readouterr().err
    assert errors.splitlines()[-1].startswith(f"error: {target}: cannot be written")
    assert "Traceback" not in errors


# Engines


def test_an_engine_asks_for_more_after_every_answer() -> None:
    """Tasks that exist only because of an answer are done too, also by processes that had become idle."""
    waiting = [Task("p001", task_argument("p001"))]
    names: list[str] = []

    def source() -> Task | None:
        return waiting.pop() if waiting else None

    def finished(answer: Answer) -> None:
        names.append(answer.task.name)
        if len(names) == 1:
            waiting.extend(Task(name, task_argument(name)) for name in ("a", "b", "c"))

    Processes(2).run(atlas_work.proving, source, lambda *_: None, finished)
    assert names[0] == "p001"
    assert sorted(names[1:]) == ["a", "b", "c"]


def task_argument(name: str) -> dict[str, Any]:
    return {"piece": {"id": name, "tube": ["1"]}, "interval": ["-0x1", "0x1"], "integrator": {}}


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_gives_the_same_certificate_as_processes(tmp_path: Path, capsys: Any) -> None:
    distributed = pytest.importorskip("distributed")
    sys.path.insert(0, str(ROOT / "tests"))
    source = write(tmp_path / "atlas.json")
    options = {"n_workers": 2, "threads_per_worker": 2, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(**options) as cluster:
        address = cluster.scheduler_address
        assert main([source, "-o", str(tmp_path / "a.json"), "--scheduler", address], atlas_work.short_only) == 0
        assert main([source, "-o", str(tmp_path / "c.json"), "--scheduler", address], atlas_work.dying) == 1
    assert main([source, "-o", str(tmp_path / "b.json"), "--jobs", "2"], atlas_work.short_only) == 0
    by_cluster, by_processes = (json.loads((tmp_path / name).read_text()) for name in ("a.json", "b.json"))
    assert by_cluster == by_processes
    lost = [r for r in read_atlas_certificate(tmp_path / "c.json").results if r["verdict"] != "proved"]
    assert [result["piece"] for result in lost] == ["p001"]
    assert "the cluster has no result for it (KilledWorker)" in lost[0]["reason"]["message"]


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_without_workers_or_with_other_software_is_refused(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("distributed")
    source = write(tmp_path / "atlas.json")
    options = {"threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(n_workers=0, **options) as cluster:
        assert "has no workers" in refused(capsys, source, "--scheduler", cluster.scheduler_address)
    with distributed.LocalCluster(n_workers=1, **options) as cluster:
        monkeypatch.setattr(
            "orbitproof.verify.engines.cluster.software", lambda: {"source": f"of process {os.getpid()}"}
        )
        assert "install the same version everywhere" in refused(
            capsys, source, "--scheduler", cluster.scheduler_address
        )
