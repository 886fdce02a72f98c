"""``orbitproof explore trajectory``: the states of an orbit over time."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands.common import add_orbit_choice, check_outputs, positive
from orbitproof.explore.names import NoOrbit
from orbitproof.explore.three_body.names import units_of_system
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import InputError, write_text
from orbitproof.shared.help_text import add_command
from orbitproof.shared.printed_tables import wrapped

if TYPE_CHECKING:
    from orbitproof.explore.three_body.trajectories import SampledOrbit

_EXAMPLES = """\
examples:
  orbitproof explore trajectory candidates.json --id earth-moon-L1-halo-k2-1 -o orbit.csv
  orbitproof explore trajectory certificates.json --id earth-moon-L2-halo-k3-1 --periods 2 -o orbit.csv
  orbitproof explore trajectory families.json --family earth-moon-L2-halo --orbit 100 -o orbit.csv
  orbitproof explore trajectory homoclinic-certificates.json --id L1 -o connection.csv
  orbitproof explore trajectory branches.json --id earth-moon-L1-halo-k2-1 --orbit -10 -o orbit.csv
  orbitproof explore trajectory catalogue.json --orbit 700 --units km -o orbit.csv --oem orbit.oem
  orbitproof explore trajectory catalogue.json --orbit 700 --units km --frame inertial --origin moon --spk orbit.bsp
  orbitproof explore trajectory families.json --orbit 9 --units km --lunit 389703 --tunit 382981 --oem orbit.oem

The first state lies on Fix(R), at its time 0; a homoclinic orbit begins near its periodic orbit, comes to Fix(R) and
goes back. States are dense where the orbit is fast: as dense as their interpolation needs (Hermite, degree 7), whose
error is stated and, of an OEM and an SPK file, found again by reading the file.
Everything is computed in double precision and nothing is proved; what a certificate says about an orbit is copied.
Kilometres and seconds need the units of the system: those that a catalogue file names, or --lunit and --tunit.
Ephemerides (CCSDS OEM, SPK) are in km, their dates are labels.
Exit codes: 0 written, 1 no periodic orbit there, 2 bad input.
"""

COUNTS = (2, 1_000_000)


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "trajectory", "states of one orbit over time, as CSV, CCSDS ephemeris message and SPK", _EXAMPLES
    )
    add_orbit_choice(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="CSV file to write")
    parser.add_argument("--oem", type=Path, metavar="FILE", help="CCSDS OEM file to write; needs --units km")
    parser.add_argument(
        "--spk", type=Path, metavar="FILE", help="SPICE's SPK file to write; needs --units km and --frame inertial"
    )
    parser.add_argument(
        "--error", type=positive, metavar="E",
        help="largest error of places when the file is interpolated, in its unit of length (default: 1 m, or 1e-9)",
    )  # fmt: skip
    parser.add_argument(
        "--points", type=int, metavar="N",
        help="so many states at equal intervals, both ends included, in place of --error (201 for systems without "
        "places in space)",
    )  # fmt: skip
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
        "--frame", choices=("rotating", "inertial"), default="rotating",
        help="axes that turn with the primaries, or that are there at time 0 and do not turn (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--origin", default="barycentre", metavar="NAME",
        help="barycentre, larger, smaller, or the name of a body, for example moon (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--epoch", default="2000-01-01T12:00:00", metavar="DATE", help="of the first state, TDB (default: %(default)s)"
    )
    add_spice_numbers(parser)
    parser.set_defaults(run=run)


def add_spice_numbers(parser: Any) -> None:
    """``--spk-body``, ``--spk-centre``, ``--spk-frame``."""
    parser.add_argument(
        "--spk-body", type=int, default=-100000, metavar="N", help="SPICE's number of the spacecraft (default: -100000)"
    )
    parser.add_argument(
        "--spk-centre", type=int, metavar="N", help="SPICE's number of the origin (default: by the name of the body)"
    )
    parser.add_argument(
        "--spk-frame", default="ECLIPJ2000", metavar="NAME",
        help="SPICE's name of the axes of the SPK file (default: %(default)s)",
    )  # fmt: skip


def run(options: argparse.Namespace) -> int:
    """Write the files asked for; returns the exit code. Raises `InputError`."""
    _check(options)
    # Only now: JAX takes a moment to load.
    from orbitproof.explore.three_body.trajectories import (
        Choice,
        Frame,
        TooFine,
        centre_number,
        chosen_units,
        description,
        ephemeris_of,
        ephemeris_text,
        epoch_of,
        error_of_message,
        find_orbit,
        origin_named,
        sample,
        trajectory_of,
        write_csv,
        write_spk,
    )
    from orbitproof.shared.systems import THREE_BODY

    epoch = epoch_of(options.epoch)
    try:
        chosen = Choice(options.id, options.family, options.orbit, options.accept, connections=True)
        source = find_orbit(options.file, chosen)
        if source.distance is not None and options.periods != 1:
            raise InputError("--periods: a homoclinic orbit does not repeat itself; leave it out")
        if source.system not in THREE_BODY:
            for option, given in (("--units km", options.units == "km"), ("--error", options.error),
                                  ("--frame", options.frame != "rotating"),
                                  ("--origin", options.origin != "barycentre")):  # fmt: skip
                if given:
                    raise InputError(f"{option}: {source.system.name} has no orbits in space; leave it out")
        system = units_of_system(source.parameters.get("mu"), "-".join(source.primaries or ()))
        units = chosen_units(options.units, options.lunit, options.tunit, source.units, system)
        frame = Frame(options.frame, origin_named(options.origin, source.primaries))
        samples = sample(
            trajectory_of(source), frame=frame, units=units, periods=options.periods, count=options.points,
            error=options.error,
        )  # fmt: skip
    except TooFine as failure:
        raise InputError(f"--error: {failure}") from None
    except NoOrbit as failure:
        print(f"{options.file}: {failure}", file=sys.stderr)
        return 1
    lines = description(samples)
    message = None
    if options.oem is not None:
        ephemeris = ephemeris_of(samples, epoch)
        message = ephemeris_text(ephemeris)
        found = error_of_message(message, ephemeris)
        lines += [] if found is None else [f"{options.oem}: read back, interpolated to {found:.1e} km"]
    if options.spk is not None:
        centre = centre_number(frame.origin, source.primaries, options.spk_centre)
        ephemeris = ephemeris_of(samples, epoch, "--spk")
        found = write_spk(options.spk, ephemeris, body=options.spk_body, centre=centre, frame=options.spk_frame)
        lines.append(
            f"{options.spk}: body {options.spk_body} about {centre} in {options.spk_frame}, a label; read back by "
            f"SPICE, interpolated to {found:.1e} km"
        )
    if options.output is not None:
        write_csv(options.output, samples)
    if message is not None:
        write_text(options.oem, message)
    tell(wrapped(lines), [_as_json(samples, lines)])
    return 0


def _as_json(samples: SampledOrbit, lines: list[str]) -> dict[str, Any]:
    """What was written, for programs; times and lengths in the units of the file."""
    trajectory = samples.trajectory
    return {
        "orbit": trajectory.source.title,
        "system": trajectory.source.system.name,
        "parameters": trajectory.source.parameters,
        "period": trajectory.period if trajectory.source.distance is None else None,
        "first_integral": trajectory.first_integral,
        "states": len(samples.times),
        "last_time": samples.times[-1],
        "interpolation_error": samples.error,
        "about": lines,
    }


def _check(options: argparse.Namespace) -> None:
    """Whether the options fit together, before anything is computed. Raises `InputError`."""
    check_outputs(options.output, options.oem, options.spk)
    if options.points is not None:
        if options.error is not None:
            raise InputError("--points: --error says how dense the states are; leave out one of the two")
        if not COUNTS[0] <= options.points <= COUNTS[1]:
            raise InputError(f"--points {options.points}: give a whole number from {COUNTS[0]} to {COUNTS[1]}")
    if not isfinite(options.periods) or options.periods > 1e6:
        raise InputError(f"--periods {options.periods:g}: give a number up to 1000000")
    if options.spk is not None and options.frame == "rotating":
        raise InputError("--spk: SPICE knows no axes that turn with these bodies; add --frame inertial")
    # They may not be installed.
    for path, package in ((options.oem, "ccsds_ndm"), (options.spk, "spiceypy")):
        if path is not None:
            import_module(package)
