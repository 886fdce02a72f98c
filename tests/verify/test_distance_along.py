"""All extrema of a quantity along half an orbit, against Lemma 19.2 and against polynomials; its rates as programs."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby, pairwise, product
from typing import Any

import mpmath
import pytest
from flint import arb, arb_poly, fmpq, fmpq_poly

from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS, Program, record
from orbitproof.verify.evidence import IntegrationFailure, enclose, hull, sign
from orbitproof.verify.orbit import DistanceAlong, distance_rates, rates_along
from orbitproof.verify.orbit.distance import Step
from orbitproof.verify.poincare.coordinates import physical
from orbitproof.verify.poincare.regularised import regularised

Interval = tuple[str, int]
"""On which D' ("a") or D'' ("b") has that sign."""


@dataclass
class Signs:
    """A function of which nothing but its sign is known."""

    known: int
    middle: int = 0

    def sign(self, left: arb, right: arb) -> int:
        return self.known

    def value(self, where: arb) -> arb:
        return arb(self.middle)


def scripted(number: int, interval: Interval) -> Step:
    letter, s = interval
    rate, curvature = (Signs(s), Signs(0)) if letter == "a" else (Signs(0), Signs(s, s))
    return Step(Signs(0), rate, curvature, arb(1), lambda theta: number + theta)  # type: ignore[arg-type]


def by_the_lemma(
    word: tuple[Interval, ...], half_period: Fraction
) -> tuple[int, list[tuple[int, list[int]]], int] | None:
    """The kinds at the ends, and of the extrema in between with the intervals that may hold them."""
    runs = [[*group] for _, group in groupby(enumerate(word), key=lambda item: item[1][0])]
    letters, signs = [run[0][1][0] for run in runs], [{s for _, (_, s) in run} for run in runs]
    if letters[0] == "a" or letters[-1] == "a" or len(runs) < 3 or any(len(found) > 1 for found in signs):
        return None
    kinds = [found.pop() for found in signs]
    between = []
    for before, run, after in zip(range(1, len(runs), 2), range(2, len(runs), 2), range(3, len(runs), 2), strict=False):
        if kinds[before] != kinds[after]:
            if kinds[run] != kinds[after]:
                return None
            between.append((kinds[run], [number for number, _ in runs[run]]))
    clear = runs[-1][0][0]
    if kinds[0] != kinds[1] or kinds[-1] != -kinds[-2] or not clear < half_period < len(word):
        return None
    return kinds[0], between, kinds[-1]


def test_what_is_found_is_what_the_lemma_says() -> None:
    """All ways in which up to six intervals cover half an orbit."""
    accepted = 0
    for length in range(1, 7):
        for word in product([("a", 1), ("a", -1), ("b", 1), ("b", -1)], repeat=length):
            along = DistanceAlong()
            refused = False
            try:
                for number, interval in enumerate(word):
                    along.cover(scripted(number, interval))
            except IntegrationFailure:
                refused = True
            last = max((number + 1 for number, (letter, _) in enumerate(word) if letter == "a"), default=0)
            for half_period in {Fraction(last), last + Fraction(1, 2), length - Fraction(1, 2), Fraction(length)}:
                expected = by_the_lemma(word, half_period)
                try:
                    end = None if refused else along.end_kind(enclose(half_period), arb(length))
                except IntegrationFailure:
                    end = None
                if end is None or expected is None:
                    assert end is None, (word, half_period)
                    assert expected is None, (word, half_period)
                    continue
                accepted += 1
                start, between, finish = expected
                assert (along.start_kind, [each.kind for each in along.found], end) == (
                    start,
                    [k for k, _ in between],
                    finish,
                )
                for each, (_, places) in zip(along.found, between, strict=True):
                    assert all(each.time.contains(arb(place + 0.5)) for place in places)
    assert accepted > 20


@dataclass
class Family:
    """The hull of functions of theta, each a polynomial."""

    members: tuple[arb_poly, ...]

    def value(self, where: arb) -> arb:
        middle = where.mid()
        return hull(*(poly(middle) + poly.derivative()(where) * (where - middle) for poly in self.members))

    def sign(self, left: arb, right: arb) -> int:
        return sign(self.value(left.union(right)))


def rational(value: Fraction) -> fmpq:
    return fmpq(value.numerator, value.denominator)


def with_extrema(zeros: list[Fraction], lead: int) -> fmpq_poly:
    """D with D' = lead t (t - 1) (t - z_1) .."""
    slope = lead * fmpq_poly([0, 1]) * fmpq_poly([-1, 1])
    for zero in zeros:
        slope = slope * fmpq_poly([-rational(zero), 1])
    return slope.integral() + 3


def followed(members: list[fmpq_poly], cuts: list[Fraction], half_period: arb) -> tuple[DistanceAlong, int]:
    """Over steps between the cuts; the system's time is three times that of the integration."""
    along = DistanceAlong()
    for left, right in pairwise(cuts):
        inner = fmpq_poly([rational(left), rational(right - left)])

        def over(order: int, inner: fmpq_poly = inner) -> Family:
            found = members
            for _ in range(order):
                found = [poly.derivative() for poly in found]
            return Family(tuple(arb_poly(poly(inner)) for poly in found))

        start, length = enclose(left), enclose(right - left)
        time = lambda theta, start=start, length=length: 3 * (start + length * theta)  # noqa: E731
        along.cover(Step(over(0), over(1), over(2), length, time))  # type: ignore[arg-type]
    return along, along.end_kind(half_period, 3 * enclose(cuts[-1]))


def test_the_extrema_of_a_family_of_polynomials_are_enclosed() -> None:
    """Those of each member, also where a joint of two steps is near them."""
    source = random.Random(5)
    shift = Fraction(1, 2**12)
    for _ in range(60):
        zeros = sorted(Fraction(k, 16) for k in source.sample(range(2, 15, 3), source.randint(0, 3)))
        lead = source.choice((-2, 1))
        moved = [[zero + s * shift for zero in zeros] for s in (-1, 1)]
        members = [with_extrema(each, lead) for each in moved]
        others = {Fraction(source.randint(1, 99), 100) for _ in range(source.randint(0, 4))}
        cuts = sorted({Fraction(0), *others, *source.sample(zeros, len(zeros) // 2 + len(zeros) % 2), Fraction(65, 64)})
        along, end = followed(members, cuts, arb(3))
        for places, poly in zip(moved, members, strict=True):
            bend = poly.derivative().derivative()
            kinds = [1 if bend(rational(place)) > 0 else -1 for place in (Fraction(0), *places, Fraction(1))]
            assert (along.start_kind, *(each.kind for each in along.found), end) == tuple(kinds)
            for each, place in zip(along.found, places, strict=True):
                assert each.time.contains(3 * rational(place))
                assert each.value.contains(poly(rational(place)))
                assert each.time.rad() < 1e-2


@pytest.mark.parametrize("length", [Fraction(1, 8), Fraction(1), Fraction(16)])
def test_the_value_at_an_extremum_is_that_of_each_function_however_long_the_step_is(length: Fraction) -> None:
    """3 x^2 + b x and 3 x^2 - b x, x = theta - 1/2: both are 0 in the middle of their zeros of the rate."""
    x = fmpq_poly([fmpq(-1, 2), 1])
    for b in (fmpq(1, 4), fmpq(1, 2**20)):
        members = [3 * x * x + sign_ * b * x for sign_ in (1, -1)]
        functions = []
        for _ in range(3):
            functions.append(Family(tuple(map(arb_poly, members))))
            members = [poly.derivative() / rational(length) for poly in members]
        step = Step(*functions, enclose(length), lambda theta: theta * enclose(length))  # type: ignore[arg-type]
        found = step.zero(arb(0), arb(1))
        assert found is not None
        for place in (fmpq(1, 2) - b / 6, fmpq(1, 2) + b / 6):
            assert found.time.contains(place * rational(length))
        assert found.value.contains(-b * b / 12)
        assert found.value.rad() < 4 * b * b


@pytest.mark.parametrize(
    "slope",
    [
        # Stationary at 1/2 without an extremum; two extrema closer than can be told; constant.
        [0, -1, 5, -8, 4],
        [0, -1, 5 + fmpq(1, 2**40), -8 - fmpq(1, 2**40), 4],
        [0],
    ],
)  # fmt: skip
def test_what_is_nearly_stationary_is_not_classified(slope: list[Any]) -> None:
    with pytest.raises(IntegrationFailure, match="hardly changes"):
        followed([fmpq_poly(slope).integral()], [Fraction(0), Fraction(1, 3), Fraction(65, 64)], arb(3))


MU = MASS_PARAMETERS["earth-moon"]
STATE = (0.9, 0.1, 0.2, -0.3, 0.4, 0.5)

Case = tuple[Program, Callable[[Sequence[Any], Sequence[Any]], Any], Program, list[Any]]
"""A field, the quantity as a function of the state that it moves, the rates, and inputs."""

NUMBER = lambda value: mpmath.mpf(value.numerator) / value.denominator  # noqa: E731
POWER = lambda base, exponent: mpmath.power(base, NUMBER(exponent))  # noqa: E731


def _case(name: str) -> Case:
    if name == "another":
        field = record(
            lambda s, p: (s[2] * s[0] ** Fraction(1, 2), s[3] / s[0], s[0] - p[1] / s[1], p[0] * s[1] - s[0] ** 3),
            ("x", "y", "vx", "vy"), ("b", "c"),
        )  # fmt: skip
        other = lambda s, p: s[0] * s[1] + p[0] * s[0] ** 3 / s[1] - (p[1] - s[0]) ** 2 * s[3] ** 2  # noqa: E731
        values = 1.5, 0.75, 0.3, -0.4, 0.7, 1.9
        return field, other, rates_along(field, 4, other), [mpmath.mpf(value) for value in values]
    coordinates = physical(CR3BP) if name == "physical" else regularised(CR3BP, STATE, [float(MU)])
    assert coordinates is not None
    regularisation = coordinates.regularisation
    source = random.Random(1)
    inputs = [mpmath.mpf(source.uniform(0.2, 0.8)) for _ in coordinates.field.inputs]

    def squared(state: Sequence[Any], constants: Sequence[Any]) -> Any:
        parameters = constants[:1]
        if regularisation is not None:
            state = regularisation.projection_program.evaluate([*state, *parameters], NUMBER, POWER)
        assert CR3BP.squared_distance_program is not None
        return CR3BP.squared_distance_program.evaluate([*state, *parameters], NUMBER, POWER)[0]

    return coordinates.field, squared, distance_rates(CR3BP, coordinates), inputs


@pytest.mark.parametrize("name", ["physical", "regularised", "another"])
def test_rates_are_derivatives_along_orbits(name: str) -> None:
    """Of D along x + f t + f' f t^2/2, differentiated numerically."""
    with mpmath.workdps(60):
        program, quantity, rates, inputs = _case(name)
        size = len(program.outputs)
        state, constants = inputs[:size], inputs[size:]

        def field(at: list[Any]) -> list[Any]:
            return list(program.evaluate([*at, *constants], NUMBER, POWER))

        def along(time: Any) -> Any:
            moved = (x + f * time + g * time**2 / 2 for x, f, g in zip(state, first, second, strict=True))
            return quantity([*moved], constants)

        first = field(state)
        second = [
            mpmath.diff(lambda e, i=i: field([x + e * f for x, f in zip(state, first, strict=True)])[i], 0)
            for i in range(size)
        ]
        for order, value in enumerate(rates.evaluate(inputs, NUMBER, POWER)):
            expected = mpmath.diff(along, 0, order)
            assert abs(value - expected) < 1e-15 * max(1, abs(expected))
            assert abs(expected) > 1e-3
