"""The normal form of reversible maps of four variables: known torsion is found, and nothing where it cannot be."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import cos, sin
from typing import Any

import numpy as np
import pytest
from flint import acb, arb
from support.balls import agree
from support.reversible_maps import on_circle, random_map, turning, widened
from support.within import within

from orbitproof.verify.evidence import Checklist, NotEstablishedError, guarded
from orbitproof.verify.newton import Jet
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.tori import proved_tori
from orbitproof.verify.tori.normal_form import (
    COMBINATIONS,
    EllipticPoint,
    combination,
    elliptic_point,
    in_coordinates,
    torsion,
    trace_and_determinant,
)

precision = within(lambda: guarded(200))


def found_of(jets: Any) -> tuple[EllipticPoint, list[list[acb]]]:
    point = elliptic_point(jets)
    return point, torsion(in_coordinates(jets, point), point.multipliers)


@pytest.mark.parametrize("seed", range(6))
def test_torsion_is_that_of_the_map_that_was_changed(seed: int) -> None:
    known = random_map(seed)
    point, found = found_of(known.jets)
    assert all(agree(a, b) for a, b in zip(point.cosines, known.cosines, strict=True))
    for row, wanted in zip(found, known.torsion, strict=True):
        for value, tau in zip(row, wanted, strict=True):
            assert agree(value.imag, tau)
            assert value.real.contains(0)
            assert float(value.imag.rad()) < 1e-30


def test_balls_of_maps_give_balls_that_contain_the_torsion_of_each() -> None:
    for seed in range(3):
        known = random_map(seed)
        _, found = found_of(widened(known.jets, "1e-12"))
        for row, wanted in zip(found, known.torsion, strict=True):
            for value, tau in zip(row, wanted, strict=True):
                assert value.imag.contains(tau.mid())
                assert float(value.imag.rad()) < 1e-4


def test_coordinates_make_the_derivative_diagonal_and_the_reversor_conjugation() -> None:
    for seed in range(2):
        known = random_map(seed)
        point = elliptic_point(known.jets)
        for j, function in enumerate(in_coordinates(known.jets, point)):
            for i in range(4):
                wanted = point.multipliers[j] if i == j else acb(0)
                assert agree(function[unit(4, i)], wanted)
            assert float(point.multipliers[j].imag) > 0
        for covector in point.covectors:
            assert all(value.imag.is_zero() for value in covector[:2])
            assert all(value.real.is_zero() for value in covector[2:])


def test_all_combinations_up_to_order_four_are_there_once() -> None:
    wanted = {k for k in product(range(-4, 5), repeat=2) if 0 < abs(k[0]) + abs(k[1]) <= 4}
    assert len(COMBINATIONS) == len(set(COMBINATIONS)) == 20
    assert {*COMBINATIONS, *((-a, -b) for a, b in COMBINATIONS)} == wanted


def test_combinations_are_powers_of_the_multipliers() -> None:
    angles = arb("0.7"), arb("1.9")
    for k in COMBINATIONS:
        value = combination([on_circle(angle) for angle in angles], k)
        assert agree(value, on_circle(k[0] * angles[0] + k[1] * angles[1]))


ONE = [[arb(1), arb(2)], [arb(2), arb(-1)]]


def checked(jets: tuple[Jet, ...]) -> arb:
    """The determinant of the torsion, all hypotheses of the map holding."""
    checklist = Checklist()
    point = proved_tori._check_elliptic(checklist, jets)
    proved_tori._check_resonances(checklist, point)
    _, determinant = proved_tori._check_torsion(checklist, jets, point)
    return determinant


def refused(jets: tuple[Jet, ...]) -> str:
    with pytest.raises(NotEstablishedError) as caught:
        checked(jets)
    return caught.value.reason.condition


def test_a_map_without_resonance_and_with_regular_torsion_passes() -> None:
    assert agree(checked(turning([arb(1), arb("2.2")], ONE)), arb(-5))


RESONANT = [
    ("1:3", 2 * arb.pi() / 3, arb("0.5")),
    ("1:4", arb("0.9"), arb.pi() / 2),
    ("equal", arb(1), arb(1)),
    ("1:2 of both", arb("0.8"), arb("1.6")),
    ("2:1 of both", arb("1.6"), arb("0.8")),
    ("1:3 of both", arb("0.8"), arb("2.4")),
    ("3:1 of both", arb("2.4"), arb("0.8")),
    ("2 + 1", arb("2.4"), 2 * arb.pi() - arb("4.8")),
    ("3 + 1", arb("1.9"), 2 * arb.pi() - arb("5.7")),
    ("2 + 2", arb("1.1"), arb.pi() - arb("1.1")),
]


@pytest.mark.parametrize(("first", "second"), [case[1:] for case in RESONANT], ids=[case[0] for case in RESONANT])
def test_resonances_up_to_order_four_are_refused(first: arb, second: arb) -> None:
    assert refused(turning([first, second], ONE)) in ("non-resonance", "elliptic")


def test_resonances_of_order_five_are_no_obstacle() -> None:
    checked(turning([2 * arb.pi() / 5, arb("0.7")], ONE))
    checked(turning([arb("0.6"), arb("2.4")], ONE))


def test_a_torsion_that_may_degenerate_is_refused() -> None:
    assert refused(turning([arb(1), arb("2.2")], [[arb(1), arb(2)], [arb(2), arb(4)]])) == "torsion"
    assert refused(widened(turning([arb(1), arb("2.2")], ONE), "0.2")) != ""


def test_maps_that_are_not_elliptic_are_refused() -> None:
    jets = turning([arb(1), arb("2.2")], ONE)
    for first, second in (("1.5", "0.5"), ("-1.5", "0.5"), ("1.5", "1.6"), ("-1.5", "-1.6")):
        pair = (arb(first), arb(second))
        bent = []
        for j, jet in enumerate(jets):
            column = j % 2
            sine = (arb(1) - pair[column] * pair[column]).mid()
            entries = {unit(4, column): pair[column], unit(4, column + 2): -sine}
            if j >= 2:
                entries = {unit(4, column): arb(1), unit(4, column + 2): pair[column]}
            bent.append(Jet(4, 3, {**{k: v for k, v in jet.coefficients.items() if sum(k) > 1}, **entries}))
        assert refused(tuple(bent)) == "elliptic"
        trace, _ = trace_and_determinant(bent)
        assert agree(trace, pair[0] + pair[1])


def test_cosines_that_may_be_equal_are_refused() -> None:
    assert refused(turning([arb(1), arb(1)], ONE)) == "elliptic"


def test_complex_cosines_are_refused() -> None:
    """A pair that has left the circle: M_pp = [[c, -d], [d, c]]."""
    jets = turning([arb(1), arb("2.2")], ONE)
    block = [[arb("0.3"), arb("-0.2")], [arb("0.2"), arb("0.3")]]
    bent = [
        Jet(4, 3, {**jet.coefficients, **({unit(4, k): block[j][k] for k in range(2)} if j < 2 else {})})
        for j, jet in enumerate(jets)
    ]
    assert refused(tuple(bent)) == "elliptic"


def test_a_map_that_is_not_reversible_is_no_proof() -> None:
    """A real part of the coefficient of z_1 |z_1|^2 that is not 0."""
    jets = list(turning([arb(1), arb("2.2")], ONE))
    for j in (0, 2):
        more = Jet(4, 3, {(3, 0, 0, 0) if j == 0 else (2, 0, 1, 0): arb("0.5")})
        jets[j] = jets[j] + more
    assert refused(tuple(jets)) == "torsion"


@pytest.mark.parametrize("bad", [arb("nan"), arb(0, "inf")])
def test_enclosures_that_are_not_finite_prove_nothing(bad: arb) -> None:
    for index in ((1, 0, 0, 0), (2, 0, 0, 0), (3, 0, 0, 0)):
        jets = list(turning([arb(1), arb("2.2")], ONE))
        jets[0] = jets[0] + Jet(4, 3, {index: bad})
        with pytest.raises((NotEstablishedError, ArithmeticError)):
            checked(tuple(jets))


KICKS = {
    (3, 0): 0.7, (2, 1): -0.4, (1, 2): 0.9, (0, 3): 0.3, (4, 0): 0.5, (2, 2): -0.8, (1, 3): 0.6,
}  # fmt: skip
"""Coefficients of V(p_1, p_2); a kick is q -> q + grad V(p) / 2."""
TURNS = 1.1, 2.3


def kick(p: Any, q: Any) -> Any:
    slopes = []
    for j in range(2):
        value = p[0] * 0.0
        for powers, factor in KICKS.items():
            if powers[j]:
                lower = [n - (i == j) for i, n in enumerate(powers)]
                value = value + 0.5 * factor * powers[j] * p[0] ** lower[0] * p[1] ** lower[1]
        slopes.append(value)
    return [a + b for a, b in zip(q, slopes, strict=True)]


def kicked_turn(state: Any) -> Any:
    """A kick, turns of the (p_j, q_j), a kick: reversible, symplectic, of four variables."""
    p, q = state[:2], kick(state[:2], state[2:])
    turned = [(cos(a) * x - sin(a) * y, sin(a) * x + cos(a) * y) for a, x, y in zip(TURNS, p, q, strict=True)]
    p = [x for x, _ in turned]
    return [*p, *kick(p, [y for _, y in turned])]


@dataclass(frozen=True)
class Poly:
    """Numbers or jets, with powers."""

    jet: Jet

    def __add__(self, other: Poly) -> Poly:
        return Poly(self.jet + other.jet)

    def __sub__(self, other: Poly) -> Poly:
        return self + other * -1.0

    def __mul__(self, other: Poly | float) -> Poly:
        return Poly(self.jet * other.jet if isinstance(other, Poly) else self.jet.scaled(arb(other)))

    __rmul__ = __mul__

    def __pow__(self, power: int) -> Poly:
        result = Poly(Jet(4, 3, {(0, 0, 0, 0): arb(1)}))
        for _ in range(power):
            result = result * self
        return result


def rotation_of(values: Any) -> float:
    """By how much the numbers turn on average, with weights that make the average of a quasi-periodic turn exact."""
    turns = np.angle(values[1:] / values[:-1]) % (2 * np.pi)
    time = (np.arange(len(turns)) + 1) / (len(turns) + 1)
    weights = np.exp(-1 / (time * (1 - time)))
    return float(np.sum(turns * weights) / np.sum(weights))


def test_iterates_turn_by_what_the_torsion_says() -> None:
    """In double precision, of a map that is given by formulas, at amplitudes of a hundredth."""
    jets = tuple(each.jet for each in kicked_turn([Poly(Jet(4, 3, {unit(4, j): arb(1)})) for j in range(4)]))
    point, found = found_of(jets)
    covectors = np.array([[complex(value) for value in row] for row in point.covectors])
    omegas = [float(value.arg()) for value in point.multipliers]
    tau = np.array([[float(value.imag) for value in row] for row in found])
    for sizes in ((0.01, 0.004), (0.004, 0.01)):
        matrix = np.vstack([covectors, covectors.conj()])
        state = list(np.linalg.solve(matrix, np.array([*sizes, *sizes], dtype=complex)).real)
        orbit = []
        for _ in range(6000):
            orbit.append(state)
            state = kicked_turn(state)
        z = covectors @ np.array(orbit).T
        squares = np.mean(np.abs(z) ** 2, axis=1)
        for j in range(2):
            shift = rotation_of(z[j]) - omegas[j]
            assert shift == pytest.approx(float(tau[j] @ squares), rel=5e-3, abs=2e-8)
            assert abs(shift) > 1e-6
