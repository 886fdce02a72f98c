"""The theorem about a curve of periodic orbits, from proved pieces (section 26.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, ctx

from orbitproof.shared.formats import PeriodicAtlas
from orbitproof.verify.curve import CURVE_PRECISION, Chain, Conclusion, Ends, IntervalResult, times_of
from orbitproof.verify.evidence import Checklist, EmptyIntersectionError, NotEstablishedError, NotProved, Proved, Reason
from orbitproof.verify.periodic_curve.conditions import check_periodic_curve, hypotheses_of
from orbitproof.verify.periodic_curve.counted import CountedPart, counted_along
from orbitproof.verify.periodic_curve.turns import Turn, turns_of


@dataclass(frozen=True)
class PeriodicCurveTheorem:
    """The pieces of an atlas are one curve of periodic orbits, as its claim says (Theorem 26.4)."""

    atlas: PeriodicAtlas

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return hypotheses_of(self.atlas)


@dataclass(frozen=True)
class ProvedPeriodicCurve:
    """What is known of a proved curve.

    Attributes:
        chain: its pieces, glued.
        ends: enclosures of the coordinates of its first and last point.
        period: contains the least periods of all its orbits; not finite if they are not all known.
        turns: where the parameter has extrema along the curve, as far as that is certain; none without a parameter.
        multipliers: its parts, by how many multipliers lie where; none if they are not known.
    """

    chain: Chain
    ends: Ends
    period: arb
    turns: tuple[Turn, ...] = ()
    multipliers: tuple[CountedPart, ...] = ()


def conclude_periodic(atlas: PeriodicAtlas, results: Sequence[IntervalResult]) -> Conclusion[ProvedPeriodicCurve]:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    Args:
        atlas: the claim; that the results are about its pieces as they are is for the caller.
        results: one for each interval of each piece.
    """
    checklist = Checklist()
    with ctx.workprec(CURVE_PRECISION):
        try:
            chain = check_periodic_curve(checklist, atlas, results)
            names = atlas.coordinates
            ends = {key: dict(zip(names, end, strict=True)) for key, end in zip(_ENDS, chain.ends, strict=True)}
            turns = () if atlas.claim.parameter is None else turns_of(chain)
            counted = counted_along(atlas, chain, results)
        except NotEstablishedError as error:
            return Conclusion(NotProved(error.reason, tuple(checklist.hypotheses)))
        except EmptyIntersectionError as error:
            reason = Reason("results", f"pieces contradict each other: {error}", "report this")
            return Conclusion(NotProved(reason, tuple(checklist.hypotheses)))
        curve = ProvedPeriodicCurve(chain, ends, times_of(chain), turns, counted)
    return Conclusion(Proved(PeriodicCurveTheorem(atlas), curve, tuple(checklist.hypotheses)))


_ENDS = ("start", "end")
