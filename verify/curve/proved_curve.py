"""The theorem about a curve of symmetric periodic orbits, from proved pieces (section 15.9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve.conclusion import Conclusion, Ends
from orbitproof.verify.curve.conditions import check_curve, hypotheses_of
from orbitproof.verify.curve.followed import Follow, Partner, follow_nothing, no_partner
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits, is_of_doublings
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

if TYPE_CHECKING:
    from orbitproof.verify.curve.bifurcations_on_it import Bifurcation, CertifiedPoint
    from orbitproof.verify.curve.birth_piece import Birth

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
        birth: where the orbits at its end come from, if that is claimed (16.12, 16.14).
    """

    chain: Chain
    ends: Ends
    half_period: arb
    x_l: arb | None = None
    birth: Birth | None = None


def conclude(
    atlas: Atlas,
    results: Sequence[IntervalResult],
    bifurcations: Sequence[CertifiedPoint] = (),
    partner: Partner = no_partner,
    follow: Follow = follow_nothing,
) -> Conclusion[ProvedCurve]:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    Args:
        atlas: the claim about a curve; that the results are about its pieces as they are is for the caller.
        results: one for each interval of each piece, see `verify.curve.proved_intervals.read_results`.
        bifurcations: points that may lie on the curve, of certificates.
        partner: encloses the other point of a symmetric orbit on Fix(R), by integration.
        follow: encloses where an orbit meets the section, by integration.
    """

    def placed_on(chain: Chain | None, birth: Birth | None) -> tuple[Bifurcation, ...]:
        if is_of_doublings(atlas.system):
            from orbitproof.verify.curve.doubled_family import place_doubling

            return tuple(place_doubling(atlas, chain, entry, follow) for entry in bifurcations)
        if is_of_axial_orbits(atlas.system):
            from orbitproof.verify.curve.lifted_family import place_birth

            return tuple(place_birth(atlas, chain, birth, entry, follow) for entry in bifurcations)
        return tuple(_placed(atlas, chain, birth, entry, partner, follow) for entry in bifurcations)

    checklist = Checklist()
    with ctx.workprec(PRECISION):
        try:
            chain = check_curve(checklist, atlas, results)
            birth = _birth(checklist, atlas, chain, results, follow)
        except NotEstablishedError as error:
            return Conclusion(NotProved(error.reason, tuple(checklist.hypotheses)), placed_on(None, None))
        placed: tuple[Bifurcation, ...] = ()
        try:
            placed = placed_on(chain, birth)
            curve = ProvedCurve(chain, _ends(atlas, chain, placed), times_of(chain), _libration_point(atlas), birth)
        except (EmptyIntersectionError, NotEstablishedError) as error:
            reason = Reason(
                "bifurcations", f"curve, parameters and certificates contradict each other: {error}", "report this"
            )
            return Conclusion(NotProved(reason, tuple(checklist.hypotheses)), placed)
    return Conclusion(Proved(CurveTheorem(atlas), curve, tuple(checklist.hypotheses)), placed)


def _placed(
    atlas: Atlas, chain: Chain | None, birth: Birth | None, entry: CertifiedPoint, partner: Partner, follow: Follow
) -> Bifurcation:
    """Whether the point of a certificate lies on the curve, or is the doubling at which its orbits are born."""
    if birth is None or entry.k == 1 or entry.crossings == atlas.claim.crossings:
        from orbitproof.verify.curve.bifurcations_on_it import place_bifurcation

        return place_bifurcation(atlas, chain, entry, partner)
    from orbitproof.verify.curve.doubling_birth import place_doubling_at_birth

    return place_doubling_at_birth(birth, entry, follow)


def _birth(
    checklist: Checklist, atlas: Atlas, chain: Chain, results: Sequence[IntervalResult], follow: Follow
) -> Birth | None:
    """Where the orbits at the end of the curve come from, if that is claimed."""
    if not atlas.birth_pieces():
        return None
    if is_of_axial_orbits(atlas.system):
        from orbitproof.verify.curve.lifted_family import check_birth

        return check_birth(checklist, atlas, chain, results, follow)
    from orbitproof.verify.curve.doubling_birth import check_birth_at_doubling

    return check_birth_at_doubling(checklist, atlas, chain, results, follow)


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
