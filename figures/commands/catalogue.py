"""``orbitproof figures catalogue``: the rows of a certified catalogue, and how near its orbits are to them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_catalogues, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof verify catalogue halo.json --curve curve.json -o rows.json
  orbitproof figures catalogue rows.json -o figures-out/

Periods over Jacobi constants, filled where the certificate gives an orbit of the curve, and the certified bounds of how
far state, Jacobi constant, period and stability index of that orbit are from the row. Every verdict is copied.
Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    words = "rows of a catalogue that a curve certifies"
    parser = add_command(commands, "catalogue", words, _EXAMPLES)
    parser.add_argument("certificates", type=Path, nargs="+", metavar="FILE", help="certificates of catalogues (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    draw_catalogues(options.certificates, options.output, files=files_of(options), told=print_path)
    return 0
