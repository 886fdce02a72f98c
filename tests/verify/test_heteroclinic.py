"""Heteroclinic orbits: one is proved, each inequality at its edge, and claims of what is not there (section 41)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb
from support import homoclinic_cases as cases
from support.metamorphic_cases import ROWS

from orbitproof.shared.claims import HeteroclinicOrbit
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import define_system
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Proved, enclose, guarded
from orbitproof.verify.heteroclinic import (
    End,
    HeteroclinicEnclosures,
    HeteroclinicResults,
    HeteroclinicTheorem,
    check_heteroclinic_exactly,
    prove_heteroclinic,
)
from orbitproof.verify.homoclinic import Way, width_of_sliver
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.words.heteroclinic import heteroclinic_found, heteroclinic_in_full, heteroclinic_in_words

BITS = 192
LIMITS = Limits(digits=10, max_precision=256)
CLAIM = replace(
    cases.hills(), cone=(Q(1, 1024), Q(1, 512)), centre=(Q(-1), Q(1, 4096), Q(1), Q(-3, 8192)),
    radii=(Q(1, 2048), Q(1, 2**30), Q(1, 2048), Q(1, 2**29)),
)  # fmt: skip
RHO = CLAIM.radii[1], CLAIM.radii[3]
DELTA = tuple(map(width_of_sliver, CLAIM.ends))
UNLIKE = replace(CLAIM, level_sign=(1, -1), returns=(2, 4), arrival=(6, 5), slope=(Q(1, 2), Q(-3, 4)))
"""All that there is two of differs."""


def linear(centre: Any, by_a: Any, by_s: Any) -> Linearised:
    with guarded(BITS):
        balls = [value if isinstance(value, arb) else enclose(Q(value)) for value in (centre, by_a, by_s)]
    return Linearised(balls[0], tuple(balls[1:]))


def returned(period: Any, multiplier: int = 20) -> Mapping[str, Linearised]:
    return {
        "first": linear(0, multiplier, 0), "second": linear(0, 0, "0.05"), "w": linear(1, 0, 0),
        "time": linear(period, 1, 2),
    }  # fmt: skip


RETURNED = returned(3), returned(4, -30)
ARRIVED = (
    {"first": linear(2, -15, 0), "second": linear(1, 7, 0), "w": linear(-1, 17, 3), "time": linear(9, 5, 7)},
    {"first": linear(2, 11, 0), "second": linear(-1, 13, 0), "w": linear(-1, 19, 5), "time": linear(8, 6, 4)},
)


def fixed(a: Q, s: Q, **changes: Any) -> Mapping[str, Linearised]:
    """A return whose fixed point is (a, s)."""
    return {"first": linear(-19 * a, 20, 0), "second": linear(Q("0.95") * s, 0, "0.05"), **changes}


def outcome(back: Any = ({}, {}), arrivals: Any = ({}, {}), **changes: Any) -> Any:
    """What follows from the linear maps above, changed in some places."""
    claim, checklist = replace(CLAIM, **changes), Checklist()
    with guarded(BITS):
        check_heteroclinic_exactly(checklist, claim)
        first, second = ([Way(**{**old, **new}) for old, new in zip(usual, given, strict=True)] for usual, given in (
            (RETURNED, back), (ARRIVED, arrivals),
        ))  # fmt: skip
        return prove_heteroclinic(claim, checklist, HeteroclinicEnclosures(tuple(first), tuple(second)))


def reason(*args: Any, **changes: Any) -> str:
    found = outcome(*args, **changes)
    assert isinstance(found, NotProved)
    return found.reason.condition


def test_an_orbit_between_two_hills_is_proved() -> None:
    """The periodic orbits are x = -1 and x = 1, with the frequencies (15/4)^(1/2) and (17/4)^(1/2)."""
    found = certify(ROWS["heteroclinic"](), LIMITS)
    assert found.proved, found.reason
    for end, x, square in zip(found.results.ends, (-1, 1), (Q(15, 4), Q(17, 4)), strict=True):
        assert end.point["x"].contains(x)
        with guarded(BITS):
            period = 2 * arb.pi() / enclose(square).sqrt()
        assert end.period.contains(period)
        assert float(end.period.rad()) < 1e-4
    multipliers = [float(end.multiplier) for end in found.results.ends]
    assert multipliers == pytest.approx([98.17370902427038, 74.34370985991592], rel=1e-3)
    # On the level.
    x, u, v = (float(found.results.meeting[name]) for name in "xuv")
    assert (u**2 + v**2) / 2 - (x**2 - 1) ** 2 / 4 - (3 * x - x**3) / 128 == pytest.approx(0.5, abs=1e-8)


def test_results_are_those_of_the_points_that_are_found() -> None:
    """Both arrivals move: p_1 - p_2 and q_1 + q_2 are zero at a that are no middles."""
    first, second = RHO[0] / 4, -RHO[1] / 8
    arrivals = (
        {"first": linear(2 + 15 * first, -15, 0), "second": linear(1 - 7 * first, 7, 0)},
        {"first": linear(2 - 11 * second, 11, 0), "second": linear(-1 - 13 * second, 13, 0)},
    )
    a, s = Q(1, 2**14), Q(1, 2**24)
    found = outcome((fixed(a, s), {"time": linear(4, 1, 2)}), arrivals)
    assert isinstance(found, Proved)
    results = found.results
    for end, passage, time, slopes in zip(
        results.ends, (CLAIM.centre[1] + first, CLAIM.centre[3] + second), (9 + 5 * first, 8 + 6 * second),
        ((-15, 7), (11, 13)), strict=True,
    ):  # fmt: skip
        assert end.passage.contains(enclose(passage))
        assert end.time.contains(enclose(time))
        assert all(ball.contains(slope) for ball, slope in zip(end.slopes, slopes, strict=True))
    for end, point, period in zip(results.ends, (-1 + a + s, 1), (3 + a + 2 * s, 4), strict=True):
        assert end.point["x"].contains(enclose(Q(point)))
        assert end.period.contains(enclose(Q(period)))
    assert [end.multiplier.contains(value) for end, value in zip(results.ends, (20, -30), strict=True)] == [True, True]
    assert results.meeting["x"].contains(2)
    assert results.meeting["u"].contains(1)
    assert results.meeting["v"].contains(enclose(-1 + 17 * first + 3 * DELTA[0]))


@pytest.mark.parametrize("end", [0, 1])
def test_each_end_is_asked_all_that_a_homoclinic_orbit_is(end: int) -> None:
    def at(**functions: Any) -> Any:
        return tuple(functions if number == end else {} for number in (0, 1))

    number, centre, radii = end + 1, list(CLAIM.centre), list(CLAIM.radii)
    assert reason(at(w=linear(-1, 0, 0))) == f"return-map-{number}"
    assert reason(({}, {}), at(time=linear(-1, 0, 0))) == f"return-map-{number}"
    assert reason(at(first=linear(1, 20, 0))) == f"periodic-{number}"
    assert reason(at(second=linear(0, 1, "0.05"))) == f"cone-{number}"
    centre[2 * end + 1] = radii[2 * end]
    assert reason(centre=tuple(centre)) == f"arrival-{number}"


def test_one_periodic_orbit_is_not_taken_for_two() -> None:
    """Those of one orbit have one time for each crossing; and where they do not differ, other points are needed."""
    same = ({}, {"time": linear(3, 1, 2)})
    # Both points are crossed in one direction and differ: these are two orbits.
    assert isinstance(outcome(same), Proved)
    one = replace(CLAIM, centre=(Q(1), *CLAIM.centre[1:]))
    assert reason(same, centre=one.centre) == "distinct"
    # The other point of an orbit is crossed in the other direction.
    turned = ({}, {"time": linear(3, 1, 2), "w": linear(-1, 0, 0)})
    assert reason(turned, level_sign=(1, -1)) == "distinct"
    # Orbits with more points in the section may have both of them.
    assert reason(same, returns=(4, 4)) == "distinct"
    assert isinstance(outcome(same, returns=(4, 2)), Proved)
    # Twice the crossings in twice the time are one orbit.
    assert reason(({}, {"time": linear(6, 1, 2)}), returns=(2, 4), centre=one.centre) == "distinct"
    assert isinstance(outcome(({}, {"time": linear(6, 1, 2)}), returns=(4, 2), centre=one.centre), Proved)


def test_orbits_are_compared_at_their_points_and_not_at_the_middles_of_the_boxes() -> None:
    a, s = Q(1, 2**14), Q(1, 2**24)
    # The same time, at points that might be two of four; and one point, in two boxes.
    assert reason((fixed(a, s), {"time": linear(3 + a + 2 * s, 1, 2)}), returns=(4, 4)) == "distinct"
    here = (fixed(a, s, time=linear(3, 0, 0)), {"time": linear(3, 0, 0)})
    assert reason(here, centre=(Q(1), CLAIM.centre[1], 1 + a + s, CLAIM.centre[3])) == "distinct"
    # The direction in which the section is crossed at x = -1 and x = 1, where v is 1, and more at the second point.
    for rate, apart in (("(x + 1/2)*v", 0), ("v*(v - 1 - 1/256)", 1)):
        system = define_system({
            "name": "turning", "state": "x y u v", "field": {"x": "u", "y": rate, "u": "x", "v": "0"},
            "first_integral": "v**2",
        })  # fmt: skip
        claim = replace(CLAIM, system=system, parameters={})
        back = [{**each, "time": linear(3, 0, 0)} for each in RETURNED]
        back[1] |= fixed(apart * Q(1, 2**12), Q(0), w=linear(1, 1024, 0))
        ways = tuple(Way(**each) for each in back), tuple(Way(**each) for each in ARRIVED)
        with guarded(BITS):
            found = prove_heteroclinic(claim, Checklist(), HeteroclinicEnclosures(*ways))
        assert isinstance(found, NotProved)
        assert found.reason.condition == "distinct"


def test_w_has_one_sign_at_both_arrivals() -> None:
    assert reason(({}, {}), ({}, {"w": linear(1, 0, 0)})) == "sheet"
    assert reason(({}, {}), ({"w": linear(0, 0, 0)}, {})) == "sheet"
    assert reason(({}, {}), ({"w": linear(-1, 0, 2 / DELTA[0])}, {})) == "sheet"
    assert reason(({}, {}), ({}, {"w": linear(-1, Q(3, 2) / RHO[1], 0)})) == "sheet"
    assert reason(({}, {}), ({}, {"w": linear(-1, 0, 2 / DELTA[1])})) == "sheet"
    assert isinstance(outcome(({}, {}), tuple({"w": linear(1, 0, 0)} for _ in range(2))), Proved)


def test_the_zero_is_in_both_intervals_for_all_slopes_of_both_manifolds() -> None:
    assert reason(({}, {}), ({"first": linear(2 + 16 * RHO[0], -15, 0)}, {})) == "heteroclinic"
    # p_1 and p_2 are subtracted, q_1 and q_2 added: signs that are wrong lead elsewhere.
    assert reason(({}, {}), ({"second": linear(-1, 7, 0)}, {})) == "heteroclinic"
    assert reason(({}, {}), ({}, {"first": linear(-2, 11, 0)})) == "heteroclinic"
    # At the middles the manifolds may be at either edge of their slivers.
    for end, (by_a_1, by_a_2) in enumerate(((-15, 7), (11, 13))):
        for name, centre, by_a in (("first", 2, by_a_1), ("second", 1 - 2 * end, by_a_2)):
            wide = {name: linear(centre, by_a, 40 * max(RHO) / DELTA[end])}
            arrivals = tuple(wide if number == end else {} for number in (0, 1))
            assert reason(({}, {}), arrivals) == "heteroclinic"
    # The other sliver is narrower.
    assert DELTA[0] < DELTA[1] / 2
    assert reason(({}, {}), ({}, {"first": linear(2, 11, 18 * RHO[0] / DELTA[1])})) == "heteroclinic"


def test_manifolds_that_may_be_tangent_are_refused() -> None:
    """u_1 = (-15, 7) and u_2 = (p_2', -q_2') are parallel."""
    assert reason(({}, {}), ({}, {"first": linear(2, 15, 0), "second": linear(-1, 7, 0)})) == "heteroclinic"
    # And where some slope of the manifold in its cone makes them so.
    near = 7 + 6 * CLAIM.cone[1]
    found = outcome(({}, {}), ({}, {"first": linear(2, 15, 0), "second": linear(-1, near, -8)}))
    assert isinstance(found, NotProved)
    assert "the manifolds may be tangent" in found.reason.message


def test_what_is_missing_proves_nothing() -> None:
    checklist = Checklist()
    with guarded(BITS):
        check_heteroclinic_exactly(checklist, CLAIM)
        found = prove_heteroclinic(CLAIM, checklist, None)
    assert isinstance(found, NotProved)
    assert found.reason.condition == "return-map-1"
    with pytest.raises(NotEstablishedError) as failure:
        check_heteroclinic_exactly(Checklist(), replace(CLAIM, level_coordinate="x"))
    assert failure.value.reason.condition == "level"


def test_claims_that_cannot_be_are_refused_with_their_field() -> None:
    claim: HeteroclinicOrbit = cases.hills()
    wrong: dict[str, list[Any]] = {
        "reversing_symmetry": [(1, 1, 1, -1)], "section": ["x"], "level_coordinate": ["y"], "level": [None],
        "level_sign": [(1,), (1, 0)], "returns": [(2, 2, 2), (2, 0)], "arrival": [(6,), (0, 6)],
        "slope": [(Q(1),), (Q(1), Q(0))], "cone": [(Q(1),), (Q(1), Q(0))], "centre": [claim.centre[:2]],
        "radii": [claim.radii[:3], (*claim.radii[:3], Q(0))],
    }  # fmt: skip
    for name, values in wrong.items():
        for value in values:
            with pytest.raises(InputError, match=f"^{name}"):
                replace(claim, **{name: value})
    # Each end has its own part of the claim, and both are the whole.
    assert HeteroclinicOrbit.between("hills", *UNLIKE.ends) == UNLIKE
    for number, end in enumerate(UNLIKE.ends):
        own = end.level_sign, end.crossings, end.arrival, end.slope, end.cone
        whole = UNLIKE.level_sign, UNLIKE.returns, UNLIKE.arrival, UNLIKE.slope, UNLIKE.cone
        assert own == tuple(pair[number] for pair in whole)
        assert (end.centre, end.radii) == tuple(four[2 * number :][:2] for four in (UNLIKE.centre, UNLIKE.radii))


def test_the_words_say_of_each_end_what_is_claimed_of_it() -> None:
    theorem = heteroclinic_in_words(HeteroclinicTheorem(UNLIKE))
    for words in (
        "box 1 contains exactly one point to which its orbit comes back at crossing 2 of",
        "box 2 exactly one to which its orbit comes back at crossing 4,",
        "|g'| at most 0.0009765625 in box 1 and 0.001953125 in box 2",
        "crossing 6 of the orbit of the first is the image under R of crossing 5 of the orbit of the second",
    ):
        assert words in theorem
    ends = [End({"x": arb(k)}, *map(arb, range(k + 1, k + 5)), (arb(k + 5), arb(k + 6))) for k in (1, 11)]
    found = HeteroclinicResults((ends[0], ends[1]), dict.fromkeys("xuv", arb(30)))
    assert list(heteroclinic_found(UNLIKE, found)) == [
        "periodic orbit 1: x in [1.000000000, 1.000000000], multiplier in [3.000000000, 3.000000000]",
        "periodic orbit 2: x in [11.00000000, 11.00000000], multiplier in [13.00000000, 13.00000000]",
        "the heteroclinic orbit crosses the section at "
        + ", ".join(f"{w} in [30.00000000, 30.00000000]" for w in "xuv"),
    ]
    lines = list(heteroclinic_in_full(UNLIKE, theorem, found))
    for number, sign, slope, a in (
        (1, "positive", "0.5", "0.000244140625"),
        (2, "negative", "-0.75", "-0.0003662109375"),
    ):
        (line,) = (each for each in lines if each.startswith(f"Box {number} "))
        assert f"lies where v is {sign}" in line
        assert f"u = {slope} (a - s)" in line
        assert f"has the middle {a} and" in line
    assert "half-width 1.862645149230957e-09" in line
    own = define_system({
        "name": "own", "state": "a s g N", "parameters": "n", "field": {"a": "g", "s": "N", "g": "n*a", "N": "0"},
        "first_integral": "N**2",
    })  # fmt: skip
    claim = replace(UNLIKE, system=own, parameters={"n": Q(1)}, section="s", level_coordinate="N")
    theorem = heteroclinic_in_words(HeteroclinicTheorem(claim))
    assert "as a graph s0 = g0(a0), |g0'|" in theorem
    assert "for each integer n0," in theorem
    assert "n0 N0 " in theorem


@pytest.mark.slow
def test_false_claims_are_refused() -> None:
    claim = cases.hills()
    r_1, rho_1, _, rho_2 = claim.radii
    c_1, a_1, c_2, a_2 = claim.centre

    def why(**changes: Any) -> str:
        found = certify(replace(claim, **changes), LIMITS)
        assert not found.proved
        return found.reason.condition

    # No intersection there; another number of crossings; the stable direction for the unstable one.
    assert why(centre=(c_1, a_1 + 4 * rho_1, c_2, a_2)) == "heteroclinic"
    assert why(centre=(c_1, a_1, c_2, a_2 - 4 * rho_2)) == "heteroclinic"
    assert why(arrival=(7, 6)) in ("sheet", "heteroclinic")
    assert why(arrival=(6, 4)) == "heteroclinic"
    assert why(slope=(-claim.slope[0], claim.slope[1])) in ("cone-1", "periodic-1")
    # The other branch, a box beside the periodic orbit, and one orbit for both.
    assert why(centre=(c_1, -a_1, c_2, a_2)) in ("return-map-1", "heteroclinic")
    assert why(centre=(c_1 + 4 * r_1, a_1, c_2, a_2)) == "periodic-1"
    first, _ = claim.ends
    found = certify(HeteroclinicOrbit.between("one", first, first), LIMITS)
    assert found.reason is not None
    assert found.reason.condition == "distinct"


@pytest.mark.slow
def test_an_orbit_from_one_libration_point_to_the_other_one_is_proved() -> None:
    """Wilczak and Zgliczynski 2003: mu = 0.0009537, C = 3.03 (theirs is larger by mu (1 - mu)), from L1 to L2."""
    found = certify(cases.oterma(), Limits(digits=10, max_precision=256))
    assert found.proved, found.reason
    for end, x, multiplier in zip(
        found.results.ends, ("0.920803491320743", "1.08192948684179"), (1391.778, 1147.248), strict=True
    ):
        assert abs(float(end.point["x"]) - float(x)) < 1e-9
        assert abs(float(end.multiplier) - multiplier) < 0.02
    assert abs(float(found.results.meeting["x"]) - 1.0398192025) < 1e-8
