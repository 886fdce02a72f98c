"""``orbitproof explore connections``: symmetric homoclinic orbits to a periodic orbit on its level."""

from __future__ import annotations

import argparse
from functools import partial
from typing import Any

from orbitproof.explore.commands import common
from orbitproof.explore.commands.periodic_claims import ClaimStore, kept_claims
from orbitproof.explore.names import exact_number, exact_parameters, system_named, values_by_name
from orbitproof.shared.claims import HomoclinicOrbit
from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.interrupts import INTERRUPTED

_EXAMPLES = """\
examples:
  orbitproof explore connections --system cr3bp-planar --parameter mu=0.0009537 --start x=0.9208 --sign 1 \\
      --level "3.03 - 0.0009537*(1 - 0.0009537)" --side -1 --arrivals 3 -o claims.json
      orbits from the Lyapunov orbit about the first libration point and back to it, on its level
  orbitproof verify claims.json -o certificates.json

The system has four coordinates, two of which R fixes, and a first integral A + b w^2 in its level coordinate w.
Exit codes: 0 found, 1 nothing is found or not all is refined, 2 bad input, 130 interrupted: the claims so far are kept.
"""

_NEAR = 1e-6
"""The images of boxes are so large: the unstable manifold bends little in them."""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    meaning = "homoclinic orbits to a symmetric periodic orbit, on a level of the first integral"
    parser = add_command(commands, "connections", meaning, _EXAMPLES)
    common.add_system(parser)
    parser.add_argument("--level", required=True, metavar="NUMBER", help="of the first integral, exactly as written")
    words = "near the point of the periodic orbit on Fix(R): the coordinate that is not the level coordinate"
    parser.add_argument("--start", required=True, metavar="NAME=VALUE", help=words)
    words = "of the level coordinate there (default: %(default)s)"
    parser.add_argument("--sign", type=int, choices=(1, -1), default=1, help=words)
    words = "crossings of the section in half a period (default: %(default)s)"
    parser.add_argument("--half", type=common.crossings, default=1, metavar="M", help=words)
    words = "the branch of the unstable manifold on which that coordinate grows or falls (default: both)"
    parser.add_argument("--side", type=int, choices=(1, -1), help=words)
    words = (
        "crossings after which an orbit is in Fix(R), counted from a that are sampled, from 1e-7 or more, which is "
        "printed, to that times the multiplier (default: the first at which there are orbits)"
    )
    parser.add_argument("--arrivals", type=common.crossings, nargs="+", metavar="K", help=words)
    words = (
        "the orbit is claimed from a point at most so far from the periodic orbit, and the box is about as large "
        "(default: a millionth, divided by the multiplier)"
    )
    parser.add_argument("--near", type=common.positive, metavar="R", help=words)
    common.add_claim_output(parser, "what is found is printed")
    parser.set_defaults(run=run, digits=30)


def run(options: argparse.Namespace) -> int:
    """Find, print, refine and write; returns the exit code. Raises `InputError`."""
    if options.output is not None:
        check_writable(options.output)
    if options.system is None:
        raise InputError("--system: missing; name a system or its file")
    system = system_named(options.system)
    parameters = exact_parameters(system, values_by_name("--parameter", options.parameter or ()))
    level = exact_number("--level", options.level)
    ((name, text),) = values_by_name("--start", [options.start]).items()
    start = exact_number(f"--start {name}", text)
    kept = kept_claims(options)

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.connections import (
        ConnectionFailure,
        OnLevel,
        homoclinic_claim,
        homoclinic_orbits,
        hyperbolic_orbit,
        is_claimed,
    )
    from orbitproof.explore.engines import Reporter

    with Reporter(options.quiet) as report:
        try:
            setting = OnLevel(system, parameters, level, options.sign)
            if name != system.state[setting.along]:
                raise InputError(f"--start {name}: give the coordinate {system.state[setting.along]}")
            report.stage("periodic orbit")
            orbit = hyperbolic_orbit(setting, start, options.half, options.digits)
        except ConnectionFailure as failure:
            report.error(f"{system.name}: {failure}")
            return 1
        report.message(
            f"periodic orbit: {name} = {float(orbit.p):.15g}, period {orbit.period:.10g}, multiplier "
            f"{float(orbit.multiplier):.10g}; sampled from a = {orbit.first:.3g}"
        )
        found = []
        for side in (1, -1) if options.side is None else (options.side,):
            report.stage("unstable manifold")
            found += homoclinic_orbits(orbit, side, options.arrivals or ())
        print(f"{'a':>16}  crossings to Fix(R)")
        for each in found:
            print(f"{float(each.distance):16.8e}  {each.crossings}")
        code, near = 0 if found else 1, options.near or _NEAR / abs(float(orbit.multiplier))
        if not found:
            report.error(
                "no orbit comes to Fix(R) at these crossings; ask for later ones (--arrivals)"
                if options.arrivals
                else f"no orbit comes to Fix(R) within {orbit.crossings} crossings; ask for later ones (--arrivals)"
            )
        if options.output is None:
            return code
        store, claimed = ClaimStore(options.output, kept, report), {each.id: each for each in kept}
        base = options.id or f"{system.name}-homoclinic"
        try:
            for number, each in enumerate(found, start=1):
                label = base if len(found) == 1 else f"{base}-{number}"
                old = claimed.get(label)
                if not (isinstance(old, HomoclinicOrbit) and is_claimed(each, old)):
                    store.add(label, partial(homoclinic_claim, each, label, near, options.digits))
        except KeyboardInterrupt:
            report.error("interrupted; the same command with --append goes on from the claims in the file")
            return INTERRUPTED
        finally:
            store.close()
    return code if store.complete else 1
