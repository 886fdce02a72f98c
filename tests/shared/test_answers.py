"""What commands print: text that fits the terminal, or one JSON document."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Callable
from fractions import Fraction
from io import StringIO
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from orbitproof.explore.commands.arguments import parser as explore_parser
from orbitproof.explore.engines import Reporter
from orbitproof.figures.__main__ import argument_parser as figures_parser
from orbitproof.shared.answers import add_json_option, answered, tell
from orbitproof.shared.output import files_of_a_command, write_text
from orbitproof.shared.printed_tables import fitted, shortened, wrapped
from orbitproof.verify.run import branch_command, catalogue_command, index_command, row_command, web_command

WIDE = [("name", "state", "id"), ("first", "x = 0.123456789012345678901234, y = 0.123456789012345678901234", "a b c"),
        ("second", "", "d" * 90)]  # fmt: skip


def document(capsys: Any, run: Callable[[], int]) -> tuple[int, Any]:
    with files_of_a_command():
        code = answered("orbitproof x", True, run)
    return code, json.loads(capsys.readouterr().out)


def test_text_is_printed_as_it_comes(capsys: Any) -> None:
    def run() -> int:
        tell("a line", [{"a": 1}])
        tell("", [{"a": 2}])
        assert capsys.readouterr().out == "a line\n"
        return 1

    assert answered("orbitproof x", False, run) == 1
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("code", [0, 1, 130])
def test_results_and_files_are_one_document(code: int, tmp_path: Path, capsys: Any) -> None:
    def run() -> int:
        write_text(tmp_path / "a.json", "{}")
        tell("a line", [{"number": np.float64(0.1), "all": (np.int64(2), True, None)}])
        tell("another", [{"third": Fraction(1, 3), "multiplier": 1 + 2j, "endless": inf, "points": np.zeros(2)}])
        return code

    assert document(capsys, run) == (code, {
        "command": "orbitproof x", "exit_code": code, "files": [str(tmp_path / "a.json")],
        "results": [{"number": 0.1, "all": [2, True, None]},
                    {"third": "1/3", "multiplier": [1.0, 2.0], "endless": None, "points": [0.0, 0.0]}],
    })  # fmt: skip


def test_nothing_is_printed_of_bad_input(capsys: Any) -> None:
    def run() -> int:
        tell("a line", [{"a": 1}])
        return 2

    assert answered("orbitproof x", True, run) == 2
    assert capsys.readouterr().out == ""


def test_a_failure_leaves_the_next_command_its_text(capsys: Any) -> None:
    def fails() -> int:
        raise KeyError

    with pytest.raises(KeyError):
        answered("orbitproof x", True, fails)
    tell("a line")
    assert capsys.readouterr().out == "a line\n"


def options_of(parser: argparse.ArgumentParser) -> set[str]:
    return {name for action in parser._actions for name in action.option_strings}


def test_every_command_has_the_option() -> None:
    found = 0
    for whole in (explore_parser(), figures_parser()):
        (commands,) = (each for each in whole._actions if isinstance(each, argparse._SubParsersAction))
        for parser in commands.choices.values():
            assert "--json" in options_of(parser), parser.prog
            found += 1
    for module in (row_command, branch_command, catalogue_command, index_command, web_command):
        assert "--json" in options_of(module._parser()), module
        found += 1
    assert found > 25


def test_the_option_is_off_unless_given() -> None:
    parser = argparse.ArgumentParser()
    add_json_option(parser)
    assert (parser.parse_args([]).json, parser.parse_args(["--json"]).json) == (False, True)


@pytest.mark.parametrize("columns", [40, 60, 80, 100])
def test_a_wide_table_becomes_blocks_and_breaks_no_number(columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = fitted(WIDE, head=-1)
    assert [line for line in lines if not line.startswith(" ")] == ["a b c", "d" * 90]
    assert all(len(line) <= columns for line in lines if line != "d" * 90)
    text = " ".join(" ".join(lines).split())
    assert "name first state x = 0.123456789012345678901234, y = 0.123456789012345678901234" in text
    assert "name second" in text


def test_a_table_that_fits_stays_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    first, *rest = fitted(WIDE, head=-1)
    assert first.split() == ["name", "state", "id"]
    assert [line.split()[0] for line in rest] == ["first", "second"]


def test_lines_are_wrapped_below_their_margin(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    text = wrapped(["short", "  point: x = 1.23456789012345, y = 1.23456789012345"])
    assert text == "short\n  point: x = 1.23456789012345,\n      y = 1.23456789012345"


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_a_progress_bar_shows_its_times_whole(columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    console = Console(width=columns, file=StringIO(), force_terminal=True, legacy_windows=False)
    bar = Reporter()._progress
    for name in ("refining 14 points: earth-moon-L1-halo-k4-2: Newton step 1 with 128 bits", "short"):
        task = bar.add_task(
            shortened(name, "earth-moon-L1-halo-k4-2: Newton step 1 with 128 bits"), total=4, completed=1
        )
        bar.tasks[task].start_time = 0.0
    console.print(bar.make_tasks_table(bar.tasks))
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", console.file.getvalue())  # type: ignore[attr-defined]
    first, second = text.splitlines()
    for line in (first, second):
        assert len(line) <= columns
        assert re.search(r"25% .*:\d\d left +\S*:--\s*$|25% .*:\d\d left +\d+:\d\d:\d\d\s*$", line), line
    assert first.startswith("earth-mo" if columns < 120 else "earth-moon-L1-halo-k4-2: Newton step 1 with 128 bits ")
