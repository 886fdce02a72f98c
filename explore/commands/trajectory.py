"""``orbitproof explore trajectory``: the states of an orbit over time."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

from orbitproof.explore.commands.common import add_command, add_orbit_choice, positive
from orbitproof.shared.formats import InputError, check_writable, write_text

_EXAMPLES = """\
examples:
  orbitproof explore trajectory candidates.json --id earth-moon-L1-halo-k2-1 -o orbit.csv
  orbitproof explore trajectory certificates.json --id earth-moon-L2-halo-k3-1 --periods 2 -o orbit.csv
  orbitproof explore trajectory families.json --family earth-moon-L2-halo --orbit 100 -o orbit.csv
  orbitproof explore trajectory catalogue.json --orbit 700 --units km -o orbit.csv --oem orbit.oem
  orbitproof explore trajectory families.json --orbit 9 --units km --lunit 389703 --tunit 382981 --oem orbit.oem

The first state lies on Fix(R), at its time 0. Everything is computed in double precision and nothing is proved; what
a certificate says about an orbit is copied. Kilometres and seconds need the units of the system: those that a
catalogue file names, or --lunit and --tunit. An ephemeris message (CCSDS OEM) is in km, its dates are labels.
Exit codes: 0 written, 1 no periodic orbit there, 2 bad input.
"""

COUNTS = (2, 1_000_000)


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "trajectory", "states of one orbit over time, as CSV and as CCSDS ephemeris message", _EXAMPLES
    )
    add_orbit_choice(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="CSV file to write")
    parser.add_argument("--oem", type=Path, metavar="FILE", help="CCSDS OEM file to write; needs --units km")
    parser.add_argument(
        "--points", type=int, default=201, metavar="N", help="states, both ends included (default: %(default)s)"
    )
    parser.add_argument(
        "--periods", type=positive, default=1.0, metavar="P", help="how many periods (default: %(default)s)"
    )
    parser.add_argument(
        "--units", choices=("nondimensional", "km"), default="nondimensional", help="km: km and s (default %(default)s)"
    )
    parser.add_argument(
        "--lunit", type=positive, metavar="KM", help="the unit of length in km, in place of the catalogue's"
    )
    parser.add_argument(
        "--tunit", type=positive, metavar="S", help="the unit of time in s, in place of the catalogue's"
    )
    parser.add_argument(
        "--epoch", default="2000-01-01T12:00:00", metavar="DATE", help="of the first state, TDB (default: %(default)s)"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the files asked for; returns the exit code. Raises `InputError`."""
    if options.output is None and options.oem is None:
        raise InputError("-o, --oem: missing; name the CSV file or the ephemeris file to write")
    for path in (options.output, options.oem):
        if path is not None:
            check_writable(path)
    if not COUNTS[0] <= options.points <= COUNTS[1]:
        raise InputError(f"--points {options.points}: give a whole number from {COUNTS[0]} to {COUNTS[1]}")
    if not isfinite(options.periods) or options.periods > 1e6:
        raise InputError(f"--periods {options.periods:g}: give a number up to 1000000")

    if options.oem is not None:
        # Before anything is computed: it may not be installed.
        import_module("ccsds_ndm")
    # Only now: JAX takes a moment to load.
    from orbitproof.explore.trajectories import (
        Choice,
        NoOrbit,
        chosen_units,
        description,
        ephemeris_text,
        epoch_of,
        find_orbit,
        trajectory_of,
        write_csv,
    )
    from orbitproof.shared.systems import THREE_BODY

    epoch = epoch_of(options.epoch)
    try:
        source = find_orbit(options.file, Choice(options.id, options.family, options.orbit))
        if options.units == "km" and source.system not in THREE_BODY:
            raise InputError(f"--units km: {source.system.name} has no units of length and time; leave it out")
        units = chosen_units(options.units, options.lunit, options.tunit, source.units)
        trajectory = trajectory_of(source, options.points, options.periods)
    except NoOrbit as failure:
        print(f"{options.file}: {failure}", file=sys.stderr)
        return 1
    message = None if options.oem is None else ephemeris_text(trajectory, units, epoch)
    if options.output is not None:
        write_csv(options.output, trajectory, units)
    if message is not None:
        write_text(options.oem, message)
    print("\n".join(description(trajectory, units)))
    return 0
