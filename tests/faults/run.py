"""Faults made on purpose, one line each: ``python tests/faults/run.py --output faults.json``.

The files beside this one are the table, one for each room of the trusted modules (`read`). Every fault is applied to a
copy of the package, and the tests of its room run on the copy until one of them fails; those that `make test` runs, and
with ``--slow`` those that `make test-slow` runs where no other has noticed the fault. Results are kept one by one, and
the same command goes on; it tries a fault again when its patch or the modules beside it have changed, and one that no
test has noticed when its tests have.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import child

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TRUSTED = ("shared", "verify")
LINKED = ("explore", "figures", "tests", "docs", "README.md", "pyproject.toml", "setup.py", "Makefile")

_LIMIT = 1800.0
"""Seconds for the tests of one fault, ten times as many for the slow ones."""

Result = dict[str, Any]
"""How a fault fared: ``verdict`` (found, timed out, survives), ``by`` which test, ``slow``, ``seconds``."""


@dataclass(frozen=True)
class Fault:
    """One entry of the table.

    Attributes:
        room: its file in the table.
        breaks: what is no longer true, in a sentence; no two entries of a room have the same.
        section: the section of the chapter that says it, ``7.4``; ``certificate 13.1`` in the chapter of another room.
        file: the module, from the root of the checkout.
        old, new: the text that is replaced, which occurs once, and what it becomes.
        first: tests that run before those of the room.
        tests: tests of the room, those that most likely notice first.
        harmless: why nothing false can follow, if no test can notice it.
    """

    room: str
    breaks: str
    section: str
    file: str
    old: str
    new: str
    first: tuple[str, ...]
    tests: tuple[str, ...]
    harmless: str | None

    @property
    def name(self) -> str:
        return f"{self.room}: {self.breaks}"

    def key(self) -> str:
        """Digest of the patch and the modules beside it."""
        return _digest([self.file, self.old, self.new], sorted((ROOT / self.file).parent.glob("*.py")))

    def digest_of_tests(self) -> str:
        """Digest of the files of the tests."""
        names = dict.fromkeys(test.partition("::")[0] for test in (*self.first, *self.tests))
        return _digest(names, [ROOT / name for name in names])

    def applied(self, text: str) -> str:
        """The module with the fault. Raises `ValueError` unless the old text occurs once and the new one differs."""
        if text.count(self.old) != 1 or self.old == self.new:
            raise ValueError(f"{self.name}: the text to be changed occurs {text.count(self.old)} times in {self.file}")
        return text.replace(self.old, self.new)


def _digest(texts: Iterable[str], files: Iterable[Path]) -> str:
    parts = [*texts, *(path.read_text(encoding="utf-8") for path in files)]
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:20]


def read(folder: Path = HERE) -> list[Fault]:
    """All faults of the table, by room."""
    faults = []
    for path in sorted(folder.glob("*.toml")):
        room = tomllib.loads(path.read_text(encoding="utf-8"))
        for entry in room["faults"]:
            rest = {"first": tuple(entry.pop("tests", ())), "harmless": entry.pop("harmless", None)}
            faults.append(Fault(room=path.stem, tests=tuple(room["tests"]), **entry, **rest))
    return faults


def copied(folder: Path) -> None:
    """A checkout in a folder whose trusted modules may be changed; everything else is a link."""
    shutil.copytree(ROOT / "src", folder / "src", symlinks=True, ignore=shutil.ignore_patterns("*.egg-info"))
    for room in (*TRUSTED, "explore", "figures"):
        link = folder / "src" / "orbitproof" / room
        link.unlink(missing_ok=True)
        link.symlink_to(Path("..", "..", room), target_is_directory=True)
    for name in TRUSTED:
        shutil.copytree(ROOT / name, folder / name)
    for name in LINKED:
        (folder / name).symlink_to(ROOT / name)


def tested(
    folder: Path,
    tests: Iterable[str],
    slow: bool,
    times: Mapping[str, float],
    all_of_them: bool,
    first: Sequence[str],
) -> Result:
    """Run tests on a copy, `first` and those that took little of the `times` first; until one fails, or all of them."""
    arguments = ["--tb=no", "-p", "no:cacheprovider", "--hypothesis-seed=0", "-m", "slow" if slow else "not slow"]
    arguments += [*([] if all_of_them else ["-x"]), *dict.fromkeys(tests)]
    begin = time.monotonic()
    # The server has imported what is not under test once, and each process is a fork of it.
    process = _SERVER.Process(target=child.run_tests, args=(folder, arguments, dict(times), first))
    process.start()
    _running.add(process)
    process.join(10 * _LIMIT if slow else _LIMIT)
    late = process.is_alive()
    end(process)
    told = folder / "told.json"
    found = json.loads(told.read_text(encoding="utf-8")) if told.exists() else {"code": 1, "failed": [], "seconds": {}}
    ended = process.exitcode is not None and process.exitcode < 0
    if found["code"] in (3, 4) or not (told.exists() or ended):
        output = folder / "output.txt"
        raise RuntimeError(f"pytest did not run:\n{output.read_text(encoding='utf-8') if output.exists() else ''}")
    failed = found["failed"]
    verdict = "timed out" if late else "survives" if found["code"] in (0, 5) else "found"
    by = failed[0] if failed else "the end of the process" if verdict == "found" else ""
    told.unlink(missing_ok=True)
    result = {"verdict": verdict, "by": by, "slow": slow, "seconds": round(time.monotonic() - begin, 1)}
    return {**result, "failed": failed, "times": found["seconds"]}


_SERVER = multiprocessing.get_context("forkserver")
_SERVER.set_forkserver_preload(["pytest", "hypothesis", "numpy", "flint", "jsonschema"])
_running: set[BaseProcess] = set()


def end(process: BaseProcess) -> None:
    """End a process and all of its session."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid or 0, signal.SIGKILL)
    process.join()
    _running.discard(process)


def tried(fault: Fault, times: Mapping[str, float], slow: bool) -> Result:
    """Apply a fault to a copy and run its tests; the slow ones only where no other has noticed it."""
    with tempfile.TemporaryDirectory(prefix="orbitproof-fault-") as name:
        folder = Path(name)
        copied(folder)
        module = folder / fault.file
        module.write_text(fault.applied(module.read_text(encoding="utf-8")), encoding="utf-8")
        tests = (*fault.first, *fault.tests)
        result = tested(folder, tests, False, times, False, fault.first)
        if slow and result["verdict"] == "survives":
            return tested(folder, tests, True, times, False, fault.first)
        return result


def failing_anyway(tests: Iterable[str]) -> set[str]:
    """Those of these tests that fail without any fault, in other sources that do the same: they find none."""
    with tempfile.TemporaryDirectory(prefix="orbitproof-fault-") as name:
        copied(Path(name))
        for room in TRUSTED:
            with (Path(name) / room / "__init__.py").open("a", encoding="utf-8") as module:
                module.write("# Another source.\n")
        return {failed for slow in (False, True) for failed in tested(Path(name), tests, slow, {}, True, ())["failed"]}


def run(faults: Sequence[Fault], output: Path, jobs: int, slow: bool, tell: Callable[[str], None]) -> list[Result]:
    """Try what is not known yet; returns what is known of each fault, in their order."""
    known: dict[str, Result] = json.loads(output.read_text()) if output.exists() else {}
    times: dict[str, float] = dict(known.setdefault("times", {}))
    keys = {fault.name: fault.key() for fault in faults}

    def is_missing(fault: Fault) -> bool:
        before = known.get(keys[fault.name], {})
        if before.get("verdict", "survives") != "survives":
            return False
        return not before or before["tests"] != fault.digest_of_tests() or (slow and not before["slow"])

    missing = [fault for fault in faults if is_missing(fault)]
    for fault in missing:
        fault.applied((ROOT / fault.file).read_text(encoding="utf-8"))
    with ThreadPoolExecutor(jobs) as pool:
        waiting = {pool.submit(tried, fault, times, slow): fault for fault in missing}
        try:
            for number, future in enumerate(as_completed(waiting), 1):
                fault, result = waiting[future], future.result()
                times.update(result.pop("times"))
                result.pop("failed")
                known["times"] = times
                known[keys[fault.name]] = {"name": fault.name, "tests": fault.digest_of_tests(), **result}
                keep(known, output)
                place = f"{number}/{len(missing)}"
                tell(f"{place} {result['verdict']:9} {fault.name}  {result['by']} {result['seconds']} s")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in list(_running):
                end(process)
            raise
    results = [known.get(keys[fault.name], {}) for fault in faults]
    finders = {result["by"] for result in results if "::" in result["by"] and not result.get("confirmed")}
    false = failing_anyway(sorted(finders)) if finders else set()
    for fault, result in zip(faults, results, strict=True):
        result["confirmed"] = result["by"] not in false
        if not result["confirmed"]:
            tell(f"fails without a fault: {result['by']}, which found {fault.name}")
            known.pop(keys[fault.name], None)
            result["verdict"] = "not tried"
    keep(known, output)
    return results


def keep(known: Result, output: Path) -> None:
    """Write what is known, whole or not at all."""
    beside = output.with_name(f".{output.name}.new")
    beside.write_text(json.dumps(known, indent=1), encoding="utf-8")
    beside.replace(output)


def table(faults: Sequence[Fault], results: Sequence[Result]) -> str:
    """Counts by room, and each fault that no test has noticed, with its reason."""
    heads = ("faults", "make test", "slow", "harmless", "survive", "not tried")
    rows: dict[str, list[int]] = {}
    lines = []
    for fault, result in zip(faults, results, strict=True):
        found, untried = result["verdict"] in ("found", "timed out"), result["verdict"] == "not tried"
        place = 2 if found and result["slow"] else 1 if found else 5 if untried else 3 if fault.harmless else 4
        for name in (fault.room, "all"):
            rows.setdefault(name, [0] * len(heads))
            rows[name][0] += 1
            rows[name][place] += 1
        if result["verdict"] == "timed out":
            lines.append(f"found by its time only: {fault.name}")
        elif place in (3, 4):
            lines.append(f"not found: {fault.name}{': ' if fault.harmless else ''}{fault.harmless or ''}")
        elif place == 1 and fault.harmless:
            lines.append(f"said to be harmless, and found: {fault.name}")
    if "all" in rows:
        rows["all"] = rows.pop("all")
    counted = [f"{name:14}" + "".join(f"{n:11}" for n in row) + _percent(row) for name, row in rows.items()]
    return "\n".join([f"{'room':14}" + "".join(f"{head:>11}" for head in heads), *counted, *lines])


def _percent(row: Sequence[int]) -> str:
    tried = row[0] - row[5]
    return f"   {100 * row[1] / tried:.1f} % by make test" if tried else ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 0 if every fault is found or has its reason."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("faults.json"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", metavar="TEXT", help="faults with this text in 'room: what it breaks'")
    parser.add_argument("--slow", action="store_true", help="the slow tests too, where no other has noticed the fault")
    options = parser.parse_args(arguments)
    faults = [fault for fault in read() if options.only in fault.name]
    results = run(faults, options.output, options.jobs, options.slow, lambda line: print(line, file=sys.stderr))
    print(table(faults, results))
    good = [
        result["verdict"] in ("found", "timed out") or fault.harmless
        for fault, result in zip(faults, results, strict=True)
    ]
    return 0 if all(good) else 1


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(main())
