"""What commands print in a terminal of 80 columns, and as JSON."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from support.claims import known

from orbitproof.explore.__main__ import main as explore
from orbitproof.explore.commands.arguments import parser
from orbitproof.figures.__main__ import main as figures
from orbitproof.shared.formats import write_candidates
from orbitproof.shared.output import files_of_a_command
from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.certificate import certify, write_certificates

DATA = Path(__file__).resolve().parents[1] / "data"
CANDIDATES = str(DATA / "figures-candidates.json")
CERTIFICATES = str(DATA / "figures-certificates.json")
FALKNER_SKAN = str(DATA / "figures-falkner-skan-family.json")
ORBITS = str(DATA / "orbit-candidates.json")
LIBRATION = ["--mass", "earth-moon", "--start", "x=0.8234", "z=0", "vy=0.126"]
TURNING = """
name = "turning"
state = "x y z"
field = {"x": "x - y - x*(x**2 + y**2)", "y": "x + y - y*(x**2 + y**2)", "z": "-2*z"}
"""
ONE = known("fs3")
LONG = "falkner-skan-of-a-name-that-is-longer-than-others"
COMMANDS: dict[str, tuple[Any, list[str]]] = {
    "verify": (verify, ["one.json", "-o", "one-certificate.json", "--fresh"]),
    "recheck": (verify, ["--recheck", "certificates.json"]),
    "no-digests": (verify, ["--recheck", CERTIFICATES]),
    "tables": (figures, ["tables", CERTIFICATES]),
    "pictures": (figures, ["all", ".", "--list"]),
    "data": (figures, ["data", ".", "--dry-run", "--only", "falkner*"]),
    "candidates": (explore, ["candidates", "--from-family", FALKNER_SKAN, "-k", "3", "--digits", "20", "-o", "c.json"]),
    "family": (explore, ["family", "--from-family", FALKNER_SKAN, "-k", "2", "3", "-o", "f.json"]),
    "orbit": (explore, ["orbit", "--system", "cr3bp", *LIBRATION, "-o", "o.json"]),
    "trajectory": (explore, ["trajectory", ORBITS, "--id", "ORBIT", "-o", "o.csv"]),
    "branches": (explore, ["branches", CERTIFICATES, "--only", "falkner*k3*", "--length", "0.01", "-o", "b.json"]),
    "periodic": (explore, ["periodic", "--system", "turning.py", "--start", "x=1", "y=0", "z=0", "--period", "6.2"]),
}
"""A short run of each command that has something to say, by what it is about."""
WIDE = {"data", "no-digests"}
"""What is printed to be run, and what is wrong with a file: a line each, unbroken."""


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A proved row, under a name with which no table fits."""
    path = tmp_path_factory.mktemp("rows") / "certificates.json"
    write_certificates(path, [certify(replace(ONE, id=LONG))])
    return path


@pytest.fixture(autouse=True)
def here(tmp_path: Path, certificates: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(certificates, tmp_path)
    write_candidates(tmp_path / "one.json", [ONE])
    (tmp_path / "turning.py").write_text(TURNING)


def words_of(name: str) -> tuple[Any, list[str]]:
    command, words = COMMANDS[name]
    first = json.loads(Path(ORBITS).read_text())["candidates"][0]["id"]
    return command, [first if word == "ORBIT" else word for word in words]


def printed(name: str, columns: int, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> str:
    command, words = words_of(name)
    monkeypatch.setenv("COLUMNS", str(columns))
    capsys.readouterr()
    assert command(words) in (0, 1)
    return str(capsys.readouterr().out)


def numbers(text: str) -> set[str]:
    return set(re.findall(r"[-+]?[0-9]+\.[0-9][0-9e+-]*", text))


@pytest.mark.parametrize("name", COMMANDS)
def test_lines_fit_a_terminal_and_no_number_is_broken(name: str, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    wide = printed(name, 1000, capsys, monkeypatch)
    narrow = printed(name, 80, capsys, monkeypatch)
    assert wide
    assert max(map(len, wide.splitlines())) > 80 or re.sub(r"in \S+ s", "", wide) == re.sub(r"in \S+ s", "", narrow)
    if name not in WIDE:
        assert max(map(len, narrow.splitlines())) <= 80
    assert numbers(narrow) - {time for time in numbers(narrow) if f"in {time} s" in narrow} <= numbers(wide)


def test_the_help_of_every_command_of_the_search_fits_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    (commands,) = (action for action in parser()._actions if action.dest == "command")
    assert isinstance(commands.choices, dict)
    lines = {name: each.format_help().splitlines() for name, each in commands.choices.items()}
    assert {name: line for name, each in lines.items() for line in each if len(line) > 80} == {}
    assert len(lines) > 10


@pytest.mark.parametrize("name", COMMANDS)
def test_results_are_printed_as_one_document(name: str, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    command, words = words_of(name)
    capsys.readouterr()
    with files_of_a_command():
        code = command([*words, "--json"])
    document = json.loads(capsys.readouterr().out)
    assert list(document) == ["command", "exit_code", "files", "results"]
    assert document["command"].startswith("orbitproof ")
    assert document["exit_code"] == code
    outputs = [after for before, after in pairwise(words) if before == "-o"]
    assert document["files"] == outputs
    assert document["results"]
    assert all(isinstance(result, dict) and result for result in document["results"])


def test_results_have_what_programs_need(capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def results(name: str) -> list[dict[str, Any]]:
        command, words = words_of(name)
        capsys.readouterr()
        command([*words, "--json"])
        return list(json.loads(capsys.readouterr().out)["results"])

    (orbit,) = results("orbit")
    assert orbit["period"] == pytest.approx(2.7435939, abs=1e-6)
    assert orbit["period_days"] == pytest.approx(12.16, abs=0.01)
    assert orbit["first_integral"] == pytest.approx(3.174196, abs=1e-6)
    assert orbit["point"]["x"] == pytest.approx(0.8233246, abs=1e-6)
    (candidate,) = results("candidates")
    assert (candidate["k"], candidate["parameter_name"]) == (3, "beta")
    assert candidate["parameter"].startswith("453.44258682138482264")
    (circle,) = results("periodic")
    assert circle["period"] == pytest.approx(6.283185307, abs=1e-8)
    (row,) = results("verify")
    assert (row["id"], row["verdict"], row["results"]["side"]) == (ONE.id, "proved", "both")
    (check,) = results("recheck")
    assert (check["id"], check["stands"], check["level"], check["findings"]) == (LONG, True, 2, [])
    first, *_ = results("no-digests")
    assert (first["stands"], first["level"], first["findings"][0]["place"]) == (False, 0, "digest")
