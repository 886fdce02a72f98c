"""Command line for catalogues: ``orbitproof verify catalogue halo.json --curve curve.json -o rows.json``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from statistics import median
from typing import Any

from orbitproof.shared.answers import tell
from orbitproof.shared.formats import (
    CatalogueRows,
    InputError,
    about,
    check_writable,
    read_catalogue_rows,
    table_form,
)
from orbitproof.shared.interrupts import run_command
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.printed_tables import wrapped
from orbitproof.shared.systems import shown
from orbitproof.verify.branches import WITHIN, certified_rows, certified_table, check_title, rows_of_curve
from orbitproof.verify.certificate import Certificate, Recheck, read_certificate, write_certificate
from orbitproof.verify.run import (
    ArgumentParser,
    Workplace,
    whole_number,
)
from orbitproof.verify.run.proof_command import add_checking_options, by_curve, check_of, prove_or_check

_EXAMPLES = """\
examples:
  orbitproof verify catalogue halo.json --curve curve.json -o rows.json
      which rows a proved curve certifies: point, period, stability and distances of the orbit that starts near each
  orbitproof verify catalogue --rows 10000 --curve curve.json -o rows.json --table halo.csv
      a catalogue of the curve itself, as a table in which each row says what is proved of it
  orbitproof verify catalogue --recheck rows.json --curve curve.json
      check that all it states follows from the certificate of the curve
  orbitproof verify catalogue --recheck --integrate rows.json --curve curve.json --jobs 2
      and prove the curve again, in another way

The curve needs a list: orbitproof verify atlas ATLAS -o curve.json --complete 1, from a family that is traced through
the rows: orbitproof explore family --from-catalogue halo.json, orbitproof explore atlas --from-family.
exit codes: 0 every row is certified, or the certificate stands; 1 not; 2 bad input; 130 interrupted
"""

_LACKS = {
    "functions": "the curve is proved there without its list (orbitproof verify atlas --complete 1)",
    "nearness": "the orbit beside it is not shown to start so close to it (--within)",
}
_SHOWN = 20
"""Rows that are not certified are told up to this number."""


def _parser() -> ArgumentParser:
    words = "Certify rows of a catalogue by a curve that is proved."
    parser = ArgumentParser("orbitproof verify catalogue", words, _EXAMPLES)
    words = "catalogue (JSON or CSV); with --recheck, certificate of one; left out with --rows"
    parser.add_argument("file", type=Path, nargs="?", help=words)
    words = "certify so many orbits of the curve itself, at equal steps, in place of a catalogue's"
    parser.number("--rows", "N", words, whole_number(1), None)
    words = "the rows with what is proved of each, as .json, .csv or .parquet"
    parser.add_argument("--table", type=Path, metavar="FILE", help=words)
    parser.add_argument(
        "--curve", type=Path, required=True, metavar="FILE", help="certificate of a curve with its list"
    )
    parser.add_argument("-o", "--output", type=Path, help="certificate of the rows")
    words = "an orbit certifies a row from which it starts no farther than this (default: 1e-6)"
    parser.add_argument("--within", type=_distance, default=WITHIN, metavar="D", help=words)
    words = "prove the curve again, in another way"
    add_checking_options(parser, "check the certificate of a catalogue again", words, "pieces of the curve")
    return parser


def _distance(text: str) -> Fraction:
    try:
        value = parse_exact(text)
    except ValueError:
        value = Fraction(0)
    if not value > 0:
        raise argparse.ArgumentTypeError(f"{text!r}: give a positive number")
    return value


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    return prove_or_check("catalogue", _parser().parse_args(arguments), _run, _recheck)


def _run(options: argparse.Namespace, workplace: Workplace) -> int:
    if (options.file is None) == (options.rows is None):
        raise InputError("FILE, --rows: give one of the two, a catalogue or how many orbits of the curve")
    for path in (options.output, options.table):
        if path is not None:
            check_writable(path)
    if options.table is not None:
        table_form(options.table)
    curve = read_certificate(options.curve, "atlas-certificate")
    with about(options.file):
        rows = None if options.rows is not None else read_catalogue_rows(options.file)
        if rows is not None:
            check_title(rows)
    with about(options.curve):
        rows = rows_of_curve(curve, options.rows) if rows is None else rows
        certificate = certify_rows(rows, curve, options.within, workplace)
    if options.output is not None:
        write_certificate(options.output, certificate.document)
    if options.table is not None:
        with about(options.file):
            table = certified_table(rows, certificate.document)
        table.write(options.table)
    tell(wrapped(_summary(certificate.document).splitlines()), certificate.document["rows"])
    return 0 if certificate.proved else 1


def certify_rows(rows: CatalogueRows, curve: Certificate, within: Fraction, workplace: Workplace) -> Certificate:
    """The certificate of rows by a curve, whose certificate is checked up to its conclusion first.

    Raises `InputError` if that does not stand, is of no such curve, or the work is not brought to an end.
    """
    tasks = {"rows": 1.0 + len(rows.rows) / 200}
    found = by_curve(curve, certified_rows, (rows, within), workplace, tasks, "the rows were not looked at")
    return Certificate(found)


def _recheck(options: argparse.Namespace, workplace: Workplace) -> Recheck:
    for option in ("table", "rows"):
        if getattr(options, option) is not None:
            raise InputError(f"--{option}: --recheck writes no file; leave it out")
    if options.file is None:
        raise InputError("FILE: missing; give the certificate of a catalogue")
    certificate = read_certificate(options.file, "catalogue-certificate")
    curve = read_certificate(options.curve, "atlas-certificate")
    with about(options.file):
        return check_of(certificate, [curve], options.integrate, workplace)


def _summary(document: Mapping[str, Any]) -> str:
    """How many rows are certified, how far they are from the orbits, and which are not."""
    rows = document["rows"]
    certified = [row for row in rows if row.get("orbit")]
    lines = [f"{len(certified)} of {len(rows)} rows are certified by the curve {shown(document['rests_on']['id'])}"]
    if certified:
        lines.append(f"{'difference, at most':<24}{'median':>9}{'largest':>9}  at row")
    for name, words in (
        ("point", "state"),
        ("level", "Jacobi constant"),
        ("period", "period"),
        ("stability_index", "stability index"),
    ):
        known = [(_most(row["differences"][name]), row["number"]) for row in certified if row["differences"].get(name)]
        if known:
            largest, number = max(known)
            lines.append(f"{words:<24}{median(value for value, _ in known):9.1e}{largest:9.1e}  {number}")
    others = [row for row in rows if not row.get("orbit")]
    lines += [f"row {row['number']}: not certified: {_LACKS[row['lacks']]}" for row in others[:_SHOWN]]
    if len(others) > _SHOWN:
        lines.append(f"and {len(others) - _SHOWN} more")
    return "\n".join(lines)


def _most(ball: Mapping[str, str]) -> float:
    """A bound of the numbers in a ball, to be printed with few digits: rounded up."""
    return float(parse_exact(ball["mid"]) + parse_exact(ball["rad"])) * 1.05


if __name__ == "__main__":
    sys.exit(run_command(main))
