"""The stability matrix of random half maps, exactly: what the flow of a tube says is handed in."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb, ctx
from support.random_halves import (
    LIMITS,
    FirstHalf,
    Halves,
    Polynomial,
    Unknown,
    at,
    first_half_again,
    integral,
    second_half,
)
from support.within import within

from orbitproof.shared import define_system
from orbitproof.shared.systems import (
    AROUND,
    CR3BP_PLANAR,
    FALKNER_SKAN,
    LIFTED,
    VERTICAL,
    ReversibleSystem,
)
from orbitproof.verify.algebra import Grading, Series, WideArithmetic, ball_polynomial
from orbitproof.verify.evidence import IntegrationFailure, enclose
from orbitproof.verify.functions import BoundedFunction, bounded, known_part
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.stability import TubeOfOrbits, about_closer_polynomial, first_half, matrix
from orbitproof.verify.stability.along import CurveInTube
from orbitproof.verify.stability.first_half import from_first_half
from orbitproof.verify.stability.matrix import SHARE
from orbitproof.verify.stability.stored_stability import OrbitFunctions
from orbitproof.verify.stability.units import at_other_point, units_of

_precision = within(lambda: ctx.workprec(200))


PLACES = [Q(k, 8) for k in range(-8, 9)]


def holds(found: BoundedFunction, truth: Any, known: float) -> bool:
    """Whether the values, of all tau there are, are in what is enclosed; known up to so much of them."""
    for tau in PLACES[:: 4 if known > 1e-3 else 1]:
        value = found.value(enclose(tau))
        wanted = enclose(truth(SHARE * tau))
        if not value.contains(wanted):
            return False
        assert value.rad() < known * (1 + abs(wanted))
    return True


def check(halves: Halves, found: OrbitFunctions, back: list[list[Polynomial]], known: float) -> None:
    for k, own in enumerate(found.characteristic):
        assert holds(bounded(own), lambda place, k=k: halves.truth(back, place)[k], known), f"a_{k + 1}"
    assert len(found.characteristic) == halves.n
    # The square of omega in a level is all unknown.
    assert holds(bounded(found.level), lambda place: integral([at(row, place) for row in halves.here]), 1e-6)
    assert holds(bounded(found.half_period), lambda place: at(halves.time, place), known)
    assert holds(bounded(found.first_factor), halves.determinant, known)


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_of_random_halves_the_stability_matrix_is_that_of_their_product(
    n: int, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    halves = Halves(seed, n)
    seen: list[Mapping[str, Series]] = []
    back = halves.back
    monkeypatch.setattr(matrix, "HalfOrbits", second_half(halves, back, seen))
    check(halves, halves.tube.functions(halves.half, None), back, 1e-15)
    # The second half begins at the other point, off it across its curve.
    (begun,) = seen
    for k, name in enumerate(halves.system.centre_coordinates):
        known = BoundedFunction(ball_polynomial(known_part(begun[name], 0)), arb(begun[name].errors[0]))
        assert all(known.value(enclose(place)).contains(enclose(at(halves.there[k], place))) for place in PLACES)


NAMES = {1: ["q0", "p0", "p1", "time", "back0", "back1"],
         2: ["q0", "q1", "p0", "p1", "p2", "back0", "back1", "back2"]}  # fmt: skip


@pytest.mark.parametrize(
    ("n", "name", "grade"),
    [(n, name, grade) for n, names in NAMES.items() for name in names for grade in range(2 + (name[0] != "b"))],
)
def test_what_is_not_known_of_either_half_is_in_the_stability_matrix(
    n: int, name: str, grade: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One value of one half is known up to a term of one grade, of both signs."""
    for sign in (1, -1):
        for variable in range(n):
            reach = [Q(3, 8) if j == variable else Q(1, 64) for j in range(n)]
            halves = Halves(variable, n, Unknown(name, grade, sign, variable, power=variable), reach=reach)
            back = halves.back
            monkeypatch.setattr(matrix, "HalfOrbits", second_half(halves, back, []))
            check(halves, halves.tube.functions(halves.half, None), back, 1e-2)


@pytest.mark.parametrize(
    ("name", "grade"), [("", 0), ("q0", 0), ("q0", 1), ("p0", 0), ("p1", 0), ("p1", 1), ("vx", 1), ("w", 1), ("w'", 1)]
)
def test_from_the_first_half_alone_the_same_follows(name: str, grade: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a quotient of speeds is the determinant of the half map (Lemma 18.15)."""
    for seed, sign in ((0, 1), (1, -1), (2, 1)):
        halves = FirstHalf(seed, 1, Unknown(name, grade, sign, power=seed), CR3BP_PLANAR)
        monkeypatch.setattr(first_half, "HalfOrbits", first_half_again(halves))
        found = from_first_half(halves.tube, halves.half)
        known = 1e-2 if name else 1e-10
        (own,) = found.characteristic
        assert holds(bounded(own), halves.sigma, known)
        assert holds(bounded(found.half_period), lambda place, halves=halves: at(halves.time, place), known)
        assert holds(bounded(found.first_factor), halves.determinant, known)
        assert isinstance(found.out_of_plane, VariationFunctions)
        rows = [row for rows in halves.v for row in rows]
        for entry, row in zip(found.out_of_plane.known.entries, rows, strict=True):
            assert holds(entry, lambda place, row=row: at(row, place), known)


# The curve in its tube


@pytest.mark.parametrize("n", [1, 2])
def test_a_curve_that_leaves_its_tube_anywhere_is_refused(n: int) -> None:
    """The tube that is followed is four times as wide: beyond a quarter of it the curve is not that of the proof."""
    for seed in range(4):
        for j in range(n):
            reach = [Q(1, 5)] * n
            inside = Halves(seed, n, share=Q(1, 4), reach=reach)
            inside.tube.curve(inside.half)
            reach[j] = Q(7, 27)
            outside = Halves(seed, n, share=Q(1, 4), reach=reach)
            assert max(map(abs, (at(outside.omega[j], tau * SHARE) for tau in (-1, 1)))) > Q(1, 4)
            with pytest.raises(IntegrationFailure, match="in its tube"):
                outside.tube.curve(outside.half)


@pytest.mark.parametrize("odd", [(True,), (False,), (True, False), (False, True), (True, True)])
def test_equations_that_a_symmetry_negates_are_divided_by_sigma(odd: tuple[bool, ...]) -> None:
    for name, grade in (("", 0), ("q0", 0), ("q0", 1), ("q0", 2)):
        halves = Halves(0, len(odd), Unknown(name, grade), odd=odd)
        curve = halves.tube.curve(halves.half)
        for found, omega in zip(curve.omega, halves.omega, strict=True):
            for place in (Q(k, 8) for k in range(-8, 9)):
                value = bounded(found).value(enclose(place))
                assert value.contains(enclose(at(omega, place)))
                assert value.rad() < (1e-2 if name else 1e-15)


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("symmetric", [False, True])
def test_a_tube_about_a_closer_polynomial_lies_in_the_first_one(n: int, symmetric: bool) -> None:
    """And its polynomial is the curve; on a symmetric piece no odd powers are taken over."""
    for seed in range(4):
        # What is known of an even function may have an odd part, within its error.
        unknown = Unknown("q0", 0, 1, power=1) if symmetric else Unknown()
        odd = (False,) * n if symmetric else None
        halves = Halves(seed, n, unknown, share=Q(1, 4), reach=[Q(1, 6)] * n, odd=odd)
        old = halves.tube
        new, half = about_closer_polynomial(old, halves.half)
        assert half is None
        assert new.piece.polynomial != old.piece.polynomial
        radius = (old.interval[1] - old.interval[0]) / 2
        for j in range(n):
            first, second = (tube.piece.polynomial[j] for tube in (old, new))
            for share in (Q(k, 16) for k in range(-16, 17)):
                s = old.middle + share * radius
                moved = abs(at(list(second), s) - at(list(first), s))
                assert 0 < new.piece.tube[j] <= old.piece.tube[j] - moved
                assert not symmetric or first[1::2] == second[1 : len(first) : 2]
                assert not symmetric or not any(second[len(first) + 1 :: 2])
                wanted = at(list(first), s) + halves.widths[j] * at(halves.omega[j], share * Q(16, 17))
                assert abs(at(list(second), s) - wanted) < Q(1, 2 ** (30 if symmetric else 70))


@pytest.mark.parametrize("j", [0, 1])
def test_where_one_of_several_polynomials_leaves_the_tube_none_is_taken(j: int) -> None:
    reach = [Q(1, 6)] * 2
    reach[j] = Q(1, 3)
    halves = Halves(0, 2, share=Q(1, 4), reach=reach)
    half = halves.half
    assert about_closer_polynomial(halves.tube, half) == (halves.tube, half)


# In units of the orbit

ALGEBRA = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=4)


@pytest.mark.parametrize("system", [AROUND["L1"], VERTICAL["L1"], LIFTED], ids=lambda system: system.name)
@pytest.mark.parametrize("end", [0, 1])
def test_a_return_is_told_in_units_of_its_end(system: ReversibleSystem, end: int) -> None:
    """After scaling by a power of lambda, which is none of the family, each orbit is the same orbit (18.9)."""
    chance = random.Random(end)
    oracle: Any = None
    tube = TubeOfOrbits(system, {}, Halves(0, 1).tube.piece, (Q(-1), Q(1)), LIMITS, "physical", oracle)
    # What is 1 there, and the power of lambda by which each coordinate is multiplied.
    unit = {"cr3bp-l1": "xx", "cr3bp-l1-vertical": "wu", "cr3bp-lifted": ("vz", "vz")}[system.name][end]
    scaled_alike = ("z", "vz") if system is LIFTED else system.state
    for _ in range(8):
        own = {name: Q(chance.choice((-1, 1)) * chance.randint(8, 64), 32) for name in system.centre_coordinates}
        factor = Q(chance.choice((-1, 1)) * chance.choice((1, 2, 4)), 4)
        state = {name: own.get(name, Q(0)) for name in system.state} | {unit: Q(1)}
        state = {name: value * (factor if name in scaled_alike else 1) for name, value in state.items()}
        parameter = str(system.family_parameter)
        start = {parameter: own[parameter] / factor ** (2 if system is LIFTED else 1)}
        found = tube.named(
            {name: ALGEBRA.constant(value) for name, value in start.items()},
            [ALGEBRA.constant(state[name]) for name in system.state],
            end,
        )
        for name, element in zip(system.centre_coordinates, found, strict=True):
            value = bounded(element).value(arb(0))
            assert value.contains(enclose(own[name]))
            assert value.rad() < 1e-25
    other = at_other_point(system).normalised
    assert {name: value for name, value in other.items() if value} == {units_of(system)[1]: 1}
    assert set(other) == set(system.normalised)


def test_units_are_told_of_systems_that_scale_alone() -> None:
    system = AROUND["L1"]
    bent = replace(system, vector_field=lambda s, p: (s[2], s[3], s[0] * s[0], s[1]))
    for other in (FALKNER_SKAN, bent, replace(VERTICAL["L1"], title="another")):
        with pytest.raises(IntegrationFailure, match="not known in its own units"):
            units_of(other)


def test_the_other_points_are_on_one_sheet_all_along_the_curve() -> None:
    """The level coordinate is s - c or c - s there: of one sign unless |c| < 1, and of each sign at some end."""
    system = define_system({
        "name": "signs", "state": "x y vx vy", "parameters": "a", "R": {"vx": -1, "vy": -1}, "section": "vy",
        "field": {"x": "vx", "y": "vy", "vx": "-a*x", "vy": "-y"}, "family_parameter": "a",
        "first_integral": "(vx**2 + vy**2 + a*x**2 + y**2)/2", "level_coordinate": "y",
        "fixed_level": {"value": "1/2", "sign": 1},
    })  # fmt: skip
    assert isinstance(system, ReversibleSystem)
    tube = replace(Halves(0, 1).tube, system=system)
    curve = CurveInTube((ALGEBRA.constant(Q(0)),), Q(0))
    flow = WideArithmetic(Grading((1,), 1), 80, 0, 0, width=4)
    for sign in (1, -1):
        for c in (Q(-3, 2), Q(-15, 16), Q(-1, 32), Q(1, 32), Q(15, 16), Q(3, 2)):
            level = flow.polynomial({(0,): [-sign * c, Q(sign)]})
            state = [level if name == "y" else flow.constant(Q(0)) for name in system.state]
            if abs(c) < 1:
                with pytest.raises(IntegrationFailure, match="one sign"):
                    tube._at_other_point(curve, state)
                continue
            there = tube._at_other_point(curve, state)
            assert isinstance(there, ReversibleSystem)
            assert there.fixed_level is not None
            assert there.fixed_level.sign == (-sign if c > 0 else sign)


@pytest.mark.parametrize("n", [1, 2])
def test_the_tube_that_is_followed_is_about_the_polynomial_over_a_little_more_than_the_interval(
    n: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Any] = []

    def of(system: Any, start: Any, widths: Any, *rest: Any) -> Any:
        begun.append((start, widths, rest))

    monkeypatch.setattr(matrix.HalfReturn, "of", of)
    for seed in range(4):
        tube = replace(Halves(seed, n).tube, crossings=seed + 1)
        tube.follow([Q(1, 2**9), Q(1, 2**12)][:n], None)
        tube.wider(None)
        for start, widths, rest in begun:
            assert rest[-1] == seed + 1
            low, high = tube.interval
            for sigma in (Q(-1), Q(0), Q(16, 17), Q(1)):
                s = (low + high) / 2 + sigma * Q(17, 16) * (high - low) / 2
                p = [tube.piece.half_width * s, *(at(list(row), s) for row in tube.piece.polynomial)]
                for name, origin, row in zip(
                    tube.system.centre_coordinates, tube.piece.centre, tube.piece.frame, strict=True
                ):
                    element = start[name]
                    wanted = origin + sum((a * b for a, b in zip(row, p, strict=True)), Q(0))
                    assert abs(at(known_part(element, 0), sigma) - wanted) <= Q(element.errors[0]) + Q(1, 2**60)
                    for j, width in enumerate(widths):
                        position = element.arithmetic.grading.variable(j)
                        assert position is not None
                        assert abs(at(known_part(element, position), sigma) - row[j + 1] * width) < Q(1, 2**60)
        for width, own in zip(begun[1][1], tube.piece.tube, strict=True):
            assert 4 * own < width <= 8 * own
        begun.clear()
