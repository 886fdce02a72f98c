"""Homoclinic orbits on all levels of an interval: one family is proved, others are refused (section 42)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb
from support import homoclinic_cases as cases

from orbitproof.shared.errors import InputError
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import Checklist, NotProved, Proved, enclose, guarded
from orbitproof.verify.homoclinic import Way, enclose_homoclinic, prove_homoclinic
from orbitproof.verify.homoclinic_curve import (
    HomoclinicCurveEnclosures,
    check_homoclinic_curve_exactly,
    enclose_homoclinic_curve,
    following,
    prove_homoclinic_curve,
)
from orbitproof.verify.maps import Format
from orbitproof.verify.oracle import IN_FRAMES
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.poincare import IntegratorSettings

SETTINGS = IntegratorSettings(precision=72, order=24)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def enclosures() -> HomoclinicCurveEnclosures:
    return enclose_homoclinic_curve(cases.wells_on_levels(), SETTINGS, IN_FRAMES)


def outcome(found: HomoclinicCurveEnclosures | None, **changes: Any) -> Any:
    """What is concluded of a claim that is told otherwise, from the same enclosures."""
    claim, checklist = replace(cases.wells_on_levels(), **changes), Checklist()
    with guarded(SETTINGS.precision):
        check_homoclinic_curve_exactly(checklist, claim)
        return prove_homoclinic_curve(claim, checklist, found)


def reason(found: HomoclinicCurveEnclosures | None, **changes: Any) -> str:
    result = outcome(found, **changes)
    assert isinstance(result, NotProved)
    return result.reason.condition


def test_orbits_between_two_wells_are_proved_and_contain_that_of_one_level(
    enclosures: HomoclinicCurveEnclosures,
) -> None:
    found = outcome(enclosures)
    assert isinstance(found, Proved)
    assert found.results.point["x"].contains(1)
    assert found.results.multiplier.contains(arb(cases.MULTIPLIER))
    # One level at the end of the interval, by the code of chapter 40.
    curve = cases.wells_on_levels()
    c, a, slope = (sum(row, Q(0)) for row in curve.polynomials)
    assert curve.level is not None
    one = replace(curve.middle, level=curve.level + curve.level_radius, centre=(c, a), slope=slope)
    checklist = Checklist()
    with guarded(96):
        check_homoclinic_curve_exactly(checklist, curve)
        alone = prove_homoclinic(one, checklist, enclose_homoclinic(one, IntegratorSettings(96), IN_FRAMES))
    assert isinstance(alone, Proved)
    for name, ball in alone.results.meeting.items():
        assert found.results.meeting[name].contains(ball)
    assert found.results.time.contains(alone.results.time)
    assert found.results.multiplier.overlaps(alone.results.multiplier)


def test_what_the_enclosures_do_not_show_is_not_proved(enclosures: HomoclinicCurveEnclosures) -> None:
    claim = cases.wells_on_levels()
    (r, rho), (c, a) = claim.radii, claim.centre
    assert reason(None) == "return-map"
    assert reason(replace(enclosures, returned=enclosures.returned[1:])) == "return-map"
    assert reason(replace(enclosures, arrived=enclosures.arrived[:-1])) == "return-map"
    assert reason(enclosures, level_sign=-1) == "return-map"
    assert reason(enclosures, cone=claim.cone / 2**20) == "cone"
    assert reason(enclosures, cone=Q(2)) == "cone"
    # The intervals lie beyond the box for some t, or about the periodic orbit for some t.
    powers = claim.powers
    assert reason(enclosures, powers=(powers[0], (r - a,), powers[2])) == "arrival"
    assert reason(enclosures, powers=(powers[0], (-a,), powers[2])) == "arrival"
    assert reason(enclosures, centre=(c, rho / 2)) == "arrival"
    assert reason(enclosures, radii=(r, rho / 2**20)) in ("arrival", "homoclinic")


@pytest.mark.parametrize("part", [0, 3, 7])
def test_each_bound_is_used_on_each_part(enclosures: HomoclinicCurveEnclosures, part: int) -> None:
    def changed(way: str, change: Callable[[Way], Way]) -> HomoclinicCurveEnclosures:
        parts = list(getattr(enclosures, way))
        parts[part] = change(parts[part])
        return replace(enclosures, **{way: tuple(parts)})

    def wider(way: str, function: str, place: int, by: float) -> HomoclinicCurveEnclosures:
        def change(found: Way) -> Way:
            balls = [*getattr(found, function).balls]
            balls[place] += arb(0, by)
            return replace(found, **{function: Linearised(balls[0], tuple(balls[1:]))})

        return changed(way, change)

    assert reason(wider("returned", "first", 0, 1)) == "periodic"
    assert reason(wider("returned", "first", 1, 100)) == "periodic"
    assert reason(wider("returned", "second", 1, 1)) == "cone"
    assert reason(wider("returned", "w", 0, 10)) == "return-map"
    assert reason(wider("returned", "time", 0, 10)) == "return-map"
    assert reason(wider("arrived", "time", 0, 100)) == "return-map"
    assert reason(wider("arrived", "second", 0, 1)) == "homoclinic"
    assert reason(wider("arrived", "second", 1, 1e12)) == "homoclinic"
    assert reason(wider("arrived", "second", 2, 1e12)) == "homoclinic"
    assert reason(wider("arrived", "first", 1, float("inf"))) == "return-map"
    # A derivative that is 1, less the identity.
    fixed = changed(
        "returned",
        lambda way: replace(way, second=Linearised(way.second.centre, (way.second.slopes[0], arb(1, 0.5)))),
    )
    assert reason(fixed) == "periodic"
    rho, width = cases.wells_on_levels().radii[1], following.width_of_slivers(cases.wells_on_levels())

    # At the middles of the intervals the manifolds may be at either edge of the slivers.
    edges = Linearised(arb(0), (arb(1), enclose(2 * rho / width)))
    assert reason(changed("arrived", lambda way: replace(way, second=edges))) == "homoclinic"
    flat = Linearised(arb(1), (arb(0, 1e9), arb(0)))
    assert reason(changed("arrived", lambda way: replace(way, first=flat, w=flat))) == "transversal"


def moved(
    found: HomoclinicCurveEnclosures, way: str, function: str, part: int, place: int, by: arb
) -> HomoclinicCurveEnclosures:
    """With one ball elsewhere: of the value, place 0, or of a derivative."""
    parts = list(getattr(found, way))
    balls = [*getattr(parts[part], function).balls]
    balls[place] += by
    parts[part] = replace(parts[part], **{function: Linearised(balls[0], tuple(balls[1:]))})
    return replace(found, **{way: tuple(parts)})


@pytest.mark.parametrize("part", [0, 7])
def test_fixed_points_near_the_sides_are_refused(enclosures: HomoclinicCurveEnclosures, part: int) -> None:
    r, way = enclose(cases.wells_on_levels().radii[0]), enclosures.returned[part]
    a_a, s_s = way.first.slopes[0].mid(), way.second.slopes[1].mid()
    # The image of the graph does not reach one side.
    assert reason(moved(enclosures, "returned", "first", part, 0, (1 - a_a) * r * 19 / 20)) == "cone"
    # The cone leaves the box, or the sliver.
    above = moved(enclosures, "returned", "second", part, 0, (1 - s_s) * r * 9 / 10)
    assert reason(above, cone=Q(1, 5)) == "cone"
    assert reason(moved(enclosures, "returned", "second", part, 0, (1 - s_s) * r / 2)) == "arrival"


@pytest.mark.parametrize("part", [0, 7])
def test_results_are_those_of_all_parts(enclosures: HomoclinicCurveEnclosures, part: int) -> None:
    claim, by = cases.wells_on_levels(), arb(1) / 16
    rho, back, there = enclose(claim.radii[1]), enclosures.returned[part], enclosures.arrived[part]

    def found(way: str, function: str, place: int, change: arb) -> Any:
        return outcome(moved(enclosures, way, function, part, place, change)).results

    assert found("returned", "time", 0, by).period.contains(back.time.centre + by)
    assert found("returned", "first", 1, by).multiplier.contains(back.first.slopes[0] + by)
    for function, name in (("first", "x"), ("w", "v")):
        assert found("arrived", function, 0, by).meeting[name].contains(getattr(there, function).centre.mid() + by)
    assert found("arrived", "time", 0, by).time.contains(there.time.centre.mid() + by)
    rate = there.second.slopes[0].mid()
    passage = found("arrived", "second", 0, -rate * rho / 4).passage
    assert passage.contains(rho / 4 - (there.second.centre / rate).mid())
    for place, function in enumerate(("first", "second")):
        slopes = found("arrived", function, 1, arb(1)).slopes
        assert slopes[place].contains(getattr(there, function).slopes[0] + 1)
    c = outcome(enclosures, powers=((Q(1, 1000),), *claim.powers[1:])).results.point["x"]
    assert all(c.contains(enclose(1 + t * Q(1, 1000))) for t in (-1, 0, 1))


def test_functions_are_enclosed_on_all_of_the_box_with_their_errors() -> None:
    claim = cases.wells_on_levels()
    r = claim.radii[0]
    box = following._Set(claim, (Q(0),), (r, r), Format(72, 3, 24))
    with guarded(72):
        # The derivatives of p^2 are 2 p, and p is from 1 - 2 r to 1 + 2 r.
        for found in box._on_parts(box.p * box.p):
            assert all(slope.contains(enclose(2 + 4 * side * r)) for slope in found.slopes for side in (-1, 1))
        for found in box._on_parts(box.p.widened(Q(1, 1024))):
            assert all(found.centre.contains(enclose(1 + side * Q(1, 1024))) for side in (-1, 1))


def test_false_claims_are_refused() -> None:
    claim = cases.wells_on_levels()
    (r, rho), (c, a), powers = claim.radii, claim.centre, claim.powers

    def why(**changes: Any) -> str:
        found = certify(replace(claim, **changes), Limits(digits=10, max_precision=128))
        assert not found.proved
        return found.reason.condition

    # Beside the orbits; right in the middle alone; other numbers of crossings; the stable direction.
    assert why(centre=(c, a + 4 * rho)) == "homoclinic"
    assert why(powers=(powers[0], (Q(0),), powers[2])) == "homoclinic"
    assert why(arrival=claim.arrival + 1) == "homoclinic"
    assert why(slope=-claim.slope, powers=(powers[0], powers[1], (-powers[2][0],))) in ("cone", "periodic")
    # Too many levels.
    assert why(level_radius=claim.level_radius * Q(6, 5)) == "homoclinic"
    # The right periodic orbit in the middle alone.
    assert why(powers=((4 * r,), powers[1], powers[2])) in ("periodic", "tube")


def test_a_and_s_are_formed_with_more_powers_of_t_than_products_have_room_for() -> None:
    """At the points of the boxes themselves, as if they came back at once."""
    claim = cases.wells_on_levels()
    powers = (*claim.powers[:2], (*claim.powers[2], *[Q(1, 10**3)] * 8))
    radius = claim.radii[0]
    box = following._Set(replace(claim, powers=powers), (Q(0),), (radius, radius), Format(72, 3, 24))
    with guarded(72):
        own = box._own(box.p, box.q)
        for element, place in zip(own, (0, 1), strict=True):
            for found in box._on_parts(element):
                expected = [0, *(int(place == each) for each in (0, 1))]
                assert all((ball - value).contains(0) for ball, value in zip(found.balls, expected, strict=True))
                assert all(float(ball.rad()) < 1e-6 for ball in found.balls)


def test_claims_that_cannot_be_are_refused_with_their_field() -> None:
    claim = cases.wells_on_levels()
    rows = claim.powers
    wrong: dict[str, Any] = {
        "level": None, "level_radius": Q(0), "slope": rows[2][0], "centre": (Q(1),), "arrival": 0,
        "powers": rows[:2],
    }  # fmt: skip
    for name, value in wrong.items():
        with pytest.raises(InputError, match=f"^{name}"):
            replace(claim, **{name: value})
    with pytest.raises(InputError, match=r"^powers"):
        replace(claim, powers=((), *rows[1:]))


def test_orbits_of_the_sun_and_jupiter_are_proved_about_the_published_level() -> None:
    """For every Jacobi constant within 0.0001 of 3.03, in the units of Wilczak and Zgliczynski."""
    found = certify(cases.jupiter_on_levels(), Limits(digits=10, max_precision=256))
    assert found.proved, found.reason
    assert found.results.point["x"].contains(enclose(cases.jupiter().centre[0]))
    assert abs(float(found.results.multiplier) - 1391.8) < 1
    assert abs(float(found.results.meeting["x"]) + 0.648192) < 1e-4
