"""``orbitproof figures tori``: pictures of tori and of manifolds."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, check_folder, file_name
from orbitproof.shared.formats import InputError, stated_format

_EXAMPLES = """\
examples:
  orbitproof explore tori catalogue.json --orbit 700 -o tori.json
  orbitproof explore manifold families.json --family earth-moon-L1-halo --orbit 20 --plane x=0.98785 -o tube.json
  orbitproof figures tori tori.json tube.json -o figures-out/

In space and on the section; all of it is numerical and labelled so. Exit codes: 0 written, 2 bad input.
"""

_REMEDY = "give a file of tori or of a manifold, written by orbitproof explore"


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = commands.add_parser(
        "tori",
        help="tori around elliptic orbits, tubes of unstable ones",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="files of tori or manifolds (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    from orbitproof.explore.invariants import read_manifold, read_tori
    from orbitproof.figures.files import save
    from orbitproof.figures.pictures import draw_manifold, draw_tori
    from orbitproof.figures.style import close, use_style

    drawings = []
    for path in options.files:
        if stated_format(path, _REMEDY) == "manifold":
            drawings.append((path, draw_manifold, read_manifold(path)))
        else:
            drawings.append((path, draw_tori, read_tori(path)))
    names = [file_name(path.stem) for path in options.files]
    if len(set(names)) < len(names):
        raise InputError("two files of one name; give files whose names differ")
    check_folder(options.output)
    with use_style():
        for name, (_, draw, record) in zip(names, drawings, strict=True):
            figure = draw(record)
            for written in save(figure, options.output / name):
                print(written, flush=True)
            close(figure)
    return 0
