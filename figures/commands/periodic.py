"""``orbitproof figures periodic``: pictures of periodic orbits without symmetry, bifurcations and families of them."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_periodic, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof figures periodic lorenz-certificates.json -o figures-out/
  orbitproof figures periodic lorenz.json -o figures-out/          (candidates: all of it is numerical)
  orbitproof explore periodic --system roessler.py .. --along c 1 4 --family-output family.json
  orbitproof figures periodic family.json -o figures-out/
  orbitproof figures periodic life.json certificates.json -o figures-out/

  orbit-*         two projections of each orbit, with its points on the section; filled if certified
  bifurcation-*   the orbit at each bifurcation and, numerical, the new orbits or, of a torus, iterates on the section
  family-*        period and multipliers along each family, and where multipliers meet the unit circle; all numerical
  homoclinic-*    homoclinic orbits with their periodic orbit, and the manifolds where they cross; filled if certified
  life-*          equilibria, the orbits that are born there, and their periods; filled where a certificate proves them

Verdicts are copied.
Exit codes: 0 written, 1 an orbit, or what is born at a bifurcation, could not be drawn, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "periodic", "periodic orbits without symmetry, their bifurcations and families", _EXAMPLES
    )
    words = "candidates, certificates or families of explore periodic (JSON)"
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help=words)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    drawn = draw_periodic(options.files, options.output, files=files_of(options), told=print_path)
    for name, reason in drawn.not_drawn.items():
        print(f"{name}: not drawn: {reason}", file=sys.stderr)
    return 1 if drawn.not_drawn else 0
