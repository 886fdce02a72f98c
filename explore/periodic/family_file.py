"""Files of families of periodic orbits without symmetry (orbitproof-periodic-family), version 1, as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from orbitproof.shared.codec import from_json, to_json
from orbitproof.shared.formats import read_document, write_document
from orbitproof.shared.stored import Rational, rules

if TYPE_CHECKING:
    from orbitproof.explore.periodic.continuation import FamilyMember, PeriodicFamily

PERIODIC_FAMILY = "periodic-family"
STATUS = "numerics in double precision, nothing is proved"

Kind = Literal["fold", "branch point", "pitchfork", "period doubling", "Neimark-Sacker"]


@dataclass(frozen=True)
class MemberRecord:
    """An orbit of a family in a file.

    Attributes:
        value: of what varies along the family.
        period: in the system's time.
        point: shape (N,), a point of the orbit.
        multipliers: real and imaginary part of each, without those that are 1 for every orbit; the largest first.
    """

    value: float
    period: float
    point: tuple[float, ...]
    multipliers: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class BifurcationRecord:
    """Where multipliers meet the unit circle: what happens, the orbit there, and the multiplier that is there."""

    kind: Kind
    orbit: MemberRecord
    multiplier: tuple[float, float]


@dataclass(frozen=True)
class PeriodicFamilyRecord:
    """A family of periodic orbits in a file.

    Attributes:
        status: what the numbers are worth.
        system: its name.
        state: names of its coordinates.
        parameters: exact values, by name, of those that do not vary.
        name: of the parameter, or of the first integral, that varies.
        over_levels: whether it is a first integral.
        conservative: whether the system has a first integral.
        reason: why the family ends.
        orbits: in order along the family.
        bifurcations: in the same order.
    """

    status: Annotated[str, rules(maxLength=200)]
    system: str
    state: tuple[str, ...]
    parameters: Mapping[str, Rational]
    name: str
    over_levels: bool
    conservative: bool
    reason: str
    orbits: Annotated[tuple[MemberRecord, ...], rules(minItems=1)]
    bifurcations: tuple[BifurcationRecord, ...]


def record_of(family: PeriodicFamily) -> PeriodicFamilyRecord:
    """What a file says of a family."""
    system, fixed = family.problem.system, dict(family.problem.parameters)
    if family.parameter is not None:
        del fixed[family.parameter]
    return PeriodicFamilyRecord(
        STATUS,
        system.name,
        system.given_state,
        fixed,
        family.name,
        family.parameter is None,
        system.first_integral_program is not None,
        family.reason,
        tuple(map(_member, family.members)),
        tuple(
            BifurcationRecord(each.kind, _member(each.member), (each.multiplier.real, each.multiplier.imag))  # type: ignore[arg-type]
            for each in family.bifurcations
        ),
    )


def _member(member: FamilyMember) -> MemberRecord:
    orbit = member.orbit
    found = orbit.multipliers if np.all(np.isfinite(orbit.multipliers)) else ()
    pairs = tuple((float(value.real), float(value.imag)) for value in found)
    return MemberRecord(member.value, float(orbit.period), tuple(map(float, orbit.point)), pairs)


def write_periodic_family(path: Path, family: PeriodicFamily) -> None:
    """Write a family, whole or not at all."""
    entry = to_json(record_of(family))
    write_document(path, {"format": f"orbitproof-{PERIODIC_FAMILY}", "version": 1, **entry}, PERIODIC_FAMILY)


def read_periodic_family(path: Path) -> PeriodicFamilyRecord:
    """The family of a file. Raises `InputError`."""
    document = read_document(path, PERIODIC_FAMILY)
    entry = {key: value for key, value in document.items() if key not in ("format", "version")}
    return from_json(PeriodicFamilyRecord, entry, str(path))
