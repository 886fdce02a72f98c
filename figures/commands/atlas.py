"""``orbitproof figures atlas``: pictures of proved branches, from the certificates of their atlases."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.files import add_file_options, files_of
from orbitproof.figures.scripting import draw_atlases, print_path
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof verify atlas l1.json -o l1-certificate.json
  orbitproof figures atlas l1-certificate.json -o figures-out/
  orbitproof figures atlas l1-earth-moon.json l1-sun-jupiter.json -o figures-out/

For each certificate its atlas (atlas-*: widths of the pieces, the coordinates in which orbits were followed, tubes,
certified points); for all certificates of one kind of curve together the curves themselves, drawn from the certified
polynomials (curves-*); of those with a complete list (--complete K) the stability parameters with all resonances
(stability-*); surfaces over the mass parameter (surface-*). Every verdict is copied.
Exit codes: 0 written, 1 written, but something is not proved, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(commands, "atlas", "proved branches: their pieces, and the curves", _EXAMPLES)
    parser.add_argument("certificates", type=Path, nargs="+", help="certificates of atlases (JSON)")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    add_file_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read everything, then write the pictures; returns the exit code. Raises `InputError`."""
    from orbitproof.verify.certificate import read_certificate

    draw_atlases(options.certificates, options.output, files=files_of(options), told=print_path)
    return 0 if all(read_certificate(path, "atlas-certificate").proved for path in options.certificates) else 1
