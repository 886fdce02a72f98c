"""Of claims about a box: what is told of balls of points holds for each of them, and what is decided is sure."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import acb, arb
from support import krein_cases
from support.balls import agree
from support.closed_form_maps import claim, description
from support.inclusion import broken_inclusions, checked
from support.random_segments import ball
from support.within import within

from orbitproof.shared.systems import CR3BP
from orbitproof.verify.bifurcation import ReducedFunction, coordinates_in_box, narrowed_zero
from orbitproof.verify.bifurcation.conditions import Problem
from orbitproof.verify.bifurcation.nondegeneracy import Nondegeneracy, check_family_of_maps, check_hamiltonian
from orbitproof.verify.bifurcation.proved_bifurcation import results_at
from orbitproof.verify.bifurcation.reduction import FamilyJet
from orbitproof.verify.double_resonance import proved_double_resonance
from orbitproof.verify.double_resonance.equations import Unfolding, _tangent
from orbitproof.verify.evidence import Checklist, DerivativeTable, NotEstablishedError, enclose, guarded, indices_up_to
from orbitproof.verify.krein import proved_krein
from orbitproof.verify.newton import BoxFunction, Jet
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.orbit import Approach, full_return_jets, inverse_jets, proved_orbit, stability_from, stability_of
from orbitproof.verify.orbit.following import Distance
from orbitproof.verify.orbit.full_return import _along_level
from orbitproof.verify.orbit.multipliers import UNDECIDED, _multiplier
from orbitproof.verify.reversor_breaking import both_points, parameter_of, period_of
from orbitproof.verify.twist import Rotation, proved_stable_orbit

BITS = 160

precision = within(lambda: guarded(BITS))


def jet_of(chance: random.Random, variables: int, first: int = 1, terms: int = 20) -> Jet:
    indices = [index for index in indices_up_to(variables, 3) if sum(index) >= first]
    chosen = [index for index in indices if sum(index) < 2] + chance.sample(indices, min(terms, len(indices)))
    return Jet(variables, 3, {index: ball(chance) for index in chosen})


def told(coefficients: Any) -> Any:
    """What is certain of the stability of an orbit: what is not decided is not."""
    found = stability_from(coefficients)
    return found.parameters, found.multipliers or None, None if found.verdict == UNDECIDED else found.verdict


@pytest.mark.parametrize("seed", range(4))
def test_multipliers(seed: int) -> None:
    chance = random.Random(seed)
    for size in (2, 3):
        halves = [[[ball(chance, -2, 2) for _ in range(size)] for _ in range(size)] for _ in range(2)]
        assert not broken_inclusions(lambda *both: stability_of(*both).parameters, tuple(halves), chance, 9)
    for coefficients in ([ball(chance, -3, 3)], [ball(chance, -3, 3), ball(chance, -3, 3)]):
        assert not broken_inclusions(told, (coefficients,), chance)
    for parameter in (acb(ball(chance, -0.9, 0.9)), acb(ball(chance, 1.1, 9)), acb(ball(chance), ball(chance))):
        assert not broken_inclusions(_multiplier, (parameter,), chance)


@pytest.mark.parametrize(
    "coefficients",
    [[1], [-1], [2, 1], [-2, 1], [1, 0], [-1, 0], ["7/4", "3/4"], ["-7/4", "3/4"], [0, 0], [1, "1/4"], [4, 4], [0, -1]],
    ids=str,
)
def test_where_a_multiplier_may_be_1_or_minus_1_or_two_may_be_equal_nothing_is_decided(coefficients: Any) -> None:
    """These are on a border, and a ball about each reaches over it; so does one of both."""
    exact = [enclose(Fraction(value)) for value in coefficients]
    assert not broken_inclusions(told, (exact,), random.Random(0))


@pytest.mark.parametrize("size", [1, 2])
def test_full_returns(size: int) -> None:
    chance = random.Random(size)
    half = [jet_of(chance, 2 * size, terms=4) for _ in range(2 * size)]
    for i, jet in enumerate(half):
        half[i] = jet + Jet(2 * size, 3, {unit(2 * size, i): arb(2)})
    assert not broken_inclusions(inverse_jets, (half,), chance, 8 // size**2)
    assert not broken_inclusions(full_return_jets, (half,), chance, 8 // size**2)
    variables = 2 * size + 1
    kept = {index: ball(chance) for index in indices_up_to(variables, 3)}
    kept[unit(variables, size)] += 3
    assert not broken_inclusions(lambda kept: _along_level(kept, size + 1), (kept,), chance, 6)


FRAME = tuple(tuple(map(Fraction, row)) for row in ((1, 0, 0), ("1/2", -2, "3/4"), ("-5/4", "3/8", 1)))
"""With negative entries, its first row the parameter's."""


def table_of(chance: random.Random, variables: int) -> DerivativeTable:
    """Of a polynomial of degree 3, whose derivatives of degree 3 are the same everywhere."""
    centre = {index: ball(chance) for index in indices_up_to(variables, 3)}
    box = {index: value + arb(0, 1) * (sum(index) < 3) for index, value in centre.items()}
    return DerivativeTable(box, centre)


def numbers(chance: random.Random, count: int) -> list[arb]:
    return [ball(chance, -0.01, 0.01) for _ in range(count)]


@pytest.mark.parametrize("seed", range(2))
def test_points_of_a_birth_and_of_a_collision(seed: int) -> None:
    """Their points, parameters, periods, angles: each is a function of where the zero is."""
    chance, candidate = random.Random(seed), krein_cases.of_family(frame=FRAME)
    tables = [table_of(chance, 5) for _ in range(3)]
    found: Any = SimpleNamespace(image=tables[:2], half_period=tables[2], sheet=())
    where = numbers(chance, 3)
    assert not broken_inclusions(lambda where: both_points(candidate, found, where), (where,), chance)
    assert not broken_inclusions(lambda where: parameter_of(candidate, where), (where,), chance)
    assert not broken_inclusions(lambda where: period_of(found, where), (where,), chance)

    def of_collision(*values: Any) -> Any:
        return proved_krein._results(candidate, found, *values)

    arguments = where, ball(chance, -0.9, 0.9), ball(chance, 0.2, 1), ball(chance, 0.2, 1)
    results = of_collision(*arguments)
    assert (results.side, results.type) == ("above", "subcritical")
    assert of_collision(where, arguments[1], -arguments[2], -arguments[3]).side == "below"
    assert of_collision(where, arguments[1], -arguments[2], -arguments[3]).type == "supercritical"
    assert not broken_inclusions(of_collision, arguments, chance, 20)


def test_points_where_two_resonances_meet() -> None:
    chance = random.Random(0)
    names = ("mu", "x", "z", "vy")
    frame = tuple(tuple(Fraction(chance.randint(-8, 8), 4) for _ in names) for _ in names)
    centre = (Fraction(1, 4),) * 4
    candidate = SimpleNamespace(coordinates=names, centre=centre, frame=frame, varying="mu", system=CR3BP)
    table = table_of(chance, 4)
    found = SimpleNamespace(half_period=table, first_integral=table)
    equations = SimpleNamespace(along=1)

    def results(where: Any, unfolding: Any) -> Any:
        return proved_double_resonance._results(candidate, found, equations, where, 1, unfolding)  # type: ignore[arg-type]

    unfolding = Unfolding(ball(chance, 1, 2), ball(chance, 1, 2), arb(1))
    told = results(numbers(chance, 4), unfolding)
    assert (told.side, told.extremum) == ("below", "minimum")
    assert results(numbers(chance, 4), replace(unfolding, curvature=-unfolding.curvature)).extremum == "maximum"
    assert not broken_inclusions(results, (numbers(chance, 4), unfolding), chance)
    for size in (1, 2, 3):
        slopes = [[ball(chance) for _ in range(size + 1)] for _ in range(size)]
        assert not broken_inclusions(_tangent, (slopes,), chance)
        tangent = _tangent(slopes)
        assert all(sum((a * t for a, t in zip(row, tangent, strict=True)), arb(0)).contains(0) for row in slopes)


def test_points_of_a_bifurcation() -> None:
    chance, small = random.Random(0), Fraction(1, 2**20)
    frame = tuple(tuple(Fraction(chance.randint(-8, 8), 4) + 4 * (i == j) for j in range(3)) for i in range(3))
    candidate = claim(
        description(2, True), "period_tupling", 2, (small,) * 3, frame=frame, centre=(small, -small, small)
    )
    table = table_of(chance, 3)
    problem = Problem(2, candidate.radii, (arb(0),) * 3, (), BoxFunction(table))
    conclusion = Nondegeneracy("above", {"alpha": ball(chance)})
    of_point = lambda where: results_at(candidate, problem, where, conclusion)  # noqa: E731
    where = tuple(numbers(chance, 3))
    assert not broken_inclusions(of_point, (where,), chance)
    assert not broken_inclusions(lambda point: coordinates_in_box(candidate, point), (of_point(where).point,), chance)
    back = coordinates_in_box(candidate, of_point(where).point)
    assert all(agree(a, b) for a, b in zip(back, where, strict=True))


@pytest.mark.parametrize("tangential", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_normal_forms_of_bifurcations(seed: int, tangential: bool) -> None:
    chance = random.Random(seed)
    kind, k = ("period_tupling", 2) if tangential else ("touch_and_go", 3)
    radii = (Fraction(1, 8),) * 3
    candidate, of_map = (claim(description(2, hamiltonian), kind, k, radii) for hamiltonian in (True, False))
    gradient = [ball(chance, 1, 2) for _ in range(3)]

    def reduction(jet: Jet, level: Jet) -> Any:
        return SimpleNamespace(jet=lambda _: jet, restrict=lambda *_: level)

    def hamiltonian(jet: Jet, level: Jet, curve: Any, crossing: Any, gradient: Any, bound: Any) -> Any:
        if tangential:
            # h_b' = 0 there: the two quotients are of one number.
            level = Jet(2, 3, {**level.coefficients, (0, 1): -bound * level[1, 0]})
            moved = {(0, 2): -bound * jet[1, 1] / (1 + bound * curve.slope)}
            jet = Jet(2, 3, {**jet.coefficients, **moved})
        integral = SimpleNamespace(gradient=lambda *_: gradient)
        problem, family = SimpleNamespace(first_integral=integral), SimpleNamespace(jet=lambda _: curve)
        point = SimpleNamespace(where=(), crossing=crossing)
        return checked(check_hamiltonian, candidate, problem, family, reduction(jet, level), point)

    jet, level = jet_of(chance, 2), jet_of(chance, 2)
    jet = jet + Jet(2, 3, {(1, 1): arb(3)})
    level = level + Jet(2, 3, {(1, 0): arb(3)})
    curve = FamilyJet(ball(chance), ball(chance))
    arguments = jet, level, curve, ball(chance, 1, 2), gradient, ball(chance, 0.2, 0.5)
    assert not broken_inclusions(hamiltonian, arguments, chance, 20)

    def maps(jet: Jet, crossing: Any) -> Any:
        return checked(check_family_of_maps, of_map, reduction(jet, jet), SimpleNamespace(where=(), crossing=crossing))

    assert not broken_inclusions(lambda jet: maps(jet, jet.derivative(1, 1)), (jet,), chance, 10)
    if not tangential:
        assert not broken_inclusions(lambda crossing: maps(jet, crossing), (ball(chance, 1, 2),), chance)


def test_zeros() -> None:
    """One ball that holds the zeros of all functions of a ball of functions; and of those of a reduced function."""
    chance = random.Random(0)
    radius = Fraction(1, 4)
    problem = Problem(1, (radius,) * 2, (arb(0, 1) / 4,) * 2, (), None)

    def zero(place: arb, slope: arb, bend: arb) -> arb:
        def value(p: arb) -> arb:
            return (p - place) * (slope + bend * (p - place))

        return narrowed_zero(problem, 1, value, lambda p: slope + 2 * bend * (p - place))

    arguments = ball(chance, -0.1, 0.1), ball(chance, 2, 3), arb(1) / 4
    assert agree(zero(*arguments), arguments[0])
    assert not broken_inclusions(lambda place: zero(place, *arguments[1:]), (arguments[0],), chance)
    jets = [jet_of(chance, 2)]
    wide = Jet(2, 3, {(0, 2): arb(0, 4)})
    reduced = ReducedFunction(ball(chance, 1, 2), ball(chance, -0.1, 0.1), jets[0], jets[0] + wide)
    assert not broken_inclusions(lambda p_1: reduced.zero(p_1), (ball(chance, -0.1, 0.1),), chance)
    of_both = lambda slope, foot: replace(reduced, slope=slope, foot=foot).zero(arb("0.3"))  # noqa: E731
    assert not broken_inclusions(of_both, (reduced.slope, reduced.foot), chance)
    of_foot = lambda at_foot: replace(reduced, at_foot=at_foot, across=at_foot + wide).at_centre(arb("0.3"))  # noqa: E731
    assert not broken_inclusions(of_foot, (jets[0],), chance)


@pytest.mark.parametrize("cosine", ["-0.5", "0"])
def test_at_a_resonance_of_order_3_or_4_nothing_is_said(cosine: str) -> None:
    """Nor next to it where it may be one; a little farther away something is."""
    for middle, radius, is_open in (("0", "0", True), ("1e-20", "2e-20", True), ("1e-20", "1e-21", False)):
        value = arb(cosine) + arb(middle, radius)
        rotation = Rotation(value, (1 - value * value).sqrt(), arb(1), 1)
        for check in (
            lambda known=value: proved_krein._check_resonances(Checklist(), known),
            lambda known=rotation: proved_stable_orbit._check_resonances(Checklist(), known),
        ):
            if is_open:
                with pytest.raises(NotEstablishedError):
                    check()
            else:
                check()


def test_distances_along_an_orbit() -> None:
    """Of balls of the place, of times and of squares: minima and maxima that take turns, both ends among them."""
    chance = random.Random(0)
    tables = [table_of(chance, 2) for _ in range(2)]
    for table, height in zip(tables, (4, 9), strict=True):
        for part in (table.box, table.centre):
            part[0, 0] = part[0, 0] + height  # type: ignore[index]

    def told(where: Any, half_period: Any, between: Any) -> Any:
        approaches = tuple(
            Approach(time, value, kind) for (time, value), kind in zip(between, (-1, 1, -1, 1), strict=True)
        )
        distance = Distance(tables[0], tables[1], 1, -1, approaches)
        return checked(proved_orbit._check_distance, distance, where, half_period)

    between = [(arb(1), arb(16)), (arb(2), arb(1)), (arb(3), arb(25)), (arb(4), arb(2))]
    arguments = numbers(chance, 2), arb(5), between
    assert not broken_inclusions(told, arguments, chance, 12)
    (least, greatest), _ = told(*arguments)
    assert agree(least.distance, arb(1))
    assert agree(greatest.distance, arb(5))
    # Two minima that may be the least: both times, and all values.
    wide = [between[0], (arb(2, 0.25), arb(1, 0.5)), between[2], (arb(4, 0.125), arb(1.25, 0.125))]
    (least, _), _ = told(*arguments[:2], wide)
    assert len(least.times) == 2
    assert all(ball.contains(end) for ball, end in zip(least.times, (arb("1.76"), arb("3.876")), strict=True))
    assert all(least.distance.contains(arb(value).sqrt()) for value in ("0.51", "1.37"))
