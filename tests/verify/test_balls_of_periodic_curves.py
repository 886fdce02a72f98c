"""Curves of periodic orbits: what is asked of all orbits of a tube, part by part, and what is counted along it."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction as F
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, arb_poly
from support.balls import agree
from support.inclusion import broken_inclusions
from support.periodic_curves import LIMITS, WHOLE, levels_atlas, turning_atlas, twice_atlas
from support.within import within

from orbitproof.shared.formats import PeriodicAtlas, PeriodicCurveClaim, Piece, define_system
from orbitproof.verify.algebra import Series
from orbitproof.verify.curve import BEYOND
from orbitproof.verify.evidence import Checklist, NotEstablishedError, enclose, guarded
from orbitproof.verify.functions import REACH, BoundedFunction, StoredFunction
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_curve import Counts, MultiplierFunctions
from orbitproof.verify.periodic_curve.characteristic import _characteristic, _derivative, _without_one
from orbitproof.verify.periodic_curve.conditions import _parameter_bounds
from orbitproof.verify.periodic_curve.counted import _counted, _value, counts_of, counts_of_pair_of_area
from orbitproof.verify.periodic_curve.piece import _Proof
from orbitproof.verify.periodic_curve.returns import Returns, TubeOfOrbits, ranges

BITS = 160

precision = within(lambda: guarded(BITS))


def unit(size: int, place: int) -> tuple[F, ...]:
    return tuple(F(int(i == place)) for i in range(size))


SPACE = replace(
    define_system(
        {
            "name": "space", "state": "x y z", "parameters": "c b a",
            "field": {"x": "b*y - z", "y": "c*x + a", "z": "a*x*y - c"},
        }
    ),
    first_integral=lambda state, values: (_height(state, values),),
)  # fmt: skip
"""Parameters in no order of their names; no first integral, but a function of the state."""


def _height(state: Sequence[Any], values: Sequence[Any]) -> Any:
    (x, y, z), (c, b, a) = state, values
    return a * x**2 * y + b * y * z - c * z**3 + x


def space(varies: bool, normal: Sequence[F], crossings: int = 1) -> PeriodicAtlas:
    """One piece about (0, 1/2, ..), in the coordinates of the section and of b if it varies."""
    values = {"a": F(3, 4), "b": F(-5, 4), "c": F(2, 3)}
    claim = PeriodicCurveClaim("periodic-arc", tuple(normal), F(3, 8), 1, crossings, "b" if varies else None)
    size = 2 + varies
    frame = tuple(tuple(map(F, row[:size])) for row in ((-1, -2, F(1, 2)), (1, F(-1, 2), -1), (F(1, 2), 1, 2))[:size])
    centre = ((values.pop("b"),) if varies else ()) + (F(1, 2), F(-3, 4))
    rows = ((F(1, 16), F(1, 8)),) * (size - 1)
    piece = Piece("p1", "regular", centre, frame, F(1, 4), rows, (F(1, 2**10),) * (size - 1), "physical")
    return PeriodicAtlas("space", "In space", SPACE, values, claim, (piece,))


def tube_of(atlas: PeriodicAtlas) -> TubeOfOrbits:
    piece = atlas.curve_pieces()[0]
    arithmetic = LIMITS.arithmetic(piece.tube, LIMITS.precision // 2)
    return TubeOfOrbits(atlas, piece, (F(0), F(1)), piece.tube, arithmetic)


def proof_of(atlas: PeriodicAtlas) -> _Proof:
    return _Proof(atlas, atlas.curve_pieces()[0], WHOLE, ORACLE, LIMITS)


def points_of(atlas: PeriodicAtlas, source: random.Random) -> Iterator[tuple[F, list[F]]]:
    """s, and the coordinates of points of the tube there, its edges among them."""
    piece = atlas.curve_pieces()[0]
    for _ in range(12):
        s = F(source.choice((-1, 1))) if source.random() < 0.3 else F(source.randint(-32, 32), 32)
        across = [
            sum((c * s**n for n, c in enumerate(row)), F(0)) + source.choice((-1, 1)) * width
            for row, width in zip(piece.polynomial, piece.tube, strict=True)
        ]
        local = [piece.half_width * s, *across]
        yield (
            s,
            [
                x + sum((a * b for a, b in zip(row, local, strict=True)), F(0))
                for x, row in zip(piece.centre, piece.frame, strict=True)
            ],
        )


NORMALS = [(F(1, 4), F(2), F(-1)), (F(-3), F(1), F(1, 2)), (F(1), F(1, 3), F(4))]


@pytest.mark.parametrize("normal", NORMALS)
@pytest.mark.parametrize("varies", [False, True])
def test_points_of_a_tube_are_on_the_section_with_their_parameters(varies: bool, normal: tuple[F, ...]) -> None:
    """The state at all points of a tube in the system's order, the velocity across, H and its derivatives along."""
    atlas, source = space(varies, normal), random.Random(1)
    orbits, claim, proof = tube_of(atlas), space(varies, normal).claim, proof_of(atlas)
    pivot = claim.pivot
    assert abs(normal[pivot]) == max(map(abs, normal))
    own = orbits.section.own_state(orbits.state)
    across = orbits.across(orbits.section.coordinates(SPACE.program))
    parts = [ranges(element) for element in (*own, *orbits.constants, across)]
    low, high = _parameter_bounds(atlas.curve_pieces()[0]) if varies else (F(0), F(0))
    slopes = [
        proof._integral_slopes(orbits, [ranges(element)[part] for element in orbits.others(orbits.state)], part)
        for part in range(8)
    ]
    for s, coordinates in points_of(atlas, source):
        values = dict(zip(atlas.coordinates, coordinates, strict=True))
        rest = [values[name] for i, name in enumerate("xyz") if i != pivot]
        others = [entry for i, entry in enumerate(normal) if i != pivot]
        height = (claim.offset - sum((a * b for a, b in zip(others, rest, strict=True)), F(0))) / normal[pivot]
        state = [*rest[:pivot], height, *rest[pivot:]]
        a, c, b = F(3, 4), F(2, 3), values.get("b", F(-5, 4))
        assert low <= b <= high or not varies
        x, y, z = state
        field = [b * y - z, c * x + a, a * x * y - c]
        exact = [x, y, z, c, b, a, sum((n * f for n, f in zip(normal, field, strict=True)), F(0))]
        # The part of the interval in which sigma = s is.
        part = min(7, int((s + 1) * 4))
        for balls, value in zip(parts, exact, strict=True):
            assert agree(balls[part], enclose(value))
        gradient = [2 * a * x * y + 1, a * x * x + b * z, b * y - 3 * c * z * z]
        along = [gradient[i] - gradient[pivot] * normal[i] / normal[pivot] for i in range(3) if i != pivot]
        assert all(agree(ball, enclose(value)) for ball, value in zip(slopes[part], along, strict=True))
        if not varies:
            level = a * x * x * y + b * y * z - c * z**3 + x
            assert agree(_value(atlas, list(map(enclose, coordinates))), enclose(level))
    if not varies:
        assert not broken_inclusions(lambda point: _value(atlas, point), ([arb(0.3), arb(-0.7)],), source)


def moved(orbits: TubeOfOrbits, by: Sequence[Sequence[F]]) -> tuple[Series, ...]:
    """The points of a tube, moved by polynomials in sigma."""
    points = orbits.others(orbits.state)
    return tuple(
        point + orbits.arithmetic.polynomial({(0,) * len(orbits.arithmetic.grading.weights): list(row)})
        for point, row in zip(points, by, strict=True)
    )


NOT, AWAY = [F(0)], [F(1)]


@pytest.mark.parametrize("crossings", [1, 6, 30])
def test_no_point_of_any_part_of_a_tube_is_back_at_any_earlier_crossing(crossings: int) -> None:
    """One coordinate apart is enough, on each part of the interval another one; at one sigma none is."""
    atlas = space(True, NORMALS[0], crossings)
    orbits, proof = tube_of(atlas), proof_of(atlas)
    primes = [q for q in (2, 3, 5) if crossings % q == 0]
    stops = [*(crossings // q for q in primes), crossings]
    same = moved(orbits, [NOT, NOT])

    def holds(images: dict[int, tuple[Series, ...]]) -> bool:
        try:
            proof._check_least(Checklist(), orbits, Returns(images, same[0]))
        except NotEstablishedError:
            return False
        return True

    apart = {stop: moved(orbits, [AWAY, NOT]) for stop in stops[:-1]} | {crossings: same}
    assert holds(apart)
    for stop in stops[:-1]:
        for place in (0, 1):
            assert holds(apart | {stop: moved(orbits, [AWAY if i == place else NOT for i in (0, 1)])})
            for at in (F(-15, 16), F(1, 16), F(15, 16)):
                # Apart but near one sigma, and there in the other coordinate or not.
                turned = [[-at, F(1)] if i == place else NOT for i in (0, 1)]
                assert not holds(apart | {stop: moved(orbits, turned)})
                both = [[-at, F(1)], [at + (F(3, 4) if at < 0 else F(-3, 4)), F(-1)]]
                assert holds(apart | {stop: moved(orbits, both if place == 0 else both[::-1])})
        assert not holds(apart | {stop: same})
    assert not holds({stop: moved(orbits, [AWAY, AWAY]) for stop in stops[:-1]})


def test_the_direction_is_that_of_every_part() -> None:
    proof = proof_of(space(True, NORMALS[0]))
    turned = replace(proof, atlas=replace(proof.atlas, claim=replace(proof.atlas.claim, direction=-1)))
    for place in range(8):
        for wrong in (arb(-1), arb(0), arb(0.5, 1), arb("nan")):
            across = [wrong if i == place else arb(1, 0.5) for i in range(8)]
            for attempt, balls in ((proof, across), (turned, [-ball for ball in across])):
                with pytest.raises(NotEstablishedError, match=r"normal \. f"):
                    attempt._check_direction(Checklist(), balls)
    proof._check_direction(Checklist(), [arb(1, 0.5)] * 8)
    turned._check_direction(Checklist(), [arb(-1, 0.5)] * 8)


def test_the_integral_tells_the_last_coordinate_on_every_part_between_points_and_images() -> None:
    """x^2 + y^2 on y = 0: its derivative 2 x vanishes where points with x < 0 have an image with x > 0."""
    atlas = levels_atlas()
    orbits, proof = tube_of(atlas), proof_of(atlas)

    def holds(by: Sequence[F]) -> bool:
        try:
            proof._check_last(Checklist(), orbits, moved(orbits, [by, NOT]), 0)
        except NotEstablishedError:
            return False
        return True

    assert holds(NOT)
    # x is from -5/4 to -3/4: images at 1/4 at most stay on this side.
    assert holds([F(1, 2)])
    for at in (-1, 1):
        # On one side only the image goes beyond 0.
        assert not holds([F(1, 2), F(at)])
    assert not holds([F(3, 2)])
    assert proof._dropped(orbits) == 0


def test_the_period_is_that_of_all_parts() -> None:
    """Wherever it is longest or shortest: at an end, in the middle, on any part between."""
    arithmetic, chance = tube_of(turning_atlas()).arithmetic, random.Random(0)
    rows = [[F(5), F(1)], [F(5), F(-1)], [F(5), F(0), F(1)], [F(5), F(0), F(-1)]]
    rows += [[F(5), *(F(chance.randint(-8, 8), 8) for _ in range(3))] for _ in range(8)]
    for row in rows:
        unknown = F(chance.randint(0, 4), 64)
        found = Returns({}, arithmetic.polynomial({(0,): row}).widened(unknown)).time_of_all()
        times = [sum(c * F(place, 32) ** n for n, c in enumerate(row)) for place in range(-32, 33)]
        for time in times:
            assert agree(found, enclose(time + unknown))
            assert agree(found, enclose(time - unknown))
        # On each of the eight parts a little is lost.
        lost = sum(n * abs(c) for n, c in enumerate(row)) / 8
        assert float(found.rad()) < float((max(times) - min(times)) / 2 + unknown + lost) * 1.01


def functions(source: random.Random, size: int, error: float) -> list[list[BoundedFunction]]:
    return [
        [BoundedFunction(arb_poly([arb(source.uniform(-1, 1)) for _ in range(3)]), arb(error)) for _ in range(size)]
        for _ in range(size)
    ]


@pytest.mark.parametrize("size", [1, 2, 3])
def test_coefficients_of_the_polynomial_of_multipliers(size: int) -> None:
    """At points of the interval, for all functions within the bounds: of D, and of the rest without a factor."""
    source = random.Random(size)
    rows = functions(source, size, 2.0**-12)
    found = _characteristic(rows)
    assert len(found) == size
    for _ in range(12):
        tau = arb(source.uniform(-0.9, 0.9))
        at = [[each.polynomial(tau) + source.choice((-1, 1)) * arb(2) ** -12 for each in row] for row in rows]
        for number, value in enumerate(_leading(at), start=1):
            assert agree(found[number - 1].value(tau), value)
            assert found[number - 1].value(tau).rad() < 0.1
    # (lambda - 1)(lambda^2 + b lambda + c) = lambda^3 + (b - 1) lambda^2 + (c - b) lambda - c.
    b, c = functions(source, 1, 2.0**-12)[0][0], functions(source, 1, 0.0)[0][0]
    one = BoundedFunction(arb_poly([1]), arb(0))
    quotient = _without_one([b - one, c - b, c.scaled(arb(-1))])
    assert len(quotient) == 2
    for tau in (arb(-0.5), arb(0.75)):
        for ball, exact in zip(quotient, (b, c), strict=True):
            assert agree(ball.value(tau), exact.polynomial(tau) + arb(0, 2.0**-12))
            assert agree(ball.value(tau), exact.polynomial(tau))


def _leading(matrix: Sequence[Sequence[arb]]) -> list[arb]:
    """The coefficients of det(lambda - A) after the first, by the method of Faddeev and Le Verrier."""
    size = len(matrix)
    product, found = [list(row) for row in matrix], list[arb]()
    for k in range(1, size + 1):
        found.append(-sum((product[i][i] for i in range(size)), arb(0)) / k)
        shifted = [
            [value + (found[-1] if i == j else 0) for j, value in enumerate(row)] for i, row in enumerate(product)
        ]
        product = [
            [sum((a * row[j] for a, row in zip(line, shifted, strict=True)), arb(0)) for j in range(size)]
            for line in matrix
        ]
    return found


def test_zeros_of_polynomials_in_balls_are_counted_as_at_all_of_their_points() -> None:
    """One zero goes through the circle as the ball widens: before that it is counted, after that nothing is."""
    source, decided = random.Random(3), 0
    for _ in range(100):
        size = source.randint(1, 4)
        zeros = [source.choice((-1, 1)) * source.choice((0.2, 0.5, 0.7, 1.5, 2.5)) for _ in range(size)]
        edge = source.choice((-1.0, 1.0))
        coefficients = _of_zeros([arb(z) for z in zeros])
        inside = sum(abs(z) < 1 for z in zeros)
        for place in range(size):
            for end in (edge, edge * 1.25, edge * 0.75):
                other = _of_zeros([arb(end) if i == place else arb(z) for i, z in enumerate(zeros)])
                balls = [a.union(b) for a, b in zip(coefficients, other, strict=True)]
                found = counts_of(balls)
                if found is None:
                    continue
                decided += 1
                at_end = sum(abs(end if i == place else z) < 1 for i, z in enumerate(zeros))
                assert found == Counts(inside, 0, size - inside)
                assert at_end == inside
                assert abs(end) != 1
    assert decided > 30
    for value in (1.5, -1.5, 2.5, -2.5):
        expected = Counts(0, 2, 0) if abs(value) < 2 else Counts(1, 0, 1)
        assert counts_of_pair_of_area(arb(value, 0.25)) == expected
        assert counts_of_pair_of_area(arb(value, 0.6)) is None


def _of_zeros(zeros: Sequence[arb]) -> list[arb]:
    polynomial = arb_poly([1])
    for zero in zeros:
        polynomial = polynomial * arb_poly([-zero, 1])
    return [polynomial[len(zeros) - n] for n in range(1, len(zeros) + 1)]


@pytest.mark.parametrize("size", [1, 2])
def test_a_zero_on_the_circle_lies_in_a_part_that_is_not_counted(size: int) -> None:
    """lambda = 1 + k (s - place), beside 1/2: parts cover what was asked for, each with what is true on all of it."""
    source = random.Random(size)
    atlas = turning_atlas() if size == 1 else twice_atlas()
    for _ in range(4):
        start, end = F(source.randint(-16, -4), 16), F(source.randint(4, 16), 16)
        place, k = F(source.randint(-3, 3), 16), F(source.choice((-1, 1)), 4)
        middle, length = (start + end) / 2, (end - start) / 2 * REACH
        first = [1 + k * (middle - place), k * length]
        rows = [[-value for value in first]]
        if size == 2:
            rows = [[-first[0] - F(1, 2), -first[1]], [first[0] / 2, first[1] / 2]]
        known = MultiplierFunctions(tuple(StoredFunction.near(list(map(enclose, row)), arb(2) ** -40) for row in rows))
        wanted = (start + F(1, 32), end)
        parts = _counted(atlas, known, (start, end), wanted)
        assert parts[0][0] == wanted[0]
        assert parts[-1][1] == wanted[1]
        assert all(one[1] == other[0] for one, other in itertools.pairwise(parts))
        for low, high, counts in parts:
            if counts is None:
                assert high - low < F(1, 2**20)
                continue
            for s in (low, (low + high) / 2, high):
                value = 1 + k * (s - place)
                assert abs(value) != 1
                assert counts == Counts((abs(value) < 1) + size - 1, 0, int(abs(value) > 1))
        assert any(low <= place <= high and counts is None for low, high, counts in parts)


@pytest.mark.parametrize("normal", NORMALS)
def test_the_parameter_is_between_its_bounds_on_a_piece(normal: tuple[F, ...]) -> None:
    atlas = space(True, normal)
    low, high = _parameter_bounds(atlas.curve_pieces()[0])
    at = [coordinates[0] for _, coordinates in points_of(atlas, random.Random(2))]
    assert low <= min(at) <= max(at) <= high
    assert high - low < 4 * (max(at) - min(at))


@pytest.mark.parametrize("seed", range(4))
def test_derivatives_of_a_return_are_those_at_all_points_that_the_curve_may_have(seed: int) -> None:
    """F = a + b_1 omega_1 + b_2 omega_2 + q omega_1^2, a and b_j linear in sigma, at omega_j = +-o_j; q is unknown."""
    source, atlas = random.Random(seed), space(True, NORMALS[0])
    a, *b = [[F(source.choice((-1, 1)) * source.randint(1, 9), 4) for _ in range(2)] for _ in range(3)]
    q, bounds_, widths = F(seed % 2 * source.randint(1, 5), 2), (F(3, 16), F(1, 8)), (F(1, 2**10), F(1, 2**9))
    lines = [arb_poly(list(map(enclose, row))) for row in (a, *b)]
    image: Any = SimpleNamespace(
        errors=[arb(0), arb(0), enclose(q)], polynomials=lines, linear=lambda j: lines[1 + j]
    )  # fmt: skip
    # The parameter is p_1, the coordinates of the section are p_0, along the curve, and p_2.
    frame = (unit(3, 1), unit(3, 0), unit(3, 2))
    piece = replace(atlas.curve_pieces()[0], frame=frame)
    ((along, across),) = _derivative(atlas, piece, WHOLE, [image], widths, list(map(enclose, bounds_)))
    for signs in itertools.product((-1, 1), repeat=2):
        omega = [sign * bound for sign, bound in zip(signs, bounds_, strict=True)]
        for sigma in (F(-7, 8), F(0), F(7, 8)):
            by_omega = [row[0] + row[1] * sigma for row in b]
            by_omega[0] += 2 * q * omega[0]
            by_p = [value / width for value, width in zip(by_omega, widths, strict=True)]
            by_sigma = a[1] + sum(row[1] * w for row, w in zip(b, omega, strict=True))
            turns = [row[1] * BEYOND for row in piece.polynomial]
            rate = by_sigma - sum(x * t for x, t in zip(by_p, turns, strict=True))
            assert across.value(enclose(sigma)).contains(enclose(by_p[1]))
            assert along.value(enclose(sigma)).contains(enclose(rate / (piece.half_width * BEYOND)))
    steep = _derivative(atlas, replace(piece, frame=(unit(3, 2), unit(3, 1), unit(3, 0))), WHOLE, [image], widths,
                        list(map(enclose, bounds_)))  # fmt: skip
    ((first, _),) = steep
    for sign in (-1, 1):
        assert first.value(arb(0)).contains(enclose((b[0][0] + sign * 2 * q * bounds_[0]) / widths[0]))
