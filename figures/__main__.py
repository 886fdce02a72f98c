"""Command line: pictures of families with their certified bifurcations, and tables of these."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections.abc import Sequence
from pathlib import Path

from orbitproof.figures.commands import all as all_command
from orbitproof.figures.commands import atlas as atlas_command
from orbitproof.figures.commands import branches as branches_command
from orbitproof.figures.commands import catalogue as catalogue_command
from orbitproof.figures.commands import data as data_command
from orbitproof.figures.commands import distances as distances_command
from orbitproof.figures.commands import interactive as interactive_command
from orbitproof.figures.commands import periodic as periodic_command
from orbitproof.figures.commands import tori as tori_command
from orbitproof.figures.commands import web as web_command
from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_family, draw_resonances, print_path, tables_of, write_tables
from orbitproof.shared.answers import add_json_option, answered, tell
from orbitproof.shared.formats import InputError, refused
from orbitproof.shared.help_text import HelpFormatter, Parser, add_command
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.printed_tables import terminal_width, wrapped

_EXAMPLES = """\
examples:
  orbitproof figures family candidates.json certificates.json -o figures-out/
  orbitproof figures family candidates.json certificates.json --family halo-family.json -o figures-out/
  orbitproof figures family candidates.json -o figures-out/        (no certificates: all points hollow)
  orbitproof figures resonances families.json --candidates candidates.json -o figures-out/
  orbitproof figures tables certificates.json -o tables-out/
  orbitproof figures data data/                  (make the data files of all pictures)
  orbitproof figures all data/ -o figures-out/   (draw all pictures from them)

A marker is filled if the certificate of its candidate says "proved", and hollow otherwise. Family files
are written by explore, with its option --family-output.
Exit codes: 0 pictures or tables written, 1 something not drawn or (tables) a row is not proved, lies outside its
published enclosure or is missing, 2 bad input.
"""

_RESONANCES_EXAMPLES = """\
examples:
  orbitproof explore candidates --preset tables -o candidates.json --family-output families.json
  orbitproof figures resonances families.json -o figures-out/
  orbitproof figures resonances families.json --candidates candidates.json --certificates certificates.json -o out/

For each family: a picture (PDF and PNG), the samples (stability-*.csv) and the resonances and extrema of the
stability parameters, with their distance from the nearest resonant value (resonances-*.csv).
Exit codes: 0 written, 2 bad input.
"""

_TABLES_EXAMPLES = """\
examples:
  orbitproof figures tables certificates.json
  orbitproof figures tables earth-moon.json sun-jupiter.json -o tables-out/
  orbitproof figures tables certificates.json -o tables-out/ --candidates candidates.json --digits 40
  orbitproof figures tables certificates.json -o tables-out/ --published my-list.json --allow-missing

One table for each family, as text, Markdown, CSV and LaTeX, beside what the paper prints: our enclosure is
"inside" the published one, "overlaps" it, or lies "outside". The format of a file of published enclosures is
described in docs/formats.md. Without -o the tables are printed as text. Verdicts are copied, not checked again.
Exit codes: 0 tables written; 1 written, but a row is not proved, lies outside or is missing; 2 bad input.
"""


def argument_parser() -> argparse.ArgumentParser:
    """The command line: its commands and options."""
    parser = Parser(
        prog="orbitproof figures",
        description="Pictures of families of symmetric periodic orbits (PDF and PNG), and tables of what is certified.",
        epilog=_EXAMPLES,
        formatter_class=HelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    family = add_command(commands, "family", "a family, its resonances and what is certified", _EXAMPLES)
    family.add_argument("candidates", type=Path, help="candidates file (JSON)")
    family.add_argument("certificates", type=Path, nargs="?", help="certificates file; without it nothing is filled")
    family.add_argument("--family", type=Path, nargs="+", default=[], metavar="FILE", help="traced families (JSON)")
    family.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    family.add_argument("--quiet", action="store_true", help="no messages on standard error")
    add_file_options(family)
    family.set_defaults(run=_run_family)
    resonances = add_command(
        commands, "resonances", "stability along families, finely sampled, as picture and CSV", _RESONANCES_EXAMPLES
    )
    resonances.add_argument("families", type=Path, nargs="+", help="family files (JSON), searched for resonances")
    resonances.add_argument(
        "--candidates", type=Path, metavar="FILE", help="candidates file, to mark what is certified"
    )
    resonances.add_argument("--certificates", type=Path, metavar="FILE", help="certificates of these candidates")
    resonances.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder to write into")
    resonances.add_argument("--quiet", action="store_true", help="no messages on standard error")
    add_file_options(resonances)
    resonances.set_defaults(run=_run_resonances)
    tables = add_command(commands, "tables", "the certified rows beside the published ones", _TABLES_EXAMPLES)
    tables.add_argument("certificates", type=Path, nargs="+", help="certificates files (JSON)")
    tables.add_argument("-o", "--output", type=Path, metavar="FOLDER", help="folder for the tables")
    tables.add_argument("--published", type=Path, metavar="FILE", help="published enclosures (default: the paper's)")
    tables.add_argument(
        "--candidates",
        type=Path,
        nargs="+",
        default=[],
        metavar="FILE",
        help="the candidates, for family names and the order along the family (default: from ids, as in the file)",
    )
    tables.add_argument(
        "--digits", type=_digits, default=30, metavar="N", help="print at most N significant digits (default: 30)"
    )
    tables.add_argument(
        "--allow-missing", action="store_true", help="exit code 0 also if published rows have no certificate"
    )
    tables.add_argument("--quiet", action="store_true", help="no messages on standard error")
    tables.set_defaults(run=_run_tables)
    for command in (
        all_command,
        atlas_command,
        branches_command,
        catalogue_command,
        data_command,
        distances_command,
        periodic_command,
        tori_command,
        web_command,
        interactive_command,
    ):
        command.add_parser(commands)
    for command_parser in commands.choices.values():
        add_json_option(command_parser)
    return parser


def _digits(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 3 <= int(text[:5]) <= 1000:
        raise argparse.ArgumentTypeError(f"{text!r}: give a number of digits from 3 to 1000")
    return int(text)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = argument_parser().parse_args(argv)
    return answered(f"orbitproof figures {options.command}", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    try:
        return int(options.run(options))
    except InputError as error:
        return refused(error)
    except KeyboardInterrupt:
        print("interrupted: files already written are kept", file=sys.stderr)
        return INTERRUPTED


def _run_family(options: argparse.Namespace) -> int:
    draw_family(
        options.candidates,
        options.output,
        certificates=options.certificates,
        families=options.family,
        files=files_of(options),
        told=print_path,
        quiet=options.quiet,
    )
    return 0


def _run_resonances(options: argparse.Namespace) -> int:
    draw_resonances(
        options.families,
        options.output,
        candidates=options.candidates,
        certificates=options.certificates,
        files=files_of(options),
        told=print_path,
        quiet=options.quiet,
    )
    return 0


def _run_tables(options: argparse.Namespace) -> int:
    tables = tables_of(options.certificates, candidates=options.candidates, published=options.published)
    if options.output is None:
        from orbitproof.figures.tables import to_csv, to_text

        for table in tables:
            rows = csv.DictReader(io.StringIO(to_csv(table, options.digits)))
            tell(wrapped(to_text(table, options.digits, terminal_width()).splitlines()), list(rows))
    else:
        write_tables(tables, options.output, digits=options.digits, told=print_path)
    sections = [(table, section) for table in tables for section in table.sections]
    if not options.quiet:
        for table, section in sections:
            label = f" ({section.label})" if section.label else ""
            print(f"{table.system.name} {table.family}{label}: {section.summary()}", file=sys.stderr)
    bad = any(section.not_proved or section.count("outside") for _, section in sections)
    missing = any(section.count("missing") for _, section in sections)
    return 1 if bad or (missing and not options.allow_missing) else 0


if __name__ == "__main__":
    sys.exit(run_command(main))
