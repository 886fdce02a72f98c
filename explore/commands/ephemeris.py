"""``orbitproof explore ephemeris``: an orbit carried over to bodies that move as kernels for SPICE say."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from orbitproof.explore.commands.common import add_orbit_choice, add_quiet, check_outputs, positive
from orbitproof.explore.commands.trajectory import add_spice_numbers
from orbitproof.explore.names import NoOrbit
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import InputError, write_text
from orbitproof.shared.help_text import add_command
from orbitproof.shared.printed_tables import wrapped

_EXAMPLES = """\
examples:
  orbitproof explore ephemeris catalogue.json --orbit 700 --kernels planets.bsp masses.tpc --epoch 2030-01-01T00:00:00 --oem orbit.oem
  orbitproof explore ephemeris orbit-certificate.json --bodies earth moon sun --kernels planets.bsp --gm earth=398600.436 moon=4902.8001 sun=132712440041.28 --epoch 2030-01-01T00:00:00 --periods 4 --spk orbit.bsp

The orbit in axes that turn and stretch with the primaries is the first guess; by multiple shooting it becomes one that
point masses, moving as the kernels say, allow for --periods. Kernels are yours, for example of NAIF; nothing is
downloaded. NUMERICAL: double precision, point masses alone, and nothing is proved. Dates are TDB.
Exit codes: 0 written, 1 no such orbit found, 2 bad input.
"""  # noqa: E501


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "ephemeris", "an orbit of the CR3BP carried over to bodies that move as kernels say", _EXAMPLES
    )
    add_orbit_choice(parser)
    parser.add_argument("--kernels", nargs="+", type=Path, required=True, metavar="FILE", help="kernels for SPICE")
    parser.add_argument(
        "--bodies", nargs="+", metavar="NAME",
        help="the larger primary, the smaller one, all others (default: the primaries of the file, and the Sun)",
    )  # fmt: skip
    parser.add_argument(
        "--gm", nargs="+", default=[], metavar="NAME=VALUE", help="km^3/s^2, of bodies whose GM no kernel has"
    )
    parser.add_argument("--epoch", required=True, metavar="DATE", help="of the first state, TDB")
    parser.add_argument(
        "--periods", type=positive, default=1.0, metavar="P", help="how many periods (default: %(default)s)"
    )
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="CSV file to write")
    parser.add_argument("--oem", type=Path, metavar="FILE", help="CCSDS OEM file to write")
    parser.add_argument("--spk", type=Path, metavar="FILE", help="SPICE's SPK file to write")
    parser.add_argument(
        "--error", type=positive, default=1e-3, metavar="KM",
        help="largest error of places when a file is interpolated (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--origin", metavar="NAME", help="one of --bodies (default: the smaller primary)")
    add_spice_numbers(parser)
    parser.set_defaults(spk_frame="J2000")
    add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Carry the orbit over and write the files asked for; returns the exit code. Raises `InputError`."""
    check_outputs(options.output, options.oem, options.spk)
    if options.periods > 1000:
        raise InputError(f"--periods {options.periods:g}: give at most 1000")
    gravity = _gravity(options.gm)
    # They may not be installed.
    for package in ("spiceypy", *(["ccsds_ndm"] if options.oem else [])):
        import_module(package)
    # Only now: JAX takes a moment to load.
    import numpy as np

    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.three_body.ephemeris_model import (
        NotCarried,
        bodies_named,
        carry_over,
        kernels_loaded,
        real_ephemeris,
    )
    from orbitproof.explore.three_body.trajectories import (
        IN_KM,
        Choice,
        TooFine,
        ephemeris_text,
        epoch_of,
        error_of_message,
        find_orbit,
        seconds_of,
        trajectory_of,
        write_spk,
        write_table,
    )
    from orbitproof.shared.systems import THREE_BODY

    epoch = epoch_of(options.epoch)
    with Reporter(options.quiet) as report, kernels_loaded(options.kernels):
        report.stage("ephemeris")
        try:
            source = find_orbit(options.file, Choice(options.id, options.family, options.orbit, options.accept))
            if source.system not in THREE_BODY:
                raise InputError(f"{options.file}: {source.system.name} has no orbits in space")
            bodies = bodies_named(_bodies(options.bodies, source.primaries), gravity)
            origin = _origin(options.origin, bodies.names)
            orbit = carry_over(
                trajectory_of(source), bodies, seconds_of(epoch), periods=options.periods, progress=report.update
            )
            ephemeris = real_ephemeris(orbit, epoch, origin=origin, error=options.error)
        except TooFine as failure:
            raise InputError(f"--error: {failure}") from None
        except (NoOrbit, NotCarried) as failure:
            report.error(f"{options.file}: {failure}")
            return 1
        lines = list(ephemeris.head)
        if options.oem is not None:
            message = ephemeris_text(ephemeris)
            lines.append(f"{options.oem}: read back, interpolated to {error_of_message(message, ephemeris):.1e} km")
        if options.spk is not None:
            centre = bodies.numbers[origin] if options.spk_centre is None else options.spk_centre
            found = write_spk(options.spk, ephemeris, body=options.spk_body, centre=centre, frame=options.spk_frame)
            lines.append(
                f"{options.spk}: body {options.spk_body} about {centre}; read back by SPICE, "
                f"interpolated to {found:.1e} km"
            )
        if options.output is not None:
            write_table(
                options.output, [*ephemeris.head, *ephemeris.remarks, f"t = 0: {options.epoch} TDB"], IN_KM,
                np.column_stack([ephemeris.times, ephemeris.states]),
            )  # fmt: skip
        if options.oem is not None:
            write_text(options.oem, message)
    tell(wrapped(lines), [{"about": lines}])
    return 0


def _gravity(assignments: Sequence[str]) -> dict[str, float]:
    result: dict[str, float] = {}
    for text in assignments:
        name, _, value = text.partition("=")
        try:
            result[name] = positive(value)
        except (ValueError, argparse.ArgumentTypeError):
            raise InputError(f"--gm {text}: give a name and km^3/s^2, for example moon=4902.8") from None
    return result


def _bodies(given: Sequence[str] | None, primaries: tuple[str, str] | None) -> Sequence[str]:
    if given is not None:
        if len(given) < 2:
            raise InputError(f"--bodies {' '.join(given)}: give the larger primary, the smaller one, and all others")
        return given
    if primaries is None:
        raise InputError("--bodies: missing; the orbit's file names no bodies: give for example earth moon sun")
    return [*primaries, *(["Sun"] if "Sun" not in primaries else [])]


def _origin(name: str | None, bodies: Sequence[str]) -> int:
    if name is None:
        return 1
    for index, body in enumerate(bodies):
        if body.casefold() == name.casefold():
            return index
    raise InputError(f"--origin {name}: give one of {', '.join(bodies)}")
