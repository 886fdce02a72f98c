"""What a command line asks for, its options checked against each other.

Everything wrong with them is an `InputError`: one line that names the option and the remedy.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from orbitproof.explore.families import StepControl
from orbitproof.explore.names import FAMILY_NAMES, PRESETS, Preset, fixed_parameters, is_family_name
from orbitproof.shared.formats import InputError, check_writable
from orbitproof.shared.systems import SYSTEMS, ReversibleSystem

LARGEST_TURNING = 1.0
TOLERANCES = (1e-14, 1e-6)


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
        control: steps and tolerances.
        options: the parsed options.
    """

    command: str
    system: ReversibleSystem | None
    families: tuple[FamilyRequest, ...]
    multiplicities: tuple[int, ...]
    points: str
    control: StepControl
    options: Any

    @property
    def family_output(self) -> Path | None:
        """Where the traced families go, if anywhere."""
        return self.options.output if self.command == "family" else self.options.family_output


def check(options: argparse.Namespace) -> Request:
    """Check the options against each other; raises `InputError`."""
    _check_paths(options)
    control = _control(options)
    if not options.beta_min < options.beta_max:
        raise InputError("--beta-min: not below --beta-max; give an interval")
    if options.beta_min <= 1:
        raise InputError("--beta-min: the family exists for beta > 1; give a larger value")
    if options.from_catalogue is not None:
        for option, value in (
            ("--system", options.system),
            ("--mass", options.mass),
            ("--family", options.family),
            ("--preset", options.preset),
            ("--from-family", options.from_family),
            ("--mirror", options.mirror or None),
        ):
            if value is not None:
                raise InputError(f"{option}: --from-catalogue says which family; leave it out")
        if options.vy_max is not None and len(options.vy_max) > 1:
            raise InputError("--vy-max: give one value; --from-catalogue says which mass")
    preset = None if options.preset is None else PRESETS[options.preset]
    if preset is not None:
        for option, value in (
            ("--system", options.system),
            ("--mass", options.mass),
            ("--family", options.family),
            ("--vy-max", options.vy_max),
        ):
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
        for name in ("csv", "catalogue"):
            if getattr(options, name, None) is not None:
                raise InputError(f"--{name}: the catalogue's columns are those of the CR3BP; leave it out")
    if options.branches and system is not None and not system.symmetries:
        raise InputError(f"--branches: {system.name} has no symmetry that could break; leave it out")
    return Request(options.command, system, families, tuple(dict.fromkeys(multiplicities)), points, control, options)


def _control(options: argparse.Namespace) -> StepControl:
    if not options.step_min <= options.step_initial <= options.step_max:
        raise InputError("--step-initial: not between --step-min and --step-max; give three increasing lengths")
    if options.turning > LARGEST_TURNING:
        raise InputError(f"--turning {options.turning:g}: too large; give at most {LARGEST_TURNING:g} radians")
    if not TOLERANCES[0] <= options.tolerance <= TOLERANCES[1]:
        raise InputError(f"--tolerance {options.tolerance:g}: give {TOLERANCES[0]:g} to {TOLERANCES[1]:g}")
    return StepControl(
        options.step_initial,
        options.step_min,
        options.step_max,
        options.turning,
        options.tolerance,
        options.until_tangency,
    )


def _check_paths(options: argparse.Namespace) -> None:
    outputs = {"--output": options.output}
    for name in ("family_output", "csv", "catalogue"):
        path = getattr(options, name, None)
        if path is None:
            continue
        option = f"--{name.replace('_', '-')}"
        if any(path.resolve() == other.resolve() for other in outputs.values()):
            raise InputError(f"{option} {path}: is another output file as well; choose another path")
        outputs[option] = path
    for path in outputs.values():
        check_writable(path)


def _families(options: argparse.Namespace, preset: Preset | None) -> tuple[FamilyRequest, ...]:
    """The families asked for: each mass with each family name."""
    if preset is not None:
        names, masses, speeds = preset.families, preset.masses, preset.velocity_max
        system = _system(preset.system)
    elif options.from_catalogue is not None:
        return ()
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
        known: tuple[str, ...] = FAMILY_NAMES[system.name]
        names = tuple(dict.fromkeys(options.family or (known if len(known) == 1 else ())))
        if not names:
            raise InputError(f"--family: missing; give one or more of {', '.join(known)}")
        for name in names:
            if not is_family_name(system.name, name):
                raise InputError(f"--family {name}: unknown for {system.name}; give one or more of {', '.join(known)}")
        masses = tuple(dict.fromkeys(options.mass or (None,)))
        speeds = tuple(options.vy_max or (None,))
        if len(speeds) not in (1, len(masses)):
            raise InputError(f"--vy-max: {len(speeds)} values for {len(masses)} masses; give one, or one for each mass")
    result: list[FamilyRequest] = []
    for index, mass in enumerate(masses):
        parameters = fixed_parameters(system, mass)
        speed = speeds[index if len(speeds) > 1 else 0]
        result += [FamilyRequest(system, name, parameters, mass or "", speed) for name in names]
    return tuple(result)


def _system(name: str) -> ReversibleSystem:
    if name not in SYSTEMS or name not in FAMILY_NAMES:
        raise InputError(f"--system {name}: unknown; give one of {', '.join(FAMILY_NAMES)}")
    return SYSTEMS[name]
