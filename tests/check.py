"""The tests that a change can reach, the nearest first, for about a minute: ``python tests/check.py``.

What has changed is what git says against its last commit. A test is as near as the way of imports from its file to a
changed module is short; modules that are loaded by name count where their names stand. What is no code is reached by
the files that name it. It says how many files it did not come to: `make test` runs them all.
"""

from __future__ import annotations

import argparse
import ast
import pickle
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))

import reading_list  # noqa: E402

_BY_ENDING = {
    ".md": ("tests/soundness/test_chapters.py", "tests/commands/test_project.py"),
    ".toml": ("tests/soundness/test_table_of_faults.py", "tests/commands/test_project.py"),
    ".json": ("tests/shared/test_schema_errors.py",),
}
"""Tests of what is no code, beside those that name it."""

_FOLDERS = tuple(ROOT / folder for folder in ("tests", "docs", "tests/faults", "src"))
_LEAST = 3
"""So many files are read also where the machine is busy."""
_NAME = re.compile(r"[A-Za-z_][\w.]*")
_LOADS = re.compile(r"'import_module'")


def changed() -> list[str]:
    """Files that differ from the last commit, or are new, from the root of the checkout."""
    words = (["diff", "--name-only", "HEAD"], ["ls-files", "--others", "--exclude-standard"])
    found = [subprocess.run(["git", *each], cwd=ROOT, capture_output=True, text=True, check=True) for each in words]
    return [line for output in found for line in output.stdout.splitlines()]


@dataclass(frozen=True)
class Said:
    """What a file says of others: names of the package with their modules, any modules, modules loaded by name."""

    package: tuple[tuple[str, str], ...]
    others: tuple[str, ...]
    loaded: tuple[str, ...]

    @classmethod
    def by(cls, path: Path) -> Said:
        """Raises `SyntaxError` for a file that Python cannot read."""
        package = dict.fromkeys((*reading_list.imports(path), *reading_list.imports(path, True)))
        others, loaded = dict[str, None](), dict[str, None]()
        nodes = list(ast.walk(reading_list.tree_of(path)))
        words = [node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
        for node in nodes:
            if isinstance(node, ast.ImportFrom) and not node.level and node.module:
                others |= dict.fromkeys([node.module, *(f"{node.module}.{each.name}" for each in node.names)])
            elif isinstance(node, ast.Import):
                others |= dict.fromkeys(each.name for each in node.names)
            elif isinstance(node, ast.Call) and node.args and _LOADS.search(ast.dump(node.func)):
                loaded |= dict.fromkeys(_loaded(node.args[0], words))
        return cls(tuple(package), tuple(others), tuple(loaded))


def _loaded(asked: ast.expr, words: Sequence[str]) -> Iterator[str]:
    """The module that is loaded; where its name is put together, all that begin so and end in a word of the file."""
    if isinstance(asked, ast.Constant):
        yield str(asked.value)
    elif isinstance(asked, ast.JoinedStr) and isinstance(asked.values[0], ast.Constant):
        yield from (f"{asked.values[0].value}{word}" for word in words if _NAME.fullmatch(word))


class Known:
    """What files say, kept between runs: most are as they were."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.entries: dict[str, tuple[tuple[int, int], Said]] = {}
        # Whatever cannot be read is made again.
        with suppress(Exception):
            self.entries = pickle.loads(place.read_bytes())

    def said(self, path: Path) -> Said:
        now = path.stat().st_mtime_ns, path.stat().st_size
        entry = self.entries.get(str(path))
        if entry is None or entry[0] != now:
            entry = self.entries[str(path)] = now, Said.by(path)
        return entry[1]

    def keep(self) -> None:
        with suppress(OSError):
            self.place.parent.mkdir(exist_ok=True)
            self.place.write_bytes(pickle.dumps(self.entries))


KNOWN = Known(ROOT / ".pytest_cache" / "imports.pickle")


@cache
def used_by_test(path: Path) -> frozenset[Path]:
    """The files that one file imports: of the package, of the tests, and the programs in `docs`."""
    said = KNOWN.said(path)
    found = {file for module, name in said.package if (file := _file(module, name))}
    found |= {file for name in said.loaded for file in _on_path(ROOT / "src", name)}
    if path.is_relative_to(ROOT / "tests"):
        found |= {file for name in said.others for file in _on_path(path.parent, name)}
    return frozenset(found)


@cache
def _file(module: str, name: str) -> Path | None:
    if reading_list.path_of(module) is None:
        return None
    return reading_list.path_of(reading_list.definer(module, name))


@cache
def _on_path(folder: Path, name: str) -> tuple[Path, ...]:
    """The module of that name in the folder, or in one that is on the path of the tests."""
    places = [each.joinpath(*name.split(".")) for each in (folder, *_FOLDERS)]
    files = (file for place in places for file in (place.with_suffix(".py"), place / "__init__.py"))
    return tuple(file.resolve() for file in files if file.exists())


def naming(name: str) -> set[Path]:
    """The files of tests that say the name of one that is no code."""
    word = Path(name).name
    return {path for path in (ROOT / "tests").rglob("*.py") if word in path.read_text("utf-8")}


def distances(targets: set[Path], tests: Sequence[Path]) -> dict[Path, int]:
    """How many imports lead from each of these tests to a file that has changed; those that none do are left out."""
    users: dict[Path, set[Path]] = {}
    seen, waiting = set(tests), list(tests)
    while waiting:
        path = waiting.pop()
        for used in used_by_test(path):
            users.setdefault(used, set()).add(path)
            if used not in seen:
                seen.add(used)
                waiting.append(used)
    KNOWN.keep()
    found, front, steps = dict[Path, int](), set(targets), 0
    while front:
        found |= dict.fromkeys(front, steps)
        front = {user for path in front for user in users.get(path, ())} - set(found)
        steps += 1
    return {test: found[test] for test in tests if test in found}


def reached(files: Sequence[str]) -> list[str]:
    """Files of tests that these files can reach, the nearest first."""
    targets = {ROOT / name for name in files if name.endswith((".py", ".pyi"))}
    targets |= {path.with_suffix(".pyi") for path in targets if path.with_suffix(".pyi").exists()}
    below = [path.parent for path in targets if path.name == "conftest.py"]
    targets = targets.union(*(naming(name) for name in files if not name.endswith((".py", ".pyi"))))
    others = [test for name in files for test in _BY_ENDING.get(Path(name).suffix, ())]
    found = distances(targets, sorted((ROOT / "tests").rglob("test_*.py"))) if targets else {}
    near = [path for _, path in sorted((steps, path) for path, steps in found.items())]
    all_below = [path for folder in below for path in sorted(folder.rglob("test_*.py"))]
    return list(dict.fromkeys([*others, *(str(path.relative_to(ROOT)) for path in (*near, *all_below))]))


class Left(pytest.Module):
    """A file of tests that is not read."""

    def collect(self) -> Iterator[pytest.Item]:
        return iter(())


class Clock:
    """Ends the run of tests after so many seconds, and reads files in half of them; knows which were begun."""

    def __init__(self, seconds: float) -> None:
        self.end = time.monotonic() + seconds
        self.half: float | None = None
        self.read = 0
        self.begun: set[str] = set()

    def pytest_pycollect_makemodule(self, module_path: Path, parent: Any) -> pytest.Module | None:
        now = time.monotonic()
        self.half = self.half or (now + self.end) / 2
        self.read += 1
        return Left.from_parent(parent, path=module_path) if now > self.half and self.read > _LEAST else None

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.begun.add(nodeid.partition("::")[0])

    def pytest_runtest_protocol(self, item: pytest.Item) -> None:
        if time.monotonic() > self.end:
            item.session.shouldstop = "the time is over"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 0 if all tests pass that were run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", help="what has changed (default: what git says)")
    parser.add_argument("--seconds", type=float, default=60.0)
    options = parser.parse_args(arguments)
    tests = reached(options.files or changed())
    if not tests:
        print("no test can notice this change")
        return 0
    clock = Clock(options.seconds)
    code = pytest.main(["-x", "-p", "no:cacheprovider", *tests], plugins=[clock])
    rest = "" if clock.begun >= set(tests) else "; make test runs the rest"
    print(f"tried {len(clock.begun)} of {len(tests)} files of tests that the change can reach{rest}")
    fine = code in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
    return 0 if fine or (code == pytest.ExitCode.INTERRUPTED and time.monotonic() > clock.end) else 1


if __name__ == "__main__":
    sys.exit(main())
