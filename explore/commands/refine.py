"""``orbitproof explore refine``: from an approximate bifurcation point to a candidate with its box."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from orbitproof.explore.commands import common
from orbitproof.explore.names import label_of, place_of, short_name, system_named, varying_in
from orbitproof.explore.three_body.names import given_parameters, mass_name
from orbitproof.shared.formats import (
    ACROSS_KINDS,
    DOUBLE_RESONANCE,
    KINDS,
    InputError,
    check_writable,
    read_candidates,
    write_candidates,
)
from orbitproof.shared.help_text import add_command

_KINDS = (*KINDS, *ACROSS_KINDS, DOUBLE_RESONANCE)

_EXAMPLES = """\
examples:
  orbitproof explore refine --system mine.py -k 3 --point c=0.27634 y=0.52554 -o candidate.json
  orbitproof explore refine --system mine.py -k 4 --point c=0.22544 y=0.43305 --append -o candidate.json
  orbitproof explore refine --system mine.py -k 1 --kind fold --point c=1.26623 y=1.35911 -o fold.json
  orbitproof explore refine --system cr3bp --mass earth-moon -k 1 --kind reversor_breaking \\
      --point x=0.93 z=0.287 vy=0.0817 -o loss.json
  orbitproof explore refine --system cr3bp --mass earth-moon -k 1 --kind krein_collision \\
      --point x=0.92854 z=0.29456 vy=0.0818 -o collision.json
  orbitproof explore refine --system cr3bp -k 4 --kind double_resonance \\
      --point mu=0.003521 x=0.997118 z=0.02447 vy=0.50942 -o meeting.json
  orbitproof verify candidate.json -o certificate.json

The point has to be good to five digits or so. Exit codes: 0 refined, 1 not, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "refine", "refine an approximate bifurcation point to a candidate with its box", _EXAMPLES
    )
    common.add_system(parser)
    parser.add_argument("--mass", type=mass_name, metavar="MU", help="mass parameter of the CR3BP: a name or a number")
    parser.add_argument("-k", type=common.multiplicity, required=True, metavar="K", help="multiplicity")
    parser.add_argument(
        "--kind",
        choices=_KINDS,
        metavar="KIND",
        help=f"of the bifurcation: {', '.join(_KINDS)} (default: the generic one of that K)",
    )
    parser.add_argument(
        "--symmetry",
        metavar="NAME",
        help="the symmetry that breaks, for symmetry breaking, or that fixes the point, for period tupling with K = 3 "
        "(default: the only one)",
    )
    parser.add_argument(
        "--crossings",
        type=common.multiplicity,
        default=1,
        metavar="M",
        help="how often the half orbit, from Fix(R) to Fix(R), meets the section, its end included (default: 1)",
    )
    parser.add_argument(
        "--point",
        nargs="+",
        required=True,
        metavar="NAME=VALUE",
        help="the point on Fix(R): family parameter (where two resonances meet, that which varies) and coordinates",
    )
    parser.add_argument(
        "--digits", type=common.digits, default=50, metavar="N", help="decimal digits (default: %(default)s)"
    )
    parser.add_argument(
        "--radii",
        nargs="+",
        type=common.positive,
        metavar="R",
        help="half-widths of the box along p_0, p_1, ..: what a failed proof asks for (default: such as suit it)",
    )
    parser.add_argument("--id", metavar="NAME", help="of the candidate (default: system and K)")
    parser.add_argument(
        "--accept", action="store_true", help="take a point that is farther away than the digits of --point explain"
    )
    common.add_output(parser, "candidates file")
    parser.add_argument("--append", action="store_true", help="keep what the output file already holds")
    common.add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Refine and write; returns the exit code. Raises `InputError`."""
    if options.system is None:
        raise InputError("--system: missing; give a name or the file of your own system")
    check_writable(options.output)
    system = system_named(options.system)
    varying = varying_in(system, "--point", options.point) if options.kind == DOUBLE_RESONANCE else None
    parameters = given_parameters(system, options.mass, options.parameter, varying)
    place = place_of(system, "--point", options.point, complete=True, varying=varying)
    if options.radii is not None and len(options.radii) != len(place):
        count = len(place)
        raise InputError(f"--radii: {len(options.radii)} numbers; {system.name} needs {count}, for p_0, p_1, ..")
    label = label_of(system, options.mass, options.parameter) or system.name
    kept = read_candidates(options.output) if options.append and options.output.is_file() else []
    name = options.id or f"{label}-{short_name(options.kind, options.k)}"
    if any(candidate.id == name for candidate in kept):
        raise InputError(f"--id {name}: is in {options.output} already; choose another name")

    # Only now: JAX takes a moment to load.
    from orbitproof.explore.points import refine_at
    from orbitproof.explore.refinement import RefinementFailure

    try:
        found = refine_at(
            system,
            place,
            options.k,
            parameters=parameters,
            kind=options.kind,
            symmetry=options.symmetry,
            crossings=options.crossings,
            digits=options.digits,
            radii=options.radii,
            id=name,
            accept=options.accept,
            quiet=options.quiet,
        )
    except RefinementFailure as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    write_candidates(options.output, [*kept, found])
    if not options.quiet:
        print(f"{name} written to {options.output}", file=sys.stderr)
    return 0
