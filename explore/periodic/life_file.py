"""Files of whole lives (orbitproof-life), version 1, as JSON: a curve of equilibria and the orbits born on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from orbitproof.explore.periodic.family_file import STATUS
from orbitproof.shared.codec import from_json, to_json
from orbitproof.shared.formats import read_document, write_document
from orbitproof.shared.stored import Rational, rules

if TYPE_CHECKING:
    from orbitproof.explore.periodic.continuation import PeriodicFamily
    from orbitproof.explore.periodic.correction import ClosedOrbit
    from orbitproof.explore.periodic.equilibrium_curve import EquilibriumCurve

LIFE = "life"
_ON_CIRCLE = 1e-9


@dataclass(frozen=True)
class RestRecord:
    """An equilibrium: the value of the parameter, the state, and how many eigenvalues have a positive real part."""

    value: float
    point: tuple[float, ...]
    unstable: Annotated[int, rules(minimum=0)]


@dataclass(frozen=True)
class SpecialRecord:
    """A fold, a branch point or a Hopf point on the curve of equilibria."""

    kind: Literal["fold", "branch point", "Hopf"]
    value: float
    point: tuple[float, ...]


@dataclass(frozen=True)
class CycleRecord:
    """A periodic orbit.

    Attributes:
        value: of the parameter.
        period: in the system's time.
        low, high: shape (N,), the least and the greatest value of each coordinate on it.
        stable: whether all multipliers but the trivial one are inside the unit circle.
    """

    value: float
    period: float
    low: tuple[float, ...]
    high: tuple[float, ...]
    stable: bool


@dataclass(frozen=True)
class PassedRecord:
    """What happens on a family, and the orbit there."""

    kind: Literal["fold", "branch point", "pitchfork", "period doubling", "Neimark-Sacker"]
    orbit: CycleRecord


@dataclass(frozen=True)
class CyclesRecord:
    """A family of periodic orbits: in order, with the bifurcations that it passes.

    Attributes:
        born: at what it is born.
        reason: why it ends.
    """

    born: str
    orbits: Annotated[tuple[CycleRecord, ...], rules(minItems=1)]
    passed: tuple[PassedRecord, ...]
    reason: str


@dataclass(frozen=True)
class LifeRecord:
    """A curve of equilibria and the families that are born on it, in a file.

    Attributes:
        status: what the numbers are worth.
        system: its name.
        state: names of its coordinates.
        parameters: exact values, by name, of those that do not vary.
        name: of the parameter that varies.
        equilibria: in order along the curve.
        special: folds, branch points and Hopf points on it, in the same order.
        families: of periodic orbits.
    """

    status: Annotated[str, rules(maxLength=200)]
    system: str
    state: tuple[str, ...]
    parameters: Mapping[str, Rational]
    name: str
    equilibria: Annotated[tuple[RestRecord, ...], rules(minItems=1)]
    special: tuple[SpecialRecord, ...]
    families: tuple[CyclesRecord, ...]


def life_of(curve: EquilibriumCurve, families: Sequence[PeriodicFamily]) -> LifeRecord:
    """What a file says of a curve and of the families that are born on it."""
    system, fixed = curve.problem.system, dict(curve.problem.parameters)
    del fixed[curve.name]
    return LifeRecord(
        STATUS,
        system.name,
        system.given_state,
        fixed,
        curve.name,
        tuple(
            RestRecord(each.value, _numbers(each.equilibrium.point), each.equilibrium.unstable)
            for each in curve.members
        ),
        tuple(
            SpecialRecord(each.kind, each.value, _numbers(each.point))  # type: ignore[arg-type]
            for each in curve.special
        ),
        tuple(
            CyclesRecord(
                "" if family.born is None else family.born.kind,
                tuple(_cycle(each.value, each.orbit) for each in family.members),
                tuple(
                    PassedRecord(each.kind, _cycle(each.value, each.member.orbit))  # type: ignore[arg-type]
                    for each in family.bifurcations
                ),
                family.reason,
            )
            for family in families
        ),
    )


def _numbers(values: np.ndarray) -> tuple[float, ...]:
    return tuple(map(float, values))


def _cycle(value: float, orbit: ClosedOrbit) -> CycleRecord:
    stable = bool(np.all(np.abs(orbit.multipliers) < 1 - _ON_CIRCLE))
    low, high = _numbers(orbit.loop.min(axis=0)), _numbers(orbit.loop.max(axis=0))
    return CycleRecord(value, float(orbit.period), low, high, stable)


def write_life(path: Path, record: LifeRecord) -> None:
    """Write a whole life, whole or not at all."""
    write_document(path, {"format": f"orbitproof-{LIFE}", "version": 1, **to_json(record)}, LIFE)


def read_life(path: Path) -> LifeRecord:
    """The whole life of a file. Raises `InputError`."""
    document = read_document(path, LIFE)
    entry = {key: value for key, value in document.items() if key not in ("format", "version")}
    return from_json(LifeRecord, entry, str(path))
