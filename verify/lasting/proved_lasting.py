"""Stability for ever as part of the theorem about a curve (section 29.6)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import cast

from flint import ctx

from orbitproof.shared.formats import Atlas
from orbitproof.verify.evidence import NotProved, Proved, Reason
from orbitproof.verify.lasting.fates import LEAST_ORDER, LastingList, lasting_list
from orbitproof.verify.lasting.reversibility import Reversibility, reversibility
from orbitproof.verify.lasting.stored import CurveIntervalResult, is_known_of
from orbitproof.verify.stability import PRECISION, ListConclusion, ListTheorem, ProvedList


@dataclass(frozen=True)
class LastingTheorem(ListTheorem):
    """The theorem of a list, and where the orbits are stable for ever (Theorem 29.9)."""


@dataclass(frozen=True)
class ProvedLasting(ProvedList):
    """What is known of a curve with its list.

    Attributes:
        lasting: which orbits are stable for ever, and the exceptions.
        reversibility: what shows that the enclosures agree with reversibility, where the twist is known.
    """

    lasting: LastingList
    reversibility: Reversibility | None


def conclude_lasting(
    atlas: Atlas,
    results: Sequence[CurveIntervalResult],
    listed: ListConclusion,
    begun: Callable[[int], None] = lambda number: None,
) -> ListConclusion:
    """Stability for ever of the orbits of a curve, and the theorem about it.

    Args:
        results: of the pieces, with what is known of the twist.
        listed: what they prove of the curve and its resonances.
        begun: called with the number of a stretch of the curve before a part of it is looked at.
    """
    outcome = listed.outcome
    if not isinstance(outcome, Proved):
        return listed
    theorem, known = cast(ListTheorem, outcome.theorem), outcome.results
    if not is_known_of(atlas.system) or listed.order < LEAST_ORDER:
        message = f"stability for ever is known for n = 1 only, with all resonances up to k = {LEAST_ORDER}"
        reason = Reason("lasting", message, "give `complete` a larger number, or leave `lasting` out")
        return replace(listed, outcome=NotProved(reason, outcome.hypotheses))
    with ctx.workprec(PRECISION):
        try:
            shown = reversibility(results)
        except ValueError as error:
            reason = Reason("lasting", f"{error}: an enclosure is wrong", "report it together with the atlas")
            return replace(listed, outcome=NotProved(reason, outcome.hypotheses))
        lasting = lasting_list(atlas, known.curve.chain, known.found, results, begun)
    proved = ProvedLasting(**vars(known), lasting=lasting, reversibility=shown)
    return replace(listed, outcome=Proved(LastingTheorem(theorem.curve, theorem.order), proved, outcome.hypotheses))
