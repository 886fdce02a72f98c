"""Multipliers of all orbits of a curve without symmetry, enclosed and counted (sections 26.6 and 26.7)."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import groupby, pairwise
from math import exp, pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb
from support.periodic_curves import (
    ATLASES,
    LIMITS,
    attempt,
    closed_atlas,
    faster_atlas,
    oscillator_atlas,
    proved,
    turning_atlas,
    twisting_atlas,
)

from orbitproof.shared.formats import PeriodicAtlas
from orbitproof.verify.curve import IntervalResult
from orbitproof.verify.evidence import IntegrationFailure, NotKnown, Proved, Reason, enclose, hull, interval_text
from orbitproof.verify.functions import REACH
from orbitproof.verify.periodic_curve import (
    CountedPart,
    Counts,
    MultiplierFunctions,
    PeriodicIntervalResult,
    characteristic,
    conclude_periodic,
    unconfirmed_multipliers,
)
from orbitproof.verify.periodic_curve import counted as counted_parts
from orbitproof.verify.periodic_curve.characteristic import multipliers_along
from orbitproof.verify.periodic_curve.counted import counts_of, counts_of_pair_of_area
from orbitproof.verify.theorems.periodic_curve import told

Q = Fraction


def _rate_of_turning(x: float) -> float:
    q = x * x
    return exp(2 * pi * (2 - 2 * q) * q / 5)


TRUE: dict[str, Callable[[PeriodicAtlas, int, Q], list[float]]] = {
    "turning": lambda atlas, n, s: [-_rate_of_turning(float(atlas.curve_pieces()[n].point(s)[1]))],
    "twice": lambda atlas, n, s: _of_two(exp(-pi * float(atlas.curve_pieces()[n].point(s)[0]) / 2), exp(-2 * pi)),
    "levels": lambda atlas, n, s: [-exp(-2 * pi)],
    "tilted": lambda atlas, n, s: [-exp(-2 * pi)],
    "on-level": lambda atlas, n, s: [-exp(-2 * pi)],
}
"""c_1, c_2, .. at s of piece n, in closed form."""


def _of_two(first: float, second: float) -> list[float]:
    return [-first - second, first * second]


@pytest.mark.parametrize("name", ATLASES)
def test_the_multipliers_of_exact_curves_lie_in_the_enclosures(name: str) -> None:
    source = random.Random(name)
    for number, result in enumerate(proved(name)):
        assert isinstance(result, PeriodicIntervalResult)
        assert isinstance(result.multipliers, MultiplierFunctions)
        for _ in range(50):
            s = Q(source.randrange(-(2**30), 2**30), 2**30)
            true = TRUE[name](ATLASES[name], number, s)
            assert len(true) == len(result.multipliers.coefficients)
            for value, function in zip(true, result.multipliers.coefficients, strict=True):
                ball = function.enclosed.value(enclose(s / REACH))
                assert abs(float(ball.mid()) - value) <= float(ball.rad()) + 1e-14
                assert float(ball.rad()) < 1e-9


def test_on_parts_of_a_piece_they_are_those_of_its_orbits() -> None:
    atlas = replace(turning_atlas(), pieces=turning_atlas().pieces[:1])
    results = tuple(attempt(atlas, interval=ends).stored for ends in ((Q(-1), Q(1, 4)), (Q(1, 4), Q(1))))
    result = results[1]
    assert isinstance(result, PeriodicIntervalResult)
    assert isinstance(result.multipliers, MultiplierFunctions)
    for s in (Q(1, 4), Q(1, 2), Q(1)):
        ball = result.multipliers.coefficients[0].enclosed.value(enclose((s - Q(5, 8)) / (Q(3, 8) * REACH)))
        assert abs(float(ball.mid()) - TRUE["turning"](atlas, 0, s)[0]) <= float(ball.rad()) + 1e-14
    before, gap, after = counted(atlas, results)
    assert (before.counts, gap.counts, after.counts) == (Counts(0, 0, 1), None, Counts(1, 0, 0))
    assert gap.between[0] <= Q(4, 5) <= gap.between[1]
    # Where two results overlap, orbits are counted once.
    whole = proved("turning")[0]
    assert _places(counted(atlas, (whole, result))) == _places(counted(atlas, (whole,)))


@pytest.mark.parametrize(
    ("along", "terms", "slope"),
    [
        # P = f_0 + f_1 omega + f_2 omega^2 with the powers of sigma that are given, at omega = 1/32.
        ("a", {(1,): [0, 1]}, lambda t: t),
        ("a", {(1,): [0, 1], (2,): [1]}, lambda t: t + Q(2, 32)),
        ("x", {(0,): [0, 1]}, lambda t: Q(1)),
        ("x", {(1,): [0, 1]}, lambda t: Q(1, 32)),
        ("x", {(2,): [0, 0, 0, 0, 0, 1]}, lambda t: 5 * t**4 / 32**2),
    ],
)
def test_derivatives_are_those_at_the_curve_and_not_at_its_polynomial(
    along: str, terms: dict[tuple[int, ...], list[int]], slope: Callable[[Q], Q]
) -> None:
    """dP/dx where p_0 is a, that is dP/domega over its width, or p_0 is x, that is dP/dsigma over h r."""
    atlas = faster_atlas() if along == "a" else turning_atlas()
    piece = replace(atlas.curve_pieces()[0], polynomial=((Q(0),),))
    arithmetic = LIMITS.arithmetic([Q(1)], LIMITS.precision, 2)
    image = arithmetic.polynomial({key: list(map(Q, row)) for key, row in terms.items()})
    width = Q(1, 4)
    found = multipliers_along(atlas, piece, (Q(-1), Q(1)), [image], [width], [arb(1) / 32])
    assert isinstance(found, MultiplierFunctions)
    unit = width if along == "a" else piece.half_width * Q(17, 16)
    for tau in (Q(-32, 33), Q(-1, 3), Q(0), Q(1, 2), Q(32, 33)):
        true = -slope(tau * Q(33, 34)) / unit
        ball = found.coefficients[0].enclosed.value(enclose(tau))
        assert (ball - enclose(true)).contains(0)
        assert float(ball.rad()) < 1


@pytest.mark.parametrize("grade", [0, 1, 2])
def test_what_is_not_known_of_an_image_counts_in_its_derivatives(grade: int) -> None:
    """sigma^16 omega^grade / 1000 is among what is not known."""
    piece = replace(turning_atlas().curve_pieces()[0], polynomial=((Q(0),),))
    arithmetic = LIMITS.arithmetic([Q(1)], LIMITS.precision, 2)
    nothing = arithmetic.polynomial({(0,): [Q(0)]})
    image = nothing.with_errors([0.001 * (number == grade) for number in range(3)])
    found = multipliers_along(turning_atlas(), piece, (Q(-1), Q(1)), [image], [Q(1, 4)], [arb(1) / 32])
    assert isinstance(found, MultiplierFunctions)
    slope = Q(16, 1000) * Q(16, 17) ** 15 / 32**grade / (piece.half_width * Q(17, 16))
    ball = found.coefficients[0].enclosed.value(enclose(Q(32, 33)))
    assert (ball + enclose(slope)).contains(0)


def test_coordinates_are_those_of_the_section_whatever_the_frame_is() -> None:
    """a = p_0, x = 2 p_0 + p_1: p_0 alone does not change with x."""
    frame = ((Q(1), Q(0)), (Q(2), Q(1)))
    piece = replace(turning_atlas().curve_pieces()[0], polynomial=((Q(0),),), frame=frame)
    image = LIMITS.arithmetic([Q(1)], LIMITS.precision, 2).polynomial({(0,): [Q(0), Q(1)]})
    found = multipliers_along(turning_atlas(), piece, (Q(-1), Q(1)), [image], [Q(1, 4)], [arb(0)])
    assert isinstance(found, MultiplierFunctions)
    assert abs(float(found.coefficients[0].enclosed.value(arb(0)).mid())) < 1e-9


def test_of_many_coordinates_the_reason_is_told() -> None:
    with pytest.raises(IntegrationFailure, match="in at most 6 coordinates"):
        characteristic._characteristic([[]] * 7)


def counted(atlas: PeriodicAtlas, results: tuple[IntervalResult, ...]) -> tuple[CountedPart, ...]:
    """The parts of a curve that is proved."""
    outcome = conclude_periodic(atlas, results).outcome
    assert isinstance(outcome, Proved), outcome
    return outcome.results.multipliers


def _places(parts: tuple[CountedPart, ...]) -> list[Any]:
    return [(part.pieces, part.between, part.counts) for part in parts]


def test_a_multiplier_leaves_the_circle_where_the_curve_turns_and_nowhere_else() -> None:
    before, gap, after = counted(turning_atlas(), proved("turning"))
    assert (before.counts, gap.counts, after.counts) == (Counts(0, 0, 1), None, Counts(1, 0, 0))
    assert before.between[0] == -1
    assert after.between[1] == 1
    assert (before.between[1], after.between[0]) == gap.between
    assert after.pieces == ("p1", "p2")
    # The multiplier is 1 at x = 1, s = 4/5 of the first piece.
    assert gap.between[0] <= Q(4, 5) <= gap.between[1]
    assert gap.between[1] - gap.between[0] < Q(1, 10**9)
    assert gap.all_values.contains(-1)
    assert float(gap.all_values.rad()) < 1e-12
    ends = before.values[0], gap.values[0], after.values[0], after.values[1]
    assert all(
        abs(float(value) - (x**4 - 2 * x**2)) < 1e-12 for value, x in zip(ends, (0.775, 1, 1, 1.225), strict=True)
    )
    words = told(conclude_periodic(turning_atlas(), proved("turning")))["statement"]
    first, last = (interval_text(value, 18) for value in before.values)
    for expected in (
        f"from a in {first} to a in {last}, 0 inside",
        "Besides the multiplier 1 of the direction of the flow each orbit has 1 other.",
        "0 inside, 1 outside the unit circle: unstable orbits;",
        "it is not decided; as the numbers on both sides differ, an orbit there has one on the circle;",
        "1 inside, 0 outside the unit circle: asymptotically stable orbits.",
    ):
        assert expected in words


def test_orbits_that_lose_area_are_attracting() -> None:
    (part,) = counted(ATLASES["twice"], proved("twice"))
    assert part.counts == Counts(2, 0, 0)
    words = told(conclude_periodic(ATLASES["twice"], proved("twice")))["statement"]
    assert "2 others; for every orbit of the curve 2 inside, 0 outside the unit circle: asymptotically stable" in words


def test_orbits_of_levels_are_not_called_asymptotically_stable() -> None:
    for name in ("levels", "on-level"):
        (part,) = counted(ATLASES[name], proved(name))
        assert part.counts == Counts(1, 0, 0)
        words = told(conclude_periodic(ATLASES[name], proved(name)))["statement"]
        assert "Besides two multipliers that are 1 each orbit has 1 other; for every orbit of the curve 1 in" in words
        assert "stable" not in words
    # Where the level varies its values at the ends are those of H: 25/16 and 9/16.
    (part,) = counted(ATLASES["levels"], proved("levels"))
    assert [value.contains(level) for value, level in zip(part.values, (25 / 16, 9 / 16), strict=True)] == [True, True]


@pytest.mark.parametrize(
    ("low", "high", "expected"), [("3/10", "4/10", Counts(0, 2, 0)), ("-3/10", "-2/10", Counts(1, 0, 1))]
)
def test_multipliers_of_maps_that_keep_areas(low: str, high: str, expected: Counts) -> None:
    """The pair is exp(2 pi i a^(1/2)) and its inverse."""
    atlas = twisting_atlas(Q(low), Q(high))
    (part,) = counted(atlas, (attempt(atlas).stored,))
    assert part.counts == expected


def test_what_only_touches_the_circle_is_left_open_and_no_crossing_is_claimed() -> None:
    """At a = 1/4 both are -1; on both sides they are on the circle."""
    atlas = twisting_atlas(Q(23, 100), Q(27, 100))
    results = (attempt(atlas).stored,)
    first, gap, last = counted(atlas, results)
    assert (first.counts, gap.counts, last.counts) == (Counts(0, 2, 0), None, Counts(0, 2, 0))
    assert gap.all_values.contains(arb(0.25))
    words = told(conclude_periodic(atlas, results))["statement"]
    assert "differ" not in words
    assert "0 inside, 2 on, 0 outside the unit circle" in words


@pytest.mark.parametrize("seed", range(4))
def test_zeros_of_random_polynomials_are_counted(seed: int) -> None:
    source = np.random.default_rng(seed)
    decided = 0
    for _ in range(200):
        size = int(source.integers(1, 6))
        pairs = int(source.integers(0, size // 2 + 1))
        sizes = np.exp(source.normal(0, 1, pairs))
        turned = sizes * np.exp(1j * source.uniform(0, pi, pairs))
        zeros = np.concatenate([turned, turned.conj(), np.exp(source.normal(0, 1, size - 2 * pairs))])
        coefficients = [float(value) for value in np.poly(zeros).real[1:]]
        found = counts_of([arb(value, 1e-9) for value in coefficients])
        if found is not None:
            decided += 1
            inside = int((np.abs(zeros) < 1).sum())
            assert found == Counts(inside, 0, size - inside)
    assert decided > 150


@pytest.mark.parametrize("zeros", [[1.0], [-1.0, 0.5], [0.6 + 0.8j, 0.6 - 0.8j], [0.6 + 0.8j, 0.6 - 0.8j, 2.0]])
def test_a_zero_on_the_circle_is_never_counted(zeros: list[complex]) -> None:
    coefficients = [float(value) for value in np.poly(zeros).real[1:]]
    assert counts_of([arb(value, 1e-9) for value in coefficients]) is None


def test_numbers_that_are_not_finite_count_nothing() -> None:
    assert counts_of([arb("nan"), arb(0)]) is None
    assert counts_of([arb(0), arb("inf")]) is None
    assert counts_of_pair_of_area(arb("nan")) is None
    assert counts_of_pair_of_area(arb(2)) is None
    assert counts_of_pair_of_area(arb(-1.99, 0.02)) is None


def test_the_level_is_that_of_points_of_the_section() -> None:
    """(x + y/2 = 1 as 2 x + y = 2); H = x^2 + y^2 falls from y = -1/10 on."""
    atlas, results = ATLASES["tilted"], proved("tilted")
    for factor in (1, 2):
        normal = tuple(factor * entry for entry in atlas.claim.normal)
        claim = replace(atlas.claim, normal=normal, offset=factor * atlas.claim.offset)
        (part,) = counted(replace(atlas, claim=claim), results)
        for value, y in zip(part.values, (-0.1, 0.1), strict=True):
            level = (1 - y / 2) ** 2 + y * y
            assert abs(float(value.mid()) - level) < 1e-12 + float(value.rad()) < 1e-6
            assert part.all_values.contains(arb(level, 1e-9))


def test_what_is_said_of_parts_that_are_counted_alike_holds_of_all_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """The parameter may turn on the way: its values at the ends of a part do not bound those between them."""
    chance = random.Random(0)
    for _ in range(40):
        ends = [(arb(chance.uniform(-2, 2)), arb(chance.uniform(-2, 2))) for _ in range(8)]
        parts = [
            CountedPart(
                (f"p{number}", f"q{number}"),
                (Q(number), Q(number + 1)),
                pair,
                hull(*pair) + arb(0, chance.uniform(0, 1)),
                chance.choice((None, Counts(1, 0, 0))),
            )
            for number, pair in enumerate(ends)
        ]
        shares = [parts[:3], [], parts[3:]]
        chain: Any = SimpleNamespace(stretches=shares)
        monkeypatch.setattr(counted_parts, "_parts_of", lambda atlas, stretch, known: iter(stretch))
        found = counted_parts.counted_along(turning_atlas(), chain, proved("turning"))
        assert all(one.counts != other.counts for one, other in pairwise(found))
        assert (found[0].between[0], found[-1].between[1]) == (0, 8)
        for whole in found:
            own = [part for part in parts if whole.between[0] <= part.between[0] < whole.between[1]]
            assert {part.counts for part in own} == {whole.counts}
            assert whole.pieces == (own[0].pieces[0], own[-1].pieces[1])
            assert (whole.between[0], whole.between[1]) == (own[0].between[0], own[-1].between[1])
            assert whole.values[0] is own[0].values[0]
            assert whole.values[1] is own[-1].values[1]
            assert all(whole.all_values.contains(part.all_values) for part in own)


def test_where_a_piece_is_entered_is_one_part() -> None:
    """Of the first piece the multiplier is 1 at s = 4/5; what is counted before it may lie on the piece before."""
    atlas = turning_atlas()
    outcome = conclude_periodic(atlas, proved("turning")).outcome
    assert isinstance(outcome, Proved)
    stretch = outcome.results.chain.stretches[0]
    known = {(result.piece, result.interval): result.multipliers for result in proved("turning")}  # type: ignore[attr-defined]
    outside, inside = Counts(0, 0, 1), Counts(1, 0, 0)
    for entered, wanted in ((Q(9, 10), [None, inside]), (Q(3, 4), [outside, outside, None, inside])):
        entering = replace(stretch, enters=Q(1, 2), entered=entered)
        found = [
            (key, [*group])
            for key, group in groupby(counted_parts._parts_of(atlas, entering, known), lambda p: p.counts)
        ]
        assert found[0][1][0].between == (Q(1, 2), entered)
        assert found[0][1][0].counts == wanted[0]
        assert [key for key, _ in found] == [key for key, _ in groupby(wanted)]


def test_multipliers_of_what_is_not_proved_are_not_counted() -> None:
    first, second = proved("turning")
    assert isinstance(first, PeriodicIntervalResult)
    reason = Reason("newton", "for a test", "")
    refused = replace(first, verdict="not proved", reason=reason, multipliers=_doubled(first))
    alone, together = (counted(turning_atlas(), (first, second, *others)) for others in ((), (refused,)))
    assert _places(together) == _places(alone)


def test_where_all_multipliers_are_1_nothing_is_stored_or_said() -> None:
    stored = attempt(oscillator_atlas()).stored
    assert isinstance(stored, PeriodicIntervalResult)
    assert (stored.verdict, stored.multipliers) == ("proved", None)
    assert counted(oscillator_atlas(), (stored,)) == ()


def test_results_without_multipliers_say_nothing_of_them() -> None:
    atlas, results = closed_atlas()
    assert counted(atlas, results) == ()
    assert "Besides" not in told(conclude_periodic(atlas, results))["statement"]


UNKNOWN: dict[str, Any] = {
    "missing": None,
    "not known": NotKnown(Reason("multipliers", "for a test", "")),
    "too many": None,
}


@pytest.mark.parametrize("name", UNKNOWN)
def test_what_is_not_known_on_one_piece_is_not_counted_there(name: str) -> None:
    first, second = proved("turning")
    assert isinstance(first, PeriodicIntervalResult)
    lacking = replace(first, multipliers=UNKNOWN[name] if name != "too many" else _doubled(first))
    gap, rest = counted(turning_atlas(), (lacking, second))
    assert (gap.counts, rest.counts) == (None, Counts(1, 0, 0))
    assert (gap.pieces, gap.between[0]) == (("p1", "p1"), Q(-1))
    assert float(gap.all_values.lower()) < -1 < -0.85 < float(gap.all_values.upper())
    words = told(conclude_periodic(turning_atlas(), (lacking, second)))["statement"]
    assert "differ" not in words


def _doubled(result: PeriodicIntervalResult) -> MultiplierFunctions:
    assert isinstance(result.multipliers, MultiplierFunctions)
    return MultiplierFunctions(result.multipliers.coefficients * 2)


def test_new_integrations_confirm_what_is_stored_and_nothing_narrower() -> None:
    (stored,) = proved("levels")
    assert isinstance(stored, PeriodicIntervalResult)
    fresh = attempt(ATLASES["levels"], limits=replace(LIMITS, precision=112, order=44)).stored
    assert isinstance(fresh, PeriodicIntervalResult)
    assert list(unconfirmed_multipliers(stored, fresh)) == []
    assert isinstance(stored.multipliers, MultiplierFunctions)
    (function,) = stored.multipliers.coefficients
    moved = replace(function, coefficients=(function.coefficients[0] + 4 * function.error, *function.coefficients[1:]))
    narrower = replace(function, error=function.error / 2**20)
    for function in (moved, narrower):
        forged = MultiplierFunctions((function,))
        assert any(
            "not confirmed" in text for text in unconfirmed_multipliers(replace(stored, multipliers=forged), fresh)
        )
    assert list(unconfirmed_multipliers(replace(stored, multipliers=_doubled(stored)), fresh))
    elsewhere = replace(fresh, interval=(Q(-1), Q(1, 2)))
    assert list(unconfirmed_multipliers(stored, elsewhere))
    assert list(unconfirmed_multipliers(stored, replace(fresh, multipliers=None)))
    without = {key: value for key, value in vars(fresh).items() if key != "multipliers"}
    assert list(unconfirmed_multipliers(stored, IntervalResult(**without)))
