"""Command line of the formal check: ``orbitproof verify --formal``, and with ``--recheck`` the fourth level of a check.

It follows the orbits of each row once more, and writes Coq files. What is proved by them is what Coq says.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

from orbitproof.formal.checking import LEVEL, MEANING, KernelCheck, checks, lay_out, own_folders, written
from orbitproof.formal.files import name_of
from orbitproof.shared.answers import answered, tell
from orbitproof.shared.formats import InputError, as_options, refused, select_ids
from orbitproof.shared.printed_tables import fitted
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import read_certificates
from orbitproof.verify.run import ArgumentParser, Workplace, interrupted, positive_seconds, whole_number
from orbitproof.verify.run.row_tables import recheck_table, rechecks_as_json

_DESCRIPTION = """\
Write certified bifurcations as Coq files, which the kernel of Coq checks; with --recheck, have it check them.

The files hold approximate solutions, step by step, and claims about them. What Coq shows of these, and what is left to
proofs on paper, stands in formal/README.md. Coq is not needed to write them.
"""

_EXAMPLES = """\
examples:
  orbitproof verify --formal certificates.json -o formal-out
      write all bifurcations of a file; sh formal-out/check.sh has them checked
  orbitproof verify --formal certificates.json -o formal-out --only "falkner-skan-*"
      some of them
  orbitproof verify --recheck --formal certificates.json -o formal-out --jobs 2
      check certificates again, up to the kernel of Coq; if interrupted, the same command goes on

exit codes: 0 all are written, 1 some are not, 2 bad input, 130 interrupted
with --recheck: 0 all are checked by Coq, 1 some are not, or Coq is missing, 2 bad input, 130 interrupted
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    parser = ArgumentParser("orbitproof verify --formal", _DESCRIPTION, _EXAMPLES)
    parser.add_argument("file", type=Path, help="certificates file (JSON)")
    words = "folder for the Coq files; with --recheck, a temporary one if none is given"
    parser.add_argument("-o", "--output", type=Path, help=words)
    parser.add_argument("--only", nargs="+", metavar="ID", help="these only (with * and ? as in file names)")
    parser.add_argument("--recheck", action="store_true", help="check certificates again, and have Coq check the files")
    parser.add_argument("--integrate", action="store_true", help="with --recheck: integrate again before that")
    parser.number("--jobs", "N", "with --recheck: processes of Coq side by side (default: 1)", whole_number(1), 1)
    words = "with --recheck: give a row up after this time, by the clock (default: four hours)"
    parser.number("--row-timeout", "SECONDS", words, positive_seconds, None)
    parser.memory_option("each check but that of Coq, with --recheck")
    words = "with --recheck: check again what was checked in the same folder before"
    parser.add_argument("--fresh", action="store_true", help=words)
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")
    options = parser.parse_args(arguments)
    return answered("orbitproof verify --formal", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    try:
        return _recheck(options) if options.recheck else _run(options)
    except InputError as error:
        return refused(error)


def _run(options: argparse.Namespace) -> int:
    if options.output is None:
        raise InputError("-o: give a folder for the Coq files")
    if options.integrate:
        raise InputError("--integrate: there is nothing to integrate again; give it together with --recheck")
    stored = read_certificates(options.file)
    selected = [stored[name] for name in select_ids(stored, options.only, "certificate")]
    own_folders(selected)
    results = []
    try:
        lay_out(options.output)
        for entry in selected:

            def progress(steps: int, what: str, name: str = entry.id) -> None:
                if not options.quiet:
                    print(f"{name}: {steps} {what}", file=sys.stderr)

            done, words, _ = written(entry, options.output, progress)
            line = (
                f"{entry.id}: {options.output / name_of(entry.id)}, {words}"
                if done
                else f"{entry.id}: not written: {words}"
            )
            results.append({"id": entry.id, "written": done, "line": line})
    except OSError as error:
        raise InputError(f"{options.output}: cannot be written: {error.strerror}; give another folder") from None
    count = sum(bool(result["written"]) for result in results)
    text = "\n".join(str(result["line"]) for result in results)
    text += f"\n{count} of {len(selected)} written; have Coq check them: sh {options.output / 'check.sh'}"
    tell(text, results)
    return 0 if count == len(selected) else 1


def _recheck(options: argparse.Namespace) -> int:
    stored = read_certificates(options.file)
    selected = [stored[name] for name in select_ids(stored, options.only, "certificate")]
    workplace = Workplace(options.jobs, None, options.row_timeout, options.memory, options.quiet)
    done: list[KernelCheck] = []
    ended = False
    try:
        with closing(checks(selected, options.output, options.integrate, workplace, options.fresh)) as found:
            for check in found:
                done.append(check)
    except KeyboardInterrupt:
        ended = True
    before = {check.id: check.before for check in done}
    names = [entry.id for entry in selected]
    as_json = [
        {**row, "kernel": check.checked, "words": _as_said(check), "seconds": round(check.seconds, 1)}
        for row, check in zip(rechecks_as_json(names, before), done, strict=True)
    ]
    tell(f"{recheck_table(names, before)}\n\n{_table(done)}", as_json)
    if ended:
        return interrupted(len(done), len(selected), "certificates checked")
    return 0 if all(check.checked for check in done) else 1


def _as_said(check: KernelCheck) -> str:
    return as_options(check.words, timeout="--row-timeout", folder="-o FOLDER")


def _table(checks: Sequence[KernelCheck]) -> str:
    """What the kernel of Coq has said of each; then what it has checked and what remains, row by row and in general."""
    rows = [("certificate", "kernel of Coq", "processor time")]
    for check in checks:
        word = ("checked before" if check.earlier else "checked") if check.checked else "NOT CHECKED"
        rows.append((shown(check.id), word, f"{check.seconds:.1f} s" if check.seconds else ""))
    words = [f"{shown(check.id)}: {_as_said(check)}" for check in checks]
    legend = [("level", "what was checked", "how", "what remains to be believed")]
    legend.append((LEVEL, MEANING.checked, MEANING.how, MEANING.remains))
    tables = [fitted(rows), words, fitted(legend) if any(check.checked for check in checks) else []]
    return "\n\n".join("\n".join(lines) for lines in tables if lines)
