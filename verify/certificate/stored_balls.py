"""Values that hold balls, as JSON and back (section 10): what `shared.codec` has to know of balls and reasons."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import acb, arb

from orbitproof.shared.codec import from_json, register, to_json
from orbitproof.verify.evidence import Reason, ball_from_json, ball_to_json, reason_to_json

__all__ = ["from_json", "to_json"]


def _complex_to_json(value: acb) -> dict[str, Any]:
    return {"real": ball_to_json(value.real), "imaginary": ball_to_json(value.imag)}


def _complex_from_json(entry: Mapping[str, Any]) -> acb:
    return acb(ball_from_json(entry["real"]), ball_from_json(entry["imaginary"]))


def _reason_from_json(entry: Mapping[str, str]) -> Reason:
    return Reason(entry.get("condition", ""), entry["message"], entry.get("remedy", ""))


register(Reason, reason_to_json, _reason_from_json, {"$ref": "#/$defs/reason"})
register(arb, ball_to_json, ball_from_json, {"$ref": "#/$defs/ball"})
register(acb, _complex_to_json, _complex_from_json, {"$ref": "#/$defs/complex_ball"})
