"""Exact conditions on systems without any symmetry of their coordinates, maps for use, times of crossings."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Sequence
from fractions import Fraction as F
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support.balls import agree
from support.inclusion import broken_inclusions
from support.other_coordinates import dot, mixing, product
from support.within import within

from orbitproof.shared import System, define_system
from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import FixedLevel, ReversibleSystem, record
from orbitproof.verify import enclose as use
from orbitproof.verify.algebra import Arithmetic, Grading, WideArithmetic
from orbitproof.verify.certificate.levels import confirmed
from orbitproof.verify.claim import (
    check_level,
    inverse,
    is_first_integral,
    is_free_of_divergence,
    is_respected,
    on_box,
)
from orbitproof.verify.claim.functions import enclose_functions
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    IntegrationFailure,
    NotEstablishedError,
    bounds,
    enclose,
    guarded,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import Orbits, check_half_orbit, coordinates_of, on_sheet, range_of, wide_parts
from orbitproof.verify.poincare.half_orbits import WideOrbits

BITS = 160
Rows = Sequence[Sequence[F]]

precision = within(lambda: guarded(BITS))


def transposed(rows: Rows) -> tuple[tuple[F, ...], ...]:
    return tuple(zip(*rows, strict=True))


def names_of(size: int) -> list[str]:
    return [*(f"x{i}" for i in range(size)), "c", "b", "a"]


def system_of(size: int, field: Callable[..., Sequence[Any]], more: dict[str, Any] | None = None) -> System:
    names = names_of(size)[:size]
    return define_system({"name": "any", "state": names, "parameters": "c b a", "field": field, **(more or {})})


@pytest.mark.parametrize("size", [2, 3, 4])
def test_a_symmetry_is_a_matrix_and_not_its_transpose_and_all_components_respect_it(size: int) -> None:
    """f(x) = M f_0(M^-1 x) with f_0 odd in some coordinates: S = M diag M^-1, which is not symmetric."""
    for seed in range(4):
        chance = random.Random(f"{size} {seed}")
        matrix = mixing(size, chance)
        back = inverse(matrix)
        assert back is not None
        signs = [chance.choice((-1, 1)) for _ in range(size)]
        signs[0], signs[-1] = -1, 1
        symmetry = product(product(matrix, [[F(s * (i == j)) for j in range(size)] for i, s in enumerate(signs)]), back)
        assert symmetry != transposed(symmetry)

        def field(*values: Any, spoiled: int | None = None, matrix: Rows = matrix, back: Rows = back,
                  signs: Sequence[int] = tuple(signs)) -> list[Any]:  # fmt: skip
            state, (c, b, a) = values[:size], values[size:]
            y = [dot(row, state) for row in back]
            even = c + sum((x * x for x in y[1:]), y[0] * y[0])
            own = [x * even + (b / (1 + x * x) if s > 0 else x * a) for x, s in zip(y, signs, strict=True)]
            if spoiled is not None:
                # Not as it should be under S.
                own[spoiled] = own[spoiled] + (y[0] if signs[spoiled] > 0 else y[-1] * y[-1])
            return [dot(row, own) for row in matrix]

        assert is_respected(system_of(size, field).program, symmetry)
        assert not is_respected(system_of(size, field).program, transposed(symmetry))
        for place in range(size):
            spoiled = system_of(size, lambda *v, place=place, field=field: field(*v, spoiled=place))
            assert not is_respected(spoiled.program, symmetry)
        # A function of one value is left alone, or is not.
        for terms, expected in (((0, 0), True), ((0, size - 1), False), ((size - 1,), True), ((0,), False)):

            def height(*values: Any, terms: Sequence[int] = terms, back: Rows = back) -> Any:
                y = [dot(row, values[:size]) for row in back]
                return values[size + 1] + (y[terms[0]] * y[terms[1]] if len(terms) == 2 else y[terms[0]])

            program = record(lambda values, height=height: (height(*values),), names_of(size))
            assert is_respected(program, symmetry) is expected, terms


@pytest.mark.parametrize("place", [0, 1, 2])
def test_one_component_that_does_not_respect_a_symmetry_is_enough(place: int) -> None:
    """S(u, v) = (-u, u + v): of f = (u, 0) the second component alone is not as it should be."""
    order = [0, 1, 2]
    order.remove(place)
    u, w = order

    def field(*values: Any) -> list[Any]:
        rows = [0 * value for value in values[:3]]
        rows[u], rows[w] = values[u], values[w]
        return rows

    symmetry = [[F(int(i == j)) for j in range(3)] for i in range(3)]
    symmetry[u][u], symmetry[place][u] = F(-1), F(1)
    rows = tuple(map(tuple, symmetry))
    assert not is_respected(system_of(3, field).program, rows)
    # With v' = -u/2 it is, and with w' = u the other one is not.
    half = system_of(3, lambda *v: [f - v[u] / 2 * int(i == place) for i, f in enumerate(field(*v))])
    assert is_respected(half.program, rows)
    other = system_of(
        3, lambda *v: [f - v[u] / 2 * int(i == place) + v[u] * int(i == w) for i, f in enumerate(field(*v))]
    )
    assert not is_respected(other.program, rows)


@pytest.mark.parametrize("pairs", [1, 2])
def test_a_first_integral_is_kept_by_all_components_together(pairs: int) -> None:
    """x' = dH/dy, y' = -dH/dx in other coordinates, H a polynomial and a quotient with parameters."""
    size = 2 * pairs
    for seed in range(3):
        chance = random.Random(f"{pairs} {seed}")
        matrix = mixing(size, chance)
        back = inverse(matrix)
        assert back is not None

        def height(*values: Any, back: Rows = back) -> Any:
            state, (c, b, a) = values[:size], values[size:]
            y = [dot(row, state) for row in back]
            return a * y[0] * y[0] * y[-1] + b / (1 + y[-1] * y[-1]) + c * dot(y, y)

        def gradient(values: Sequence[Any], back: Rows = back) -> list[Any]:
            state, (c, b, a) = values[:size], values[size:]
            y = [dot(row, state) for row in back]
            slopes = [2 * c * each for each in y]
            slopes[0] = slopes[0] + 2 * a * y[0] * y[-1]
            slopes[-1] = slopes[-1] + a * y[0] * y[0] - 2 * b * y[-1] / (1 + y[-1] * y[-1]) / (1 + y[-1] * y[-1])
            return slopes

        def field(*values: Any, spoiled: int | None = None, matrix: Rows = matrix) -> list[Any]:
            slopes = gradient(values)
            own = [*slopes[pairs:], *(-1 * each for each in slopes[:pairs])]
            if spoiled is not None:
                own[spoiled] = own[spoiled] + values[size]
            return [dot(row, own) for row in matrix]

        system = system_of(size, field, {"first_integral": height})
        assert system.first_integral_program is not None
        assert is_first_integral(system.program, system.first_integral_program)
        assert is_free_of_divergence(system.program, size)
        for place in range(size):
            other = system_of(size, lambda *v, place=place, field=field: field(*v, spoiled=place))
            assert not is_first_integral(other.program, system.first_integral_program), place

            def swelling(*values: Any, place: int = place, field: Any = field) -> list[Any]:
                return [f + values[size + 1] * values[i] * int(i == place) for i, f in enumerate(field(*values))]

            assert not is_free_of_divergence(system_of(size, swelling).program, size), place
        # The order of parameters is that of the field.
        swapped = system_of(size, lambda *v, field=field: field(*v[:size], v[size + 2], v[size + 1], v[size]))
        assert not is_first_integral(swapped.program, system.first_integral_program)


def brakes(low: str, high: str, level: F = F(1, 12)) -> ReversibleSystem:
    """From rest to rest; y follows from the level of the potential."""
    found = define_system({
        "name": "brakes", "state": "x y vx vy", "parameters": "c a", "R": {"vx": -1, "vy": -1}, "section": "vy",
        "field": {"x": "vx", "y": "vy", "vx": "-x - 2*a*x*y", "vy": "-c*y - a*x**2 + y**2"},
        "first_integral": "(vx**2 + vy**2 + x**2 + c*y**2)/2 + a*x**2*y - y**3/3", "family_parameter": "a",
        "level_coordinate": "y", "fixed_level": {"value": str(level), "between": [low, high]},
    })  # fmt: skip
    assert isinstance(found, ReversibleSystem)
    return found


def test_the_coordinate_of_a_level_is_one_at_all_points_of_a_box_or_it_is_refused() -> None:
    """With a frame of negative entries; at corners of the box H - h changes its sign, and dH/dy has one."""
    chance, holds = random.Random(3), 0
    for _ in range(80):
        low, high = F(-chance.randint(10, 16), 16), F(-chance.randint(2, 5), 16)
        system = brakes(str(low), str(high))
        centre = (F(chance.randint(4, 12), 8), F(chance.randint(-3, 3), 8))
        frame = ((F(1), F(0)), (F(chance.choice((-2, -1, 2))), F(chance.choice((-1, 1)))))
        radii = (F(1, 2 ** chance.randint(2, 8)), F(1, 2 ** chance.randint(2, 8)))
        claim = Candidate("box", system, {"c": F(1)}, "period_tupling", 2, centre, frame, ((F(1),),), radii)
        balls = on_box(claim)
        try:
            check_level(Checklist(), claim)
            proved = True
            holds += 1
        except NotEstablishedError:
            proved = False
        for p in itertools.product((-1, 0, 1), repeat=2):
            a, x = (m + dot(row, [r * s for r, s in zip(radii, p, strict=True)])
                    for m, row in zip(centre, frame, strict=True))  # fmt: skip
            for ball, value in zip(balls, (x, None, 0, 0, 1, a), strict=True):
                assert value is None or agree(ball, enclose(F(value)))
            heights = [(x * x + y * y) / 2 + a * x * x * y - y**3 / 3 - F(1, 12) for y in (low, high)]
            slopes = [y + a * x * x - y * y for y in (low + (high - low) * F(n, 8) for n in range(9))]
            if proved:
                assert heights[0] * heights[1] < 0
                assert all(slope > 0 for slope in slopes) or all(slope < 0 for slope in slopes)
    assert 10 < holds < 70


def test_points_are_on_a_sheet_if_all_of_them_are() -> None:
    system = brakes("-1", "-1/10")
    by_sign = define_system({
        "name": "signs", "state": "x y vx vy", "parameters": "a", "R": {"vx": -1, "vy": -1}, "section": "vy",
        "field": {"x": "vx", "y": "vy", "vx": "-a*x", "vy": "-y"}, "family_parameter": "a",
        "first_integral": "(vx**2 + vy**2 + a*x**2 + y**2)/2", "level_coordinate": "y",
        "fixed_level": {"value": "1/2", "sign": 1},
    })  # fmt: skip
    assert isinstance(by_sign, ReversibleSystem)
    assert on_sheet(by_sign, [arb(1, 0.5), arb(0.25, 0.125)]).fixed_level == FixedLevel(F(1, 2), 1)
    assert on_sheet(by_sign, [arb(-1, 0.5), arb(-0.25, 0.125)]).fixed_level == FixedLevel(F(1, 2), -1)
    for values in ([arb(1), arb(-1)], [arb(-1), arb(1)], [arb(1), arb(0.25, 0.5)], [arb(0.25, 0.5), arb(1)], []):
        with pytest.raises(IntegrationFailure):
            on_sheet(by_sign, values)
    there = on_sheet(system, [arb(-0.5, 0.125), arb(2, 0.5)]).fixed_level
    assert there is not None
    assert there.between is not None
    assert there.between[0] < F(-5, 8)
    assert there.between[1] > F(5, 2)


def test_functions_of_coordinates_are_those_at_all_points_of_balls() -> None:
    """Each of what it is a function of, functions of functions too, parameters in no order of their names."""
    system = define_system({
        "name": "nested", "state": "x y", "parameters": "b a",
        "field": {"x": "exp(a*x)*b - sin(x*b + exp(a*x))", "y": "log(2 + b*x**2) - a*cos(y - b)"},
    })  # fmt: skip
    chance = random.Random(6)
    size = len(system.state)
    state, parameters = (
        [arb(0.3), arb(-0.4), *[arb(chance.uniform(5, 6)) for _ in range(size - 2)]],
        [arb(0.7), arb(-0.2)],
    )
    assert not broken_inclusions(lambda s, p: enclose_functions(system, s, p), (state, parameters), chance)
    found = dict(zip(system.state, enclose_functions(system, state, parameters), strict=True))
    (x, y), (b, a) = state[:2], parameters
    grown = (a * x).exp()
    values = [grown, (x * b + grown).sin(), (x * b + grown).cos(), (2 + b * x * x).log(), (y - b).cos(), (y - b).sin()]
    assert all(any(agree(ball, value) for ball in found.values()) for value in values)
    # What is not defined at some point of a ball is not finite.
    wide = enclose_functions(system, [arb(0, 3), *state[1:]], [arb(-1), arb(0)])
    assert not all(ball.is_finite() for ball in wide)


def a_table(value: arb) -> DerivativeTable:
    return DerivativeTable({(0, 0): value}, {(0, 0): value.mid()})


@pytest.mark.parametrize("components", [1, 2, 3])
def test_every_crossing_before_the_end_is_apart_in_some_component(components: int) -> None:
    apart, near = a_table(arb(1, 0.5)), a_table(arb(0.25, 0.5))
    for crossings in (1, 3):
        for away in itertools.product(range(components + 1), repeat=crossings):
            before = [[apart if j == place else near for j in range(components)] for place in away]
            holds = all(place < components for place in away)
            if holds:
                check_half_orbit(Checklist(), before)
                continue
            with pytest.raises(NotEstablishedError):
                check_half_orbit(Checklist(), before)


def test_the_time_of_a_crossing_is_that_of_orbits_that_begin_at_any_time_of_a_ball() -> None:
    """x' = v, v' = -x from v = 0: pi later than the beginning, whenever that is."""
    circle = define_system({"name": "circle", "state": "x v", "field": {"x": "v", "v": "-x"}})
    arithmetic = Arithmetic(Grading((1,), 1), 100, 0, 40)
    x = arithmetic.polynomial({(0,): F(5, 4), (1,): F(1, 2**12)})
    orbits = Orbits(
        coordinates_of("own", circle.program, 2, 1), arithmetic, [x, arithmetic.constant(F(0))], [], ORACLE
    )  # fmt: skip
    orbits.time = arb(0, 1) / 64
    for counter in orbits.counters:
        counter.clear_time = None
    _, time = orbits.next_crossing()
    for begin in (-1, 0, 1):
        assert agree(time, arb.pi() + arb(begin) / 64)
    assert time.rad() < 0.016
    _, time = orbits.next_crossing()
    assert agree(time, 2 * arb.pi() + arb(1) / 64)


def test_the_time_of_a_return_is_at_the_rate_of_each_orbit() -> None:
    """rate(s) t + delay(s, xi): at both ends of the ball of t, for all s, and what is unknown of each."""
    arithmetic = WideArithmetic(Grading((1,), 1), 120, 0, 2, 0, 2)
    rate = arithmetic.polynomial({(0,): [F(1), F(1, 8), F(-1, 16)]})
    delay = arithmetic.polynomial({(0,): [F(1, 32), F(-1, 8)], (1,): F(1, 64)}).widened(F(1, 256))
    orbits: Any = object.__new__(WideOrbits)
    orbits.coordinates, orbits.arithmetic = SimpleNamespace(regularisation=None), arithmetic
    orbits.time, orbits.delay, orbits.rate = arb(3) + arb(0, 1) / 128, delay, rate
    found = orbits.return_time
    for part in wide_parts(4):
        ball = range_of(found, part)
        for end, edge in itertools.product((-1, 1), repeat=2):
            s = F(str(float(part.mid()))) + F(end, 4)
            speed = 1 + s / 8 - s * s / 16
            exact = speed * (3 + F(edge, 128)) + F(1, 32) - s / 8 + F(edge, 64) + F(edge, 256)
            assert agree(ball, enclose(exact))
            assert agree(orbits.rate_on(part), enclose(speed))
        assert ball.rad() < 0.2
    orbits.rate = None
    assert agree(range_of(orbits.return_time, arb(0)), arb(3) + arb(1) / 128 + arb(1) / 32 + arb(1) / 64 + arb(1) / 256)


ROTATION = define_system({"name": "rotation", "state": "x v", "parameters": "w", "field": {"x": "w*v", "v": "-w*x"}})


def test_zeros_of_images_depend_on_their_independent_variables() -> None:
    """x cos 1 + v sin 1 = c with a frame of negative entries: v for each x, at both ends and over all of the box."""
    rows = {"x": [F(-2), F(0)], "v": [F(1, 2), F(-3)], "w": [F(0), F(0)]}
    box = use.box({"x": 1, "v": "1/4", "w": 1}, rows, ["1/64", "1/16"])
    image = use.flow(ROTATION, box, 1, precision=96)
    assert isinstance(image, use.Enclosure)
    c = F(7507, 10000)
    zero = use.interval_newton([image.function({"x": 1}, -c)])
    assert isinstance(zero, use.Zero)
    cosine, sine = arb(1).cos(), arb(1).sin()

    def exact(p: arb) -> tuple[arb, arb]:
        """The unknown p_2, and v there."""
        v = (enclose(c) - (1 - 2 * p) * cosine) / sine
        return (v - arb(1) / 4 - p / 2) / -3, v

    for p in (arb(-1) / 64, arb(0), arb(3) / 256, arb(1) / 64):
        unknown, v = exact(p)
        for found in (zero.at, zero.over([p]), zero.over([arb(0, 1) / 64])):
            assert agree(found[0], p)
            assert agree(found[1], unknown)
        assert zero.over([p])[1].rad() < 1e-20
        assert agree(zero.point["v"], v)
        assert agree(zero.point["x"], 1 - 2 * p)
    chance = random.Random(4)
    assert not broken_inclusions(lambda p: zero.over([p]), (arb(1) / 256,), chance)
    function = image.function({"x": F(1, 3), "v": F(-2)}, "1/7", [5, -3])
    where = [arb(1) / 128, arb(-1) / 32]
    for index in ((0, 0), (1, 0), (0, 1)):
        if index == (0, 0):
            assert not broken_inclusions(lambda balls, i=index: function.over(balls, i), (where,), chance)
        x, v = 1 - 2 * where[0], arb(1) / 4 + where[0] / 2 - 3 * where[1]
        first, second = x * cosine + v * sine, v * cosine - x * sine
        by = {(0, 0): first / 3 - 2 * second + arb(1) / 7 + 5 * where[0] - 3 * where[1],
              (1, 0): (-2 * cosine + sine / 2) / 3 - 2 * (cosine / 2 + 2 * sine) + 5,
              (0, 1): -sine + 6 * cosine - 3}  # fmt: skip
        assert agree(function.over(where, index), by[index])
        assert agree(function.table.box[index], by[index])
    assert not broken_inclusions(lambda balls: dict(image.over(balls).value), (where,), chance)


def test_what_is_stored_is_confirmed_by_what_lies_in_it_and_by_nothing_else() -> None:
    """At either end, and without a tolerance."""
    chance = random.Random(5)
    for _ in range(200):
        radius = F(1, 2 ** chance.randint(3, 40)) * chance.choice((0, 1, 1))
        stored = arb(chance.uniform(-2, 2)) + (arb(0, 1) * enclose(radius) if radius else 0)
        by = arb(0, 1) * enclose(radius) * arb(chance.choice((0.5, 1.5, 0.0, 1 - 2.0**-10)))
        fresh = stored.mid() + enclose(radius) * chance.choice((-1, 0, 0.5, 2.0**-30)) + by
        (low, high), (new_low, new_high) = bounds(stored), bounds(fresh)
        assert (not list(confirmed(stored, fresh, "place"))) is (low <= new_low and new_high <= high)
    assert list(confirmed(arb(1), arb("nan"), "place"))
    assert list(confirmed(arb("nan"), arb(1), "place"))
    assert list(confirmed(arb(0, "inf"), arb(1), "place"))
