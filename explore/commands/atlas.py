"""``orbitproof explore atlas``: whole branches of symmetric orbits, in pieces for the verifier."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orbitproof.explore.atlases import Source, check_names
from orbitproof.explore.commands import common
from orbitproof.explore.names import exact_number, system_named
from orbitproof.explore.three_body.names import (
    FAMILY_NAMES,
    families_to_give,
    family_name,
    given_parameters,
    has_branches,
    is_family_name,
    mass_name,
    system_with,
)
from orbitproof.shared.formats import Covers, InputError, check_writable
from orbitproof.shared.help_text import add_command
from orbitproof.shared.systems import SYSTEMS, ReversibleSystem

DEGREES = (8, 60)
DECAYS = (1e-15, 1e-6)
TUBES = (1e-13, 1e-3)
OVERLAPS = (0.01, 0.5)


@dataclass(frozen=True)
class AtlasPreset:
    """A curve of the paper.

    Attributes:
        system, mass, family: as on the command line; "" for a system without masses.
        covers: coordinate, from and to of an arc, or `None`.
        increasing: coordinates claimed to increase.
        title: for the atlas.
        birth: whether the arc ends at the doubling from which its orbits are born.
        tube, decay: the defaults of --tube and --decay.
    """

    system: str
    mass: str
    family: str
    covers: tuple[str, str, str] | None
    increasing: tuple[str, ...]
    title: str
    birth: bool = False
    tube: float = 1e-9
    decay: float = 1e-13


ATLAS_PRESETS = {
    "falkner-skan": AtlasPreset(
        "falkner-skan",
        "",
        "odd",
        ("beta", "1.125", "100000"),
        ("beta",),
        "Symmetric periodic orbits of the Falkner-Skan equation for 9/8 <= beta <= 100000",
    ),
    "l1-circle-earth-moon": AtlasPreset(
        "cr3bp", "earth-moon", "L1-halo", None, (), "The loop of L1 halo orbits of the Earth-Moon system"
    ),
    "l1-circle-sun-jupiter": AtlasPreset(
        "cr3bp", "sun-jupiter", "L1-halo", None, (), "The loop of L1 halo orbits of the Sun-Jupiter system"
    ),
    "l2-arc-earth-moon": AtlasPreset(
        "cr3bp",
        "earth-moon",
        "L2-halo",
        ("vy", "0", "20.5"),
        ("vy",),
        "Southern L2 halo orbits of the Earth-Moon system up to vy = 20.5",
    ),
    "l2-arc-sun-jupiter": AtlasPreset(
        "cr3bp",
        "sun-jupiter",
        "L2-halo",
        ("vy", "0", "8"),
        ("vy",),
        "Southern L2 halo orbits of the Sun-Jupiter system up to vy = 8",
    ),
    "l3-halo-earth-moon": AtlasPreset(
        "cr3bp",
        "earth-moon",
        "L3-halo",
        ("x", "-1", "-0.02"),
        ("x",),
        "Southern L3 halo orbits of the Earth-Moon system from their birth to x = -0.02",
        tube=1e-8,
        decay=1e-15,
    ),
    "l3-halo-sun-jupiter": AtlasPreset(
        "cr3bp",
        "sun-jupiter",
        "L3-halo",
        ("x", "-1", "-0.02"),
        ("x",),
        "Southern L3 halo orbits of the Sun-Jupiter system from their birth to x = -0.02",
        tube=1e-8,
        decay=1e-15,
    ),
    **{
        f"axial-{point.lower()}-{mass}": AtlasPreset(
            "cr3bp-axial",
            mass,
            f"{point}-axial",
            ("vz", "0", reach),
            ("vz",),
            f"{point} axial orbits of the {name} system from their birth to vz = {reach}",
        )
        for point, mass, name, reach in (
            ("L1", "earth-moon", "Earth-Moon", "0.4"),
            ("L2", "earth-moon", "Earth-Moon", "0.5"),
            ("L1", "sun-jupiter", "Sun-Jupiter", "0.165"),
            ("L2", "sun-jupiter", "Sun-Jupiter", "0.205"),
        )
    },
    "dro-earth-moon": AtlasPreset(
        "cr3bp-planar",
        "earth-moon",
        "dro",
        ("x", "1.008", "1.788"),
        ("x",),
        "Distant retrograde orbits of the Moon, from 0.02 to 0.8 from it",
    ),
    **{
        f"butterfly-{mass}": AtlasPreset(
            "cr3bp",
            mass,
            "L2-butterfly",
            ("x", low, high),
            ("x",),
            f"Southern L2 butterfly orbits of the {name} system from x = {low} to their birth at a period doubling",
            True,
        )
        for mass, name, low, high in (
            ("earth-moon", "Earth-Moon", "0.925", "1"),
            ("sun-jupiter", "Sun-Jupiter", "0.985", "1.1"),
        )
    },
    "dro-sun-jupiter": AtlasPreset(
        "cr3bp-planar",
        "sun-jupiter",
        "dro",
        ("x", "1.008", "1.8"),
        ("x",),
        "Distant retrograde orbits of Jupiter, from 0.009 to 0.8 from it",
    ),
}

_EXAMPLES = """\
examples:
  orbitproof explore atlas --preset l1-circle-earth-moon -o l1.json
  orbitproof explore atlas --system cr3bp --mass 0.01 --family L2-halo --covers vy 0 5 --increasing vy -o l2.json
  orbitproof explore atlas --system falkner-skan --covers beta 2 1000 -o fs.json
  orbitproof explore atlas --from-family family.json --family L1-halo-2 -o branch.json
  orbitproof explore atlas --check l1.json

A family that starts at a symmetry breaking becomes a symmetric arc, or a symmetric loop if it ends at another one;
any other becomes an arc. Nothing here is rigorous: orbitproof verify atlas proves the pieces and that they are one
curve. Exit codes: 0 covered, 1 not, 2 bad input.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(
        commands, "atlas", "cover a whole branch of symmetric orbits by pieces for the verifier", _EXAMPLES
    )
    presets = "; ".join(f"{name}: {preset.title}" for name, preset in ATLAS_PRESETS.items())
    words = f"in place of the next options: {presets}"
    parser.add_argument("--preset", choices=tuple(ATLAS_PRESETS), metavar="NAME", help=words)
    common.add_system(parser)
    parser.add_argument(
        "--mass", type=mass_name, metavar="MU", help="mass parameter of the CR3BP: a name or a number, taken exactly"
    )
    parser.add_argument("--family", type=family_name, metavar="NAME", help="the family, as for explore family")
    common.add_branch(parser)
    parser.add_argument(
        "--from-family",
        type=Path,
        metavar="FILE",
        help="a family from a family file (any that explore family writes) instead of one traced here; --family and "
        "--mass choose among several",
    )
    parser.add_argument(
        "--covers",
        nargs=3,
        metavar=("NAME", "FROM", "TO"),
        help="the part of the family on which a coordinate goes from one value to a larger one; a symmetric arc "
        "starts at its symmetric point, whatever FROM is (default: all of the family)",
    )
    parser.add_argument(
        "--arc",
        type=common.index,
        default=1,
        metavar="N",
        help="which of the arcs, where the family turns back in that coordinate and runs through the range several "
        "times (default: the first)",
    )
    parser.add_argument(
        "--increasing", nargs="+", default=[], metavar="NAME", help="coordinates claimed to increase along the curve"
    )
    parser.add_argument(
        "--birth",
        action="store_true",
        help="of a family of doubled period that is traced here: the arc goes on to the doubling at which its orbits "
        "are born, from FROM of --covers or, without it, from where its half orbits no longer meet the section twice",
    )
    limits = parser.add_argument_group("limits of a family that is traced here, each optional")
    limits.add_argument("--max-orbits", type=common.count, default=5000, metavar="N", help="default: %(default)s")
    limits.add_argument("--jacobi-min", type=common.number, metavar="C", help="smallest Jacobi constant")
    limits.add_argument("--min-distance", type=common.positive, metavar="R", help="smallest distance to a primary")
    pieces = parser.add_argument_group("pieces")
    pieces.add_argument(
        "--degree",
        type=int,
        default=28,
        metavar="D",
        help="a piece is so wide that coefficient D of the flow in the curve's parameter falls to --decay "
        "(default: %(default)s)",
    )
    pieces.add_argument("--decay", type=common.positive, metavar="E", help="default: 1e-13, with --preset as it suits")
    pieces.add_argument(
        "--tube",
        type=common.positive,
        metavar="W",
        help="half-width of the tubes about the curve, in units of the distance from the nearest primary, or of 1 "
        "(default: 1e-09, with --preset as it suits)",
    )
    pieces.add_argument(
        "--overlap",
        type=common.positive,
        default=0.08,
        metavar="F",
        help="part of its half-width by which a piece goes into the next (default: %(default)s)",
    )
    pieces.add_argument(
        "--coordinates",
        choices=("auto", "physical", "regularised"),
        default="auto",
        help="in which the orbits are followed (default: for each piece what is cheaper)",
    )
    output = parser.add_mutually_exclusive_group(required=True)
    output.add_argument("-o", "--output", type=Path, metavar="FILE", help="atlas file to write")
    output.add_argument(
        "--check",
        type=Path,
        metavar="FILE",
        help="instead: compute orbits at random places of an atlas file in float64 and compare them with its "
        "polynomials and tubes",
    )
    parser.add_argument("--id", metavar="NAME", help="short name of the atlas (default: the preset's or the family's)")
    common.add_quiet(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check the options and cover, or check an atlas; returns the exit code. Raises `InputError`."""
    if options.check is not None:
        # Only now: JAX takes a moment to load.
        from orbitproof.explore.atlases import check_file

        return check_file(options.check, options.quiet)
    source = _source(options)
    suited = ATLAS_PRESETS[options.preset] if options.preset else AtlasPreset
    for name in ("tube", "decay"):
        if getattr(options, name) is None:
            setattr(options, name, getattr(suited, name))
    for name, value, (low, high) in (
        ("degree", options.degree, DEGREES),
        ("decay", options.decay, DECAYS),
        ("tube", options.tube, TUBES),
        ("overlap", options.overlap, OVERLAPS),
    ):
        if not low <= value <= high:
            raise InputError(f"--{name} {value:g}: give a number from {low:g} to {high:g}")
    if source.system is not None and options.coordinates == "regularised" and source.system.name != "cr3bp":
        raise InputError(f"--coordinates regularised: {source.system.name} has none; leave it out")
    check_writable(options.output)

    from orbitproof.explore.commands.atlas_of_family import run_source

    return run_source(source, options)


def _source(options: argparse.Namespace) -> Source:
    chosen = {
        "--system": options.system,
        "--mass": options.mass,
        "--family": options.family,
        "--covers": options.covers,
        "--increasing": options.increasing or None,
        "--branch": options.branch,
        "--from-family": options.from_family,
    }
    if options.preset is not None:
        if options.birth:
            raise InputError(f"--birth: --preset {options.preset} says which arc; leave out one of the two")
        for option, given in chosen.items():
            if given is not None:
                raise InputError(f"{option}: given by --preset {options.preset}; leave out one of the two")
        preset = ATLAS_PRESETS[options.preset]
        system = SYSTEMS[preset.system]
        covers = None if preset.covers is None else _covers(preset.covers, system)
        return Source(
            system, preset.family, preset.mass or None, None, covers, preset.increasing, preset.title, preset.birth
        )
    if options.from_family is not None:
        if options.birth:
            raise InputError("--birth: goes with a family that is traced here; leave out --from-family, or --birth")
        for option, given in (("--system", options.system), ("--branch", options.branch)):
            if given is not None:
                raise InputError(f"{option}: --from-family says which; leave it out")
        covers = None if options.covers is None else _covers(options.covers, None)
        increasing = tuple(options.increasing)
        return Source(None, options.family, options.mass, options.from_family, covers, increasing, None)
    named = options.system or system_with([options.family] if options.family else [])
    if named is None:
        raise InputError("--system: missing; give one, or --preset, or --from-family")
    system = system_named(named)
    names = FAMILY_NAMES.get(system.name)
    if names is None:
        raise InputError(f"--from-family: missing; trace a family of {system.name} first, with explore family")
    family = options.family or (names[0] if len(names) == 1 else None)
    if family is None or not is_family_name(system.name, family):
        wrong = "missing" if family is None else f"{family}: unknown for {system.name}"
        to_give = families_to_give(system.name, family or "")
        raise InputError(f"--family {wrong}; give one of {to_give}".replace("--family missing", "--family: missing"))
    if options.branch is not None and not has_branches(family):
        raise InputError(f"--branch: {family} has no northern and southern orbits; leave it out")
    given_parameters(system, options.mass, options.parameter)
    covers = None if options.covers is None else _covers(options.covers, system)
    check_names(system, covers, tuple(options.increasing))
    if system.family_parameter is not None and covers is None:
        raise InputError(f"--covers: missing; give a range of {system.family_parameter}")
    if options.birth and not family.endswith(("-butterfly", "-dragonfly")):
        raise InputError(f"--birth: {family} is not of doubled period; leave it out")
    return Source(system, family, options.mass, None, covers, tuple(options.increasing), None, options.birth)


def _covers(words: Any, system: ReversibleSystem | None) -> Covers:
    name, low, high = words
    covers = Covers(name, exact_number("--covers", low), exact_number("--covers", high))
    if not covers.start < covers.end:
        raise InputError(f"--covers {name} {low} {high}: an empty range; give the smaller value first")
    if system is not None and name == system.family_parameter == "beta" and covers.start <= 1:
        raise InputError(f"--covers {name} {low}: the family exists for beta > 1; give a larger value")
    return covers
