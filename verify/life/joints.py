"""How two arcs of a life are joined: where on a curve of equilibria orbits are born (section 39.2)."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from orbitproof.shared.claims.life import BEGINS, Joining, LifeJoint
from orbitproof.verify.birth_curve import ProvedBirthCurve
from orbitproof.verify.curve import PlaceOnCurve, is_inside_curve, locate, lower_end, upper_end
from orbitproof.verify.equilibrium.spectrum import Spectrum
from orbitproof.verify.equilibrium_curve import ProvedEquilibriumCurve, Sides
from orbitproof.verify.evidence import EmptyIntersectionError
from orbitproof.verify.life.arc import LifeCurve


@dataclass(frozen=True)
class Birthplace:
    """A curve of orbits begins at an equilibrium of a curve of equilibria.

    Attributes:
        arc, on: ids of both.
        how: as in the claim.
        place: of the equilibrium on the latter.
        value: of the parameter there.
        point: the equilibrium, by coordinate.
        frequency: omega of its eigenvalues +- i omega.
        others: the other eigenvalues (38.5).
        before, after: how many eigenvalues the equilibria on the nearest parts of the curve have left and right of the
            imaginary axis, of which that is decided; `None` if there is no such part.
    """

    arc: str
    on: str
    how: Joining
    place: PlaceOnCurve
    value: arb
    point: dict[str, arb]
    frequency: arb
    others: Spectrum
    before: Sides | None
    after: Sides | None


def joint_shown(arc: LifeCurve, joint: LifeJoint, on: LifeCurve) -> Birthplace | str:
    """The joint of a proved arc with another one if it is as claimed, or why that is not shown (Lemma 39.2)."""
    if joint.how != BEGINS:
        return "there is no such way to be joined"
    point = arc.birth
    if point is None or not isinstance(arc.curve, ProvedBirthCurve):
        return "it is no curve of orbits from their birth on"
    if not isinstance(on.curve, ProvedEquilibriumCurve):
        return "the other is no curve of equilibria"
    place = locate(on.atlas, on.curve.chain, [point[name] for name in on.atlas.coordinates])
    if isinstance(place, str):
        return place
    if not is_inside_curve(on.atlas, on.curve.chain, place):
        return "it is not shown to begin before the end of the other"
    value = point.pop(on.atlas.claim.parameter)
    about = arc.curve.frequency, arc.curve.eigenvalues
    return Birthplace(arc.id, on.id, joint.how, place, value, point, *about, *_beside(on.curve, place))


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
