"""``orbitproof figures web``: the diagram of a proved web, from its certificate and those of its arcs."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_web, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof verify web web.json --certificates planar.json halo.json certificates.json -o web-certificate.json
  orbitproof figures web web-certificate.json --certificates planar.json halo.json -o figures-out/ --page web.html

Jacobi constant against x of the point on Fix(R) where orbits start, for all arcs, from the certified polynomials;
vertices are filled. Families in the plane, vertical ones, of orbits symmetric under R, and under the half turn have
colours of their own. Every verdict is copied. The page holds everything it needs: click an arc, and see its orbits.
Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    words = "families joined into a proved graph: level against x"
    parser = add_command(commands, "web", words, _EXAMPLES)
    parser.add_argument("web", type=Path, help="certificate of a web (JSON)")
    words = "certificates of its arcs (JSON)"
    parser.add_argument("--certificates", type=Path, nargs="+", required=True, metavar="FILE", help=words)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    words = "also write the diagram and the orbits of each arc as one HTML file"
    parser.add_argument("--page", type=Path, metavar="FILE", help=words)
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the picture; returns the exit code. Raises `InputError`."""
    files = files_of(options)
    draw_web(options.web, options.certificates, options.output, page=options.page, files=files, told=print_path)
    return 0
