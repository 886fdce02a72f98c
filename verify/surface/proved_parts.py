"""What is proved of a piece of a surface on parts of an interval of s (section 17.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.curve import interval_to_json
from orbitproof.verify.evidence import ball_from_json, ball_to_json, balls_to_json


@dataclass(frozen=True)
class ProvedPart:
    """For each s in [start, end] the piece's box has one symmetry breaking, at p in `point`, halo orbits on `side`.

    Attributes:
        start, end: within [-1, 1].
        point: enclosures of the coordinates p of the bifurcation point.
        side: levels of the first integral at which the halo orbits live.
        enclosures: of what the hypotheses are about, by hypothesis and name.
    """

    start: Fraction
    end: Fraction
    point: tuple[arb, ...]
    side: str
    enclosures: Mapping[str, Mapping[str, arb]] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """The JSON object."""
        return {
            "interval": interval_to_json((self.start, self.end)),
            "point": [ball_to_json(ball) for ball in self.point],
            "side": self.side,
            "hypotheses": {name: balls_to_json(balls) for name, balls in self.enclosures.items()},
        }

    @classmethod
    def from_json(cls, entry: Mapping[str, Any]) -> ProvedPart:
        """The same part without the enclosures. Raises `ValueError` or `KeyError` if it is none."""
        start, end = (parse_exact(text) for text in entry["interval"])
        return cls(start, end, tuple(ball_from_json(ball) for ball in entry["point"]), str(entry["side"]))


@dataclass(frozen=True)
class ProvedParts:
    """Parts that cover an interval of s, in order, and the half periods of the orbits over it."""

    parts: tuple[ProvedPart, ...]
    time: arb

    def to_json(self) -> dict[str, Any]:
        """Its part of the JSON object of a result; all numbers that carry proof are exact."""
        return {
            "interval": interval_to_json((self.parts[0].start, self.parts[-1].end)),
            "parts": [part.to_json() for part in self.parts],
            "time": ball_to_json(self.time),
        }
