"""The complete list as part of the theorem about a curve (section 18.7)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from flint import ctx

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve import Chain, Conclusion, CurveTheorem, ProvedCurve
from orbitproof.verify.distances import is_distance_of_orbits
from orbitproof.verify.evidence import (
    EmptyIntersectionError,
    IntegrationFailure,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
)
from orbitproof.verify.stability.complete_list import PRECISION, complete_list
from orbitproof.verify.stability.linear_stability import StableInterval, stable_intervals
from orbitproof.verify.stability.list_entries import CompleteList
from orbitproof.verify.stability.stored_stability import StabilityFunctions, StabilityResult

if TYPE_CHECKING:
    from orbitproof.verify.curve import Bifurcation
    from orbitproof.verify.stability.across_list import ListAcross


@dataclass(frozen=True)
class ListTheorem:
    """The resonances and stable orbits of a proved curve up to an order (Theorem 18.5).

    Its own hypotheses stand in the list, beside those of the curve.
    """

    curve: CurveTheorem
    order: int

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`: those of the curve."""
        return self.curve.hypotheses


@dataclass(frozen=True)
class ProvedList:
    """What is known of a curve with its list.

    Attributes:
        curve: the curve.
        found: resonances, collisions, extrema.
        stable, unknown: intervals between which orbits are linearly stable, and of which nothing is known.
        across: the same of variations out of the plane, where there are any.
    """

    curve: ProvedCurve
    found: CompleteList
    stable: tuple[StableInterval, ...]
    unknown: tuple[StableInterval, ...]
    across: ListAcross | None


@dataclass(frozen=True)
class ListConclusion:
    """What the pieces of an atlas prove together of a curve and of its list.

    Attributes:
        curve: what they prove of the curve; without it there is no list.
        order: the largest k that is asked for.
        outcome: the theorem about both, or why it is not proved.
    """

    curve: Conclusion[ProvedCurve]
    order: int
    outcome: Outcome[ProvedList]


def conclude_list(
    atlas: Atlas,
    results: Sequence[StabilityResult],
    curve: Conclusion[ProvedCurve],
    order: int,
    combinations: bool = False,
    begun: Callable[[int], None] = lambda number: None,
) -> ListConclusion:
    """All resonances up to an order on a curve, and the theorem about them.

    Args:
        results: of the pieces, with what is known of the stability of their orbits.
        curve: what they prove of the curve.
        combinations: whether combination resonances are listed too, for n = 2.
        begun: called with the number of each stretch of the curve before it is looked at.
    """

    def refused(reason: Reason) -> ListConclusion:
        return ListConclusion(curve, order, NotProved(reason, curve.outcome.hypotheses))

    if not isinstance(curve.outcome, Proved):
        return refused(curve.outcome.reason)
    if not is_distance_of_orbits(atlas.system, atlas.claim.symmetry):
        results = [_without_distance(result) for result in results]
    chain = curve.outcome.results.chain
    with ctx.workprec(PRECISION):
        try:
            found = complete_list(atlas, chain, results, order, curve.bifurcations, combinations, begun)
            across = _across(atlas, chain, found, curve.bifurcations)
        except EmptyIntersectionError as error:
            message = f"the complete list and the certificates contradict each other: {error}"
            return refused(Reason("complete", message, "report this"))
        except (NotEstablishedError, IntegrationFailure) as error:
            return refused(error.reason)
        stable, unknown = stable_intervals(chain, found, atlas.claim.goes_round)
    known = ProvedList(curve.outcome.results, found, tuple(stable), tuple(unknown), across)
    theorem = ListTheorem(CurveTheorem(atlas), order)
    return ListConclusion(curve, order, Proved(theorem, known, curve.outcome.hypotheses))


def _across(atlas: Atlas, chain: Chain, plane: CompleteList, bifurcations: Sequence[Bifurcation]) -> ListAcross | None:
    """The list of variations out of the plane, of motion in one."""
    if atlas.system.stiffness_across is None:
        return None
    from orbitproof.verify.stability.across_list import list_across

    return list_across(atlas, chain, plane, bifurcations)


def _without_distance(result: StabilityResult) -> StabilityResult:
    known = result.stability
    return replace(result, stability=replace(known, distance=None)) if isinstance(known, StabilityFunctions) else result
