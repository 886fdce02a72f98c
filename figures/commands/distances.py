"""``orbitproof figures distances``: how near to the smaller primary the orbits of families come."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_distances, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof explore family --mass jpl-earth-moon --family L2-halo -o halo.json
  orbitproof figures distances halo.json -o figures-out/

Least and greatest distance along each family, in units and, for the systems of the JPL catalogue, in km, with the
surface of the body and the orbits that hit it. All of it is numerical. Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "distances", "distances from the smaller primary along families, and which orbits hit it", _EXAMPLES
    )
    parser.add_argument("families", type=Path, nargs="+", metavar="FILE", help="family files (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    draw_distances(options.families, options.output, files=files_of(options), told=print_path)
    return 0
