"""The command line's options."""

from __future__ import annotations

import argparse
from pathlib import Path

from orbitproof.explore.commands import (
    atlas,
    atlas_libration,
    atlas_mass,
    branches,
    catalogue,
    common,
    connections,
    ephemeris,
    equilibria,
    invariants,
    losses,
    mass_curve,
    orbit,
    periodic,
    portraits,
    refine,
    trajectory,
)
from orbitproof.explore.families import CONTROL, SAMPLING_TIMEOUT
from orbitproof.explore.search import POINTS, PRESETS
from orbitproof.explore.three_body.names import FAMILY_NAMES, family_name, mass_name
from orbitproof.shared.answers import add_json_option
from orbitproof.shared.help_text import HelpFormatter, Parser, add_command
from orbitproof.shared.systems import MASS_PARAMETERS

_FOLDS = "also look for folds: extrema of the family parameter or first integral along the family"

_EXAMPLES = """\
examples:
  orbitproof explore candidates --preset tables -o tables.json --family-output families.json
  orbitproof explore candidates --preset tables -k 5 6 --from-family families.json --append -o tables.json
  orbitproof explore candidates --system cr3bp --mass earth-moon --family L1-halo -k 1 2 3 4 --z-max 0.25 -o c.json
  orbitproof explore candidates --system falkner-skan -k 2 3 4 --append -o c.json
  orbitproof explore family --system cr3bp --mass 0.01 --family L2-halo --z-max 0.1 -o family.json
  orbitproof explore candidates --from-family family.json -k 3 --z-max 0.15 -o more.json
  orbitproof explore family --system cr3bp --mass 0.1 --family L1-lyapunov L1-vertical --branches -o families.json
  orbitproof explore family --system cr3bp --mass earth-moon --family L2-halo -o f.json --csv f.csv
  orbitproof explore family --from-catalogue halo.json --catalogue-orbit 700 -o family.json
  orbitproof explore family --from-orbit branches.json --id earth-moon-L1-halo-k2-1 --orbit 5 -o family.json
  orbitproof explore candidates --system mine.py --start c=0.1 y=0.2 --parameter-max c 1.3 -k 2 3 4 -o c.json
  orbitproof explore family --system falkner-skan --beta-min 1.001 --beta-max 100000 -o family.json
"""

_MASS_HELP = (
    "mass parameter of the CR3BP, the smaller mass over the total: a name ("
    + ", ".join(MASS_PARAMETERS)
    + "; the first two as in the paper, exact IEEE doubles, the others as in the periodic orbit catalogue) or a number "
    "in (0, 1/2], taken exactly as written: decimal (0.01215 is the fraction 1215/100000, not the nearest double) or "
    "hexadecimal (0x18e267d713713fp-59)"
)


def parser() -> Parser:
    """The parser of ``orbitproof explore``."""
    result = Parser(
        prog="orbitproof explore",
        description="Find bifurcations of symmetric periodic orbits in reversible systems: follow families, detect "
        "1:k resonances, refine them and write boxes for the verifier. Nothing here is rigorous.",
        epilog=_EXAMPLES,
        formatter_class=HelpFormatter,
        allow_abbrev=False,
    )
    commands = result.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    candidates = add_command(
        commands, "candidates", "find and refine bifurcations, write candidate boxes", _examples("candidates")
    )
    _family_options(candidates)
    candidates.add_argument(
        "-k",
        nargs="+",
        type=common.multiplicity,
        metavar="K",
        help="multiplicities: 1 symmetry breaking, k > 1 the 1:k resonances (default: 2 3 4, or the preset's; "
        "with --folds none)",
    )
    candidates.add_argument("--folds", action="store_true", help=_FOLDS)
    candidates.add_argument(
        "--digits",
        type=common.digits,
        default=50,
        metavar="N",
        help="decimal digits of the refined points (default: %(default)s)",
    )
    candidates.add_argument(
        "--points",
        choices=POINTS,
        help="an orbit meets Fix(R) in two points, and new orbits may appear near both. one: a candidate for the "
        "first; distinct: for both where the new orbits differ (even k >= 4); all: always for both (default: one, "
        "or the preset's)",
    )
    common.add_output(candidates, "candidates file")
    candidates.add_argument(
        "--append",
        action="store_true",
        help="keep what the output file already holds; points refined there to as many digits are not refined again",
    )
    candidates.add_argument("--family-output", type=Path, metavar="FILE", help="write the traced families as JSON")
    family = add_command(commands, "family", "trace families and their resonances in float64", _examples("family"))
    _family_options(family)
    family.add_argument("-k", nargs="+", type=common.multiplicity, metavar="K", help="also locate these resonances")
    family.add_argument("--folds", action="store_true", help=_FOLDS)
    common.add_output(family, "family file")
    family.add_argument(
        "--csv",
        type=Path,
        metavar="FILE",
        help="CR3BP: write the orbits with the columns of the JPL three-body periodic orbit catalogue; of several "
        "families each into a file of its own, its name put in front of the extension; with "
        "--from-catalogue all corrected orbits of that file",
    )
    family.add_argument(
        "--catalogue", type=Path, metavar="FILE", help="the same as JSON, like a response of the catalogue's interface"
    )
    for command in (
        catalogue,
        orbit,
        periodic,
        equilibria,
        connections,
        losses,
        refine,
        branches,
        mass_curve,
        portraits,
        trajectory,
        ephemeris,
        invariants,
        atlas,
        atlas_libration,
        atlas_mass,
    ):
        command.add_parser(commands)
    for command_parser in commands.choices.values():
        add_json_option(command_parser)
    return result


def _examples(command: str) -> str:
    """The examples that call one command."""
    lines = _EXAMPLES.splitlines(keepends=True)
    return lines[0] + "".join(line for line in lines if f" {command} " in line)


def _family_options(target: argparse.ArgumentParser) -> None:
    families = "; ".join(f"{system}: {', '.join(names)}" for system, names in FAMILY_NAMES.items())
    common.add_start(target)
    target.add_argument("--mass", type=mass_name, nargs="+", metavar="MU", help=_MASS_HELP)
    meanings = "; ".join(f"{name}: {preset.meaning}" for name, preset in PRESETS.items())
    target.add_argument(
        "--preset", choices=tuple(PRESETS), help=f"in place of --system, --mass, --family and --vy-max: {meanings}"
    )
    target.add_argument(
        "--family",
        nargs="+",
        type=family_name,
        metavar="NAME",
        help=f"families to trace ({families}; in any case, with aliases such as nrho, distant-retrograde, 3:1), or "
        "what to call the one of --start; L1-halo-2, L1-halo-3, .. branch off at the next symmetry breakings of "
        "L1-lyapunov, the same for L2 and L3; resonant-P-Q goes round the larger primary P times in Q turns of "
        "the smaller one, resonant-P-Q-near in the phase that comes closer to that",
    )
    target.add_argument(
        "--from-family",
        type=Path,
        metavar="FILE",
        help="start from the families in a family file and continue them up to the limits, instead of from their "
        "birth; families that are asked for and are not in the file are traced too",
    )
    target.add_argument(
        "--from-catalogue",
        type=Path,
        metavar="FILE",
        help="start from a file of the JPL three-body periodic orbit catalogue, its JSON or CSV: every orbit is "
        "corrected and compared with the file, and the family is traced both ways from one of them",
    )
    target.add_argument(
        "--catalogue-orbit",
        type=common.index,
        metavar="N",
        help="the orbit of that file, counted from 1, from which the family is traced (default: the middle one)",
    )
    target.add_argument(
        "--from-orbit",
        type=Path,
        metavar="FILE",
        help="the family of one orbit of a file: of a branch (which becomes a family), candidates, certificates, an "
        "atlas, tori, ..; --family says what to call it",
    )
    target.add_argument(
        "--id", metavar="ID", help="with --from-orbit: the branch, candidate or certificate, or the family of a file"
    )
    target.add_argument(
        "--orbit",
        type=common.place,
        metavar="N",
        help="with --from-orbit: which, counted from 1; of a branch from its birth, -1, -2, .. on its other side",
    )
    common.add_accept(target)
    common.add_branch(target)
    target.add_argument(
        "--branches",
        action="store_true",
        help="also trace the families that branch off where the symmetry S of a planar family breaks",
    )
    limits = target.add_argument_group("limits, each optional; a family ends with the first orbit beyond one")
    limits.add_argument("--max-orbits", type=common.count, default=1000, metavar="N", help="default: %(default)s")
    for end, meaning in (("min", "smallest"), ("max", "largest")):
        limits.add_argument(
            f"--parameter-{end}",
            nargs=2,
            action="append",
            metavar=("NAME", "VALUE"),
            help=f"{meaning} value of the family parameter, a coordinate on Fix(R), half-period or integral",
        )
    limits.add_argument("--z-max", type=common.positive, metavar="Z", help="CR3BP: largest |z| of the first point")
    limits.add_argument(
        "--vy-max",
        nargs="+",
        type=common.positive,
        metavar="V",
        help="CR3BP: largest |vy| of the first point, one value or one for each mass",
    )
    limits.add_argument("--jacobi-min", type=common.number, metavar="C", help="CR3BP: smallest Jacobi constant")
    limits.add_argument(
        "--min-distance",
        type=common.positive,
        metavar="R",
        help="CR3BP: smallest distance to a primary (default: 1e-5, or 1e-4 (MU/3)^(1/3) where that is less)",
    )
    limits.add_argument("--beta-min", type=common.number, default=100.0, metavar="B", help="default: %(default)s")
    limits.add_argument("--beta-max", type=common.number, default=1000.0, metavar="B", help="default: %(default)s")
    steps = target.add_argument_group(
        "steps along a family, in arclength: coordinates in units of the distance of the libration point from the "
        "nearest primary (beta: of 1000), time as it is"
    )
    for name, value, meaning in (
        ("initial", CONTROL.initial, "first step"),
        ("min", CONTROL.minimum, "step at which a family that cannot be continued is given up"),
        ("max", CONTROL.maximum, "longest step; it grows with the coordinates where they are large"),
    ):
        steps.add_argument(
            f"--step-{name}",
            type=common.positive,
            default=value,
            metavar="H",
            help=f"{meaning} (default: %(default)s)",
        )
    steps.add_argument(
        "--turning",
        type=common.positive,
        default=CONTROL.turning,
        metavar="A",
        help="largest angle in radians by which a family may turn in a step (default: %(default)s)",
    )
    steps.add_argument(
        "--tolerance",
        type=common.positive,
        default=CONTROL.tolerance,
        metavar="E",
        help="length of the last Newton step, in the same units, at which an orbit is found (default: %(default)s)",
    )
    steps.add_argument(
        "--until-tangency",
        action="store_true",
        help="end a family where an orbit touches the section and the number of its crossings changes",
    )
    target.add_argument(
        "--sampling-timeout",
        type=common.positive,
        default=SAMPLING_TIMEOUT,
        metavar="S",
        help="seconds after which the stability of a family is not sampled further for resonances; what was found is "
        "kept (default: %(default)s)",
    )
    common.add_jobs(target, ": families traced and points refined at the same time")
    common.add_quiet(target)
