"""``orbitproof explore mass-curve``: symmetry-breaking points of L1, L2, L3 as functions of the mass parameter."""

from __future__ import annotations

import argparse
from fractions import Fraction
from math import isfinite, log10
from typing import Any

from orbitproof.explore.commands.common import add_jobs, add_output, add_quiet
from orbitproof.explore.three_body.names import mass_parameter
from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.systems import MASS_PARAMETERS

POINTS = ("L1", "L2", "L3")
DIGITS = (10, 300)
EXTREMUM_BITS, EXTREMUM_ORDER, EXTREMUM_TOLERANCE = 400, 80, 1e-60

_EXAMPLES = """\
examples:
  orbitproof explore mass-curve -o curves.json
  orbitproof explore mass-curve --digits 50 --at decades earth-moon sun-jupiter -o curves.json
  orbitproof explore mass-curve --points L2 L3 --extrema L2 L3 --digits 30 -o curves.json
  orbitproof explore mass-curve --points L3 --mu-min 1e-30 --at 1e-20 1e-30 --digits 20 -o small.json

Follows the first symmetry breaking of each planar Lyapunov family, where the halo orbits are born, from the largest
mass to the smallest. What the output file already holds is kept: the same command goes on where it was interrupted.
Exit codes: 0 everything found, 1 something was not, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "mass-curve", "symmetry-breaking points of L1, L2, L3 as functions of the mass parameter", _EXAMPLES
    )
    parser.add_argument(
        "--points", nargs="+", choices=POINTS, default=list(POINTS), help="libration points (default: all three)"
    )
    parser.add_argument(
        "--mu-max", default="0.5", metavar="MU", help="largest mass, at most 1/2 (default: %(default)s)"
    )
    parser.add_argument("--mu-min", default="1e-10", metavar="MU", help="smallest mass (default: %(default)s)")
    parser.add_argument(
        "--step",
        type=float,
        default=0.1,
        metavar="S",
        help="longest step, in log mu and in scaled coordinates, 0.001 to 1 (default: %(default)s)",
    )
    parser.add_argument(
        "--digits",
        type=int,
        metavar="N",
        help="compute points in high precision as well, to N digits relative to the size of the orbit (default with "
        "--at or --extrema: 30)",
    )
    parser.add_argument(
        "--at",
        nargs="+",
        metavar="MU",
        help="masses of these points: numbers, taken exactly, names "
        f"({', '.join(MASS_PARAMETERS)}), or decades for all powers of ten (default with --digits: decades)",
    )
    parser.add_argument(
        "--extrema",
        nargs="+",
        choices=POINTS,
        default=[],
        help="locate the local minima and maxima of the Jacobi constant along the curves of these points",
    )
    precision = parser.add_argument_group(
        "high precision; every result is checked with 80 more bits, a quarter more terms, a tolerance 1e-20 times finer"
    )
    precision.add_argument(
        "--bits", type=int, metavar="B", help=f"of the mantissas (default: what N needs; extrema: {EXTREMUM_BITS})"
    )
    precision.add_argument(
        "--order",
        type=int,
        metavar="K",
        help=f"of the Taylor expansion in time (default: 0.4 times the bits; extrema: {EXTREMUM_ORDER})",
    )
    precision.add_argument(
        "--tolerance",
        type=float,
        metavar="T",
        help=f"of a time step, relative (default: the last bit; extrema: {EXTREMUM_TOLERANCE:g})",
    )
    add_output(parser, "mass-curve file")
    add_jobs(parser, " for points in high precision")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check the options and trace; returns the exit code. Raises `InputError`."""
    check_writable(options.output)
    largest, smallest = mass_parameter("--mu-max", options.mu_max), mass_parameter("--mu-min", options.mu_min)
    if not smallest < largest:
        raise InputError(f"--mu-min {options.mu_min}: not below --mu-max; give a smaller mass")
    if float(smallest) < 1e-100:
        raise InputError(f"--mu-min {options.mu_min}: below 1e-100; give a larger mass")
    if not 0.001 <= options.step <= 1:
        raise InputError(f"--step {options.step:g}: outside [0.001, 1]; the default is 0.1")
    if options.digits is not None and not DIGITS[0] <= options.digits <= DIGITS[1]:
        raise InputError(f"--digits {options.digits}: give {DIGITS[0]} to {DIGITS[1]}")
    for name in options.extrema:
        if name not in options.points:
            raise InputError(f"--extrema {name}: not among --points; add it there")
    for name, value, low, high in (("bits", options.bits, 64, 20_000), ("order", options.order, 10, 10_000)):
        if value is not None and not low <= value <= high:
            raise InputError(f"--{name} {value}: give a whole number from {low} to {high}")
    tolerance = options.tolerance
    if tolerance is not None and (not isfinite(tolerance) or not 1e-280 <= tolerance <= 1e-10):
        raise InputError(f"--tolerance {tolerance:g}: give a number from 1e-280 to 1e-10")

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.three_body.masses import MassCurveRequest, run_request

    request = MassCurveRequest(
        points=tuple(dict.fromkeys(options.points)),
        largest=largest,
        smallest=smallest,
        step=options.step,
        masses=_masses(options, largest, smallest),
        extrema=tuple(dict.fromkeys(options.extrema)),
        digits=options.digits or 30,
        bits=options.bits,
        order=options.order,
        tolerance=tolerance,
        extremum_settings=(
            options.bits or EXTREMUM_BITS,
            options.order or EXTREMUM_ORDER,
            tolerance or EXTREMUM_TOLERANCE,
        ),
        output=options.output,
        jobs=options.jobs,
        quiet=options.quiet,
    )
    return run_request(request)


def _masses(options: argparse.Namespace, largest: Fraction, smallest: Fraction) -> tuple[Fraction, ...]:
    """The masses of the points in high precision, from the largest; raises `InputError`."""
    words = options.at
    if words is None:
        words = [] if options.digits is None or options.extrema else ["decades"]
    masses: set[Fraction] = set()
    for text in words:
        if text == "decades":
            lowest = int(log10(smallest)) - 1
            decades = {Fraction(10) ** exponent for exponent in range(lowest, 0)}
            masses |= {largest, *(mu for mu in decades if smallest <= mu <= largest)}
            continue
        mu = mass_parameter("--at", text)
        if not smallest <= mu <= largest:
            raise InputError(f"--at {text}: outside [--mu-min, --mu-max]; give a mass on the curve")
        masses.add(mu)
    return tuple(sorted(masses, reverse=True))
