"""The full return on the level as jets: springs whose return map is known, and orbits with known multipliers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

import mpmath
import pytest
from flint import arb
from support.balls import agree
from support.springs import BITS, SMALL, claim, exactly, half, number, springs
from test_functions_in_fields import swings
from test_orbit_on_level import certificate, claimed

from orbitproof.explore.refinement import OrbitTask, refine_orbit
from orbitproof.shared.formats import COORDINATE, Candidate, Equation
from orbitproof.shared.systems import FALKNER_SKAN
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import Proved, bounds, guarded, indices_up_to
from orbitproof.verify.newton import Jet, compose, derivatives_of
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import OrbitResults, full_return_jets, half_return_jets, inverse_jets
from orbitproof.verify.poincare import HalfReturn, IntegratorSettings, enclose_half_return

W = 2


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with mpmath.workprec(BITS), guarded(BITS):
        yield


def random_jets(random: Random, size: int) -> list[Jet]:
    def entry(i: int, index: tuple[int, ...]) -> arb:
        mean = 2 * (sum(index) == 1 and index[i] == 1)
        return arb(mean + Fraction(random.randrange(-100, 100), 300).numerator / arb(300))

    indices = [index for index in indices_up_to(size, 3) if any(index)]
    return [Jet(size, 3, {index: entry(i, index) for index in indices}) for i in range(size)]


@pytest.mark.parametrize("size", [1, 2, 4])
def test_a_map_after_its_inverse_is_the_identity(size: int) -> None:
    for seed in range(5):
        jets = random_jets(Random(seed), size)
        inverse = inverse_jets(jets)
        for i, jet in enumerate(jets):
            both = compose(derivatives_of(jet), inverse)
            for index in indices_up_to(size, 3):
                wanted = int(sum(index) == 1 and index[i] == 1)
                assert agree(both[index], arb(wanted))
                assert float(both[index].rad()) < 1e-30


def test_an_inverse_of_balls_contains_those_of_all_maps_in_them() -> None:
    random = Random(7)
    exact = random_jets(random, 2)
    wide = [Jet(2, 3, {k: v + arb(0, "1e-6") for k, v in jet.coefficients.items()}) for jet in exact]
    balls = inverse_jets(wide)
    for _ in range(20):
        near = [
            Jet(2, 3, {k: v + arb(random.uniform(-1, 1)) * arb("1e-6") for k, v in jet.coefficients.items()})
            for jet in exact
        ]
        for inside, outside in zip(inverse_jets(near), balls, strict=True):
            assert all(agree(outside[index], inside[index]) for index in indices_up_to(2, 3))


def test_a_singular_map_has_no_inverse() -> None:
    jets = [Jet(2, 3, {(1, 0): arb(1), (0, 1): arb(1)}), Jet(2, 3, {(1, 0): arb(1), (0, 1): arb(1, "1e-9")})]
    with pytest.raises(ZeroDivisionError):
        inverse_jets(jets)


@cache
def spring_claim(off: Fraction = Fraction(1, 2)) -> Candidate:
    """The orbit along the hard spring, the soft one at rest."""
    with mpmath.workprec(BITS):
        found = claim(111, Fraction(8), 1, SMALL, off)
    return replace(
        found,
        parameters={"w": Fraction(W)},
        centre=(Fraction(3, 2) + off * SMALL[0], off * SMALL[1]),
        frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))),
        equation=Equation(COORDINATE, Fraction(3, 2), "x"),
    )


@cache
def spring_half() -> HalfReturn:
    return enclose_half_return(spring_claim(), IntegratorSettings(128), ORACLE)


def amplitude(level: Any) -> Any:
    """a with a^2 + a^4/2 = level."""
    return mpmath.sqrt(mpmath.sqrt(1 + 2 * level) - 1)


def expected(rho: Any) -> tuple[Any, Any]:
    """The angle by which (y, vy / w^(1/2)) turns back in a full return, and its derivative in y^2 + vy^2 / w."""
    a = mpmath.mpf(3) / 2
    level = a**2 + a**4 / 2
    angle = lambda r: 2 * mpmath.sqrt(W) * half(amplitude(level - W * r))  # noqa: E731
    return angle(rho), mpmath.diff(angle, rho)


def test_the_full_return_of_springs_turns_by_an_angle_that_depends_on_the_energy() -> None:
    """z -> z exp(-i theta(|z|^2)), z = y + i vy / w^(1/2), in all derivatives up to order 3."""
    first, second = full_return_jets(half_return_jets(spring_claim(), spring_half()))
    theta, slope = expected(mpmath.mpf(0))
    root = mpmath.sqrt(W)
    for i, j in indices_up_to(2, 3):
        # Coefficient of y^i vy^j of exp(-i theta) (z - i slope z |z|^2).
        value = mpmath.mpc(0)
        if (i, j) == (1, 0):
            value = mpmath.mpc(1)
        elif (i, j) == (0, 1):
            value = mpmath.mpc(0, 1) / root
        elif i + j == 3:
            cubic = {(3, 0): 1, (2, 1): 1j / root, (1, 2): 1 / root**2, (0, 3): 1j / root**3}[i, j]
            value = -1j * slope * cubic
        value = mpmath.expj(-theta) * value
        for jet, part in ((first, value.real), (second, value.imag * root)):
            low, high = bounds(jet[i, j])
            assert low - Fraction(1, 2**100) <= exactly(part) <= high + Fraction(1, 2**100), (i, j)
            assert number(high - low) < 1e-6


def test_the_coordinate_that_is_left_out_does_not_matter() -> None:
    half_return = spring_half()
    turned = HalfReturn((half_return.image[1], half_return.image[0], half_return.image[2]), half_return.first_integral)
    for left, right in zip(
        full_return_jets(half_return_jets(spring_claim(), half_return)),
        full_return_jets(half_return_jets(spring_claim(), turned)),
        strict=True,
    ):
        assert all(agree(left[index], right[index]) for index in indices_up_to(2, 3))


def trace_of(candidate: Candidate) -> arb:
    half_return = enclose_half_return(candidate, IntegratorSettings(128), ORACLE)
    first, second = full_return_jets(half_return_jets(candidate, half_return))
    assert agree(first[1, 0], second[0, 1])
    assert float(first[1, 0].rad()) < 1e-4
    assert agree(first[1, 0] * second[0, 1] - first[0, 1] * second[1, 0], arb(1))
    return first[1, 0]


def test_on_a_fixed_level_the_derivative_has_the_multipliers_of_the_orbit() -> None:
    proof = certificate()
    assert proof.orbit is not None
    (parameter,) = proof.orbit.stability.parameters
    assert agree(trace_of(claimed()), parameter.real)


def test_at_a_parameter_the_derivative_has_the_multipliers_of_the_orbit() -> None:
    wanted = Equation(COORDINATE, Fraction(400), "beta")
    candidate = refine_orbit(OrbitTask("orbit", FALKNER_SKAN, {}, wanted, (400.0, 0.9408), 40, {}))
    proof = certify(candidate, Limits(max_precision=256))
    assert proof.orbit is not None
    (parameter,) = proof.orbit.stability.parameters
    assert agree(trace_of(candidate), parameter.real)


def test_enclosures_of_another_claim_are_refused() -> None:
    half_return = spring_half()
    assert half_return.is_complete(1, True)
    assert not half_return.is_complete(2, True)
    assert not half_return.is_complete(1, False)
    assert not replace(half_return, image=half_return.image[1:]).is_complete(1, True)
    short = replace(half_return, image=(half_return.image[0][1:], *half_return.image[1:]))
    assert not short.is_complete(1, True)
    with pytest.raises(ValueError, match="zip"):
        half_return_jets(spring_claim(), short)


def test_with_functions_in_the_field_the_derivative_has_the_multipliers_of_the_orbit() -> None:
    _, _, proof = swings("pendulum")
    assert proof.orbit is not None
    (parameter,) = proof.orbit.stability.parameters
    assert isinstance(proof.candidate, Candidate)
    assert agree(trace_of(proof.candidate), parameter.real)


def test_half_orbits_with_two_crossings_are_followed_to_their_end() -> None:
    candidate, found = springs("twice")
    outcome = _conclude(candidate, 128, found)
    assert isinstance(outcome, Proved)
    assert isinstance(outcome.results, OrbitResults)
    (parameter,) = outcome.results.stability.parameters
    assert agree(trace_of(candidate), parameter.real)
