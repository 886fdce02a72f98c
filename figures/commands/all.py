"""``orbitproof figures all``: every picture, from a folder of data files."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_all, print_path
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import InputError, select_ids
from orbitproof.shared.help_text import add_command
from orbitproof.shared.printed_tables import wrapped

_EXAMPLES = """\
examples:
  orbitproof figures data data/                          (makes the data files that are missing)
  orbitproof figures all data/ -o figures-out/
  orbitproof figures all data/ -o figures-out/ --only phase-portraits resonant-halo-families
  orbitproof figures all data/ --list                    (the pictures, and which data files each one needs)

Certified points are filled, numerical ones hollow. A picture whose data are missing is reported together with
the command that makes them, and the others are drawn. docs/figures.md describes every picture.
Exit codes: 0 all drawn; 1 something not drawn, or no certificates, so that nothing is filled; 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(commands, "all", "every picture, from a folder of data files", _EXAMPLES)
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of data files")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER", help="folder for the pictures")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these pictures (with * and ?; default: all)")
    parser.add_argument("--list", action="store_true", help="list the pictures and the data they need, draw nothing")
    parser.add_argument("--quiet", action="store_true", help="no messages on standard error but what is not drawn")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw the pictures asked for; returns the exit code. Raises `InputError`."""
    if options.list:
        # Matplotlib takes a second to load: not for --help.
        from orbitproof.figures.collection import PICTURES

        known = {picture.name: picture for picture in PICTURES}
        for picture in (known[name] for name in select_ids(known, options.only, "picture")):
            line = f"{picture.name}: {picture.shows}; needs {', '.join(picture.data) or 'no data'}"
            result = {"name": picture.name, "shows": picture.shows, "data": picture.data}
            tell(wrapped([line]), [result])
        return 0
    if options.output is None:
        raise InputError("-o: missing; name the folder for the pictures")
    how = {"only": options.only, "files": files_of(options), "told": print_path, "quiet": options.quiet}
    drawn = draw_all(options.data, options.output, **how)
    if drawn.hollow:
        from orbitproof.figures.collection import step_of

        command = step_of("certificates.json").text(options.data)
        print(f"no certificates: all points are hollow; make them with: {command}", file=sys.stderr)
    return 2 if drawn.bad_input else 1 if drawn.not_drawn or drawn.hollow else 0
