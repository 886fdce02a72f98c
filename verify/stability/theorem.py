"""The complete list as part of the theorem about a curve (section 18.7)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import ctx

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve import Conclusion, ProvedCurve
from orbitproof.verify.distances import is_distance_of_orbits
from orbitproof.verify.evidence import (
    EmptyIntersectionError,
    IntegrationFailure,
    NotEstablishedError,
    Proved,
    Reason,
    hypothesis_to_json,
)
from orbitproof.verify.stability.across_list import list_across
from orbitproof.verify.stability.complete_list import PRECISION, complete_list
from orbitproof.verify.stability.linear_stability import stable_intervals
from orbitproof.verify.stability.statement import statement, statement_across

_EMPTY: dict[str, Any] = {
    name: [] for name in ("hypotheses", "points", "stable", "undecided", "gaps", "extrema", "open_extrema")
}


def with_complete_list(
    atlas: Atlas, results: Sequence[Mapping[str, Any]], conclusion: Conclusion[ProvedCurve], order: int
) -> dict[str, Any]:
    """The JSON object of a conclusion with all resonances up to an order, and the theorem about them.

    Args:
        results: of the pieces, as JSON, with what is known of the stability of their orbits.
    """
    document = conclusion.to_json()
    if not is_distance_of_orbits(atlas.system, atlas.claim.symmetry):
        results = [_without_distance(result) for result in results]
    nothing = _EMPTY | {"order": order}
    if not isinstance(conclusion.outcome, Proved):
        return {**document, "complete": nothing}
    chain = conclusion.outcome.results.chain
    with ctx.workprec(PRECISION):
        try:
            found = complete_list(atlas, chain, results, order, conclusion.bifurcations)
            across = list_across(atlas, chain, found, conclusion.bifurcations)
        except EmptyIntersectionError as error:
            message = f"the complete list and the certificates contradict each other: {error}"
            return {**_refused(document, Reason("complete", message, "report this")), "complete": nothing}
        except (NotEstablishedError, IntegrationFailure) as error:
            return {**_refused(document, error.reason), "complete": nothing}
        stable, unknown = stable_intervals(chain, found, atlas.claim.kind == "loop")
        words = statement(atlas, found, stable, unknown)
        if across is not None:
            words = f"{words}\n{statement_across(atlas, across)}"
    return {
        **document,
        "statement": f"{document['statement']}\n{words}",
        "complete": {
            "order": found.order,
            "hypotheses": [hypothesis_to_json(hypothesis) for hypothesis in found.hypotheses],
            "stability_parameters": found.parameters,
            "points": [point.to_json() for point in found.points],
            "stable": [entry.to_json() for entry in stable],
            "undecided": [entry.to_json() for entry in unknown],
            "gaps": [gap.to_json() for gap in found.gaps],
            "extrema": [entry.to_json() for entry in found.extrema],
            "open_extrema": [gap.to_json() for gap in found.open_extrema],
            **({} if across is None else {"out_of_plane": across.to_json()}),
        },
    }


def _refused(document: Mapping[str, Any], reason: Reason) -> dict[str, Any]:
    return {**document, "verdict": "not proved", "reason": reason.to_json(), "statement": ""}


def _without_distance(result: Mapping[str, Any]) -> Mapping[str, Any]:
    known = {key: value for key, value in result.get("stability", {}).items() if key != "distance"}
    return {**result, "stability": known} if known else result
