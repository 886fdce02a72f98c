"""The list of resonances and stability of variations out of the plane of motion (section 18.11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import AXIAL
from orbitproof.verify.claim import is_left_alone
from orbitproof.verify.curve import Bifurcation, Chain
from orbitproof.verify.evidence import excludes_zero
from orbitproof.verify.stability.complete_list import Finder, orders, resonant_value
from orbitproof.verify.stability.kinds import Kind, Matter
from orbitproof.verify.stability.linear_stability import StableInterval, stable_intervals
from orbitproof.verify.stability.list_entries import CompleteList, Gap, Point, Segment
from orbitproof.verify.stability.matching import with_certificates

_ENTRIES = {
    (1, 0): ((Kind.ACROSS_AXIAL, 1), (Kind.ACROSS_SYMMETRIC, 2)),
    (2, 1): ((Kind.ACROSS_DOUBLING, 0), (Kind.ACROSS_DOUBLING, 3)),
}
"""For the values 1 and -1 of the stability parameter, the entries of V that vanish there."""


@dataclass(frozen=True)
class ListAcross:
    """What is proved of variations out of the plane along a curve.

    Attributes:
        found: the list.
        stable, unknown: intervals between which they are stable, and of which nothing is known.
        jacobi_constants: at the points of the list, `None` where there is none.
    """

    found: CompleteList
    stable: tuple[StableInterval, ...]
    unknown: tuple[StableInterval, ...]
    jacobi_constants: tuple[arb | None, ...]


def _away_from_centre(point: Point) -> Point:
    """In units of the orbit (18.9): at the libration point itself, where its size is 0, nothing begins."""
    is_birth = point.kind.is_birth
    return replace(point, kind=Kind.UNDECIDED) if is_birth and not excludes_zero(point.level) else point


def _jacobi_constant(atlas: Atlas, point: Point) -> arb | None:
    """Jacobi constant of an orbit of a family around a libration point; `None` for others."""
    if not atlas.system.derived_parameters:
        return None
    from orbitproof.verify.curve import jacobi_constant

    return jacobi_constant(atlas.system, atlas.parameters, point.point)


def list_across(
    atlas: Atlas, chain: Chain, plane: CompleteList, bifurcations: Sequence[Bifurcation]
) -> ListAcross | None:
    """The list for the values of that of the orbits in the plane; `None` if the system is no motion in a plane.

    Nor is there one if a symmetry of the claim is not shown to be one of the variations (section 21.1).

    Raises `EmptyIntersectionError` if a certified symmetry breaking on the curve is not in it.
    """
    if not is_left_alone(atlas.system.stiffness_across_program, atlas.system, atlas.claim.symmetry):
        return None
    points: list[Point] = []
    gaps = [gap for gap in plane.gaps if gap.subject is Matter.EVERYTHING]
    segments: list[Segment] = []
    for segment in plane.segments:
        stretch = chain.stretches[segment.stretch]
        known = segment.out_of_plane
        if known is None:
            why = "variations out of the plane are not enclosed"
            gaps.append(Gap(segment.stretch, stretch.tube.piece.id, segment.start, segment.end, Matter.EVERYTHING, why))
            continue
        across = replace(segment, characteristic=(known.parameter,))
        finder = Finder(atlas, stretch, across)
        for k, j in orders(plane.order):
            for kind, entry in _ENTRIES.get((k, j), ((Kind.RESONANCE, None),)):
                function = across.at(resonant_value(k, j)) if entry is None else known.entries[entry]
                finder.add(function, k, j, kind)
        points += finder.points
        gaps += finder.gaps
        segments.append(across)
    if atlas.system.normalised:
        points = [_away_from_centre(point) for point in points]
    points.sort(key=lambda entry: (entry.stretch, entry.s.mid()))
    births = [entry for entry in bifurcations if entry.breaks_symmetry]
    for kind, reversor in ((Kind.ACROSS_SYMMETRIC, None), (Kind.ACROSS_AXIAL, AXIAL)):
        here = [number for number, point in enumerate(points) if point.kind is kind]
        own = [entry for entry in births if entry.reversor == reversor]
        for number, point in zip(here, with_certificates([points[n] for n in here], gaps, own), strict=True):
            points[number] = point
    found = CompleteList(plane.order, 1, tuple(points), tuple(gaps), tuple(segments))
    stable, unknown = stable_intervals(chain, found, atlas.claim.goes_round)
    constants = tuple(_jacobi_constant(atlas, point) for point in points)
    return ListAcross(found, tuple(stable), tuple(unknown), constants)
