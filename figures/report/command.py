"""``orbitproof report``: what certificates prove, as one document."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.systems import shown
from orbitproof.verify.engines import CHECK_SECONDS, LONG_CHECK_SECONDS, ArgumentParser, Display, positive_seconds

_EXAMPLES = """\
examples:
  orbitproof report certificates.json -o report.html
  orbitproof report certificates.json branches-out/*-certificate.json -o paper.tex -o paper.html
  orbitproof report l1-certificate.json -o l1.md --no-pictures
  orbitproof report certificates.json -o k2.html --only "*-k2-*"

Each theorem as a statement that stands alone, with its hypotheses, margins and pictures; how to check it again,
software and digests, references. HTML carries its pictures; those of LaTeX and Markdown go into a folder beside the
file. Every certificate is checked up to its conclusion first (verify --recheck): one that does not stand is named, and
then nothing is written.
Exit codes: 0 written, everything in it is proved; 1 a certificate does not stand and nothing was written, or the report
was written and says what is not proved; 2 bad input;
130 interrupted.
"""


def argument_parser() -> argparse.ArgumentParser:
    """The command line."""
    words = "A report of what certificates prove, to read, to print and to cite."
    parser = ArgumentParser("orbitproof report", words, _EXAMPLES)
    parser.add_argument("certificates", type=Path, nargs="+", help="certificates of bifurcations and of atlases (JSON)")
    words = ".html, .tex or .md; once for each file that is to be written"
    parser.add_argument("-o", "--output", type=Path, action="append", required=True, metavar="FILE", help=words)
    parser.add_argument("--only", nargs="+", metavar="ID", help="these certificates (with * and ? as in file names)")
    parser.add_argument("--no-pictures", action="store_true", help="text, formulas and tables only")
    words = f"give a check up after this time (default: {CHECK_SECONDS:g}; of curves {LONG_CHECK_SECONDS:g})"
    parser.number("--timeout", "SECONDS", words, positive_seconds, None)
    parser.memory_option("each check")
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = argument_parser().parse_args(arguments)
    try:
        return _run(options)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: nothing was written", file=sys.stderr)
        return INTERRUPTED


def _run(options: argparse.Namespace) -> int:
    from orbitproof.figures.report.content import report_of
    from orbitproof.figures.report.statements import is_proved, name_of
    from orbitproof.figures.report.theorems import Refused, check_files
    from orbitproof.figures.report.writers import format_of, write_report

    for output in options.output:
        format_of(output)
        check_writable(output)
    try:
        entries = check_files(options.certificates, options.only, options.quiet, options.timeout, options.memory)
    except Refused as refusal:
        for path, check in refusal.rechecks:
            found = check.findings[0] if check.findings else None
            what = check.obstacle if found is None else f"{found.place}: {found.message}"
            print(f"REFUSED {path}: {shown(check.id)}: {what}", file=sys.stderr)
        print("nothing was written: a report tells only what follows from its certificates", file=sys.stderr)
        return 1
    proved = [entry for entry in entries if is_proved(entry)]
    pictures = {}
    if not options.no_pictures:
        from orbitproof.figures.report.pictures import pictures_of

        display = Display({name_of(entry): 1.0 for entry in proved}, options.quiet)
        with display.shown():
            for entry in proved:
                pictures[name_of(entry)] = pictures_of(entry)
                display.finish(name_of(entry), "drawn" if pictures[name_of(entry)] else "has no picture")
    report = report_of(entries, lambda entry: pictures.get(name_of(entry), ()))
    for output in options.output:
        for path in write_report(output, report):
            print(path)
    return 0 if len(proved) == len(entries) else 1


if __name__ == "__main__":
    sys.exit(run_command(main))
