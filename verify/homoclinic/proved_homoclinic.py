"""A transverse homoclinic orbit: cone condition, arrival at Fix(R), transversality (sections 40.3 to 40.6)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
from orbitproof.verify.claim import check_symmetries, quadratic_coefficient
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    all_finite,
    concluded,
    enclose,
    excludes_zero,
    is_below,
    is_inside,
    is_outside,
    is_positive,
    show,
    symmetric,
)
from orbitproof.verify.homoclinic.following import HomoclinicEnclosures, Way, balls_of, reversible, width_of_sliver
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.periodic import Linearised


@dataclass(frozen=True)
class HomoclinicResults:
    """What is known of a proved homoclinic orbit and of its periodic orbit, in the units of the system.

    Attributes:
        point: the coordinate p of the point of the periodic orbit on Fix(R), by name.
        period: of the periodic orbit.
        multiplier: the one of absolute value above 1.
        passage: a at the point of the homoclinic orbit that lies on the graph over the interval.
        meeting: the coordinates at which it meets Fix(R), by name.
        time: from the box to there.
        slopes: derivatives of p and of q at this meeting, along the unstable manifold, by a.
    """

    point: Mapping[str, arb]
    period: arb
    multiplier: arb
    passage: arb
    meeting: Mapping[str, arb]
    time: arb
    slopes: tuple[arb, arb]


@dataclass(frozen=True)
class HomoclinicTheorem:
    """The periodic orbit of a claim has a transverse homoclinic orbit as claimed (Theorem 40.5)."""

    claim: HomoclinicOrbit

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return "symmetries", "level", "return-map", "periodic", "cone", "arrival", "homoclinic", "transversal"


def check_homoclinic_exactly(checklist: Checklist, claim: HomoclinicOrbit) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_symmetries(checklist, reversible(claim))
    statement = "the first integral is A + b w^2, w the level coordinate, A independent of w, b a constant other than 0"
    remedy = "give another coordinate as level_coordinate"
    with checklist.hypothesis("level", "40.1", statement, remedy) as evidence:
        coefficient = quadratic_coefficient(reversible(claim))
        evidence.require(bool(coefficient), "the program of the first integral does not show it")
        if coefficient:
            evidence.record("b", enclose(coefficient))


def prove_homoclinic(
    claim: HomoclinicOrbit, checklist: Checklist, enclosures: HomoclinicEnclosures | None
) -> Outcome[HomoclinicResults]:
    """Check that there is an orbit as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> HomoclinicResults:
        found, where, multiplier = check_end(checklist, claim, enclosures)
        passage = _check_meeting(checklist, claim, found.arrived)
        slopes = _check_transversal(checklist, claim, found.arrived)
        a = passage - enclose(claim.centre[1])
        sliver = [a, symmetric(width_of_sliver(claim))]
        return HomoclinicResults(
            {claim.along: enclose(claim.centre[0]) + where[0] + where[1]},
            found.returned.time.value(where),
            multiplier,
            passage,
            {claim.along: found.arrived.first.value(sliver), claim.level_coordinate: found.arrived.w.value(sliver)},
            found.arrived.time.value(sliver),
            slopes,
        )

    return concluded(HomoclinicTheorem(claim), checklist, check)


def check_end(
    checklist: Checklist, claim: HomoclinicOrbit, enclosures: HomoclinicEnclosures | None
) -> tuple[HomoclinicEnclosures, list[arb], arb]:
    """Periodic orbit and unstable manifold, to the sliver: the enclosures, (a, s) of the point, the multiplier."""
    found = _checked(checklist, claim, enclosures)
    where = _check_fixed_point(checklist, claim, found.returned)
    multiplier = _check_cone(checklist, claim, found.returned, where)
    _check_sliver(checklist, claim, where)
    return found, where, multiplier


def _checked(checklist: Checklist, claim: HomoclinicOrbit, found: HomoclinicEnclosures | None) -> HomoclinicEnclosures:
    """Every enclosure that is used is there and finite, times are positive, and the box returns to its sheet."""
    statement = (
        "all orbits of the box cross the section as often as claimed and come back to the sheet of the level with the "
        "claimed sign, and all orbits of the sliver cross it as often as claimed"
    )
    with checklist.hypothesis("return-map", "40.2", statement, "smaller radii or more precision") as evidence:
        evidence.require(found is not None, "there are no enclosures")
        if found is not None:
            ways = [found.returned, found.arrived]
            complete = all(len(each.slopes) == 2 for way in ways for each in way.functions)
            evidence.require(complete, "a derivative is missing")
            finite = all_finite(balls_of(ways))
            evidence.require(finite, "an enclosure is not finite", needs_precision=True)
            if complete and finite:
                side = symmetric(claim.radii[0])
                w = evidence.record("w at the return", found.returned.w.value([side, side]))
                evidence.require(is_positive(claim.level_sign * w), "w may have the other sign")
                sides = ([side, side], [symmetric(claim.radii[1]), symmetric(width_of_sliver(claim))])
                for name, way, box in zip(("return", "arrival"), ways, sides, strict=True):
                    time = evidence.record(f"time of the {name}", way.time.value(box))
                    evidence.require(is_positive(time), "a time is not positive", needs_precision=True)
    assert found is not None
    return found


def _check_fixed_point(checklist: Checklist, claim: HomoclinicOrbit, found: Way) -> list[arb]:
    """(a, s) of the one fixed point of the return in the box."""
    statement = "interval Newton: the return map has exactly one fixed point inside the box"
    remedy = "move the centre to the periodic orbit, or choose smaller radii"
    with checklist.hypothesis("periodic", "40.3", statement, remedy) as evidence:
        (a_a, a_s), (s_a, s_s) = found.first.slopes, found.second.slopes
        matrix = [[a_a - 1, a_s], [s_a, s_s - 1]]
        evidence.require(is_regular(matrix), "the derivative may be singular in the box", needs_precision=True)
        where = newton_image(matrix, [found.first.centre, found.second.centre])
        for name, ball in zip("as", where, strict=True):
            evidence.record(name, ball)
            outside = is_outside(ball, claim.radii[0])
            message = f"{name} in {show(ball)} is not inside the box"
            inside = is_inside(ball, claim.radii[0])
            evidence.require(inside, message, needs_precision=not outside, excluded=outside)
        evidence.require(len(where) == 2, "an equation is missing")
    return where


def _check_cone(checklist: Checklist, claim: HomoclinicOrbit, found: Way, where: list[arb]) -> arb:
    """The cone is mapped into itself and stretched on the whole box; returns the multiplier."""
    statement = (
        "the derivative of the return map takes the cone |ds| <= cone |da| into its interior and stretches its vectors "
        "in a, everywhere in the box; the cone about the fixed point leaves the box through the sides |a| = r alone"
    )
    with checklist.hypothesis("cone", "40.4", statement, "smaller radii, or a wider cone") as evidence:
        cone, radius = enclose(claim.cone), enclose(claim.radii[0])
        (a_a, a_s), (s_a, s_s) = ([abs(ball) for ball in each.slopes] for each in (found.first, found.second))
        stretch = evidence.record("stretching", a_a - cone * a_s)
        turned = evidence.record("steepness of the image", (s_a + cone * s_s) / stretch)
        evidence.require(is_below(arb(1), stretch), "vectors may not be stretched", needs_precision=True)
        evidence.require(is_below(turned, cone), f"an image may have the steepness {show(turned)}")
        a, s = map(abs, where)
        widest = evidence.record("greatest |s| in the cone", s + cone * (radius + a))
        evidence.require(is_below(widest, radius), "the cone leaves the box elsewhere")
        evidence.require(is_below(radius + a, stretch * (radius - a)), "the fixed point is too far from the middle")
    return found.first.slopes[0] + symmetric(claim.cone) * found.first.slopes[1]


def _check_sliver(checklist: Checklist, claim: HomoclinicOrbit, where: list[arb]) -> None:
    """The sliver contains the unstable manifold over the interval, which is in the box and not at the fixed point."""
    statement = "the interval of a lies in the box and beside the fixed point, and the sliver contains the cone over it"
    remedy = "give another interval of a, or a centre closer to the periodic orbit"
    with checklist.hypothesis("arrival", "40.5", statement, remedy) as evidence:
        a, s = map(abs, where)
        middle, half_width = abs(enclose(claim.centre[1])), enclose(claim.radii[1])
        farthest = middle + half_width
        evidence.require(is_below(farthest, enclose(claim.radii[0])), "the interval leaves the box")
        evidence.require(is_below(a, middle - half_width), "the fixed point may be in it", needs_precision=True)
        widest = evidence.record("greatest |s| of the manifold", s + enclose(claim.cone) * (farthest + a))
        inside = is_below(widest, enclose(width_of_sliver(claim)))
        evidence.require(inside, "the manifold may leave the sliver", needs_precision=True)


def along_manifold(claim: HomoclinicOrbit, function: Linearised) -> arb:
    """The derivative of a function along the unstable manifold, by a."""
    by_a, by_s = function.slopes
    return by_a + symmetric(claim.cone) * by_s


def _check_meeting(checklist: Checklist, claim: HomoclinicOrbit, found: Way) -> arb:
    """The one a of the interval at which the orbit on the manifold arrives in Fix(R)."""
    statement = "interval Newton: along the unstable manifold q has exactly one zero at the arrival, in the interval"
    remedy = "move the interval to the homoclinic orbit, or choose a smaller one or a smaller cone"
    with checklist.hypothesis("homoclinic", "40.5", statement, remedy) as evidence:
        rate = evidence.record("dq/da", along_manifold(claim, found.second))
        evidence.require(excludes_zero(rate), "q may not be monotone", needs_precision=True)
        q = found.second.centre + found.second.slopes[1] * symmetric(width_of_sliver(claim))
        change = evidence.record("a, from the middle", -q / rate)
        radius = claim.radii[1]
        outside = is_outside(change, radius)
        message = f"it is in {show(change)}, not inside the interval"
        evidence.require(is_inside(change, radius), message, needs_precision=not outside, excluded=outside)
    return enclose(claim.centre[1]) + change


def _check_transversal(checklist: Checklist, claim: HomoclinicOrbit, found: Way) -> tuple[arb, arb]:
    """At the arrival the unstable manifold is tangent neither to Fix(R) nor to what R negates."""
    statement = "along the unstable manifold neither q nor both p and w have the derivative 0 at the arrival"
    with checklist.hypothesis("transversal", "40.6", statement, "a smaller interval or a smaller cone") as evidence:
        p, q, w = (along_manifold(claim, each) for each in (found.first, found.second, found.w))
        for name, ball in (("dp/da", p), ("dq/da", q), ("dw/da", w)):
            evidence.record(name, ball)
        evidence.require(excludes_zero(q), "q may not change", needs_precision=True)
        evidence.require(excludes_zero(p) or excludes_zero(w), "p and w may not change", needs_precision=True)
    return p, q
