"""Which certified bifurcations lie on a proved curve (section 15.8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import cast

from flint import acb, arb

from orbitproof.shared.claims import AnyAtlas, Atlas, OfKind
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.claim import signs_on
from orbitproof.verify.curve.followed import Partner, Point, no_partner
from orbitproof.verify.curve.gluing import Chain, Stretch
from orbitproof.verify.curve.tube import lower_end, upper_end
from orbitproof.verify.evidence import EmptyIntersectionError, all_finite, enclose, excludes_zero, is_below, symmetric

PLANAR = "S"
"""The symmetry of the CR3BP that fixes the planar orbits, z -> -z."""

LACKS_COORDINATES = "the certificate does not have all coordinates of the point"


@dataclass(frozen=True)
class CertifiedPoint(OfKind):
    """What a certificate proves of a point: that it lies on a symmetric orbit, and what orbit that is.

    Attributes:
        id, kind, k: of the certificate.
        problem: why it counts for nothing; empty if all else holds.
        is_foreign: whether that is since it is about another system, section, reversing symmetry, level or other
            parameters than the curve, or not readable here.
        parameters: exact values of its system's fixed parameters.
        reversor: the name of its reversing symmetry, if that is not R.
        crossings: how often half orbits meet the section.
        symmetry, signs: name and signs of the symmetry that breaks; `None` if none does.
        point: enclosures of its coordinates, by name.
        parameter_name, parameter: of the bifurcation.
        stability: enclosures of the stability parameters of one orbit; none of a bifurcation.
        other_point: enclosures of the coordinates of the orbit's other point on Fix(R), if they are known.
        shifted_by: symmetries that are shown to shift the orbit along itself by half its period.
        direction: of the orbits that are born where R is lost, by the names of coordinates that R negates.
    """

    id: str
    kind: str
    k: int
    problem: str = ""
    is_foreign: bool = False
    parameters: Mapping[str, Fraction] = field(default_factory=dict)
    reversor: str | None = None
    crossings: int = 1
    symmetry: str | None = None
    signs: tuple[int, ...] | None = None
    point: Point = field(default_factory=dict)
    parameter_name: str = ""
    parameter: arb | None = None
    stability: tuple[acb, ...] = ()
    other_point: Point | None = None
    shifted_by: tuple[str, ...] = ()
    direction: Point | None = None

    @property
    def is_planar(self) -> bool:
        """Whether, of the CR3BP, it is an orbit in the plane: where S breaks, the orbit itself is fixed by it (8.6)."""
        return self.breaks_symmetry and self.symmetry == PLANAR


@dataclass(frozen=True)
class PlaceOnCurve:
    """A point of the curve.

    Attributes:
        piece: id of the piece.
        s: enclosure of its s.
        mirrored: whether it is the mirror image that lies in the piece.
        other_point: whether it is the other point of the orbit on Fix(R).
    """

    piece: str
    s: arb
    mirrored: bool
    other_point: bool = False


@dataclass(frozen=True)
class Bifurcation(OfKind):
    """A certificate of a bifurcation, or of one orbit, and whether the point lies on the curve.

    Attributes:
        id, kind, k: of the certificate.
        place: where on the curve, or `None` if it is not shown to lie on it.
        reason: why not; empty if it does.
        point: enclosure of the bifurcation point, by coordinate name; empty if the certificate proves nothing.
        parameter_name: name of the bifurcation parameter.
        parameter: its enclosure, or `None`.
        is_foreign: whether it is about another system, section, reversing symmetry, level or other parameters than the
            curve, or not readable here.
        reversor: the name of its reversing symmetry, if that is not R.
        stability: enclosures of the stability parameters of one orbit; none of a bifurcation.
    """

    id: str
    kind: str
    k: int
    place: PlaceOnCurve | None
    reason: str
    point: Point
    parameter_name: str = ""
    parameter: arb | None = None
    is_foreign: bool = False
    reversor: str | None = None
    stability: tuple[acb, ...] = ()

    def found(self, place: PlaceOnCurve | str) -> Bifurcation:
        """The bifurcation with its place on the curve, or with why it has none."""
        return replace(self, place=place) if isinstance(place, PlaceOnCurve) else replace(self, reason=place)


def entry_of(certified: CertifiedPoint) -> Bifurcation:
    """A certificate before its point is looked for; with a reason if it counts for nothing."""
    entry = Bifurcation(certified.id, certified.kind, certified.k, None, certified.problem, {})
    if certified.problem:
        return replace(entry, is_foreign=certified.is_foreign)
    return replace(
        entry,
        point=certified.point,
        parameter_name=certified.parameter_name,
        parameter=certified.parameter,
        reversor=certified.reversor,
        stability=certified.stability,
    )


def place_bifurcation(
    atlas: Atlas, chain: Chain | None, certified: CertifiedPoint, partner: Partner = no_partner
) -> Bifurcation:
    """Whether the point of a certificate lies on the curve.

    `chain` is `None` if the curve itself is not proved. `partner` encloses the other point of a symmetric orbit on
    Fix(R).
    """
    entry = Bifurcation(certified.id, certified.kind, certified.k, None, certified.problem, {})
    if certified.problem:
        return replace(entry, is_foreign=certified.is_foreign)
    crossings = certified.crossings
    wanted = _crossings_of(atlas)
    if crossings != wanted:
        reason = f"its half orbits meet the section {crossings} times, those of the curve {wanted}"
        return replace(entry, reason=reason)
    point = _in_coordinates_of(atlas, certified, partner)
    if isinstance(point, str):
        return replace(entry, reason=point)
    entry = replace(
        entry,
        point=point,
        parameter_name=certified.parameter_name,
        parameter=certified.parameter,
        reversor=certified.reversor,
        stability=certified.stability,
    )
    if chain is None:
        return replace(entry, reason="the curve itself is not proved")
    # By what it does: another system of the same name may call another symmetry so.
    own = atlas.system.symmetries.get(str(atlas.claim.symmetry))
    breaks = entry.breaks_symmetry and own is not None and certified.signs == own
    place = locate(atlas, chain, list(point.values()), breaks)
    if isinstance(place, PlaceOnCurve):
        return replace(entry, place=place)
    if not atlas.system.derived_parameters:
        # On a fixed level that certificate does not say on which sheet P(x) is; its enclosure by integration does.
        known = certified.other_point if atlas.system.fixed_level is None else None
        second = known or partner(atlas.system, atlas.parameters, point, crossings)
        found_there = None if second is None else locate(atlas, chain, [second[name] for name in point], False)
        if isinstance(found_there, PlaceOnCurve):
            return replace(entry, place=replace(found_there, other_point=True))
    return replace(entry, reason=place)


def _crossings_of(atlas: Atlas) -> int:
    """How often half orbits of the curve meet the section in the system in which its points are certified."""
    if atlas.system.derived_parameters:
        from orbitproof.verify.curve.vertical_family import CROSSINGS, vertical_point

        if vertical_point(atlas.system) is not None:
            return CROSSINGS
    return atlas.claim.crossings


def _in_coordinates_of(atlas: Atlas, certified: CertifiedPoint, partner: Partner) -> Point | str:
    """The point by the coordinates of the curve, in their order, or why it is none of the curve's."""
    if atlas.system.derived_parameters:
        from orbitproof.verify.curve.lyapunov_family import carried
        from orbitproof.verify.curve.vertical_family import carried_vertical, vertical_point

        if vertical_point(atlas.system) is None:
            return carried(atlas, certified)
        return carried_vertical(atlas, certified, partner)
    names = atlas.system.centre_coordinates
    if not set(names) <= set(certified.point):
        return LACKS_COORDINATES
    # Of the CR3BP, and the curve is one of planar orbits (16.5).
    if set(certified.point) - set(names) and not certified.is_planar:
        return "it is not shown to be a planar orbit"
    return {name: certified.point[name] for name in names}


def locate(
    atlas: AnyAtlas, chain: Chain, point: Sequence[arb], is_symmetry_breaking: bool = False
) -> PlaceOnCurve | str:
    """Where on the curve a point lies that is given by enclosures of its coordinates, or why nowhere.

    It has to be a zero of the curve's equations, which is what bifurcations of every kind are. If it
    `is_symmetry_breaking`, for the symmetry of the atlas, the point is fixed by it and may be a symmetric point of
    the curve.
    """
    if not all_finite(point):
        return "its enclosure is not finite"
    images = [(list(point), False)]
    if atlas.claim.is_of_symmetric_curve:
        system = cast(ReversibleSystem, atlas.system)
        signs = signs_on(system, str(atlas.claim.symmetry), system.centre_coordinates)
        images.append(([sign * ball for sign, ball in zip(signs, point, strict=True)], True))
    misses: list[tuple[arb, str]] = []
    for image, mirrored in images:
        for stretch in chain.stretches:
            found = _in_stretch(stretch, image, is_symmetry_breaking)
            if isinstance(found, arb):
                return PlaceOnCurve(stretch.tube.piece.id, found, mirrored)
            if found is not None:
                misses.append(found)
    if not misses:
        return "it lies beyond the ends of all pieces"
    return min(misses, key=lambda miss: upper_end(miss[0]))[1]


def is_inside_curve(atlas: AnyAtlas, chain: Chain, place: PlaceOnCurve) -> bool:
    """Whether the place certainly is none of the ends of the curve."""
    claim, first, last = atlas.claim, chain.stretches[0], chain.stretches[-1]
    if claim.is_closed:
        return True
    # The beginning of a symmetric arc is its symmetric point, on both sides of which it goes on.
    if not claim.is_of_symmetric_curve and place.piece == first.tube.piece.id and lower_end(place.s) <= first.entered:
        return False
    return not (place.piece == last.tube.piece.id and upper_end(place.s) >= last.leaves)


def _contradicts(stretch: Stretch, s: arb, offsets: Sequence[arb]) -> bool:
    """Whether a symmetric orbit in the tube lies farther off the polynomial than the only one there can (15.8)."""
    parts = stretch.run.between(lower_end(s), upper_end(s))
    return not any(
        all(ball.overlaps(symmetric(bound)) is True for ball, bound in zip(offsets, part.deviation, strict=True))
        for part, _, _ in parts
    )


def _in_stretch(stretch: Stretch, point: Sequence[arb], is_symmetry_breaking: bool) -> arb | tuple[arb, str] | None:
    """s of the point if it certainly lies on the stretch; else how far off it is, and in words; `None` if far away."""
    tube, name = stretch.tube, stretch.tube.piece.id
    p = tube.to_local(point)
    s = tube.parameter(p)
    if not s.is_finite() or is_below(s, enclose(stretch.enters)) or is_below(enclose(stretch.leaves), s):
        return None
    if tube.is_symmetric and not excludes_zero(s):
        if not is_symmetry_breaking:
            return arb(0), f"it is not shown to lie off the points of {name} that are fixed by the symmetry"
        s = arb(0)
    widths = [enclose(width) for width in tube.piece.tube]
    offsets = [ball / width for ball, width in zip(tube.offsets(s, p), widths, strict=True)]
    if not all_finite(offsets):
        return None
    if tube.contains(s, p) and stretch.contains(s):
        if _contradicts(stretch, s, tube.offsets(s, p)):
            raise EmptyIntersectionError(f"the tube of {name} has no such point so far off its polynomial")
        return s
    most = max((abs(ball) for ball in offsets), key=upper_end)
    if lower_end(most) >= 1:
        return most, f"it lies outside the tubes, in {name} by {float(lower_end(most)):.3g} half-widths or more"
    if any(upper_end(ball) - lower_end(ball) >= 1 for ball in offsets):
        return most, f"its enclosure is too wide for the tube of {name}; certify it in a smaller box"
    return most, f"it is not shown to lie on the part of {name} that is proved; more digits or a wider tube may decide"
