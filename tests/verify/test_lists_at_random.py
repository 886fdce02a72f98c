"""What complete lists are made of, at random: parts, zeros, stationary values, matches, by their definitions.

Functions are known up to an error; that one is taken which has the zeros, or stationary values, that were chosen.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from flint import arb, arb_poly, ctx
from support.balls import agree
from support.chain_cases import concluded, parabola, proved
from support.curve_cases import proof
from support.stored import values
from support.within import within

from orbitproof.shared import define_system
from orbitproof.shared.claims import Claim
from orbitproof.shared.systems import AXIAL, CR3BP, CR3BP_PLANAR, FALKNER_SKAN, LIFTED, VERTICAL, record
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import Bifurcation, PlaceOnCurve
from orbitproof.verify.curve.tube import read_tube
from orbitproof.verify.distances import Ranges
from orbitproof.verify.evidence import EmptyIntersectionError, NotKnown, Proved, Reason, enclose, exact_value, sign
from orbitproof.verify.functions import REACH, BoundedFunction, StoredFunction
from orbitproof.verify.out_of_plane import KnownVariations, VariationFunctions
from orbitproof.verify.stability import (
    Bound,
    CompleteList,
    CurveEnd,
    Gap,
    Kind,
    Matter,
    Point,
    Resonance,
    Segment,
    across_list,
    bounds_on,
    conclude_list,
    extrema_on,
    is_stable,
    linear_stability,
    orbit_between,
    proved_list,
    segments_of,
    stable_intervals,
)
from orbitproof.verify.stability import complete_list as lists
from orbitproof.verify.stability.complete_list import resonant_value
from orbitproof.verify.stability.confirmation import unconfirmed
from orbitproof.verify.stability.extrema import BAND, is_in_band
from orbitproof.verify.stability.level import Level, gradient
from orbitproof.verify.stability.linear_stability import _together
from orbitproof.verify.stability.matching import about_the_list, with_certificates
from orbitproof.verify.stability.stored_stability import StabilityFunctions
from orbitproof.verify.stability.units import scales
from orbitproof.verify.stability.zeros import (
    Zero,
    _merged,
    _narrowed,
    between,
    ends_of,
    zeros_beside_double_one,
    zeros_on,
)

END = 1 / REACH

_precision = within(lambda: ctx.workprec(192))


Polynomial = list[Q]


def times(*factors: Sequence[Q]) -> Polynomial:
    result = [Q(1)]
    for factor in factors:
        grown = [Q(0)] * (len(result) + len(factor) - 1)
        for i, a in enumerate(result):
            for j, b in enumerate(factor):
                grown[i + j] += a * b
        result = grown
    return result


def plus(one: Sequence[Q], other: Sequence[Q]) -> Polynomial:
    size = max(len(one), len(other))
    first, second = ([*row, *([Q(0)] * (size - len(row)))] for row in (one, other))
    return [a + b for a, b in zip(first, second, strict=True)]


def known_beside(member: Sequence[Q], error: Q, power: int) -> BoundedFunction:
    """A function known up to an error, of which the member is one: the largest and the smallest there is."""
    return BoundedFunction(ball_polynomial(plus(member, [Q(0)] * power + [error])), enclose(abs(error)).upper())


# Parts


def constant(*coefficients: Q) -> StoredFunction:
    return StoredFunction(coefficients, Q(0))


@pytest.mark.parametrize("symmetric", [False, True])
def test_parts_of_a_stretch_are_those_of_results_that_count_there(symmetric: bool) -> None:
    chance = random.Random(str(symmetric))
    for _ in range(150):
        size = chance.choice((1, 2))
        piece = SimpleNamespace(id="p", tube=[Q(1)] * size)
        ends = sorted(Q(chance.randint(-16, 16), 16) for _ in range(2))
        if ends[0] == ends[1]:
            continue
        entered = min(ends[0] + Q(chance.randint(0, 3), 40), ends[1])
        proved: list[Any] = []
        results: list[Any] = []
        counting: dict[int, tuple[Q, Q]] = {}
        for tag in range(3, 3 + chance.randint(1, 8)):
            low, high = sorted(chance.sample(range(-16, 17), 2))
            interval = Q(low, 16), Q(high, 16)
            kind = chance.choice(
                ("good", "good", "good", "good", "piece", "unproved", "uncounted", "none", "few", "open")
            )
            known: Any = StabilityFunctions(
                tuple(constant(Q(100 * k + tag), Q(1)) for k in range(size + (kind == "few"))),
                constant(Q(1000 + tag), Q(1)), constant(Q(1100 + tag), Q(1)), constant(Q(1200 + tag), Q(1)),
            )  # fmt: skip
            known = {"none": None, "open": NotKnown(Reason("stability", "", ""))}.get(kind, known)
            results.append(
                SimpleNamespace(
                    piece="another" if kind == "piece" else "p",
                    is_proved=kind != "unproved",
                    interval=interval,
                    stability=known,
                    computation=SimpleNamespace(precision=chance.choice((64, 80, None))),
                )
            )
            if kind != "uncounted":
                proved.append(interval)
                if symmetric:
                    proved.append((-interval[1], -interval[0]))
            if kind == "good":
                counting[tag] = interval
        # An interval may be counted for the sake of another result.
        counting = {tag: interval for tag, interval in counting.items() if interval in proved}
        of_tag = dict(enumerate(results, start=3))
        run = SimpleNamespace(intervals=[SimpleNamespace(start=low, end=high) for low, high in proved])
        tube = SimpleNamespace(piece=piece, is_symmetric=symmetric)
        stretch: Any = SimpleNamespace(tube=tube, run=run, enters=ends[0], entered=entered, leaves=ends[1])
        segments, gaps = segments_of(7, stretch, results)
        parts = sorted([(part.start, part.end) for part in (*segments, *gaps)])
        assert parts[0][0] == ends[0]
        assert parts[-1][1] == ends[1]
        assert all(before[1] == after[0] and before[0] < before[1] for before, after in pairwise(parts))
        for segment in segments:
            assert segment.stretch == 7
            assert segment.entered == min(max(segment.start, entered), segment.end)
            tag = int(exact_value(segment.characteristic[0].polynomial[0].mid()))
            turned = int(exact_value(segment.characteristic[0].polynomial[1].mid()))
            assert of_tag[tag].piece == "p"
            assert of_tag[tag].is_proved
            low, high = of_tag[tag].interval
            assert turned == 1 or symmetric
            low, high = (low, high) if turned == 1 else (-high, -low)
            assert (low, high) in proved
            assert low <= segment.start < segment.end <= high
            assert segment.tau(low) == -END
            assert segment.tau(high) == END
            assert len(segment.characteristic) == size
            own = [(100 * k, function) for k, function in enumerate(segment.characteristic)]
            own += [(1000, segment.level), (1100, segment.half_period), (1200, segment.first_factor)]
            for base, function in own:
                assert function.polynomial.coeffs() == [base + tag, turned]
        for gap in gaps:
            assert (gap.stretch, gap.piece, gap.subject) == (7, "p", Matter.EVERYTHING)
            for tag, (low, high) in counting.items():
                sides = [(low, high), *([(-high, -low)] if symmetric else [])]
                assert all(end <= gap.start or start >= gap.end for start, end in sides), tag


# Zeros


def test_every_zero_of_every_member_is_in_one_isolating_interval_or_undecided() -> None:
    chance = random.Random(0)
    listed = 0
    for _ in range(250):
        roots = [Q(chance.randint(-36, 36), 36) for _ in range(chance.randint(0, 4))]
        roots += [roots[0]] if roots and chance.random() < 0.3 else []
        roots += [roots[-1] + Q(1, 2**30)] if roots and chance.random() < 0.2 else []
        away = [Q(chance.choice((-1, 1)) * chance.randint(1, 9)), Q(chance.randint(-3, 3), 4), Q(1, 8)]
        member = times(away, *([-root, Q(1)] for root in roots))
        error = chance.choice((Q(0), Q(1, 2**40), Q(1, 2**20), Q(1, 64))) * chance.choice((-1, 1))
        function = known_beside(member, error, chance.randint(0, 5))
        low, high = sorted(chance.sample([-END, Q(-1, 2), Q(0), Q(1, 3), END], 2))
        if chance.random() < 0.2 and roots and roots[0] < high:
            low = max(roots[0], -END)
        found = zeros_on(function, low, high)
        listed += len(found.zeros)
        inside = {root for root in roots if low <= root <= high}
        double = {root for root in inside if roots.count(root) > 1}
        others = np.roots([float(c) for c in away[::-1]])
        for root in inside:
            places = [zero for zero in found.zeros if zero.lower <= root <= zero.upper]
            open_there = any(first <= root <= last for first, last in found.undecided)
            assert len(places) + open_there >= 1
            assert len(places) <= 1
            assert root not in double or not places
            assert root not in (low, high) or open_there
            for zero in places:
                assert zero.lower < root < zero.upper
                assert zero.place.contains(enclose(root))
        for zero in found.zeros:
            here = [root for root in roots if zero.lower <= root <= zero.upper]
            here += [x.real for x in others if abs(x.imag) < 1e-9 and zero.lower <= x.real <= zero.upper]
            assert len(here) == 1
            signs = [sign(function.value(enclose(end))) for end in (zero.lower, zero.upper)]
            assert sorted(signs) == [-1, 1]
            assert low <= zero.lower < zero.upper <= high
        edges = sorted([(zero.lower, zero.upper) for zero in found.zeros] + list(found.undecided))
        assert all(before[1] <= after[0] for before, after in pairwise(edges))
    assert listed > 100


def test_beside_a_double_zero_no_other_is_lost() -> None:
    """f = tau^2 g is known up to an error whose second derivative is: g has chosen zeros on both sides."""
    chance = random.Random(1)
    seen = 0
    for _ in range(120):
        roots = [Q(chance.choice((-1, 1)) * chance.randint(1, 60), 64) for _ in range(chance.randint(0, 3))]
        member = times([Q(0), Q(0), Q(chance.choice((-1, 1)))], *([-root, Q(1)] for root in roots))
        error = chance.choice((Q(0), Q(1, 2**40), Q(1, 2**10))) * chance.choice((-1, 1))
        function = known_beside(member, error, chance.randint(2, 5))
        upper = chance.choice((-1, 1)) * chance.choice((END, Q(1, 2)))
        end, found = zeros_beside_double_one(function, upper)
        assert 0 <= end / upper <= 1
        for root in set(roots):
            if 0 < root / upper <= 1:
                assert abs(root) > abs(end)
                places = [zero for zero in found.zeros if zero.lower < root < zero.upper]
                open_there = any(first <= root <= last for first, last in found.undecided)
                assert len(places) + open_there >= 1
                assert len(places) <= 1
                seen += len(places)
        for zero in found.zeros:
            assert sum(zero.lower <= root <= zero.upper for root in roots) == 1
            assert min(zero.lower / upper, zero.upper / upper) >= end / upper
    assert seen > 20


# Stationary values


def derivative(row: Sequence[Q]) -> Polynomial:
    return [n * c for n, c in enumerate(row)][1:] or [Q(0)]


def near(value: float) -> arb:
    return arb(float(value), 1e-9 * (1 + abs(float(value))))


def value_at(row: Sequence[Q], place: float) -> float:
    return float(np.polyval([float(c) for c in row[::-1]], place))


def segment_with(characteristic: Sequence[BoundedFunction], start: Q, entered: Q, end: Q) -> Segment:
    flat = BoundedFunction(arb_poly([0]), arb(0))
    return Segment(0, start, entered, end, Q(0), Q(1), tuple(characteristic), flat, flat, flat)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("at_end", [-1, 0, 1])
def test_every_stationary_parameter_in_the_band_is_found_or_open(count: int, at_end: int) -> None:
    """Parameters are polynomials, even ones beside a symmetric point; of n = 2 their sum and product are known."""
    chance = random.Random(f"{count} {at_end}")
    found_in_all = 0
    for _ in range(8 if at_end and count == 2 else 40):
        places = [Q(chance.randint(-60, 60), 64) + Q(1, 2**9) for _ in range(chance.randint(0, 3))]
        if at_end:
            # c' = tau times an even polynomial.
            slope = times([Q(0), Q(chance.choice((-1, 1)), 2)], *([-place * place, Q(0), Q(1)] for place in places[:2]))
        else:
            slope = times([Q(chance.choice((-1, 1)), 2)], *([-place, Q(1)] for place in places))
        parameter = [Q(chance.randint(-72, 72), 64), *(c / (n + 1) for n, c in enumerate(slope))]
        rows = [parameter]
        if count == 2:
            other = [Q(chance.choice((-40, 40)), 16), Q(0 if at_end else 1, 3), Q(chance.choice((-1, 1)), 3)]
            rows.append(other)
        if count == 1:
            symmetric = [parameter]
        else:
            symmetric = [plus(*rows), times(*rows)]
        error = chance.choice((Q(0), Q(1, 2**30), Q(1, 2**16))) * chance.choice((-1, 1))
        power = 2 * chance.randint(0, 2)
        known = [known_beside(row, error, power) for row in symmetric]
        start, entered, end = {-1: (Q(0), Q(0), END), 0: (-END, Q(-1, 2), END), 1: (-END, Q(-1, 2), Q(0))}[at_end]
        found, undecided = extrema_on(segment_with(known, start, entered, end), at_end)
        tops = [(place, value_at(row, place))
                for row in rows
                for place in {round(x.real, 12) for x in np.roots([float(c) for c in derivative(row)[::-1]])
                              if abs(x.imag) < 1e-9}]  # fmt: skip
        tops = [(place, value) for place, value in tops if abs(value) < 1.1 and start < place < end]
        if at_end:
            tops = [(place, value) for place, value in tops if abs(place) > 1e-9]
        for place, value in tops:
            here = [turn for turn in found if agree(turn[0], near(place)) and agree(turn[1], near(value))]
            open_there = any(low - Q(1, 2**30) <= place <= high + Q(1, 2**30) for low, high in undecided)
            assert len(here) == 1 or open_there, (place, value)
        for tau, _ in found:
            assert entered <= exact_value(tau.upper())
            assert exact_value(tau.lower()) <= end
        found_in_all += len(found)
    assert found_in_all > (2 if at_end and count == 2 else 10)


def test_orbits_are_stable_if_all_parameters_differ_and_lie_inside() -> None:
    chance = random.Random(2)
    said = {True: 0, False: 0}
    for _ in range(400):
        count = chance.choice((1, 2))
        kinds = [chance.choice(("inside", "inside", "above", "below")) for _ in range(count)]
        places = {"inside": (-63, 63), "above": (65, 192), "below": (-192, -65)}
        own = [Q(chance.randint(*places[kind]), 64) for kind in kinds]
        is_pair = count == 2 and chance.random() < 0.3
        trace, product = sum(own), own[0] * own[-1]
        if is_pair:
            # c = a +- i b.
            trace, product = 2 * own[0], own[0] ** 2 + own[1] ** 2 + Q(1, 64)
        stable = not is_pair and set(kinds) == {"inside"} and len(set(own)) == count
        error = chance.choice((Q(0), Q(1, 2**12), Q(1, 8)))
        known = [known_beside([c], error, 0) for c in ([trace] if count == 1 else [trace, product])]
        said_so = is_stable(segment_with(known, -END, -END, END), enclose(Q(1, 4)))
        assert said_so in (None, stable)
        if said_so is None:
            assert error or len(set(own)) < count
        else:
            said[said_so] += 1
    assert min(said.values()) > 40


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_the_characteristic_polynomial_vanishes_at_the_parameters(count: int) -> None:
    chance = random.Random(count)
    for _ in range(20):
        own = [Q(chance.randint(-40, 40), 16) for _ in range(count)]
        product = times(*([-c, Q(1)] for c in own))
        # a_k with signs: c^n - a_1 c^(n-1) + ..
        known = [
            BoundedFunction(ball_polynomial([(-1) ** k * product[count - k]]), arb(0)) for k in range(1, count + 1)
        ]
        segment = segment_with(known, -END, -END, END)
        for c in (*own, Q(7, 3)):
            wanted = Q(1)
            for each in own:
                wanted *= c - each
            assert (segment.at(enclose(c)).value(arb(0)) - enclose(wanted)).contains(0)
            assert segment.at(enclose(c)).value(arb(0)).rad() < 1e-30
        assert (segment.discriminant is None) == (count != 2)


# Certificates


KINDS = ("doubling", "fold", "symmetry_breaking", "reversor_breaking", "krein_collision")


def test_certificates_are_at_the_one_point_that_may_be_theirs() -> None:
    """By the definition of section 18.5: overlapping places of the same k on the same piece, or of collisions."""
    chance = random.Random(3)
    outcomes = {"here": 0, "open": 0, "refused": 0, "left": 0}
    for _ in range(1500):
        points, gaps = [], []
        for _ in range(chance.randint(0, 6)):
            k = chance.choice((0, 1, 2, 3))
            kinds = {
                0: [Kind.COLLISION], 1: [Kind.FOLD, Kind.LOSS, Kind.SYMMETRIC, Kind.UNDECIDED],
                2: [Kind.HERE, Kind.THERE, Kind.UNDECIDED], 3: [Kind.RESONANCE],
            }[k]  # fmt: skip
            place = arb(chance.randint(-1, 1)) / 8 + arb(0, 1 / 64)
            points.append(Point(0, chance.choice("ppq"), k, min(k - 1, 1) if k else 0, chance.choice(kinds), place,
                                arb(0), arb(1), {}))  # fmt: skip
        for _ in range(chance.choice((0, 0, 0, 1, 2))):
            low = Q(chance.randint(-4, 2), 8)
            subject = chance.choice((Matter.EVERYTHING, Matter.COLLISION, Matter.EXTREMA, Resonance(1, 0),
                                     Resonance(2, 1), Resonance(3, 1)))  # fmt: skip
            gaps.append(Gap(0, chance.choice("pq"), low, low + Q(chance.randint(0, 2), 8), subject, ""))
        kind = chance.choice(KINDS)
        k = {"doubling": chance.choice((2, 3)), "krein_collision": 1}.get(kind, 1)
        s, other = arb(chance.randint(-1, 1)) / 8 + arb(0, 1 / 64), chance.random() < 0.5
        entry = Bifurcation("c", kind, k, PlaceOnCurve("p", s, False, other), "", {})
        is_collision = kind == "krein_collision"
        mine = [
            point for point in points
            if (point.kind is Kind.COLLISION if is_collision else point.k == k)
            and point.piece == "p" and abs(point.s.mid() - s.mid()) < 1 / 16
        ]  # fmt: skip
        about = (
            {Matter.EVERYTHING, Matter.COLLISION} if is_collision else {Matter.EVERYTHING, Resonance(k, min(k - 1, 1))}
        )
        hidden = [
            gap for gap in gaps
            if gap.subject in about and gap.piece == "p"
            and gap.start - Q(1, 64) <= exact_value(s.mid()) <= gap.end + Q(1, 64)
        ]  # fmt: skip
        wanted = {"fold": Kind.FOLD, "symmetry_breaking": Kind.SYMMETRIC, "reversor_breaking": Kind.LOSS}.get(kind)
        contradicts = len(mine) == 1 and (
            (mine[0].kind in (Kind.FOLD, Kind.LOSS, Kind.SYMMETRIC) and mine[0].kind is not wanted)
            or mine[0].kind is (Kind.HERE if other else Kind.THERE)
        )
        try:
            found = with_certificates(points, gaps, [entry])
        except EmptyIntersectionError:
            assert not hidden
            assert not mine or contradicts
            outcomes["refused"] += 1
            continue
        assert len(found) == len(points)
        certified = [point for point in found if point.certificates]
        if hidden or len(mine) > 1:
            assert not certified
            outcomes["open" if hidden else "left"] += 1
        else:
            assert len(mine) == 1
            assert not contradicts
            assert certified == [replace(mine[0], certificates=("c",))]
            outcomes["here"] += 1
    assert min(outcomes.values()) > 10, outcomes


def test_only_certificates_up_to_the_order_and_about_the_curve_have_to_be_in_its_list() -> None:
    entries = [
        Bifurcation(f"{kind} {k}", kind, k, None, "", {})
        for kind in (*KINDS, "orbit", "stable_orbit")
        for k in (1, 2, 3)
    ]

    def names(system: Any, order: int) -> set[str]:
        return {entry.id for entry in about_the_list(SimpleNamespace(system=system), entries, order)}  # type: ignore[arg-type]

    for order in (1, 2, 3):
        assert names(CR3BP, order) == {f"{kind} {k}" for kind in KINDS for k in range(1, order + 1)}
        assert names(CR3BP_PLANAR, order) == {name for name in names(CR3BP, order) if "symmetry" not in name}
        assert names(LIFTED, order) == {f"symmetry_breaking {k}" for k in (1, 2, 3)}
        assert names(VERTICAL["L1"], order) == {f"reversor_breaking {k}" for k in (1, 2, 3)}


# Confirmation


def test_any_stored_function_that_is_not_found_again_is_told_alone() -> None:
    def functions(moved: int) -> StabilityFunctions:
        own = [StoredFunction((Q(n, 7).limit_denominator(64) + (n == moved), Q(1)), Q(1, 2**20)) for n in range(9)]
        rows = [replace(each, coefficients=tuple(Q(round(c * 64), 64) for c in each.coefficients)) for each in own]
        return StabilityFunctions(tuple(rows[:2]), *rows[2:5], None, VariationFunctions(*rows[5:]))

    stored = functions(-1)
    wide = replace(
        stored,
        characteristic=tuple(replace(each, error=Q(1, 2**16)) for each in stored.characteristic),
        **{
            name: replace(getattr(stored, name), error=Q(1, 2**16)) for name in ("level", "half_period", "first_factor")
        },
        out_of_plane=VariationFunctions(*(replace(each, error=Q(1, 2**16)) for each in stored.out_of_plane.entries)),  # type: ignore[union-attr]
    )
    assert not list(unconfirmed(wide, stored))
    words = ["coefficient 1", "coefficient 2", "level", "half period", "first factor", *["out of the plane"] * 4]
    for moved, word in enumerate(words):
        (told,) = unconfirmed(wide, functions(moved))
        assert word in told
    assert any("out of the plane" in told for told in unconfirmed(wide, replace(stored, out_of_plane=None)))
    assert list(unconfirmed(wide, replace(stored, characteristic=stored.characteristic[:1])))
    assert list(unconfirmed(replace(wide, characteristic=wide.characteristic[:1]), stored))
    assert list(unconfirmed(wide, None))


# Units


def test_programs_scale_if_every_component_has_the_degree_of_its_coordinate() -> None:
    def system(field: Any) -> Any:
        names = ("x", "y", "z")
        program = record(field, names, ("eps", "c"))
        return SimpleNamespace(family_parameter="eps", state=names, program=program, normalised=None)

    good = [
        lambda s, p: (s[0] * s[0] / s[1] + p[1] * s[2], s[1] * p[0] * s[2], s[0] + s[1] * (p[0] * s[0]) ** Q(3)),
        lambda s, p: (p[0] * s[0] * s[1], s[2] * (s[0] / s[1]) ** Q(1, 2), s[2]),
        lambda s, p: (1 / p[0], s[0] / (p[0] * s[1]), s[2] * (1 - p[1])),
    ]
    assert all(scales(system(field)) for field in good)
    for number, field in enumerate(good):
        for part in range(3):
            for change in (
                lambda value, s, p: value * s[0], lambda value, s, p: value + 1, lambda value, s, p: value - p[0],
                lambda value, s, p: value / s[2], lambda value, s, p: value + s[0] * s[1],
                lambda value, s, p: (value * s[0]) ** Q(1, 2), lambda value, s, p: p[1] + 0 * value,
            ):  # fmt: skip

                def changed(s: Any, p: Any, field: Any = field, part: int = part, change: Any = change) -> Any:
                    values = list(field(s, p))
                    values[part] = change(values[part], s, p)
                    return values

                assert not scales(system(changed)), (number, part)
    assert not scales(FALKNER_SKAN)


# Points of one part


def by_tau(row: Sequence[Q], middle: Q, radius: Q) -> Polynomial:
    result, power = [Q(0)], [Q(1)]
    for c in row:
        result, power = plus(result, [c * each for each in power]), times(power, [middle, radius])
    return result


def integrated(row: Sequence[Q]) -> Polynomial:
    return [Q(0), *(c / (n + 1) for n, c in enumerate(row))]


ATLAS: Any = SimpleNamespace(system=SimpleNamespace(normalised={}, centre_coordinates=()))


@pytest.mark.parametrize("at_end", [-1, 0, 1])
@pytest.mark.parametrize("matter", ["1:1", "2:1", "4:1", "5:2", "collision"])
def test_on_a_part_every_zero_is_listed_with_its_kind_or_named(
    matter: str, at_end: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At r_1 the level is stationary, or the first factor vanishes; at the others it does not."""
    monkeypatch.setattr(lists, "point_over", lambda stretch, s: ())
    chance = random.Random(f"{matter} {at_end}")
    seen: dict[Kind, int] = {}
    for _ in range(25):
        middle, radius = (Q(0), Q(1)) if at_end else (Q(chance.randint(-20, 20), 32), Q(chance.randint(8, 40), 32))
        tau = {-1: (Q(0), Q(0), END), 0: (-END, Q(-5, 8), END), 1: (-END, Q(-5, 8), Q(0))}[at_end]
        start, entered, end = (middle + radius * each for each in tau)
        roots = [middle + radius * Q(chance.randint(-60, 60), 64) + Q(1, 2**10) for _ in range(chance.randint(1, 3))]
        if len(set(roots)) < len(roots):
            continue
        if at_end:
            roots = [root * at_end for root in map(abs, roots)]
            roots = [-root for root in roots]
        factors = [[-root, Q(1)] if not at_end else [-root * root, Q(0), Q(1)] for root in roots]
        strength = [Q(chance.choice((-1, 1)) * chance.randint(1, 6), 2)]
        rest = times(strength, *factors)
        # The level, or the first factor, as the lemma of kinds lets them be: no other zeros.
        vanishing = factors[0] if not at_end else times([Q(0), Q(1)], factors[0])
        level = integrated(vanishing)
        value = {"1:1": Q(1), "2:1": Q(-1), "4:1": Q(0)}.get(matter, Q(0))
        flat = [Q(3)]
        if matter == "1:1" and at_end:
            # A double zero at the symmetric point, and those of the rest.
            rest = times([Q(0), Q(0), Q(1)], rest)
        one = plus([value], rest)
        if matter == "collision":
            trace = [Q(1, 3), Q(0) if at_end else Q(1, 5), Q(1, 7)]
            rows = [trace, [c / 4 for c in plus(times(trace, trace), [-c for c in rest])]]
        elif matter == "5:2":
            rows = [one]
        else:
            other = [Q(chance.choice((-3, 3))), Q(0) if at_end else Q(1, 16), Q(1, 16)]
            rows = [plus(one, other), times(one, other)] if chance.random() < 0.5 else [one]
        error, power = chance.choice((Q(0), Q(1, 2**40))) * chance.choice((-1, 1)), 2 * chance.randint(0, 2)
        if at_end and matter == "1:1":
            error = Q(0)
        own = [known_beside(by_tau(row, middle, radius), error, power) for row in (*rows, level, flat, factors[0])]
        if matter == "5:2":
            # c = cos(4 pi/5) + rest.
            own[0] = BoundedFunction(own[0].polynomial + arb_poly([resonant_value(5, 2)]), own[0].error)
        segment = Segment(3, start, entered, end, middle, radius, tuple(own[: len(rows)]), *own[len(rows) :])
        stretch: Any = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id="p"), is_symmetric=bool(at_end)))
        finder = lists.Finder(ATLAS, stretch, segment)
        k, j = {"1:1": (1, 0), "2:1": (2, 1), "4:1": (4, 1), "5:2": (5, 2), "collision": (0, 0)}[matter]
        if k:
            finder.resonances(k, j)
        else:
            finder.collisions()
        points = list(finder.points)
        if at_end and k == 1:
            (centre,) = [point for point in points if point.kind is Kind.SYMMETRIC]
            assert centre.s.contains(0)
            points.remove(centre)
        assert all((point.k, point.j, point.stretch, point.piece) == (k, j, 3, "p") for point in points)
        inside = [root for root in roots if start <= root <= end]
        for root in inside:
            here = [point for point in points if point.s.contains(enclose(root))]
            named = [gap for gap in finder.gaps if gap.start <= root <= gap.end]
            assert len(here) + bool(named) >= 1
            assert len(here) <= 1
            if root < entered:
                assert named
                assert not here
            for gap in named:
                assert (gap.stretch, gap.piece) == (3, "p")
                assert gap.subject == (Resonance(k, j) if k else Matter.COLLISION)
            for point in here:
                kinds = {1: (Kind.FOLD, Kind.LOSS), 2: (Kind.HERE, Kind.THERE)}.get(k)
                expected = kinds[0 if root == roots[0] else 1] if kinds else Kind.RESONANCE if k else Kind.COLLISION
                assert point.kind in (expected, Kind.UNDECIDED)
                seen[point.kind] = seen.get(point.kind, 0) + 1
                wanted = sum((c * root**n for n, c in enumerate(level)), Q(0))
                assert (point.level + arb(0, 1e-9)).contains(enclose(wanted))
        assert len(points) == sum(1 for root in inside if any(p.s.contains(enclose(root)) for p in points))
    assert sum(seen.values()) > 8
    assert Kind.UNDECIDED not in seen or seen[Kind.UNDECIDED] < 4


def test_which_of_two_factors_vanishes_is_said_where_it_is_certain() -> None:
    chance = random.Random(5)
    counts = {"changes": 0, "keeps": 0, "undecided": 0}
    for _ in range(400):
        low, high = sorted(Q(each, 64) for each in chance.sample(range(-60, 61), 2))
        root = low + (high - low) * Q(chance.randint(1, 15), 16)
        place = enclose(root) + arb(0, 1) * enclose((high - low) / 2 ** chance.choice((6, 20)))
        own = (
            root
            if chance.random() < 0.5
            else chance.choice((low, high, low - Q(1, 8), high + Q(1, 2), Q(1, 10**6) + high))
        )
        slope = chance.choice((-1, 1)) * Q(chance.randint(1, 8), 4)
        member = times([slope], [-own, Q(1)])
        error = chance.choice((Q(0), Q(1, 2**10), (high - low) / 3)) * chance.choice((-1, 1))
        function = known_beside(member, error, chance.randint(0, 3))
        found = lists._factor(function.value, Zero(low, high, place), Kind.FOLD, Kind.LOSS)
        assert found in (Kind.UNDECIDED, Kind.FOLD if own == root else Kind.LOSS)
        counts["undecided" if found is Kind.UNDECIDED else "changes" if own == root else "keeps"] += 1
    assert min(counts.values()) > 20, counts


# The level


def test_parts_on_which_the_level_is_regular_are_those_on_which_a_derivative_is_not_0() -> None:
    """Of two derivatives along the curve, at random; where both vanish, or may, nothing is listed."""
    chance = random.Random(6)
    gaps_seen = 0
    for _ in range(40):
        rows = [[Q(chance.randint(-8, 8), 8) for _ in range(3)] for _ in range(2)]
        if chance.random() < 0.6:
            common = [-Q(chance.randint(-48, 48), 64), Q(1)]
            rows = [times(common, row[:2]) for row in rows]
        functions = [BoundedFunction(ball_polynomial(row), arb(0)) for row in rows]

        def slopes(program: Any, stretch: Any, low: Q, high: Q, functions: Any = functions) -> list[arb]:
            return [function.value(between(low, high)) for function in functions]

        level: Any = object.__new__(Level)
        level._program, level._title, level._slopes, level._gradient = object(), "H", {}, slopes
        stretch: Any = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id="p")))
        cuts = [Q(-7, 8), Q(chance.randint(-40, 0), 64), Q(chance.randint(1, 40), 64), Q(7, 8)]
        entered = cuts[0] + Q(chance.randint(0, 8), 64)
        given = [segment_with(functions[:1], low, min(max(low, entered), high), high) for low, high in pairwise(cuts)]
        found, gaps = level.regular(stretch, given)
        gaps_seen += len(gaps)
        parts = sorted([(each.start, each.end) for each in (*found, *gaps)])
        assert parts[0][0] == cuts[0]
        assert parts[-1][1] == cuts[-1]
        assert all(before[1] == after[0] for before, after in pairwise(parts))
        for part in found:
            (own,) = [each for each in given if each.start <= part.start < part.end <= each.end]
            assert part.entered == min(max(own.entered, part.start), part.end)
            assert part.characteristic == own.characteristic
            for n in range(17):
                s = float(part.start + (part.end - part.start) * n / 16)
                assert any(abs(value_at(row, s)) > 1e-12 for row in rows)
        least = min(max(abs(value_at(row, float(p.start + (p.end - p.start) * n / 16))) for row in rows)
                    for p in found for n in range(17)) if found else 1.0  # fmt: skip
        assert all(0 < bound <= least + 1e-12 for bound in level._slopes.values())
        assert all((gap.stretch, gap.piece, gap.subject) == (0, "p", Matter.EVERYTHING) for gap in gaps)
    assert gaps_seen > 10


@pytest.mark.parametrize("sign", [1, -1])
def test_the_derivative_of_the_level_on_a_part_is_that_at_all_its_points(sign: int) -> None:
    """Along y = beta^2/100, known up to a deviation of either sign."""
    atlas, found = parabola(Claim("arc", None, ("beta",)))
    stretch, piece = proof(concluded((atlas, found))).chain.stretches[0], atlas.curve_pieces()[1]
    tube = read_tube(piece, values([proved(piece, deviation=["0x1p-21"])]))
    stretch = replace(stretch, tube=tube, run=tube.runs[0], enters=Q(-1), leaves=Q(1))
    program = record(lambda s, p: (s[0] * s[0] * s[1] + p[0] * s[1] * s[1] * s[1],), ("beta", "y"), ("c",))
    level: Any = object.__new__(Level)
    level._known, level._names, level._system = {"c": enclose(Q(5))}, ("beta", "y"), None
    for low, high in ((Q(-1), Q(-1, 2)), (Q(1, 4), Q(1, 2)), (Q(0), Q(1))):
        slopes = level._gradient(program, stretch, low, high)
        for s in (low, high, (low + high) / 2, low + (high - low) / 64):
            beta = piece.centre[0] + piece.half_width * s
            y = piece.centre[1] + piece.frame[1][0] * piece.half_width * s + piece.polynomial[0][2] * s**2
            y += sign * Q(1, 2**21)
            for slope, wanted in zip(slopes, (2 * beta * y, beta**2 + 15 * y**2), strict=True):
                assert slope.contains(enclose(wanted))
                assert slope.rad() < abs(slope.mid()) + 1


def test_ends_of_balls_are_beyond_all_of_their_points() -> None:
    chance = random.Random(7)
    for _ in range(200):
        ball = arb(chance.uniform(-1, 1)) + arb(0, 1) * arb(chance.choice((0.0, 2.0**-190, 2.0**-20, 0.5)))
        low, high = ends_of(ball)
        middle, radius = exact_value(ball.mid()), exact_value(ball.rad())
        assert low <= middle - radius
        assert high >= middle + radius
        assert high - low <= 2 * radius + Q(1, 2**150)


def test_a_zero_is_in_what_newton_leaves_of_its_interval_for_every_member() -> None:
    """Also where the derivative may vanish, and nothing is gained."""
    chance = random.Random(8)
    narrowed = 0
    for _ in range(200):
        root = Q(chance.randint(-20, 20), 64)
        slope = chance.choice((-1, 1)) * Q(chance.randint(1, 16), 4)
        member = times([slope], [-root, Q(1)], [Q(chance.randint(3, 8)), Q(chance.randint(-2, 2))])
        error = chance.choice((Q(0), Q(1, 2**20), Q(1, 8), Q(3))) * chance.choice((-1, 1))
        function = known_beside(member, error, chance.randint(0, 3))
        low, high = root - Q(chance.randint(0, 16), 32), root + Q(chance.randint(1, 16), 32)
        found = _narrowed(function, low, high)
        assert found.contains(enclose(root))
        narrowed += found.rad() < enclose((high - low) / 16)
    assert narrowed > 50


# Out of the plane


class Planar:
    """Two pieces, on each of which V is known as polynomials of s; in the plane nothing is known to happen."""

    def __init__(self, seed: int) -> None:
        chance = self.chance = random.Random(f"across {seed}")
        self.rows: list[list[Polynomial]] = []
        segments, stretches = [], []
        for number in range(2):
            tube = SimpleNamespace(piece=SimpleNamespace(id="pq"[number]), is_symmetric=False)
            stretches.append(SimpleNamespace(tube=tube, enters=Q(-1), entered=Q(-1), leaves=Q(1)))
            rows = []
            for place in chance.sample(range(-56, 57), 4):
                root = Q(place, 64) + Q(1, 2**9)
                rows.append(times([Q(chance.choice((-1, 1)) * chance.randint(4, 12), 8)], [-root, Q(1)]))
            self.rows.append(rows)
            own = [BoundedFunction(ball_polynomial(by_tau(row, Q(0), Q(33, 32))), arb(0)) for row in rows]
            flat = BoundedFunction(arb_poly([5]), arb(0))
            segments.append(
                Segment(number, Q(-1), Q(-1), Q(1), Q(0), Q(33, 32), (flat,), flat, flat, flat, None,
                        KnownVariations(tuple(own)))
            )  # fmt: skip
        self.chain: Any = SimpleNamespace(stretches=stretches)
        self.plane = CompleteList(4, 1, (), (), tuple(segments))
        system = SimpleNamespace(normalised={}, centre_coordinates=(), stiffness_across_program=None,
                                 derived_parameters={})  # fmt: skip
        claim = SimpleNamespace(symmetry=None, goes_round=False)
        self.atlas: Any = SimpleNamespace(system=system, claim=claim)

    def root(self, number: int, entry: int) -> Q:
        row = self.rows[number][entry]
        return -row[0] / row[1]

    def listed(self, certified: Sequence[Bifurcation] = ()) -> Any:
        return across_list.list_across(self.atlas, self.chain, self.plane, certified)


@pytest.mark.parametrize("seed", range(6))
def test_out_of_the_plane_every_entry_of_every_part_has_its_zeros(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lists, "point_over", lambda stretch, s: ())
    monkeypatch.setattr(across_list, "is_left_alone", lambda *_: True)
    planar = Planar(seed)
    found = planar.listed().found
    assert found.gaps == ()
    for segment, rows in zip(found.segments, planar.rows, strict=True):
        (function,) = segment.characteristic
        for s in (Q(-1, 2), Q(1, 3)):
            v = [sum((c * s**n for n, c in enumerate(row)), Q(0)) for row in rows]
            assert (function.value(segment.tau_of(enclose(s))) + arb(0, 1e-20)).contains(
                enclose(v[0] * v[3] + v[1] * v[2])
            )
    kinds = {1: Kind.ACROSS_AXIAL, 2: Kind.ACROSS_SYMMETRIC, 0: Kind.ACROSS_DOUBLING, 3: Kind.ACROSS_DOUBLING}
    expected = []
    for number, rows in enumerate(planar.rows):
        expected += [(number, kinds[entry], 1 if entry in (1, 2) else 2, float(planar.root(number, entry)))
                     for entry in range(4)]  # fmt: skip
        parameter = plus(times(rows[0], rows[3]), times(rows[1], rows[2]))
        for k, value in ((3, -0.5), (4, 0.0)):
            moved = [float(c) for c in parameter]
            moved[0] -= value
            expected += [(number, Kind.RESONANCE, k, x.real) for x in np.roots(moved[::-1])
                         if abs(x.imag) < 1e-12 and abs(x.real) < 1]  # fmt: skip
    assert len(found.points) == len(expected)
    for number, kind, k, place in expected:
        alike = [point for point in found.points if (point.stretch, point.kind, point.k) == (number, kind, k)]
        here = [point for point in alike if agree(point.s, near(place))]
        assert len(here) == 1
    # Where zeros are not separated this is told of their entry alone.
    square = BoundedFunction(ball_polynomial(times([-Q(1, 9), Q(1)], [-Q(1, 9), Q(1)])), arb(0))
    own = planar.plane.segments[1].out_of_plane
    assert own is not None
    for entry, subject in ((1, Resonance(1, 0)), (3, Resonance(2, 1))):
        entries = tuple(square if n == entry else each for n, each in enumerate(own.entries))
        changed = replace(planar.plane.segments[1], out_of_plane=KnownVariations(entries))
        beside = Planar(seed)
        beside.plane = replace(planar.plane, segments=(planar.plane.segments[0], changed))
        gaps = [gap for gap in beside.listed().found.gaps if gap.subject == subject]
        assert [gap.stretch for gap in gaps] == [1]
    # Where V is not known nothing is, and says so.
    first, second = planar.plane.segments
    planar.plane = replace(planar.plane, segments=(first, replace(second, out_of_plane=None)))
    (gap,) = planar.listed().found.gaps
    assert (gap.stretch, gap.piece, gap.start, gap.end, gap.subject) == (1, "q", Q(-1), Q(1), Matter.EVERYTHING)


@pytest.mark.parametrize("seed", range(6))
def test_orbits_out_of_the_plane_are_born_under_their_own_symmetry(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lists, "point_over", lambda stretch, s: ())
    monkeypatch.setattr(across_list, "is_left_alone", lambda *_: True)
    planar = Planar(seed)
    for number in range(2):
        for entry, reversor, kind in ((1, AXIAL, Kind.ACROSS_AXIAL), (2, None, Kind.ACROSS_SYMMETRIC)):
            place = PlaceOnCurve("pq"[number], enclose(planar.root(number, entry)), False)
            birth = Bifurcation("b", "symmetry_breaking", 1, place, "", {}, reversor=reversor)
            points = [point for point in planar.listed([birth]).found.points if point.certificates]
            assert [(point.stretch, point.kind) for point in points] == [(number, kind)]
            assert agree(points[0].s, place.s)
            other = replace(birth, reversor=None if reversor else AXIAL)
            with pytest.raises(EmptyIntersectionError, match="no zero"):
                planar.listed([other])
            # In units of the orbit nothing begins where its size may be 0.
            for size, wanted in ((arb(0, 1), Kind.UNDECIDED), (arb(2, 1), kind)):
                function = BoundedFunction(arb_poly([size.mid()]), size.rad())
                own = tuple(replace(segment, level=function) for segment in planar.plane.segments)
                inner = Planar(seed)
                inner.atlas.system.normalised = {"x": Q(1)}
                inner.plane = replace(planar.plane, segments=own)
                here = [point for point in inner.listed().found.points if agree(point.s, place.s) and point.k == 1]
                assert wanted in {point.kind for point in here if point.stretch == number}


# At touching


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("side", [1, -1])
def test_a_stationary_value_at_the_end_of_the_band_may_be_in_it(count: int, side: int) -> None:
    """It is 11/10, or a little less; or more, by as much as the error leaves open, or by much."""
    for error in (Q(1, 2**30), Q(1, 2**20)):
        for beyond in (Q(0), -error / 4, error / 4, -Q(1, 2**6), Q(1, 8)):
            for bend in (1, -1):
                parameter = [side * (BAND + beyond), Q(0), Q(bend)]
                # Somewhere else than at the middle of the interval.
                parameter = by_tau(parameter, Q(1, 7), Q(1))
                rows = [parameter] if count == 1 else [plus(parameter, [Q(9)]), times(parameter, [Q(9)])]
                known = [known_beside(row, error, 0) for row in rows]
                found, undecided = extrema_on(segment_with(known, -END, -END, END), 0)
                here = [value for tau, value in found if tau.contains(enclose(Q(-1, 7)))]
                is_open = any(low <= Q(-1, 7) <= high for low, high in undecided)
                assert beyond > 0 or here or (is_open and count == 2)
                assert beyond < Q(1, 8) or not here
                assert beyond < Q(1, 8) or not undecided or count == 2
                for value in here:
                    assert value.contains(enclose(side * (BAND + beyond)))
                    assert not is_in_band(value) or beyond < 0


def test_the_derivative_of_a_level_with_functions_is_that_of_all_points() -> None:
    system = define_system({
        "name": "functions", "state": "x y vx vy", "R": {"vx": -1, "vy": -1}, "section": "vy",
        "field": {"x": "vx", "y": "vy", "vx": "-exp(x)*cos(y)-sin(x)", "vy": "exp(x)*sin(y) - 1/(2+y)"},
        "first_integral": "(vx**2 + vy**2)/2 + exp(x)*cos(y) - cos(x) + log(2+y)",
    })  # fmt: skip
    program = system.first_integral_program
    assert program is not None
    chance = random.Random(9)
    for _ in range(20):
        x, y = (arb(chance.uniform(-1, 1)) for _ in range(2))
        radius = arb(2) ** -chance.choice((4, 20, 60))
        known = {"x": x + arb(0, 1) * radius, "y": y + arb(0, 1) * radius, "vx": arb(1) / 3, "vy": arb(0)}
        # Values of the functions follow from those of their arguments.
        arguments = [known.get(name, arb(77)) for name in program.inputs]
        found = gradient(program, arguments, ("x", "y", "vx"), system)
        for a, b in ((0, 0), (1, 1), (-1, 1), (1, -1)):
            at, to = x + a * radius, y + b * radius
            wanted = at.exp() * to.cos() + at.sin(), -at.exp() * to.sin() + 1 / (2 + to), arb(1) / 3
            assert all(agree(slope, value) for slope, value in zip(found, wanted, strict=True))
        assert all(slope.rad() < 20 * radius + 2.0**-150 for slope in found)


# Where something may change


def point_at(stretch: int, s: arb, kind: Kind, k: int) -> Point:
    return Point(stretch, "p", k, min(k - 1, 1) if k else 0, kind, s, arb(0), arb(1), {})


def test_places_of_change_hold_the_whole_of_points_and_of_ends() -> None:
    chance = random.Random(10)
    tube = SimpleNamespace(piece=SimpleNamespace(id="p"))
    for _ in range(60):
        stretches = [SimpleNamespace(tube=tube, enters=Q(-1), entered=Q(-15, 16), leaves=Q(1)) for _ in range(2)]
        chain: Any = SimpleNamespace(stretches=stretches)
        balls = [(chance.randrange(2), arb(chance.uniform(-1, 1)) + arb(0, 1) * 2.0 ** -chance.randint(2, 9))
                 for _ in range(chance.randint(0, 5))]  # fmt: skip
        points = tuple(point_at(stretch, s, Kind.FOLD, 1) for stretch, s in balls)
        gaps = []
        for _ in range(chance.randint(0, 2)):
            low = Q(chance.randint(-60, 40), 64)
            gaps.append(Gap(chance.randrange(2), "p", low, low + Q(chance.randint(0, 20), 64), Resonance(1, 0), ""))
        found = CompleteList(2, 1, points, tuple(gaps), ())
        bounds = list(bounds_on(chain, found, lambda point: True, lambda subject: True))
        for before, after in pairwise(bounds):
            assert (before.stretch, before.upper) < (after.stretch, after.lower)
        covered = [(stretch, *ends_of(s)) for stretch, s in balls]
        covered += [(gap.stretch, gap.start, gap.end) for gap in gaps] + [(0, Q(-1), Q(-15, 16)), (1, Q(1), Q(1))]
        for stretch, low, high in covered:
            here = [each for each in bounds if each.stretch == stretch and each.lower <= low <= high <= each.upper]
            assert len(here) == 1
            is_gap = any((gap.stretch, gap.start, gap.end) == (stretch, low, high) for gap in gaps)
            assert not here[0].is_one_point or ((low, high) == (here[0].lower, here[0].upper) and not is_gap)


def test_a_symmetric_point_is_the_end_of_the_curve_only_where_both_are_one_place() -> None:
    end = Bound(0, Q(0), Q(0), (CurveEnd.END,))
    for kind, s, alone in (
        (Kind.SYMMETRIC, arb(0), True),
        (Kind.SYMMETRIC, arb(0, 0.125), False),
        (Kind.FOLD, arb(0), False),
    ):
        point = point_at(0, s, kind, 1)
        both = Bound(0, *ends_of(s), (point.found,), point)
        for first, second in ((end, both), (both, end)):
            found = _together(first, second)
            assert found.is_one_point == alone
            assert found.lower <= Q(0) <= found.upper
            if alone:
                assert found is both


def test_the_orbit_that_decides_lies_between_its_places_and_on_the_curve() -> None:
    chance = random.Random(11)
    tube = SimpleNamespace(piece=SimpleNamespace(id="p"))
    seen = 0
    for _ in range(200):
        entered = Q(chance.randint(-60, -30), 64)
        stretches = [SimpleNamespace(tube=tube, enters=Q(-1), entered=entered, leaves=Q(1)) for _ in range(2)]
        chain: Any = SimpleNamespace(stretches=stretches)
        flat = BoundedFunction(arb_poly([0]), arb(0))
        cut = Q(chance.randint(-62, 60), 64)
        own = [replace(segment_with([flat], low, min(max(low, entered), high), high), stretch=stretch)
               for stretch in range(2) for low, high in ((Q(-1), cut), (cut, Q(1)))]  # fmt: skip
        own = [replace(each, middle=Q(1, 3), radius=Q(5, 4)) for each in own]
        places = sorted((chance.randrange(2), Q(chance.randint(-64, 64), 64)) for _ in range(2))
        before, after = (Bound(stretch, s, s + Q(chance.randint(0, 8), 64), ()) for stretch, s in places)
        if (before.stretch, before.upper) > (after.stretch, after.lower):
            continue
        found = orbit_between(chain, own, before, after)
        if found is not None:
            segment, tau = found
            s = segment.s_of(tau)
            assert (before.stretch, before.upper) <= (segment.stretch, exact_value(s.mid()))
            assert (segment.stretch, exact_value(s.mid())) <= (after.stretch, after.lower)
            assert segment.entered <= exact_value(s.mid()) <= segment.end
            seen += 1
    assert seen > 60


def test_of_a_loop_that_is_cut_the_ranges_are_known_if_they_are_on_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    tube = SimpleNamespace(piece=SimpleNamespace(id="p"))
    chain: Any = SimpleNamespace(stretches=[SimpleNamespace(tube=tube, enters=Q(-1), entered=Q(-1), leaves=Q(1))])
    inside = BoundedFunction(arb_poly([0]), arb(0))
    segment = segment_with([inside], Q(-1), Q(-1), Q(1))
    folds = tuple(point_at(0, arb(place), Kind.FOLD, 1) for place in (-0.5, 0.5))
    found = CompleteList(2, 1, folds, (), (segment,))
    for lost in (None, Q(-1), Q(1, 2)):
        known: Any = Ranges(arb(3), None, None)

        def ranges(_: Any, begin: Any, end: Any, lost: Any = lost, known: Any = known) -> Any:
            return None if begin[1] == lost else known

        monkeypatch.setattr(linear_stability, "ranges_between", ranges)
        stable, unknown = stable_intervals(chain, found, True)
        assert unknown == []
        around = [entry for entry in stable if entry.begin.lower == Q(1, 2)]
        assert [(entry.begin.lower, entry.end.lower) for entry in around] == [(Q(1, 2), Q(-1, 2))]
        assert (around[0].ranges is None) == (lost is not None)


def test_the_ranges_of_an_interval_are_those_of_all_orbits_that_may_be_between_its_places() -> None:
    """A place is a point of its ball: on both sides of it there may be orbits of the interval in the ball."""
    chance = random.Random(12)
    tube = SimpleNamespace(piece=SimpleNamespace(id="p"))
    stretches = [SimpleNamespace(tube=tube, enters=Q(-1), entered=Q(-15, 16), leaves=Q(1)) for _ in range(2)]
    chain: Any = SimpleNamespace(stretches=stretches)
    inside, seen = BoundedFunction(arb_poly([0]), arb(0)), 0
    for _ in range(60):
        lines = [(arb(chance.randint(-9, 9)), arb(chance.randint(-9, 9))) for _ in stretches]
        segments = tuple(
            replace(
                segment_with([inside], Q(-1), Q(-15, 16), Q(1)),
                stretch=stretch,
                half_period=BoundedFunction(arb_poly(list(line)), arb(0)),
            )
            for stretch, line in enumerate(lines)
        )
        points = tuple(
            point_at(chance.randrange(2), arb(chance.uniform(-0.9, 0.9)) + arb(0, 1) * 2.0**-9, Kind.FOLD, 1)
            for _ in range(chance.randint(1, 4))
        )
        for entry in stable_intervals(chain, CompleteList(2, 1, points, (), segments), False)[0]:
            assert entry.ranges is not None
            places = (entry.begin.stretch, entry.begin.lower), (entry.end.stretch, entry.end.upper)
            for stretch, s in (*places, *((number, end) for number in (0, 1) for end in (Q(-1), Q(1)))):
                if places[0] <= (stretch, s) <= places[1]:
                    value = segments[stretch].half_period.value(enclose(segments[stretch].tau(s)))
                    assert entry.ranges.half_period.contains(value)
                    seen += 1
    assert seen > 200


def test_a_part_meets_the_symmetric_point_if_that_is_one_of_its_ends() -> None:
    flat = BoundedFunction(arb_poly([0]), arb(0))
    for start, end, at in ((0, 1, -1), (-1, 0, 1), (-1, 1, 0), (Q(1, 4), 1, 0), (-1, Q(-1, 4), 0)):
        segment = segment_with([flat], Q(start), Q(start), Q(end))
        assert segment.meets_symmetric_point == at
        assert replace(segment, middle=Q(1, 2)).meets_symmetric_point == 0


def test_distances_that_are_none_of_the_orbits_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file may name some of a system that has none."""
    atlas, found = parabola(Claim("arc", None, ("beta",)))
    one, marker = constant(Q(1)), cast(Any, object())
    known = StabilityFunctions((one,), one, one, one, marker)
    given = [replace(cast(Any, each), stability=known) for each in values(found)]
    seen: list[Any] = []

    def stops(_: Any, chain: Any, results: Any, *rest: Any) -> Any:
        seen.extend(results)
        raise EmptyIntersectionError("seen")

    monkeypatch.setattr(proved_list, "complete_list", stops)
    conclusion = conclude_list(atlas, given, concluded((atlas, found)), 4)
    assert not isinstance(conclusion.outcome, Proved)
    assert [each.stability for each in seen] == [replace(known, distance=None)] * len(given)


@pytest.mark.parametrize("value", [Q(1, 2), Q(3, 2), Q(-3, 2), None])
def test_between_two_places_orbits_are_stable_or_not_or_it_is_said_that_nothing_is_known(value: Q | None) -> None:
    """Of one parameter c, or where no functions are known."""
    tube = SimpleNamespace(piece=SimpleNamespace(id="p"))
    chain: Any = SimpleNamespace(stretches=[SimpleNamespace(tube=tube, enters=Q(-1), entered=Q(-1), leaves=Q(1))])
    point = point_at(0, arb(0), Kind.FOLD, 1)
    for error in (Q(0), Q(-4) if (value or 0) > 0 else Q(4)):
        function = known_beside([value or Q(0)], error, 0)
        segments = () if value is None else (segment_with([function], Q(-1), Q(-1), Q(1)),)
        stable, unknown = stable_intervals(chain, CompleteList(2, 1, (point,), (), segments), False)
        places = [[(entry.begin.upper, entry.end.lower) for entry in entries] for entries in (stable, unknown)]
        both = [(Q(-1), Q(0)), (Q(0), Q(1))]
        if error or value is None:
            assert places == [[], both]
        else:
            assert places == [both if abs(value) < 1 else [], []]


def test_the_middle_of_a_regular_piece_is_no_symmetric_point(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a part of it begins or ends at s = 0 nothing is left out there."""
    monkeypatch.setattr(lists, "point_over", lambda stretch, s: ())
    stretch: Any = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id="p"), is_symmetric=False))
    for side in (1, -1):
        start, end = sorted((Q(0), side * Q(7, 8)))
        # c - 1 = (s - a)(s - b) with a and b near 0 and farther out; between them c is stationary.
        member = plus([Q(1)], times([-side * Q(1, 32), Q(1)], [-side * Q(1, 8), Q(1)]))
        segment = segment_with([known_beside(member, Q(0), 0)], start, start, end)
        segment = replace(segment, level=known_beside([Q(0), Q(1)], Q(0), 0))
        finder = lists.Finder(ATLAS, stretch, segment)
        finder.resonances(1, 0)
        finder.turns()
        places = [side * Q(1, 32), side * Q(1, 8)]
        assert [point.kind for point in finder.points] == [Kind.LOSS] * 2
        assert all(any(point.s.contains(enclose(place)) for point in finder.points) for place in places)
        (extremum,) = finder.extrema
        assert extremum.s.contains(enclose(side * Q(5, 64)))


@pytest.mark.parametrize("stable", [True, False, None])
def test_combinations_of_orbits_of_which_stability_is_not_decided_are_named(
    stable: bool | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lists, "point_over", lambda stretch, s: ())
    monkeypatch.setattr(lists, "is_stable", lambda segment, tau: stable)
    stretch: Any = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id="p"), is_symmetric=False))
    # c_1 + c_2 = 0 at s = 1/8.
    rows = [[-Q(1, 8), Q(1)], [Q(-1, 3), Q(1, 16)]]
    segment = segment_with([known_beside(row, Q(0), 0) for row in rows], Q(-1, 2), Q(-1, 2), Q(1, 2))
    finder = lists.Finder(ATLAS, stretch, segment)
    finder.combinations()
    listed = [point for point in finder.points if point.kind is Kind.OPPOSITE and point.s.contains(enclose(Q(1, 8)))]
    named = [gap for gap in finder.gaps if gap.start <= Q(1, 8) <= gap.end and gap.subject is Matter.COMBINATIONS]
    assert (len(listed), bool(named)) == (int(stable is True), stable is None)


@pytest.mark.parametrize("goes_round", [False, True])
def test_a_loop_alone_goes_on_where_it_is_cut(goes_round: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    atlas, found = parabola(Claim("arc", None, ("beta",)))
    other: Any = SimpleNamespace(system=atlas.system, claim=SimpleNamespace(symmetry=None, goes_round=goes_round))
    asked: list[bool] = []

    def stops(chain: Any, found: Any, closed: bool) -> Any:
        asked.append(closed)
        raise LookupError

    monkeypatch.setattr(proved_list, "complete_list", lambda *_: CompleteList(2, 1, (), (), ()))
    monkeypatch.setattr(proved_list, "stable_intervals", stops)
    with pytest.raises(LookupError):
        conclude_list(other, values(found), concluded((atlas, found)), 2)
    assert asked == [goes_round]


def test_intervals_that_meet_are_one_and_nothing_of_them_is_lost() -> None:
    chance = random.Random(12)
    for _ in range(100):
        # Parts of one interval, as it is divided.
        cuts = sorted(Q(n, 4) for n in chance.sample(range(-16, 25), chance.randint(2, 9)))
        given = [part for part in pairwise(cuts) if chance.random() < 0.6]
        chance.shuffle(given)
        found = _merged(given)
        assert all(before[1] < after[0] for before, after in pairwise(found))
        for n in range(-80, 120):
            place = Q(n, 16)
            assert any(low <= place <= high for low, high in found) == any(low <= place <= high for low, high in given)
