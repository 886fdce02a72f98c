"""How to integrate a piece of a curve, and what is then known of it (sections 15.2, 15.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.shared.numbers import format_exact
from orbitproof.verify.evidence import ball_to_json


@dataclass(frozen=True)
class PieceLimits:
    """How to integrate a piece.

    Attributes:
        precision: fractional bits of the fixed-point format.
        order: degree of the time expansions.
        width: degree in s.
    """

    precision: int = 80
    order: int = 40
    width: int = 40

    def __post_init__(self) -> None:
        if min(self.precision, self.order) < 16 or self.width < 1:
            raise ValueError(f"precision {self.precision}, order {self.order}, width {self.width} are too small")


@dataclass(frozen=True)
class PieceResult:
    """What is known of a piece on an interval of s.

    Attributes:
        piece: its id.
        interval: within [-1, 1]; that of the proof may be longer than what was asked for.
        deviation: for each s the p_j of the orbit in the tube differ from polynomial_j(s) by at most this.
        slope_deviation: bounds of the derivatives of these differences d_j in s; of d_j'(s)/s for a symmetric piece.
        time: half periods of the orbits.
        reason: why it is not proved; `None` if it is.
        remedy: what may help.
        condition: what was not shown, in one word.
        computation: precision, order, width, steps, coordinates, seconds.
    """

    piece: str
    interval: tuple[Fraction, Fraction]
    deviation: tuple[Fraction, ...] = ()
    slope_deviation: tuple[Fraction, ...] = ()
    time: arb | None = None
    reason: str | None = None
    remedy: str | None = None
    condition: str = ""
    computation: Mapping[str, float | int | str] = field(default_factory=dict)

    @property
    def is_proved(self) -> bool:
        """Whether the claim of the piece is proved on the interval."""
        return self.reason is None

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the result; all numbers that carry proof are exact."""
        result: dict[str, Any] = {
            "piece": self.piece,
            "interval": [format_exact(end) for end in self.interval],
            "verdict": "proved" if self.is_proved else "not proved",
            "computation": dict(self.computation),
        }
        if self.reason is not None:
            reason = {"condition": self.condition, "message": self.reason, "remedy": self.remedy or ""}
            return result | {"reason": reason}
        return result | {
            "deviation": [format_exact(value) for value in self.deviation],
            "slope_deviation": [format_exact(value) for value in self.slope_deviation],
            "time": ball_to_json(self.time if self.time is not None else arb(float("nan"))),
        }
