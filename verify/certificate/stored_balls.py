"""Values that hold balls, as JSON and back (section 10): what `shared.codec` has to know of balls and reasons."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any

from flint import acb, arb

from orbitproof.shared.claims.fields import Line, Short
from orbitproof.shared.codec import from_json, register, to_json
from orbitproof.shared.stored import rules
from orbitproof.verify.certificate.tables import ball_from_text, ball_to_text, table_from_json, table_to_json
from orbitproof.verify.evidence import (
    Brief,
    Briefs,
    DerivativeTable,
    Hypothesis,
    Reason,
    ball_from_json,
    ball_to_json,
    hypothesis_to_json,
    reason_to_json,
)

__all__ = ["from_json", "register", "to_json"]

Dyadic = Annotated[str, rules("dyadic", pattern="^-?0x[0-9a-f]{1,20000}(p[+-]?[0-9]{1,6})?$")]
Text = Annotated[str, rules(maxLength=50000)]


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
class Table:
    """Derivatives up to order 3 of one function of p; multi-indices in lexicographic order.

    Attributes:
        box: over the box.
        centre: at its centre.
    """

    box: Briefs
    centre: Briefs


@dataclass(frozen=True)
class Shown:
    """What was checked; balls that are not finite are left out.

    Attributes:
        name: short key, for example HC3.
        statement: the inequality or inclusion that was checked, in words.
        section: of the method, that says why it is enough; docs/method.md leads to it.
    """

    name: Short
    statement: Line
    section: Short
    holds: bool
    enclosures: Mapping[str, arb]


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


def _hypothesis_from_json(entry: Mapping[str, Any]) -> Hypothesis:
    balls = {name: ball_from_json(ball) for name, ball in entry["enclosures"].items()}
    return Hypothesis(entry["name"], entry["statement"], entry["section"], entry["holds"], MappingProxyType(balls))


register(Reason, reason_to_json, _reason_from_json, Told)
register(arb, ball_to_json, ball_from_json, Ball)
register(acb, _complex_to_json, _complex_from_json, ComplexBall)
register(Brief, ball_to_text, ball_from_text, Text)
register(Hypothesis, hypothesis_to_json, _hypothesis_from_json, Shown)
register(DerivativeTable, table_to_json, table_from_json, Table)
