"""``orbitproof figures branches``: the new orbits at bifurcation points, beside their families."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_branches, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof explore branches certificates.json -o branches.json
  orbitproof figures branches branches.json --family families.json -o figures-out/

For each family that has some of the points a picture with all of its branches (branches-*), and for each branch the
bifurcation diagram, the starts and a new orbit (branch-*). Points are filled if a certificate says "proved"; orbits are
numerical. Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(commands, "branches", "new orbits at bifurcation points, beside their families", _EXAMPLES)
    parser.add_argument("branches", type=Path, metavar="FILE", help="branch file of explore branches (JSON)")
    parser.add_argument("--family", type=Path, nargs="+", default=[], metavar="FILE", help="traced families (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    draw_branches(options.branches, options.output, families=options.family, files=files_of(options), told=print_path)
    return 0
