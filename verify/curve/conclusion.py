"""What a proved curve is known to be: hypotheses, enclosures, ends, bifurcations (section 15.9)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from orbitproof.shared.numbers import format_exact
from orbitproof.verify.curve.bifurcations_on_it import Bifurcation
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.curve.statement import Ends
from orbitproof.verify.evidence import Hypothesis, Reason, ball_to_json, balls_to_json, hypothesis_to_json


@dataclass(frozen=True)
class Conclusion:
    """What the pieces of an atlas prove together. Raises `ValueError` if it says more than its hypotheses show.

    Attributes:
        atlas: id of the atlas.
        statement: the theorem in words; empty if it is not proved.
        reason: why it is not proved, or `None` if it is.
        hypotheses: what was checked, in order, with enclosures.
        chain: the curve, or `None`.
        ends: enclosures of the coordinates of its first and last point.
        bifurcations: the certificates given, and where on the curve they are.
        expected: names of the hypotheses that the claim takes, in order.
    """

    atlas: str
    statement: str
    reason: Reason | None
    hypotheses: tuple[Hypothesis, ...]
    chain: Chain | None
    ends: Ends
    bifurcations: tuple[Bifurcation, ...]
    expected: tuple[str, ...]

    def __post_init__(self) -> None:
        names = tuple(hypothesis.name for hypothesis in self.hypotheses)
        shown = bool(names) and names == self.expected and all(h.holds is True for h in self.hypotheses)
        if self.is_proved and not (shown and self.chain is not None):
            raise ValueError(f"hypotheses {names} do not prove what takes {self.expected}")
        if self.is_proved != bool(self.statement):
            raise ValueError("a statement belongs to what is proved, and to nothing else")

    @property
    def is_proved(self) -> bool:
        """Whether the curve is proved; each bifurcation says for itself whether it lies on it."""
        return self.reason is None

    def to_json(self) -> dict[str, Any]:
        """The JSON object: exact numbers and balls with decimals beside them."""
        reason, chain = self.reason, self.chain
        return {
            "verdict": "proved" if self.is_proved else "not proved",
            "statement": self.statement,
            "reason": None
            if reason is None
            else {"condition": reason.condition, "message": reason.message, "remedy": reason.remedy},
            "hypotheses": [hypothesis_to_json(hypothesis) for hypothesis in self.hypotheses],
            "stretches": []
            if chain is None
            else [
                {
                    "piece": stretch.tube.piece.id,
                    "enters": format_exact(stretch.enters),
                    "leaves": format_exact(stretch.leaves),
                }
                for stretch in chain.stretches
            ],
            "joints": []
            if chain is None
            else [
                {
                    "before": joint.before,
                    "after": joint.after,
                    "leaves": format_exact(joint.leaves),
                    "enters": ball_to_json(joint.enters),
                    "offsets": [ball_to_json(ball) for ball in joint.offsets],
                    "turn": ball_to_json(joint.turn),
                }
                for joint in chain.joints
            ],
            "ends": {end: balls_to_json(coordinates) for end, coordinates in self.ends.items()},
            "bifurcations": [entry.to_json() for entry in self.bifurcations],
        }
