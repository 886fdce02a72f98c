"""The theorem about a curve of symmetric periodic orbits, from proved pieces (section 15.9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve.bifurcations_on_it import (
    Bifurcation,
    CertifiedPoint,
    Partner,
    no_partner,
    place_bifurcation,
)
from orbitproof.verify.curve.conclusion import Conclusion, Ends
from orbitproof.verify.curve.conditions import check_curve, hypotheses_of
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.curve.piece_result import IntervalResult
from orbitproof.verify.evidence import (
    Checklist,
    EmptyIntersectionError,
    NotEstablishedError,
    NotProved,
    Proved,
    Reason,
    all_finite,
    hull,
    meet,
)

PRECISION = 256
"""Bits of the ball arithmetic: far more than double numbers in the pieces, and certificates, have."""


@dataclass(frozen=True)
class CurveTheorem:
    """The pieces of an atlas are one curve of symmetric periodic orbits, as its claim says (Theorem 15.5)."""

    atlas: Atlas

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return hypotheses_of(self.atlas)


@dataclass(frozen=True)
class ProvedCurve:
    """What is known of a proved curve.

    Attributes:
        chain: its pieces, glued.
        ends: enclosures of the coordinates of its first and last point.
        half_period: contains the half periods of all its orbits; not finite if they are not all known.
        x_l: the libration point on its axis, if the system is written around one.
    """

    chain: Chain
    ends: Ends
    half_period: arb
    x_l: arb | None = None


def conclude(
    atlas: Atlas,
    results: Sequence[IntervalResult],
    bifurcations: Sequence[CertifiedPoint] = (),
    partner: Partner = no_partner,
) -> Conclusion[ProvedCurve]:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    Args:
        atlas: the claim about a curve; that the results are about its pieces as they are is for the caller.
        results: one for each interval of each piece, see `verify.curve.proved_intervals.read_results`.
        bifurcations: points that may lie on the curve, of certificates.
        partner: encloses the other point of a symmetric orbit on Fix(R), by integration.
    """
    checklist = Checklist()
    with ctx.workprec(PRECISION):
        try:
            chain = check_curve(checklist, atlas, results)
        except NotEstablishedError as error:
            unplaced = tuple(place_bifurcation(atlas, None, entry, partner) for entry in bifurcations)
            return Conclusion(NotProved(error.reason, tuple(checklist.hypotheses)), unplaced)
        placed: tuple[Bifurcation, ...] = ()
        try:
            placed = tuple(place_bifurcation(atlas, chain, entry, partner) for entry in bifurcations)
            curve = ProvedCurve(chain, _ends(atlas, chain, placed), times_of(chain), _libration_point(atlas))
        except (EmptyIntersectionError, NotEstablishedError) as error:
            reason = Reason(
                "bifurcations", f"curve, parameters and certificates contradict each other: {error}", "report this"
            )
            return Conclusion(NotProved(reason, tuple(checklist.hypotheses)), placed)
    return Conclusion(Proved(CurveTheorem(atlas), curve, tuple(checklist.hypotheses)), placed)


def _libration_point(atlas: Atlas) -> arb | None:
    """The libration point on its axis, if the system is written around one."""
    if not atlas.system.derived_parameters:
        return None
    from orbitproof.verify.curve.lyapunov_family import libration_point

    return libration_point(atlas.system, atlas.parameters)


def _ends(atlas: Atlas, chain: Chain, placed: Sequence[Bifurcation]) -> Ends:
    """The coordinates of the ends; a symmetry breaking on the curve is its symmetric point, known from there too."""
    names = atlas.system.centre_coordinates
    result = {key: dict(zip(names, end, strict=True)) for key, end in zip(("start", "end"), chain.ends, strict=True)}
    for entry in placed:
        if entry.place is None or entry.place.other_point or not entry.place.s.is_zero():
            continue
        first, last = chain.stretches[0], chain.stretches[-1]
        for key, stretch, s in (("start", first, first.enters), ("end", last, last.leaves)):
            if s == 0 and stretch.tube.is_symmetric and entry.place.piece == stretch.tube.piece.id:
                result[key] = {name: meet(ball, entry.point[name]) for name, ball in result[key].items()}
    return result


def times_of(chain: Chain) -> arb:
    """A ball that contains the times of all orbits of the curve; not finite if they are not all known."""
    times = [
        part.time for stretch in chain.stretches for part, _, _ in stretch.run.between(stretch.enters, stretch.leaves)
    ]
    return hull(times[0], *times[1:]) if all_finite(times) else arb(float("nan"))
