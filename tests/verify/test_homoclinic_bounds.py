"""Homoclinic orbits: each inequality at its edge, and enclosures that hold the points they are about (section 40)."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb
from support import homoclinic_cases as cases

from orbitproof.shared.claims import HomoclinicOrbit
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import define_system
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Proved, enclose, guarded
from orbitproof.verify.homoclinic import (
    HomoclinicResults,
    HomoclinicTheorem,
    check_homoclinic_exactly,
    enclose_homoclinic,
    prove_homoclinic,
)
from orbitproof.verify.homoclinic.following import HomoclinicEnclosures, Way, width_of_sliver
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.words.homoclinic import homoclinic_in_full, homoclinic_in_words

BITS = 192
CLAIM = replace(cases.wells(), cone=Q(1, 1024), centre=(Q(1), Q(1, 4096)), radii=(Q(1, 2048), Q(1, 2**30)))
R, RHO = CLAIM.radii
A_0 = CLAIM.centre[1]
DELTA = width_of_sliver(CLAIM)


def linear(centre: Any, by_a: Any, by_s: Any) -> Linearised:
    return Linearised(_exactly(centre)[0], _exactly(by_a, by_s))


def _exactly(*values: Any) -> tuple[arb, ...]:
    with guarded(BITS):
        return tuple(value if isinstance(value, arb) else enclose(Q(value)) for value in values)


RETURNED = {"first": linear(0, 20, 0), "second": linear(0, 0, "0.05"), "w": linear(1, 0, 0), "time": linear(3, 1, 2)}
ARRIVED = {"first": linear(2, -15, 0), "second": linear(0, 1, 0), "w": linear(1, 17, 3), "time": linear(9, 5, 7)}


def outcome(returned: Any = (), arrived: Any = (), **changes: Any) -> Any:
    """What follows from the linear maps above, changed in some places."""
    claim, checklist = replace(CLAIM, **changes), Checklist()
    with guarded(BITS):
        check_homoclinic_exactly(checklist, claim)
        ways = Way(**{**RETURNED, **dict(returned)}), Way(**{**ARRIVED, **dict(arrived)})
        return prove_homoclinic(claim, checklist, HomoclinicEnclosures(*ways))


def reason(*args: Any, **changes: Any) -> str:
    found = outcome(*args, **changes)
    assert isinstance(found, NotProved)
    return found.reason.condition


def fixed(a: Q, s: Q, **changes: Any) -> dict[str, Linearised]:
    """A return whose fixed point is (a, s)."""
    return {"first": linear(-19 * a, 20, 0), "second": linear(Q("0.95") * s, 0, "0.05"), **changes}


def test_results_are_those_of_the_points_that_are_found() -> None:
    """A fixed point and a meeting beside the middles of their boxes."""
    a, s, change = R / 64, DELTA / 8, RHO / 8
    found = outcome(
        fixed(a, s, first=linear(-19 * a - 100 * s, 20, 100)),
        {"second": linear(-change, 1, 0), "first": linear(2, -15, 4)},
    )
    assert isinstance(found, Proved)
    results = found.results
    assert results.point["x"].contains(enclose(1 + a + s))
    assert results.period.contains(enclose(3 + a + 2 * s))
    for slope in (-CLAIM.cone, CLAIM.cone):
        assert results.multiplier.contains(enclose(20 + 100 * slope))
        assert results.slopes[0].contains(enclose(-15 + 4 * slope))
    assert results.passage.contains(enclose(A_0 + change))
    for s in (-DELTA, DELTA):
        assert results.meeting["x"].contains(enclose(2 - 15 * change + 4 * s))
        assert results.meeting["v"].contains(enclose(1 + 17 * change + 3 * s))
        assert results.time.contains(enclose(9 + 5 * change + 7 * s))
    # A multiplier of the other sign is as good.
    assert isinstance(outcome({"first": linear(0, -20, 0)}), Proved)


def test_the_periodic_orbit_is_in_the_box_and_the_cone_in_the_cone() -> None:
    assert reason(fixed(R * Q(3, 2), Q(0))) == "periodic"
    assert reason({"second": linear(0, -1, "0.05")}) == "cone"
    assert reason({"second": linear(0, 0, 50)}) == "cone"
    # What is stretched by more than 1 at slope 0, and less at the edge of the cone.
    assert reason({"first": linear(0, "1.5", 1024), "second": linear(0, 0, "0.001")}) == "cone"
    # The image of the part of the manifold in the box does not reach one side of it.
    assert reason(fixed(R * Q(24, 25), Q(0))) == "cone"
    # The cone leaves the box at its upper side, beyond the side of the fixed point.
    assert reason(fixed(R / 2, R * (1 - CLAIM.cone * Q(5, 4)))) == "cone"


def test_the_interval_is_in_the_box_and_the_manifold_in_the_sliver() -> None:
    assert reason(centre=(Q(1), R - RHO / 2)) == "arrival"
    assert reason(centre=(Q(1), RHO / 2 - R)) == "arrival"
    assert reason(fixed(A_0 - RHO / 2, Q(0))) == "arrival"
    assert reason(fixed(Q(0), DELTA * Q(9, 10))) == "arrival"
    assert reason(fixed(A_0 / 2, DELTA * Q(3, 8))) == "arrival"
    assert isinstance(outcome(fixed(Q(0), DELTA * Q(2, 5))), Proved)


def test_the_zero_is_in_the_interval_for_all_slopes_of_the_manifold() -> None:
    by_s = Q(1, 2**14)
    # Inside the interval if the manifold has slope 0, and not if q grows as slowly as it may.
    low = RHO * (1 - CLAIM.cone * by_s / 2) - by_s * DELTA
    assert reason((), {"second": linear(-low, 1, by_s)}) == "homoclinic"
    assert isinstance(outcome((), {"second": linear(-low * Q(9, 10), 1, by_s)}), Proved)
    # At the middle of the interval the manifold may be at either edge of the sliver.
    assert reason((), {"second": linear(0, 1, 2 * RHO / DELTA)}) == "homoclinic"


def test_a_crossing_of_the_fixed_set_that_is_tangent_is_not_transversal() -> None:
    flat = linear(2, 0, 0)
    assert reason((), {"first": flat, "w": flat}) == "transversal"
    assert reason((), {"first": linear(2, CLAIM.cone / 2, 1), "w": flat}) == "transversal"
    assert isinstance(outcome((), {"first": flat}), Proved)
    assert isinstance(outcome((), {"w": flat}), Proved)


@pytest.mark.parametrize("way", ["returned", "arrived"])
def test_no_bound_is_infinite_and_w_keeps_its_sign_on_all_of_the_box(way: str) -> None:
    bad = arb(0, float("inf"))
    for name, function in (RETURNED if way == "returned" else ARRIVED).items():
        for place in range(3):
            balls = [*function.balls]
            balls[place] = bad
            changed = {name: Linearised(balls[0], tuple(balls[1:]))}
            assert reason(**{way: changed}) == "return-map"
        assert reason(**{way: {name: Linearised(function.centre, function.slopes[:1])}}) == "return-map"
    assert reason({"w": linear(1, 1 / R, 0)}) == "return-map"
    assert reason({"time": linear(3, 0, 4 / R)}) == "return-map"
    assert reason((), {"time": linear(9, 0, 10 / DELTA)}) == "return-map"


def test_what_needs_no_integration_is_asked_exactly() -> None:
    def why(claim: HomoclinicOrbit) -> str:
        with pytest.raises(NotEstablishedError) as failure:
            check_homoclinic_exactly(Checklist(), claim)
        return failure.value.reason.condition

    # Not reversed by these signs; and x is no coordinate in which the energy is A + b x^2.
    assert why(replace(CLAIM, reversing_symmetry=(1, -1, 1, -1), level_coordinate="u")) == "symmetries"
    assert why(replace(CLAIM, level_coordinate="x")) == "level"
    with pytest.raises(InputError, match=r"^reversing_symmetry"):
        replace(CLAIM, reversing_symmetry=(1, -1, -1, -1))
    turning = {
        "name": "turning", "state": "x u", "field": {"x": "u", "u": "-sin(x)"}, "first_integral": "u**2/2 - cos(x)",
    }  # fmt: skip
    # Its four coordinates are x, u, sin(x) and cos(x).
    with pytest.raises(InputError, match=r"^system"):
        replace(CLAIM, system=define_system(turning), parameters={})


def test_points_of_the_box_and_of_the_sliver_lie_in_what_is_enclosed() -> None:
    """The derivatives at points, from boxes of 2^-80 about them, are among those that are enclosed."""
    claim, tiny = cases.wells(), Q(1, 2**80)
    r, rho = claim.radii

    def at(a: Q, s: Q, slope: Q, crossings: int, sign: int) -> Way:
        point = replace(
            claim, slope=slope, crossings=1, arrival=crossings, centre=(claim.centre[0] + 2 * s, a - s), cone=tiny,
            radii=(tiny, tiny), level_sign=sign,
        )  # fmt: skip
        return enclose_homoclinic(point, IntegratorSettings(precision=128), ORACLE).arrived

    # With the other slope s is the direction in which the return stretches; the other sheet is a mirror image.
    for slope, sign, a, s in ((claim.slope, 1, r, -r), (-claim.slope, -1, Q(0), r)):
        arrival = claim.arrival if slope == claim.slope else 1
        given = dict(reversed(claim.parameters.items()))
        followed = replace(claim, slope=slope, arrival=arrival, level_sign=sign, parameters=given)
        box = enclose_homoclinic(followed, IntegratorSettings(precision=96), ORACLE)
        found = at(a, s, slope, claim.crossings, sign)
        assert (sign * box.returned.w.centre).lower() > 0
        for number in range(2):
            p, q = found.first.slopes[number], found.second.slopes[number] / enclose(slope)
            assert box.returned.first.slopes[number].contains((p + q) / 2)
            assert box.returned.second.slopes[number].contains((p - q) / 2)
            assert box.returned.w.slopes[number].contains(found.w.slopes[number])
            assert box.returned.time.slopes[number].contains(found.time.slopes[number])
        if slope == claim.slope:
            corner = at(claim.centre[1] + rho, width_of_sliver(claim), slope, claim.arrival, sign)
            for wide, narrow in zip(box.arrived.functions, corner.functions, strict=True):
                assert all(map(arb.contains, wide.slopes, narrow.slopes))
            x, u, v, _ = (function.centre for function in corner.functions)
            assert ((u**2 + v**2 - (x - 1) ** 2 + (x - 1) ** 4 / 2) / 2).contains(arb(1) / 2)


def test_the_words_say_where_the_box_lies() -> None:
    one = arb(1)
    found = HomoclinicResults({"x": one}, one, one, one, {"x": one, "v": one}, one, (one, one))
    for sign, word in ((1, "positive"), (-1, "negative")):
        claim = replace(CLAIM, level_sign=sign)
        text = "\n".join(homoclinic_in_full(claim, homoclinic_in_words(HomoclinicTheorem(claim)), found))
        assert f"The box lies where v is {word}." in text


def test_where_both_manifolds_are_one_curve_nothing_is_proved() -> None:
    """Without coupling x swings alone on its separatrix, x - 1 = 2^(1/2) sech(t): W^u crosses Fix(R), and is W^s."""
    claim = replace(
        cases.wells(), parameters={"w": Q(4), "e": Q(0)}, slope=Q(1), cone=Q(1, 2**10),
        centre=(Q(1), Q(275940584212129926675, 2**80)), radii=(Q(9, 2**14), Q(11, 2**33)),
    )  # fmt: skip
    found = certify(claim, Limits(digits=10, max_precision=200))
    assert found.reason is not None
    assert found.reason.condition == "transversal"
