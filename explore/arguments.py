"""The command line's options: what they are and what they have to fulfil.

Everything wrong with them is an `InputError`: one line that names the option and the remedy.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from explore import branches_command, portraits_command
from shared.formats import InputError, check_writable
from shared.numbers import parse_exact
from shared.systems import MASS_PARAMETERS, SYSTEMS, ReversibleSystem

FAMILY_NAMES: Mapping[str, tuple[str, ...]] = {
    "cr3bp": tuple(f"{point}-{kind}" for kind in ("halo", "lyapunov") for point in ("L1", "L2", "L3")),
    "falkner-skan": ("odd",),
}
"""The families that can be asked for, by system; `explore.families` traces them."""

MAX_MULTIPLICITY = 1000
DIGITS = (15, 400)

POINTS = ("one", "distinct", "all")
"""Where an orbit's new orbits appear near both of its points on Fix(R): which of these become candidates."""


@dataclass(frozen=True)
class Preset:
    """A named search: what it stands for on the command line.

    Attributes:
        system: name of the system.
        masses, families: each mass with each family.
        velocity_max: the largest |vy| of the first point, one for each mass.
        multiplicities: unless -k says otherwise.
        points: one of `POINTS`, unless --points says otherwise.
        meaning: for the help text.
    """

    system: str
    masses: tuple[str, ...]
    families: tuple[str, ...]
    velocity_max: tuple[float, ...]
    multiplicities: tuple[int, ...]
    points: str
    meaning: str


PRESETS: Mapping[str, Preset] = {
    "tables": Preset(
        "cr3bp", ("earth-moon", "sun-jupiter"), ("L1-halo", "L2-halo"), (20.5, 8.0), (1, 2, 3, 4), "distinct",
        "the L1 halo loops and the L2 halo families of the Earth-Moon and the Sun-Jupiter system, as far as the paper "
        "follows them",
    ),
}  # fmt: skip

_EXAMPLES = """\
examples:
  python -m explore candidates --preset tables -o tables.json --family-output families.json
  python -m explore candidates --preset tables -k 5 6 --from-family families.json --append -o tables.json
  python -m explore candidates --system cr3bp --mass earth-moon --family L1-halo -k 1 2 3 4 --z-max 0.25 -o c.json
  python -m explore candidates --system falkner-skan -k 2 3 4 --append -o c.json
  python -m explore family --system cr3bp --mass 0.01 --family L2-halo --z-max 0.1 -o family.json
  python -m explore candidates --from-family family.json -k 3 --z-max 0.15 -o more.json
"""

_MASS_HELP = (
    "mass parameter of the CR3BP, the smaller mass over the total: a name ("
    + ", ".join(MASS_PARAMETERS)
    + ": exact IEEE doubles) or a number in (0, 1), taken exactly as written: decimal (0.01215 is the fraction "
    "1215/100000, not the nearest double) or hexadecimal (0x18e267d713713fp-59)"
)


class Parser(argparse.ArgumentParser):
    """Reports a wrong command line as one line, exit code 2."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {' '.join(message.split())}; see {self.prog} --help\n")


def _positive(text: str) -> float:
    value = float(text)
    if not isfinite(value) or value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return value


def _number(text: str) -> float:
    value = float(text)
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def _count(text: str) -> int:
    value = int(text)
    if not 2 <= value <= 1_000_000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 2 to 1000000")
    return value


def _jobs(text: str) -> int:
    value = int(text)
    if not 1 <= value <= 1024:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes from 1 to 1024")
    return value


def _multiplicity(text: str) -> int:
    value = int(text)
    if not 1 <= value <= MAX_MULTIPLICITY:
        raise argparse.ArgumentTypeError(f"{text!r} is not a multiplicity from 1 to {MAX_MULTIPLICITY}")
    return value


def _digits(text: str) -> int:
    value = int(text)
    if not DIGITS[0] <= value <= DIGITS[1]:
        raise argparse.ArgumentTypeError(f"{text!r} digits: choose {DIGITS[0]} to {DIGITS[1]}")
    return value


# argparse names the type in its message about text that is no number at all.
for _type in (_positive, _number):
    _type.__name__ = "number"
for _type in (_count, _jobs, _multiplicity, _digits):
    _type.__name__ = "whole number"


def parser() -> Parser:
    """The parser of ``python -m explore``."""
    result = Parser(
        prog="python -m explore",
        description="Find bifurcations of symmetric periodic orbits in reversible systems: follow families, detect "
        "1:k resonances, refine them and write boxes for the verifier. Nothing here is rigorous.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    commands = result.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    candidates = commands.add_parser(
        "candidates", help="find and refine bifurcations, write candidate boxes", epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False,
    )  # fmt: skip
    _family_options(candidates)
    candidates.add_argument(
        "-k", nargs="+", type=_multiplicity, metavar="K",
        help="multiplicities: 1 symmetry breaking, k > 1 the 1:k resonances (default: 2 3 4, or the preset's)",
    )  # fmt: skip
    candidates.add_argument(
        "--digits", type=_digits, default=50, metavar="N",
        help="decimal digits of the refined points (default: %(default)s)",
    )  # fmt: skip
    candidates.add_argument(
        "--points", choices=POINTS,
        help="an orbit meets Fix(R) in two points, and new orbits may appear near both. one: a candidate for the "
        "first; distinct: for both where the new orbits differ (even k >= 4); all: always for both (default: one, "
        "or the preset's)",
    )  # fmt: skip
    candidates.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="candidates file to write")
    candidates.add_argument(
        "--append", action="store_true",
        help="keep what the output file already holds; points refined there to as many digits are not refined again",
    )  # fmt: skip
    candidates.add_argument("--family-output", type=Path, metavar="FILE", help="write the traced families as JSON")
    family = commands.add_parser(
        "family", help="trace families and their resonances in float64", epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False,
    )  # fmt: skip
    _family_options(family)
    family.add_argument("-k", nargs="+", type=_multiplicity, metavar="K", help="locate these resonances as well")
    family.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="family file to write")
    for command in (branches_command, portraits_command):
        command.add_parser(commands)
    return result


def _family_options(target: argparse.ArgumentParser) -> None:
    families = "; ".join(f"{system}: {', '.join(names)}" for system, names in FAMILY_NAMES.items())
    target.add_argument("--system", metavar="NAME", help=f"one of {', '.join(SYSTEMS)}")
    target.add_argument("--mass", nargs="+", metavar="MU", help=_MASS_HELP)
    meanings = "; ".join(f"{name}: {preset.meaning}" for name, preset in PRESETS.items())
    target.add_argument(
        "--preset", choices=tuple(PRESETS), help=f"in place of --system, --mass, --family and --vy-max: {meanings}"
    )
    target.add_argument("--family", nargs="+", metavar="NAME", help=f"families to trace ({families})")
    target.add_argument(
        "--from-family", type=Path, metavar="FILE",
        help="start from the families in a family file and continue them up to the limits, instead of from their "
        "birth; families that are asked for and not in the file are traced as well",
    )  # fmt: skip
    target.add_argument(
        "--mirror", action="store_true", help="halo families: the mirror image, z < 0 at the first point"
    )
    limits = target.add_argument_group("limits, each optional; a family ends with the first orbit beyond one")
    limits.add_argument("--max-orbits", type=_count, default=1000, metavar="N", help="default: %(default)s")
    limits.add_argument("--z-max", type=_positive, metavar="Z", help="CR3BP: largest |z| of the first point")
    limits.add_argument(
        "--vy-max", nargs="+", type=_positive, metavar="V",
        help="CR3BP: largest |vy| of the first point, one value or one for each mass",
    )  # fmt: skip
    limits.add_argument("--jacobi-min", type=_number, metavar="C", help="CR3BP: smallest Jacobi constant")
    limits.add_argument(
        "--min-distance", type=_positive, default=1e-5, metavar="R",
        help="CR3BP: smallest distance to a primary (default: %(default)s)",
    )  # fmt: skip
    limits.add_argument("--beta-min", type=_number, default=100.0, metavar="B", help="default: %(default)s")
    limits.add_argument("--beta-max", type=_number, default=1000.0, metavar="B", help="default: %(default)s")
    target.add_argument(
        "--jobs", type=_jobs, default=os.cpu_count() or 1, metavar="N",
        help="processes: families traced and points refined at the same time (default: the number of processors, "
        "%(default)s)",
    )  # fmt: skip
    target.add_argument("--quiet", action="store_true", help="no messages but errors on standard error")


@dataclass(frozen=True)
class FamilyRequest:
    """A family to trace.

    Attributes:
        name: one of `FAMILY_NAMES`.
        parameters: exact fixed parameters of the system.
        label: the mass as the user gave it, or "".
        velocity_max: largest |vy| of the first point, or `None`.
    """

    system: ReversibleSystem
    name: str
    parameters: Mapping[str, Fraction]
    label: str
    velocity_max: float | None = None


@dataclass(frozen=True)
class Request:
    """A checked command line.

    Attributes:
        command: "candidates" or "family".
        system: `None` only together with `from_family`.
        families: what to trace; may be empty only together with `from_family`.
        multiplicities: the k to look for, may be empty for "family".
        points: one of `POINTS`.
        options: the parsed options.
    """

    command: str
    system: ReversibleSystem | None
    families: tuple[FamilyRequest, ...]
    multiplicities: tuple[int, ...]
    points: str
    options: Any

    @property
    def family_output(self) -> Path | None:
        """Where the traced families go, if anywhere."""
        return self.options.output if self.command == "family" else self.options.family_output


def check(options: argparse.Namespace) -> Request:
    """Check the options against each other; raises `InputError`."""
    _check_paths(options)
    if not options.beta_min < options.beta_max:
        raise InputError("--beta-min: not below --beta-max; give an interval")
    if options.beta_min <= 1:
        raise InputError("--beta-min: the family exists for beta > 1; give a larger value")
    preset = None if options.preset is None else PRESETS[options.preset]
    if preset is not None:
        for option, value in (
            ("--system", options.system), ("--mass", options.mass), ("--family", options.family),
            ("--vy-max", options.vy_max),
        ):  # fmt: skip
            if value is not None:
                raise InputError(f"{option}: given by --preset {options.preset}; leave out one of the two")
    multiplicities = options.k
    if multiplicities is None:
        multiplicities = preset.multiplicities if preset else ((2, 3, 4) if options.command == "candidates" else ())
    points = getattr(options, "points", None) or (preset.points if preset else "one")
    families = _families(options, preset)
    system = families[0].system if families else None if options.system is None else _system(options.system)
    if system is not None and 1 in multiplicities and not system.symmetries:
        raise InputError(f"-k 1: {system.name} has no symmetry that could break; leave it out")
    if system is not None and system.family_parameter is not None:
        for option, value in (("--z-max", options.z_max), ("--vy-max", options.vy_max)):
            if value is not None:
                raise InputError(f"{option}: {system.name} has no such coordinate on Fix(R); leave it out")
    return Request(options.command, system, families, tuple(dict.fromkeys(multiplicities)), points, options)


def _check_paths(options: argparse.Namespace) -> None:
    outputs = [options.output] + ([options.family_output] if getattr(options, "family_output", None) else [])
    if len(outputs) == 2 and outputs[0].resolve() == outputs[1].resolve():
        raise InputError(f"--family-output {outputs[1]}: is the output file as well; choose another path")
    for path in outputs:
        check_writable(path)


def _families(options: argparse.Namespace, preset: Preset | None) -> tuple[FamilyRequest, ...]:
    """The families asked for: each mass with each family name."""
    if preset is not None:
        names, masses, speeds = preset.families, preset.masses, preset.velocity_max
        system = _system(preset.system)
    else:
        if options.from_family is not None and not options.family and not options.mass:
            if options.mirror:
                raise InputError("--mirror: --from-family says which families; leave it out")
            if options.vy_max is not None and len(options.vy_max) > 1:
                raise InputError("--vy-max: give one value; --from-family says which masses")
            return ()
        if options.system is None:
            beside = " beside --from-family with --family or --mass" if options.from_family is not None else ""
            raise InputError(f"--system: missing{beside}; give one of {', '.join(SYSTEMS)}")
        system = _system(options.system)
        known = FAMILY_NAMES[system.name]
        names = tuple(dict.fromkeys(options.family or (known if len(known) == 1 else ())))
        if not names:
            raise InputError(f"--family: missing; give one or more of {', '.join(known)}")
        for name in names:
            if name not in known:
                raise InputError(f"--family {name}: unknown for {system.name}; give one or more of {', '.join(known)}")
        masses = tuple(dict.fromkeys(options.mass or (None,)))
        speeds = tuple(options.vy_max or (None,))
        if len(speeds) not in (1, len(masses)):
            raise InputError(f"--vy-max: {len(speeds)} values for {len(masses)} masses; give one, or one for each mass")
    result: list[FamilyRequest] = []
    for index, mass in enumerate(masses):
        parameters, label = _parameters(system, mass)
        speed = speeds[index if len(speeds) > 1 else 0]
        result += [FamilyRequest(system, name, parameters, label, speed) for name in names]
    return tuple(result)


def _system(name: str) -> ReversibleSystem:
    if name not in SYSTEMS or name not in FAMILY_NAMES:
        raise InputError(f"--system {name}: unknown; give one of {', '.join(FAMILY_NAMES)}")
    return SYSTEMS[name]


def _parameters(system: ReversibleSystem, mass: str | None) -> tuple[dict[str, Fraction], str]:
    if not system.fixed_parameters:
        if mass is not None:
            raise InputError(f"--mass {mass}: {system.name} has no mass parameter; leave it out")
        return {}, ""
    if mass is None:
        raise InputError(f"--mass: missing; give a name ({', '.join(MASS_PARAMETERS)}) or a number in (0, 1)")
    value = MASS_PARAMETERS.get(mass)
    if value is None:
        try:
            value = parse_exact(mass)
        except ValueError:
            names = ", ".join(MASS_PARAMETERS)
            raise InputError(f"--mass {mass}: neither a name ({names}) nor a number; give a number in (0, 1)") from None
    if not 0.0 < float(value) < 1.0 or not 0 < value < 1:
        raise InputError(f"--mass {mass}: outside (0, 1); give the smaller mass over the total mass")
    return {"mu": value}, mass
