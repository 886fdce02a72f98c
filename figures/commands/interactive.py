"""``orbitproof figures interactive``: orbits, families, proved loops, tori or tubes in space, as one HTML file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.scripting import print_path, write_page
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof figures interactive families.json --family earth-moon-L2-halo -o l2.html
  orbitproof figures interactive families.json --family earth-moon-L1-halo --candidates candidates.json \\
    --certificates certificates.json -o l1.html
  orbitproof figures interactive l1-certificate.json -o loop.html        (the certificate of an atlas)
  orbitproof figures interactive tori.json -o torus.html                 (or tube.json, a manifold)
  orbitproof figures interactive halo.json -o halo.html                  (a catalogue)
  orbitproof figures interactive halo.json --orbit 700 -o orbit.html     (one orbit, of any file that names some)

The page holds everything it needs. Colours are Jacobi constants. What the mouse points at shows Jacobi
constant, period, stability index, least distance from the smaller primary, and verdict; verdicts are copied.
Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "interactive", "orbits in space as one HTML file, to be turned with the mouse", _EXAMPLES
    )
    parser.add_argument(
        "file", type=Path, metavar="FILE", help="families, a catalogue, an atlas's certificate, tori, .. (JSON)"
    )
    parser.add_argument("--family", metavar="NAME", help="the family, for example earth-moon-L2-halo")
    parser.add_argument("--id", metavar="NAME", help="one orbit: of candidates, certificates or branches")
    parser.add_argument("--orbit", type=int, metavar="N", help="one orbit: its number in the file or its family")
    parser.add_argument("--candidates", type=Path, metavar="FILE", help="candidates file, to show its points")
    parser.add_argument("--certificates", type=Path, metavar="FILE", help="certificates of these candidates")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="HTML file to write")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the page; returns the exit code. Raises `InputError`."""
    points = {"candidates": options.candidates, "certificates": options.certificates}
    chosen = {"family": options.family, "identifier": options.id, "orbit": options.orbit}
    print_path(write_page(options.file, options.output, **chosen, **points))
    return 0
