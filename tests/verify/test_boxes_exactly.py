"""Boxes with skew frames: what is in them, and what they reach, up to the last bit and in every direction."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support import breaking_cases
from support.balls import agree
from support.chain_cases import concluded, parabola
from support.claims import known
from support.curve_cases import proof
from support.inclusion import broken_inclusions

from orbitproof.shared.claims import Candidate, Claim
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.bifurcation import coordinates_in_box, in_box
from orbitproof.verify.bifurcation.level_forms import _keeps_sign
from orbitproof.verify.curve.bifurcations_on_it import _contradicts
from orbitproof.verify.curve.gluing import Stretch, _enter
from orbitproof.verify.curve.proved_curve import times_of
from orbitproof.verify.curve.proved_intervals import ProvedInterval, Run
from orbitproof.verify.curve.tube import Tube
from orbitproof.verify.double_resonance import check_resonance_exactly
from orbitproof.verify.double_resonance import proved_double_resonance as room
from orbitproof.verify.evidence import Checklist, NotEstablishedError, enclose
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.reversor_breaking import is_shifted_by
from orbitproof.verify.stability import point_over
from orbitproof.verify.stability.between_orbits import _is_within
from orbitproof.verify.stability.complete_list import Finder
from orbitproof.verify.stability.extrema import extrema_on
from orbitproof.verify.stability.kinds import Kind
from orbitproof.verify.stability.list_entries import Segment

BITS = 200
SKEW = tuple(tuple(map(Fraction, row)) for row in ((1, 0, 0), ("-1/2", 2, "-3/4"), ("5/4", "-1/4", -1)))
LITTLE = Fraction(1, 2**20)


def beyond(place: int, radii: tuple[Fraction, ...], side: int) -> list[Fraction]:
    """A point of a box, but for one coordinate, which is a little outside; for -1 a little inside as all others."""
    inside = 1 - LITTLE
    signs = [(-1) ** (i + place) for i in range(len(radii))]
    return [
        sign * radius * (1 + LITTLE if i == place and side > 0 else inside)
        for i, (sign, radius) in enumerate(zip(signs, radii, strict=True))
    ]


def at(candidate: Candidate, p: list[Fraction]) -> dict[str, arb]:
    """The coordinates of a point of Fix(R)."""
    return {
        name: enclose(c + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0)))
        for name, c, row in zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True)
    }


@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("side", [1, -1])
def test_an_orbit_is_shifted_into_its_box_and_onto_its_sheet_or_not_said_to_be(place: int, side: int) -> None:
    radii = (Fraction(1, 2**20), Fraction(1, 2**24), Fraction(1, 2**22))
    candidate = replace(breaking_cases.halo(), frame=SKEW, radii=radii)
    with ctx.workprec(BITS):
        level, x, z = at(candidate, beyond(place, radii, side)).values()
        for sheet, sign in product((1, -1), (1, -1)):
            own = replace(candidate, level_sign=sheet)
            found: Any = SimpleNamespace(parameter=level, other_point={"x": x, "z": -z, "vy": arb(sign)})
            assert is_shifted_by(own, found, "S") == (side < 0 and sheet == sign)
        wide: Any = SimpleNamespace(parameter=level, other_point={"x": x, "z": -z, "vy": arb(0, 1)})
        assert not is_shifted_by(candidate, wide, "S")


@pytest.mark.parametrize("place", range(3))
def test_a_point_is_in_a_box_if_all_of_its_coordinates_are(place: int) -> None:
    radii = (Fraction(1, 2**20), Fraction(1, 2**24), Fraction(1, 2**22))
    candidate = replace(known("em1"), frame=SKEW, radii=radii, symmetry=None)
    with ctx.workprec(BITS):
        for side in (1, -1):
            p = beyond(place, radii, side)
            assert in_box(candidate, at(candidate, p)) == (side < 0)
            found = coordinates_in_box(candidate, at(candidate, p))
            assert all(agree(ball, enclose(value)) for ball, value in zip(found, p, strict=True))


@pytest.mark.parametrize("signs", list(product((1, -1), repeat=3)))
def test_a_coordinate_keeps_its_sign_on_a_box_if_no_corner_reaches_0(signs: tuple[int, ...]) -> None:
    radii, row = (Fraction(1, 8), Fraction(1, 4), Fraction(1, 16)), (Fraction(1, 2), Fraction(1, 4), Fraction(2))
    reach = sum((a * r for a, r in zip(row, radii, strict=True)), Fraction(0))
    turned = tuple(sign * a for sign, a in zip(signs, row, strict=True))
    for height, keeps in ((reach + LITTLE, True), (reach - LITTLE, False), (reach, False)):
        for centre in (height, -height):
            candidate: Any = SimpleNamespace(frame=(SKEW[0], turned), centre=(Fraction(9), centre), radii=radii)
            assert _keeps_sign(candidate, 1) == keeps


@pytest.mark.parametrize("signs", list(product((1, -1), repeat=2)))
def test_a_parameter_stays_in_its_range_at_all_corners_of_a_box(signs: tuple[int, int], monkeypatch: Any) -> None:
    for name in ("theorem_of_resonance", "check_symmetries", "check_frames"):
        monkeypatch.setattr(room, name, lambda *rest: None)
    radii, row = (Fraction(1, 8), Fraction(1, 4)), (Fraction(signs[0], 2), Fraction(signs[1], 4))
    contains = lambda value: 0 < value < 1  # noqa: E731
    system = SimpleNamespace(parameters={"mu": SimpleNamespace(contains=contains)})
    for centre, holds in (
        (Fraction(1, 8) + LITTLE, True), (Fraction(1, 8) - LITTLE, False),
        (Fraction(7, 8) - LITTLE, True), (Fraction(7, 8) + LITTLE, False),
    ):  # fmt: skip
        candidate: Any = SimpleNamespace(
            system=system, varying="mu", frame=(row,), centre=(centre,), radii=radii, crossings=1
        )
        if holds:
            check_resonance_exactly(Checklist(), candidate)
        else:
            with pytest.raises(NotEstablishedError, match="leaves"):
                check_resonance_exactly(Checklist(), candidate)


# Places on curves.


def two_known(first: str, second: str) -> tuple[Any, Stretch]:
    """The first stretch of a parabola, on whose two halves deviations are known that differ."""
    atlas, results = parabola(Claim("arc", None, ("beta",)))
    stretch = proof(concluded((atlas, results))).chain.stretches[0]
    halves = ((Fraction(-1), Fraction(0), first), (Fraction(0), Fraction(1), second))
    run = Run(tuple(ProvedInterval(a, b, (Fraction(e),), (Fraction(e),)) for a, b, e in halves))
    return atlas, replace(stretch, run=run, enters=Fraction(-1), entered=Fraction(-1), leaves=Fraction(1))


@pytest.mark.parametrize("order", [1, -1])
def test_a_point_over_two_intervals_is_known_as_badly_as_on_the_worse_one(order: int) -> None:
    _, stretch = two_known(*("1/4096", "1/1048576")[::order])
    piece = stretch.tube.piece
    with ctx.workprec(BITS):
        over = point_over(stretch, arb(0, 2.0**-30))
        for sign in (1, -1):
            assert over[1].contains(enclose(piece.centre[1] + sign * Fraction(1, 4097)))


def test_half_periods_of_a_curve_are_those_of_all_of_its_parts() -> None:
    _, stretch = two_known("0", "0")
    for order in (1, -1):
        times = [arb(3, 0.5), arb(5, 0.25), arb(4)][::order]
        parts = [replace(stretch.run.intervals[i % 2], time=time) for i, time in enumerate(times)]
        chain: Any = SimpleNamespace(
            stretches=[replace(stretch, run=Run(tuple(parts[:2]))), replace(stretch, run=Run(tuple(parts[2:])))]
        )
        found = times_of(chain)
        assert all(found.contains(time) for time in times)
        assert not found.contains(arb(6))
        unknown: Any = SimpleNamespace(
            stretches=[*chain.stretches, replace(stretch, run=Run((replace(parts[0], time=arb("nan")),)))]
        )
        assert not times_of(unknown).is_finite()


@pytest.mark.parametrize("bad", [0, 1])
def test_a_point_contradicts_a_curve_that_is_off_in_one_coordinate(bad: int) -> None:
    parts = (ProvedInterval(Fraction(-1), Fraction(1), (Fraction(1, 8), Fraction(1, 4)), (Fraction(1),) * 2),)
    stretch: Any = SimpleNamespace(run=Run(parts))
    known_to = [arb("0.124"), arb("-0.249")]
    assert not _contradicts(stretch, arb(0), known_to)
    known_to[bad] = known_to[bad] + (arb("0.25") if bad == 0 else arb("-0.25"))
    assert _contradicts(stretch, arb(0), known_to)
    known_to[bad] = arb(0, 1)
    assert not _contradicts(stretch, arb(0), known_to)


@pytest.mark.parametrize("seed", range(6))
def test_a_joint_holds_the_places_of_all_curves_of_the_first_piece_in_the_second(seed: int) -> None:
    """Two pieces of lines in one plane with skew frames, whose coordinates depend on each other's deviations."""
    chance = random.Random(seed)
    first = parabola()[0].curve_pieces()[0]
    away = tuple(Fraction(chance.randint(-8, 8), 64) for _ in range(2))
    frame = ((Fraction(1), Fraction(chance.randint(-8, 7), 16)), (Fraction(chance.randint(-8, 8), 16), Fraction(1)))
    flat = replace(first, polynomial=((Fraction(0),),), half_width=Fraction(1, 2), tube=(Fraction(1, 2),))
    one = replace(flat, id="one", frame=((Fraction(1), Fraction(1, 2)), (Fraction(-1, 4), Fraction(1))))
    other = replace(flat, id="other", centre=tuple(c + d for c, d in zip(flat.centre, away, strict=True)), frame=frame)
    error = Fraction(1, 16)
    run = Run((ProvedInterval(Fraction(-1), Fraction(1), (error,), (error,)),))
    before, after = Tube(one, (run,)), Tube(other, (run,))
    determinant = frame[0][0] * frame[1][1] - frame[0][1] * frame[1][0]
    with ctx.workprec(BITS):
        found = _enter(before, run, Fraction(1, 8), after)
        assert not isinstance(found[0], int)
        joint = found[0]
        for sign in (1, -1):
            p = [one.half_width / 8, sign * error]
            x, y = (
                c - d + sum((a * b for a, b in zip(row, p, strict=True)), Fraction(0))
                for c, d, row in zip(one.centre, other.centre, one.frame, strict=True)
            )
            there = (frame[1][1] * x - frame[0][1] * y) / determinant, (frame[0][0] * y - frame[1][0] * x) / determinant
            assert agree(joint.enters, enclose(there[0] / other.half_width))
            assert agree(joint.offsets[0], enclose(there[1] / other.tube[0]))
            rate = [one.half_width, sign * error]
            x, y = (sum((a * b for a, b in zip(row, rate, strict=True)), Fraction(0)) for row in one.frame)
            assert agree(joint.turn, enclose((frame[1][1] * x - frame[0][1] * y) / determinant / other.half_width))
        # Where one of these curves leaves the tube, or what is proved, there is no joint.
        assert isinstance(_enter(before, run, Fraction(1, 8), Tube(replace(other, tube=(error / 2,)), (run,)))[0], int)
        assert joint.enters.rad() > arb(2) ** -30
        width = joint.enters.rad() * 2
        low, high = joint.enters.mid() - width, joint.enters.mid() + width
        short = [Fraction(float(low)), Fraction(float(joint.enters.mid())), Fraction(float(high))]
        for a, b, holds in ((short[0], short[2], True), (short[0], short[1], False), (short[1], short[2], False)):
            part = Run((ProvedInterval(a, b, (error,), (error,)),))
            assert (not isinstance(_enter(before, run, Fraction(1, 8), Tube(other, (part,)))[0], int)) == holds


def test_points_of_a_list_hold_the_levels_and_times_of_all_of_their_places() -> None:
    chance = random.Random(0)
    atlas, stretch = two_known("0", "0")

    def function(error: float = 0.0) -> BoundedFunction:
        return BoundedFunction(ball_polynomial([Fraction(chance.randint(-64, 64), 64) for _ in range(5)]), arb(error))

    places = Fraction(-1, 2), Fraction(-1, 2), Fraction(1, 2), Fraction(0), Fraction(1)
    with ctx.workprec(BITS):
        segment = Segment(0, *places, (function(),), function(), function(), function())
        finder = Finder(atlas, stretch, segment)
        told = lambda tau: finder._point(3, 1, Kind.RESONANCE, tau)  # noqa: E731
        assert not broken_inclusions(told, (arb("0.2"),), chance)


@pytest.mark.parametrize("count", [1, 2])
def test_every_extremum_of_every_function_that_may_be_meant_is_listed_or_open(count: int) -> None:
    """Stability parameters near a quartic polynomial, and near that plus 3 + tau/2."""
    chance, error = random.Random(0), Fraction(1, 2**14)
    bent = [Fraction(1, 16), Fraction(0), Fraction(-1, 4), Fraction(1, 8), Fraction(1)]
    other = [bent[0] + 3, bent[1] + Fraction(1, 2), *bent[2:]]

    def segment(extra: tuple[Fraction, ...] = (), unknown: Fraction = Fraction(0)) -> Segment:
        trace = [a + (b if count == 2 else 0) for a, b in zip(bent, other, strict=True)]
        trace = [value + more for value, more in zip(trace, [*extra, *[Fraction(0)] * 5], strict=False)]
        known_to = [BoundedFunction(ball_polynomial(trace), enclose(unknown))]
        if count == 2:
            known_to.append(BoundedFunction(ball_polynomial(bent) * ball_polynomial(other), arb(0)))
        rest = [BoundedFunction(ball_polynomial([Fraction(chance.randint(1, 9))]), arb(0)) for _ in range(3)]
        places = Fraction(-3, 4), Fraction(-3, 4), Fraction(3, 4), Fraction(0), Fraction(1)
        return Segment(0, *places, tuple(known_to), *rest)

    with ctx.workprec(BITS):
        listed, undecided = extrema_on(segment(unknown=error), 0)
        assert listed
        for power, sign in product((0, 1, 2, 4), (1, -1)):
            true, _ = extrema_on(segment(tuple(sign * error * (n == power) for n in range(5))), 0)
            assert true
            for place, value in true:
                held = [here for here, known_value in listed if agree(here, place) and agree(known_value, value)]
                assert len(held) == 1 or any(enclose(a) <= place <= enclose(b) for a, b in undecided)


def test_an_orbit_counts_on_a_segment_from_where_that_is_surely_entered() -> None:
    segment: Any = SimpleNamespace(start=Fraction(-1, 2), entered=Fraction(-1, 4), end=Fraction(1, 2))
    for middle, radius, wanted in (
        ("0", "0.24", True), ("-0.3", "0.01", False), ("-0.25", "0.01", False), ("0.5", "0.01", False),
        ("0.6", "0", False),
    ):  # fmt: skip
        assert _is_within(arb(middle, radius), segment) == wanted
