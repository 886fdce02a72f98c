"""The period of an orbit with a force: exactly as many of the force's as it has; nothing where that is not known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction as Q
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support import periodic_cases as cases
from support.balls import agree
from support.metamorphic_cases import CURVES
from support.periodic_bifurcation_cases import forced_fold

from orbitproof.shared.formats import define_system
from orbitproof.shared.systems import System
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import certify, recheck
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.evidence import enclose
from orbitproof.verify.periodic import PeriodsOfForce, of_orbit, periods_of_force
from orbitproof.verify.periodic_curve import PeriodicCurveTheorem
from orbitproof.verify.run.row_tables import verdict_text
from orbitproof.verify.words.periodic import exactly_in_words
from orbitproof.verify.words.periodic_curve import periodic_curve_in_words

ANY = {"r": Q(1), "k": Q(1)}
START = {"force_cos": arb(1), "force_sin": arb(0, 1e-9)}


def leaky(force: str, **more: Any) -> System:
    """x' = -x + force."""
    return define_system({"name": "leaky", "state": "x", "parameters": "r k", "field": {"x": f"{force} - x"}} | more)


def with_own(u: str, w: str, **more: Any) -> System:
    """With equations of a file's own for coordinates that are called like those of a force."""
    field = {"x": "force_cos - x", "force_cos": u, "force_sin": w}
    given = {"name": "own", "state": "x force_cos force_sin", "parameters": "r k", "field": field}
    return define_system(given | {"where": {"g": "(1 - force_cos**2 - force_sin**2)/4"}} | more)


def found(
    system: System,
    times: Q = Q(1),
    width: float = 1e-6,
    point: Mapping[str, arb] = START,
    **parameters: Q | arb,
) -> PeriodsOfForce | None:
    """Of a period that differs from 2 pi `times` by at most `width`, at r = 3 and k = 2 unless others are given."""
    with ctx.workprec(200):
        period = 2 * enclose(times) * arb.pi() + arb(0, width)
        return periods_of_force(system, {"r": Q(3), "k": Q(2)} | parameters, point, period)


FORCED = {
    "once": (cases.in_plane(leaky("cos(2*t)"), 2, [Q(1, 5), Q(1), Q(0)], Q(1, 2**70), parameters=ANY), 1, "2"),
    "twice": (cases.locked(Q(3)), 2, "3"),
    "twice, backward": (cases.locked(Q(-3, 2), direction=-1), 2, "1.5"),
}
"""With how many times the period of the force the orbit has, and the speed of the force."""


@pytest.mark.parametrize("name", FORCED)
def test_an_orbit_is_proved_to_have_a_multiple_of_the_period_of_the_force(name: str) -> None:
    claim, times, speed = FORCED[name]
    certificate = certify(claim, Limits(digits=12))
    assert certificate.proved, certificate.reason
    exactly = f"exactly {times} x 2 pi/omega, where omega = {speed} is the speed of the force"
    assert f"It is {exactly}: force_cos and force_sin are the cosine" in certificate.document["statement"]["in_full"]
    assert f"the period is {exactly}\n" in verdict_text([claim], {claim.id: certificate}).replace("\n    ", " ")
    with ctx.workprec(200):
        assert certificate.periodic is not None
        assert (certificate.periodic.period - 2 * times * arb.pi() / arb(float(speed))).contains(0)
    assert recheck(certificate).stands


@pytest.mark.parametrize(
    ("force", "rate", "times"),
    [
        ("cos(r*t)", 3, 3), ("sin(-r*t)", 3, 3), ("cos(r*t/k)", Q(3, 2), 3), ("cos(t)", 1, 1), ("cos(t)", 1, 2),
        ("cos((r - k)*t + x)**2", 1, 5), ("cos(r*t) + sin(3*r*t/2)", Q(3, 2), 3), ("cos(r*t)*exp(x)", 3, 6),
    ],
)  # fmt: skip
def test_it_is_counted_in_turns_of_the_angle_of_which_all_rates_are_multiples(force: str, rate: Q, times: int) -> None:
    assert found(leaky(force), times / Q(rate)) == PeriodsOfForce(times, Q(rate))


def test_a_rate_that_is_no_fraction_lies_in_a_ball() -> None:
    root = found(leaky("cos(sqrt(r)*t)"), Q(2), r=Q(9, 4))
    assert root is not None
    assert root.number == 3
    assert isinstance(root.rate, arb)
    assert root.rate.contains(1.5)
    assert root.rate.rad() < 1e-60
    assert found(leaky("cos(sqrt(r)*t)"), Q(2), r=Q(-9, 4)) is None
    thirds = found(leaky("cos(sqrt(r)*t)"), Q(2), 0.5, r=Q(7, 3))
    assert thirds is not None
    assert isinstance(thirds.rate, arb)
    with ctx.workprec(256):
        assert (3 * thirds.rate**2).contains(7)
    assert thirds.rate.rad() < 1e-60
    varying = found(leaky("cos(r*t)"), r=arb(3, 1e-8))
    assert varying is not None
    assert varying.number == 3
    assert isinstance(varying.rate, arb)
    assert varying.rate.contains(3)


def test_a_rate_that_is_a_long_fraction_lies_in_a_ball() -> None:
    """Its 80,000 digits are not written."""
    rate, value = "(r**100)**50", 1 + Q(1, 10**16)
    own = with_own(f"({rate})*(-force_sin + g*force_cos)", f"({rate})*(force_cos + g*force_sin)")
    long = found(own, r=value)
    assert long is not None
    assert isinstance(long.rate, arb)
    assert "where omega in [1.0000000000" in exactly_in_words(long)
    with ctx.workprec(200):
        assert agree(long.rate, enclose(value) ** 5000)


def test_nothing_is_said_where_more_integers_than_one_are_possible_or_none_is() -> None:
    system = leaky("cos(r*t)")
    assert found(system, Q(2, 3), 2.0) == PeriodsOfForce(2, Q(3))
    assert found(system, Q(2, 3), 2.2) is None
    assert found(system, Q(1, 2)) is None
    assert found(system, Q(1, 3), r=arb(3, 4)) is None
    # The only integer is 0: the force stands still, or the enclosures contradict each other.
    assert found(system, r=Q(0)) is None
    assert found(leaky("cos(t*k/r)"), r=Q(0)) is None
    assert found(system, width=float("inf")) is None


def test_nothing_is_said_of_what_may_be_at_rest_in_the_middle_of_the_circle() -> None:
    system = leaky("cos(r*t)")
    rest = {"force_cos": arb(0, 1e-9), "force_sin": arb(0)}
    assert found(system, point=rest) is None
    assert found(system, point={"x": arb(1)}) is None
    assert found(system, point={"force_sin": arb(-1)}) is not None


@pytest.mark.parametrize(
    ("u", "w", "is_force"),
    [
        ("r*(-force_sin + g*force_cos)", "r*(force_cos + g*force_sin)", True),
        ("r*force_cos*(1 - force_cos**2 - force_sin**2)/4 - r*force_sin", "g*force_sin*r + force_cos*r", True),
        ("r**2*(-force_sin + g*force_cos)/r", "r*(force_cos + g*force_sin)", True),
        ("-r*force_sin", "r*force_cos", False),
        ("r*(-force_sin + g*force_cos)", "r*force_cos", False),
        ("-r*force_sin", "r*(force_cos + g*force_sin)", False),
        ("r*(-force_sin + g*force_cos)", "k*(force_cos + g*force_sin)", False),
        ("r*(-force_sin - g*force_cos)", "r*(force_cos - g*force_sin)", False),
        ("r*(-force_sin + g*force_cos)", "-r*(force_cos + g*force_sin)", False),
        ("x*(-force_sin + g*force_cos)", "x*(force_cos + g*force_sin)", False),
        ("r*force_cos*(-force_sin + g*force_cos)", "r*force_cos*(force_cos + g*force_sin)", False),
        ("r*(-force_sin + 4*g*force_cos)", "r*(force_cos + 4*g*force_sin)", False),
        ("r*(-force_sin + g*force_cos)", "r*(force_cos + g*force_sin) + x - x**2", False),
        ("r - k*force_cos", "r - k*force_sin", False),
        ("-force_cos", "k - k*force_sin", False),
        # One of the two is not used, c is not defined at the start, and polynomials are too large for what is not so.
        ("-force_cos", "k - force_cos", False),
        ("r*force_sin/force_sin*(-force_sin + g*force_cos)", "r*force_sin/force_sin*(force_cos + g*force_sin)", False),
        ("-r*force_sin*((k - 1)**100)**100*(k - 1)**2", "r*force_cos*((k - 1)**100)**100*(k - 1)**2", False),
    ],
)
def test_the_equations_decide_what_is_a_force_and_not_the_names(u: str, w: str, is_force: bool) -> None:
    assert (found(with_own(u, w)) is not None) == is_force


def test_in_another_order_of_the_state_it_is_the_same() -> None:
    system = with_own("k*(-force_sin + g*force_cos)", "k*(force_cos + g*force_sin)", state="force_sin x force_cos")
    assert found(system, Q(1, 2)) == PeriodsOfForce(1, Q(2))
    assert found(define_system({"name": "free", "state": "x y", "field": {"x": "y", "y": "-x"}})) is None


def test_a_parameter_that_varies_counts_with_its_value_at_the_bifurcation() -> None:
    fold = forced_fold()
    with ctx.workprec(200):
        period = 4 * arb.pi() / arb(2.9375)
        at = of_orbit(fold, START, period, arb(2.9375))
        assert at is not None
        assert at.number == 2
        assert isinstance(at.rate, arb)
        assert not at.rate.contains(3)
        of_k = of_orbit(replace(fold, parameter="k"), START, 4 * arb.pi() / 3, arb(7))
    assert of_k == PeriodsOfForce(2, Q(3))


def test_the_screen_tells_it_of_a_bifurcation_with_the_value_there() -> None:
    fold = forced_fold()
    torus = replace(
        fold, kind="periodic-torus", kernel=((Q(1), Q(0), Q(0)), (Q(0), Q(1), Q(0))), multiplier=(Q(3, 5), Q(4, 5))
    )
    results: Any = SimpleNamespace(point=START, parameter=arb(2.9375, 2**-40))
    with ctx.workprec(200):
        results.period = 4 * arb.pi() / arb(2.9375)
    for claim in (fold, torus):
        (line,) = kind_of(claim).besides(claim, results)
        assert line.startswith("the period is exactly 2 x 2 pi/omega, where omega in [2.93749999999")


def test_of_a_curve_on_which_the_force_may_be_0_nothing_is_said() -> None:
    names = {"force_cos": arb(0, 1e-9), "force_sin": arb(0)}
    atlas: Any = CURVES["periodic-arc"]().atlas
    along = replace(atlas.claim, normal=(Q(0), Q(1), Q(0), Q(0)), parameter="k", increasing=("k",), covers=None)
    forced = replace(atlas, system=cases.LOCKED, parameters={"r": Q(3)}, claim=along)
    with ctx.workprec(200):
        period = 2 * arb.pi()
    for more, is_told in ((START, True), (names, False)):
        ends = {key: {"k": arb(1), "x": arb(1), **more} for key in ("start", "end")}
        known: Any = SimpleNamespace(ends=ends, turns=(), period=period, multipliers=())
        text = periodic_curve_in_words(PeriodicCurveTheorem(forced), known)
        assert ("Each is exactly 3 x 2 pi/omega" in text) == is_told


def test_of_a_curve_it_is_known_where_the_rate_does_not_vary() -> None:
    """The parameter that varies has no value."""
    system = leaky("k*cos(r*t)")
    with ctx.workprec(200):
        assert periods_of_force(system, {"r": Q(3)}, START, 2 * arb.pi()) == PeriodsOfForce(3, Q(3))
        assert periods_of_force(system, {"k": Q(3)}, START, 2 * arb.pi()) is None
