"""What is refused names an argument in Python and the option on the command line, in otherwise the same line."""

from __future__ import annotations

import ast
import json
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.claims import known

from orbitproof import explore, figures, verify
from orbitproof.explore.__main__ import main as explore_command
from orbitproof.figures.__main__ import main as figures_command
from orbitproof.shared import InputError, load_system, read_atlas, write_candidates
from orbitproof.shared.arguments import as_command_says
from orbitproof.shared.formats import ArgumentError
from orbitproof.verify.__main__ import main as verify_command

ROOT = Path(__file__).resolve().parents[2]
ROOMS = [path for path in (ROOT / "verify").rglob("*.py") if path.parent.name != "run" and path.stem != "__main__"]
DATA = ROOT / "tests/data"
CERTIFICATES, FAMILY = DATA / "figures-certificates.json", DATA / "figures-halo-family.json"
SURFACE, CURVE = DATA / "surface.json", DATA / "atlas-falkner-skan.json"
MICHELSON = ROOT / "docs/examples/michelson.py"


def changed(folder: Path) -> Path:
    """A certificates file in which an id appears twice."""
    path = folder / "twice.json"
    document = json.loads(CERTIFICATES.read_text())
    path.write_text(json.dumps(document | {"certificates": document["certificates"][:1] * 2}))
    return path


def claim_of(folder: Path) -> str:
    write_candidates(folder / "claim.json", [known("fs2")])
    return str(folder / "claim.json")


def michelson(folder: Path) -> Any:
    return explore.refine_at(load_system(MICHELSON), {"c": 1.0, "y": 1.0}, 2, parameters={"d": 1})


def copied(folder: Path) -> Path:
    (folder / "other.json").write_text(CERTIFICATES.read_text())
    return folder / "other.json"


Python = Callable[[Path], Any]
Words = Callable[[Path], list[str]]
CASES: dict[str, tuple[Python, Words, str, str]] = {
    "certificates of others": (
        lambda folder: verify.certify(known("fs2"), output=copied(folder), quiet=True),
        lambda folder: ["verify", claim_of(folder), "-o", str(copied(folder))],
        "replace the file with fresh=True",
        "replace the file with --fresh",
    ),
    "a file to be replaced": (
        lambda folder: verify.certify(known("fs2"), output=changed(folder), quiet=True),
        lambda folder: ["verify", claim_of(folder), "-o", str(changed(folder))],
        "write the file again with fresh=True; or replace the file with fresh=True",
        "write the file again with --fresh; or replace the file with --fresh",
    ),
    "a scheduler": (
        lambda folder: verify.certify(known("fs2"), scheduler="nowhere", quiet=True),
        lambda folder: ["verify", claim_of(folder), "--scheduler", "nowhere"],
        "scheduler nowhere: not an address",
        "--scheduler nowhere: not an address",
    ),
    "a list on a surface": (
        lambda folder: verify.certify(read_atlas(SURFACE), complete=3, quiet=True),
        lambda folder: ["verify", "atlas", str(SURFACE), "--complete", "3"],
        "complete: lists what is on a curve",
        "--complete: lists what is on a curve",
    ),
    "few bits": (
        lambda folder: verify.certify(read_atlas(CURVE), precision=1, quiet=True),
        lambda folder: ["verify", "atlas", str(CURVE), "--precision", "1"],
        "precision, order, width, top: ",
        "--precision, --order, --width, --top: ",
    ),
    "a picture that is none": (
        lambda folder: figures.draw_all(folder, folder, only=["nothing"]),
        lambda folder: ["figures", "all", str(folder), "-o", str(folder), "--only", "nothing"],
        "only nothing: no such picture",
        "--only nothing: no such picture",
    ),
    "few dots": (
        lambda folder: figures.Files(dpi=7),
        lambda folder: ["figures", "all", str(folder), "-o", str(folder), "--dpi", "7"],
        "dpi 7: give a whole number from 50 to 1200",
        "--dpi 7: give a whole number from 50 to 1200",
    ),
    "certificates alone": (
        lambda folder: figures.draw_resonances([FAMILY], folder, certificates=CERTIFICATES),
        lambda folder: ["figures", "resonances", str(FAMILY), "-o", str(folder), "--certificates", str(CERTIFICATES)],
        "certificates: need their candidates; add candidates",
        "--certificates: need their candidates; add --candidates",
    ),
    "a parameter that is none": (
        michelson,
        lambda folder: [
            *("explore", "refine", "--system", str(MICHELSON), "--point", "c=1", "y=1", "-k", "2"),
            *("--parameter", "d=1", "-o", str(folder / "out.json")),
        ],
        "parameters d: michelson has no such fixed parameter",
        "--parameter d: michelson has no such fixed parameter",
    ),
}
COMMANDS = {"verify": verify_command, "explore": explore_command, "figures": figures_command}


@pytest.mark.parametrize("name", CASES)
def test_python_names_the_argument_and_the_command_its_option(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    call, words, in_python, on_command_line = CASES[name]
    with pytest.raises((InputError, ValueError)) as raised:
        call(tmp_path)
    assert in_python in str(raised.value)
    assert not re.search(r"--[a-z]", str(raised.value))
    command, *options = words(tmp_path)
    assert COMMANDS[command](options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert on_command_line in line
    assert "=True" not in line


def test_a_value_that_looks_like_an_argument_stays_as_it_is() -> None:
    error = ArgumentError("{output}: {0} is no {1}; give {fresh=True:--fresh}", "{fresh}.json", "{0}")
    assert str(error) == "output: {fresh}.json is no {0}; give fresh=True"
    assert error.on_command_line == "--output: {fresh}.json is no {0}; give --fresh"
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.on_command_line) == (str(error), error.on_command_line)
    assert as_command_says(InputError("no {file}")) == "no {file}"


SAYS_OPTION = re.compile(r'(?:InputError|ValueError)\(\s*f?"--')
COMMAND_LINES = re.compile(
    r"/commands/|__main__|_command\.py$|^explore/(three_body/)?(search|names|atlases|trajectories|catalogues)/"
)


def test_only_command_lines_raise_in_the_words_of_options() -> None:
    """What else is called from Python names its arguments, as `ArgumentError`s do."""
    modules = [path for room in ("shared", "verify", "figures", "explore") for path in (ROOT / room).rglob("*.py")]
    found = [path.relative_to(ROOT).as_posix() for path in modules if SAYS_OPTION.search(path.read_text("utf-8"))]
    assert [name for name in found if not COMMAND_LINES.search(name)] == []


def test_results_name_the_argument_and_the_command_its_option(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here,) = verify.certify(known("fs2"), timeout=1e-3, quiet=True)
    assert here.reason is not None
    assert here.reason.remedy == "give `timeout` more seconds"
    output = tmp_path / "certificates.json"
    assert verify_command([claim_of(tmp_path), "--row-timeout", "0.001", "-o", str(output), "--quiet"]) == 1
    assert "; give --row-timeout more seconds" in " ".join(capsys.readouterr().out.split())
    (there,) = verify.read(output)
    assert there.reason == here.reason


@pytest.mark.parametrize("path", ROOMS, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_results_say_names_no_option(path: Path) -> None:
    tree = ast.parse(path.read_text())
    values = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    # After a colon it is the other name of an argument, which `ArgumentError` chooses.
    assert not [text for text in values if isinstance(text, str) and re.search(r"(?<!:)--[a-z]", text)]
