"""``orbitproof figures tori``: pictures of tori and of manifolds."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_tori, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof explore tori catalogue.json --orbit 700 -o tori.json
  orbitproof explore manifold families.json --family earth-moon-L1-halo --orbit 20 --plane x=0.98785 -o tube.json
  orbitproof figures tori tori.json tube.json -o figures-out/

In space and on the section; all of it is numerical and labelled so. Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(commands, "tori", "tori around elliptic orbits, tubes of unstable ones", _EXAMPLES)
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="files of tori or manifolds (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    draw_tori(options.files, options.output, files=files_of(options), told=print_path)
    return 0
