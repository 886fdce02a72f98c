"""One symmetric orbit, singled out by an equation: enclosures against an independent integration, false claims."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import pytest
from support.balls import agree
from support.reference import Orbits, three_body
from support.springs import contains, middle, number, start_of
from support.within import within

from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, Candidate, Equation, read_candidates
from orbitproof.verify.attempt.precision import missing_of_orbit
from orbitproof.verify.certificate import Certificate, Level, Limits, certify, digest, recheck
from orbitproof.verify.evidence import bounds, exact_value
from orbitproof.verify.orbit import OrbitResults

DATA = Path(__file__).resolve().parents[1] / "data"
HALO = read_candidates(DATA / "orbit-candidates.json")[0]
LIMITS = Limits(digits=12)


MU = Fraction("1.215058560962404e-2")
FLOW = Orbits(three_body, 1)

precision = within(lambda: mpmath.workprec(160))


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    return certify(HALO, LIMITS)


@pytest.fixture(scope="module")
def orbit(certificate: Certificate) -> OrbitResults:
    assert certificate.proved, certificate.reason
    assert certificate.orbit is not None
    return certificate.orbit


@pytest.fixture(scope="module")
def flow(orbit: OrbitResults) -> Callable[[Fraction], list[Any]]:
    """The state at a time, by an integrator that shares nothing with the verifier."""
    return lambda time: [number(value) for value in FLOW.flow(start_of(orbit), [MU], time)]


def test_the_other_point_is_where_an_independent_integration_arrives(
    orbit: OrbitResults, flow: Callable[[Fraction], list[Any]]
) -> None:
    x, y, z, vx, vy, vz = flow(exact_value(orbit.half_period.mid()))
    assert max(map(abs, (y, vx, vz))) < 1e-16
    for ball, value in zip(orbit.other_point.values(), (x, z, vy), strict=True):
        assert contains(ball, value, 1e-16)
        low, high = bounds(ball)
        assert high - low < Fraction(1, 10**12)


def test_distances_are_extremal_over_the_whole_orbit(
    orbit: OrbitResults, flow: Callable[[Fraction], list[Any]]
) -> None:
    assert orbit.least is not None
    assert orbit.greatest is not None

    def distance(time: Fraction) -> Any:
        x, y, z, *_ = flow(time)
        return mpmath.sqrt((x - 1 + number(MU)) ** 2 + y**2 + z**2)

    assert contains(orbit.least.distance, distance(exact_value(orbit.least.times[0].mid())), 1e-14)
    assert contains(orbit.greatest.distance, distance(exact_value(orbit.greatest.times[0].mid())), 1e-14)
    for share in (0.1, 0.6, 0.97, 1.2):
        here = distance(Fraction(share) * exact_value(orbit.half_period.mid()))
        assert middle(orbit.least.distance) < here < middle(orbit.greatest.distance)


def test_multipliers_are_those_of_the_variational_equations(orbit: OrbitResults) -> None:
    """Sum and sum of products of the stability parameters, from difference quotients of the whole orbit."""
    step = Fraction(1, 2**60)

    def end(start: list[Fraction]) -> tuple[Fraction, ...]:
        return FLOW.flow(start, [MU], exact_value(orbit.period.mid()))

    columns, here = [], end(start_of(orbit))
    for axis in range(6):
        start = start_of(orbit)
        start[axis] += step
        columns.append([number((a - b) / step) for a, b in zip(end(start), here, strict=True)])
    matrix = mpmath.matrix(columns).T
    square = matrix * matrix
    trace, trace_of_square = (sum(each[i, i] for i in range(6)) for each in (matrix, square))
    # Two multipliers are 1; lambda^2 + 1/lambda^2 = 4 s^2 - 2 for the others.
    s = [middle(value.real) for value in orbit.stability.parameters]
    assert abs(2 * sum(s) - (trace - 2)) < 1e-8
    assert abs(4 * (s[0] ** 2 + s[1] ** 2) - 4 - (trace_of_square - 2)) < 1e-7
    for value, multiplier in zip(orbit.stability.parameters, orbit.stability.multipliers, strict=True):
        both = multiplier + 1 / multiplier
        assert agree(both, 2 * value)
    assert orbit.stability.verdict == "unstable"


def test_all_numbers_have_the_digits_that_were_asked_for(orbit: OrbitResults) -> None:
    assert missing_of_orbit(orbit, LIMITS.digits) <= 0
    for ball in (*orbit.point.values(), *orbit.other_point.values(), orbit.period):
        low, high = bounds(ball)
        assert high - low < Fraction(1, 10**12) * abs(low)


def test_sixteen_digits_take_few_bits_on_a_box_as_wide_as_they_allow(orbit: OrbitResults) -> None:
    """The half period of all orbits of the box is known less well than the length of a short last step."""
    wide = replace(HALO, radii=(Fraction(1, 2**40),) * 3)
    found = certify(wide, Limits(digits=16))
    assert found.proved, found.reason
    assert (found.computation.attempts, found.computation.precision <= 110) == (1, True)
    assert found.orbit is not None
    assert found.orbit.least is not None
    assert orbit.least is not None
    assert agree(found.orbit.least.distance, orbit.least.distance)
    assert missing_of_orbit(found.orbit, 16) <= 0


def claim(quantity: str, value: Fraction, coordinate: str | None = None, **changes: Any) -> Candidate:
    return replace(HALO, equation=Equation(quantity, value, coordinate), **changes)


@pytest.mark.parametrize(
    "false",
    [
        claim(COORDINATE, Fraction("1.0984423593815401"), "x"),
        claim(HALF_PERIOD, Fraction("1.3063074")),
        claim(LEVEL, Fraction("3.017905732646")),
        pytest.param(replace(HALO, parameters={"mu": Fraction("1.215058560962405e-2")}), marks=pytest.mark.slow),
        replace(HALO, centre=(HALO.centre[0], HALO.centre[1] + Fraction(1, 10**20), HALO.centre[2])),
    ],
    ids=["coordinate", "half period", "level", "mass", "centre"],
)
def test_a_false_claim_is_not_proved(false: Candidate) -> None:
    certificate = certify(false, Limits(digits=12, max_precision=128))
    assert not certificate.proved
    assert certificate.reason is not None
    assert certificate.reason.condition == "orbit"


@pytest.mark.slow
def test_an_extremum_that_is_not_there_is_found_by_integrating(certificate: Certificate) -> None:
    """A false table that agrees with itself: two extrema more, with everything else derived from it."""
    from orbitproof.verify.certificate.rechecking import derived

    entry = copy.deepcopy(certificate.to_json())
    least = "0x1p-20 +- 0x0"
    entry["enclosures"]["distance"]["between"] = [
        {"time": "0x1p-3 +- 0x0", "value": least, "kind": 1},
        {"time": "0x1p-2 +- 0x0", "value": "0x1p-8 +- 0x0", "kind": -1},
    ]
    forged = derived({**entry, "digest": digest(entry)})
    assert forged["verdict"] == "proved"
    assert forged["results"]["least_distance"]["distance"]["decimal"].startswith("[0.0009765625")
    result = recheck(Certificate.from_json({**forged, "digest": digest(forged)}), integrate=True)
    assert result.level is Level.CONCLUSION
    assert not result.stands
