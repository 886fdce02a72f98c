"""The command that proves an atlas: certificates, interrupted runs, bad input."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import sys
from contextlib import nullcontext
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import atlas_work
from support.atlas_runs import CURVE, ROOT, InOrder, go, refused, write
from support.claims import known
from support.closed_form_lists import line
from support.forgeries import DATA, atlas_certificate, of_parabola, read
from support.runs import started, wait_until
from support.stored import values

from orbitproof.shared import InputError
from orbitproof.shared.claims import Atlas
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.systems import AROUND
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.certificate import (
    Limits,
    certify,
    digest,
    read_certificate,
    write_certificate,
    write_certificates,
)
from orbitproof.verify.oracle import steps_about
from orbitproof.verify.run import piece_order
from orbitproof.verify.run.branch_command import _parser, main
from orbitproof.verify.run.branch_tasks import RunLimits, attempts_of
from orbitproof.verify.run.branches import AtlasRun
from orbitproof.verify.run.workplace import Workplace


def certificate_of(atlas: Atlas, work: Any) -> dict[str, Any]:
    run, _ = go(atlas, work)
    return make_atlas_certificate(atlas, values(run.results), None)


def test_a_certificate_is_written_and_read_again(tmp_path: Path) -> None:
    path = tmp_path / "curve.json"
    certificate = certificate_of(CURVE, atlas_work.short_only)
    write_certificate(path, certificate)
    stored = read_certificate(path, "atlas-certificate")
    assert stored.document == certificate
    assert replace(stored.atlas, provenance=CURVE.provenance) == CURVE
    assert not stored.proved
    keys = [(result.piece, result.interval) for result in stored.results]
    assert keys == sorted(keys)


def test_a_changed_certificate_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "curve.json"
    write_certificate(path, certificate_of(CURVE, atlas_work.proving))
    text = path.read_text()
    path.write_text(text.replace('"0x1p-30"', '"0x1p-31"', 1))
    with pytest.raises(InputError, match="digest"):
        read_certificate(path, "atlas-certificate")
    document = json.loads(text)
    document["results"][0]["piece"] = "p777"
    document["digest"] = digest(document)
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"results\[0\]\.piece"):
        read_certificate(path, "atlas-certificate")


def test_what_is_not_proved_carries_no_theorem(tmp_path: Path) -> None:
    certificate = certificate_of(CURVE, atlas_work.proving)
    certificate["statement"]["theorem"] = "all is well"
    with pytest.raises(InputError):
        write_certificate(tmp_path / "curve.json", certificate)


def test_the_theorem_is_proved_printed_and_stored(tmp_path: Path, capsys: Any) -> None:
    target = tmp_path / "curve.json"
    code = main([write(tmp_path / "atlas.json"), "-o", str(target)], atlas_work.short_only)
    output, errors = capsys.readouterr()
    assert code == 0, output + errors
    stored = read_certificate(target, "atlas-certificate")
    assert stored.proved
    assert " ".join(stored.document["statement"]["theorem"].split()) in " ".join(output.split())
    assert all(len(line) <= 80 for line in output.splitlines())
    assert stored.document["conclusion"]["joints"]
    place = ", ".join(
        f"{name} = {float(value):.6g}"
        for name, value in zip(CURVE.system.centre_coordinates, CURVE.pieces[1].point(Fraction(0)), strict=True)
    )
    assert f"p001: again with more precision, not proved for s in [-1, 1], near {place}: the tube is empty" in errors
    assert f"p001: split, not proved for s in [-1, 1], near {place}: the tube is empty" in errors
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
    assert "stored is 3, evaluated again it is 2" in errors


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
    assert "half period: stored is [2.75, 3.25], disjoint from [8.75, 9.25]" in capsys.readouterr().err


def test_a_piece_that_cannot_be_proved_is_named_and_the_rest_is_kept(tmp_path: Path, capsys: Any) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    assert main([source, "-o", str(target), "--max-splits", "1"], atlas_work.not_the_second) == 1
    output, errors = capsys.readouterr()
    assert "NOT PROVED" in output
    assert len(re.findall(r"p001: not proved, near beta = [0-9.]+, y = [0-9.]+: the tube is empty", errors)) == 1
    assert "[4/3]" not in errors
    assert "Traceback" not in errors
    stored = read_certificate(target, "atlas-certificate")
    assert {r.piece for r in stored.results if r.is_proved} == {"p000", "p002"}

    # The same command with more splits proves p001 and nothing else.
    assert main([source, "-o", str(target), "--max-splits", "2"], atlas_work.short_only) == 0
    output, errors = capsys.readouterr()
    assert "2 of 3 pieces settled already" in errors
    assert [line.split()[-1] for line in output.splitlines() if line.startswith(("p000", "p002"))] == ["kept", "kept"]


def test_a_process_that_ends_costs_its_piece_only_and_is_tried_again(tmp_path: Path, capsys: Any) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    assert main([source, "-o", str(target), "--jobs", "2"], atlas_work.dying) == 1
    assert "exit code 3" in capsys.readouterr().err
    assert {r.piece for r in read_certificate(target, "atlas-certificate").results if r.is_proved} == {"p000", "p002"}
    assert main([source, "-o", str(target), "--quiet"], atlas_work.proving) == 0


@pytest.mark.usefixtures("little_grace")
def test_an_interval_without_end_is_ended_at_the_time_limit(tmp_path: Path, capsys: Any) -> None:
    source = write(tmp_path / "atlas.json")
    assert main([source, "--timeout", "0.2", "--max-splits", "0"], atlas_work.endless) == 1
    errors = capsys.readouterr().err
    assert re.search(r"p001: not proved, near .*: the time limit of 0.2 s passed within one step", errors)
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
    assert read_certificate(target, "atlas-certificate").atlas.curve_pieces()[1] == changed.curve_pieces()[1]
    assert main([write(tmp_path / "atlas.json", changed), "-o", str(target), "--fresh"], atlas_work.proving) == 0
    assert "[3/3]" in capsys.readouterr().err


def test_results_of_other_software_are_not_kept(tmp_path: Path, capsys: Any) -> None:
    target = tmp_path / "curve.json"
    certificate = certificate_of(CURVE, atlas_work.proving)
    certificate["software"] = {**certificate["software"], "source": "sha256:other"}
    certificate["digest"] = digest(certificate)
    write_certificate(target, certificate)
    assert main([write(tmp_path / "atlas.json"), "-o", str(target)], atlas_work.proving) == 0
    assert "[3/3]" in capsys.readouterr().err


def test_a_proof_of_other_software_stays_until_there_is_a_new_one(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However often a run is interrupted, and where it ends without a proof."""
    monkeypatch.setattr(Workplace, "engine", lambda *_: nullcontext(InOrder()))
    target, beside, asked = tmp_path / "curve.json", tmp_path / "curve.json.unfinished", []
    words = [write(tmp_path / "atlas.json"), "-o", str(target), "--quiet"]

    def every_other(argument: Any, report: Any) -> Any:
        asked.append(argument["piece"]["id"])
        if len(asked) % 2 == 0:
            raise KeyboardInterrupt
        return atlas_work.proving(argument, report)

    def of_other_software() -> bytes:
        document = json.loads(target.read_text())
        document["software"]["source"] = "sha256:other"
        target.write_text(json.dumps(document | {"digest": digest(document)}))
        return target.read_bytes()

    assert main(words, atlas_work.proving) == 0
    before = of_other_software()
    for done in (1, 2):
        assert main(words, every_other) == INTERRUPTED
        assert f"interrupted: {done} of 3 pieces finished, saved in {beside}" in capsys.readouterr().err
        assert target.read_bytes() == before
    assert main(words, every_other) == 0
    assert len(asked) == 5
    assert not beside.exists()
    assert read_certificate(target, "atlas-certificate").proved
    assert target.read_bytes() != before

    before = of_other_software()
    assert main([*words, "--max-splits", "0"], atlas_work.failing) == 1
    assert f"{target}: still holds the proof of before; what was found now: {beside}" in capsys.readouterr().err
    assert target.read_bytes() == before
    assert not read_certificate(beside, "atlas-certificate").proved
    beside.write_text("{")
    assert "or replace the file with --fresh" in refused(capsys, *words)
    assert main([*words, "--fresh"], atlas_work.proving) == 0
    assert not beside.exists()


def test_an_interrupt_keeps_finished_pieces_and_the_same_command_goes_on(tmp_path: Path, capsys: Any) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    call = f"main({[source, '-o', str(target)]!r}, atlas_work.endless)"
    imports = "from support import atlas_work; from orbitproof.verify.run.branch_command import main"
    code = f"{imports}; raise SystemExit({call})"
    places = [str(ROOT / "tests"), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(places)}
    with started(["-c", code], env=environment) as run:
        wait_until(lambda: target.exists() and len(read_certificate(target, "atlas-certificate").results) == 2)
        # As a terminal does: to every process of the group.
        os.killpg(run.pid, signal.SIGINT)
        output, errors = run.communicate(timeout=60)
    assert run.returncode == INTERRUPTED
    assert "interrupted: 2 of 3 pieces finished, saved in" in errors
    assert "Traceback" not in errors
    assert "not finished" in output
    stored = read_certificate(target, "atlas-certificate")
    assert stored.document["reason"]["condition"] == "unfinished"
    assert [result.piece for result in stored.results] == ["p000", "p002"]
    assert main(["--recheck", str(target)]) == 1

    assert main([source, "-o", str(target)], atlas_work.proving) == 0
    assert "2 of 3 pieces settled already" in capsys.readouterr().err
    assert read_certificate(target, "atlas-certificate").proved


def test_pieces_whose_orbits_take_the_most_steps_are_proved_first(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = attempts_of(CURVE, RunLimits({}))[0]
    names = CURVE.system.centre_coordinates
    points = [dict(zip(names, map(float, piece.centre), strict=True)) for piece in CURVE.curve_pieces()]
    found = steps_about(CURVE.system, points, settings["precision"], settings["order"])
    assert all(1 < number < 100 for number in found)
    assert steps_about(CURVE.system, points[:1], 2 * settings["precision"], settings["order"])[0] > found[0]
    assert steps_about(AROUND["L1"], points, settings["precision"], settings["order"]) == [0] * 3
    for numbers, order in (([3, 9, 5], ["p001", "p002", "p000"]), ([0, 0, 0], ["p000", "p001", "p002"])):
        monkeypatch.setattr(piece_order, "steps_about", lambda *_, numbers=numbers: numbers)
        run, tasks = AtlasRun(CURVE, RunLimits({})), []
        while (task := run._next()) is not None:
            tasks.append(task.name)
        assert tasks == order


def test_lists_of_curves_with_one_stability_parameter_take_fewer_bits() -> None:
    atlases = line(1, 2, True).atlas(4), line(1, 1, True).atlas(4)
    assert [len(atlas.curve_pieces()[0].tube) for atlas in atlases] == [2, 1]
    two, one = (attempts_of(atlas, RunLimits({}, stability=True)) for atlas in atlases)
    names = {"precision", "order", "width"}
    assert all(set(settings) - {"top"} == names for settings in (*one, *two))
    assert all(fewer[name] < more[name] for fewer, more in zip(one, two, strict=True) for name in names)
    assert all(one[0][name] < one[1][name] for name in names)
    assert attempts_of(atlases[1], RunLimits({"width": 9}, stability=True))[0] == {**one[0], "width": 9}


def test_examples_of_the_help_parse(capsys: Any) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    text = capsys.readouterr().out.partition("examples:")[2].replace("\\\n", " ")
    commands = [shlex.split(line) for line in re.findall(r"orbitproof verify atlas (.+)", text)]
    assert len(commands) >= 5
    for command in commands:
        assert _parser().parse_args(command).file.suffix == ".json"


def test_bad_input_is_one_line_and_exit_code_2(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target = write(tmp_path / "atlas.json"), tmp_path / "curve.json"
    assert "cannot be read" in refused(capsys, str(tmp_path / "none.json"))
    assert "does not exist" in refused(capsys, source, "-o", str(tmp_path / "none" / "curve.json"))
    assert "--only" in refused(capsys, source, "--only", "x")
    certificates = str(ROOT / "tests" / "data" / "figures-certificates.json")
    text = refused(capsys, source, "--bifurcations", certificates, "--only", "halo-*", "none-such")
    assert "--only none-such: no such bifurcation; known: " in text
    assert "is in another file too" in refused(capsys, source, "--bifurcations", certificates, certificates)
    assert "--integrate" in refused(capsys, source, "--integrate")
    assert "too small" in refused(capsys, source, "--precision", "3")
    assert "not an address" in refused(capsys, source, "--scheduler", "somewhere")
    assert "--output: --recheck writes no file" in refused(capsys, "--recheck", source, "-o", str(target))
    assert "the file holds an atlas" in refused(capsys, "--recheck", source)
    write_certificate(target, certificate_of(replace(CURVE, id="another"), atlas_work.proving))
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

    monkeypatch.setattr("orbitproof.verify.run.branches.write_certificate", full)
    assert main([source, "-o", str(target)], atlas_work.proving) == 2
    errors = capsys.readouterr().err
    assert errors.splitlines()[-1].startswith(f"error: {target}: cannot be written")
    assert "Traceback" not in errors


def test_bifurcations_stand_beside_a_curve_that_is_checked_again_and_not_beside_a_surface(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    point = certify(known("fs3"), Limits(max_precision=256))
    write_certificates(tmp_path / "points.json", [point])
    atlas, results = of_parabola()
    surface = json.loads((DATA / "surface-results.json").read_text())
    documents = {
        "with": atlas_certificate(atlas, results, [point]),
        "without": atlas_certificate(atlas, results),
        "surface": atlas_certificate(read("surface.json"), surface),
    }
    codes = {}
    for name, document in documents.items():
        write_certificate(tmp_path / f"{name}.json", document)
        given = ["--recheck", str(tmp_path / f"{name}.json"), "--bifurcations", str(tmp_path / "points.json")]
        codes[name] = main([*given, "--quiet"])
    assert codes == {"with": 0, "without": 1, "surface": 2}
    assert "are looked for on curves of symmetric orbits only" in capsys.readouterr().err
