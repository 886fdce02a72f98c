"""``orbitproof explore atlas-libration``: planar Lyapunov families down to their libration point, as atlases."""

from __future__ import annotations

import argparse
from typing import Any

from orbitproof.explore.commands.common import add_command, add_output, add_quiet, number, positive
from orbitproof.explore.names import mass_parameter
from orbitproof.shared.formats import InputError, check_writable, write_atlas
from orbitproof.shared.systems import MASS_PARAMETERS

POINTS = ("L1", "L2", "L3")
THROUGH = ("halo", "axial")
WIDEST_TUBE = 1e-3

_EXAMPLES = """\
examples:
  orbitproof explore atlas-libration --point L1 --mass earth-moon -o lyapunov.json
  orbitproof explore atlas-libration --point L1 --mass earth-moon --through axial -o lyapunov.json
  orbitproof explore atlas-libration --point L3 --mass 0.1 --side right -o lyapunov-l3.json
  orbitproof explore atlas-libration --point L2 --mass sun-jupiter --end -0.01 -o lyapunov-l2.json

An orbit is given by eps, the signed distance from the libration point at which it starts on the axis, and vy, its
speed there in units of eps; the orbit of eps = 0 is that of the linear centre. The pieces go from beyond the first
symmetry breaking, where halo orbits branch off (or axial ones), across eps = 0. Takes a few seconds.
Exit codes: 0 written, 1 the family could not be followed, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands,
        "atlas-libration",
        "atlas of a planar Lyapunov family from its symmetry breaking to the libration point",
        _EXAMPLES,
    )
    parser.add_argument("--point", choices=POINTS, required=True, help="the libration point")
    parser.add_argument(
        "--mass",
        required=True,
        metavar="MU",
        help=f"mass parameter: a name ({', '.join(MASS_PARAMETERS)}) or a number in (0, 1), taken exactly as written",
    )
    parser.add_argument(
        "--side",
        choices=("left", "right"),
        help="where the orbits start on the axis, left or right of the point (default: L3 right, the others left)",
    )
    parser.add_argument(
        "--end",
        type=number,
        metavar="EPS",
        help="go to this eps, positive on the right (default: a bit beyond a birth, see --through)",
    )
    parser.add_argument(
        "--through",
        choices=THROUGH,
        help="go a bit beyond the first birth of halo or of axial orbits (default: halo)",
    )
    parser.add_argument(
        "--tube",
        type=positive,
        default=1e-8,
        metavar="W",
        help=f"half-width of the tubes, relative to vy, at most {WIDEST_TUBE:g} (default: %(default)s)",
    )
    add_output(parser, "atlas file")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Follow the family and write the atlas; returns the exit code. Raises `InputError`."""
    mu = mass_parameter("--mass", options.mass)
    if options.tube > WIDEST_TUBE:
        raise InputError(f"--tube {options.tube:g}: above {WIDEST_TUBE:g}; the default is 1e-8")
    if options.end is not None and options.side is not None:
        raise InputError("--side: not together with --end, whose sign tells the side; leave one of them out")
    if options.end is not None and options.through is not None:
        raise InputError("--through: not together with --end, which says how far to go; leave one of them out")
    if options.end == 0:
        raise InputError("--end 0: that is the libration point; give another number")
    check_writable(options.output)
    side = {"left": -1, "right": 1, None: 1 if options.point == "L3" else -1}[options.side]

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.atlases import LibrationFailure, LyapunovFamily, lyapunov_atlas
    from orbitproof.explore.engines import Reporter

    family = LyapunovFamily(options.point, mu)
    with Reporter(options.quiet) as report:
        report.stage(f"{options.point}, the planar family")
        try:
            atlas = lyapunov_atlas(family, options.mass, options.end, side, options.tube, options.through or "halo")
        except LibrationFailure as error:
            report.error(f"orbitproof explore atlas-libration: {error}")
            return 1
        write_atlas(options.output, atlas)
        covers = atlas.claim.covers
        assert covers is not None
        pieces = f"{len(atlas.pieces)} piece" + "s" * (len(atlas.pieces) > 1)
        report.message(
            f"{pieces} over eps from {float(covers.start):.6g} to {float(covers.end):.6g} written to {options.output}"
        )
    return 0
