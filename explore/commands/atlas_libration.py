"""``orbitproof explore atlas-libration``: planar, vertical and axial families of a libration point, as atlases."""

from __future__ import annotations

import argparse
from typing import Any

from orbitproof.explore.commands.common import add_output, add_quiet, number, positive
from orbitproof.explore.three_body.names import mass_name, mass_parameter
from orbitproof.shared.formats import InputError, check_writable, write_atlas
from orbitproof.shared.help_text import add_command
from orbitproof.shared.systems import MASS_PARAMETERS

POINTS = ("L1", "L2", "L3")
THROUGH = ("halo", "axial")
WIDEST_TUBE, PLANAR_TUBE, VERTICAL_TUBE = 1e-3, 1e-8, 1e-7
AXIAL_TUBE = {"L1": 1e-9, "L2": 1e-9, "L3": 5e-9}

_EXAMPLES = """\
examples:
  orbitproof explore atlas-libration --point L1 --mass earth-moon -o lyapunov.json
  orbitproof explore atlas-libration --point L1 --mass earth-moon --through axial -o lyapunov.json
  orbitproof explore atlas-libration --point L3 --mass 0.1 --side right -o lyapunov-l3.json
  orbitproof explore atlas-libration --point L2 --mass sun-jupiter --end -0.01 -o lyapunov-l2.json
  orbitproof explore atlas-libration --vertical --point L1 --mass earth-moon -o vertical.json
  orbitproof explore atlas-libration --axial --point L3 --mass earth-moon -o axial.json

An orbit is given by eps, the signed distance from the libration point at which it starts on the axis, and vy, its
speed there in units of eps; the orbit of eps = 0 is that of the linear centre. The pieces go from beyond the first
symmetry breaking, where halo orbits branch off (or axial ones), across eps = 0. A vertical orbit is given by eps2, the
square of its speed across the plane where it crosses the axis; the pieces go beyond the birth of axial orbits on the
vertical family (of L3 eps2 falls again before that), or to the end that is given. The axial family is covered from
its birth on the planar family to that on the vertical one: by eps2 from 0 on, and last by a piece about the vertical
orbit. Takes seconds.
Exit codes: 0 written, 1 the family could not be followed, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands,
        "atlas-libration",
        "atlas of a planar or vertical family from the libration point, or of the axial family between births",
        _EXAMPLES,
    )
    parser.add_argument("--point", choices=POINTS, required=True, help="the libration point")
    parser.add_argument(
        "--mass",
        type=mass_name,
        required=True,
        metavar="MU",
        help=f"mass parameter: a name ({', '.join(MASS_PARAMETERS)}) or a number in (0, 1/2], taken exactly as written",
    )
    parser.add_argument("--vertical", action="store_true", help="the vertical family instead of the planar one")
    parser.add_argument("--axial", action="store_true", help="the axial family, from birth to birth")
    parser.add_argument(
        "--side",
        choices=("left", "right"),
        help="where the orbits start on the axis, left or right of the point (default: L3 right, the others left)",
    )
    parser.add_argument(
        "--end",
        type=number,
        metavar="EPS",
        help="go to this eps, positive on the right, or eps2 of vertical orbits (default: a bit beyond a birth)",
    )
    parser.add_argument(
        "--through",
        choices=THROUGH,
        help="go a bit beyond the first birth of halo or of axial orbits (default: halo)",
    )
    parser.add_argument(
        "--tube",
        type=positive,
        metavar="W",
        help=f"half-width of the tubes, relative to vy, at most {WIDEST_TUBE:g} "
        "(default: 1e-8, vertical 1e-7, axial 1e-9, of L3 5e-9)",
    )
    add_output(parser, "atlas file")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Follow the family and write the atlas; returns the exit code. Raises `InputError`."""
    mu = mass_parameter("--mass", options.mass)
    usual = AXIAL_TUBE[options.point] if options.axial else VERTICAL_TUBE if options.vertical else PLANAR_TUBE
    tube = options.tube or usual
    if tube > WIDEST_TUBE:
        raise InputError(f"--tube {tube:g}: above {WIDEST_TUBE:g}; the default is {usual:g}")
    if options.axial:
        for name in ("vertical", "side", "through", "end"):
            if getattr(options, name) not in (None, False):
                raise InputError(f"--{name}: not together with --axial, which goes from birth to birth; leave it out")
    for name in ("side", "through"):
        if options.vertical and getattr(options, name) is not None:
            raise InputError(f"--{name}: not together with --vertical; leave it out, or give --end")
    if options.vertical and options.end is not None and options.end < 0:
        raise InputError(f"--end {options.end:g}: the square of a speed; give a positive number")
    if options.end is not None and options.side is not None:
        raise InputError("--side: not together with --end, whose sign tells the side; leave one of them out")
    if options.end is not None and options.through is not None:
        raise InputError("--through: not together with --end, which says how far to go; leave one of them out")
    if options.end == 0:
        raise InputError("--end 0: that is the libration point; give another number")
    check_writable(options.output)
    side = {"left": -1, "right": 1, None: 1 if options.point == "L3" else -1}[options.side]

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.atlases import LibrationFailure
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.three_body.atlases import (
        LyapunovFamily,
        VerticalFamily,
        axial_atlas,
        lyapunov_atlas,
        vertical_atlas,
    )

    with Reporter(options.quiet) as report:
        kind = "axial" if options.axial else "vertical" if options.vertical else "planar"
        report.stage(f"{options.point}, the {kind} family")
        try:
            if options.axial:
                atlas = axial_atlas(options.point, mu, options.mass, tube)
            elif options.vertical:
                atlas = vertical_atlas(VerticalFamily(options.point, mu), options.mass, options.end, tube)
            else:
                family = LyapunovFamily(options.point, mu)
                atlas = lyapunov_atlas(family, options.mass, options.end, side, tube, options.through or "halo")
        except LibrationFailure as error:
            report.error(f"error: {error}")
            return 1
        write_atlas(options.output, atlas)
        covers = atlas.claim.covers
        assert covers is not None
        pieces = f"{len(atlas.pieces)} piece" + "s" * (len(atlas.pieces) > 1)
        covered = f"{covers.coordinate} from {float(covers.start):.6g} to {float(covers.end):.6g}"
        report.message(f"{pieces} over {covered} written to {options.output}")
    return 0
