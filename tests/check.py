"""The tests that a change can reach, the nearest first, for about a minute: ``python tests/check.py``.

What has changed is what git says against its last commit. A test is as near as the way of imports from its file to a
changed module is short. It says how many files it did not come to: `make test` runs them all.
"""

from __future__ import annotations

import argparse
import ast
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))

import reading_list  # noqa: E402

_BY_ENDING = {
    ".md": ("tests/soundness/test_chapters.py", "tests/commands/test_project.py"),
    ".toml": ("tests/soundness/test_table_of_faults.py", "tests/commands/test_project.py"),
    ".json": ("tests/shared/test_schema_errors.py",),
}
"""Tests of what is no code."""


def changed() -> list[str]:
    """Files that differ from the last commit, or are new, from the root of the checkout."""
    words = (["diff", "--name-only", "HEAD"], ["ls-files", "--others", "--exclude-standard"])
    found = [subprocess.run(["git", *each], cwd=ROOT, capture_output=True, text=True, check=True) for each in words]
    return [line for output in found for line in output.stdout.splitlines()]


@cache
def used_by_test(path: Path) -> frozenset[Path]:
    """The files that one of the tests' folder imports: of the package, and of `support`."""
    own = {definer for module, name in reading_list.imports(path) if (definer := _file(module, name))}
    own |= {definer for module, name in reading_list.imports(path, True) if (definer := _file(module, name))}
    return frozenset(own | set(_support(path)))


def _file(module: str, name: str) -> Path | None:
    if reading_list.path_of(module) is None:
        return None
    return reading_list.path_of(reading_list.definer(module, name))


def _support(path: Path) -> Iterator[Path]:
    for node in ast.walk(reading_list.tree_of(path)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("support"):
            names = [node.module, *(f"{node.module}.{each.name}" for each in node.names)]
            files = (ROOT / "tests" / f"{str(name).replace('.', '/')}.py" for name in names)
            yield from (file for file in files if file.exists())


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
    found, front, steps = dict[Path, int](), set(targets), 0
    while front:
        found |= dict.fromkeys(front, steps)
        front = {user for path in front for user in users.get(path, ())} - set(found)
        steps += 1
    return {test: found[test] for test in tests if test in found}


def reached(files: Sequence[str]) -> list[str]:
    """Files of tests that these files can reach, the nearest first."""
    targets = {ROOT / name for name in files if name.endswith((".py", ".pyi"))}
    others = [test for name in files for test in _BY_ENDING.get(Path(name).suffix, ())]
    found = distances(targets, sorted((ROOT / "tests").rglob("test_*.py"))) if targets else {}
    near = sorted((steps, str(path.relative_to(ROOT))) for path, steps in found.items())
    return list(dict.fromkeys([*others, *(name for _, name in near)]))


class Clock:
    """Ends the run of tests after so many seconds; knows which files were begun."""

    def __init__(self, seconds: float) -> None:
        self.end = time.monotonic() + seconds
        self.begun: set[str] = set()

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
    return 0 if code == 0 or (code == pytest.ExitCode.INTERRUPTED and time.monotonic() > clock.end) else 1


if __name__ == "__main__":
    sys.exit(main())
