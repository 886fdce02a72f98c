"""Periodic orbits without symmetry: closed forms and published orbits proved, false claims not."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
from flint import acb, arb, ctx
from support import periodic_cases as cases
from support.balls import agree

from orbitproof.shared.formats import PeriodicOrbit, define_system
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import certify
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.claim import is_free_of_divergence
from orbitproof.verify.evidence import NotProved, Outcome, Proved, guarded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import (
    Linearised,
    PeriodicEnclosures,
    PeriodicResults,
    enclose_periodic,
    multipliers_of,
    stops_of,
)
from orbitproof.verify.poincare import IntegratorSettings

BITS = 160


@cache
def _enclosed(key: str) -> PeriodicEnclosures:
    return enclose_periodic(CLAIMS[key], IntegratorSettings(BITS), ORACLE)


CLAIMS = {
    "hopf": cases.hopf(),
    "turning": cases.turning(Fraction(-1, 10)),
    "oscillators": cases.oscillators(),
    "AB": cases.lorenz("AB"),
}


def _outcome(claim: PeriodicOrbit, enclosures: PeriodicEnclosures | None) -> Outcome[PeriodicResults]:
    return _conclude(claim, BITS, enclosures)


def _proved(key: str) -> PeriodicResults:
    outcome = _outcome(CLAIMS[key], _enclosed(key))
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


def _refused(claim: PeriodicOrbit, enclosures: PeriodicEnclosures | None) -> str:
    outcome = _outcome(claim, enclosures)
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


def _contains(ball: acb | arb, value: acb | arb) -> bool:
    return bool(acb(ball).contains(acb(value).mid()))


def test_a_limit_cycle_is_proved_with_its_period_and_multipliers() -> None:
    found = _proved("hopf")
    with ctx.workprec(500):
        pi = arb.pi()
        assert _contains(found.period, 2 * pi)
        small, large = found.multipliers.values
        assert _contains(small, (-4 * pi).exp())
        assert _contains(large, (-pi / 2).exp())
    assert found.period.rad() < 1e-20
    counts = found.multipliers
    assert (counts.inside, counts.on, counts.outside, counts.undecided, counts.trivial) == (2, 0, 0, 0, 1)
    assert counts.is_attracting
    assert found.level is None


@pytest.mark.parametrize("w", [Fraction(1, 2), Fraction(3)])
def test_a_planar_cycle_has_its_floquet_exponent(w: Fraction) -> None:
    claim = cases.planar(w)
    outcome = _outcome(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))
    assert isinstance(outcome, Proved), outcome.reason
    found = outcome.results
    with ctx.workprec(500):
        turn = 2 * arb.pi() * w.denominator / w.numerator
        assert _contains(found.period, turn)
        (value,) = found.multipliers.values
        assert _contains(value, (-turn / 2).exp())
    assert found.multipliers.is_attracting


@pytest.mark.parametrize(("a", "outside"), [(Fraction(-1, 10), 0), (Fraction(1, 10), 2)])
def test_a_complex_pair_is_enclosed_and_counted(a: Fraction, outside: int) -> None:
    claim = cases.turning(a)
    outcome = _outcome(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))
    assert isinstance(outcome, Proved)
    found = outcome.results.multipliers
    assert (found.inside, found.outside, found.undecided) == (3 - outside, outside, 0)
    with ctx.workprec(500):
        exact = (2 * arb.pi() * acb(arb(a.numerator) / a.denominator, arb(1) / 3)).exp()
        assert any(_contains(value, exact) for value in found.values)
        assert any(_contains(value, exact.conjugate()) for value in found.values)


def test_on_a_level_two_multipliers_are_one_and_an_elliptic_pair_is_on_the_circle() -> None:
    found = _proved("oscillators")
    with ctx.workprec(500):
        angle = 2 * arb.pi() * arb(2).sqrt()
        assert _contains(found.period, 2 * arb.pi())
        assert any(_contains(value, acb(0, angle).exp()) for value in found.multipliers.values)
    counts = found.multipliers
    assert (counts.inside, counts.on, counts.outside, counts.undecided, counts.trivial) == (0, 2, 0, 0, 2)
    assert found.level == 4


def test_published_orbits_of_lorenz_are_proved() -> None:
    """D. Viswanath, Physica D 190 (2004) 115-128: AB and AAB; quoted without the paper at hand."""
    with ctx.workprec(300):
        periods = {
            "AB": arb("1.558652210716174727567870209212696070528480548997243935889521578319019875"),
            "AAB": arb("2.3059072639398477494266319272"),
        }
        slack = {"AB": arb(0, 1e-60), "AAB": arb(0, 1e-27)}
    found = _proved("AB")
    assert agree(found.period, periods["AB"] + slack["AB"])
    assert (found.multipliers.inside, found.multipliers.outside) == (1, 1)
    assert not found.multipliers.is_attracting
    certificate = certify(cases.lorenz("AAB"), Limits())
    assert certificate.proved
    assert certificate.periodic is not None
    assert agree(certificate.periodic.period, periods["AAB"] + slack["AAB"])


SLIVERS = [Fraction(3, 2**90), Fraction(-3, 2**90), Fraction(5, 2**91)]


@pytest.mark.parametrize("by", SLIVERS)
@pytest.mark.parametrize("place", [0, 1])
def test_a_box_beside_the_orbit_is_refused(by: Fraction, place: int) -> None:
    claim = cases.shifted(cases.hopf(), place, by)
    outcome = _outcome(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "periodic"
    assert outcome.reason.excluded


def test_an_orbit_on_the_edge_of_the_box_is_not_proved() -> None:
    claim = cases.shifted(cases.hopf(), 0, Fraction(1, 2**90))
    outcome = _outcome(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "periodic"
    assert not outcome.reason.excluded
    assert outcome.reason.needs_precision


@pytest.mark.parametrize("place", [0, 1])
def test_what_is_found_does_not_depend_on_the_centre(place: int) -> None:
    claim = cases.shifted(cases.lorenz("AB"), place, Fraction(4, 10**21))
    outcome = _outcome(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))
    assert isinstance(outcome, Proved)
    with guarded(BITS):
        found, exact = outcome.results, _proved("AB")
        assert agree(found.period, exact.period)
        assert all(agree(found.point[name], exact.point[name]) for name in "xyz")
        assert found.period.rad() < 1e-27


def test_on_a_level_the_point_is_that_of_the_level() -> None:
    level, shift = Fraction(4 * 17), Fraction(1, 2**92)
    claim = cases.shifted(cases.oscillators(level=level, system=cases.PRODUCT, point=Fraction(2)), 0, shift)
    outcome = _outcome(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))
    assert isinstance(outcome, Proved), outcome.reason
    with guarded(BITS):
        assert (outcome.results.point["x"] - 2).contains(0)
        assert outcome.results.point["x"].rad() < 1e-50


def test_the_direction_is_that_of_all_points_of_the_box() -> None:
    assert _refused(cases.hopf(radii=(Fraction(2), Fraction(1))), None) == "direction"


def test_a_box_without_an_orbit_of_lorenz_is_refused() -> None:
    claim = cases.shifted(cases.lorenz("AB"), 0, Fraction(3, 10**20))
    assert _refused(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)) == "periodic"


@pytest.mark.parametrize(
    ("changes", "condition"),
    [
        ({"direction": 1}, "direction"),
        ({"offset": Fraction(28)}, "section"),
        ({"normal": (Fraction(0),) * 3}, "section"),
        ({"normal": (Fraction(1), Fraction(0), Fraction(1))}, "section"),
        ({"frame": ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)), (Fraction(1), Fraction(0)))}, "section"),
        ({"frame": ((Fraction(1), Fraction(2)), (Fraction(1), Fraction(2)), (Fraction(0),) * 2)}, "section"),
    ],
)
def test_what_is_wrong_with_the_section_is_seen_exactly(changes: dict[str, Any], condition: str) -> None:
    assert _refused(cases.lorenz("AB", **changes), _enclosed("AB")) == condition


@pytest.mark.parametrize("crossings", [1, 3])
def test_another_number_of_crossings_is_refused(crossings: int) -> None:
    claim = cases.lorenz("AB", crossings=crossings)
    assert _refused(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)) == "periodic"


@pytest.mark.parametrize("crossings", [2, 4, 6])
def test_an_orbit_run_through_several_times_is_not_proved(crossings: int) -> None:
    claim = cases.hopf(crossings=crossings)
    expected = ("least-period",) if crossings == 2 else ("least-period", "periodic")
    assert _refused(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)) in expected


def test_the_orbit_of_another_parameter_is_refused() -> None:
    claim = cases.lorenz("AB", parameters={"sigma": Fraction(10), "rho": Fraction("28.0001"), "beta": Fraction(8, 3)})
    assert _refused(claim, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)) == "periodic"


def test_the_orbit_of_another_level_is_refused() -> None:
    claim = replace(cases.oscillators(), level=Fraction(4) + Fraction(1, 2**30))
    assert _refused(claim, _enclosed("oscillators")) == "periodic"


def test_without_its_level_an_orbit_of_a_family_is_not_isolated() -> None:
    assert _refused(replace(cases.oscillators(), level=None), _enclosed("oscillators")) == "periodic"


def test_what_is_no_first_integral_is_refused() -> None:
    wrong = replace(cases.OSCILLATORS, first_integral=lambda x, _: (x[0] * x[0] + 2 * x[1] * x[1],))
    assert _refused(replace(cases.oscillators(), system=wrong), _enclosed("oscillators")) == "first-integral"


def test_a_level_whose_derivative_vanishes_on_the_way_is_refused() -> None:
    """With an image that differs by more than the radius, -p_0 may be as good as p_0."""
    found = _enclosed("oscillators")
    (last,) = found.returns
    far = replace(last, image=(replace(last.image[0], centre=arb(-4, 1)), *last.image[1:]))
    assert _refused(CLAIMS["oscillators"], replace(found, returns=(far,))) == "last-coordinate"


def _changed(key: str, change: Any) -> PeriodicEnclosures:
    found = _enclosed(key)
    return replace(found, returns=change(found.returns))


def test_a_derivative_that_may_be_singular_proves_nothing() -> None:
    def same(returns: Any) -> Any:
        flat = Linearised(arb(0), (arb(1), arb(0))), Linearised(arb(0), (arb(0), arb(1)))
        return (*returns[:-1], replace(returns[-1], image=flat))

    assert _refused(CLAIMS["AB"], _changed("AB", same)) == "periodic"


@pytest.mark.parametrize(("spread", "words"), [(0.0, "may be singular"), (0.75, "known too roughly, up to [0.75")])
def test_why_a_derivative_is_not_shown_to_be_regular_is_said(spread: float, words: str) -> None:
    """Multipliers near 0 that are known badly are not multipliers 1."""
    middle = 1.0 if spread == 0.0 else 0.5

    def vague(returns: Any) -> Any:
        flat = Linearised(arb(0), (arb(middle, spread), arb(0))), Linearised(arb(0), (arb(0), arb(0, spread)))
        return (*returns[:-1], replace(returns[-1], image=flat))

    outcome = _outcome(CLAIMS["AB"], _changed("AB", vague))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "periodic"
    assert words in outcome.reason.message


def test_an_earlier_return_that_may_be_the_point_proves_nothing() -> None:
    def back(returns: Any) -> Any:
        return (replace(returns[0], image=(Linearised(arb(0, 1), (arb(0), arb(0))),) * 2), *returns[1:])

    assert _refused(CLAIMS["AB"], _changed("AB", back)) == "least-period"


@pytest.mark.parametrize(
    ("crossings", "stops"), [(1, (1,)), (2, (1, 2)), (5, (1, 5)), (6, (2, 3, 6)), (8, (4, 8)), (30, (6, 10, 15, 30))]
)
def test_earlier_returns_are_those_of_the_greatest_divisors(crossings: int, stops: tuple[int, ...]) -> None:
    assert stops_of(crossings) == stops


def _matrix(*rows: list[float]) -> list[list[arb]]:
    return [[arb(value) for value in row] for row in rows]


@pytest.mark.parametrize(
    ("matrix", "volume", "counts"),
    [
        (_matrix([0.5, 0], [0, 2]), False, (1, 0, 1, 0)),
        (_matrix([0.5, 0], [0, 2]), True, (1, 0, 1, 0)),
        (_matrix([0, -1], [1, 0]), False, (0, 0, 0, 2)),
        (_matrix([0, -1], [1, 0]), True, (0, 2, 0, 0)),
        (_matrix([0.5, 0, 0], [0, 0, -1], [0, 1, 0]), True, (1, 0, 0, 2)),
        (_matrix([0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0.6, -0.8], [0, 0, 0.8, 0.6]), True, (0, 0, 0, 4)),
        (_matrix([1, 1], [0, 1]), True, (0, 0, 0, 2)),
        (_matrix([0.5, 1], [0, 0.25]), False, (2, 0, 0, 0)),
        (_matrix([-1.5]), False, (0, 0, 1, 0)),
        (_matrix([0.5, 0], [0, 1]), False, (1, 0, 0, 1)),
        (_matrix([0, -0.5, 0], [0.5, 0, 0], [0, 0, 3]), False, (2, 0, 1, 0)),
        ([[arb(0, 3), arb(0)], [arb(0), arb(0.5)]], False, None),
        ([[arb("nan"), arb(0)], [arb(0), arb(0.5)]], False, (0, 0, 0, 2)),
    ],
)
def test_multipliers_are_counted(matrix: list[list[arb]], volume: bool, counts: tuple[int, ...] | None) -> None:
    found = multipliers_of(matrix, 1, volume)
    assert found.inside + found.on + found.outside + found.undecided == len(matrix)
    if counts is None:
        assert found.undecided >= 1
    else:
        assert (found.inside, found.on, found.outside, found.undecided) == counts


@pytest.mark.parametrize(
    ("matrix", "trivial", "attracting", "hyperbolic"),
    [
        (_matrix([0.5, 0], [0, -0.5]), 1, True, True),
        (_matrix([0.5, 0], [0, -0.5]), 2, False, True),
        (_matrix([0.5, 0], [0, -2]), 1, False, True),
        (_matrix([0.5, 0], [0, -1]), 1, False, False),
        (_matrix([0, -1], [1, 0]), 1, False, False),
    ],
)
def test_an_orbit_attracts_if_all_multipliers_but_the_first_are_inside(
    matrix: list[list[arb]], trivial: int, attracting: bool, hyperbolic: bool
) -> None:
    found = multipliers_of(matrix, trivial, False)
    assert (found.is_attracting, found.is_hyperbolic) == (attracting, hyperbolic)


@pytest.mark.parametrize(
    ("field", "free"),
    [
        ({"x": "x + y", "y": "x - y", "z": "x*y"}, True),
        ({"x": "x + y", "y": "x + y", "z": "x*y"}, False),
        ({"x": "x*z", "y": "y*z", "z": "-z**2"}, True),
        ({"x": "x*z", "y": "y*z", "z": "z**2"}, False),
        ({"x": "x*y/2", "y": "-y**2/4", "z": "y"}, True),
    ],
)
def test_the_divergence_is_the_sum_of_its_terms(field: dict[str, str], free: bool) -> None:
    system = define_system({"name": "any", "state": "x y z", "field": field})
    assert is_free_of_divergence(system.program, 3) is free


def test_a_multiplier_known_to_be_real_has_no_imaginary_part() -> None:
    found = multipliers_of(_matrix([0.5, 0.25, 0], [0.25, 2, 0.5], [0, 0.5, 4]), 1, False)
    assert all(value.imag.is_zero() for value in found.values)
    found = multipliers_of(_matrix([0, -1], [1, 0]), 1, True)
    assert not any(value.imag.is_zero() for value in found.values)
