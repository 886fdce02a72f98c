"""Angles, surfaces and normal forms along curves: balls give balls, and what is counted is sure."""

from __future__ import annotations

import random
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest
from flint import acb, arb, ctx
from support.balls import agree
from support.inclusion import broken_inclusions
from support.random_segments import ball, number
from support.within import within

from orbitproof.shared.claims import SurfacePiece
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_PLANAR, LIFTED, VERTICAL
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import stiffness_at_rest
from orbitproof.verify.evidence import Evidence, enclose, hull
from orbitproof.verify.index.along_curve import _start
from orbitproof.verify.index.half_turns import Turning, determinant, half_turns, index_of
from orbitproof.verify.index.libration_value import _whole, index_of_small_orbits
from orbitproof.verify.index.moving import Moving
from orbitproof.verify.lasting.jets import FunctionJet, compose, inverse_of_plane_map
from orbitproof.verify.lasting.twist_function import normal_form
from orbitproof.verify.orbit_on_curve.orbit_on_curve import _index
from orbitproof.verify.surface.gluing import Sheet
from orbitproof.verify.surface.proved_parts import ProvedPart

BITS = 160
MU = Fraction(1, 80)

precision = within(lambda: ctx.workprec(BITS))


def numbers(chance: random.Random, count: int) -> tuple[acb, ...]:
    return tuple(acb(ball(chance), ball(chance)) for _ in range(count))


@pytest.mark.parametrize("size", [1, 2, 3])
def test_angles_of_planes(size: int) -> None:
    chance = random.Random(size)
    rows = tuple(numbers(chance, size) for _ in range(size))
    assert not broken_inclusions(determinant, (rows,), chance)
    turning = Turning(acb(1))
    turning.go_on(acb(0, 1) + acb("0.1"))
    before = turning.angle

    def further(end: acb, at: acb) -> Any:
        other = Turning(at)
        other.angle = before
        other.go_on(end)
        return other.angle, other.at

    assert not broken_inclusions(further, (acb("-0.4", "0.8"), acb("0.1", "0.7")), chance)
    angle, across = arb("2.3") + 3 * arb.pi(), ball(chance, 0.5, 1)
    turned = acb("0.3", "0.8")

    def counted(end: acb, across: arb) -> Any:
        rest = size * arb.pi() / 2 + (end / across).arg()
        return half_turns(rest.mid() + 2 * arb.pi(), end, across, size)

    assert counted(turned, across)[0] == 2
    assert not broken_inclusions(lambda end, across: counted(end, across), (turned, across), chance)
    # Half turns of an angle that may be one of two numbers are not told.
    with pytest.raises(Exception, match="not known"):
        half_turns(arb(0, 4), turned, across, size)
    with pytest.raises(Exception, match="not known"):
        half_turns(angle, turned, arb(0, 1), size)
    with pytest.raises(Exception, match="not known"):
        half_turns(angle, acb(arb(0, 1), arb(0, 1)), across, size)


@pytest.mark.parametrize("place", range(3))
def test_an_argument_is_followed_only_if_all_values_on_the_way_are_on_one_side(place: int) -> None:
    """Of values on the way, that of before, and that of the end, one lies opposite, across, or about 0."""
    for wrong in (acb(-1, "0.1"), acb(arb(0, 2), 1), acb(0, -2), acb(arb("nan"), 1)):
        over, end = [acb(1, "0.5"), acb(2, -1), acb(1)], acb(1, "0.125")
        turning = Turning(acb("0.5", "0.25"))
        assert turning.reaches(over, end)
        assert turning.reaches(over[:1], end)
        over[place] = wrong
        assert not turning.reaches(over, end)
    assert not Turning(acb(-1)).reaches([acb(1)], acb(1))
    assert not Turning(acb(1)).reaches([acb(1)], acb(arb(0, 1), 0))


def test_vectors_that_move() -> None:
    chance = random.Random(0)
    polynomials = tuple(ball_polynomial([number(chance) for _ in range(5)]) for _ in range(3))
    vector = Moving(polynomials, (arb(0),) * 3)
    other = Moving(polynomials[::-1], (arb("0.25"), arb("0.5"), arb(1)))
    both = Moving(polynomials, (arb("0.5"), arb(1), arb("0.25"))).less(arb(-2), other)
    assert [float(bound) for bound in both.errors] == [1, 2, 2.25]
    both = Moving(polynomials, (arb("0.5"), arb(1), arb("0.25"))).less(arb(2), other)
    assert [float(bound) for bound in both.errors] == [1, 2, 2.25]
    assert not broken_inclusions(vector.over, (ball(chance, 0.2, 0.8),), chance)
    low, high = Fraction(1, 4), Fraction(3, 4)
    over = vector.over(hull(enclose(low), enclose(high)))
    for place in (low, high, Fraction(1, 2)):
        at = vector.over(enclose(place))
        assert all(agree(a, b) for a, b in zip(over, at, strict=True))
        wide = other.over(enclose(place))
        known = Moving(other.known, (arb(0),) * 3).over(enclose(place))
        left = vector.less(arb(-2), other).over(enclose(place))
        for a, b, bound, both, own in zip(wide, known, other.errors, left, at, strict=True):
            for side in (1, -1):
                assert a.contains(b + side * bound * arb("0.999"))
                assert both.contains(own + 2 * (b + side * bound * arb("0.999")))


@pytest.mark.parametrize("planes", [1, 2])
def test_half_turns_of_a_way_that_is_known(planes: int) -> None:
    """Vectors exp(i phi) times real ones turn by planes phi; both numbers and the index are those of phi."""
    chance = random.Random(planes)
    real = tuple(tuple(acb(value.real) for value in numbers(chance, planes)) for _ in range(planes))
    for phi in (0.4, 2.0, 4.0, 7.0):
        turn = acb(arb(phi).cos(), arb(phi).sin())
        fixed = tuple(tuple(turn * value for value in row) for row in real)
        angles = (planes * arb(phi), planes * arb(phi))
        negated = tuple(tuple(turn * value * acb(0, 1) for value in row) for row in real)
        found = index_of(angles, (), fixed, negated)
        assert found.planes == planes
        for count, angle in zip((found.fixed, found.negated), found.angles, strict=True):
            assert count < angle < count + planes
            assert agree(angle, planes * arb(phi) / arb.pi())


def test_orbits_of_the_three_body_problem_start_at_all_points_of_a_ball() -> None:
    chance = random.Random(0)
    for system in (CR3BP, CR3BP_PLANAR, AROUND["L1"], VERTICAL["L1"], LIFTED):
        atlas: Any = SimpleNamespace(system=system, parameters={"mu": MU}, claim=SimpleNamespace(crossings=1))
        point = {name: ball(chance, 0.3, 0.6) for name in system.centre_coordinates}

        def started(point: Any, atlas: Any = atlas) -> Any:
            found = _start(atlas, point)
            return None if found is None else (found.state, found.crossings, found.is_planar)

        assert not broken_inclusions(started, (point,), chance), system.name
    for system, name, size in (
        *((each, "eps2", size) for each in (VERTICAL["L1"], LIFTED) for size in ("0", "-1")),
        (AROUND["L1"], "eps", "0"),
    ):
        atlas = SimpleNamespace(system=system, parameters={"mu": MU}, claim=SimpleNamespace(crossings=1))
        point = {each: ball(chance, 0.3, 0.6) for each in system.centre_coordinates}
        assert _start(atlas, point | {name: arb(size, "0.01")}) is None


@pytest.mark.parametrize("system", [*AROUND.values(), *VERTICAL.values()], ids=lambda system: system.name)
@pytest.mark.parametrize("mass", ["1/80", "1/1000", "1/3"])
def test_frequencies_at_rest_are_those_of_the_linear_equations(system: Any, mass: str) -> None:
    """w^4 - (2 - c) w^2 + (1 + 2 c)(1 - c) = 0 in the plane, w^2 = c across it (16.3)."""
    evidence, parameters = Evidence("libration-point"), {"mu": Fraction(mass)}
    known = index_of_small_orbits(evidence, system, parameters)
    plane, across = (evidence.enclosures[f"frequency {place} the plane"] for place in ("in", "out of"))
    c = stiffness_at_rest(system, parameters)
    square = plane * plane
    assert plane > 0
    assert (square * square - (2 - c) * square + (1 + 2 * c) * (1 - c)).contains(0)
    assert agree(across * across, c)
    assert plane.rad() < arb(2) ** -100
    is_planar = system in AROUND.values()
    turns = 2 * int(float(across / plane if is_planar else plane / across)) + 1
    assert known == ((2, turns) if is_planar else (2 + turns,))


def test_a_whole_number_below_a_ratio_is_told_only_between_two() -> None:
    for text, wanted in (("1.5", 1), ("0.99", 0), ("2.01", 2)):
        assert _whole(arb(text)) == wanted
    for middle, radius in (("2", "0.1"), ("1.95", "0.1"), ("2", "0"), ("1.5", "0.6")):
        assert _whole(arb(middle, radius)) is None


def test_the_stability_index_of_balls() -> None:
    chance = random.Random(0)
    for parameters in ((acb(ball(chance, 2, 3)),), (acb(ball(chance, 2, 3)), acb(ball(chance, -9, -8)))):
        for each in (parameters, parameters[::-1]):
            stability: Any = lambda values: SimpleNamespace(parameters=values)  # noqa: E731
            assert not broken_inclusions(lambda values, of=stability: _index(of(values)), (each,), chance)
            sizes = [(abs(c - 1) + abs(c + 1)) / 2 for c in each]
            found = _index(stability(each))
            assert found is not None
            assert agree(found, max(sizes, key=lambda size: float(size.mid())))


# Surfaces, and stability for ever.


def random_sheet(chance: random.Random, size: int = 3) -> Sheet:
    def row() -> tuple[Fraction, ...]:
        return tuple(number(chance) for _ in range(3))

    frame = tuple(tuple(number(chance) + 3 * (i == j) for j in range(size)) for i in range(size))
    piece = SurfacePiece(
        id="p",
        parameters={"h": (Fraction(1), Fraction(1, 2))},
        centre=tuple(row() for _ in range(size)),
        frame=frame,
        kernel_frame=tuple(each[: size - 1] for each in frame[: size - 1]),
        radii=(Fraction(1, 4),) * size,
        tilt=tuple(row() for _ in range(size - 2)),
        bend=tuple(row() for _ in range(size - 1)),
    )
    point = tuple(ball(chance, -0.2, 0.2) + arb(0, 2.0**-10) for _ in range(size))
    parts = tuple(
        ProvedPart(interval, tuple(value + shift for value in point), "above", {})
        for interval, shift in (((Fraction(-1), Fraction(0)), 0), ((Fraction(0), Fraction(1)), arb(1) / 64))
    )
    return Sheet(piece, piece.parameters["h"], parts)


@pytest.mark.parametrize("size", [2, 3, 4])
def test_points_of_a_surface_are_those_of_every_s_and_lead_back(size: int) -> None:
    chance = random.Random(size)
    for _ in range(4):
        sheet = random_sheet(chance, size)
        piece = sheet.piece
        low, high = sorted(number(chance) for _ in range(2))
        points = sheet.point(low, high)
        for s in (low, high, (low + high) / 2):
            part = sheet.parts[0] if s <= 0 else sheet.parts[1]
            p = [value.mid() + chance.choice([-1, 1]) * value.rad() for value in part.point]
            at = enclose(s)
            square = p[1] * p[1]
            bend = [ball_polynomial(row)(at) * square for row in piece.bend]
            tilt = [ball_polynomial(row)(at) * p[0] for row in piece.tilt]
            u = [p[0] + bend[0], p[1], *(p[j] + tilt[j - 2] + bend[j - 1] for j in range(2, size))]
            wanted = [
                ball_polynomial(row)(at) + sum((enclose(a) * b for a, b in zip(each, u, strict=True)), arb(0))
                for row, each in zip(piece.centre, piece.frame, strict=True)
            ]
            assert all(agree(a, b) for a, b in zip(points, wanted, strict=True))
            back = sheet.offsets(low, high, wanted)
            assert all(agree(a, b) for a, b in zip(back, p, strict=True))
        place = sheet.offsets(low, low, points)
        assert len(place) == size
        assert not broken_inclusions(partial(sheet.offsets, low, low), ([value.mid() for value in wanted],), chance)
        value = 1 + number(chance) / 2
        first, last = sheet.place(value)
        assert first <= 2 * (value - 1) <= last


@dataclass(frozen=True)
class Plain:
    """A number as a function that is the same all along a curve."""

    size: arb

    def __add__(self, other: Plain) -> Plain:
        return Plain(self.size + other.size)

    def __sub__(self, other: Plain) -> Plain:
        return Plain(self.size - other.size)

    def __mul__(self, other: Plain) -> Plain:
        return Plain(self.size * other.size)

    def scaled(self, factor: Fraction) -> Plain:
        return Plain(self.size * enclose(factor))


@pytest.mark.parametrize("seed", range(3))
def test_twists_as_functions(seed: int) -> None:
    chance = random.Random(seed)
    indices = [(i, j) for i in range(4) for j in range(4) if 1 < i + j < 4]
    for odd in (False, True):
        s, up = ball(chance, -0.4, 0.9), ball(chance, 0.5, 1)
        terms = [chance.sample([each for each in indices if not odd or sum(each) == 3], 3) for _ in range(2)]

        def found(s: arb, up: arb, values: Any, terms: Any = terms, odd: bool = odd) -> Any:
            linear = {(1, 0): s, (0, 1): (s * s - 1) / up}, {(1, 0): up, (0, 1): s}
            jets = [
                FunctionJet(
                    {key: Plain(value) for key, value in {**first, **dict(zip(own, more, strict=True))}.items()}
                )
                for first, own, more in zip(linear, terms, values, strict=True)
            ]
            form = normal_form(jets[0], jets[1], Plain(s), Plain(arb(1)), odd)
            return form.twist.size, form.fourth.size

        more = [[ball(chance) for _ in range(3)] for _ in range(2)]
        assert not broken_inclusions(found, (s, up, more), chance)


def test_maps_of_the_plane_are_inverted() -> None:
    chance = random.Random(0)
    indices = [(i, j) for i in range(4) for j in range(4) if 0 < i + j < 4]
    even, kernel = (
        FunctionJet({index: Plain(ball(chance) + 2 * (index == unit)) for index in indices})
        for unit in ((1, 0), (0, 1))
    )
    (a, b), (c, d) = ([jet.coefficients[unit].size for unit in ((1, 0), (0, 1))] for jet in (even, kernel))
    back = inverse_of_plane_map(even, kernel, Plain(1 / (a * d - b * c)))
    for place, jet in enumerate(back):
        assert jet.coefficients
        again = compose((even, kernel)[place], back)
        for index, value in again.coefficients.items():
            assert agree(value.size, arb(int(index == ((1, 0), (0, 1))[place])))
