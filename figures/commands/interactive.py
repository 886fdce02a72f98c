"""``orbitproof figures interactive``: a family, a proved loop or tori in space, as one HTML file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.scripting import write_page

_EXAMPLES = """\
examples:
  orbitproof figures interactive families.json --family earth-moon-L2-halo -o l2.html
  orbitproof figures interactive families.json --family earth-moon-L1-halo --candidates candidates.json \\
    --certificates certificates.json -o l1.html
  orbitproof figures interactive l1-certificate.json -o loop.html        (the certificate of an atlas)
  orbitproof figures interactive tori.json -o torus.html

The page holds everything it needs. What the mouse points at shows Jacobi constant, period, stability index and
verdict; verdicts are copied. Exit codes: 0 written, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = commands.add_parser(
        "interactive",
        help="orbits in space as one HTML file, to be turned with the mouse",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="families, certificate of an atlas, or tori (JSON)")
    parser.add_argument("--family", metavar="NAME", help="the family, for example earth-moon-L2-halo")
    parser.add_argument("--candidates", type=Path, metavar="FILE", help="candidates file, to show its points")
    parser.add_argument("--certificates", type=Path, metavar="FILE", help="certificates of these candidates")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="HTML file to write")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the page; returns the exit code. Raises `InputError`."""
    points = {"candidates": options.candidates, "certificates": options.certificates}
    print(write_page(options.file, options.output, family=options.family, **points))
    return 0
