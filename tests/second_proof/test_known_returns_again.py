"""Second proofs of bifurcations on returns that are known: what is found is right, and what is not so is refused."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import acb, arb
from polynomial_returns import BEND, BITS, bifurcation, claimed, jets, legs, returning, synthetic, torus
from support.normal_form_maps import KnownBifurcation, KnownTorus, known_bifurcation, known_torus

from orbitproof.verify.second_proof import CannotFollow

ONE, OFF = Fraction(1), (Fraction(1, 2), Fraction(-1, 3), Fraction(2))


def near(ball: Any, value: Fraction, width: float = 1e-12) -> bool:
    """Whether a ball holds a number and is not much wider."""
    with jets.precision(4 * BITS):
        return bool(ball.contains(jets.ball(value))) and float(ball.rad()) < width * max(1.0, abs(float(value)))


def torus_attempt(known: KnownTorus, halves: int = 1, turned: Fraction = ONE) -> Any:
    """The vector of the claim is that of the map times `turned`."""
    kernel = tuple(tuple(turned * value for value in part) for part in known.eigenvector)
    claim = claimed("periodic-torus", kernel, known.multiplier)
    size = len(known.derivatives)
    return synthetic(torus._Torus, claim, returning(known.derivatives, BEND[:size], halves), halves)


def concluded(attempt: Any) -> Any:
    with jets.precision(BITS):
        return attempt.conclusion()


@pytest.mark.parametrize(("size", "halves", "seed"), [(2, 1, 1), (2, 2, 2), (3, 1, 3), (3, 2, 4), (2, 1, 5), (3, 1, 6)])
def test_tori_of_known_returns(size: int, halves: int, seed: int) -> None:
    known = known_torus(size, random.Random(seed), OFF[: size - 2])
    turned = Fraction(3, 2)
    found = concluded(torus_attempt(known, halves, turned))
    cosine, sine = known.multiplier
    assert near(found.parameter, Fraction(0))
    assert all(near(value, Fraction(0)) for value in found.point.values())
    assert near(found.period, ONE)
    assert near(found.multiplier.real, cosine)
    assert near(found.multiplier.imag, sine)
    assert near(found.speed, known.speed)
    assert near(found.lyapunov, known.lyapunov * turned**2)
    assert found.side == ("below" if known.speed * known.lyapunov > 0 else "above")
    assert found.criticality == ("supercritical" if known.lyapunov < 0 else "subcritical")
    assert len(found.multipliers) == size - 2
    assert all(near(z.real, value) for z, value in zip(found.multipliers, OFF, strict=False))
    assert found.inside == size - 2
    assert all(h.holds for h in found.hypotheses)
    names = ["newton", "direction", "crossings", "non-resonance", "others", "crossing", "lyapunov"]
    assert [h.name for h in found.hypotheses] == names


def resonant() -> KnownTorus:
    """z -> i z (1 + a - |z|^2)."""
    x, y = (0, -1), (1, 0)
    rows = tuple(
        {(1, 0, 0): c, (0, 1, 0): s, (1, 0, 1): c, (0, 1, 1): s,
         (3, 0, 0): -6 * c, (1, 2, 0): -2 * c, (2, 1, 0): -2 * s, (0, 3, 0): -6 * s}
        for c, s in (x, y)
    )  # fmt: skip
    half, zero = Fraction(1, 2), Fraction(0)
    known = known_torus(2, random.Random(1))
    return replace(known, derivatives=rows, multiplier=(zero, ONE), eigenvector=((half, zero), (zero, -half)))


def test_a_resonance_of_order_four_is_refused() -> None:
    with pytest.raises(CannotFollow, match="non-resonance is not shown"):
        concluded(torus_attempt(resonant()))


@pytest.mark.parametrize("what", ["crossing", "lyapunov"])
def test_a_coefficient_that_is_zero_is_refused(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    attempt = torus_attempt(known_torus(2, random.Random(1)))
    numbers = {"crossing": arb(1), "lyapunov": arb(1)} | {what: arb(0, 1)}
    monkeypatch.setattr(attempt, "coefficients", lambda *given: tuple(numbers.values()))
    with pytest.raises(CannotFollow, match=f"{what} is not shown"):
        concluded(attempt)


@pytest.mark.parametrize(("speed", "lyapunov"), [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_the_side_of_a_torus_follows_from_signs_however_wide_the_coefficients_are(
    speed: int, lyapunov: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    attempt = torus_attempt(known_torus(2, random.Random(1)))
    monkeypatch.setattr(attempt, "coefficients", lambda *given: (arb(speed, 0.75), arb(lyapunov, 0.75)))
    found = concluded(attempt)
    assert (found.speed * found.lyapunov).contains(0)
    assert found.side == ("below" if speed * lyapunov > 0 else "above")


def test_another_multiplier_on_the_circle_is_refused() -> None:
    with pytest.raises(CannotFollow, match="others is not shown"):
        concluded(torus_attempt(known_torus(3, random.Random(3), (Fraction(-1),))))


def test_a_pair_that_does_not_cross_is_refused() -> None:
    """Without its terms with a the map has a pair on the circle for all a: no regular zero."""
    known = known_torus(2, random.Random(1))
    still = tuple({i: v for i, v in row.items() if not i[-1]} for row in known.derivatives)
    with pytest.raises((CannotFollow, ZeroDivisionError)):
        concluded(torus_attempt(replace(known, derivatives=still)))


def attempt_of(known: KnownBifurcation, kind: str, halves: int, turned: Fraction = ONE, **more: Any) -> Any:
    """The vector of the claim is that of the map times `turned`."""
    kernel = (tuple(turned * value for value in known.eigenvector),)
    claim = claimed(kind, kernel, **more)
    size = len(known.derivatives)
    bend = BEND[:size] if "symmetry" not in more else (Fraction(0),) * size
    return synthetic(bifurcation._Proof, claim, returning(known.derivatives, bend, halves), halves)


@pytest.mark.parametrize(
    ("kind", "size", "halves", "seed"),
    [
        ("periodic-fold", 1, 1, 1),
        ("periodic-fold", 3, 2, 2),
        ("periodic-fold", 2, 1, 3),
        ("periodic-doubling", 1, 1, 4),
        ("periodic-doubling", 1, 2, 5),
        ("periodic-doubling", 3, 1, 6),
        ("periodic-doubling", 2, 2, 7),
    ],
)
def test_folds_and_doublings_of_known_returns(kind: str, size: int, halves: int, seed: int) -> None:
    sigma, turned = bifurcation.SIGMA[kind], Fraction(-3, 2)
    known = known_bifurcation(sigma, size, random.Random(seed), others=OFF[: size - 1])
    found = concluded(attempt_of(known, kind, halves, turned))
    assert near(found.parameter, Fraction(0))
    assert all(near(value, Fraction(0)) for value in found.point.values())
    assert near(found.opening, known.opening * turned**2)
    assert found.side == ("above" if known.opening > 0 else "below")
    assert (found.known, found.is_fixed) == (sigma, None)
    assert all(near(z.real, value) for z, value in zip(sorted_balls(found), sorted(OFF[: size - 1]), strict=True))
    assert (found.inside, found.on, found.outside) == (min(size - 1, 2), 0, max(size - 3, 0))
    # c/(l J W) is the coefficient of -y^3 where l w = 1 for the normal form.
    outwards = {1: None, -1: "supercritical" if known.bend > 0 else "subcritical"}[sigma]
    assert found.criticality == outwards


def sorted_balls(found: Any) -> list[Any]:
    return sorted(found.multipliers, key=lambda z: float(z.real.mid()))


def test_coefficients_are_for_vectors_with_the_product_that_is_claimed() -> None:
    """In coordinates of the box, of which the first one is half of p_0, and for vectors that are only near."""
    known = known_bifurcation(-1, 2, random.Random(6), others=(Fraction(1, 2),))
    exact = (known.eigenvector[0] / 2, known.eigenvector[1])
    rough = tuple(value + Fraction(i + 1, 16) for i, value in enumerate(exact))
    factor = sum(r * r for r in rough) / sum(r * e for r, e in zip(rough, exact, strict=True))
    claim = claimed("periodic-doubling", (rough,), stretch=2)
    found = concluded(synthetic(bifurcation._Proof, claim, returning(known.derivatives, BEND[:2], 1), 1))
    assert near(found.opening, known.opening * factor**2)

    other = known_torus(2, random.Random(5))
    u, v = ((part[0] / 2, part[1]) for part in other.eigenvector)
    rough_u, rough_v = (u[0] + Fraction(1, 16), u[1]), (v[0], v[1] - Fraction(1, 8))
    length = sum(value**2 for value in (*rough_u, *rough_v))
    real = sum(a * b for a, b in zip((*rough_u, *rough_v), (*u, *v), strict=True))
    imaginary = sum(a * b for a, b in zip(rough_u, v, strict=True)) - sum(
        a * b for a, b in zip(rough_v, u, strict=True)
    )
    claim = claimed("periodic-torus", (rough_u, rough_v), other.multiplier, stretch=2)
    torus_found = concluded(synthetic(torus._Torus, claim, returning(other.derivatives, BEND[:2], 1), 1))
    assert near(torus_found.lyapunov, other.lyapunov * length**2 / (real**2 + imaginary**2))


@pytest.mark.parametrize(("size", "halves", "seed"), [(1, 1, 1), (2, 1, 2), (2, 2, 3)])
def test_pitchforks_in_the_fixed_set(size: int, halves: int, seed: int) -> None:
    """S negates the first coordinate; the return under S has the multiplier -1, the orbit 1."""
    signs = (-1, *[1] * (size - 1))
    known = known_bifurcation(-1, size, random.Random(seed), signs=signs, others=OFF[: size - 1])
    found = concluded(attempt_of(known, "periodic-pitchfork", halves, symmetry=signs))
    assert found.is_fixed is True
    assert (found.known, near(found.period, ONE)) == (1, True)
    assert near(found.opening, known.opening)
    assert all(near(z.real, value) for z, value in zip(sorted_balls(found), sorted(OFF[: size - 1]), strict=True))
    assert found.criticality == ("supercritical" if known.bend > 0 else "subcritical")
    assert "in Fix(S)" in [h.name for h in found.hypotheses]


def test_a_vector_that_is_not_turned_alone_is_not_in_the_fixed_set() -> None:
    signs = (-1, 1)
    known = known_bifurcation(-1, 2, random.Random(2), signs=signs, others=OFF[:1])
    attempt = attempt_of(known, "periodic-pitchfork", 1, symmetry=signs)
    with jets.precision(BITS):
        zero = attempt.enclosed()[1]
        for place, by, holds in ((2, 0, True), (2, arb(1) / 64, False), (1, 0, True)):
            moved = [value + by * (i == attempt.time + place) for i, value in enumerate(zero)]
            is_fixed, (hypothesis,) = attempt.mirrored(moved)
            assert (is_fixed, hypothesis.holds) == (True, holds)


def test_parts_of_the_period_of_a_pitchfork_are_compared_under_s() -> None:
    """Half the time on, S must not take the orbit to its point; that it is elsewhere itself says nothing."""
    signs = (-1, 1)
    known = known_bifurcation(-1, 2, random.Random(2), signs=signs, others=OFF[:1])
    attempt = attempt_of(known, "periodic-pitchfork", 1, symmetry=signs)
    attempt.statement = replace(attempt.statement, crossings=2)
    with jets.precision(BITS):
        zero = [arb(1), *[arb(0)] * (attempt.time + 1)]
        for first, holds in ((-1, False), (1, True)):
            between = {2: [jets.Jet({(): arb(x)}, 0) for x in (first, 0, 0)]}
            checks, _ = attempt.check_orbit(legs.Return([], 2, between), zero)
            assert [check.holds for check in checks if check.name == "least period, T/2"] == [holds]


def test_pitchforks_of_orbits_that_are_moved() -> None:
    """S negates a coordinate in which the point is not 0; multipliers of the orbit are squares, its period is twice."""
    known = known_bifurcation(-1, 3, random.Random(9), others=(Fraction(1, 2), Fraction(-1, 3)))
    attempt = attempt_of(known, "periodic-pitchfork", 1, symmetry=(1, 1, 1))
    original = attempt.mirrored

    def mirrored(zero: Any) -> Any:
        signs = attempt.statement.symmetry
        attempt.statement = replace(attempt.statement, symmetry=(-1, *signs[1:]))
        found = original([zero[0] + 1, *zero[1:]])
        attempt.statement = replace(attempt.statement, symmetry=signs)
        return found

    attempt.mirrored = mirrored
    found = concluded(attempt)
    assert found.is_fixed is False
    assert near(found.period, Fraction(2))
    assert [near(z.real, v) for z, v in zip(sorted_balls(found), (Fraction(1, 9), Fraction(1, 4)), strict=True)] == [
        True, True
    ]  # fmt: skip
    assert "S moves the point" in [h.name for h in found.hypotheses]


def test_a_doubling_in_the_fixed_set_is_no_pitchfork() -> None:
    """S negates another coordinate: the vector is not turned, so the hypothesis about Fix(S) does not hold."""
    signs = (1, -1)
    known = known_bifurcation(-1, 2, random.Random(2), signs=signs, others=(Fraction(1, 2),))
    with pytest.raises(CannotFollow, match="Fix"):
        concluded(attempt_of(known, "periodic-pitchfork", 1, symmetry=signs))


def test_a_fold_is_no_doubling_and_a_doubling_no_fold() -> None:
    for sigma, kind in ((1, "periodic-doubling"), (-1, "periodic-fold")):
        known = known_bifurcation(sigma, 2, random.Random(2), others=(Fraction(1, 2),))
        with pytest.raises((CannotFollow, ZeroDivisionError)):
            concluded(attempt_of(known, kind, 1))


def test_side_is_refused_where_a_coefficient_may_be_zero() -> None:
    """A doubling without cubic part: x -> -x + a x + b x^2 - b^2 x^3."""
    rows = ({(1, 0): Fraction(-1), (1, 1): ONE, (2, 0): Fraction(4), (3, 0): Fraction(-24)},)
    known = replace(known_bifurcation(-1, 1, random.Random(1)), derivatives=rows, eigenvector=(ONE,))
    with pytest.raises(CannotFollow, match="side is not shown"):
        concluded(attempt_of(known, "periodic-doubling", 1))


def test_on_a_level_no_criticality_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    known = known_bifurcation(-1, 2, random.Random(7), others=(Fraction(1, 2),))
    attempt = attempt_of(known, "periodic-doubling", 1)
    monkeypatch.setattr(attempt, "check_orbit", lambda found, zero: ([], arb(1)))
    given = list[int]()
    balls = [acb(arb(1, 0.5)), acb(0.25)]
    monkeypatch.setattr(
        attempt, "multipliers", lambda found, trivial, is_fixed: (given.append(trivial), (-1, balls))[1]
    )
    found = concluded(attempt)
    assert given == [2]
    assert (found.inside, found.on, found.outside) == (1, 0, 0)
    assert (found.criticality, float(found.level)) == (None, 1.0)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling", "periodic-torus"])
@pytest.mark.parametrize("halves", [1, 2])
def test_the_derivative_of_all_equations(kind: str, halves: int) -> None:
    """Against quotients of differences, in all directions."""
    chance = random.Random(halves)
    if kind == "periodic-torus":
        attempt = torus_attempt(known_torus(2, chance), halves)
    else:
        attempt = attempt_of(known_bifurcation(bifurcation.SIGMA[kind], 2, chance), kind, halves)
    with jets.precision(BITS):
        attempt.prepare(attempt.returned(None, attempt.centre, 2))
        attempt.centre = [c + arb(chance.randint(-9, 9)) / 16 for c in attempt.centre]
        centre, step = list(attempt.centre), arb(2) ** -100
        rows = attempt.returned(None, centre, 2)
        matrix, before = attempt.system(rows, centre), attempt.zeros(rows)
        assert len(matrix) == len(centre) == len(matrix[0])
        for j in range(len(centre)):
            attempt.centre = [c + step * (i == j) for i, c in enumerate(centre)]
            after = attempt.zeros(attempt.returned(None, attempt.centre, 2))
            for i, (one, other) in enumerate(zip(after, before, strict=True)):
                assert abs(float((one - other) / step - matrix[i][j])) < 1e-20
