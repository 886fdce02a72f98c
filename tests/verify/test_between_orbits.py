"""Extrema between certified orbits: narrower values that are true, and orbits that contradict the curve refused."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import acb, arb, arb_poly, ctx
from support.flow_checks import ball
from support.within import within

from orbitproof.verify.curve import Bifurcation, PlaceOnCurve
from orbitproof.verify.evidence import EmptyIntersectionError
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.stability import Extremum, Gap, Matter, Segment, extrema_on, is_in_band
from orbitproof.verify.stability.between_orbits import between_orbits

ERROR = 1e-5
APART = Fraction(1, 10**9)

_precision = within(lambda: ctx.workprec(200))


class Curve:
    """A segment whose stability parameters are polynomials of s, known up to `ERROR`: one turns, one is large."""

    def __init__(self, seed: int, alone: bool = False, middle: Fraction = Fraction(0), radius: Fraction = Fraction(1)):
        self.middle, self.radius = middle, radius
        source = random.Random(seed)
        self.place = Fraction(source.randint(-60, 60), 100) + Fraction(1, 10**7)
        self.value = -1 - Fraction(source.randint(1, 9), 10**5)
        shift = arb_poly([-ball(self.place), 1])
        turning = shift * shift * arb_poly([source.choice((1, -1)), arb(1) / 4]) + arb_poly([ball(self.value)])
        self.parameters = [turning] if alone else [turning, arb_poly([40, -3, 7])]
        flat = BoundedFunction(arb_poly([0]), arb(0))
        products = [turning] if alone else [turning + self.parameters[1], turning * self.parameters[1]]
        characteristic = tuple(BoundedFunction(f, arb(ERROR)) for f in products)
        self.segment = Segment(
            0,
            *(middle + side * radius / REACH for side in (-1, -1, 1)),
            middle,
            radius,
            characteristic,
            flat,
            flat,
            flat,
        )
        found, undecided = extrema_on(self.segment, 0)
        self.gaps = [
            Gap(0, "p", middle + radius * low, middle + radius * high, Matter.EXTREMA, "") for low, high in undecided
        ]
        self.extrema = [
            Extremum(0, "p", height, is_in_band(height), self.segment.s_of(tau), arb(0), arb(1))
            for tau, height in found
        ]

    @property
    def listed(self) -> Extremum:
        (entry,) = [entry for entry in self.extrema if entry.s.contains(ball(self.middle + self.radius * self.place))]
        return entry

    def orbit(self, tau: Fraction, piece: str = "p", shift: Fraction = Fraction(0)) -> Bifurcation:
        """The certified orbit at tau, of which is said that its stability parameters are larger by `shift`."""
        values = tuple(acb(polynomial(ball(tau)) + ball(shift)) for polynomial in self.parameters)
        s = self.middle + self.radius * tau
        place = PlaceOnCurve(piece, ball(s) + arb(0, 1) / 10**25, False)
        return Bifurcation(f"orbit at {float(s)}", "orbit", 1, place, "", {}, stability=values[::-1])

    def beside(self, distance: Fraction = APART) -> list[Bifurcation]:
        """Three orbits, the middle one at the extremum."""
        return [self.orbit(self.place + side * distance) for side in (1, 0, -1)]

    def narrowed(self, orbits: list[Bifurcation], pieces: tuple[str, ...] = ("p",)) -> list[Extremum]:
        return list(between_orbits(self.extrema, self.gaps, [self.segment], pieces, orbits))


@pytest.mark.parametrize("alone", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_three_orbits_show_the_value_between_them_to_many_digits(seed: int, alone: bool) -> None:
    curve = Curve(seed, alone)
    before = curve.listed
    (entry,) = [entry for entry in curve.narrowed(curve.beside()) if entry.certificates]
    assert before.value.rad() > 1e-6
    assert entry.value.contains(ball(curve.value))
    assert entry.s.contains(ball(curve.place))
    assert entry.value.rad() < 1e-15
    assert entry.s.rad() < 2e-9
    assert before.value.contains(entry.value)
    assert len(entry.certificates) == 3
    assert len(entry.certificates) == 3
    assert not before.certificates


@pytest.mark.parametrize("seed", range(12))
def test_the_value_is_true_wherever_the_orbits_lie_around_it(seed: int) -> None:
    curve, source = Curve(seed), random.Random(seed + 100)
    offsets = sorted(Fraction(source.randint(-(10**6), 10**6), 10**12) for _ in range(7))
    (entry,) = curve.narrowed([curve.orbit(curve.place + offset) for offset in offsets])
    assert entry.s.contains(ball(curve.place))
    assert entry.value.contains(ball(curve.value))


def test_orbits_on_one_side_of_it_say_nothing_more() -> None:
    curve = Curve(1)
    orbits = [curve.orbit(curve.place + number * APART) for number in (1, 2, 3)]
    assert curve.narrowed(orbits) == curve.extrema
    assert curve.narrowed(curve.beside()[:2]) == curve.extrema


def test_orbits_that_are_not_on_this_piece_or_nowhere_say_nothing() -> None:
    curve = Curve(2)
    orbits = curve.beside()
    assert curve.narrowed(orbits, ("another",)) == curve.extrema
    assert curve.narrowed([replace(entry, place=None) for entry in orbits]) == curve.extrema
    assert curve.narrowed([replace(entry, kind="doubling") for entry in orbits]) == curve.extrema
    beyond = [replace(entry, place=PlaceOnCurve("p", arb(2), False)) for entry in orbits]
    assert curve.narrowed(beyond) == curve.extrema


def test_orbits_before_the_curve_enters_a_piece_say_nothing() -> None:
    curve = Curve(2)
    curve.segment = replace(curve.segment, entered=curve.place + 2 * APART)
    curve.extrema = []
    assert curve.narrowed(curve.beside()) == []
    curve.segment = replace(curve.segment, entered=curve.place - 2 * APART)
    with pytest.raises(EmptyIntersectionError, match="the list does not have"):
        curve.narrowed(curve.beside())


def test_orbits_with_complex_or_missing_stability_parameters_say_nothing() -> None:
    curve = Curve(3)
    orbits = curve.beside()
    assert curve.narrowed([replace(entry, stability=()) for entry in orbits]) == curve.extrema
    turned = [replace(entry, stability=tuple(value + acb(0, 1) for value in entry.stability)) for entry in orbits]
    assert curve.narrowed(turned) == curve.extrema
    for number in range(2):
        turned = [
            replace(entry, stability=tuple(v + acb(0, n == number) for n, v in enumerate(entry.stability)))
            for entry in orbits
        ]
        assert curve.narrowed(turned) == curve.extrema


def test_orbits_with_other_stability_parameters_contradict_the_curve() -> None:
    curve = Curve(4)
    orbits = [curve.orbit(curve.place + side * APART, shift=Fraction(1, 1000)) for side in (-1, 0, 1)]
    with pytest.raises(EmptyIntersectionError, match="other stability parameters"):
        curve.narrowed(orbits)


def test_an_extremum_that_is_not_listed_is_a_contradiction_unless_it_is_open_there() -> None:
    curve = Curve(5)
    orbits = curve.beside()
    curve.extrema = [entry for entry in curve.extrema if entry is not curve.listed]
    with pytest.raises(EmptyIntersectionError, match="the list does not have"):
        curve.narrowed(orbits)
    curve.gaps.append(Gap(0, "p", curve.place - 1, curve.place + 1, Matter.EXTREMA, "bounds too wide"))
    assert curve.narrowed(orbits) == curve.extrema


def test_an_extremum_is_left_as_it_is_where_there_may_be_more() -> None:
    curve = Curve(6)
    curve.gaps.append(Gap(0, "p", curve.place, curve.place + APART, Matter.EXTREMA, "bounds too wide"))
    assert curve.narrowed(curve.beside()) == curve.extrema
    curve.gaps.clear()
    curve.extrema += [curve.listed]
    assert curve.narrowed(curve.beside()) == curve.extrema


def test_a_listed_value_that_is_forged_is_a_contradiction() -> None:
    curve = Curve(7)
    wrong = replace(curve.listed, value=curve.listed.value + 1)
    curve.extrema = [wrong if entry is curve.listed else entry for entry in curve.extrema]
    with pytest.raises(EmptyIntersectionError, match="another extremum"):
        curve.narrowed(curve.beside())


def test_nothing_is_said_where_the_stability_parameters_may_meet() -> None:
    curve = Curve(8)
    close = curve.parameters[0] + arb_poly([ball(Fraction(1, 10**12))])
    curve.parameters = [curve.parameters[0], close]
    products = (curve.parameters[0] + close, curve.parameters[0] * close)
    characteristic = tuple(BoundedFunction(f, arb(ERROR)) for f in products)
    curve.segment = replace(curve.segment, characteristic=characteristic)
    assert curve.narrowed(curve.beside()) == curve.extrema


@pytest.mark.parametrize("alone", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_the_value_is_true_on_intervals_of_any_length(seed: int, alone: bool) -> None:
    """The middle one of the orbits is far from the extremum, as far as one may be that shows it."""
    source = random.Random(seed + 200)
    middle, radius = Fraction(source.randint(-40, 40), 64), Fraction(1, 2 ** source.randint(1, 8))
    curve = Curve(seed, alone, middle, radius)
    side, apart = source.choice((-1, 1)), Fraction(1, 10**3)
    offsets = [Fraction(-102, 100), Fraction(1), Fraction(102, 100)]
    found = curve.narrowed([curve.orbit(curve.place + side * apart * offset) for offset in offsets])
    (entry,) = [entry for entry in found if entry.certificates]
    assert entry.value.contains(ball(curve.value))
    assert entry.s.contains(ball(middle + radius * curve.place))
    # Beyond the curve's own error.
    assert entry.value.rad() < 1e-4


def test_each_parameter_turns_by_itself_and_beyond_the_band_nothing_is_said() -> None:
    """The larger parameter turns at the value 40, where the smaller one does not."""
    curve = Curve(9)
    low = arb_poly([arb(-1) / 2, 1])
    for height, told in ((arb(40), False), (arb(1), True)):
        high = arb_poly([height, 0, 1])
        curve.parameters = [low, high]
        characteristic = tuple(BoundedFunction(f, arb(ERROR)) for f in (low + high, low * high))
        curve.segment, curve.gaps = replace(curve.segment, characteristic=characteristic), []
        for listed in (True, False):
            curve.extrema = [Extremum(0, "p", arb(1, 1e-3), True, arb(0, 1e-3), arb(0), arb(1))] if listed else []
            orbits = [curve.orbit(side * Fraction(1, 10**4)) for side in (-1, 0, 1)]
            if told and not listed:
                with pytest.raises(EmptyIntersectionError, match="the list does not have"):
                    curve.narrowed(orbits)
                continue
            found = curve.narrowed(orbits)
            assert [bool(entry.certificates) for entry in found] == [told] * listed
            assert all(entry.value.contains(1) for entry in found)


def test_extrema_and_gaps_of_other_parts_are_no_answer() -> None:
    curve = Curve(5)
    orbits, listed, gaps = curve.beside(), curve.listed, curve.gaps
    curve.extrema = [replace(listed, stretch=1)]
    with pytest.raises(EmptyIntersectionError, match="the list does not have"):
        curve.narrowed(orbits)
    curve.gaps = [*gaps, Gap(1, "q", curve.place - 1, curve.place + 1, Matter.EXTREMA, "")]
    with pytest.raises(EmptyIntersectionError, match="the list does not have"):
        curve.narrowed(orbits)
    # Nor are those elsewhere on the same part.
    curve.extrema = [replace(listed, s=listed.s + arb(1) / 8)]
    curve.gaps = [
        Gap(0, "p", curve.place + side, curve.place + side, Matter.EXTREMA, "") for side in (-APART * 4, APART * 4)
    ]
    with pytest.raises(EmptyIntersectionError, match="the list does not have"):
        curve.narrowed(orbits)
    curve.extrema = [listed]
    (entry,) = curve.narrowed(orbits)
    assert entry.certificates


def test_orbits_in_no_certain_order_say_nothing() -> None:
    """Neither along the curve, nor their parameters."""
    curve = Curve(5)
    curve.extrema, curve.gaps = [], []
    orbits = curve.beside()
    for wide in range(3):
        moved = list(orbits)
        place = moved[wide].place
        assert place is not None
        moved[wide] = replace(moved[wide], place=replace(place, s=place.s + arb(0, 1) * ball(3 * APART / 2)))
        assert curve.narrowed(moved) == []
    # Nearer and nearer to the extremum; the last parameter may be beyond that of the one before.
    for far in ((3, 2, 1), (1, 2, 3)):
        near = [curve.orbit(curve.place + share * APART) for share in far]
        for number in (0, 2):
            unsure = tuple(value + acb(arb(0, 1) * ball(100 * APART * APART)) for value in near[number].stability)
            moved = [replace(each, stability=unsure) if n == number else each for n, each in enumerate(near)]
            assert curve.narrowed(moved) == []
    # c = tau - 1 and c + 1/20; which of the two is the smaller one is not known at the first orbit.
    first, second = arb_poly([-1, 1]), arb_poly([arb(-19) / 20, 1])
    curve.parameters = [first, second]
    characteristic = tuple(BoundedFunction(f, arb(ERROR)) for f in (first + second, first * second))
    curve.segment = replace(curve.segment, characteristic=characteristic)
    near = [curve.orbit(side * Fraction(1, 10**5)) for side in (-1, 0, 1)]
    low, high = sorted((value.real for value in near[0].stability), key=float)
    near[0] = replace(near[0], stability=(acb(high), acb(low + arb(1) / 16 + arb(0, 1) / 8)))
    assert curve.narrowed(near) == []
