"""``orbitproof explore equilibria``: equilibria, their curves, Hopf points, and the orbits that are born there."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.commands import common
from orbitproof.explore.commands.periodic_claims import Along, ClaimStore, Passed, kept_claims
from orbitproof.explore.names import exact_number, given_values, own_system, start_values, symmetry_of
from orbitproof.shared.formats import InputError, check_writable, write_atlas, write_text
from orbitproof.shared.help_text import add_command
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.wording import counted

if TYPE_CHECKING:
    from orbitproof.explore.periodic import FoundEquilibrium, Hopf
    from orbitproof.shared.systems import System

_EXAMPLES = """\
examples:
  orbitproof explore equilibria --system lorenz.py --parameter sigma=10 rho=28 beta=8/3
      the equilibria that Newton's method finds from many starts, with their eigenvalues
  orbitproof explore equilibria --system lorenz.py --parameter sigma=10 rho=20 beta=8/3 --start x=7 y=7 z=19 \\
      --along rho 1 30 -o hopf.json
      the curve of one of them, its folds and Hopf points; the Hopf points as claims
  orbitproof explore equilibria --system lorenz.py --parameter sigma=10 rho=20 beta=8/3 --start x=7 y=7 z=19 \\
      --along rho 10 30 --cycles --life life.json -o claims.json
      also the periodic orbits that are born there, with the bifurcations that they pass
  orbitproof verify claims.json -o certificates.json
  orbitproof explore equilibria --system lorenz.py --parameter sigma=10 rho=20 beta=8/3 --start x=7 y=7 z=19 \\
      --along rho 10 30 --atlas curve.json
      the curve as pieces; then orbitproof verify atlas curve.json -o certificate.json
  orbitproof figures periodic life.json certificates.json -o figures-out/

The system's file needs neither R nor section.
Exit codes: 0 found, 1 something is not found or not refined, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    meaning = "equilibria of any system, their curves, folds and Hopf points, and the orbits that are born there"
    parser = add_command(commands, "equilibria", meaning, _EXAMPLES)
    parser.add_argument(
        "--system", required=True, metavar="NAME|FILE", help="a file of your own, .json, or .py, which is run; or cr3bp"
    )
    parser.add_argument(
        "--parameter", nargs="+", metavar="NAME=VALUE", help="all parameters of the vector field, exactly as written"
    )
    parser.add_argument(
        "--start",
        nargs="+",
        metavar="NAME=VALUE",
        help="near an equilibrium: all coordinates of the state (default: many starts are tried)",
    )
    parser.add_argument(
        "--along",
        nargs=3,
        metavar=("NAME", "MIN", "MAX"),
        help="continue the equilibrium of --start in a parameter, both ways until it leaves this interval; with -o the "
        "Hopf points that are met are refined",
    )
    parser.add_argument(
        "--cycles",
        action="store_true",
        help="with --along: follow the periodic orbits that are born at the Hopf points; with -o the bifurcations that "
        "they meet are refined too",
    )
    parser.add_argument(
        "--generations",
        type=common.generations,
        default=0,
        metavar="N",
        help="with --cycles: follow also the orbits that are born at period doublings and pitchforks, those that are "
        "born from these, and so on, N times (default: %(default)s)",
    )
    parser.add_argument(
        "--symmetry",
        metavar="IMAGE",
        help="with --cycles: a linear symmetry of the vector field, as for explore periodic",
    )
    parser.add_argument(
        "--claims",
        choices=("equilibria", "bifurcations", "all"),
        help="with --along: what -o writes (default: bifurcations, Hopf points among them)",
    )
    parser.add_argument(
        "--curve", type=Path, metavar="FILE", help="with --along: the points of the curve as a table, CSV"
    )
    parser.add_argument("--csv", type=Path, metavar="FILE", help="with --cycles: the orbits of each family as a table")
    parser.add_argument(
        "--life",
        type=Path,
        metavar="FILE",
        help="with --along: the curve and the families as one JSON file, for orbitproof figures periodic",
    )
    parser.add_argument(
        "--family-output", type=Path, metavar="FILE", help="with --cycles: the families as JSON, for orbitproof figures"
    )
    words = "with --along: the curve as pieces, through its folds, for orbitproof verify atlas"
    parser.add_argument("--atlas", type=Path, metavar="FILE", help=words)
    words = (
        "with --along: the orbits that are born at the Hopf point as pieces, from the equilibrium on, for orbitproof "
    )
    words += "verify atlas; of several Hopf points the further files are FILE-2, .."
    parser.add_argument("--births", type=Path, metavar="FILE", help=words)
    common.add_claim_output(parser, "what is found is printed")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Find, print, refine and write; returns the exit code. Raises `InputError`."""
    for path in (
        options.output,
        options.curve,
        options.csv,
        options.family_output,
        options.life,
        options.atlas,
        options.births,
    ):
        if path is not None:
            check_writable(path)
    system = own_system(options.system)
    parameters = given_values("--parameter", options.parameter or (), tuple(system.parameters))
    for name, value in parameters.items():
        if not system.parameters[name].contains(value):
            raise InputError(f"--parameter {name}={value}: outside {system.parameters[name]}; give a value inside")
    start = None
    if options.start is not None:
        start = tuple(map(float, start_values("--start", options.start, system).values()))
    along = _along(options, system, parameters)
    kept = kept_claims(options)

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.periodic import (
        PeriodicFailure,
        equilibrium_as_json,
        equilibrium_claim,
        equilibrium_described,
        find_equilibria,
    )

    found: list[FoundEquilibrium] = []
    claims = options.claims or ("equilibria" if along is None else "bifurcations")
    base, code = options.id or system.name, 0
    with Reporter(options.quiet) as report:
        report.stage(f"looking for equilibria of {system.name}")
        try:
            for each in find_equilibria(system, parameters, start, report.update):
                found.append(each)
                report.tell(equilibrium_described(each), equilibrium_as_json(each))
        except PeriodicFailure as failure:
            report.error(f"{system.name}: {failure}")
            return 1
        store = None if options.output is None else ClaimStore(options.output, kept, report)
        try:
            if store is not None and claims != "bifurcations":
                for number, each in enumerate(found, start=1):
                    name = f"{base}-equilibrium" + ("" if len(found) == 1 else f"-{number}")
                    store.add(
                        name,
                        lambda name=name, each=each: equilibrium_claim(
                            each.problem, each.equilibrium, name, options.digits, report.update
                        ),
                    )
            if along is not None:
                code = follow_curve(options, found[0], along, None if claims == "equilibria" else store, report)
        except KeyboardInterrupt:
            report.error("interrupted")
            code = INTERRUPTED
        if store is not None:
            store.close()
            code = max(code, 0 if store.complete else 1)
    return code


def follow_curve(
    options: argparse.Namespace,
    found: FoundEquilibrium,
    along: Along,
    store: ClaimStore | None,
    report: Any,
) -> int:
    """Follow the curve of an equilibrium, and with ``--cycles`` the orbits of its Hopf points; returns the exit code.

    Arguments:
        store: for claims about bifurcations; `None`: they are only told.

    Raises `InputError`.
    """
    from orbitproof.explore.periodic import (
        PeriodicFailure,
        continue_equilibrium,
        curve_as_json,
        curve_csv,
        curve_described,
        families_from,
        life_of,
        symmetries_for,
        write_life,
    )

    name, *bounds = along
    assert name is not None
    low, high = bounds
    system = found.problem.system
    report.stage(f"following the equilibrium in {name}")
    try:
        symmetries = symmetries_for(found.problem, options.symmetry, name)
        curve = continue_equilibrium(
            found.problem, found.equilibrium, name, (low, high), progress=lambda done: report.update("", done)
        )
    except PeriodicFailure as failure:
        report.error(f"{system.name}: {failure}")
        return 1
    except ValueError as error:
        raise InputError(f"--symmetry: {error}; give an involution that the vector field respects") from None
    report.tell(curve_described(curve), curve_as_json(curve))
    if getattr(options, "curve", None) is not None:
        write_text(options.curve, curve_csv(curve))
        report.message(f"{len(curve.members)} points are in {options.curve}")
    if curve.interrupted:
        report.error("interrupted; the curve so far is kept")
        return INTERRUPTED
    code = 0
    # Of explore periodic it is the curve of an orbit.
    if hasattr(options, "cycles") and options.atlas is not None:
        code = _cover(options, found, name, (low, high), report)
    if getattr(options, "births", None) is not None:
        code = max(code, _cover_births(options, curve.hopf, (low, high), report))
    passed = Passed(options.id or system.name, options, store, report)
    for point in curve.hopf:
        passed.take_hopf(point)
    # Of explore periodic orbits are what is looked for.
    if getattr(options, "cycles", True):
        families = families_from(curve.hopf, (low, high), options.generations, None, passed.say, symmetries)
        code = max(code, passed.take(families))
        if code != INTERRUPTED and not passed.families:
            report.error(f"no orbits are born at a Hopf point of {system.name} on the way")
            code = 1
    if getattr(options, "life", None) is not None:
        write_life(options.life, life_of(curve, passed.families))
        report.message(f"the whole life is in {options.life}")
    if code == 0 and store is not None and not passed.claimed:
        report.error(f"no Hopf point on the way; none is in {store.path}")
        code = 1
    return code


def _cover(
    options: argparse.Namespace, found: FoundEquilibrium, name: str, bounds: tuple[float, float], report: Any
) -> int:
    """The curve of an equilibrium, written as an atlas; 1 if it does not go as far as asked for."""
    from orbitproof.explore.periodic import PeriodicFailure, cover_equilibria

    report.stage(f"covering the curve in {name}")
    base = options.id or f"{found.problem.system.name}-equilibria"
    try:
        covered = cover_equilibria(found, name, bounds, base, progress=lambda text: report.update(text, None))
    except PeriodicFailure as failure:
        report.error(f"{found.problem.system.name}: no atlas: {failure}")
        return 1
    write_atlas(options.atlas, covered.atlas)
    pieces = counted(len(covered.atlas.pieces), "piece")
    report.message(f"{pieces} are in {options.atlas}; ends: {'; '.join(covered.ends)}")
    return 0 if covered.reaches else 1


def _cover_births(options: argparse.Namespace, points: Sequence[Hopf], bounds: tuple[float, float], report: Any) -> int:
    """The orbits that are born at Hopf points, each written as an atlas; 1 if there are none, or none are covered."""
    from orbitproof.explore.periodic import PeriodicFailure, cover_birth

    code = 0 if points else 1
    if not points:
        report.error("no Hopf point on the way; no orbits are born")
    for number, hopf in enumerate(points, start=1):
        path = options.births if number == 1 else options.births.with_stem(f"{options.births.stem}-{number}")
        report.stage(f"covering the orbits born at {hopf.name} = {hopf.value:.10g}")
        base = (options.id or f"{hopf.problem.system.name}-birth") + (f"-{number}" if number > 1 else "")
        try:
            covered = cover_birth(hopf, bounds, base, progress=lambda text: report.update(text, None))
        except PeriodicFailure as failure:
            report.error(f"{hopf.problem.system.name}: no atlas of the orbits born there: {failure}")
            code = 1
            continue
        write_atlas(path, covered.atlas)
        report.message(f"{counted(len(covered.atlas.pieces), 'piece')} are in {path}; ends: {'; '.join(covered.ends)}")
    return code


def _along(options: argparse.Namespace, system: System, parameters: Mapping[str, Fraction]) -> Along | None:
    """The parameter and the interval of ``--along``. Raises `InputError`."""
    of_cycles = {
        "--csv": options.csv,
        "--family-output": options.family_output,
        "--generations": options.generations,
        "--symmetry": options.symmetry,
    }
    for option, given in of_cycles.items():
        if given and not options.cycles:
            raise InputError(f"{option}: belongs to --cycles; give that too")
    of_curves = {
        "--cycles": options.cycles,
        "--curve": options.curve,
        "--life": options.life,
        "--atlas": options.atlas,
        "--births": options.births,
        "--claims": options.claims,
    }
    for option, given in of_curves.items():
        if given and options.along is None:
            raise InputError(f"{option}: belongs to --along; give that too")
    if options.along is None:
        return None
    name, *ends = options.along
    low, high = (float(exact_number(f"--along {name}", text)) for text in ends)
    if not low < high:
        raise InputError(f"--along {name}: an empty interval; give the smaller value first")
    if name not in system.parameters:
        known = ", ".join(system.parameters) or "none"
        raise InputError(f"--along {name}: {system.name} has no such parameter; there are {known}")
    if not low <= float(parameters[name]) <= high:
        raise InputError(
            f"--along {name}: {parameters[name]}, where the equilibrium is, lies outside; widen the interval"
        )
    if options.start is None:
        raise InputError("--start: missing; with --along give the coordinates of the equilibrium to follow")
    if options.symmetry is not None:
        options.symmetry = symmetry_of(system, options.symmetry)
    return name, low, high
