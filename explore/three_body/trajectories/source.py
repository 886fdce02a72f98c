"""Orbits as files name them, and how the one that is meant is chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.three_body.trajectories.units import Units
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import System

_LISTED = 5


@dataclass(frozen=True)
class Choice:
    """Which orbit of a file is meant.

    Attributes:
        identifier: id of a candidate, certificate or branch, or `None`.
        family: name of a family of a family file, its mass in front where there are several, or `None`.
        number: of the orbit along a family or in a catalogue, or of the piece of an atlas, counted from 1; of an orbit
            of a branch, counted from its birth, negative on its other side; or `None`.
        accept: whether the orbit that is found is taken though the file says something else of it.
        connections: whether a homoclinic orbit, which has no period, may be meant.
    """

    identifier: str | None = None
    family: str | None = None
    number: int | None = None
    accept: bool = False
    connections: bool = False


@dataclass(frozen=True)
class Legs:
    """An orbit in parts: starts, durations, and whether they are half of it, as `PeriodicSolution` takes them."""

    starts: Matrix
    durations: Vector
    mirrored: bool


@dataclass(frozen=True)
class Said:
    """What a file says of an orbit beside its state; `None`: nothing.

    Attributes:
        period: the full one.
        level: of the first integral.
        stability_index: (|lambda| + 1/|lambda|)/2 of the largest multiplier.
    """

    period: float | None = None
    level: float | None = None
    stability_index: float | None = None


@dataclass(frozen=True)
class SourceOrbit:
    """A periodic orbit that a file names, or a homoclinic one.

    Attributes:
        parameters: exact, by name; those of the unknowns need not be among them.
        unknowns: of a symmetric orbit, shape (2 + n,): family parameter (if any), coordinates on Fix(R), half period.
            `None`: R does not map the orbit to itself, or the system has no R.
        title: what it is.
        verdict: what the file says about it, in words.
        primaries: names of the system's two bodies, or `None`.
        units: that the file names.
        legs: how the file knows the orbit, if in parts; needed without unknowns.
        stability: its stability parameters, if the file knows them better than one integration along the orbit.
        said: what the file says of the orbit besides.
        distance: of a homoclinic orbit, which its legs follow to Fix(R), the coordinate a of its start, which tells how
            far from the periodic orbit it is; `None` of a periodic orbit.
        accept: whether the orbit that is found is taken though it is not so.
    """

    system: System
    parameters: Mapping[str, Fraction]
    unknowns: Vector | None
    title: str
    verdict: str
    primaries: tuple[str, str] | None = None
    units: Units | None = None
    legs: Legs | None = None
    stability: tuple[complex, ...] | None = None
    said: Said = Said()
    distance: float | None = None
    accept: bool = False


def chosen_id(path: Path, choice: Choice, known: Sequence[str]) -> str:
    """The id that is meant, which may be left out where there is one only. Raises `InputError`."""
    refuse_family(choice, f"{path} holds no families; choose with --id")
    if choice.identifier is None and len(known) == 1:
        return known[0]
    if choice.identifier not in known:
        said = "missing" if choice.identifier is None else f"no {choice.identifier!r}"
        raise InputError(f"--id: {said}; give one of {path}: {some(known)}")
    return choice.identifier


def chosen_number(path: Path, choice: Choice, count: int, what: str = "orbits") -> int:
    """The place that is meant, from 0; it may be left out where there is one only. Raises `InputError`."""
    if choice.number is None and count > 1:
        raise InputError(f"--orbit: missing; {path} has {count} {what} there: give a number from 1 to {count}")
    number = 1 if choice.number is None else choice.number
    if number < 1:
        raise InputError(f"--orbit {number}: {what} are counted from 1 there; only branches have two sides")
    if number > count:
        raise InputError(f"--orbit {number}: {path} has {count} {what} there; give a smaller number")
    return number - 1


def refuse_id(choice: Choice, why: str) -> None:
    """Raises `InputError` if an id is given."""
    _without(choice.identifier, "--id", why)


def refuse_family(choice: Choice, why: str) -> None:
    """Raises `InputError` if a family is named."""
    _without(choice.family, "--family", why)


def refuse_number(choice: Choice, why: str) -> None:
    """Raises `InputError` if a number is given."""
    _without(choice.number, "--orbit", why)


def _without(value: object, option: str, why: str) -> None:
    if value is not None:
        raise InputError(f"{option}: {why}")


def some(names: Sequence[str]) -> str:
    """The first of the names, and how many there are besides."""
    more = len(names) - _LISTED
    return ", ".join(names[:_LISTED]) + (f" and {more} more" if more > 0 else "")
