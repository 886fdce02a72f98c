"""``orbitproof figures all``: every picture, from a folder of data files."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, check_folder
from orbitproof.shared.formats import InputError, select_ids

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
    parser = commands.add_parser(
        "all",
        help="every picture, from a folder of data files",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of data files")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER", help="folder for the pictures")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these pictures (with * and ?; default: all)")
    parser.add_argument("--list", action="store_true", help="list the pictures and the data they need, draw nothing")
    parser.add_argument("--quiet", action="store_true", help="no messages on standard error but what is not drawn")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw the pictures asked for; returns the exit code. Raises `InputError`."""
    # Matplotlib takes a second to load: not for --help.
    from orbitproof.figures.collection import PICTURES, DataFolder, MissingData
    from orbitproof.figures.orbits import OrbitNotClosed

    known = {picture.name: picture for picture in PICTURES}
    chosen = [known[name] for name in select_ids(known, options.only, "picture")]
    if options.list:
        for picture in chosen:
            print(f"{picture.name}: {picture.shows}; needs {', '.join(picture.data) or 'no data'}")
        return 0
    if options.output is None:
        raise InputError("-o: missing; name the folder for the pictures")
    data = DataFolder(options.data)
    check_folder(options.output)

    code, started = 0, time.monotonic()
    for number, picture in enumerate(chosen, 1):
        before = time.monotonic()
        try:
            # First of all, so that one missing file is not found only after the drawing of half a picture.
            for name in picture.data:
                data.path(name)
            for path in picture.write(data, options.output):
                print(path, flush=True)
        except (MissingData, OrbitNotClosed) as error:
            print(f"{picture.name}: not drawn: {error}", file=sys.stderr)
            code = max(code, 1)
        except InputError as error:
            print(f"{picture.name}: not drawn: error: {error}", file=sys.stderr)
            code = 2
        if not options.quiet:
            now = time.monotonic()
            left = (now - started) / number * (len(chosen) - number)
            estimate = f"; about {left:.0f} s left" if number < len(chosen) else ""
            print(f"[{number}/{len(chosen)}] {picture.name}: {now - before:.1f} s{estimate}", file=sys.stderr)
    if any(picture.marked for picture in chosen) and not data.has_certificates:
        from orbitproof.figures.collection import step_of

        command = step_of("certificates.json").text(options.data)
        print(f"no certificates: all points are hollow; make them with: {command}", file=sys.stderr)
        code = max(code, 1)
    return code
