"""The project's surface: packages, README examples, and nothing that belongs to one machine."""

from __future__ import annotations

import argparse
import ast
import importlib
import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
import release_check

from orbitproof.__main__ import _COMMANDS as COMMANDS

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("shared", "explore", "verify", "figures", "formal")
README = (ROOT / "README.md").read_text("utf-8")
MAKEFILE = (ROOT / "Makefile").read_text("utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def commands_of(text: str) -> list[list[str]]:
    """Every `orbitproof explore|verify|figures|report|doctor ...` in a text, as argument lists from that word on."""
    words = "|".join(COMMANDS)
    lines = re.findall(rf"orbitproof ((?:(?:{words})[ ]|doctor)[^\n`#]*)", text.replace("\\\n", " "))
    return [shlex.split(re.split(r"\s{2,}\(", line)[0]) for line in lines]


class Parsed(Exception):
    """Raised in place of the work, once the arguments are accepted."""


def parse(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the command's own parser read the arguments; raises `SystemExit` if it refuses them."""
    package, *rest = arguments
    main = importlib.import_module(f"orbitproof.{COMMANDS[package][0]}").main
    plain = argparse.ArgumentParser.parse_args

    def parse_and_stop(parser: argparse.ArgumentParser, *args: Any, **options: Any) -> None:
        plain(parser, *args, **options)
        raise Parsed

    with monkeypatch.context() as patch:
        patch.setattr(argparse.ArgumentParser, "parse_args", parse_and_stop)
        with pytest.raises(Parsed):
            main(rest)


def tracked_files() -> list[Path]:
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in names.split("\0") if name and (ROOT / name).is_file()]


def test_readme_shows_a_command_for_each_step() -> None:
    assert {command[0] for command in commands_of(README)} == set(COMMANDS)


@pytest.mark.parametrize("command", commands_of(README), ids=" ".join)
def test_readme_commands_parse(command: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    parse(command, monkeypatch)


def test_commands_of_all_other_documents_parse(monkeypatch: pytest.MonkeyPatch) -> None:
    pages = [*sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs").glob("*/*.md"))]
    printed = [command for page in pages for command in release_check.commands_of(page)]
    complete = [command.text for command in printed if not release_check.PATTERN.search(command.text)]
    assert len(complete) > 150
    for text in complete:
        parse(shlex.split(text)[1:], monkeypatch)


def test_commands_of_documents_are_in_fenced_blocks() -> None:
    # Of two kinds of pages the indented lines are run as they stand.
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "docs").glob("*/*.md")]
    for page in pages:
        if page.parent.name not in ("examples", "coming-from"):
            text = page.read_text("utf-8")
            assert not re.search(r"^ {4}(orbitproof|make|pip|python) ", text, re.MULTILINE), page.name


def test_blocks_of_json_can_be_read() -> None:
    pages = [*(ROOT / "docs").glob("*.md"), *(ROOT / "docs").glob("*/*.md")]
    blocks = [
        text
        for page in pages
        for text in re.findall(r"^```json.*\n([^`]*)^```$", page.read_text("utf-8"), re.MULTILINE)
    ]
    assert len([json.loads(block) for block in blocks]) >= 2


def test_a_command_with_a_misspelt_option_does_not_parse(monkeypatch: pytest.MonkeyPatch) -> None:
    for command in (["explore", "candidates", "--sistem", "cr3bp"], ["verify", "c.json", "--outptu", "x"]):
        with pytest.raises(SystemExit):
            parse(command, monkeypatch)


def test_what_is_misspelt_is_answered_with_what_may_be_meant(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for words, meant in (
        (["explore", "orbit", "--familly", "L2-halo"], "did you mean --family?"),
        (["verify", "c.json", "--outptu", "x"], "did you mean --output?"),
        (["explore", "candidats"], "did you mean candidates?"),
        (["figures", "family", "c.json", "-o", "x", "--familly", "x"], "did you mean --family?"),
        (["explore", "orbit", "--period", "-6.5d"], "write --period=-6.5d"),
    ):
        monkeypatch.setattr(sys, "argv", ["orbitproof", *words])
        with pytest.raises(SystemExit):
            parse(words, monkeypatch)
        assert meant in capsys.readouterr().err
    for words, meant in ((["verfy"], "did you mean verify?"), (["verify", "indx"], "did you mean index?")):
        command = [sys.executable, "-m", "orbitproof", *words]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (done.returncode, meant in done.stderr) == (2, True)


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("orbitproof ver", "verify"),
        ("orbitproof explore orb", "orbit"),
        ("orbitproof explore orbit --fam", "--family"),
        ("orbitproof verify --other", "--other-boxes"),
        ("orbitproof verify atlas --comp", "--complete"),
        ("orbitproof figures family --fam", "--family"),
    ],
)
def test_a_shell_completes_commands_and_options(line: str, word: str, tmp_path: Path) -> None:
    pytest.importorskip("argcomplete")
    answer = tmp_path / "answer"
    asked = {"COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE": "1", "_ARGCOMPLETE_SHELL": "bash"}
    asked |= {"_ARGCOMPLETE_STDOUT_FILENAME": str(answer), "_ARGCOMPLETE_IFS": "\n"}
    words = [sys.executable, "-m", "orbitproof"]
    subprocess.run(words, env={**os.environ, **asked}, cwd=tmp_path, capture_output=True, timeout=120, check=False)
    assert [found.strip() for found in answer.read_text().splitlines()] == [word]


@pytest.mark.parametrize("package", COMMANDS)
def test_help_has_examples_and_its_examples_parse(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    result = subprocess.run(
        [sys.executable, "-m", "orbitproof", package, "--help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert "examples" in result.stdout.lower()
    examples = commands_of(result.stdout.partition("examples:")[2])
    assert examples
    for command in examples:
        parse(command, monkeypatch)


def test_readme_is_short() -> None:
    assert len(README.split()) <= 1000


def test_the_lines_that_the_readme_explains_are_those_of_a_certificate() -> None:
    document = json.loads((ROOT / "tests" / "data" / "figures-certificates.json").read_text("utf-8"))
    (block,) = re.findall(r"^```text\n(.*?)\n```$", README, re.MULTILINE | re.DOTALL)
    head, what, parameter = block.split("\n")
    (entry,) = (entry for entry in document["certificates"] if entry["id"] == head.partition(":")[0])
    claim, results = entry["statement"]["candidate"], entry["results"]
    assert f": {entry['verdict']} in " in head
    assert (claim["k"], claim["kind"]) == (2, "period_tupling")
    assert what == f"  period doubling (k = 2), new orbits {results['side']}"
    name, digits, first, last = re.fullmatch(r"  (.*) = (\d\.\d+)\[(\d),(\d)\]", parameter).groups()  # type: ignore[union-attr]
    assert name == results["parameter_name"]
    lower, upper = (Decimal(end) for end in results["parameter"]["decimal"].strip("[]").split(", "))
    assert Decimal(digits + first) <= lower <= upper <= Decimal(digits + last)


def test_architecture_names_every_room() -> None:
    layout = (ROOT / "docs" / "architecture.md").read_text("utf-8").partition("## Layout")[2].partition("\n## ")[0]
    for room in ROOMS:
        assert f"\n{room}/" in layout
    for room in (ROOT / "verify").iterdir():
        if (room / "README.md").exists():
            assert re.search(rf"\b{room.name}\b", layout), room.name


def test_the_glossary_is_in_order_and_has_the_words_that_stop_a_newcomer() -> None:
    page = re.sub(r"\$|\\mathrm|[{}]", "", (ROOT / "docs" / "glossary.md").read_text("utf-8"))
    rows = re.findall(r"^\| ([^|]+) \|", page, re.MULTILINE)[2:]
    assert [row.lower() for row in rows] == sorted(row.lower() for row in rows)
    words = {word.strip() for row in rows for word in re.split(r"[,;]", row)}
    assert {"ball", "Fix(R)", "level", "n", "k", "resonance 1:k", "multiplier", "NRHO", "R", "S"} <= words


def test_the_order_of_reading_is_one() -> None:
    docs = ROOT / "docs"
    chapters = (docs / "method.md").read_text("utf-8").partition("## Chapters")[2].partition("\n## ")[0]
    order = [*re.findall(r"\(\.\./verify/(\w+)/README\.md\) \|", chapters), "second_proof"]
    contents = (docs / "site" / "chapters.md").read_text("utf-8")
    assert re.findall(r"^verify/(\w+)/README$", contents, re.MULTILINE) == order
    layout = (docs / "architecture.md").read_text("utf-8").partition("in the order of reading")[2].partition("\n## ")[0]
    assert [word for word in re.findall(r"\w+", layout) if word in set(order)] == order


def test_base_install_carries_nothing_of_the_search_side() -> None:
    names = {re.split(r"[<>=\[]", line)[0] for line in PROJECT["project"]["dependencies"]}
    assert names.isdisjoint({"jax", "diffrax", "equinox", "mpmath", "matplotlib"})
    assert set(PROJECT["project"]["optional-dependencies"]) == {
        "explore",
        "figures",
        "oem",
        "spk",
        "interactive",
        "parquet",
        "cluster",
        "completion",
        "docs",
        "dev",
    }


def test_demo_verifies_where_the_search_side_is_refused() -> None:
    assert re.search(r"^VERIFY = PYTHONPATH=verify/alone \S+ verify$", MAKEFILE, re.MULTILINE)
    assert "env $(VERIFY) $(OUT)/candidates.json" in MAKEFILE
    assert MAKEFILE.index("mkdir -p $(OUT)") < MAKEFILE.index("-o $(OUT)/candidates.json")


def test_tracked_files_name_no_machine_path() -> None:
    pattern = re.compile(r"(?<![\w.$}~-])/(?:home|Users|root|work|tmp|mnt|opt|var/folders)/[\w.]")
    found = []
    for path in tracked_files():
        if path.suffix in {".png", ".pdf"}:
            continue
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            if pattern.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}")
    assert not found, "\n".join(found)


def test_every_local_link_and_picture_of_the_documents_exists() -> None:
    documents = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "docs").glob("*/*.md")]
    for document in sorted(path for path in documents if path.parent.name != "site"):
        prose = re.sub(r"^```.*?^```", "", document.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
        for target in re.findall(r"\]\(([^)#\s]+)", prose):
            if "://" not in target:
                assert (document.parent / target).exists(), f"{document.name}: {target}"


def test_pictures_of_the_readme_are_small() -> None:
    pictures = sorted((ROOT / "docs" / "images").glob("*"))
    assert pictures
    for picture in pictures:
        assert picture.stat().st_size < 300_000, picture.name


def test_modules_stay_one_idea_long() -> None:
    for package in ROOMS:
        for module in sorted((ROOT / package).rglob("*.py")):
            assert len(module.read_text("utf-8").splitlines()) <= 450, module.name


def twice(body: list[ast.stmt]) -> list[str]:
    """Classes and functions of a body that a later one of the same name replaces."""
    nodes = [node for node in body if isinstance(node, ast.ClassDef | ast.FunctionDef)]
    further = re.compile(r"overload|\w+\.(setter|register.*)")
    names = [node.name for node in nodes if not any(further.fullmatch(ast.unparse(d)) for d in node.decorator_list)]
    inner = [name for node in nodes if isinstance(node, ast.ClassDef) for name in twice(node.body)]
    return [name for name in set(names) if names.count(name) > 1] + inner


def test_no_definition_is_replaced_by_a_later_one_of_its_name() -> None:
    source = "@dataclass\nclass A:\n    def f(self): ...\n    def f(self): ...\n\nclass A: ..."
    assert twice(ast.parse(source).body) == ["A", "f"]
    sources = {path: path.read_text("utf-8") for path in tracked_files() if path.suffix == ".py"}
    assert not {path: names for path, text in sources.items() if (names := twice(ast.parse(text).body))}


def names_in(face: Path) -> set[str]:
    """The names that a room's `__init__` hands on."""
    imports = [node for node in ast.walk(ast.parse(face.read_text("utf-8"))) if isinstance(node, ast.ImportFrom)]
    return {alias.asname or alias.name for node in imports for alias in node.names}


def test_no_room_hands_on_a_name_that_is_one_of_its_modules() -> None:
    faces = [face for room in ROOMS for face in (ROOT / room).rglob("__init__.py*")]
    assert any(names_in(face) for face in faces)
    for face in faces:
        assert not names_in(face) & {module.stem for module in face.parent.glob("*.py")}, face
