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
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Proved, enclose, guarded
from orbitproof.verify.heteroclinic import (
    HeteroclinicEnclosures,
    check_heteroclinic_exactly,
    prove_heteroclinic,
)
from orbitproof.verify.homoclinic import Way, width_of_sliver
from orbitproof.verify.periodic import Linearised

BITS = 192
LIMITS = Limits(digits=10, max_precision=256)
CLAIM = replace(
    cases.hills(), cone=(Q(1, 1024), Q(1, 512)), centre=(Q(-1), Q(1, 4096), Q(1), Q(-1, 8192)),
    radii=(Q(1, 2048), Q(1, 2**30), Q(1, 2048), Q(1, 2**29)),
)  # fmt: skip
RHO = CLAIM.radii[1], CLAIM.radii[3]
DELTA = tuple(map(width_of_sliver, CLAIM.ends))


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
    found = outcome(({}, {"time": linear(4, 1, 2)}), arrivals)
    assert isinstance(found, Proved)
    results = found.results
    for end, passage, time, slopes in zip(
        results.ends, (CLAIM.centre[1] + first, CLAIM.centre[3] + second), (9 + 5 * first, 8 + 6 * second),
        ((-15, 7), (11, 13)), strict=True,
    ):  # fmt: skip
        assert end.passage.contains(enclose(passage))
        assert end.time.contains(enclose(time))
        assert all(ball.contains(slope) for ball, slope in zip(end.slopes, slopes, strict=True))
    assert [end.period.contains(period) for end, period in zip(results.ends, (3, 4), strict=True)] == [True, True]
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


def test_w_has_one_sign_at_both_arrivals() -> None:
    assert reason(({}, {}), ({}, {"w": linear(1, 0, 0)})) == "sheet"
    assert reason(({}, {}), ({"w": linear(0, 0, 0)}, {})) == "sheet"
    assert reason(({}, {}), ({"w": linear(-1, 0, 2 / DELTA[0])}, {})) == "sheet"
    assert reason(({}, {}), ({}, {"w": linear(-1, 2 / RHO[1], 0)})) == "sheet"
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


def test_manifolds_that_may_be_tangent_are_refused() -> None:
    """u_1 = (-15, 7) and u_2 = (p_2', -q_2') are parallel."""
    assert reason(({}, {}), ({}, {"first": linear(2, 15, 0), "second": linear(-1, 7, 0)})) == "heteroclinic"
    # And where some slope of the manifold in its cone makes them so.
    near = 7 + 4 * CLAIM.cone[1]
    found = ({}, {"first": linear(2, 15, 0), "second": linear(-1, near, -8)})
    assert reason(({}, {}), found) == "heteroclinic"


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
    first, second = claim.ends
    assert HeteroclinicOrbit.between("hills", first, second) == claim


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
