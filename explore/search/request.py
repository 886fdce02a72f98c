"""What a command line asks for, its options checked against each other.

Everything wrong with them is an `InputError`: one line that names the option and the remedy.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from orbitproof.explore.families import StepControl
from orbitproof.explore.names import Contradiction, NoOrbit, label_of, place_of, system_named
from orbitproof.explore.search.presets import PRESETS, Preset, PresetFamilies
from orbitproof.explore.seeds import FirstOrbit
from orbitproof.explore.three_body.names import (
    FAMILY_NAMES,
    WITHOUT_SYMMETRY,
    families_to_give,
    given_parameters,
    has_branches,
    is_family_name,
    system_with,
)
from orbitproof.shared.formats import InputError, check_writable, stated_format
from orbitproof.shared.systems import MASS_PARAMETERS, SYSTEMS, THREE_BODY, ReversibleSystem

LARGEST_TURNING = 1.0
TOLERANCES = (1e-14, 1e-6)

EQUILIBRIUM = "equilibrium"
"""What ``--start`` begins with if an equilibrium is meant."""


@dataclass(frozen=True)
class FamilyRequest:
    """A family to trace.

    Attributes:
        name: one of `FAMILY_NAMES`, or what a family that starts from an orbit is to be called.
        parameters: exact fixed parameters of the system.
        label: the mass as the user gave it, or "".
        velocity_max, z_max: largest |vy| and |z| of the first point, or `None`.
        multiplicities: the k to look for, or `None`: those of the request.
        first: an approximate first orbit, for a family without a name of its own.
    """

    system: ReversibleSystem
    name: str
    parameters: Mapping[str, Fraction]
    label: str
    velocity_max: float | None = None
    z_max: float | None = None
    multiplicities: tuple[int, ...] | None = None
    first: FirstOrbit | None = None


@dataclass(frozen=True)
class Request:
    """A checked command line.

    Attributes:
        command: "candidates" or "family".
        systems: those of the families; empty only together with `from_family` or `from_catalogue`.
        families: what to trace; may be empty only together with `from_family` or `from_catalogue`.
        multiplicities: the k to look for where a family does not say; may be empty for "family".
        points: one of `POINTS`.
        control: steps and tolerances.
        options: the parsed options.
    """

    command: str
    systems: tuple[ReversibleSystem, ...]
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
    for source, named in (("--from-catalogue", options.from_catalogue), ("--from-orbit", options.from_orbit)):
        if named is None:
            continue
        for option, value in (
            ("--system", options.system),
            ("--mass", options.mass),
            ("--family", options.family if source == "--from-catalogue" else None),
            ("--preset", options.preset),
            ("--from-family", options.from_family),
            ("--from-catalogue", options.from_catalogue if source == "--from-orbit" else None),
            ("--branch", options.branch),
            ("--start", options.start),
            ("--half-period", options.half_period),
        ):
            if value is not None:
                raise InputError(f"{option}: {source} says which family; leave it out")
        if options.vy_max is not None and len(options.vy_max) > 1:
            raise InputError(f"--vy-max: give one value; {source} says which mass")
    for option, value in (("--id", options.id), ("--orbit", options.orbit)):
        if value is not None and options.from_orbit is None:
            raise InputError(f"{option}: belongs to --from-orbit; give that too")
    preset = None if options.preset is None else PRESETS[options.preset]
    if preset is not None:
        for option, value in (
            ("--system", options.system),
            ("--mass", options.mass),
            ("--family", options.family),
            ("--vy-max", options.vy_max),
            ("--z-max", options.z_max if any(each.z_max for each in preset.searched) else None),
            ("--start", options.start),
        ):
            if value is not None:
                raise InputError(f"{option}: given by --preset {options.preset}; leave out one of the two")
    multiplicities = options.k
    if multiplicities is None:
        multiplicities = (2, 3, 4) if options.command == "candidates" and not options.folds else ()
    points = getattr(options, "points", None) or (preset.points if preset else "one")
    families = _families(options, preset)
    if options.branch is not None and not options.branches and not any(has_branches(each.name) for each in families):
        raise InputError("--branch: none of these families has northern and southern orbits; leave it out")
    systems = tuple({family.system.name: family.system for family in families}.values())
    if not systems and options.system is not None:
        systems = (system_named(options.system),)
    for system in systems:
        _check_for_system(options, system, multiplicities)
    return Request(options.command, systems, families, tuple(dict.fromkeys(multiplicities)), points, control, options)


def _check_for_system(options: argparse.Namespace, system: ReversibleSystem, multiplicities: Sequence[int]) -> None:
    if 1 in multiplicities and not system.symmetries:
        raise InputError(f"-k 1: {system.name} has no symmetry that could break; leave it out")
    for option, name, value in (("--z-max", "z", options.z_max), ("--vy-max", "vy", options.vy_max)):
        if value is not None and name not in system.centre_coordinates:
            raise InputError(f"{option}: {system.name} has no such coordinate on Fix(R); leave it out")
    if system not in THREE_BODY:
        for name in ("csv", "catalogue"):
            if getattr(options, name, None) is not None:
                raise InputError(f"--{name}: the catalogue's columns are those of the CR3BP; leave it out")
    if options.branches and not system.symmetries:
        raise InputError(f"--branches: {system.name} has no symmetry that could break; leave it out")


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
        return tuple(family for searched in preset.searched for family in _searched(options, searched))
    if options.from_catalogue is not None:
        return ()
    if options.from_orbit is not None:
        return (_through(options),)
    if options.from_family is not None and not options.family and not options.mass:
        if options.branch is not None:
            raise InputError("--branch: --from-family says which families; leave it out")
        if options.vy_max is not None and len(options.vy_max) > 1:
            raise InputError("--vy-max: give one value; --from-family says which masses")
        return ()
    named = options.system or (system_with(options.family or ()) if options.start is None else None)
    if named is None:
        for name in options.family or ():
            if options.mass and options.from_family is None and system_with([name]) is None:
                raise InputError(f"--family {name}: unknown; give one of {families_to_give('cr3bp', name)}")
        beside = " beside --from-family with --family or --mass" if options.from_family is not None else ""
        raise InputError(f"--system: missing{beside}; give one of {', '.join(FAMILY_NAMES)}, or your own system's file")
    system = system_named(named)
    if options.start is not None:
        return started(options, system)
    known = FAMILY_NAMES.get(system.name, ())
    if not known:
        wanted = " ".join(f"{name}=.." for name in system.centre_coordinates)
        raise InputError(f"--start: missing; give an approximate orbit, --start {wanted}, or --start {EQUILIBRIUM}")
    names = tuple(dict.fromkeys(options.family or (known if len(known) == 1 else ())))
    if not names:
        raise InputError(f"--family: missing; give one or more of {', '.join(known)}")
    for name in names:
        if name in WITHOUT_SYMMETRY:
            raise InputError(
                f"--family {name}: no reversor maps its orbits to themselves; give it to explore catalogue, or "
                f"follow it with explore periodic --system cr3bp --triangular {name} --along level .."
            )
        if not is_family_name(system.name, name):
            other = system_with([name])
            beside = "" if other is None else f", or --system {other}"
            raise InputError(
                f"--family {name}: unknown for {system.name}; give one or more of "
                f"{families_to_give(system.name, name)}{beside}"
            )
    masses = tuple(dict.fromkeys(options.mass or (None,)))
    speeds = tuple(options.vy_max or (None,))
    if len(speeds) not in (1, len(masses)):
        raise InputError(f"--vy-max: {len(speeds)} values for {len(masses)} masses; give one, or one for each mass")
    result: list[FamilyRequest] = []
    for index, mass in enumerate(masses):
        parameters = given_parameters(system, mass, options.parameter)
        label = label_of(system, mass, options.parameter)
        speed = speeds[index if len(speeds) > 1 else 0]
        result += [FamilyRequest(system, name, parameters, label, speed) for name in names]
    return tuple(result)


def _searched(options: argparse.Namespace, searched: PresetFamilies) -> Iterator[FamilyRequest]:
    """The families of one system that a preset stands for."""
    system = SYSTEMS[searched.system]
    for index, mass in enumerate(searched.masses):
        parameters = given_parameters(system, mass, options.parameter)
        label = label_of(system, mass, options.parameter)
        for name in searched.families:
            yield FamilyRequest(
                system,
                name,
                parameters,
                label,
                searched.velocity_max[index if len(searched.velocity_max) > 1 else 0],
                searched.z_max,
                searched.multiplicities if options.k is None else None,
            )


def _through(options: argparse.Namespace) -> FamilyRequest:
    """The family of the orbit that a file names. Raises `InputError`, `Contradiction`."""
    path, names = options.from_orbit, options.family or []
    if len(names) > 1:
        raise InputError("--family: --from-orbit is one orbit; give one name")
    # Only now: JAX takes a moment to load.
    from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of

    in_families = stated_format(path, "give a file that names an orbit") == "family"
    names_of = (None, options.id) if in_families else (options.id, None)
    try:
        source = find_orbit(path, Choice(*names_of, options.orbit, options.accept))
        trajectory_of(source)
    except Contradiction as failure:
        raise Contradiction(f"{path}: {failure}") from None
    except NoOrbit as failure:
        raise InputError(f"--from-orbit {path}: {failure}; choose another orbit") from None
    system = source.system
    if source.unknowns is None or not isinstance(system, ReversibleSystem):
        raise InputError(
            f"--from-orbit {path}: R does not map {source.title} to itself; explore periodic follows such orbits"
        )
    label = next((key for key, value in MASS_PARAMETERS.items() if source.parameters.get("mu") == value), "")
    *point, half_period = source.unknowns.tolist()
    return FamilyRequest(
        system,
        names[0] if names else options.id or "family",
        {name: source.parameters[name] for name in system.fixed_parameters},
        label if system in THREE_BODY else "",
        options.vy_max[0] if options.vy_max else None,
        first=FirstOrbit(tuple(point), half_period),
    )


def started(options: argparse.Namespace, system: ReversibleSystem) -> tuple[FamilyRequest, ...]:
    """The family of ``--start``, or the families of the elliptic pairs of an equilibrium. Raises `InputError`."""
    masses, names, speeds = options.mass or [None], options.family or ["family"], options.vy_max or [None]
    for option, values in (("--mass", masses), ("--family", names), ("--vy-max", speeds)):
        if len(values) > 1:
            raise InputError(f"{option}: --start is one orbit; give one value")
    if options.branch is not None:
        raise InputError("--branch: --start says which orbit; leave it out")
    name, words = names[0], list(options.start)
    if not name.isprintable() or not 0 < len(name) <= 100:
        raise InputError(f"--family {name!r}: no name; use letters, digits and signs")
    parameters = given_parameters(system, masses[0], options.parameter)
    label = label_of(system, masses[0], options.parameter)
    if words[0] != EQUILIBRIUM:
        place = place_of(system, "--start", words, complete=True)
        first = FirstOrbit(tuple(place[each] for each in system.centre_coordinates), options.half_period)
        return (FamilyRequest(system, name, parameters, label, speeds[0], first=first),)
    if options.half_period is not None:
        raise InputError("--half-period: follows from the frequencies of the equilibrium; leave it out")
    guess = place_of(system, f"--start {EQUILIBRIUM}", words[1:], complete=False)

    # Only now: numpy takes a moment to load.
    from orbitproof.explore.seeds import EquilibriumFailure, small_orbits

    try:
        firsts = small_orbits(system, {key: float(value) for key, value in parameters.items()}, guess)
    except EquilibriumFailure as error:
        raise InputError(f"--start {EQUILIBRIUM}: {error}") from None
    called = [name] if len(firsts) == 1 else [f"{name}-{number}" for number in range(1, len(firsts) + 1)]
    return tuple(
        FamilyRequest(system, each, parameters, label, speeds[0], first=first)
        for each, first in zip(called, firsts, strict=True)
    )
