"""Stability parameters and multipliers: every enclosure against roots that are known."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from itertools import product

import mpmath
import pytest
from flint import acb, arb, ctx
from support.balls import agree
from support.within import within

from orbitproof.shared.formats import HALF_PERIOD, Candidate, Equation
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import bounds, enclose
from orbitproof.verify.orbit import STABLE, UNSTABLE, stability_of
from orbitproof.verify.orbit.multipliers import _multiplier, _roots

Root = tuple[Fraction, Fraction]
"""Real and imaginary part."""

THREE_SPRINGS = ReversibleSystem(
    name="three springs",
    title="hard spring beside two soft ones",
    state=("x", "y", "z", "vx", "vy", "vz"),
    parameters={},
    vector_field=lambda s, _: (s[3], s[4], s[5], -s[0] - s[0] ** 3, -s[1] / 4, Fraction(-9, 400) * s[2]),
    reversing_symmetry=(1, 1, 1, -1, -1, -1),
    section="vx",
    first_integral=lambda s, _: (
        s[3] ** 2 + s[4] ** 2 + s[5] ** 2 + s[0] ** 2 + s[0] ** 4 / 2 + s[1] ** 2 / 4 + Fraction(9, 400) * s[2] ** 2,
    ),
    first_integral_name="twice the energy",
)
"""x'' = -x - x^3, y'' = -y/4, z'' = -9 z/400."""

_precision = within(lambda: ctx.workprec(120))


def random_pair(source: random.Random) -> tuple[Root, Root]:
    """Two real or conjugate numbers; opposite, equal and vanishing ones are not rare."""
    a, b = (Fraction(source.randint(-12, 12), source.choice((4, 5, 8))) for _ in range(2))
    match source.choice(("real", "opposite", "equal", "conjugate", "imaginary", "close")):
        case "opposite":
            return (a, Fraction(0)), (-a, Fraction(0))
        case "equal":
            return (a, Fraction(0)), (a, Fraction(0))
        case "conjugate":
            return (a, b), (a, -b)
        case "imaginary":
            return (Fraction(0), b), (Fraction(0), -b)
        case "close":
            return (a, Fraction(0)), (a + Fraction(1, 2 ** source.randint(5, 60)), Fraction(0))
    return (a, Fraction(0)), (b, Fraction(0))


def coefficients_of(pair: tuple[Root, Root]) -> tuple[Fraction, Fraction]:
    """Sum and product."""
    (a, b), (c, d) = pair
    assert b + d == 0
    return a + c, a * c - b * d


def around(source: random.Random, value: Fraction, size: int) -> arb:
    """A ball of a radius of about 2^-size that contains a number, not in its middle."""
    radius = Fraction(source.randint(0, 8), 8 * 2**size)
    return enclose(value + radius * Fraction(source.randint(-8, 8), 8)) + arb(0, enclose(radius).upper())


def contains(ball: acb, root: Root) -> bool:
    return all(
        low <= value <= high for (low, high), value in zip(map(bounds, (ball.real, ball.imag)), root, strict=True)
    )


def hold_each_once(balls: Sequence[acb], pair: tuple[Root, Root]) -> bool:
    """Whether two balls contain two roots, one each."""
    first, second = balls
    return any(contains(first, a) and contains(second, b) for a, b in (pair, pair[::-1]))


@pytest.mark.parametrize("size", [0, 2, 6, 20, 60, 200])
def test_the_two_enclosures_contain_the_two_roots_one_each(size: int) -> None:
    source = random.Random(f"roots {size}")
    for _ in range(400):
        pair = random_pair(source)
        trace, determinant = (around(source, value, size) for value in coefficients_of(pair))
        assert hold_each_once(_roots(trace, determinant), pair), (pair, trace, determinant)


def test_roots_that_differ_are_told_apart_where_the_coefficients_are_known() -> None:
    for pair in [((-3, 0), (3, 0)), ((Fraction(1, 3), 0), (0, 0)), ((0, 2), (0, -2)), ((1, 2), (1, -2))]:
        exact = tuple((Fraction(a), Fraction(b)) for a, b in pair)
        balls = _roots(*map(enclose, coefficients_of(exact)))
        assert not balls[0].overlaps(balls[1])
        assert all(ball.real.rad() < 1e-30 and ball.imag.rad() < 1e-30 for ball in balls)


def matrices(source: random.Random, pair: tuple[Root, Root], size: int) -> tuple[list[list[arb]], list[list[arb]]]:
    """A and A' with the eigenvalues 1 and those of the pair for 2 A' A - 1, in balls."""
    (trace, determinant), one, zero = coefficients_of(pair), Fraction(1), Fraction(0)
    sigma = [[one, zero, zero], [zero, trace, -determinant], [zero, one, zero]]
    for _ in range(4):
        # Q S Q^-1 with Q = 1 + c e_i e_j^T.
        i, j = source.sample(range(3), 2)
        c = Fraction(source.randint(-2, 2))
        sigma[i] = [a + c * b for a, b in zip(sigma[i], sigma[j], strict=True)]
        for row in sigma:
            row[j] -= c * row[i]
    unit = [[Fraction(i == j) for j in range(3)] for i in range(3)]
    half = [[(a + b) / 2 for a, b in zip(*rows, strict=True)] for rows in zip(sigma, unit, strict=True)]
    out, back = ([[around(source, value, size) for value in row] for row in matrix] for matrix in (unit, half))
    return out, back


@pytest.mark.parametrize("size", [3, 10, 30, 100, 200])
def test_an_orbit_has_the_stability_parameters_and_multipliers_that_are_enclosed(size: int) -> None:
    source = random.Random(f"orbits {size}")
    decided = 0
    for _ in range(200):
        pair = random_pair(source)
        found = stability_of(*matrices(source, pair, size))
        assert hold_each_once(found.parameters, pair)
        exact = [acb(enclose(a), enclose(b)) for a, b in pair]
        for ball, multiplier in zip(found.parameters, found.multipliers, strict=bool(found.multipliers)):
            here = [(s, s + sign * (s * s - 1).sqrt()) for s in exact if agree(ball, s) for sign in (1, -1)]
            assert any(agree(multiplier, value) for _, value in here)
            assert not abs(multiplier) < 1
        real = not any(b for _, b in pair)
        inside = real and all(-1 < a < 1 for a, _ in pair) and pair[0] != pair[1]
        outside = not real or any(abs(a) > 1 for a, _ in pair)
        assert inside or found.verdict != STABLE
        assert outside or found.verdict != UNSTABLE
        decided += found.verdict in (STABLE, UNSTABLE)
    assert size < 30 or decided > 100


@pytest.mark.parametrize("size", [3, 10, 100])
def test_one_stability_parameter_decides_alone(size: int) -> None:
    source = random.Random(f"one {size}")
    verdicts = set()
    for _ in range(100):
        s, c = Fraction(source.randint(-16, 16), 8), Fraction(source.randint(-2, 2))
        # Q S Q^-1 with Q = 1 + c e_1 e_2^T, and half of 1 more than that.
        half = [[Fraction(1), c * (s - 1) / 2], [Fraction(0), (s + 1) / 2]]
        unit = [[Fraction(i == j) for j in range(2)] for i in range(2)]
        out, back = ([[around(source, value, size) for value in row] for row in matrix] for matrix in (unit, half))
        found = stability_of(out, back)
        (parameter,) = found.parameters
        assert contains(parameter, (s, Fraction(0)))
        assert found.verdict != STABLE or abs(s) < 1
        assert found.verdict != UNSTABLE or abs(s) > 1
        verdicts.add(found.verdict)
    assert {STABLE, UNSTABLE} <= verdicts


@pytest.mark.parametrize("size", [2, 6, 20, 60])
def test_a_multiplier_near_1_or_minus_1_is_enclosed(size: int) -> None:
    """Where it is not known whether the stability parameter is inside (-1, 1)."""
    for one, share in product((1, -1), range(-8, 9)):
        s = one + Fraction(share, 8 * 2**size)
        multiplier = _multiplier(acb(arb(one, arb(2) ** -size)))
        root = acb(enclose(s * s - 1)).sqrt()
        assert all(multiplier.contains(enclose(s) + sign * root) for sign in (1, -1))


def test_opposite_stability_parameters_are_both_found() -> None:
    """The three springs: y and z turn by 2 T / 2 and 6 T / 20 in a period 2 T, whose cosines are opposite at pi/1.3."""
    with mpmath.workprec(200):
        half_period = mpmath.pi * 10 / 13
        amplitude = mpmath.findroot(
            lambda a: 2 * mpmath.ellipk(a * a / (2 + 2 * a * a)) / mpmath.sqrt(1 + a * a) - half_period, 1.0
        )
        value, start = (Fraction(int(mpmath.floor(x * 2**150)), 2**150) for x in (half_period, amplitude))
        expected = mpmath.cos(half_period)
    unit = tuple(tuple(Fraction(i == j) for j in range(3)) for i in range(3))
    claim = Candidate(
        id="three springs",
        system=THREE_SPRINGS,
        parameters={},
        kind="orbit",
        k=1,
        centre=(start, Fraction(0), Fraction(0)),
        frame=unit,
        kernel_frame=tuple(row[:2] for row in unit[:2]),
        radii=(Fraction("1e-12"),) * 3,
        equation=Equation(HALF_PERIOD, value, None),
    )
    certificate = certify(claim, Limits(digits=8))
    assert certificate.proved, certificate.reason
    assert certificate.orbit is not None
    low, high = (bounds(value.real) for value in certificate.orbit.stability.parameters)
    for (lower, upper), s in ((low, expected), (high, -expected)):
        assert lower <= Fraction(int(mpmath.floor(s * 2**150)), 2**150) <= upper
    assert high[0] - low[1] > 1
    assert certificate.orbit.stability.verdict == STABLE
    # A stability parameter of 1, of which an enclosure may hold it, is that of multipliers 1.
    assert "other than 1 and -1 are the lambda" in certificate.statement["in_full"]
    assert "one of them that is not 1 or -1." in certificate.statement["in_full"]
