"""Faults made on purpose, one line each: ``python tests/faults/run.py --output faults.json``.

The files beside this one are the table, one for each room of the trusted modules (`read`): faults that change an idea.
Beside them stand faults by rule (`slips`), drawn from all that can be made of the trusted modules: with ``--slips 200
--seed 1`` two hundred, always the same until the modules change; of all of them ``--sample 300`` draws three hundred.
Every fault is applied to a copy of the package, and the tests of its room run on the copy until one of them fails:
those that `make test` runs and the one that its entry names, and with ``--slow`` those that `make test-slow` runs where
no other has noticed the fault.
Results are kept one by one, and the same command goes on; it tries a fault again when its patch or the modules beside
it have changed, and one that no test has noticed when its tests have.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import child
import slips

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
        first: tests that run before those of the room; one that is slow runs after those of `make test`.
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
    """All faults of the table, by room. A file of it has, by module, what is broken with section, old and new text.

    Behind these may stand tests that run first, and last ``{ harmless = .. }``.
    """
    faults = []
    for path in sorted(folder.glob("*.toml")):
        room = tomllib.loads(path.read_text(encoding="utf-8"))
        tests = tuple(room.pop("tests"))
        for file, entries in room.items():
            for breaks, (section, old, new, *rest) in entries.items():
                harmless = rest.pop()["harmless"] if rest and isinstance(rest[-1], dict) else None
                faults.append(Fault(path.stem, breaks, section, file, old, new, tuple(rest), tests, harmless))
    return faults


def trusted_modules() -> list[str]:
    """Those with which faults by rule are made: guesses, attempts and runs decide nothing."""
    paths = (path.relative_to(ROOT).as_posix() for room in TRUSTED for path in sorted((ROOT / room).rglob("*.py")))
    apart = ("verify/oracle/", "verify/attempt/", "verify/alone/", "verify/run/", "verify/scripting", "shared/printing")
    return [path for path in paths if not path.startswith(apart) and not path.endswith("__init__.py")]


def drawn(count: int, seed: int, table: Sequence[Fault]) -> list[Fault]:
    """Faults by rule, drawn at random; tests are those of the rooms with most faults in the folder and in the file."""
    every = [slip for file in trusted_modules() for slip in slips.slips(ROOT, file)]
    random.Random(seed).shuffle(every)
    rooms: dict[str, Counter[str]] = {}
    for fault in table:
        for place in (fault.file, _folder(fault.file)):
            rooms.setdefault(place, Counter())[fault.room] += 1
    tests = {fault.room: fault.tests for fault in table}
    found: dict[str, Fault] = {}
    for slip in every:
        text = (ROOT / slip.file).read_text(encoding="utf-8")
        if len(found) == count:
            break
        if not slips.changes(slip, text):
            continue
        places = [each for each in (_folder(slip.file), slip.file) if each in rooms] or ["verify/certificate"]
        room, *more = dict.fromkeys(rooms[each].most_common(1)[0][0] for each in places)
        begin, end = slip.begin, slip.end
        while text.count(text[begin:end]) > 1:
            begin, end = max(begin - 1, 0), end + 1
        new = text[begin : slip.begin] + slip.new + text[slip.end : end]
        breaks = f"{slip.file}:{slip.line}: {slip.rule}: {slip.function}: {slip.says}"
        first = tuple(dict.fromkeys(test for fault in table if fault.file == slip.file for test in fault.first))
        section = ", ".join(slip.sections)
        around = tuple(dict.fromkeys(test for name in (room, *more) for test in tests[name]))
        found[breaks] = Fault(room, breaks, section, slip.file, text[begin:end], new, first, around, None)
    return list(found.values())


def _folder(file: str) -> str:
    return "/".join(file.split("/")[: 2 if file.startswith("verify/") else 1])


def copied(folder: Path, more: Iterable[str] = ()) -> None:
    """A checkout in a folder whose trusted modules, and what more is named, may be changed; the rest are links."""
    shutil.copytree(ROOT / "src", folder / "src", symlinks=True, ignore=shutil.ignore_patterns("*.egg-info"))
    for room in (*TRUSTED, "explore", "figures"):
        link = folder / "src" / "orbitproof" / room
        link.unlink(missing_ok=True)
        link.symlink_to(Path("..", "..", room), target_is_directory=True)
    for name in (*TRUSTED, *more):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in set(LINKED) - set(more):
        (folder / name).symlink_to(ROOT / name)


def tested(
    folder: Path,
    tests: Iterable[str],
    slow: bool,
    times: Mapping[str, float],
    all_of_them: bool,
    first: Sequence[str],
) -> Result:
    """Run tests on a copy, `first` and those that took little of the `times` first; until one fails, or all of them.

    Those that are `slow`, or all others; single tests in `first` run in either case.
    """
    arguments = ["--tb=no", "-p", "no:cacheprovider", "--hypothesis-seed=0", "-m", ""]
    arguments += [*([] if all_of_them else ["-x"]), *dict.fromkeys(tests)]
    begin = time.monotonic()
    # The server has imported what is not under test once, and each process is a fork of it.
    process = _SERVER.Process(target=child.run_tests, args=(folder, arguments, slow, dict(times), first))
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
    seconds = round(time.monotonic() - begin, 1)
    result = {"verdict": verdict, "by": by, "slow": slow or found.get("slow", False), "seconds": seconds}
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
    quick, both = (100 * sum(row[1:last]) / max(tried, 1) for last in (2, 3))
    return f"   {quick:.1f} % by make test, {both:.1f} % with make test-slow" if tried else ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 0 if every fault is found or has its reason."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("faults.json"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", metavar="TEXT", help="faults with this text in 'room: what it breaks'")
    parser.add_argument("--slow", action="store_true", help="the slow tests too, where no other has noticed the fault")
    parser.add_argument("--slips", type=int, default=0, metavar="N", help="so many faults by rule beside the table")
    parser.add_argument("--seed", type=int, default=1, help="which of them, and which sample")
    parser.add_argument("--sample", type=int, default=0, metavar="N", help="only so many of all, drawn at random")
    options = parser.parse_args(arguments)
    table_of_faults = read()
    made = drawn(options.slips, options.seed, table_of_faults)
    faults = [fault for fault in (*table_of_faults, *made) if options.only in fault.name]
    if options.sample:
        faults = random.Random(options.seed).sample(faults, min(options.sample, len(faults)))
    try:
        results = run(faults, options.output, options.jobs, options.slow, lambda line: print(line, file=sys.stderr))
    except KeyboardInterrupt:
        print(f"stopped; {options.output} has what is known, and the same command goes on", file=sys.stderr)
        return 1
    print(table(faults, results))
    good = [
        result["verdict"] in ("found", "timed out") or fault.harmless
        for fault, result in zip(faults, results, strict=True)
    ]
    return 0 if all(good) else 1


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(main())
