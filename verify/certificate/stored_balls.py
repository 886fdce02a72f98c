"""Values that hold balls, as JSON and back (section 10): what `shared.codec` has to know of balls and reasons."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from flint import acb, arb

from orbitproof.shared.claims.fields import Line
from orbitproof.shared.codec import from_json, register, to_json
from orbitproof.shared.stored import rules
from orbitproof.verify.evidence import Reason, ball_from_json, ball_to_json, reason_to_json

__all__ = ["from_json", "to_json"]

Dyadic = Annotated[str, rules("dyadic", pattern="^-?0x[0-9a-f]{1,20000}(p[+-]?[0-9]{1,6})?$")]


@dataclass(frozen=True)
class Ball:
    """The closed interval [mid - rad, mid + rad], exactly.

    Attributes:
        decimal: for people: an interval rounded outward.
    """

    mid: Dyadic
    rad: Dyadic
    decimal: Line = ""


@dataclass(frozen=True)
class ComplexBall:
    """A rectangle."""

    real: arb
    imaginary: arb


@dataclass(frozen=True)
class Told:
    """Why a claim is not proved. Failure to verify is not a proof that the claim is false."""

    condition: Line
    message: Line
    remedy: Line


def _complex_to_json(value: acb) -> dict[str, Any]:
    return {"real": ball_to_json(value.real), "imaginary": ball_to_json(value.imag)}


def _complex_from_json(entry: Mapping[str, Any]) -> acb:
    return acb(ball_from_json(entry["real"]), ball_from_json(entry["imaginary"]))


def _reason_from_json(entry: Mapping[str, str]) -> Reason:
    return Reason(entry.get("condition", ""), entry["message"], entry.get("remedy", ""))


register(Reason, reason_to_json, _reason_from_json, Told)
register(arb, ball_to_json, ball_from_json, Ball)
register(acb, _complex_to_json, _complex_from_json, ComplexBall)
