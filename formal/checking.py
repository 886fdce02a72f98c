"""The fourth level of checking certificates again: what the kernel of Coq says of them (formal/README.md).

A certificate that stands at the levels before is written as files for Coq, and `check.sh` has these checked: its exit
code decides, and then whether what Coq states is what the certificate claims.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
import os
import shutil
import signal
import subprocess
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from time import monotonic
from typing import Any

from orbitproof.formal.arithmetic import NotShownError
from orbitproof.formal.files import THEORY, digest_of, name_of, sources_of, write_row
from orbitproof.formal.rows import Progress, export
from orbitproof.formal.statements import difference
from orbitproof.shared.formats import InputError
from orbitproof.shared.output import write_text
from orbitproof.shared.processes import Failure
from orbitproof.shared.sources import source_digests
from orbitproof.verify.certificate import Certificate, Recheck
from orbitproof.verify.certificate.levels import Meaning
from orbitproof.verify.evidence import IntegrationFailure, one_line, software
from orbitproof.verify.run import GIBIBYTE, INTEGRATION_SECONDS, CheckLimits, Display, Workplace, apart
from orbitproof.verify.scripting import recheck as recheck_before

COQ_IS_MISSING = "coqc is missing; on Debian and Ubuntu: apt install coq libcoq-bignums"
LEVEL = "4 kernel"
MEANING = Meaning(
    "all arithmetic of the proof: steps, crossings, every inequality of the conclusion, the parameter at the point",
    "orbits followed once more and written down for Coq, whose kernel computes; assumed are primitive integers only",
    "that kernel; the definitions of formal/theory; the lemmas on paper; that Coq's statement.txt says what the "
    "certificate does, which formal/statements.py compares",
)
"""What the level looks at, and what remains, beside `levels.MEANINGS`."""

_RECORD = "checked.json"
_MOST_STEPS = 10**6
_POLL_SECONDS = 0.2
_LONGEST_WORDS = 500
WATCHED = 'exec 3<&0; (cat <&3 >/dev/null; kill -KILL 0) & exec sh "$0" "$@" </dev/null 3<&-'
"""The script in a group of processes that ends as soon as nobody holds the other end of its standard input."""


@dataclass(frozen=True)
class KernelCheck:
    """What the kernel of Coq has said of one certificate.

    Attributes:
        before: how it stands at the levels before.
        checked: whether the kernel has checked the files of its row.
        words: what was checked and what remains on paper, or why it was not checked.
        seconds: processor time that Coq took.
        earlier: whether an earlier run in the same folder has checked these very files.
    """

    before: Recheck
    checked: bool
    words: str
    seconds: float = 0.0
    earlier: bool = False

    @property
    def id(self) -> str:
        """The certificate's id."""
        return self.before.id


def recheck(
    certificates: Certificate | Iterable[Certificate],
    *,
    folder: str | Path | None = None,
    integrate: bool = False,
    jobs: int = 1,
    timeout: float | None = None,
    memory: float = CheckLimits.memory / GIBIBYTE,
    quiet: bool = False,
    fresh: bool = False,
) -> list[KernelCheck]:
    """Check certified bifurcations again, up to the kernel of Coq.

    Arguments:
        certificates: from `verify.certify` or `verify.read`, each with an id of its own.
        folder: for the files and what Coq says of them (`statement.txt` of each row); a temporary one if none is given.
            What was checked in it before, with these certificates, files and theories, is not checked again.
        integrate: integrate again before that.
        jobs: processes of Coq side by side.
        timeout: seconds for each row by the clock; without one, four hours.
        memory: GiB for each process but those of Coq.
        quiet: nothing on standard error.
        fresh: check again what was checked before.

    Returns one `KernelCheck` for each, in their order: a row that Coq did not come to the end of is not checked, and
    `words` says why. Raises `InputError` if an id appears twice, rows would share a folder, or it cannot be written.
    After an interrupt (`KeyboardInterrupt`) no process is left, and the folder knows what was checked.
    """
    given = [certificates] if isinstance(certificates, Certificate) else list(certificates)
    workplace = Workplace(jobs, None, timeout, int(memory * GIBIBYTE), quiet)
    with closing(checks(given, None if folder is None else Path(folder), integrate, workplace, fresh)) as found:
        return list(found)


def checks(
    given: Sequence[Certificate], folder: Path | None, integrate: bool, workplace: Workplace, fresh: bool
) -> Generator[KernelCheck, None, None]:
    """What `recheck` returns, one by one; to be closed, whatever ends it."""
    own_folders(given)
    with ExitStack() as stack:
        place = folder or Path(stack.enter_context(TemporaryDirectory(prefix="orbitproof-formal-")))
        yield from _checks(given, place, folder is not None, integrate, workplace, fresh)


def _checks(
    given: Sequence[Certificate], folder: Path, kept: bool, integrate: bool, workplace: Workplace, fresh: bool
) -> Generator[KernelCheck, None, None]:
    before = recheck_before(
        given, integrate=integrate, jobs=workplace.jobs, timeout=workplace.timeout,
        memory=workplace.memory / GIBIBYTE, quiet=workplace.quiet,
    )  # fmt: skip
    try:
        display = Display({entry.id: _work(entry) for entry in given}, workplace.quiet)
        with _alone(folder), display.shown():
            run = _Run(folder, kept, workplace, fresh)
            for entry, check in zip(given, before, strict=True):
                result = run.check(entry, check, display)
                display.finish(entry.id, "checked" if result.checked else f"NOT CHECKED: {result.words}")
                yield result
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror}; give another folder") from None


def own_folders(certificates: Sequence[Certificate]) -> None:
    """Raises `InputError` if the files of two certificates would lie in one folder."""
    folders = {"theory": "the theory"}
    for entry in certificates:
        if (other := folders.setdefault(name_of(entry.id), entry.id)) != entry.id:
            raise InputError(f"{entry.id}: it would have the folder of {other}; write one of them elsewhere (--only)")


def _work(certificate: Certificate) -> float:
    """How long Coq takes grows with the steps; a file may say anything of them."""
    steps = 0 if "format" in certificate.document else certificate.computation.steps
    return 1.0 + min(steps, _MOST_STEPS)


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """No other run is at work in the folder meanwhile. Raises `OSError`; `InputError` if there is one."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"{folder}: another run is at work there; wait for it, or give another folder") from None
        yield


def written(certificate: Certificate, folder: Path, progress: Progress = lambda n, what: None) -> tuple[bool, str, str]:
    """Write the files of a row: whether they are written; how many steps and crossings, or why not; their digest."""
    try:
        row, digest = write_row(export(certificate, progress), folder)
    except (InputError, NotShownError, IntegrationFailure) as error:
        return False, str(error).removeprefix(f"{certificate.id}: "), ""
    except OSError as error:
        return False, f"the folder cannot be written: {error.strerror}", ""
    return True, size_of(row), digest


def size_of(row: Path) -> str:
    """How many steps and crossings the files in a folder have."""
    texts = [path.read_text("utf-8") for path in sources_of(row)]
    steps, crossings = (sum(text.count(f"\nLemma {word}_") for text in texts) for word in ("step", "crossing"))
    return f"{steps} step{'s' * (steps > 1)}, {crossings} crossing{'s' * (crossings > 1)}"


def lay_out(folder: Path) -> None:
    """Theories and script into the folder. Raises `OSError`; `InputError` if a link or a folder is in their place."""
    theory = folder / "theory"
    theory.mkdir(parents=True, exist_ok=True)
    if theory.resolve() == THEORY.resolve():
        raise InputError(f"{folder}: the theory itself lies there; give another folder")
    for path in (theory, folder / "check.sh", *theory.iterdir()):
        if path.is_symlink() or (path != theory and path.is_dir()):
            raise InputError(f"{path} is a link or a folder; remove it, or give another folder")
    for path in sorted(THEORY.glob("*.v")):
        shutil.copy(path, theory)
    shutil.copy(THEORY.parent / "check.sh", folder)


def _checked_words(entry: Certificate, before: Recheck, row: Path) -> str:
    """What the kernel has computed for the hypotheses of a certificate, and what their sections leave on paper."""
    # Words of another version are not printed, and sections are words.
    certificate = entry if before.rendered is None else Certificate(before.rendered)
    names = ", ".join(h.name for h in certificate.hypotheses)
    numbers = sorted({tuple(map(int, h.section.split("."))) for h in certificate.hypotheses})
    sections = [".".join(map(str, number)) for number in numbers if number >= (6,)]
    sections += ["12.1 to 12.3"] if "level_form" in certificate.statement else []
    claimed = ", ".join(filter(None, (certificate.claimed, certificate.on_side)))
    return (
        f"{size_of(row)}, all that is computed for {names}; on paper: that {claimed}, follows from it "
        f"(sections 1.3 to 5.2, {', '.join(sections)})"
    )


class _Run:
    """Rows of one folder, one after the other."""

    def __init__(self, folder: Path, kept: bool, workplace: Workplace, fresh: bool) -> None:
        """`kept`: the folder will still be there. Raises `OSError`; `InputError` if its record cannot be read."""
        self._folder, self._kept, self._jobs = folder.absolute(), kept, workplace.jobs
        self._limits = CheckLimits(workplace.timeout, workplace.memory, INTEGRATION_SECONDS)
        self._record = {} if fresh else _read(folder / _RECORD)
        self._missing = COQ_IS_MISSING if shutil.which("coqc") is None else ""
        self._theory_is_compiled = False
        self._coq = ""
        if not self._missing:
            version = subprocess.run(["coqc", "--version"], capture_output=True, check=False).stdout
            words = version.decode(errors="replace").strip().split("\n")[0]
            self._coq = f"{shutil.which('coqc')}: {words}"
            lay_out(folder)

    def check(self, entry: Certificate, before: Recheck, display: Display) -> KernelCheck:
        """What is found of a certificate that has been checked so far. Raises `OSError`."""
        why = f"it does not stand at the levels before: {before.why}" if not before.stands else self._missing
        found = KernelCheck(before, False, why) if why else self._check(entry, before, display)
        return replace(found, words=one_line(found.words))

    def _check(self, entry: Certificate, before: Recheck, display: Display) -> KernelCheck:
        row = self._folder / name_of(entry.id)
        kept = self._record.get(entry.id)
        now = {"of": self._digest(entry, _digest_of_files(row)), "stated": _stated(row)}
        if kept is not None and now.items() <= kept.items():
            words = f"{self._words(entry, before, row)}; {self._folder / _RECORD} says so, `fresh` checks it again"
            return KernelCheck(before, True, words, float(kept["seconds"]), True)
        display.advance(entry.id, 0.0, "following its orbits")
        answer = apart(written, entry.id, (entry, self._folder), self._limits)
        if isinstance(answer, Failure):
            return KernelCheck(before, False, f"its files are not written: {answer.message}")
        is_written, words, digest = answer
        if not is_written:
            return KernelCheck(before, False, f"its files are not written: {words}")
        if not self._theory_is_compiled:
            display.advance(entry.id, 0.1, "compiling the theory")
            code, said, _ = self._script(["-t"], None)
            if code != 0:
                return KernelCheck(before, False, said)
            self._theory_is_compiled = True
        of = self._digest(entry, digest)
        files = sum(1 for _ in sources_of(row))

        def progress() -> None:
            with suppress(OSError):
                done = (row / "done").read_text().count("\n")
                display.advance(entry.id, 0.1 + 0.9 * done / files, f"Coq: {done} of {files} files")

        code, said, seconds = self._script(["-k", "-j", str(self._jobs), row.name], progress)
        if code != 0:
            return KernelCheck(before, False, said, seconds)
        if of != self._digest(entry, _digest_of_files(row)):
            return KernelCheck(before, False, "its files were changed meanwhile", seconds)
        if other := difference(entry, (row / "statement.txt").read_text("utf-8", "replace")):
            return KernelCheck(before, False, other, seconds)
        self._record[entry.id] = {"of": of, "stated": _stated(row), "seconds": round(seconds, 1)}
        write_text(self._folder / _RECORD, json.dumps(self._record, indent=1))
        return KernelCheck(before, True, self._words(entry, before, row), seconds)

    def _words(self, entry: Certificate, before: Recheck, row: Path) -> str:
        """What was checked, by what, and where the reader sees of what."""
        words = f"{_checked_words(entry, before, row)}; by {self._coq}"
        read = f"read {row / 'statement.txt'}" if self._kept else "give a `folder` to read it"
        said = "what Coq states is the claim of the certificate, of its results the parameter only, between wider ends"
        return f"{words}; {said}: {read}"

    def _script(self, words: Sequence[str], progress: Callable[[], None] | None) -> tuple[int, str, float]:
        """Run `check.sh`: its exit code, the end of what it said, and processor time."""
        start, before = monotonic(), _processor_seconds()
        with TemporaryFile("w+", encoding="utf-8", errors="replace") as into:
            run = subprocess.Popen(
                ["sh", "-c", WATCHED, str(self._folder / "check.sh"), *words],
                stdin=subprocess.PIPE, stdout=into, stderr=subprocess.STDOUT, start_new_session=True,
            )  # fmt: skip
            try:
                while True:
                    try:
                        code = run.wait(_POLL_SECONDS)
                        break
                    except subprocess.TimeoutExpired:
                        if progress is not None:
                            progress()
                        if monotonic() - start > self._limits.with_integration:
                            late = "Coq did not come to an end in time; give it more (`timeout`)"
                            return 1, late, _processor_seconds() - before
            finally:
                with suppress(ProcessLookupError):
                    os.killpg(run.pid, signal.SIGKILL)
                run.wait()
                assert run.stdin is not None
                run.stdin.close()
            into.seek(0)
            _, sign, words = into.read().rpartition("NOT CHECKED: ")
        words = words[:_LONGEST_WORDS] if sign else words[-_LONGEST_WORDS:]
        return code, words or f"it ended with {code}", _processor_seconds() - before

    def _digest(self, entry: Certificate, files: str) -> str:
        """Of all that a check rests on: the certificate, Coq, what writes files, theories, the script, the files."""
        exporter = source_digests([("formal", Path(__file__).parent)], ())
        found = hashlib.sha256(json.dumps([entry.to_json(), self._coq, software(), *exporter, files]).encode())
        theory = sorted((self._folder / "theory").glob("*.v"))
        for path in (self._folder / "check.sh", *theory):
            found.update(f"{path.name} {hashlib.sha256(path.read_bytes()).hexdigest()}".encode())
        return found.hexdigest()


def _read(path: Path) -> dict[str, Any]:
    """What earlier runs have checked; nothing if it is not known. Raises `InputError` for another file."""
    if not path.exists():
        return {}
    with suppress(ValueError, RecursionError):
        found = json.loads(path.read_text("utf-8"))
        if isinstance(found, dict) and all(
            isinstance(kept, dict)
            and isinstance(s := kept.get("seconds"), float)
            and math.isfinite(s)
            and {"of", "stated"} <= {*kept}
            for kept in found.values()
        ):
            return found
    raise InputError(f"{path}: it does not say what was checked; give another folder, or --fresh")


def _stated(row: Path) -> str:
    """The digest of what Coq has said is claimed; empty if that is not there."""
    path = row / "statement.txt"
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""


def _digest_of_files(row: Path) -> str:
    return digest_of((path.name, path.read_text("utf-8")) for path in sources_of(row))


def _processor_seconds() -> float:
    """Of the processes that this one has waited for, and of theirs."""
    times = os.times()
    return times.children_user + times.children_system
