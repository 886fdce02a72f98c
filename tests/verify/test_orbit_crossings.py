"""Orbits whose halves meet the section more than once: a vertical orbit, its turning distances, false claims."""

from __future__ import annotations

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

from orbitproof.shared.formats import HALF_PERIOD, Candidate, Equation, read_candidates
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.evidence import exact_value
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import OrbitResults, enclose_orbit
from orbitproof.verify.poincare import PHYSICAL, REGULARISED, IntegratorSettings

(VERTICAL,) = read_candidates(Path(__file__).resolve().parents[1] / "data" / "orbit-vertical.json")
LIMITS = Limits(digits=12, max_precision=256)
BITS = 160
FLOW = Orbits(three_body, 1)


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    return certify(VERTICAL, LIMITS)


@pytest.fixture(scope="module")
def orbit(certificate: Certificate) -> OrbitResults:
    assert certificate.proved, certificate.reason
    assert certificate.orbit is not None
    return certificate.orbit


@pytest.fixture(scope="module")
def state(orbit: OrbitResults) -> Callable[[float], list[Any]]:
    """The state at a share of the half period, by an integrator that shares nothing with the verifier."""

    def at(share: float) -> list[Any]:
        with mpmath.workprec(BITS):
            return list(map(number, end(start_of(orbit), Fraction(share) * exact_value(orbit.half_period.mid()))))

    return at


def end(start: list[Fraction], time: Fraction) -> tuple[Fraction, ...]:
    return FLOW.flow(start, [VERTICAL.parameters["mu"]], time)


def test_the_half_orbit_ends_at_its_second_crossing(
    orbit: OrbitResults, state: Callable[[float], list[Any]], certificate: Certificate
) -> None:
    with mpmath.workprec(BITS):
        x, y, z, vx, vy, vz = state(1)
        assert max(map(abs, (y, vx, vz))) < 1e-14
        for ball, value in zip(orbit.other_point.values(), (x, z, vy), strict=True):
            assert contains(ball, value, 1e-14)
        # By the orbit's second symmetry it is on the x axis halfway, crossing the section outside of Fix(R).
        _, y, z, _, _, vz = state(0.5)
        assert max(abs(y), abs(z)) < 1e-14
        assert abs(vz) > 0.1
    assert [item.name for item in certificate.hypotheses][3:5] == ["half-orbit", "orbit"]
    assert "P the power 2 of the Poincare map" in str(certificate.theorem)
    assert "meets the section in a period 4 times" in str(certificate.theorem)


def test_a_least_distance_between_the_ends_is_where_an_independent_integration_finds_it(
    orbit: OrbitResults, state: Callable[[float], list[Any]]
) -> None:
    def distance(share: float) -> Any:
        x, y, z, *_ = state(share)
        return mpmath.sqrt((x - 1 + number(VERTICAL.parameters["mu"])) ** 2 + y**2 + z**2)

    assert orbit.least is not None
    assert orbit.greatest is not None
    with mpmath.workprec(BITS):
        (time,) = orbit.least.times
        assert contains(time, middle(orbit.half_period) / 2, 1e-18)
        assert contains(orbit.least.distance, distance(0.5), 1e-14)
        assert contains(orbit.greatest.distance, distance(0), 1e-18)
        for share in (0.2, 0.45, 0.55, 0.9):
            assert middle(orbit.least.distance) < distance(share) < middle(orbit.greatest.distance)


def test_the_turning_distance_is_the_same_in_other_coordinates() -> None:
    """Steps of other lengths, in another time."""
    approaches = []
    for coordinates in (PHYSICAL, REGULARISED):
        found = enclose_orbit(VERTICAL, IntegratorSettings(128, coordinates=coordinates), ORACLE)
        assert found.distance is not None
        (approach,) = found.distance.between
        assert approach.kind == 1
        assert approach.value.rad() < 1e-15
        approaches.append(approach)
    first, second = approaches
    assert agree(first.time, second.time)
    assert agree(first.value, second.value)


@pytest.mark.slow
def test_multipliers_are_those_of_the_variational_equations(orbit: OrbitResults) -> None:
    """Sum and sum of squares of the multipliers, from difference quotients of the whole orbit."""
    with mpmath.workprec(BITS):
        step, period = Fraction(1, 2**60), exact_value(orbit.period.mid())
        columns = []
        for axis in range(6):
            ends = []
            for sign in (1, -1):
                start = start_of(orbit)
                start[axis] += sign * step
                ends.append(end(start, period))
            columns.append([number((a - b) / (2 * step)) for a, b in zip(*ends, strict=True)])
        matrix = mpmath.matrix(columns).T
        square = matrix * matrix
        trace, trace_of_square = (sum(each[i, i] for i in range(6)) for each in (matrix, square))
        s = [middle(value.real) for value in orbit.stability.parameters]
        assert abs(2 * sum(s) - (trace - 2)) < 1e-8
        assert abs(4 * (s[0] ** 2 + s[1] ** 2) - 4 - (trace_of_square - 2)) < 1e-5
    assert orbit.stability.verdict == "unstable"


def claim(**changes: Any) -> Candidate:
    return replace(VERTICAL, **changes)


@pytest.mark.parametrize(
    "false, condition",
    [
        (claim(crossings=1), "orbit"),
        (claim(crossings=3), "half-orbit"),
        # The fourth crossing, after a whole period, is in Fix(R) again: not the end of a half orbit.
        pytest.param(claim(crossings=4), "half-orbit", marks=pytest.mark.slow),
        (claim(equation=Equation(HALF_PERIOD, Fraction("1.7860767"))), "orbit"),
        # The period in place of its half.
        (claim(equation=Equation(HALF_PERIOD, Fraction("3.572153559729"))), "orbit"),
        (claim(parameters={"mu": Fraction("0.012150584460350998")}), "orbit"),
    ],
    ids=["once", "three times", "a whole period", "half period", "period", "mass"],
)
def test_a_false_claim_is_not_proved(false: Candidate, condition: str) -> None:
    certificate = certify(false, LIMITS)
    assert not certificate.proved
    assert certificate.reason is not None
    assert certificate.reason.condition == condition
