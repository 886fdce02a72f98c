"""Periodic orbits without symmetry and their bifurcations: what holds for balls holds for each of their points."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import acb, arb
from support.balls import agree
from support.inclusion import Refused, broken_inclusions
from support.known_returns import WIDTH, KnownReturn, contains_all, known_return, outcome_of
from support.other_coordinates import dot, mixing
from support.thresholds import unsound_balls
from support.within import within

from orbitproof.shared.formats import PeriodicBifurcation, PeriodicOrbit, define_system
from orbitproof.verify.claim import inverse, is_free_of_divergence
from orbitproof.verify.evidence import NotProved, Outcome, Proved, enclose, guarded
from orbitproof.verify.periodic import (
    Linearised,
    PeriodicEnclosures,
    PeriodicResults,
    gradient_on,
    multipliers_of,
    on_level,
    section_coordinates,
    slopes_along,
    state_on_box,
)
from orbitproof.verify.periodic.box import parameters_on_box, values_on
from orbitproof.verify.periodic.multipliers import _with_real_ones

BITS = 160
ZERO, ONE = Fraction(0), Fraction(1)

precision = within(lambda: guarded(BITS))


def numbers(count: int, chance: random.Random, size: float = 1.0) -> list[arb]:
    return [arb(chance.uniform(-size, size)) for _ in range(count)]


MIXED = replace(
    define_system(
        {
            "name": "mixed", "state": "x y z", "parameters": "b a c",
            "field": {"x": "b*x**2 - y/z", "y": "a*z - c*x", "z": "x*y + a**2 - b"},
        }
    ),
    first_integral=lambda state, values: (_height(state, values),),
)  # fmt: skip
"""Parameters in no order of their names; the first integral is none, but a function of the state."""


def _height(state: Sequence[Any], values: Sequence[Any]) -> Any:
    (x, y, z), (b, a, c) = state, values
    return b * x**2 * y + a * y * z - c * z**3 + x / z


def _claim(chance: random.Random, varying: bool = False) -> PeriodicOrbit | PeriodicBifurcation:
    """A box in a tilted section, its frame without any symmetry."""
    whole = mixing(3, chance)
    back = inverse(whole)
    assert back is not None
    centre = tuple(Fraction(chance.randint(8, 24) * chance.choice((-1, 1)), 4) for _ in range(3))
    claim: dict[str, Any] = {
        "id": "mixed", "system": MIXED, "parameters": {"a": Fraction(3, 4), "c": Fraction(-5, 2), "b": Fraction(7, 8)},
        "normal": tuple(back[-1]), "offset": dot(back[-1], centre), "direction": 1, "crossings": 1, "centre": centre,
        "frame": tuple(row[:-1] for row in whole), "radii": (Fraction(1, 32), Fraction(1, 64)),
    }  # fmt: skip
    if not varying:
        return PeriodicOrbit(**claim)
    more = {
        "kind": "periodic-fold",
        "kernel": ((ONE, ZERO),),
        "kernel_radius": ONE,
        "parameter_radius": Fraction(1, 16),
    }
    return PeriodicBifurcation(**claim, **more, parameter="c")


@pytest.mark.parametrize("varying", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_functions_on_a_box_contain_their_values_at_all_of_its_points(seed: int, varying: bool) -> None:
    chance = random.Random(seed)
    claim = _claim(chance, varying)
    coordinates, integral = section_coordinates(claim), MIXED.first_integral_program
    assert coordinates is not None
    assert integral is not None
    state, parameters = state_on_box(claim), parameters_on_box(claim)
    fields, slopes = values_on(MIXED.program, claim, state), gradient_on(integral, claim, state)
    for _ in range(12):
        p = [radius * chance.choice((-1, 1)) for radius in claim.radii]
        x, y, z = (middle + dot(row, p) for middle, row in zip(claim.centre, claim.frame, strict=True))
        b, a, c = (claim.parameters[name] for name in "bac")
        c += chance.choice((-1, 1)) * Fraction(1, 16) * varying
        exact = [b * x * x - y / z, a * z - c * x, x * y + a * a - b]
        gradient = [2 * b * x * y + 1 / z, b * x * x + a * z, a * y - 3 * c * z * z - x / z**2]
        along = [dot(gradient, column) for column in zip(*claim.frame, strict=True)]
        own = coordinates.of([enclose(value - middle) for value, middle in zip((x, y, z), claim.centre, strict=True)])
        for balls, values in (
            (state, (x, y, z)), (parameters, (b, a, c)), (fields, exact), (slopes, along), (own, p),
            (state_on_box(claim, list(map(enclose, p))), (x, y, z)),
        ):  # fmt: skip
            assert all(agree(ball, enclose(value)) for ball, value in zip(balls, values, strict=True))


def test_each_part_of_what_is_found_depends_on_the_balls_that_it_is_found_from() -> None:
    chance = random.Random(1)
    claim, integral = _claim(chance), MIXED.first_integral_program
    coordinates = section_coordinates(claim)
    assert coordinates is not None
    assert integral is not None
    assert not broken_inclusions(coordinates.of, (numbers(3, chance),), chance)
    assert not broken_inclusions(lambda sides: state_on_box(claim, sides), (numbers(2, chance),), chance)
    columns = list(zip(*claim.frame, strict=True))

    def slopes(state: Any, parameters: Any) -> Any:
        return slopes_along(integral, state, parameters, columns)

    place = [enclose(x) for x in claim.centre], numbers(3, chance)
    assert not broken_inclusions(slopes, place, chance)

    def value(centre: arb, slopes: Any, where: Any) -> arb:
        return Linearised(centre, tuple(slopes)).value(where)

    assert not broken_inclusions(value, (arb(0.3), numbers(3, chance), numbers(3, chance)), chance)
    matrix = [numbers(3, chance) for _ in range(3)]
    for dropped in range(3):
        assert not broken_inclusions(lambda m, s, d=dropped: on_level(m, s, d), (matrix, numbers(3, chance)), chance)


def _conjugated(change: Sequence[Sequence[Fraction]], middle: Sequence[Sequence[arb]]) -> list[list[arb]]:
    back = inverse(change)
    assert back is not None
    half = [[dot([enclose(a) for a in row], column) for column in zip(*middle, strict=True)] for row in change]
    return [[dot(row, [enclose(a) for a in column]) for column in zip(*back, strict=True)] for row in half]


@pytest.mark.parametrize(("size", "turns"), [(1, False), *((n, turns) for n in (2, 3, 4) for turns in (False, True))])
def test_eigenvalues_of_all_matrices_between_two_are_enclosed_and_counted(size: int, turns: bool) -> None:
    """One eigenvalue moves, or the angle of a pair does: at both ends all are in the balls, and counted as they lie."""
    for seed in range(4):
        chance = random.Random(f"{size} {turns} {seed}")
        change = mixing(size, chance)
        values = chance.sample([-3.0, -1.5, -0.5, 0.25, 0.75, 2.0, 4.0], size)
        angle, modulus = chance.uniform(0.4, 2.7), chance.choice((0.5, 1.25))

        def between(by: arb, values: Any = values, angle: Any = angle, modulus: Any = modulus) -> Any:
            middle = [[arb(values[i] if i == j else 0) for j in range(size)] for i in range(size)]
            middle[0][0] += by
            if turns:
                real, imaginary = modulus * (arb(angle) + by).cos(), modulus * (arb(angle) + by).sin()
                middle[0][:2], middle[1][:2] = [real, -imaginary], [imaginary, real]
            return middle

        ends = [_conjugated(change, between(sign * arb(2) ** -20)) for sign in (-1, 1)]
        wide = [[a.union(b) for a, b in zip(*rows, strict=True)] for rows in zip(*ends, strict=True)]
        found, at = multipliers_of(wide, 1, False), [multipliers_of(end, 1, False) for end in ends]
        if size == 4 and not found.values:
            assert (found.inside, found.on, found.outside, found.undecided) == (0, 0, 0, 4)
            continue
        assert len(found.values) == size
        for end in at:
            assert (end.inside, end.outside) == (found.inside, found.outside)
            assert all(any(agree(ball, value) for ball in found.values) for value in end.values)
        if not turns:
            assert found.inside == sum(abs(value) < 1 for value in values)
            assert all(ball.imag.is_zero() for ball in found.values)


def test_eigenvalues_near_the_circle_and_those_that_are_not_found_are_not_counted() -> None:
    chance = random.Random(2)
    for size in (1, 2, 3):
        for value in (1.0, -1.0):
            middle = [[arb(0.0) for _ in range(size)] for _ in range(size)]
            for i in range(size):
                middle[i][i] = arb(value, 2.0**-30) if i == 0 else arb(0.25 * (i + 1))
            found = multipliers_of(_conjugated(mixing(size, chance), middle), 1, False)
            assert (found.undecided, found.outside, found.on) == (size if not found.values else 1, 0, 0)
            assert not found.is_attracting
            assert not found.is_hyperbolic
    unknown = [[arb(0, 5), arb(1)], [arb(-1), arb(0, 5)]]
    for keeps_volume in (False, True):
        found = multipliers_of(unknown, 1, keeps_volume)
        assert (found.inside, found.on, found.outside) == (0, 0, 0) or not found.values
        assert not found.is_attracting
        assert not found.is_hyperbolic


def test_eigenvalues_are_called_real_if_no_other_one_may_be_their_conjugate() -> None:
    """Of three the two that are not told apart, wherever they stand, and a pair beside a real one."""
    cluster = acb(arb(1, 0.125), arb(0, 0.125))
    up, down = acb(arb(-2, 0.01), arb(1, 0.01)), acb(arb(-2, 0.01), arb(-1, 0.01))
    alone = acb(arb(4, 0.01), arb(0, 0.01))
    for values in itertools.permutations([alone, cluster, cluster, up, down], 4):
        for value, found in zip(values, _with_real_ones(values), strict=True):
            is_alone = value is alone or (value is cluster and sum(each is cluster for each in values) == 1)
            assert found.imag.is_zero() is is_alone
            assert agree(found.real, value.real)
            assert is_alone or agree(found.imag, value.imag)


CASES = [(1, False), (2, False), (3, False), (2, True), (3, True)]


@pytest.mark.parametrize(("size", "on_a_level"), CASES)
def test_returns_are_proved_with_all_that_is_known(size: int, on_a_level: bool) -> None:
    for seed in range(3):
        known = known_return(random.Random(f"{size} {on_a_level} {seed}"), size, on_a_level, crossings=(1, 6)[seed % 2])
        claim = known.claim
        outcome = outcome_of(claim, known.enclosures)
        assert isinstance(outcome, Proved), outcome.reason
        found = outcome.results
        for name, middle, row in zip(claim.system.state, claim.centre, claim.frame, strict=True):
            assert agree(found.point[name], enclose(middle + dot(row, known.fixed)))
            assert found.point[name].rad() < 2.0**-80
        assert agree(found.period, enclose(known.time[0] + dot(known.time[1:], known.fixed)))
        assert contains_all(found.multipliers.values, known.others)
        assert found.multipliers.inside == sum(abs(value) < 1 for value in known.others)
        assert (found.multipliers.trivial, found.multipliers.undecided) == (1 + on_a_level, 0)
        assert (found.level is None) is not on_a_level
        if on_a_level:
            assert found.level is not None
            assert agree(found.level, enclose(claim.level or ZERO))


def _outcome(known: KnownReturn) -> Outcome[PeriodicResults]:
    return outcome_of(known.claim, known.enclosures)


def _with(found: PeriodicEnclosures, numbers: Any) -> PeriodicEnclosures:
    """The numbers of the returns in their places."""
    returns = [
        replace(each, image=tuple(Linearised(c, tuple(s)) for c, s in image), time=Linearised(time[0], tuple(time[1])))
        for each, (image, time) in zip(found.returns, numbers, strict=True)
    ]
    return replace(found, returns=tuple(returns))


def _numbers(found: PeriodicEnclosures) -> Any:
    return [
        ([(f.centre, list(f.slopes)) for f in each.image], (each.time.centre, list(each.time.slopes)))
        for each in found.returns
    ]


@pytest.mark.parametrize(("size", "on_a_level"), CASES)
def test_what_is_proved_of_returns_in_balls_holds_for_each_of_them(size: int, on_a_level: bool) -> None:
    chance = random.Random(f"{size} {on_a_level}")
    known = known_return(chance, size, on_a_level, crossings=6)
    given = known.enclosures

    def results(numbers: Any) -> Any:
        outcome = outcome_of(known.claim, _with(given, numbers))
        if isinstance(outcome, NotProved):
            return Refused()
        found = outcome.results
        # Of eigenvalues in any order what does not depend on it.
        values = found.multipliers.values
        sums = [sum((value**n for value in values), acb(0)) for n in range(1, size + 1)] if values else None
        shown = [dict(hypothesis.enclosures) for hypothesis in outcome.hypotheses]
        return dict(found.point), found.period, sums, shown

    last = len(given.returns) - 1
    for place, size_of_balls in ((0, arb(2) ** -36), (1, arb(2) ** -8)):
        # Centres, then slopes, of the image and of the time.
        assert not broken_inclusions(
            results, (_numbers(given),), chance, 10, size_of_balls,
            lambda path, place=place: path[1] == last and path[4 if path[2] == 0 else 3] == place,
        ), place  # fmt: skip


@pytest.mark.parametrize(("size", "on_a_level"), CASES)
def test_returns_that_are_refused_are_refused_in_balls_too(size: int, on_a_level: bool) -> None:
    chance = random.Random(f"{size} {on_a_level}")
    known = known_return(chance, size, on_a_level, crossings=6)
    given = known.enclosures

    def proves(numbers: Any) -> bool:
        return isinstance(outcome_of(known.claim, _with(given, numbers)), Proved)

    last = len(given.returns) - 1
    assert not unsound_balls(proves, _numbers(given), chance, 10, where=lambda path: path[0] == last)
    centres = [(last, 0, place, 0) for place in range(size)]
    assert not unsound_balls(proves, _numbers(given), chance, 2 * size, where=lambda path: path in centres)


@pytest.mark.parametrize(("size", "on_a_level"), CASES)
def test_a_fixed_point_beyond_any_side_of_the_box_is_refused(size: int, on_a_level: bool) -> None:
    known = known_return(random.Random(f"{size} {on_a_level}"), size, on_a_level)
    for place in range(size):
        for side in (-1, 1):
            fixed = tuple(side * WIDTH * 3 / 2 if i == place else ZERO for i in range(size))
            outcome = _outcome(known.moved_to(fixed))
            assert isinstance(outcome, NotProved)
            assert outcome.reason.condition == "periodic"


@pytest.mark.parametrize(("size", "on_a_level"), CASES)
@pytest.mark.parametrize("crossings", [6, 30])
def test_every_earlier_return_is_at_another_point_in_some_coordinate(
    size: int, on_a_level: bool, crossings: int
) -> None:
    """One coordinate apart is enough, at the point itself: that another point of the box moves is not."""
    known = known_return(random.Random(f"{size} {on_a_level}"), size, on_a_level, crossings=crossings)
    given = known.enclosures
    *earlier, last = given.returns
    for number, each in enumerate(earlier):
        for apart in [None, *range(size)]:
            image = tuple(
                Linearised(
                    enclose(known.fixed[i] + WIDTH / 2**20 if i == apart else ZERO),
                    tuple(arb(int(i == j and i != apart)) for j in range(size)),
                )
                for i in range(size)
            )
            if apart is None:
                # The point returns to itself, and all others of the box to other points.
                image = tuple(
                    Linearised(enclose(-2 * known.fixed[i]), tuple(arb(3 * (i == j)) for j in range(size)))
                    for i in range(size)
                )
            changed = [*earlier[:number], replace(each, image=image), *earlier[number + 1 :], last]
            outcome = outcome_of(known.claim, replace(given, returns=tuple(changed)))
            if apart is not None:
                assert isinstance(outcome, Proved), (apart, outcome.reason)
            else:
                assert isinstance(outcome, NotProved)
                assert outcome.reason.condition == "least-period"


@pytest.mark.parametrize("size", [2, 3])
def test_a_turning_plane_is_on_the_circle_only_where_volume_is_kept(size: int) -> None:
    """The divergence is that of one coordinate alone, whichever it is, and of a plane alone there is no other one."""
    for keeps_volume, plain in ((False, False), (False, True), (True, False), (True, True)):
        known = known_return(random.Random(size), size, False, True, keeps_volume, plain=plain)
        outcome = outcome_of(known.claim, known.enclosures)
        assert isinstance(outcome, Proved), outcome.reason
        found = outcome.results.multipliers
        decided = keeps_volume and size == 2
        assert (found.on, found.undecided) == ((2, 0) if decided else (0, 2))
    for place in range(size + 1):
        names = [f"x{i}" for i in range(size + 1)]
        field = {name: f"{names[i - 1]}**2" + (f" + {name}**3" if i == place else "") for i, name in enumerate(names)}
        system = define_system({"name": "any", "state": names, "field": field})
        assert not is_free_of_divergence(system.program, size + 1), place
