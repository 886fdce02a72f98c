"""Command line of the formal check: ``orbitproof verify --formal certificates.json -o formal-out``.

It follows the orbits of each row once more, and writes Coq files. What is proved by them is what Coq says.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.formal.arithmetic import NotShownError
from orbitproof.formal.files import THEORY, name_of, write_row
from orbitproof.formal.rows import export
from orbitproof.shared.answers import answered, tell
from orbitproof.shared.formats import InputError, refused, select_ids
from orbitproof.verify.certificate import Certificate, read_certificates
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.run import ArgumentParser

_DESCRIPTION = """\
Write certified bifurcations as Coq files, which the kernel of Coq checks.

The files hold approximate solutions, step by step, and claims about them. What Coq shows of these, and what is left to
proofs on paper, stands in formal/README.md. Coq is not needed to write them.
"""

_EXAMPLES = """\
examples:
  orbitproof verify --formal certificates.json -o formal-out
      write all bifurcations of a file; sh formal-out/check.sh has them checked
  orbitproof verify --formal certificates.json -o formal-out --only "falkner-skan-*"
      some of them

exit codes: 0 all are written, 1 some are not, 2 bad input, 130 interrupted
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    parser = ArgumentParser("orbitproof verify --formal", _DESCRIPTION, _EXAMPLES)
    parser.add_argument("file", type=Path, help="certificates file (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for the Coq files")
    parser.add_argument("--only", nargs="+", metavar="ID", help="these only (with * and ? as in file names)")
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")
    options = parser.parse_args(arguments)
    return answered("orbitproof verify --formal", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    try:
        return _run(options)
    except InputError as error:
        return refused(error)


def _run(options: argparse.Namespace) -> int:
    stored = read_certificates(options.file)
    selected = [stored[name] for name in select_ids(stored, options.only, "certificate")]
    folders: dict[str, str] = {}
    for entry in selected:
        if (other := folders.setdefault(name_of(entry.id), entry.id)) != entry.id:
            raise InputError(f"{entry.id}: it would have the folder of {other}; write one of them elsewhere (--only)")
    theory = options.output / "theory"
    try:
        theory.mkdir(parents=True, exist_ok=True)
        for path in sorted(THEORY.glob("*.v")):
            shutil.copy(path, theory)
        shutil.copy(THEORY.parent / "check.sh", options.output)
        lines = {entry.id: _written(entry, options) for entry in selected}
    except OSError as error:
        raise InputError(f"{options.output}: cannot be written: {error.strerror}; give another folder") from None
    written = [name for name, (done, _) in lines.items() if done]
    text = "\n".join(line for _, line in lines.values())
    text += f"\n{len(written)} of {len(selected)} written; have Coq check them: sh {options.output / 'check.sh'}"
    tell(text, [{"id": name, "written": done, "line": line} for name, (done, line) in lines.items()])
    return 0 if len(written) == len(selected) else 1


def _written(entry: Certificate, options: argparse.Namespace) -> tuple[bool, str]:
    def progress(steps: int, what: str) -> None:
        if not options.quiet:
            print(f"{entry.id}: {steps} {what}", file=sys.stderr)

    try:
        row = export(entry, progress)
        folder = write_row(row, options.output)
    except (InputError, NotShownError, IntegrationFailure) as error:
        return False, f"{entry.id}: not written: {str(error).removeprefix(f'{entry.id}: ')}"
    crossings = len(row.arrivals)
    return True, f"{entry.id}: {folder}, {len(row.moves)} steps, {crossings} crossing{'s' * (crossings > 1)}"
