"""What is to hold before a release: ``python tests/release_check.py`` (``make release-check``).

1. Wheel and source distribution are built from the tracked files; the wheel made from the source distribution has the
   same files.
2. Each is installed into an empty environment, and proves and refuses what it should, outside of the checkout.
3. The two commands of the README, `make demo` and `make test`, run in a copy of the tracked files with an environment
   of its own.
4. Every command that README and documents print is run once, those of a page in order in a folder of their own with
   the files of docs/examples. What is not run is told with the reason: its input is the reader's own, it is a pattern,
   or it took longer than the limit, of processor time where the system tells it, so that other work on the machine
   stops no command.

The last lines count. The exit code is 1 if anything failed.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "docs" / "examples"
README_COMMANDS = ("demo", "test")
FOUND, REFUSED = (0, 1), 2
_LOOK_SECONDS = 0.5
_PATIENCE = 20
"""A command that waits is stopped after so many times the limit."""

_FENCE = re.compile(r"^```(\w*)[ ]?(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"^ {4}(orbitproof .*)$", re.MULTILINE)
_WRITTEN = re.compile(r"`(\w+\.py)`[^\n]*\n\n((?: {4}.*\n|\n)+)")
_MISSING = re.compile(r"(\S+(?<!\.py)): cannot be read")
PATTERN = re.compile(r"(^|\s)(FILE|FOLDER|ADDRESS|NAME|ID|K|MU|[A-Z]+\.json|\.\.)(\s|$)|=\.\.|(^|\s)\[|<")


@dataclass(frozen=True)
class Command:
    """A printed command: the page, its words after `orbitproof`, and the code that the page says it exits with."""

    page: str
    text: str
    code: int | None = None


@dataclass(frozen=True)
class Outcome:
    """What became of a command: "ran", "skipped" or "failed", and why."""

    word: str
    why: str


def tracked_copy(folder: Path) -> Path:
    """The tracked files as they are, elsewhere."""
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, names.split("\0")):
        if (ROOT / name).is_file():
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, target)
    return folder


def commands_of(page: Path) -> Iterator[Command]:
    """The commands of a page in order: those of its blocks, and indented lines outside of blocks."""
    text, name = page.read_text("utf-8"), page.relative_to(ROOT).as_posix()
    found: list[tuple[int, Command]] = []
    for block in _FENCE.finditer(text):
        code = int(block[2].removeprefix("exit=")) if block[2].startswith("exit=") else None
        if block[1] in ("sh", "console", "bash"):
            lines = block[3].replace("\\\n", " ").splitlines()
            found += [(block.start() + i, Command(name, line.strip(), code)) for i, line in enumerate(lines)]
    outside = _FENCE.sub(lambda block: " " * len(block[0]), text.replace("\\\n", "  "))
    found += [(line.start(), Command(name, line[1])) for line in _INDENTED.finditer(outside)]
    for _, command in sorted(found, key=lambda pair: pair[0]):
        words = re.split(r"\s{2,}\(|\s+# ", command.text.removeprefix("$ "))[0].strip()
        if words.startswith("orbitproof "):
            yield Command(name, words, command.code)


def files_of(page: Path) -> dict[str, str]:
    """The files that a page shows by name: blocks such as ```python spring.py, and indented ones after the name."""
    text = page.read_text("utf-8")
    found = {name: textwrap.dedent(code) for name, code in _WRITTEN.findall(text) if "orbitproof" not in code}
    blocks = _FENCE.findall(text)
    return found | {name: code for _, name, code in blocks if re.fullmatch(r"[\w.-]+\.(py|json)", name)}


def processor_seconds(session: int) -> float | None:
    """What the processes of a session, and those that they have waited for, have used; `None` if nobody knows."""
    ticks = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            # The name, in parentheses, may hold anything.
            fields = path.read_text().rpartition(")")[2].split()
            if int(fields[3]) == session:
                ticks += sum(map(int, fields[11:15]))
    return ticks / os.sysconf("SC_CLK_TCK") if Path("/proc/self/stat").exists() else None


def wait(process: subprocess.Popen[str], limit: float) -> str | None:
    """What a process says on standard error; `None` if it is not done after so much processor time."""
    started = time.monotonic()
    while True:
        try:
            return process.communicate(timeout=_LOOK_SECONDS)[1]
        except subprocess.TimeoutExpired:
            used = processor_seconds(process.pid)
            passed = time.monotonic() - started
            if (passed if used is None else max(used, passed / _PATIENCE)) >= limit:
                return None


def run_command(command: Command, folder: Path, python: Path, limit: float) -> Outcome:
    """Run a command in a folder, for at most `limit` seconds of processor time."""
    if PATTERN.search(command.text):
        return Outcome("skipped", "a pattern, with words for the reader's own")
    try:
        words = shlex.split(command.text)[1:]
    except ValueError as error:
        return Outcome("failed", f"no command line: {error}")
    if any(word in ("|", ">", "&&") for word in words):
        return Outcome("skipped", "needs a shell")
    process = subprocess.Popen(
        [str(python), "-m", "orbitproof", *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True, start_new_session=True, env={**os.environ, "JAX_PLATFORMS": "cpu"},
    )  # fmt: skip
    errors = wait(process, limit)
    if errors is None:
        os.killpg(process.pid, signal.SIGTERM)
        try:
            process.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
        return Outcome("skipped", f"not done in {limit:g} s of processor time")
    missing = _MISSING.search(errors)
    if process.returncode == REFUSED and missing and command.code is None:
        return Outcome("skipped", f"its input {missing[1]} is the reader's own, or of a command that was not run")
    expected = FOUND if command.code is None else (command.code,)
    if process.returncode in expected and "Traceback" not in errors:
        return Outcome("ran", f"exit code {process.returncode}")
    last = (errors.strip().splitlines() or [""])[-1]
    return Outcome("failed", f"exit code {process.returncode}: {last}")


def check_printed(pages: Sequence[Path], python: Path, limit: float) -> Counter[str]:
    """Run the commands of all pages, a line for each."""
    counts: Counter[str] = Counter()
    for page in pages:
        with tempfile.TemporaryDirectory() as name:
            for path in EXAMPLES.iterdir():
                if path.is_file():
                    shutil.copy(path, name)
            for file, text in files_of(page).items():
                (Path(name) / file).write_text(text, "utf-8")
            unfinished: set[str] = set()
            for command in commands_of(page):
                started = time.monotonic()
                outcome = run_command(command, Path(name), python, limit)
                files = {word for word in command.text.split() if "." in word and not word.startswith("-")}
                if outcome.word == "failed" and files & unfinished:
                    outcome = Outcome("skipped", f"what it reads is of a command that was stopped; {outcome.why}")
                if outcome.why.startswith("not done"):
                    unfinished |= files
                counts[outcome.word] += 1
                seconds = time.monotonic() - started
                print(f"{outcome.word:8}{command.page}: {command.text}  ({outcome.why}; {seconds:.0f} s)", flush=True)
    return counts


def build(sources: Path, target: Path) -> tuple[Path, Path]:
    """Wheel and source distribution of a folder."""
    for kind in ("wheel", "sdist"):
        code = f"from setuptools import build_meta as b; b.build_{kind}({str(target)!r})"
        subprocess.run([sys.executable, "-c", code], cwd=sources, check=True, capture_output=True, text=True)
    (wheel,), (sdist,) = target.glob("*.whl"), target.glob("*.tar.gz")
    return wheel, sdist


def contents(wheel: Path) -> set[str]:
    """Names of the files that a wheel installs."""
    with zipfile.ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if ".dist-info/" not in name}


def environment(folder: Path, what: str) -> Path:
    """A new environment with one thing installed; its interpreter."""
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    python = folder / "bin" / "python"
    subprocess.run([str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", what], check=True)
    return python


def check_installed(python: Path, folder: Path) -> None:
    """The base installation proves a claim, checks the certificate again, and names the extra that search needs."""
    shutil.copy(ROOT / "tests" / "data" / "figures-candidates.json", folder / "candidates.json")

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [str(python), "-m", "orbitproof", *words]
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)

    assert run("--version").returncode == 0
    proved = run("verify", "candidates.json", "--only", "falkner-skan-odd-k2-1", "-o", "certificates.json")
    assert (proved.returncode, "proved" in proved.stdout) == (0, True), proved.stderr
    assert run("verify", "--recheck", "certificates.json").returncode == 0
    refused = run("explore", "family", "--system", "falkner-skan", "-o", "family.json")
    assert (refused.returncode, "pip install 'orbitproof[explore]'" in refused.stderr) == (2, True), refused.stderr


def check_packages(folder: Path) -> None:
    """Build, compare, install each into an empty environment, try it."""
    wheel, sdist = build(tracked_copy(folder / "sources"), folder / "dist")
    shutil.unpack_archive(sdist, folder / "unpacked")
    (again,) = (folder / "unpacked").iterdir()
    second, _ = build(again, folder / "dist-again")
    assert contents(wheel) == contents(second), contents(wheel) ^ contents(second)
    print(f"built   {wheel.name}, {wheel.stat().st_size} bytes; {sdist.name}, {sdist.stat().st_size} bytes", flush=True)
    for package in (wheel, sdist):
        place = folder / f"empty-{package.suffix[1:]}"
        place.mkdir()
        check_installed(environment(place / "environment", str(package)), place)
        print(f"ran     {package.name} installed empty: proves, checks again, names what search needs", flush=True)


def check_readme(folder: Path) -> int:
    """The two commands of the README in a copy of the tracked files; the number of those that fail."""
    clone, failed = tracked_copy(folder / "clone"), 0
    for command in (["git", "init", "-q"], ["git", "add", "-A"]):
        subprocess.run(command, cwd=clone, check=True)
    for name in README_COMMANDS:
        assert f"make {name} " in (ROOT / "README.md").read_text("utf-8")
        started = time.monotonic()
        code = subprocess.run(["make", name], cwd=clone, check=False, stdout=subprocess.DEVNULL).returncode
        print(
            f"{'ran' if code == 0 else 'failed':8}make {name}  (exit code {code}; {time.monotonic() - started:.0f} s)"
        )
        failed += code != 0
    return failed


def main() -> int:
    """Run the command line; returns the exit code."""
    parser = argparse.ArgumentParser(description="Check what a release needs.")
    parser.add_argument(
        "--limit", type=float, default=600.0, metavar="S", help="of processor time, for each printed command"
    )
    parser.add_argument("--only", nargs="+", choices=("packages", "readme", "printed"), help="these parts")
    parser.add_argument("--pages", nargs="+", type=Path, metavar="FILE", help="these pages only")
    options = parser.parse_args()
    parts = options.only or ("packages", "readme", "printed")
    pages = [path.resolve() for path in options.pages or ()] or [
        ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs").glob("*/*.md")),
    ]  # fmt: skip
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        if "packages" in parts:
            check_packages(Path(name))
        if "readme" in parts:
            failed += check_readme(Path(name))
    if "printed" in parts:
        counts = check_printed(pages, Path(sys.executable), options.limit)
        failed += counts["failed"]
        print(f"printed commands: {counts['ran']} ran, {counts['skipped']} not run, {counts['failed']} failed")
    print("ready" if not failed else f"not ready: {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
