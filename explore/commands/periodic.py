"""``orbitproof explore periodic``: periodic orbits of any system, without symmetry, as claims for the verifier."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands import common
from orbitproof.explore.commands.periodic_atlas import cover
from orbitproof.explore.commands.periodic_branches import take_from_branches
from orbitproof.explore.commands.periodic_claims import (
    Along,
    ClaimStore,
    follow_families,
    kept_claims,
    refine_orbits,
)
from orbitproof.explore.names import (
    exact_number,
    given_values,
    own_system,
    section_of,
    start_values,
    symmetry_of,
    varied,
)
from orbitproof.explore.three_body.names import mass_name, mass_parameter
from orbitproof.explore.three_body.seeds import TRIANGULAR
from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.systems import CR3BP, System

if TYPE_CHECKING:
    from orbitproof.explore.periodic import FoundOrbit, PeriodicRequest

_EXAMPLES = """\
examples:
  orbitproof explore periodic --system lorenz.py --parameter sigma=10 rho=28 beta=8/3 --start x=1 y=2 z=20
      follow the orbit of the start until it nearly repeats, and print the periodic orbit
  orbitproof explore periodic --system lorenz.py --parameter sigma=10 rho=28 beta=8/3 --start x=1 y=2 z=20 \\
      --section z=27 --direction - --returns 4 -o lorenz.json
      all orbits that are found with up to 4 crossings of a section of your own, as claims
  orbitproof explore periodic --system mine.json --parameter mu=1 --start x=1 y=0 --period 6.28 -o orbit.json
      from a guess of a point and the period
  orbitproof explore periodic --system roessler.py --parameter a=1/5 b=1/5 c=5/2 --start x=3 y=0 z=0 --transient 300 \\
      --along c 1 4 --csv family.csv --family-output family.json
      its family in the parameter c, with folds, branch points, period doublings and Neimark-Sacker points
  orbitproof explore periodic --system roessler.py --parameter a=1/5 b=1/5 c=5/2 --start x=3 y=0 z=0 --transient 300 \\
      --along c 5/2 21/5 --generations 2 -o doublings.json
      the first three doublings of its cascade, as claims
  orbitproof explore periodic --system lorenz.py --parameter sigma=10 rho=28 beta=8/3 --start x=1 y=2 z=20 \\
      --section z=27 --direction - --returns 2 --along rho 27 29 --atlas curve.json
      its curve in rho as pieces; then orbitproof verify atlas curve.json -o certificate.json
  orbitproof explore periodic --system cr3bp --parameter mu=1.215058560962404e-2 --triangular L4-long -o l4.json
      an orbit of the long-period family of L4
  orbitproof explore periodic --from-branches branches.json --orbits 10 30 -o new-orbits.json
      orbits that explore branches found where a reversor is lost, which it does not map to themselves
  orbitproof verify lorenz.json -o certificates.json

The system's file needs neither R nor section. For a system with a first integral the orbits on one level are looked
for. Exit codes: 0 found, 1 something is not found or not refined, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    meaning = "periodic orbits of any system, no symmetry needed: found, and to many digits for the verifier"
    parser = add_command(commands, "periodic", meaning, _EXAMPLES)
    parser.add_argument(
        "--system", metavar="NAME|FILE", help="a file of your own, .json, or .py, which is run; or cr3bp"
    )
    parser.add_argument(
        "--parameter", nargs="+", metavar="NAME=VALUE", help="all parameters of the vector field, exactly as written"
    )
    words = "mass parameter of the CR3BP, a name or a number, in place of --parameter mu=.."
    parser.add_argument("--mass", type=mass_name, metavar="MU", help=words)
    begin = parser.add_mutually_exclusive_group(required=True)
    begin.add_argument("--start", nargs="+", metavar="NAME=VALUE", help="where to begin: all coordinates of the state")
    begin.add_argument(
        "--triangular",
        choices=TRIANGULAR,
        metavar="FAMILY",
        help=f"of cr3bp: a small orbit about a triangular point, of the family {', '.join(TRIANGULAR)}",
    )
    begin.add_argument(
        "--from-branches",
        type=Path,
        metavar="FILE",
        help="orbits that R does not map to themselves, from a branch file",
    )
    words = "with --from-branches: these points only (with * and ? as in file names)"
    parser.add_argument("--only", nargs="+", metavar="ID", help=words)
    parser.add_argument(
        "--orbits",
        nargs="+",
        type=int,
        metavar="N",
        help="with --from-branches: these of each branch, 1 the first from the birth, -1 that on the other side "
        "(default: the last)",
    )
    parser.add_argument("--period", type=common.positive, metavar="T", help="near the period: Newton's method at once")
    parser.add_argument(
        "--section", metavar="EXPRESSION", help="for example z=27 or x+2*y=1/2 (default: one that suits the orbit)"
    )
    parser.add_argument(
        "--direction", choices=("+", "-"), help="crossings at which the left side grows or falls (default: +)"
    )
    parser.add_argument("--level", metavar="H", help="value of the first integral (default: that of the start)")
    parser.add_argument(
        "--returns",
        type=common.index,
        default=1,
        metavar="M",
        help="look for orbits with up to so many crossings of the section (default: %(default)s)",
    )
    parser.add_argument(
        "--follow", type=common.positive, default=100.0, metavar="T", help="for how long (default: %(default)s)"
    )
    parser.add_argument("--transient", type=common.positive, metavar="T", help="time to leave out before that")
    parser.add_argument(
        "--along",
        nargs=3,
        metavar=("NAME", "MIN", "MAX"),
        help="continue the first orbit in a parameter, or over the levels of the first integral (NAME: level), both "
        "ways until it leaves this interval; with -o the bifurcations that are met are refined; an orbit that comes to "
        "rest leads to the equilibrium, its Hopf points, and the orbits that are born there",
    )
    parser.add_argument(
        "--generations",
        type=common.generations,
        default=0,
        metavar="N",
        help="with --along: follow also the orbits that are born at period doublings and pitchforks, those that are "
        "born from these, and so on, N times (default: %(default)s)",
    )
    parser.add_argument(
        "--symmetry",
        metavar="IMAGE",
        help="with --along: a linear symmetry of the vector field, for pitchforks, as the image of the state, for "
        "example --symmetry=-x,-y,z (default: changes of sign and exchanges of coordinates are tried)",
    )
    parser.add_argument(
        "--claims",
        choices=("orbits", "bifurcations", "all"),
        help="with --along: what -o writes (default: bifurcations)",
    )
    parser.add_argument("--csv", type=Path, metavar="FILE", help="with --along: the orbits of the family as a table")
    parser.add_argument(
        "--family-output", type=Path, metavar="FILE", help="with --along: the family as JSON, for orbitproof figures"
    )
    words = "with --along: the curve of the first orbit as pieces, through its folds, for orbitproof verify atlas"
    parser.add_argument("--atlas", type=Path, metavar="FILE", help=words)
    common.add_claim_output(parser, "orbits are printed only")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Find, print, refine and write; returns the exit code. Raises `InputError`."""
    if options.output is not None:
        check_writable(options.output)
    if options.from_branches is not None:
        return take_from_branches(options)
    for option, given in (("--only", options.only), ("--orbits", options.orbits)):
        if given is not None:
            raise InputError(f"{option}: belongs to --from-branches; give that too")
    if options.system is None:
        options.system = None if options.mass is None else CR3BP.name
    if options.system is None:
        raise InputError("--system: missing; give a name or the file of your own system")
    system = own_system(options.system)
    if options.mass is not None and "mu" not in system.parameters:
        raise InputError(f"--mass {options.mass}: {system.name} has no mass parameter; leave it out")
    mass = [] if options.mass is None else [f"mu={mass_parameter('--mass', options.mass)}"]
    parameters = given_values("--parameter", [*mass, *(options.parameter or ())], tuple(system.parameters))
    for name, value in parameters.items():
        if not system.parameters[name].contains(value):
            raise InputError(f"--parameter {name}={value}: outside {system.parameters[name]}; give a value inside")
    start, period = _start(options, system, parameters)
    section = section_of(system, options.section, options.direction)
    along = _along(options, system, parameters)
    if options.level is not None and system.first_integral_program is None:
        raise InputError(f"--level: {system.name} has no first integral; leave it out")
    level = None if options.level is None else exact_number("--level", options.level)
    kept = kept_claims(options)

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.periodic import (
        AffineSection,
        AtRest,
        PeriodicFailure,
        PeriodicRequest,
        described,
        find_periodic,
        orbit_as_json,
        remarks,
    )

    request = PeriodicRequest(
        system,
        parameters,
        start,
        period,
        None if section is None else AffineSection(*section),
        level,
        options.returns,
        options.transient or 0.0,
        options.follow,
    )
    orbits: list[FoundOrbit] = []
    at_rest = None
    claims = options.claims or ("orbits" if along is None else "bifurcations")
    code = 0
    with Reporter(options.quiet) as report:
        report.stage(f"looking for periodic orbits of {system.name}")
        try:
            for orbit in find_periodic(request, report.update):
                for remark in remarks(request, orbit):
                    report.message(remark)
                orbits.append(orbit)
                report.tell(described(orbit), orbit_as_json(orbit))
        except AtRest as failure:
            if along is None or along[0] is None:
                report.error(f"{system.name}: {failure}")
                return 1
            at_rest = failure.point
        except PeriodicFailure as failure:
            report.error(f"{system.name}: {failure}")
            return 1
        store = None if options.output is None else ClaimStore(options.output, kept, report)
        wanted = None if claims == "orbits" else store
        try:
            if store is not None and claims != "bifurcations" and orbits:
                refine_orbits(options, orbits, store, report)
            if at_rest is not None and along is not None:
                code = _from_equilibrium(options, request, at_rest, along, wanted, report)
            elif along is not None:
                code = follow_families(options, orbits[0], along, wanted, report)
                if options.atlas is not None and code != INTERRUPTED:
                    code = max(code, cover(options, orbits[0], along, report))
        except KeyboardInterrupt:
            report.error("interrupted")
            code = INTERRUPTED
        if store is not None:
            store.close()
            code = max(code, 0 if store.complete else 1)
    return code


def _from_equilibrium(
    options: argparse.Namespace,
    request: PeriodicRequest,
    point: Sequence[float],
    along: Along,
    store: ClaimStore | None,
    report: Any,
) -> int:
    """Where the orbit came to rest, follow the equilibrium, and the orbits of its Hopf points; the exit code."""
    from orbitproof.explore.commands.equilibria import follow_curve
    from orbitproof.explore.periodic import (
        PeriodicFailure,
        equilibrium_as_json,
        equilibrium_described,
        find_equilibria,
    )

    report.message(f"{request.system.name}: the orbit comes to rest; its equilibrium is followed")
    if options.atlas is not None:
        report.error("--atlas: there is no orbit to begin with; nothing is written there")
    try:
        (found,) = find_equilibria(request.system, request.parameters, tuple(map(float, point)), report.update)
    except PeriodicFailure as failure:
        report.error(f"{request.system.name}: {failure}")
        return 1
    report.tell(equilibrium_described(found), equilibrium_as_json(found))
    return max(follow_curve(options, found, along, store, report), int(options.atlas is not None))


def _start(
    options: argparse.Namespace, system: System, parameters: Mapping[str, Fraction]
) -> tuple[tuple[float, ...], float | None]:
    """Where to begin, and the period near that, if it is known. Raises `InputError`."""
    if options.triangular is None:
        given = start_values("--start", options.start, system)
        return tuple(map(float, given.values())), options.period
    if system is not CR3BP:
        raise InputError(f"--triangular: {system.name} is not cr3bp; give --start")
    from orbitproof.explore.three_body.seeds import triangular_orbit

    try:
        found, period = triangular_orbit(float(parameters["mu"]), options.triangular)
    except ValueError as error:
        raise InputError(f"--triangular: {error}") from None
    return tuple(found[name] for name in system.state), options.period or period


def _along(options: argparse.Namespace, system: System, parameters: Mapping[str, Fraction]) -> Along | None:
    """The parameter (`None`: the level) and the interval of ``--along``. Raises `InputError`."""
    outputs = {"--csv": options.csv, "--family-output": options.family_output, "--atlas": options.atlas}
    for option, path in outputs.items():
        if path is not None:
            if options.along is None:
                raise InputError(f"{option}: belongs to --along; give that too")
            check_writable(path)
    if options.along is None:
        for option, given in (
            ("--generations", options.generations), ("--symmetry", options.symmetry), ("--claims", options.claims)
        ):  # fmt: skip
            if given:
                raise InputError(f"{option}: belongs to --along; give that too")
        return None
    if options.symmetry is not None:
        options.symmetry = symmetry_of(system, options.symmetry)
    name, *ends = options.along
    low, high = (float(exact_number(f"--along {name}", text)) for text in ends)
    if not low < high:
        raise InputError(f"--along {name}: an empty interval; give the smaller value first")
    try:
        parameter = varied(system, name)
    except LookupError as error:
        raise InputError(f"--along {name}: {error}") from None
    if parameter is not None and not low <= float(parameters[parameter]) <= high:
        raise InputError(
            f"--along {name}: {parameters[name]}, where the first orbit is, lies outside; widen the interval"
        )
    return parameter, low, high
