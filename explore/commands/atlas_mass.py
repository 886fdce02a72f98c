"""``orbitproof explore atlas-mass``: births and period doublings over a range of the mass parameter, as an atlas."""

from __future__ import annotations

import argparse
from fractions import Fraction
from math import ceil, floor
from typing import Any

from orbitproof.explore.commands.common import add_output, add_quiet, positive
from orbitproof.explore.three_body.names import mass_parameter
from orbitproof.shared.formats import SURFACE, AnyPiece, Atlas, Claim, Covers, InputError, check_writable, write_atlas
from orbitproof.shared.help_text import add_command
from orbitproof.shared.wording import counted

POINTS = ("L1", "L2", "L3")
DOUBLED = "doubled"
FAMILIES = ("halo", "axial", DOUBLED)
AMPLITUDES = {
    ("L1", "halo"): Fraction(4, 1000),
    ("L2", "halo"): Fraction(3, 1000),
    ("L3", "halo"): Fraction(125, 10**6),
    ("L1", "axial"): Fraction(1, 1000),
    ("L2", "axial"): Fraction(1, 1000),
}
"""Values of --z by default: what the verifier proves in a few pieces."""

LOWEST = {"L1": Fraction(0), "L2": Fraction(0), "L3": Fraction(1, 10**5)}

LIGHT, LIGHT_AMPLITUDE = (Fraction(95, 10**5), Fraction(1, 1000)), Fraction(3, 10**5)
"""L3 at masses below these two (the pieces on either side overlap between them): --z by default."""

WIDEST_AMPLITUDE, WIDEST_SHARE, SHARE = 0.1, 0.5, 0.2
WIDEST_TUBE, DOUBLED_TUBE = 1e-3, 1e-8
_GRAIN = 10**4

_EXAMPLES = """\
examples:
  orbitproof explore atlas-mass --point L1 -o mass-l1.json
  orbitproof explore atlas-mass --point L2 --z 0.001 -o mass-l2.json
  orbitproof explore atlas-mass --point L1 --lyapunov -o mass-l1.json
  orbitproof explore atlas-mass --point L1 --family axial -o mass-axial-l1.json
  orbitproof explore atlas-mass --point L1 --family doubled --mu-min 0.00095 --mu-max 0.0122 -o doublings-l1.json
  orbitproof explore atlas-mass --point L3 --mu-min 0.0002 --z 0.00005 -o mass-l3.json
  orbitproof verify atlas mass-l1.json -o mass-l1-certificate.json

Near L1 and L2 the equations are written in Hill's units, lengths in units of mu^(1/3), and the range of masses may
begin at 0. With --family doubled the atlas is a curve: the orbits at which the period of halo orbits of L1 or L2 is
doubled, the first one that is found on the family at mass 0.01. Takes a few seconds. Exit codes: 0 written, 1 the curve
could not be followed, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands,
        "atlas-mass",
        "atlas of halo or axial orbits near their birth, or of period doublings, over a range of the mass",
        _EXAMPLES,
    )
    parser.add_argument("--point", choices=POINTS, required=True, help="the libration point")
    parser.add_argument(
        "--family",
        choices=FAMILIES,
        default="halo",
        help="the orbits that are born, or period doublings of halo orbits (default: %(default)s; the others: L1, L2)",
    )
    parser.add_argument(
        "--mu-min", metavar="MU", help="smallest mass parameter (default: 0 for L1 and L2, 0.00001 for L3)"
    )
    parser.add_argument("--mu-max", default="0.5", metavar="MU", help="largest, at most 1/2 (default: %(default)s)")
    parser.add_argument(
        "--z",
        type=positive,
        metavar="Z",
        help="orbits up to this abs(z), axial ones abs(vz), for L1 and L2 in units of mu^(1/3) (default: "
        + ", ".join(f"{point} {family} {float(value):g}" for (point, family), value in AMPLITUDES.items())
        + f"; L3 below mass {float(LIGHT[0]):g}: {float(LIGHT_AMPLITUDE):g})",
    )
    parser.add_argument(
        "--share",
        type=positive,
        metavar="S",
        help="half-width of a piece as a share of the radius of convergence, at most 0.5 (default: 0.2)",
    )
    parser.add_argument(
        "--tube",
        type=positive,
        metavar="W",
        help=f"doubled: half-width of the tubes, relative to the coordinates, at most {WIDEST_TUBE:g} "
        f"(default: {DOUBLED_TUBE:g})",
    )
    words = "also pieces from which the verifier proves that the planar orbits are the Lyapunov family (L1, L2)"
    parser.add_argument("--lyapunov", action="store_true", help=words)
    add_output(parser, "atlas file")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Follow the curve and write the atlas; returns the exit code. Raises `InputError`."""
    point, family = options.point, options.family
    if point == "L3" and family != "halo":
        raise InputError(f"--family {family}: for L1 and L2 only; give another point")
    for name in ("z", "share", "lyapunov") if family == DOUBLED else ("tube",):
        if getattr(options, name):
            raise InputError(f"--{name}: not with --family {family}; leave it out")
    if options.tube is not None and options.tube > WIDEST_TUBE:
        raise InputError(f"--tube {options.tube:g}: above {WIDEST_TUBE:g}; the default is {DOUBLED_TUBE:g}")
    smallest = LOWEST[point] if options.mu_min is None else mass_parameter("--mu-min", options.mu_min, or_zero=True)
    largest = mass_parameter("--mu-max", options.mu_max)
    if not smallest < largest:
        raise InputError("--mu-max: give a mass above --mu-min")
    if point == "L3" and smallest < Fraction(1, 10**8):
        raise InputError("--mu-min: below 1e-8 the equations around L3 lose all their digits; give a larger mass")
    if options.z is not None and options.z > WIDEST_AMPLITUDE:
        raise InputError(f"--z {options.z:g}: above {WIDEST_AMPLITUDE:g}; give a smaller number")
    if options.share is not None and options.share > WIDEST_SHARE:
        raise InputError(f"--share {options.share:g}: above {WIDEST_SHARE:g}; the default is 0.2")
    if options.lyapunov and (point == "L3" or family != "halo"):
        raise InputError("--lyapunov: from births of halo orbits down to L1 and L2 only; leave it out")
    check_writable(options.output)
    lowest, highest = (smallest, largest) if point == "L3" else (_root(smallest, floor), _root(largest, ceil))
    if family == DOUBLED:
        return _write_doublings(options, lowest, highest)
    share = options.share or SHARE
    z = AMPLITUDES[point, family] if options.z is None else Fraction(str(options.z))
    ranges = [(lowest, highest, z)]
    if point == "L3" and options.z is None and smallest < LIGHT[0]:
        ranges = [(lowest, min(LIGHT[1], highest), LIGHT_AMPLITUDE)]
        ranges += [(LIGHT[0], highest, z)] if highest > LIGHT[1] else []

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.atlases import LibrationFailure
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.families import FamilyFailure
    from orbitproof.explore.orbits import CorrectionFailure
    from orbitproof.explore.three_body.atlases import Births, intervals, piece, pieces_to, trace

    births = Births(point, family)
    system = births.system
    pieces: list[AnyPiece] = []
    with Reporter(options.quiet) as report:
        try:
            report.stage(f"{point}, the curve of symmetry-breaking points")
            curve = trace(births, max(float(smallest) / 2, 1e-7), float(largest))
            places = [
                (interval, width) for start, end, width in ranges for interval in intervals(point, start, end, share)
            ]
            report.stage(f"{point}, pieces")
            for number, (interval, width) in enumerate(places, start=1):
                report.update(f"{number} of {len(places)}", number / len(places))
                pieces.append(piece(births, curve.points, interval, width, f"p{number:03d}"))
            if options.lyapunov:
                report.stage(f"{point}, planar orbits down to the libration point")
                pieces += pieces_to(point, lowest**3, highest**3, lambda share: report.update("", share))
        except (FamilyFailure, CorrectionFailure, LibrationFailure) as error:
            report.error(f"error: {error}")
            return 1
        parameter = system.fixed_parameters[0]
        atlas = Atlas(
            id=f"{family}-{point.lower()}-masses",
            title=f"{family} orbits near their birth from planar orbits near {point}",
            system=system,
            parameters={},
            claim=Claim(SURFACE, "S", (), Covers(parameter, lowest, highest)),
            pieces=tuple(pieces),
            provenance={"point": point, "family": family, "share": share},
        )
        write_atlas(options.output, atlas)
        report.message(_said(atlas, parameter, lowest, highest, options.output))
    return 0


def _write_doublings(options: argparse.Namespace, lowest: Fraction, highest: Fraction) -> int:
    """Follow the period doublings and write their atlas; returns the exit code."""
    from orbitproof.explore.atlases import LibrationFailure
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.families import FamilyFailure
    from orbitproof.explore.orbits import CorrectionFailure
    from orbitproof.explore.three_body.atlases import doubling_atlas

    with Reporter(options.quiet) as report:
        report.stage(f"{options.point}, the curve of period doublings")
        try:
            atlas = doubling_atlas(options.point, lowest, highest, options.tube or DOUBLED_TUBE)
        except (FamilyFailure, CorrectionFailure, LibrationFailure) as error:
            report.error(f"error: {error}")
            return 1
        write_atlas(options.output, atlas)
        report.message(_said(atlas, "h", lowest, highest, options.output))
    return 0


def _said(atlas: Atlas, parameter: str, lowest: Fraction, highest: Fraction, output: Any) -> str:
    """What was written."""
    count = counted(len(atlas.pieces), "piece")
    return f"{count} over {parameter} from {float(lowest):.6g} to {float(highest):.6g} written to {output}"


def _root(mass: Fraction, rounded: Any) -> Fraction:
    """mass^(1/3) to four decimals, rounded to the side that `rounded` tells."""
    root = Fraction(rounded(float(mass) ** (1 / 3) * _GRAIN), _GRAIN)
    # Exactly representable roots may have been moved to the wrong side by the float power.
    step = Fraction(1, _GRAIN)
    if rounded is ceil:
        return root if root**3 >= mass else root + step
    return root if root**3 <= mass else root - step
