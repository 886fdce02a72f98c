"""How two arcs of a life are joined: where on a curve of equilibria orbits are born (section 39.2)."""

from __future__ import annotations

from dataclasses import dataclass

from orbitproof.shared.claims.life import Joining, LifeJoint
from orbitproof.verify.curve import PlaceOnCurve, is_inside_curve, locate, lower_end, upper_end
from orbitproof.verify.equilibrium_curve import ProvedEquilibriumCurve, Sides
from orbitproof.verify.evidence import EmptyIntersectionError
from orbitproof.verify.life.arc import Birth, LifeCurve


@dataclass(frozen=True)
class Birthplace:
    """A curve of orbits begins, or ends, at an equilibrium of a curve of equilibria.

    Attributes:
        arc, on: ids of both.
        how: as in the claim.
        place: of the equilibrium on the latter.
        birth: the equilibrium.
        before, after: how many eigenvalues the equilibria on the nearest parts of the curve have left and right of the
            imaginary axis, of which that is decided; `None` if there is no such part.
    """

    arc: str
    on: str
    how: Joining
    place: PlaceOnCurve
    birth: Birth
    before: Sides | None
    after: Sides | None


def joint_shown(arc: LifeCurve, joint: LifeJoint, on: LifeCurve) -> Birthplace | str:
    """The joint of a proved arc with another one if it is as claimed, or why that is not shown (Lemma 39.2)."""
    birth = arc.births.get(joint.how)
    if birth is None:
        return "no orbits are proved to be born there"
    if not isinstance(on.curve, ProvedEquilibriumCurve):
        return "the other is no curve of equilibria"
    place = locate(on.atlas, on.curve.chain, [birth.point[name] for name in on.atlas.coordinates])
    if isinstance(place, str):
        return place
    if not is_inside_curve(on.atlas, on.curve.chain, place):
        return "it is not shown to be before the end of the other"
    return Birthplace(arc.id, on.id, joint.how, place, birth, *_beside(on.curve, place))


def _beside(curve: ProvedEquilibriumCurve, place: PlaceOnCurve) -> tuple[Sides | None, Sides | None]:
    """The counts on the nearest parts of the curve before and after a birth on which they are decided (39.2).

    Raises `EmptyIntersectionError` if one is decided at the birth itself.
    """
    order = {stretch.tube.piece.id: number for number, stretch in enumerate(curve.chain.stretches)}
    here, low, high = order[place.piece], lower_end(place.s), upper_end(place.s)
    before = after = None
    for part in curve.sides:
        (first, last), (begin, end) = (order[name] for name in part.pieces), part.between
        # No eigenvalue is on the axis there, so the birth does not lie in it.
        begins_before = first < here or (first == here and begin <= low)
        ends_after = last > here or (last == here and end >= high)
        if part.sides is None:
            continue
        if begins_before and ends_after:
            raise EmptyIntersectionError(f"the eigenvalues at it are counted on {place.piece}, and none is on the axis")
        if begins_before:
            before = part.sides
        elif ends_after:
            after = after or part.sides
        else:
            return None, None
    return before, after
