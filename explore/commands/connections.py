"""``orbitproof explore connections``: symmetric homoclinic orbits, and heteroclinic ones, on a level."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from fractions import Fraction
from functools import partial
from itertools import product
from typing import Any

from orbitproof.explore.commands import common
from orbitproof.explore.commands.periodic_claims import ClaimStore, kept_claims
from orbitproof.explore.names import exact_number, exact_parameters, system_named, values_by_name
from orbitproof.shared.claims import HomoclinicCurve
from orbitproof.shared.formats import BoxClaim, InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.interrupts import INTERRUPTED

_EXAMPLES = """\
examples:
  orbitproof explore connections --system cr3bp-planar --parameter mu=0.0009537 --start x=0.9208 --sign 1 \\
      --level "3.03 - 0.0009537*(1 - 0.0009537)" --side -1 --arrivals 3 -o claims.json
      orbits from the Lyapunov orbit about the first libration point and back to it, on its level
  orbitproof explore connections --system cr3bp-planar --parameter mu=0.0009537 --start x=0.92 --side 1 \\
      --to x=1.08 --to-sign -1 --to-side -1 --level "3.03 - 0.0009537*(1 - 0.0009537)" -o claims.json
      from there to the orbit about the second one
  orbitproof verify claims.json -o certificates.json

The system has four coordinates, two of which R fixes, and a first integral A + b w^2 in its level coordinate w.
Exit codes: 0 found, 1 nothing is found or not all is refined, 2 bad input, 130 interrupted: the claims so far are kept.
"""

_NEAR = 1e-6
"""The images of boxes are so large: the unstable manifold bends little in them."""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    meaning = "orbits from a symmetric periodic orbit to itself or to another one, on a level of the first integral"
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
    words = "the same for the periodic orbit to which orbits shall lead (default: the same one)"
    parser.add_argument("--to", metavar="NAME=VALUE", help=words)
    for name, whose in (("sign", "--sign"), ("side", "--side"), ("half", "--half")):
        kind: Any = {"type": common.crossings, "metavar": "M"} if name == "half" else {"type": int, "choices": (1, -1)}
        parser.add_argument(f"--to-{name}", help=f"as {whose}, of that orbit", **kind)
    words = (
        "crossings after which an orbit is in Fix(R), counted from a that are sampled, from 1e-7 or more, which is "
        "printed, to that times the multiplier; with --to, from there to the other orbit (default: the "
        "first at which there are orbits)"
    )
    parser.add_argument("--arrivals", type=common.crossings, nargs="+", metavar="K", help=words)
    words = (
        "the orbit is claimed from a point at most so far from the periodic orbit, and the box is about as large "
        "(default: a millionth, divided by the multiplier)"
    )
    parser.add_argument("--near", type=common.positive, metavar="R", help=words)
    words = "claim each orbit for all levels at most so far from that of --level"
    parser.add_argument("--level-radius", metavar="NUMBER", help=words)
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
    wanted = [("--start", options.start, options.sign, options.half)]
    if options.to is not None:
        wanted += [("--to", options.to, options.to_sign or options.sign, options.to_half or options.half)]
    reach = None if options.level_radius is None else exact_number("--level-radius", options.level_radius)
    if reach is not None and not reach > 0:
        raise InputError("--level-radius: not positive")
    if reach is not None and options.to is not None:
        raise InputError("--level-radius: not with --to; orbits between two periodic orbits are claimed on one level")
    kept = kept_claims(options)

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.connections import (
        Branch,
        ConnectionFailure,
        OnLevel,
        heteroclinic_claim,
        heteroclinic_orbits,
        homoclinic_claim,
        homoclinic_curve_claim,
        homoclinic_orbits,
        hyperbolic_orbit,
        is_claimed,
        is_pair_claimed,
    )
    from orbitproof.explore.engines import Reporter

    with Reporter(options.quiet) as report:
        orbits = []
        for option, text, sign, half in wanted:
            ((name, number),) = values_by_name(option, [text]).items()
            start = exact_number(f"{option} {name}", number)
            try:
                setting = OnLevel(system, parameters, level, sign)
                if name != system.state[setting.along]:
                    raise InputError(f"{option} {name}: give the coordinate {system.state[setting.along]}")
                report.stage("periodic orbit")
                orbits.append(orbit := hyperbolic_orbit(setting, start, half, options.digits))
            except ConnectionFailure as error:
                report.error(f"{system.name}: {error}")
                return 1
            report.message(
                f"periodic orbit: {name} = {float(orbit.p):.15g}, period {orbit.period:.10g}, multiplier "
                f"{float(orbit.multiplier):.10g}; sampled from a = {orbit.first:.3g}"
            )
        sides, others = ((1, -1) if side is None else (side,) for side in (options.side, options.to_side))
        arrivals = options.arrivals or ()
        found: list[Any] = []
        report.stage("unstable manifold")
        if options.to is None:
            of_claim, is_old, kind = homoclinic_claim, is_claimed, "homoclinic"
            if reach is not None:
                of_claim = partial(homoclinic_curve_claim, level_radius=reach)
                is_old = _is_for_levels(reach, is_claimed)
            for side in sides:
                found += homoclinic_orbits(orbit, side, arrivals)
            print(f"{'a':>16}  crossings to Fix(R)")
            for each in found:
                print(f"{float(each.distance):16.8e}  {each.crossings}")
            most = orbit.crossings
        else:
            of_claim, is_old, kind = heteroclinic_claim, is_pair_claimed, "heteroclinic"
            for side, other in product(sides, others):
                found += heteroclinic_orbits(Branch(orbits[0], side), Branch(orbits[1], other), arrivals)
            print(f"{'a':>16}  {'a of the other':>16}  crossings between")
            for each in found:
                first, second = each.ends
                between = first.crossings + second.crossings
                print(f"{float(first.distance):16.8e}  {float(second.distance):16.8e}  {between}")
            most = sum(orbit.crossings for orbit in orbits)
        code, near = 0 if found else 1, options.near or _NEAR / max(abs(float(orbit.multiplier)) for orbit in orbits)
        if not found:
            end = "comes to Fix(R)" if options.to is None else "leads to the other one"
            where = "at these crossings" if arrivals else f"within {most} crossings"
            report.error(f"no orbit {end} {where}; ask for later ones (--arrivals)")
        if options.output is None:
            return code
        store, claimed = ClaimStore(options.output, kept, report), {each.id: each for each in kept}
        base = options.id or f"{system.name}-{kind}"
        try:
            for number, each in enumerate(found, start=1):
                label = base if len(found) == 1 else f"{base}-{number}"
                old = claimed.get(label)
                if old is None or not is_old(each, old):
                    store.add(label, partial(of_claim, each, label, near, options.digits))
        except KeyboardInterrupt:
            report.error("interrupted; the same command with --append goes on from the claims in the file")
            return INTERRUPTED
        finally:
            store.close()
    return code if store.complete else 1


def _is_for_levels(reach: Fraction, is_claimed: Callable[[Any, BoxClaim], bool]) -> Callable[[Any, BoxClaim], bool]:
    """Whether a claim is about an orbit and for so many levels."""

    def is_old(found: Any, claim: BoxClaim) -> bool:
        if not isinstance(claim, HomoclinicCurve) or claim.level_radius != reach:
            return False
        return is_claimed(found, claim.middle)

    return is_old
