"""What pieces prove together, as certificates say it, without a list (sections 15.9 and 17.4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb

from orbitproof.shared.numbers import format_exact
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.curve import Bifurcation, Chain, Conclusion
from orbitproof.verify.evidence import Proved, balls_to_json, outcome_to_json

Json = dict[str, Any]


def whole_to_json(
    conclusion: Conclusion[Any], statement: str, chain: Chain | None, joints: Sequence[Any] = (), **more: Any
) -> Json:
    """The JSON object of a conclusion; `statement` is its theorem in words.

    Args:
        chain: of a curve that is proved.
        joints: of a surface that is.
        more: what else is known.
    """
    ends = conclusion.outcome.results.ends if isinstance(conclusion.outcome, Proved) else {}
    return {
        **outcome_to_json(conclusion.outcome),
        "statement": statement,
        "stretches": [
            {"piece": each.tube.piece.id, "enters": format_exact(each.enters), "leaves": format_exact(each.leaves)}
            for each in (() if chain is None else chain.stretches)
        ],
        "joints": [to_json(joint) for joint in (joints if chain is None else chain.joints)],
        "ends": {end: balls_to_json(balls) for end, balls in ends.items()},
        **more,
        "bifurcations": [_bifurcation(entry) for entry in conclusion.bifurcations],
    }


def _bifurcation(entry: Bifurcation) -> Json:
    place = entry.place
    return {
        "id": entry.id,
        "kind": entry.kind,
        "k": entry.k,
        "on_curve": place is not None,
        "piece": None if place is None else place.piece,
        "s": None if place is None else to_json(place.s),
        "mirrored": place is not None and place.mirrored,
        "other_point": place is not None and place.other_point,
        "is_foreign": entry.is_foreign,
        "reason": entry.reason,
        "point": named_balls(entry.point),
        "parameter_name": entry.parameter_name,
        "parameter": None if entry.parameter is None else to_json(entry.parameter),
    }


def named_balls(named: Mapping[str, arb]) -> Json:
    """Balls by their names."""
    return {name: to_json(ball) for name, ball in named.items()}
