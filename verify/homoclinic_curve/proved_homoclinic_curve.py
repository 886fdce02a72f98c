"""Transverse homoclinic orbits on all levels of an interval: chapter 40 for every t (sections 42.3 to 42.5)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.claims.homoclinic_curve import HomoclinicCurve
from orbitproof.verify.algebra import ball_polynomial, values_around
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    all_finite,
    concluded,
    enclose,
    excludes_zero,
    hull,
    is_below,
    is_inside,
    is_outside,
    is_positive,
    show,
    symmetric,
)
from orbitproof.verify.homoclinic import along_manifold, check_homoclinic_exactly
from orbitproof.verify.homoclinic.following import Way, balls_of
from orbitproof.verify.homoclinic_curve.following import HomoclinicCurveEnclosures, width_of_slivers
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.poincare import WIDE_PARTS, wide_parts


@dataclass(frozen=True)
class HomoclinicCurveResults:
    """What is known of proved homoclinic orbits and of their periodic orbits, for all levels, in the system's units.

    Attributes:
        point: the coordinate p of the points of the periodic orbits on Fix(R), by name.
        period: of the periodic orbits.
        multiplier: the one of absolute value above 1.
        passage: a, from the middle of its interval, at the points of the homoclinic orbits on the graphs.
        meeting: the coordinates at which they meet Fix(R), by name.
        time: from the boxes to there.
        slopes: derivatives of p and of q at these meetings, along the unstable manifolds, by a.
    """

    point: Mapping[str, arb]
    period: arb
    multiplier: arb
    passage: arb
    meeting: Mapping[str, arb]
    time: arb
    slopes: tuple[arb, arb]


@dataclass(frozen=True)
class HomoclinicCurveTheorem:
    """On each level of a claim the periodic orbit has a transverse homoclinic orbit as claimed (Theorem 42.2)."""

    claim: HomoclinicCurve

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return "symmetries", "level", "return-map", "periodic", "cone", "arrival", "homoclinic", "transversal"


def check_homoclinic_curve_exactly(checklist: Checklist, claim: HomoclinicCurve) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    # They do not depend on the level.
    check_homoclinic_exactly(checklist, claim.middle)


def prove_homoclinic_curve(
    claim: HomoclinicCurve, checklist: Checklist, enclosures: HomoclinicCurveEnclosures | None
) -> Outcome[HomoclinicCurveResults]:
    """Check that there are orbits as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> HomoclinicCurveResults:
        proof = _Proof(claim, checklist, _checked(checklist, claim, enclosures))
        where = proof.fixed_points()
        multipliers = proof.cones(where)
        proof.slivers(where)
        changes = proof.meetings()
        slopes = proof.transversal()
        return proof.results(where, multipliers, changes, slopes)

    return concluded(HomoclinicCurveTheorem(claim), checklist, check)


def _checked(
    checklist: Checklist, claim: HomoclinicCurve, found: HomoclinicCurveEnclosures | None
) -> HomoclinicCurveEnclosures:
    """Every enclosure that is used is there and finite, times are positive, and the boxes return to their sheets."""
    statement = (
        "all orbits of the boxes cross the section as often as claimed and come back to the sheets with the claimed "
        "sign, and all orbits of the slivers cross it as often as claimed"
    )
    with checklist.hypothesis("return-map", "42.2", statement, "fewer levels, smaller radii") as evidence:
        evidence.require(found is not None, "there are no enclosures")
        if found is not None:
            ways = [*found.returned, *found.arrived]
            complete = len(found.returned) == len(found.arrived) == WIDE_PARTS
            complete = complete and all(len(each.slopes) == 2 for way in ways for each in way.functions)
            evidence.require(complete, "an enclosure is missing")
            finite = all_finite(balls_of(ways))
            evidence.require(finite, "an enclosure is not finite", needs_precision=True)
            if complete and finite:
                side = symmetric(claim.radii[0])
                sliver = [symmetric(claim.radii[1]), symmetric(width_of_slivers(claim))]
                w = evidence.record("w at the return", _all(way.w.value([side, side]) for way in found.returned))
                evidence.require(is_positive(claim.level_sign * w), "w may have the other sign")
                for name, part, box in (("return", found.returned, [side, side]), ("arrival", found.arrived, sliver)):
                    time = evidence.record(f"time of the {name}", _all(way.time.value(box) for way in part))
                    evidence.require(is_positive(time), "a time is not positive", needs_precision=True)
    assert found is not None
    return found


def _all(balls: Iterable[arb]) -> arb:
    """Encloses what is enclosed on the parts."""
    return hull(*balls)


@dataclass(frozen=True)
class _Proof:
    """The hypotheses, each on all parts of the interval of t."""

    claim: HomoclinicCurve
    checklist: Checklist
    found: HomoclinicCurveEnclosures

    def fixed_points(self) -> list[list[arb]]:
        """On each part, (a, s) of the one fixed point of the return in the box."""
        statement = "interval Newton: on each level the return map has exactly one fixed point inside the box"
        remedy = "fewer levels, or a better polynomial of c"
        radius, where = self.claim.radii[0], []
        with self.checklist.hypothesis("periodic", "42.3", statement, remedy) as evidence:
            for way in self.found.returned:
                (a_a, a_s), (s_a, s_s) = way.first.slopes, way.second.slopes
                matrix = [[a_a - 1, a_s], [s_a, s_s - 1]]
                evidence.require(is_regular(matrix), "the derivative may be singular", needs_precision=True)
                where.append(newton_image(matrix, [way.first.centre, way.second.centre]))
            for name, balls in zip("as", zip(*where, strict=True), strict=True):
                whole = evidence.record(name, _all(balls))
                outside = any(is_outside(ball, radius) for ball in balls)
                inside = all(is_inside(ball, radius) for ball in balls)
                message = f"{name} in {show(whole)} is not inside the box"
                evidence.require(inside, message, needs_precision=not outside, excluded=outside)
        return where

    def cones(self, where: list[list[arb]]) -> list[arb]:
        """On each part the cone is mapped into itself and stretched on the whole box; returns the multipliers."""
        statement = (
            "on each level the derivative of the return map takes the cone |ds| <= cone |da| into its interior and "
            "stretches its vectors in a, everywhere in the box; the cone about the fixed point leaves the box through "
            "the sides |a| = r alone"
        )
        cone, radius = enclose(self.claim.cone), enclose(self.claim.radii[0])
        stretches: list[arb] = []
        turns: list[arb] = []
        heights: list[arb] = []
        with self.checklist.hypothesis("cone", "42.3", statement, "fewer levels, or a wider cone") as evidence:
            for way, point in zip(self.found.returned, where, strict=True):
                (a_a, a_s), (s_a, s_s) = ([abs(ball) for ball in each.slopes] for each in (way.first, way.second))
                stretch = a_a - cone * a_s
                turned = (s_a + cone * s_s) / stretch
                evidence.require(is_below(arb(1), stretch), "vectors may not be stretched", needs_precision=True)
                evidence.require(is_below(turned, cone), f"an image may have the steepness {show(turned)}")
                a, s = map(abs, point)
                height = s + cone * (radius + a)
                evidence.require(is_below(height, radius), "the cone leaves the box elsewhere")
                evidence.require(is_below(radius + a, stretch * (radius - a)), "the fixed point is too far off")
                for kept, ball in ((stretches, stretch), (turns, turned), (heights, height)):
                    kept.append(ball)
            evidence.record("stretching", _all(stretches))
            evidence.record("steepness of the image", _all(turns))
            evidence.record("greatest |s| in the cone", _all(heights))
        return [along_manifold(self.claim.middle, way.first) for way in self.found.returned]

    def slivers(self, where: list[list[arb]]) -> None:
        """The slivers contain the unstable manifolds over the intervals, which are not at the fixed points."""
        statement = "each interval of a lies in the box, beside the fixed point, and the sliver contains the cone there"
        remedy = "give other intervals of a, or a better polynomial of c"
        cone, radius, half_width = map(enclose, (self.claim.cone, *self.claim.radii))
        width, heights = enclose(width_of_slivers(self.claim)), []
        middle = ball_polynomial(self.claim.polynomials[1])
        with self.checklist.hypothesis("arrival", "42.4", statement, remedy) as evidence:
            for part, point in zip(wide_parts(WIDE_PARTS), where, strict=True):
                a, s = map(abs, point)
                from_here = abs(values_around(middle, part.mid(), part.rad()))
                evidence.require(is_below(from_here + half_width, radius), "an interval leaves the box")
                beside = is_below(a, from_here - half_width)
                evidence.require(beside, "the fixed point may be in it", needs_precision=True)
                height = s + cone * (from_here + half_width + a)
                evidence.require(is_below(height, width), "the manifold may leave the sliver", needs_precision=True)
                heights.append(height)
            evidence.record("greatest |s| of the manifold", _all(heights))

    def meetings(self) -> list[arb]:
        """On each part, a at the point of the manifold that arrives in Fix(R), from the middle of the interval."""
        statement = (
            "interval Newton: on each level q has exactly one zero along the unstable manifold at the arrival, in the "
            "interval"
        )
        remedy = "fewer levels, a better polynomial of the middle, or a smaller cone"
        radius, side, rates, changes = self.claim.radii[1], symmetric(width_of_slivers(self.claim)), [], []
        with self.checklist.hypothesis("homoclinic", "42.4", statement, remedy) as evidence:
            for way in self.found.arrived:
                rates.append(self._along(way)[1])
                evidence.require(excludes_zero(rates[-1]), "q may not be monotone", needs_precision=True)
                changes.append(-(way.second.centre + way.second.slopes[1] * side) / rates[-1])
            evidence.record("dq/da", _all(rates))
            whole = evidence.record("a, from the middle", _all(changes))
            outside = any(is_outside(change, radius) for change in changes)
            inside = all(is_inside(change, radius) for change in changes)
            message = f"it is in {show(whole)}, not inside the interval"
            evidence.require(inside, message, needs_precision=not outside, excluded=outside)
        return changes

    def transversal(self) -> tuple[arb, arb]:
        """At the arrival the unstable manifolds are tangent neither to Fix(R) nor to what R negates."""
        statement = "on each level neither q nor both p and w have the derivative 0 at the arrival, along the manifold"
        with self.checklist.hypothesis("transversal", "42.5", statement, "fewer levels, a smaller cone") as evidence:
            slopes = [self._along(way) for way in self.found.arrived]
            for p, q, w in slopes:
                evidence.require(excludes_zero(q), "q may not change", needs_precision=True)
                evidence.require(excludes_zero(p) or excludes_zero(w), "p and w may not change", needs_precision=True)
            by_p, by_q, by_w = (_all(balls) for balls in zip(*slopes, strict=True))
            for name, ball in (("dp/da", by_p), ("dq/da", by_q), ("dw/da", by_w)):
                evidence.record(name, ball)
        return by_p, by_q

    def results(
        self, where: list[list[arb]], multipliers: list[arb], changes: list[arb], slopes: tuple[arb, arb]
    ) -> HomoclinicCurveResults:
        """What is known then, for all levels."""
        claim, side = self.claim.middle, symmetric(width_of_slivers(self.claim))
        c = ball_polynomial(self.claim.polynomials[0])
        centres = (values_around(c, part.mid(), part.rad()) for part in wide_parts(WIDE_PARTS))
        points = (middle + a + s for middle, (a, s) in zip(centres, where, strict=True))

        def at_arrival(function: Callable[[Way], arb]) -> arb:
            return _all(map(function, self.found.arrived))

        places = {id(way): [change, side] for way, change in zip(self.found.arrived, changes, strict=True)}
        return HomoclinicCurveResults(
            {claim.along: _all(points)},
            _all(way.time.value(point) for way, point in zip(self.found.returned, where, strict=True)),
            _all(multipliers),
            _all(changes),
            {
                claim.along: at_arrival(lambda way: way.first.value(places[id(way)])),
                claim.level_coordinate: at_arrival(lambda way: way.w.value(places[id(way)])),
            },
            at_arrival(lambda way: way.time.value(places[id(way)])),
            slopes,
        )

    def _along(self, way: Way) -> tuple[arb, arb, arb]:
        """Derivatives of p, q and w at the arrival by a, along the manifold."""
        claim = self.claim.middle
        return along_manifold(claim, way.first), along_manifold(claim, way.second), along_manifold(claim, way.w)
