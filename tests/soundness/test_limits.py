"""Files that would take all time or memory: what cannot be checked is said so, and everything else goes on."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from jsonschema.exceptions import ValidationError
from support import process_work
from support.claims import known
from support.forgeries import DATA, atlas_certificate, forged, read
from test_forged_certificates import of_parabola

from orbitproof import verify
from orbitproof.figures.commands.report import main as report
from orbitproof.shared import parse_exact
from orbitproof.shared.formats import InputError, documents, read_document, stated_format, validate_document
from orbitproof.shared.interrupts import run_command
from orbitproof.shared.systems import (
    CR3BP,
    program_from_text,
    record,
)
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate, Given, Level, Limits, Recheck, certify, rechecking
from orbitproof.verify.claim import derivative_terms, is_first_integral
from orbitproof.verify.evidence import ball_to_json
from orbitproof.verify.run import CHECK_SECONDS, INTEGRATION_SECONDS, Answer, CheckLimits, second_proofs, workplace
from orbitproof.verify.run import branch_checks as apart
from orbitproof.verify.run import rows as side_by_side
from orbitproof.verify.run.branch_checks import check_apart, places_on_apart
from orbitproof.verify.run.row_command import _parser

HEAD = {"format": "orbitproof-certificates", "version": 1, "software": {}}
INPUTS = [f"v{n} = {name}" for n, name in enumerate(("x", "y", "z", "vx", "vy", "vz", "mu"))]


def program(*lines: str) -> str:
    """A function of state and parameters of the three-body problem, whose value is the last line."""
    body = [*INPUTS, *(f"v{n} = {line}" for n, line in enumerate(lines, start=len(INPUTS)))]
    return "\n".join([*body, f"return v{len(body) - 1}"])


def squarings(first: str, number: int) -> str:
    return program(first, *(f"v{n} * v{n}" for n in range(len(INPUTS), len(INPUTS) + number)))


INTEGRALS = {
    "a power": program("v0 + v2", "v7 ** (999999999)"),
    "a power of a power": program("v0 + v2", "v7 ** (100)", "v8 ** (100)", "v9 ** (100)"),
    "a root of a power": program("v0 + v2", "v7 ** (1/999999999)", "v8 ** (-999999998/999999999)"),
    "squarings of a constant": squarings("3", 60),
    "powers of a constant": program("3", "v7 ** (100)", "v8 ** (100)", "v9 ** (100)", "v10 ** (100)"),
    "powers of a quotient": program("1/3", "v7 ** (-100)", "v8 ** (-100)", "v9 ** (-100)", "v10 ** (-100)"),
    "squarings of a polynomial": squarings("v0 + v2", 40),
    "squarings of a quotient": program("v0 + v2", "v6 / v7", *(f"v{n} * v{n}" for n in range(8, 48))),
}


@pytest.fixture(scope="module")
def honest() -> dict[str, Any]:
    """The certificate of a Falkner-Skan touch-and-go bifurcation, which stands."""
    return certify(known("fs3"), Limits(max_precision=256)).to_json()


def stranger(integral: str) -> dict[str, Any]:
    """A certificate that claims nothing, of a system that nobody knows, with this first integral."""
    rows = json.loads((DATA / "figures-certificates.json").read_text("utf-8"))["certificates"]

    def change(entry: dict[str, Any]) -> None:
        entry["id"] = "stranger"
        entry["statement"]["candidate"].update(id="stranger", system="stranger")
        entry["statement"].update(first_integral=integral, names={"system": "stranger", "first_integral": "H"})
        entry["statement"].pop("theorem")
        entry["statement"].pop("in_full", None)
        reason = {"condition": "symmetries", "message": "not shown", "remedy": "none"}
        entry.update(verdict="not proved", reason=reason, results=None, hypotheses=[], enclosures=None)

    return forged(next(row for row in rows if row["id"] == "earth-moon-L1-halo-k2-1"), change)


def written(path: Path, *entries: dict[str, Any]) -> str:
    path.write_text(json.dumps({**HEAD, "certificates": list(entries)}), "utf-8")
    return str(path)


def rows_of(capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """The lines of the table of checks, by id."""
    return {line.split()[0]: line for line in capsys.readouterr().out.splitlines() if "  " in line}


@pytest.mark.parametrize("kind", INTEGRALS)
def test_a_first_integral_without_end_is_refused_before_it_is_evaluated(
    kind: str, honest: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "both.json", stranger(INTEGRALS[kind]), honest)
    main(["--recheck", path, "--quiet", "--row-timeout", "20", "--memory", "1"])
    rows = rows_of(capsys)
    assert "cannot be checked" not in rows["stranger"]
    assert " stands " in rows[honest["id"]]
    with pytest.raises(ValueError, match="exponent") if "999999999" in INTEGRALS[kind] else nullcontext():
        function = program_from_text(INTEGRALS[kind])
        assert not is_first_integral(CR3BP.program, function)
        assert derivative_terms(function, "x") is None


def test_a_first_integral_that_takes_some_work_is_shown() -> None:
    integral = CR3BP.first_integral
    assert integral is not None
    power = record(lambda x, p: (integral(x, p)[0] ** 4,), CR3BP.state, tuple(CR3BP.parameters))
    assert is_first_integral(CR3BP.program, power)


def slow(honest: dict[str, Any]) -> dict[str, Any]:
    """A certificate that says it was made with so many bits that integrating again takes hours."""

    def change(entry: dict[str, Any]) -> None:
        entry["id"] = entry["statement"]["candidate"]["id"] = "slow"
        entry["computation"].update(precision=4000, order=4000)
        entry.update(rechecking.derived(entry))

    return forged(honest, change)


@pytest.mark.usefixtures("little_grace")
def test_an_integration_without_end_costs_its_own_row_only(
    honest: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "both.json", slow(honest), honest)
    assert main(["--recheck", path, "--quiet"]) == 0
    assert main(["--recheck", "--integrate", path, "--quiet", "--row-timeout", "3"]) == 1
    table = capsys.readouterr().out
    assert "slow: the time limit of 3 s passed within one step; the process was ended" in table
    assert f"{honest['id']}  proved   stands" in table
    assert multiprocessing.active_children() == []


@pytest.mark.usefixtures("little_grace")
def test_a_notebook_survives_an_integration_without_end(honest: dict[str, Any]) -> None:
    entries = [Certificate.from_json(entry) for entry in (slow(honest), honest)]
    first, second = verify.recheck(entries, integrate=True, timeout=3.0, quiet=True)
    assert (first.stands, first.findings, first.level) == (False, (), Level.CONCLUSION)
    assert "time limit" in first.obstacle
    assert second.stands
    with pytest.raises(ValueError, match="timeout"):
        verify.recheck(entries, timeout=-1.0, quiet=True)
    with pytest.raises(ValueError, match="memory"):
        verify.recheck(entries, memory=0.0, quiet=True)


ENDS = {
    "hangs": (process_work.hanging, "the time limit of 0.5 s passed", 0.5),
    "is ended by FLINT": (process_work.aborting, "SIGABRT", 60.0),
    "takes memory without end": (process_work.growing, "more memory than 0.25 GiB", 60.0),
    "takes memory in FLINT": (process_work.growing_in_flint, "SIGABRT", 60.0),
}
"""What happens, how it is told, and a limit of time in seconds that comes first only where nothing else does."""


@pytest.mark.usefixtures("little_grace")
@pytest.mark.parametrize("how", ENDS)
def test_a_check_that_does_not_end_is_an_obstacle(
    how: str,
    honest: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    work, words, seconds = ENDS[how]
    monkeypatch.setattr(side_by_side, "recheck_task", work)
    path = written(tmp_path / "one.json", honest)
    assert main(["--recheck", path, "--quiet", "--row-timeout", str(seconds), "--memory", "0.25"]) == 1
    out = capsys.readouterr().out
    assert words in out
    assert "cannot be checked here" in out
    assert "DOES NOT" not in out


@pytest.mark.usefixtures("little_grace")
@pytest.mark.parametrize("how", ENDS)
def test_the_check_of_a_curve_that_does_not_end_is_an_obstacle(how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    work, words, seconds = ENDS[how]
    monkeypatch.setattr(apart, "recheck", work)
    curve = Certificate({"id": "curve", "verdict": "proved"})
    found = check_apart(curve, Given(), CheckLimits(seconds, 2**28))
    assert words in found.obstacle
    assert found.findings == ()


@pytest.mark.usefixtures("little_grace")
@pytest.mark.parametrize("how", ENDS)
def test_a_place_that_does_not_end_is_an_obstacle_of_its_row(
    how: str, honest: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    work, words, seconds = ENDS[how]
    monkeypatch.setattr(apart, "recheck_place", work)
    plain = Certificate.from_json(honest)
    place = {"rests_on": {"id": "curve", "digest": "sha256:" + 64 * "0"}, "piece": "p", "s": ball_to_json(arb(0)),
             "mirrored": False, "other_point": False, "statement": "It lies there."}  # fmt: skip
    placed = plain.with_place(place)
    check = Recheck(plain.id, "proved", 11, (), level=Level.CONCLUSION)
    found = apart.place_apart(None, None, placed, check, CheckLimits(seconds, 2**28))
    assert words in found.obstacle
    assert found.level is Level.FORM
    assert apart.place_apart(None, None, plain, check, CheckLimits(0.5)) is check


def refused(path: Path, text: str, command: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line with which a command refuses a file."""
    path.write_text(text, "utf-8")
    assert main([*command, "--quiet", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.mark.parametrize("depth", [200, 900, 5_000, 100_000])
@pytest.mark.parametrize("command", [["--recheck"], ["--second-proof"], ["atlas", "--recheck"]])
def test_a_document_of_great_depth_is_refused_in_one_line(
    depth: int, command: list[str], honest: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if command[0] == "atlas":
        document: dict[str, Any] = forged(a_curve(), lambda curve: curve["conclusion"].update(id="HERE"))
    else:
        document = {**HEAD, "certificates": [{**honest, "reason": "HERE"}]}
    text = json.dumps(document).replace('"HERE"', '{"a":' * depth + "1" + "}" * depth)
    line = refused(tmp_path / "deep.json", text, command, capsys)
    assert "nested" in line or "recursion" in line


def a_curve() -> dict[str, Any]:
    """The certificate of an atlas on which nothing is proved."""
    atlas = read("atlas-lyapunov.json")
    return json.loads(json.dumps(atlas_certificate(atlas, [])))  # type: ignore[no-any-return]


def test_numbers_that_fill_the_memory_are_refused_in_one_line(
    honest: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = json.dumps({**HEAD, "certificates": [{**honest, "results": ["0x1p999999"] * 10_000}]})
    assert "numbers are too long" in refused(tmp_path / "long.json", text, ["--recheck"], capsys)
    spaced = json.dumps({**HEAD, "certificates": [{**honest, "results": ["1e-99999"] * 30_000}]}, indent=1)
    assert "numbers are too long" in refused(tmp_path / "long.json", spaced, ["--recheck"], capsys)
    for plain, part, escape in ((text, "p9", r"\u00709"), (text, "p9", r"p\u0039"), (spaced, "1e-", r"1\u0065\u002d")):
        escaped = plain.replace(part, escape)
        assert json.loads(escaped) == json.loads(plain)
        assert "numbers are too long" in refused(tmp_path / "long.json", escaped, ["--recheck"], capsys)


@pytest.mark.parametrize("text", ["0x1p9999999", "1e999999", "1e999999999", "9" * 5000, "0x1p999999999"])
def test_a_number_that_is_too_long_to_write_out_is_none(text: str) -> None:
    with pytest.raises(ValueError):
        parse_exact(text)


def test_a_program_has_bounded_exponents_and_lines() -> None:
    with pytest.raises(ValueError, match="exponent 101 is too large"):
        program_from_text(program("v0 ** (101)"))
    with pytest.raises(ValueError, match="exponent 1/101 is too large"):
        program_from_text(program("v0 ** (1/101)"))
    with pytest.raises(ValueError, match="exponent 1000000000 is too large"):
        record(lambda x: (x[0] ** 10**9,), ("x",))
    assert program_from_text(program("v0 ** (-99/100)"))
    with pytest.raises(ValueError, match="at most 10000 lines"):
        program_from_text(squarings("v0 * v1", 10_000))


@pytest.mark.usefixtures("little_grace")
def test_commands_say_what_cannot_be_checked(
    honest: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(apart, "recheck", process_work.hanging)
    monkeypatch.setattr(side_by_side, "recheck_task", process_work.aborting)
    rows, curve = written(tmp_path / "rows.json", honest), tmp_path / "curve.json"
    curve.write_text(json.dumps(a_curve()), "utf-8")
    assert main(["atlas", "--recheck", str(curve), "--quiet", "--timeout", "0.5"]) == 1
    out = capsys.readouterr().out
    assert "cannot be checked here" in out
    assert "time limit of 0.5 s" in out
    output = tmp_path / "report.md"
    assert report([rows, str(curve), "-o", str(output), "--quiet", "--timeout", "0.5", "--memory", "1"]) == 1
    first, second = (line for line in capsys.readouterr().err.splitlines() if line.startswith("REFUSED"))
    assert first.startswith(f"REFUSED {rows}: {honest['id']}: its process ended")
    assert "time limit of 0.5 s" in second
    assert not output.exists()


@pytest.mark.usefixtures("little_grace")
def test_an_orbit_is_not_placed_on_a_curve_that_cannot_be_checked(
    honest: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(apart, "places_on", process_work.hanging)
    document = a_curve()
    curve, orbit = Certificate(document), Certificate.from_json(honest)
    (placed,) = places_on_apart(curve, [orbit], CheckLimits(0.5))
    assert placed.certificate == orbit
    assert "not shown to lie" in placed.line
    assert "time limit of 0.5 s" in placed.line


def test_a_statement_that_ends_the_reader_of_second_proofs_costs_its_own_row_only(
    honest: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(second_proofs, "_first_problem", process_work.aborting)
    monkeypatch.setattr(second_proofs, "prove_row", process_work.growing)
    path = written(tmp_path / "rows.json", honest)
    assert main(["--second-proof", path, "--quiet", "--memory", "0.25"]) == 1
    out = capsys.readouterr().out
    assert "cannot follow" in out
    assert "more memory than 0.25 GiB" in out


def test_a_file_that_is_too_large_is_refused_when_so_much_of_it_was_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(documents, "_MOST_BYTES", 2**20)
    for path in (tmp_path / "large.json", Path("/dev/zero")):
        if not path.exists():
            path.write_text("[" + "1," * 2**20 + "1]")
        with pytest.raises(InputError, match="has more than 1 MiB"):
            read_document(path, "certificates")
        with pytest.raises(InputError, match="has more than 1 MiB"):
            stated_format(path, "give another")


@pytest.mark.parametrize(
    "wrong", [lambda n: {"certificates": [1] * n}, lambda n: results_of({str(i): 0 for i in range(n)})]
)
def test_of_a_file_full_of_errors_the_first_ones_are_looked_at(
    wrong: Callable[[int], dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also within alternatives of a schema."""
    made: list[object] = []
    first = ValidationError.__init__
    monkeypatch.setattr(
        ValidationError, "__init__", lambda self, *rest, **more: (made.append(self), first(self, *rest, **more))[1]
    )
    with pytest.raises(InputError, match="certificates"):
        validate_document({**HEAD, **wrong(20_000)}, "certificates", "file")
    assert 100 <= len(made) < 2_000


def results_of(point: dict[str, Any]) -> dict[str, Any]:
    entry = json.loads((DATA / "figures-certificates.json").read_text("utf-8"))["certificates"][0]
    return {"certificates": [{**entry, "results": {"point": point}}]}


@pytest.mark.parametrize("error", [MemoryError(), OverflowError("int too large")])
def test_what_the_process_of_a_command_cannot_hold_is_one_line(
    error: Exception, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails() -> int:
        raise error

    assert run_command(fails) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")


def test_an_integration_again_has_a_limit_of_time_if_none_is_given(
    honest: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[float | None] = []

    def answers(work: Any, source: Any, progress: Any, jobs: int, timeout: float | None, **more: Any) -> Any:
        given.append(timeout)
        while (task := source()) is not None:
            yield Answer(task, Recheck(task.name, "proved", 1, ()), 0.0)

    monkeypatch.setattr(side_by_side, "answers", answers)
    entry = Certificate.from_json(honest)
    for limits in (CheckLimits(), CheckLimits(7.0)):
        list(side_by_side.rechecks([entry], True, 1, lambda *_: None, limits))
    assert given == [CHECK_SECONDS, INTEGRATION_SECONDS, 7.0, 7.0]
    assert INTEGRATION_SECONDS >= 3600
    assert f"with --integrate {INTEGRATION_SECONDS:g}" in " ".join(_parser().format_help().split())


def test_an_interval_again_has_the_same_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[float | None] = []

    def engine_of(scheduler: Any, jobs: int, timeout: float | None, memory: int) -> Any:
        given.append(timeout)
        raise InputError("enough")

    monkeypatch.setattr(workplace, "engine_of", engine_of)
    path = tmp_path / "curve.json"
    path.write_text(json.dumps(atlas_certificate(*of_parabola())), "utf-8")
    for more in ([], ["--timeout", "9"]):
        assert main(["atlas", "--recheck", "--integrate", "--quiet", *more, str(path)]) in (1, 2)
    assert given == [INTEGRATION_SECONDS, 9.0]
