"""Every kind of file of one's own system goes through every command that takes files: done, or refused in a line."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from orbitproof.explore.__main__ import main as explore
from orbitproof.figures.__main__ import main as figures
from orbitproof.figures.commands.report import main as report
from orbitproof.verify.__main__ import main as verify

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
DATA = Path(__file__).resolve().parents[1] / "data"

Main = Callable[[Sequence[str]], int]

CERTIFICATES = ("certificates.json", "orbit-certificate.json", "fold-certificate.json", "breaking-certificate.json")
FILES = (
    "family.json", "candidates.json", "orbit.json", "fold.json", "breaking.json", "atlas.json", *CERTIFICATES,
    "atlas-certificate.json", "branches.json",
)  # fmt: skip

COMMANDS: dict[str, tuple[Main, Sequence[str]]] = {
    "verify": (verify, ["FILE", "--jobs", "1", "--quiet"]),
    "recheck": (verify, ["--recheck", "FILE", "--quiet"]),
    "recheck, integrate": (verify, ["--recheck", "--integrate", "FILE", "--quiet"]),
    "second proof": (verify, ["--second-proof", "FILE", "--quiet"]),
    "places": (verify, ["--recheck", "FILE", "--curve", "atlas-certificate.json", "--quiet"]),
    "atlas": (verify, ["atlas", "FILE", "--quiet"]),
    "atlas, recheck": (verify, ["atlas", "--recheck", "FILE", "--quiet"]),
    "tables": (figures, ["tables", "FILE", "-o", "OUT"]),
    "family": (figures, ["family", "FILE", "-o", "OUT"]),
    "resonances": (figures, ["resonances", "FILE", "-o", "OUT"]),
    "resonances, candidates": (figures, ["resonances", "family.json", "--candidates", "FILE", "-o", "OUT"]),
    "atlas pictures": (figures, ["atlas", "FILE", "-o", "OUT"]),
    "tori pictures": (figures, ["tori", "FILE", "-o", "OUT"]),
    "interactive": (figures, ["interactive", "FILE", "-o", "OUT/page.html"]),
    "report": (report, ["FILE", "-o", "OUT/report.html", "-o", "OUT/report.md", "-o", "OUT/report.tex", "--quiet"]),
    "trajectory": (explore, ["trajectory", "FILE", "-o", "OUT/trajectory.csv"]),
    "tori": (explore, ["tori", "FILE", "-o", "OUT/tori.json", "--quiet"]),
    "manifold": (explore, ["manifold", "FILE", "--plane", "x=1", "-o", "OUT/tube.json", "--quiet"]),
    "branches": (explore, ["branches", "FILE", "--orbits", "4", "-o", "OUT/branches.json", "--quiet"]),
    "check an atlas": (explore, ["atlas", "--check", "FILE", "--quiet"]),
    "catalogue": (explore, ["orbit", "--from-catalogue", "FILE", "-o", "OUT/orbits.json", "--quiet"]),
}

DONE = {
    "verify": {"candidates.json", "orbit.json", "fold.json", "breaking.json"},
    "recheck": set(CERTIFICATES),
    "recheck, integrate": set(CERTIFICATES),
    "atlas": {"atlas.json"},
    "atlas, recheck": {"atlas-certificate.json"},
    "tables": set(CERTIFICATES) - {"orbit-certificate.json"},
    "family": {"candidates.json", "orbit.json", "fold.json", "breaking.json"},
    "resonances": {"family.json"},
    "atlas pictures": {"atlas-certificate.json"},
    "report": {*CERTIFICATES, "atlas-certificate.json"},
    "trajectory": {"orbit-certificate.json", "breaking.json", "breaking-certificate.json"},
    "branches": {"candidates.json", "certificates.json", "breaking.json", "breaking-certificate.json"},
    "check an atlas": {"atlas.json"},
}
"""What has to be done, with exit code 0; everything else may be refused."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One file of each kind, the systems' own files removed."""
    place = tmp_path_factory.mktemp("files")
    for name in ("michelson", "henon-heiles"):
        shutil.copy(EXAMPLES / f"{name}.py", place)
    known = json.loads((DATA / "known-folds.json").read_text("utf-8"))
    (place / "fold.json").write_text(json.dumps({**known, "candidates": known["candidates"][-1:]}), "utf-8")
    patch = pytest.MonkeyPatch()
    patch.chdir(place)
    limits = ["--parameter-min", "c", "0.1", "--parameter-max", "c", "0.3", "--jobs", "1", "--quiet"]
    start = ["--system", "michelson.py", "--start", "c=0.1", "y=0.2"]
    covers = ["--from-family", "family.json", "--covers", "c", "0.15", "0.28", "--increasing", "c", "--quiet"]
    found = ["--bifurcations", "certificates.json", "--complete", "4", "--jobs", "1", "--quiet"]
    steps: list[tuple[Main, list[str]]] = [
        (explore, ["candidates", *start, *limits, "-k", "3", "4", "--digits", "30", "-o", "candidates.json",
                   "--family-output", "family.json"]),
        (explore, ["orbit", "--from-family", "family.json", "--at", "c=0.2", "--digits", "30", "-o", "orbit.json",
                   "--quiet"]),
        (explore, ["refine", "--system", "henon-heiles.py:T", "-k", "1", "--point", "x=0", "y=-0.497034785",
                   "--digits", "30", "-o", "breaking.json", "--quiet"]),
        (explore, ["atlas", *covers, "-o", "atlas.json"]),
        (explore, ["branches", "candidates.json", "--orbits", "4", "-o", "branches.json", "--quiet"]),
        *((verify, [f"{name}.json", "-o", f"{name}-certificate.json", "--jobs", "1", "--quiet"])
          for name in ("orbit", "fold", "breaking")),
        (verify, ["candidates.json", "-o", "certificates.json", "--jobs", "1", "--quiet"]),
        (verify, ["atlas", "atlas.json", *found, "-o", "atlas-certificate.json"]),
    ]  # fmt: skip
    for main, words in steps:
        assert main(words) == 0, words
    for file in place.glob("*.py"):
        file.unlink()
    patch.undo()
    return place


# Second proofs take long: those of certificates are run where a report names them. Reports are looked at below.
PAIRS = [
    (command, name)
    for command in COMMANDS
    for name in FILES
    if not ((command == "second proof" and name in CERTIFICATES) or (command == "report" and name in DONE["report"]))
]


@pytest.mark.parametrize(("command", "name"), PAIRS)
def test_a_file_is_taken_or_refused_in_a_line(
    command: str, name: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(folder)
    main, words = COMMANDS[command]
    try:
        code = main([name if word == "FILE" else word.replace("OUT", str(tmp_path)) for word in words])
    except SystemExit as end:
        code = int(end.code or 0)
    error = capsys.readouterr().err
    if name in DONE.get(command, set()):
        assert code == 0, error
    if code == 2:
        assert error.startswith(("error: ", "orbitproof ")), error
        assert name in error or "--" in error
        assert error.count("\n") == 1
    assert code in (0, 1, 2)


LONGER = [["atlas", "--recheck", "--integrate", "FILE", "--quiet"], COMMANDS["second proof"][1]]
"""Run in the slow tests."""


def commands_in(report: Path) -> list[list[str]]:
    """What a report says to check its certificates with, as words of `verify`."""
    lines = report.read_text("utf-8").splitlines()
    return [line.split()[2:] for line in lines if line.startswith("orbitproof verify")]


@pytest.mark.parametrize("name", sorted(DONE["report"]))
def test_a_report_has_a_picture_and_names_only_commands_that_are_tried_here(
    name: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    outputs = [word for form in ("html", "md", "tex") for word in ("-o", str(tmp_path / f"report.{form}"))]
    assert report([name, *outputs]) == 0
    assert "drawn" in capsys.readouterr().err
    assert "![" in (tmp_path / "report.md").read_text("utf-8")
    assert "data:image/png" in (tmp_path / "report.html").read_text("utf-8")
    found = commands_in(tmp_path / "report.md")
    assert found
    for words in found:
        given = [*words[:-1], "FILE", "--quiet"]
        assert words[-1] == name
        assert given in LONGER or any(
            given == known and name in DONE.get(what, ()) for what, (_, known) in COMMANDS.items()
        )


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(DONE["report"]))
def test_every_command_that_a_report_names_works(
    name: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    assert report([name, "-o", str(tmp_path / "report.md"), "--no-pictures", "--quiet"]) == 0
    for words in commands_in(tmp_path / "report.md"):
        assert verify([*words, "--quiet"]) == 0, words


def test_two_certificates_of_one_name_are_told_apart(folder: Path) -> None:
    names = {path.name for path in folder.glob("*.json")}
    assert names == set(FILES)
    code = report([str(folder / each) for each in (*CERTIFICATES, "atlas-certificate.json")]
                  + ["-o", str(folder.parent / "all.md"), "--no-pictures", "--quiet"])  # fmt: skip
    assert code == 0


@pytest.mark.slow
def test_a_report_of_an_orbit_with_a_place_names_its_curve(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    placed = tmp_path / "placed.json"
    curve = ["--curve", "atlas-certificate.json", "--quiet"]
    assert verify(["orbit.json", "-o", str(placed), "--jobs", "1", *curve]) == 0
    assert report([str(placed), "atlas-certificate.json", "-o", str(tmp_path / "report.md"), "--no-pictures"]) == 0
    text = (tmp_path / "report.md").read_text("utf-8")
    assert "orbitproof verify --recheck placed.json --curve atlas-certificate.json\n" in text
    assert verify(["--recheck", str(placed), *curve]) == 0
