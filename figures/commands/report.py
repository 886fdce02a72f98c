"""``orbitproof report``: what certificates prove, as one document."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.shared.answers import answered
from orbitproof.shared.formats import InputError, as_options, refused
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.output import what_is_written
from orbitproof.shared.systems import shown
from orbitproof.verify.run import CHECK_SECONDS, GIBIBYTE, LONG_CHECK_SECONDS, ArgumentParser, positive_seconds

_EXAMPLES = """\
examples:
  orbitproof report certificates.json -o report.html
  orbitproof report certificates.json branches-out/*-certificate.json -o paper.tex -o paper.html
  orbitproof report l1-certificate.json -o l1.md --no-pictures
  orbitproof report web-certificate.json arcs/*.json certificates.json -o web.html
  orbitproof report rows.json curve.json -o rows.html
  orbitproof report certificates.json -o k2.html --only "*-k2-*"

A web and the rows of a catalogue rest on other certificates: give these as well.
Each theorem as a statement that stands alone, with its hypotheses, margins and pictures; how to check it again,
software and digests, references. HTML carries its pictures; those of LaTeX and Markdown go into a folder beside the
file. Every certificate is checked up to its conclusion first (verify --recheck): one that does not stand is named, and
then nothing is written.
Exit codes: 0 written, everything in it is proved; 1 a certificate does not stand and nothing was written, or the report
was written and says what is not proved; 2 bad input; 130 interrupted.
"""


def argument_parser() -> argparse.ArgumentParser:
    """The command line."""
    words = "A report of what certificates prove, to read, to print and to cite."
    parser = ArgumentParser("orbitproof report", words, _EXAMPLES)
    parser.add_argument("certificates", type=Path, nargs="+", help="certificates of all kinds (JSON)")
    words = ".html, .tex or .md; once for each file that is to be written"
    parser.add_argument("-o", "--output", type=Path, action="append", required=True, metavar="FILE", help=words)
    parser.add_argument("--only", nargs="+", metavar="ID", help="these certificates (with * and ? as in file names)")
    parser.add_argument("--no-pictures", action="store_true", help="text, formulas and tables only")
    words = f"give a check up after this processor time (default: {CHECK_SECONDS:g}; of curves {LONG_CHECK_SECONDS:g})"
    parser.number("--timeout", "SECONDS", words, positive_seconds, None)
    parser.memory_option("each check")
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = argument_parser().parse_args(arguments)
    return answered("orbitproof report", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    try:
        return _run(options)
    except InputError as error:
        return refused(error)
    except KeyboardInterrupt:
        print(f"interrupted: {what_is_written()}", file=sys.stderr)
        return INTERRUPTED


def _run(options: argparse.Namespace) -> int:
    from orbitproof.figures.report.theorems import Refused
    from orbitproof.figures.scripting import print_path, write_report

    try:
        report = write_report(
            options.certificates,
            options.output,
            only=options.only,
            pictures=not options.no_pictures,
            timeout=options.timeout,
            memory=options.memory / GIBIBYTE,
            told=print_path,
            quiet=options.quiet,
        )
    except Refused as refusal:
        for path, check in refusal.rechecks:
            found = check.findings[0] if check.findings else None
            what = as_options(check.obstacle) if found is None else f"{found.place}: {found.message}"
            print(f"REFUSED {path}: {shown(check.id)}: {what}", file=sys.stderr)
        print("nothing was written: a report tells only what follows from its certificates", file=sys.stderr)
        return 1
    return 0 if report.proved == report.told else 1


if __name__ == "__main__":
    sys.exit(run_command(main))
