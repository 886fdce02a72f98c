"""``orbitproof explore tori`` and ``orbitproof explore manifold``: what surrounds an orbit of the CR3BP."""

from __future__ import annotations

import argparse
import re
from math import isfinite
from typing import Any

from orbitproof.explore.commands.common import add_orbit_choice, add_output, add_quiet, index, positive
from orbitproof.explore.names import NoOrbit
from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.wording import counted

_TORI_EXAMPLES = """\
examples:
  orbitproof explore tori catalogue.json --orbit 700 -o tori.json
  orbitproof explore tori families.json --family earth-moon-L2-halo --orbit 60 --pair 2 --curves 20 -o tori.json
  orbitproof figures tori tori.json -o figures-out/

Quasi-periodic orbits around an orbit with multipliers on the unit circle: invariant curves of the return map at its
Jacobi constant, from small to large until the method fails, each with the error of its invariance. Numerics in double
precision; nothing is proved. An interrupted run writes the tori that it has. Exit codes: 0 written, 1 no tori found,
2 bad input, 130 interrupted.
"""

_MANIFOLD_EXAMPLES = """\
examples:
  orbitproof explore manifold families.json --family earth-moon-L1-halo --orbit 20 --plane x=0.98785 -o tube.json
  orbitproof explore manifold catalogue.json --orbit 700 --kind stable --side - --plane x=0.98785 -o tube.json
  orbitproof figures tori tube.json -o figures-out/

Orbits that leave an unstable periodic orbit (or come to it: stable), on one side of it, up to a plane that it does not
meet itself. Numerics in double precision; nothing is proved. Exit codes: 0 written, 1 no tube found or an orbit does
not reach the plane, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommands to the parser's `commands`."""
    tori = add_command(commands, "tori", "invariant tori around an elliptic orbit of the CR3BP", _TORI_EXAMPLES)
    add_orbit_choice(tori)
    add_output(tori, "file of tori")
    tori.add_argument(
        "--pair", type=index, default=1, metavar="N",
        help="which elliptic pair of multipliers, by stability parameter (default: %(default)s)",
    )  # fmt: skip
    tori.add_argument("--curves", type=index, default=40, metavar="N", help="at most so many (default: %(default)s)")
    tori.add_argument(
        "--step", type=positive, default=0.01, metavar="H", help="longest step along the family (default: %(default)s)"
    )
    add_quiet(tori)
    tori.set_defaults(run=run_tori)
    tube = add_command(
        commands, "manifold", "a tube of the stable or unstable manifold of an orbit of the CR3BP", _MANIFOLD_EXAMPLES
    )
    add_orbit_choice(tube)
    add_output(tube, "manifold file")
    tube.add_argument("--kind", choices=("unstable", "stable"), default="unstable", help="default: %(default)s")
    tube.add_argument("--side", choices=("+", "-"), default="+", help="of the orbit, in x (default: %(default)s)")
    tube.add_argument("--plane", required=True, metavar="X=VALUE", help="where the tube ends, for example x=0.98785")
    tube.add_argument("--lines", type=index, default=60, metavar="N", help="orbits of the tube (default: %(default)s)")
    tube.add_argument(
        "--offset", type=positive, default=1e-5, metavar="D",
        help="distance at which they start from the periodic orbit (default: %(default)s)",
    )  # fmt: skip
    tube.add_argument(
        "--longest", type=positive, default=20.0, metavar="T", help="time after which one is given up (default: 20)"
    )
    add_quiet(tube)
    tube.set_defaults(run=run_manifold)


def run_tori(options: argparse.Namespace) -> int:
    """Trace the tori and write them; returns the exit code. Raises `InputError`."""
    check_writable(options.output)
    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.three_body.invariants import NoCurve, trace_tori, write_tori
    from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
    from orbitproof.shared.systems import CR3BP

    with Reporter(options.quiet) as report:
        report.stage("tori")
        try:
            source = find_orbit(options.file, Choice(options.id, options.family, options.orbit, options.accept))
            if source.system is not CR3BP:
                raise InputError(f"{options.file}: tori are traced around orbits of cr3bp, not of {source.system.name}")
            trajectory = trajectory_of(source)
            if trajectory.crossings != 1:
                raise NoCurve(
                    f"half orbits of {source.title} meet the section y = 0 {trajectory.crossings} times; tori are "
                    "traced around orbits that meet it once"
                )
            family = trace_tori(
                trajectory.orbit,
                float(source.parameters["mu"]),
                index=options.pair - 1,
                largest_step=options.step,
                most=options.curves,
                progress=report.update,
            )
        except (NoOrbit, NoCurve) as failure:
            report.error(f"{options.file}: no tori: {failure}")
            return 1
        write_tori(options.output, trajectory, family)
        worst = max(curve.error for curve in family.curves)
        last = family.curves[-1]
        report.message(
            f"{len(family.curves)} tori written to {options.output}, amplitude up to {last.amplitude:.4g}, error of "
            f"invariance up to {worst:.1e}; ends: {family.reason}"
        )
    return INTERRUPTED if family.reason == "interrupted" else 0


def run_manifold(options: argparse.Namespace) -> int:
    """Compute the tube and write it; returns the exit code. Raises `InputError`."""
    check_writable(options.output)
    match = re.fullmatch(r"([xyz])=(.+)", options.plane.replace(" ", ""))
    try:
        value = float(match[2]) if match else float("nan")
    except ValueError:
        value = float("nan")
    if match is None or not isfinite(value):
        raise InputError(f"--plane {options.plane}: give a coordinate and a number, for example x=0.98785")
    if not options.offset <= 0.01:
        raise InputError(f"--offset {options.offset:g}: too far from the periodic orbit; give at most 0.01")
    if options.longest > 1000:
        raise InputError(f"--longest {options.longest:g}: give at most 1000")
    import numpy as np

    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.three_body.invariants import NoManifold, Plane, manifold_of, write_manifold
    from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
    from orbitproof.shared.systems import THREE_BODY

    with Reporter(options.quiet) as report:
        report.stage("manifold")
        try:
            source = find_orbit(options.file, Choice(options.id, options.family, options.orbit, options.accept))
            if source.system not in THREE_BODY:
                raise InputError(f"{options.file}: {source.system.name} has no orbits in space")
            trajectory = trajectory_of(source)
            plane = Plane("xyz".index(match[1]), value)
            along = trajectory.states(np.linspace(0.0, trajectory.period, 201))[:, plane.index]
            if along.min() <= value <= along.max():
                raise InputError(
                    f"--plane {options.plane}: meets the periodic orbit itself, where the tube begins; give {match[1]} "
                    f"below {along.min():.6g} or above {along.max():.6g}"
                )
            tube = manifold_of(
                trajectory.solution,
                trajectory.parameters["mu"],
                index=trajectory.stability_index,
                kind=options.kind,
                side=1 if options.side == "+" else -1,
                plane=plane,
                count=options.lines,
                offset=options.offset,
                longest=options.longest,
                progress=report.update,
            )
        except (NoOrbit, NoManifold) as failure:
            report.error(f"{options.file}: no manifold: {failure}")
            return 1
        write_manifold(options.output, trajectory, tube)
        count = int(tube.reached.sum())
        drift = (
            f"largest change of the Jacobi constant {tube.drift:.1e}"
            if count
            else "give --longest more time, or another --plane"
        )
        report.message(
            f"{counted(len(tube.times), 'orbit')} written to {options.output}, {count} of them reach {tube.plane}; "
            f"multiplier {tube.multiplier:.6g}, {drift}"
        )
    return 0 if count == len(tube.times) else 1
