"""What points, gaps and bounds of a complete list are about, as values; their names in JSON files (section 18.5).

What follows from a list is decided by these values alone. Their names stand in files, and in no sentence.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, unique
from typing import Any


@unique
class Kind(Enum):
    """What is found at a point of the list (Lemmas 18.3, 21.1)."""

    RESONANCE = "resonance"
    FOLD = "fold"
    LOSS = "loss of R"
    SYMMETRIC = "symmetric point"
    IN_PLANE = "birth from the plane"
    HERE = "singular at this point"
    THERE = "singular at the other point"
    COLLISION = "Krein collision"
    TWO_TO_ONE = "combination 2:1"
    THREE_TO_ONE = "combination 3:1"
    OPPOSITE = "combination 2:2"
    UNDECIDED = "undecided"
    ACROSS_SYMMETRIC = "birth out of the plane"
    ACROSS_AXIAL = "axial birth out of the plane"
    ACROSS_DOUBLING = "minus one out of the plane"
    TWISTLESS = "twistless"

    @property
    def is_birth(self) -> bool:
        """Whether orbits out of the plane are born there."""
        return self in (Kind.ACROSS_AXIAL, Kind.ACROSS_SYMMETRIC)


@dataclass(frozen=True)
class Resonance:
    """A stability parameter cos(2 pi j/k)."""

    k: int
    j: int


@unique
class Matter(Enum):
    """What else may be open on a part of the curve."""

    EVERYTHING = "everything"
    COLLISION = "Krein collision"
    EXTREMA = "extrema of stability parameters"
    COMBINATIONS = "combination resonances"
    TWIST = "twist"


Subject = Resonance | Matter
"""What is not known on a part of the curve."""


def may_change_stability(subject: Subject) -> bool:
    """Whether stability may change where this is open: unless it surely does not, it may (Lemma 18.4)."""
    if isinstance(subject, Resonance):
        return not subject.k > 2
    return subject not in (Matter.EXTREMA, Matter.COMBINATIONS, Matter.TWIST)


@unique
class CurveEnd(Enum):
    """An end of the part of a curve that a list is about."""

    BEGINNING = "the beginning of the curve"
    END = "the end of the curve"


@dataclass(frozen=True)
class Found:
    """A point of the list at which a stability parameter is cos(2 pi j/k); else k = j = 0."""

    kind: Kind
    k: int
    j: int


What = Found | CurveEnd | Subject
"""What is at the end of an interval of stability: a point of the list, an end of the curve, or something open."""


def name_of(what: Kind | What) -> Any:
    """How a JSON file names it."""
    if isinstance(what, Found):
        return what.kind.value
    return {"k": what.k, "j": what.j} if isinstance(what, Resonance) else what.value


def short_name(what: What) -> str:
    """How a line of text names it."""
    return f"k = {what.k}, j = {what.j}" if isinstance(what, Resonance) else str(name_of(what))
