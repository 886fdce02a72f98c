"""The Conley-Zehnder index: flows of which it is known, another way to find it, and indices that are false."""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from flint import acb, arb, arb_poly, ctx, fmpz_poly
from support.balls import agree
from support.forgeries import atlas_certificate, checked_by, forged
from support.graph_index import index_of_orbit
from support.stored import values

from orbitproof import verify
from orbitproof.shared import IndexAlong
from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import InputError, atlas_from_json, read_atlas
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_AXIAL, FALKNER_SKAN, LIFTED, MASS_PARAMETERS, VERTICAL
from orbitproof.verify.__main__ import main
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.branches import certified_index, conclusion_of, make_atlas_certificate
from orbitproof.verify.branches import index as of_indices
from orbitproof.verify.certificate import (
    CannotBeCheckedError,
    Certificate,
    Finding,
    Level,
    Recheck,
    read_certificate,
    recheck,
    write_certificate,
)
from orbitproof.verify.curve import ProvedCurve, conclude, derived_parameter
from orbitproof.verify.evidence import Checklist, IntegrationFailure, NotProved, Proved
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.index import (
    CountedOrbit,
    HalfTurns,
    Interval,
    Start,
    along_curve,
    conclude_index,
    followed,
    following,
    intervals_of,
    places_in,
    proved_index,
    start_at,
)
from orbitproof.verify.index.half_turns import Turning, determinant, index_of
from orbitproof.verify.index.libration_value import _whole, index_of_small_orbits, reaches_rest
from orbitproof.verify.index.moving import Moving, moving, reduced
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.run import index_command, proof_command
from orbitproof.verify.stability import Bound, Gap, Matter, ProvedList, Resonance, StabilityResult, conclude_list
from orbitproof.verify.words.index import index_in_words

DATA = Path(__file__).parents[1] / "data"
PLANAR, AXIAL, RETROGRADE, LOOP = "lyapunov", "births-of-axial-orbits", "distant-retrograde", "fold-and-doublings"
MU = MASS_PARAMETERS["earth-moon"]


VERTICAL_ORBIT = (0.8448880879238473, 0.0, 0.0, 0.0, 0.016717296437398197, 0.22414688882138184)
AXIAL_ORBIT = (0.7999931275688026, 0.0, 0.0, 0.0, 0.3702779560097634, 0.23447847332955463)


@cache
def case(name: str) -> tuple[Atlas, Any]:
    """A curve, and what is proved of its pieces."""
    if name == PLANAR:
        return read_atlas(DATA / "atlas-lyapunov.json"), json.loads((DATA / "stability-lyapunov.json").read_text())
    stored = json.loads((DATA / "three-body-arcs.json").read_text())[name]
    return atlas_from_json(stored["atlas"], name), stored["results"]


def turned(angle: float) -> acb:
    """e^(i angle), with some uncertainty."""
    return acb(arb(math.cos(angle), 1e-12), arb(math.sin(angle), 1e-12))


def orthogonal(chance: random.Random, size: int) -> list[list[float]]:
    rows: list[list[float]] = []
    while len(rows) < size:
        row = [chance.gauss(0, 1) for _ in range(size)]
        for other in rows:
            share = sum(a * b for a, b in zip(row, other, strict=True))
            row = [a - share * b for a, b in zip(row, other, strict=True)]
        length = math.hypot(*row)
        rows.append([a / length for a in row])
    return rows


@pytest.mark.parametrize("planes", [1, 2])
@pytest.mark.parametrize("with_flow", [False, True])
def test_the_index_of_rotations_is_that_of_their_turns(planes: int, with_flow: bool) -> None:
    chance = random.Random(7 * planes + with_flow)
    for _ in range(200):
        angles = [chance.uniform(-9, 9) for _ in range(planes)]
        if min(abs(math.sin(2 * angle)) for angle in angles) < 1e-2:
            continue
        frame = orthogonal(chance, planes + with_flow)
        along = [acb(chance.uniform(1, 2) * entry) for entry in frame[-1]]
        rows = [[turned(angle) * entry for entry in row] for angle, row in zip(angles, frame, strict=False)]
        if planes == 2:
            # Another real basis of the same planes.
            mixed = chance.uniform(-3, 3)
            rows[1] = [a - mixed * b for a, b in zip(rows[1], rows[0], strict=True)]
        negated = [[acb(0, 1) * entry for entry in row] for row in rows]
        if with_flow:
            # Vectors are known up to multiples of the field, which is i times the gradient.
            share = acb(0, chance.uniform(-5, 5))
            rows[0] = [a + share * b for a, b in zip(rows[0], along, strict=True)]
        known = index_of(
            [arb(sum(angles), 1e-9)] * 2,
            (tuple(along),) if with_flow else (),
            tuple(map(tuple, rows)),
            tuple(map(tuple, negated)),
        )
        assert known.index == sum(2 * math.floor(angle / math.pi) + 1 for angle in angles)
        assert known.fixed == known.negated == sum(math.floor(angle / math.pi) for angle in angles)


@pytest.mark.parametrize("turns", [-2, 0, 1, 3])
def test_the_index_of_a_hyperbolic_flow_that_turns_is_twice_its_turns(turns: int) -> None:
    for rate in (-0.7, 0.3, 2.0):
        c, s = math.cosh(rate), math.sinh(rate)
        half = turns * math.pi
        first, second = acb(c, s) * turned(half), acb(s, c) * turned(half)
        angles = [arb(half + math.atan2(s, c), 1e-9), arb(half + math.atan2(c, s) - math.pi / 2, 1e-9)]
        assert index_of(angles, (), ((first,),), ((second,),)).index == 2 * turns


def test_an_end_between_half_turns_that_is_not_known_is_refused() -> None:
    for angle in (arb(1, 4), arb(math.pi, 1e-3), arb("nan")):
        with pytest.raises(IntegrationFailure, match="half turns"):
            index_of([angle] * 2, (), ((acb(angle.cos(), angle.sin()),),), ((acb(-angle.sin(), angle.cos()),),))
    sure = index_of([arb(1)] * 2, (), ((turned(1),),), ((turned(1 + math.pi / 2),),))
    assert (sure.fixed, sure.negated) == (0, 0)
    # An angle that was followed roughly is as well known as the vectors at the end.
    rough = index_of([arb(1, 1.5)] * 2, (), ((turned(1),),), ((turned(1 + math.pi / 2),),))
    for angle in rough.angles:
        assert (angle * arb.pi()).contains(1)
        assert angle.rad() < 1e-9
    assert (rough.fixed, rough.negated) == (0, 0)
    # Angles that are not those of the vectors at the end.
    with pytest.raises(IntegrationFailure, match="half turns"):
        index_of([arb(1.5)] * 2, (), ((turned(1),),), ((turned(1 + math.pi / 2),),))


def test_an_argument_is_followed_within_a_half_plane_only() -> None:
    turning = Turning(turned(0))
    assert not turning.reaches([turned(0.5)], turned(1.6))
    assert not turning.reaches([turned(2.8)], turned(1))
    assert not turning.reaches([acb(arb(0, 1), arb(0, 1))], turned(1))
    assert not turning.reaches([turned(0.5) + acb(arb(0, 2), arb(0, 2))], turned(1))
    assert not turning.reaches([turned(0.5)], turned(1) + acb(arb(0, 2), arb(0, 2)))
    assert not turning.reaches([acb("nan")], turned(1))
    for step in range(1, 12):
        assert turning.reaches([turned(step - 0.5)], turned(step))
        turning.go_on(turned(step))
    assert agree(turning.angle, arb(11))
    assert turning.angle.rad() < 1e-6


def test_the_angles_over_a_ball_of_starts_contain_those_of_its_points(monkeypatch: pytest.MonkeyPatch) -> None:
    state, radius = AXIAL_ORBIT, 2.0**-36
    lengths: list[Fraction] = []
    delays: list[arb] = []
    to_the_section, advanced = following._HalfOrbit._to_the_section, following.advance
    heights: list[arb] = []
    ends: list[bool] = []

    def noted(orbit: Any, end: Any) -> None:
        delays.extend(moving([orbit.orbits.delay], 0, Fraction(1)).over(arb(0)))
        states, part, go_on = [], orbit._part, orbit._go_on

        def kept(solution: Any) -> Any:
            states.append(moving(solution, 0, Fraction(1)))
            return part(solution)

        def over_all_times(over: Any, end: Any) -> bool:
            heights[:] = [state.over(part.theta)[1] for state, part in zip(states[-2:], over, strict=True)]
            return bool(go_on(over, end))

        orbit._part, orbit._go_on = kept, over_all_times
        to_the_section(orbit, end)
        # There variations are along the section; at the end of the step they are not.
        assert all(abs(variation.over(arb(0))[1]) < 1e-3 for variation in end.variations)
        # A step that is shorter than the way to the section is not followed backwards, nor a long way either way.
        flow, begun, length = orbit.orbits.step_taken
        far = [(length, orbit.arithmetic.constant(Fraction(delay)), True) for delay in (-1, 1)]
        own, taken = orbit.orbits.delay, lengths[:]
        for last, delay, reached in ((Fraction(1, 2**60), own, True), *far, (length, own, False)):
            orbit.orbits.step_taken, orbit.orbits.delay = (flow, begun, last), delay
            orbit._go_on = lambda *_, reached=reached: reached
            with pytest.raises(IntegrationFailure, match="end of the half orbit"):
                to_the_section(orbit, end)
        lengths[:] = taken
        vectors = orbit._vectors

        def at_the_section(block: Any, part: Any) -> Any:
            ends.append(part is end)
            return vectors(block, part)

        orbit._vectors = at_the_section

    def measured(*given: Any) -> Any:
        lengths.append(given[-1])
        return advanced(*given)

    monkeypatch.setattr(following._HalfOrbit, "_to_the_section", noted)
    monkeypatch.setattr(following, "advance", measured)
    (wide,) = followed(Start(CR3BP_AXIAL, tuple(arb(x, radius if x else 0) for x in state), MU, 1, False), 128, ORACLE)
    # What is counted is what the vectors are at the section.
    assert ends == [True]
    # The last step leads beyond all times at which orbits of the ball come to the section.
    assert abs(delays[0]) < float(lengths[-1])
    # The end of the step before it is followed again: y, whose speed is between 1/8 and 1/2, has either sign there.
    reach = float(lengths[-1]) / 8
    assert abs(delays[0]) / 2 < reach
    assert any(height.lower() < -reach for height in heights)
    assert any(height.upper() > reach for height in heights)
    # Both parts begin at the end of that step.
    assert all(height.contains(0) for height in heights)
    for sign in (-1, 1):
        point = tuple(arb(x + sign * radius * (0.9 if x else 0)) for x in state)
        (sharp,) = followed(Start(CR3BP_AXIAL, point, MU, 1, False), 128, ORACLE)
        assert wide.index == sharp.index
        for one, other in zip(wide.angles, sharp.angles, strict=True):
            assert one.contains(other)
            assert other.rad() < one.rad() / 1000


def test_the_symplectic_form_of_variations_is_the_same_at_both_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    ends: list[Any] = []
    to_the_section = following._HalfOrbit._to_the_section

    def noted(orbit: Any, end: Any) -> None:
        # Of the last step: at the section itself variations are along it.
        ends.append((orbit, [each.over(arb(0)) for each in orbit._part(orbit.orbits.state).variations]))
        to_the_section(orbit, end)

    monkeypatch.setattr(following._HalfOrbit, "_to_the_section", noted)
    followed(Start(CR3BP_AXIAL, tuple(map(arb, AXIAL_ORBIT)), MU, 1, False), 128, ORACLE)
    ((orbit, end),) = ends

    def form(variations: Any) -> list[arb]:
        vectors = [orbit._canonical(each, orbit.blocks[0]) for each in variations]
        return [
            sum(((a.conjugate() * b).imag for a, b in zip(one, other, strict=True)), arb(0))
            for one in vectors
            for other in vectors
        ]

    for before, after in zip(form(orbit._first_variations()), form(end), strict=True):
        assert agree(before, after)
        assert after.rad() < 1e-9


def test_parts_follow_one_another_and_hold_at_all_their_times(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over all steps of an orbit, with other multiples of the field on each part."""
    reached, go_on = [arb(1)], following._HalfOrbit._go_on

    def determinants(orbit: Any, part: Any) -> list[acb]:
        return [value for block in orbit.blocks for value in orbit._determinants(block, part)]

    def followed_on(orbit: Any, over: Any, end: Any) -> bool:
        before = [turning.at for turning in orbit.turning[0]]
        if not go_on(orbit, over, end):
            return False
        begin = arb(0) if reached[-1] == 1 else reached[-1]
        if len(over) == 1:
            (part,) = over
            assert part.theta.contains(begin)
            assert part.theta.contains(end.theta)
            assert end.theta > begin
            assert all(agree(a, b) for a, b in zip(before, determinants(orbit, part.at(begin)), strict=True))
            for cell in (part.theta, part.theta.mid() + arb(0, 1) / 64):
                values = determinants(orbit, part.at(cell))
                for time in (cell.mid(), cell.mid() + cell.rad() * 0.99, cell.mid() - cell.rad() * 0.99):
                    exact = determinants(orbit, part.at(time.mid()))
                    assert all(agree(value, other) for value, other in zip(values, exact, strict=True))
            reached.append(end.theta)
        else:
            assert begin == 0
        return True

    monkeypatch.setattr(following._HalfOrbit, "_go_on", followed_on)
    followed(Start(CR3BP_AXIAL, tuple(map(arb, AXIAL_ORBIT)), MU, 1, False), 128, ORACLE)
    assert len(reached) > 4


def test_a_ball_of_starts_has_the_fields_and_variations_of_its_points() -> None:
    radius = 2.0**-20

    def begun(state: Any) -> Any:
        return following._HalfOrbit(Start(CR3BP_AXIAL, tuple(state), MU, 1, False), 128, ORACLE)

    half = begun(arb(x, radius if x else 0) for x in AXIAL_ORBIT)
    part = half._part(half.orbits.state)
    for sign in (-1, 1):
        point = begun(arb(x + sign * radius * (0.99 if x else 0)) for x in AXIAL_ORBIT)
        vectors = (part.field, *part.variations)
        own = (point._field(point.start.state), *point._first_variations())
        for vector, expected in zip(vectors, own, strict=True):
            assert all(agree(a, b) for a, b in zip(vector.over(arb(0)), expected, strict=True))


def test_all_arguments_are_followed_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    half = following._HalfOrbit(Start(CR3BP_AXIAL, tuple(map(arb, AXIAL_ORBIT)), MU, 1, False), 128, ORACLE)
    part, ((first, second),) = half._part(half.orbits.state), half.turning
    assert half._go_on([part], part)
    for known in (first, second):
        monkeypatch.setattr(Turning, "reaches", lambda turning, *_, known=known: turning is known)
        assert not half._go_on([part], part)


def test_every_part_of_a_step_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    covered: list[tuple[Fraction, Fraction]] = []

    class Step:
        def at(self, theta: arb) -> arb:
            return theta

    def short_ones(_: Any, over: Any, end: arb) -> bool:
        # Cells of different lengths, those on the right the shortest.
        (cell,) = over
        if cell.rad() > (1.1 - end) / 8:
            return False
        covered.append((Fraction(float(cell.lower())), Fraction(float(end))))
        return True

    def cover() -> None:
        following._HalfOrbit._cover(object.__new__(following._HalfOrbit), cast("Any", Step()), Fraction(0), Fraction(1))

    monkeypatch.setattr(following._HalfOrbit, "_go_on", short_ones)
    cover()
    assert covered[0][0] <= 0
    assert covered[-1][1] == 1
    assert all(before[1] >= after[0] >= before[0] for before, after in pairwise(covered))
    monkeypatch.setattr(following._HalfOrbit, "_go_on", lambda *_: False)
    with pytest.raises(IntegrationFailure, match="not enclosed well enough"):
        cover()


def test_what_is_known_of_a_step_has_the_errors_of_its_grades() -> None:
    arithmetic, unit = Arithmetic(Grading((1,), 1), 64, 20, 2), Fraction(1, 2**20)
    polynomial = arithmetic.polynomial({(0,): Fraction(2), (1,): 3 * unit}).with_errors([0.25, 0.125 * float(unit), 9])
    (state,) = moving([polynomial], 0, Fraction(1)).over(arb(0, 1))
    (variation,) = moving([polynomial], 1, unit).over(arb(0, 1))
    assert state.contains(arb(2, 0.25))
    assert variation.contains(arb(3, 0.125))
    assert variation.rad() < 0.2
    # Twice a polynomial in time, over an interval of it.
    square = Series(arithmetic, [fmpz_poly([0, 0, 1 << 64]), fmpz_poly([])], arithmetic.zero_errors())
    (values,) = moving([square], 0, Fraction(1)).over(arb(0.5, 0.5))
    assert values.contains(arb(0))
    assert values.contains(arb(1))
    # Of however many terms.
    long = Series(arithmetic, [fmpz_poly([*[0] * 60, 1 << 64]), fmpz_poly([])], arithmetic.zero_errors())
    assert moving([long], 0, Fraction(1)).over(arb(1))[0].contains(arb(1))


def test_what_is_left_of_a_vector_is_unknown_by_both_errors() -> None:
    zero = arb_poly([0])
    for share in (-3, 3):
        (rest,) = Moving((zero,), (arb(1),)).less(arb(share), Moving((zero,), (arb(2),))).over(arb(0))
        assert rest.contains(arb(7))
        assert rest.contains(arb(-7))


def _canonical(vector: Moving, theta: arb) -> tuple[acb, ...]:
    """Of coordinates q and p in turn."""
    values = vector.over(theta)
    return tuple(acb(q, -p) for q, p in zip(values[::2], values[1::2], strict=True))


def _exact(vector: Moving, errors: list[float], theta: float) -> tuple[acb, ...]:
    values = [
        polynomial(arb(theta)) + arb(error) * bound
        for polynomial, error, bound in zip(vector.known, errors, vector.errors, strict=True)
    ]
    return tuple(acb(q, -p) for q, p in zip(values[::2], values[1::2], strict=True))


def test_determinants_of_what_is_left_of_the_vectors_are_those_of_the_vectors() -> None:
    """Vectors that are nearly multiples of the field and of each other, over times and errors at random."""
    chance = random.Random(5)

    def polynomials(size: float) -> list[arb_poly]:
        return [arb_poly([size * chance.uniform(-1, 1) * 3.0**-power for power in range(4)]) for _ in range(6)]

    with ctx.workprec(128):
        for _ in range(60):
            errors = tuple(arb(chance.uniform(0, 1e-20)) for _ in range(6))
            field = Moving(tuple(polynomials(1)), errors)
            many, vectors = [1e7 * chance.uniform(-1, 1) for _ in range(3)], []
            for number in range(2):
                rest = polynomials(1)
                known = [rest[k] + many[number] * field.known[k] for k in range(6)]
                if number:
                    known = [known[k] + many[2] * vectors[0].known[k] for k in range(6)]
                vectors.append(Moving(tuple(known), errors))
            theta = arb(0.5, 0.5) if chance.random() < 0.5 else arb(chance.random(), 0.1)
            first, *others = reduced([field, *vectors], _canonical, theta)
            assert first == field
            along = tuple(entry / acb(0, 1) for entry in _canonical(field, theta))
            found = determinant((along, *(_canonical(each, theta) for each in others)))
            for _ in range(20):
                middle, radius = float(theta.mid()), float(theta.rad())
                time = min(1.0, max(0.0, middle + radius * chance.uniform(-1, 1)))
                unknown = [[chance.choice([-1, 1, chance.uniform(-1, 1)]) for _ in range(6)] for _ in range(3)]
                rows = [_exact(each, own, time) for each, own in zip((field, *vectors), unknown, strict=True)]
                assert found.contains(determinant((tuple(entry / acb(0, 1) for entry in rows[0]), *rows[1:])).mid())
            # Orthogonal at the middle, and of the size of what is not common to them.
            assert all(abs(entry) < 30 for each in others for entry in _canonical(each, theta.mid()))
            assert all(error < 1e-3 for each in others for error in each.errors)


Along = tuple[ProvedCurve, ProvedList, tuple[CountedOrbit, ...]]


@cache
def counted(name: str) -> Along:
    """A curve with its list, and orbits in its intervals."""
    with ctx.workprec(192):
        atlas, entries = case(name)
        results = [result for result in values(entries) if isinstance(result, StabilityResult)]
        conclusion = conclude(atlas, results)
        assert isinstance(conclusion.outcome, Proved)
        listed = conclude_list(atlas, results, conclusion, 2).outcome
        assert isinstance(listed, Proved)
        curve, orbits = conclusion.outcome.results, []
        for interval in intervals_of(curve, listed.results):
            number, s = places_in(curve, interval)[0]
            start = start_at(atlas, curve.chain.stretches[number], s)
            assert start is not None
            orbits.append(CountedOrbit(curve.chain.stretches[number].tube.piece.id, s, followed(start, 128, ORACLE)))
    return curve, listed.results, tuple(orbits)


def test_orbits_of_an_interval_are_tried_far_from_each_other() -> None:
    curve: Any = SimpleNamespace(
        chain=SimpleNamespace(stretches=[SimpleNamespace(entered=Fraction(-1), leaves=Fraction(1)) for _ in range(24)])
    )
    interval: Any = SimpleNamespace(
        begin=SimpleNamespace(stretch=10, upper=Fraction(-3, 4)), end=SimpleNamespace(stretch=23, lower=Fraction(0))
    )
    places = places_in(curve, interval)
    assert [number for number, _ in places[:6]] == [11, 15, 19, 11, 15, 19]
    assert all(10 < number < 23 and -1 < s < 1 for number, s in places)
    interval.end.stretch = 10
    assert all(number == 10 and Fraction(-3, 4) < s < 0 for number, s in places_in(curve, interval))


EXPECTED = {
    PLANAR: [(2, 2), (2, 1)], AXIAL: [(2, 3), (2, 2)], RETROGRADE: [(1, 1), (1, 2)], LOOP: [(3,), (4,)],
}  # fmt: skip


@pytest.mark.parametrize("name", EXPECTED)
def test_the_index_along_curves_is_that_of_graphs_of_the_flow(name: str) -> None:
    atlas, (curve, _, orbits) = case(name)[0], counted(name)
    assert [tuple(turns.index for turns in orbit.turns) for orbit in orbits] == EXPECTED[name]
    stretches = {stretch.tube.piece.id: stretch for stretch in curve.chain.stretches}
    for orbit, expected in zip(orbits, EXPECTED[name], strict=True):
        start = start_at(atlas, stretches[orbit.piece], orbit.s)
        assert start is not None
        assert index_of_orbit([float(x) for x in start.state], float(start.mu), start.crossings) == expected
        assert orbit.index == sum(expected)


@cache
def half_turns_along(state: tuple[float, ...], crossings: int) -> HalfTurns:
    """From an exact start the numbers of half turns are whole to many digits."""
    (turns,) = followed(Start(CR3BP_AXIAL, tuple(arb(x) for x in state), MU, crossings, False), 128, ORACLE)
    return turns


@pytest.mark.parametrize(("state", "crossings", "index"), [(VERTICAL_ORBIT, 2, 5), (AXIAL_ORBIT, 1, 4)])
def test_orbits_under_the_half_turn_about_the_axis(state: tuple[float, ...], crossings: int, index: int) -> None:
    assert half_turns_along(state, crossings).index == index
    assert index_of_orbit(state, float(MU), crossings) == (index,)


BUTTERFLY = Start(
    CR3BP, tuple(map(arb, (0.9307299281188731, 0, -0.15805543156280744, 0, -0.029167679439055474, 0))), MU, 2, False
)
FAR_AXIAL = (-1.1624410439309225, 0, 0, 0, 1.5669624016474406, 0.7456693471091529)
AROUND_THE_EARTH = Start(along_curve.ACROSS_PLANE, tuple(map(arb, FAR_AXIAL)), MU, 1, False)


@pytest.mark.parametrize(("start", "section", "index"), [(BUTTERFLY, 1, 7), (AROUND_THE_EARTH, 2, 4)])
def test_variations_that_grow_along_the_orbit_are_followed_in_few_parts(
    start: Start, section: int, index: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A butterfly orbit past the Moon, and an axial one of L3 past the Earth."""
    tried, go_on = [], following._HalfOrbit._go_on

    def counted(orbit: Any, over: Any, end: Any) -> bool:
        tried.append(end)
        return go_on(orbit, over, end)

    monkeypatch.setattr(following._HalfOrbit, "_go_on", counted)
    (turns,) = followed(start, 128, ORACLE)
    state = [float(x) for x in start.state]
    assert (turns.index,) == (index,) == index_of_orbit(state, float(MU), start.crossings, section)
    assert len(tried) < 200


def test_half_orbits_from_plane_to_plane_turn_as_those_from_the_section_of_the_axis(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The orbit of a point in units of the speed across the plane; where vy is 0, y = 0 would be no section."""
    point = {"x": arb(AXIAL_ORBIT[0]), "vy": arb(AXIAL_ORBIT[4])}
    atlas = replace(case(PLANAR)[0], system=LIFTED, parameters={"mu": MU})
    start = along_curve._start(atlas, {"eps2": arb(AXIAL_ORBIT[5]) ** 2, **point})
    assert start is not None
    assert (start.system.section, start.system.reversing_symmetry) == ("z", CR3BP_AXIAL.reversing_symmetry)
    assert (start.crossings, start.is_planar) == (1, False)
    (across,) = followed(start, 128, ORACLE)
    along = half_turns_along(AXIAL_ORBIT, 1)
    assert across.index == along.index == 4
    assert all(agree(one, other) for one, other in zip(across.angles, along.angles, strict=True))
    for size in (arb(0), arb(0, 1e-9), arb(-1)):
        assert along_curve._start(atlas, {"eps2": size, **point}) is None


def test_the_flow_is_that_of_the_energy_in_coordinates_and_momenta() -> None:
    """Hamilton's equations at states at random: the symplectic form of field and vector is a rate of the energy."""
    half, chance = (
        following._HalfOrbit(Start(CR3BP_AXIAL, tuple(map(arb, AXIAL_ORBIT)), MU, 1, False), 128, ORACLE),
        random.Random(35),
    )
    for _ in range(20):
        state, vector = ([arb(chance.uniform(-1, 1)) for _ in range(6)] for _ in range(2))
        flow, along = (half._canonical(each, half.blocks[0]) for each in (half._field(state), vector))
        form = sum(((a.conjugate() * b).imag for a, b in zip(flow, along, strict=True)), arb(0))
        rate = sum((a * b for a, b in zip(half._gradient(state), vector, strict=True)), arb(0))
        assert (form + rate).contains(0)
        assert float((form + rate).rad()) < 1e-9 < abs(float(rate.mid()))


def test_vectors_are_those_of_the_section_that_is_meant() -> None:
    """Where vy is 0, vectors of the other section are none."""
    state = tuple(arb(x) for x in AXIAL_ORBIT)
    for system, speed, directions in (
        (along_curve.ACROSS_PLANE, 5, [0, 4, 1, 3]),
        (CR3BP_AXIAL, 4, [0, 5, 2, 3]),
    ):
        half = following._HalfOrbit(Start(system, state, MU, 1, False), 128, ORACLE)
        assert (half.speed, half.directions) == (speed, directions)
    at_rest = (*state[:4], arb(0), state[5])
    begun = following._HalfOrbit(Start(along_curve.ACROSS_PLANE, at_rest, MU, 1, False), 128, ORACLE)
    assert all(turning.at.is_finite() and not turning.at.contains(0) for block in begun.turning for turning in block)


def outcome(name: str, orbits: Any, **changes: Any) -> Any:
    curve, found, _ = counted(name)
    return conclude_index(case(name)[0], curve, changes.get("found", found), orbits, changes.get("problem", ""))


def refusal(name: str, orbits: Any, **changes: Any) -> str:
    found = outcome(name, orbits, **changes)
    assert isinstance(found, NotProved)
    assert found.hypotheses[-1].holds is False
    return found.reason.condition


@pytest.mark.parametrize("name", EXPECTED)
def test_half_turns_that_are_others_are_refused(name: str) -> None:
    _, _, orbits = counted(name)
    assert isinstance(outcome(name, orbits), Proved)
    for place, orbit in enumerate(orbits):
        for block, turns in enumerate(orbit.turns):
            for fixed, negated in ((1, 0), (-1, 0), (0, -1), (1, 1)):
                wrong = replace(turns, fixed=turns.fixed + fixed, negated=turns.negated + negated)
                others = (*orbit.turns[:block], wrong, *orbit.turns[block + 1 :])
                changed = (*orbits[:place], replace(orbit, turns=others), *orbits[place + 1 :])
                if turns.planes == 1 or (fixed + negated) % 2:
                    assert refusal(name, changed) in ("counts", "parity")
                if (fixed + negated) % 2:
                    # With the angles to it, too. Of even changes another integration tells.
                    moved = (turns.angles[0] + fixed, turns.angles[1] + negated)
                    others = (*orbit.turns[:block], replace(wrong, angles=moved), *orbit.turns[block + 1 :])
                    changed = (*orbits[:place], replace(orbit, turns=others), *orbits[place + 1 :])
                    assert refusal(name, changed) == "parity"


def test_orbits_stand_in_their_intervals() -> None:
    first, second = counted(PLANAR)[2]
    assert refusal(PLANAR, (second, first)) == "counts"
    assert refusal(PLANAR, (first,)) == "counts"
    assert refusal(PLANAR, (first, second, second)) == "counts"
    assert refusal(PLANAR, ()) == "counts"
    assert refusal(PLANAR, (first, replace(second, piece="elsewhere"))) == "counts"
    assert refusal(PLANAR, (first, replace(second, s=Fraction(3, 2)))) == "counts"
    assert refusal(PLANAR, (first, replace(second, turns=second.turns[:1]))) == "counts"
    assert refusal(PLANAR, (first, second), problem="it was not brought to an end") == "counts"
    assert refusal(PLANAR, (first, second), found=replace(counted(PLANAR)[1], across=None)) == "counts"
    nothing = conclude_index(case(PLANAR)[0], None, None, (first, second))
    assert isinstance(nothing, NotProved)
    assert nothing.reason.condition == "curve"


def test_an_orbit_whose_half_turns_do_not_follow_gives_way_to_another(monkeypatch: pytest.MonkeyPatch) -> None:
    curve, found, (orbit, _) = counted(PLANAR)
    known = of_indices._Known(case(PLANAR)[0], curve, found)
    turns = orbit.turns[0]
    vague = replace(turns, angles=(turns.angles[0], arb(turns.negated + turns.planes, 1e-9)))
    answers = iter([(vague, orbit.turns[1]), orbit.turns])
    monkeypatch.setattr(of_indices, "followed", lambda *_: next(answers))
    chosen = of_indices._counted(known, known.intervals[0])
    assert isinstance(chosen, CountedOrbit)
    assert (chosen.piece, chosen.s) != (orbit.piece, orbit.s)
    assert refusal(PLANAR, (replace(orbit, turns=(vague, orbit.turns[1])), counted(PLANAR)[2][1])) == "counts"
    monkeypatch.setattr(of_indices, "followed", lambda *_: (vague, orbit.turns[1]))
    assert "too close to a whole half turn" in str(of_indices._counted(known, known.intervals[0]))


def test_what_the_list_leaves_open_ends_an_interval() -> None:
    curve, found, _ = counted(RETROGRADE)
    assert len(intervals_of(curve, found)) == 2
    (stretch,) = curve.chain.stretches
    for subject, more in ((Matter.EVERYTHING, 1), (Resonance(1, 0), 1), (Resonance(2, 1), 0), (Matter.EXTREMA, 0)):
        low = (stretch.entered + stretch.leaves) / 2
        gap = Gap(0, stretch.tube.piece.id, low, low + Fraction(1, 2**20), subject, "it is dark")
        for changed in (
            replace(found, found=replace(found.found, gaps=(gap,))),
            replace(found, across=replace(found.across, found=replace(found.across.found, gaps=(gap,)))),  # type: ignore[type-var, union-attr]
        ):
            assert len(intervals_of(curve, changed)) == 2 + more


def test_vertical_orbits_are_followed_over_half_of_their_period() -> None:
    atlas = replace(case(PLANAR)[0], system=VERTICAL["L1"])
    x_l, size = derived_parameter(atlas.system, "x_l", atlas.parameters, 100).ball, arb("0.01")
    start = along_curve._start(atlas, {"eps2": size, "x": arb(3), "vy": arb(2)})
    assert start is not None
    assert (start.system, start.crossings, start.is_planar) == (CR3BP_AXIAL, 2, False)
    assert all(
        agree(one, other)
        for one, other in zip(
            start.state, (x_l + arb("0.03"), arb(0), arb(0), arb(0), arb("0.02"), arb("0.1")), strict=True
        )
    )
    assert along_curve._start(atlas, {"eps2": arb(0), "x": arb(3), "vy": arb(2)}) is None


def test_every_angle_stands_among_the_enclosures_of_its_hypothesis() -> None:
    for name, blocks in ((RETROGRADE, 2), (LOOP, 1)):
        found = {each.name: each.enclosures for each in outcome(name, counted(name)[2]).hypotheses}
        assert len(found["counts"]) == 2 * 2 * blocks
        assert len(found["parity"]) == 2 * blocks


def test_a_parity_is_not_wrong_where_the_sign_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    curve, found_list, orbits = counted(LOOP)
    monkeypatch.setattr(BoundedFunction, "value", lambda *_: arb(0, 1))
    found = conclude_index(case(LOOP)[0], curve, found_list, orbits)
    assert isinstance(found, NotProved)
    assert found.reason.condition == "parity"
    assert "the sign of det(1 - Sigma) is not known" in found.reason.message


def test_without_a_list_the_index_of_single_orbits_is_known() -> None:
    _, _, orbits = counted(LOOP)
    found = conclude_index(case(LOOP)[0], counted(LOOP)[0], None, orbits[:1])
    assert isinstance(found, Proved)
    assert (found.results.intervals, found.results.small) == ((), ())
    assert [each.name for each in found.hypotheses] == ["curve", "counts"]


def test_the_neighbour_changes_by_one_in_its_own_plane(monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = counted(RETROGRADE)[2]
    monkeypatch.setattr(proved_index, "_check_parity", lambda *_: None)
    plane, across = second.turns
    less = replace(across, fixed=across.fixed - 1, angles=(across.angles[0] - 1, across.angles[1]))
    more = replace(plane, fixed=plane.fixed + 1, angles=(plane.angles[0] + 1, plane.angles[1]))
    for turns in ((plane, less), (more, across), (more, less)):
        assert refusal(RETROGRADE, (first, replace(second, turns=turns))) == "neighbours"


def small(system: Any, mu: Fraction) -> tuple[int, ...]:
    checklist = Checklist()
    with checklist.hypothesis("libration-point", "35.5", "it is known", "") as evidence:
        return index_of_small_orbits(evidence, system, {"mu": mu})


@pytest.mark.parametrize("mass", ["earth-moon", "sun-jupiter"])
def test_small_orbits_have_the_index_of_the_linear_flow(mass: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mu = MASS_PARAMETERS[mass]
    for system in AROUND.values():
        assert small(system, mu) == (2, 1)
    for system in VERTICAL.values():
        assert small(system, mu) == (5,)
    with pytest.raises(ValueError, match="not about small orbits"):
        small(FALKNER_SKAN, mu)
    # A whole number is no ratio at which orbits are non-degenerate.
    assert [_whole(ratio) for ratio in (arb("1.5"), arb(2), arb(2, 0.1), arb("nan"))] == [1, None, None, None]
    curve, found, orbits = counted(PLANAR)
    # Of a curve that does not reach the point nothing is said of small orbits.
    atlas, covers = case(PLANAR)[0], case(PLANAR)[0].claim.covers
    assert covers is not None
    for claim in (
        replace(atlas.claim, increasing=()),
        replace(atlas.claim, covers=None),
        replace(atlas.claim, covers=replace(covers, start=Fraction(1, 2**40))),
        replace(atlas.claim, covers=replace(covers, coordinate="vy")),
    ):
        assert not reaches_rest(replace(atlas, claim=claim))
        known = conclude_index(replace(atlas, claim=claim), curve, found, orbits)
        assert isinstance(known, Proved)
        assert known.results.small == ()
    assert reaches_rest(atlas)
    # A vertical family may turn around in eps2 where its orbits are large.
    turning = replace(atlas.claim, increasing=("vy",), covers=replace(covers, coordinate="eps2", end=Fraction(1)))
    assert reaches_rest(replace(atlas, system=VERTICAL["L3"], claim=turning))
    assert not reaches_rest(replace(atlas, claim=turning))
    reached = conclude_index(atlas, curve, found, orbits)
    assert isinstance(reached, Proved)
    words = index_in_words(reached.theorem, reached.results, curve, "a", "b")
    assert "Those of its planar orbits around L1 that are small enough: 3, in the plane 2 and across it 1." in words
    for wrong in ((2, 3), (1, 1), (2, 2)):
        monkeypatch.setattr(proved_index, "index_of_small_orbits", lambda *_, found=wrong: found)
        assert refusal(PLANAR, orbits) == "libration-point"


def test_the_libration_point_itself_is_no_orbit_to_follow() -> None:
    atlas, (curve, _, _) = case(PLANAR)[0], counted(PLANAR)
    (piece,) = atlas.curve_pieces()
    rest = -piece.centre[0] / (piece.frame[0][0] * piece.half_width)
    (stretch,) = curve.chain.stretches
    assert start_at(atlas, stretch, rest) is None
    below, above = rest - Fraction(1, 2**20), rest + Fraction(1, 2**20)
    for s in (below, above):
        start = start_at(atlas, stretch, s)
        assert start is not None
        assert not start.state[4].contains(0)
    for ends, holds in (((below, above), True), ((above, stretch.leaves), False), ((stretch.entered, below), False)):
        begin, end = (Bound(0, s, s, ()) for s in ends)
        assert proved_index._holds_rest(atlas, curve, Interval(begin, end)) is holds


@cache
def curve_certificate() -> Certificate:
    """With its list."""
    atlas, entries = case(RETROGRADE)
    results = values(entries)
    conclusion = conclusion_of(atlas, results, (), lambda _: (), 2)
    return Certificate(make_atlas_certificate(atlas, results, conclusion))


@cache
def document() -> Any:
    return certified_index(curve_certificate())


@cache
def examined() -> Recheck:
    return recheck(curve_certificate())


def check(entry: Any, level: Level = Level.CONCLUSION) -> Recheck:
    return checked_by(entry, curve_certificate(), replace(examined(), level=level, precision=128))


def with_angle(change: Callable[[arb], arb]) -> dict[str, Any]:
    """The certificate that follows from another angle of the first orbit."""
    known, (first, *others) = of_indices._known(curve_certificate()), of_indices._stored(document())
    plane, across = first.turns
    moved = replace(plane, angles=(change(plane.angles[0]), plane.angles[1]))
    return of_indices._document(curve_certificate(), known, (replace(first, turns=(moved, across)), *others))


def test_another_integration_finds_other_angles_than_forged_ones() -> None:
    """Angles that are those of no integration pass all that follows from them; numbers of turns too."""
    entry = with_angle(lambda angle: angle - arb("0.01"))
    assert check(entry).stands
    found = check(entry, Level.INTEGRATION)
    assert not found.stands
    assert "orbits[0], 1 angles 1: stored is" in found.why
    assert "disjoint" in found.why


@pytest.mark.parametrize(
    "change",
    [
        lambda angle: arb(angle.mid() + angle.rad() * 3 / 4, angle.rad() / 1000),
        lambda angle: arb(angle.mid() - angle.rad() * 3 / 4, angle.rad() / 1000),
        lambda angle: (angle.mid() + angle.rad() / 2).union(angle.mid() + 0.001),
        lambda angle: arb(angle.mid(), angle.rad() * 3 / 4),
    ],
    ids=["above", "below", "wide", "narrow"],
)
def test_an_angle_beside_that_of_the_orbit_is_not_confirmed(change: Callable[[arb], arb]) -> None:
    """It has points in common with what other integrations find, and does not contain what any of them finds."""
    # Made with the usual bits, whichever test asks for it first.
    document()
    with ctx.workprec(192):
        entry = with_angle(change)
    assert check(entry).stands
    assert check(document(), Level.INTEGRATION).stands
    found = check(entry, Level.INTEGRATION)
    assert (found.stands, found.level) == (False, Level.CONCLUSION)
    assert "orbits[0], 1 angles 1: stored is" in found.why


def test_what_other_integrations_find_of_an_orbit_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    orbit = of_indices._stored(document())[0]
    plane, across = orbit.turns
    start: Any = None
    dark = IntegrationFailure("half turns", "it is dark", "light", needs_precision=True)

    def finds(*answers: Any) -> list[Finding]:
        """What is found if integrations give these answers, one after the other."""
        left = [*answers]

        def answer(*_: Any) -> Any:
            if left and not isinstance(left[0], Exception):
                return left.pop(0)
            raise left.pop(0) if left else dark

        monkeypatch.setattr(of_indices, "followed", answer)
        return list(of_indices._unconfirmed(start, orbit, "here"))

    narrow, wide = (replace(plane, angles=tuple(arb(a.mid(), a.rad() * by) for a in plane.angles)) for by in (0.5, 2))
    assert not finds(orbit.turns)
    assert not finds((narrow, across))
    assert not finds(dark, (wide, across), (narrow, across))
    (finding,) = finds((plane,))
    assert finding == Finding("here", "another integration finds other half turns")
    for other in (
        HalfTurns(plane.fixed, plane.negated + 1, 1, plane.angles), replace(plane, fixed=plane.fixed - 1),
        replace(plane, planes=2),
    ):  # fmt: skip
        assert finds((wide, across), (other, across)) == [finding]
    apart = replace(plane, angles=(plane.angles[0] + 1, plane.angles[1]))
    assert ["disjoint" in each.message for each in finds((wide, across), (apart, across), orbit.turns)] == [True]
    assert ["does not confirm" in each.message for each in finds((wide, across))] == [True, True]
    with pytest.raises(CannotBeCheckedError, match="here: it is dark"):
        finds()


def test_what_is_not_proved_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: Any) -> Any:
        raise IntegrationFailure("half turns", "it is dark", "light", needs_precision=True)

    monkeypatch.setattr(of_indices, "followed", never)
    entry = certified_index(curve_certificate())
    assert entry["verdict"] == "not proved"
    assert entry["reason"]["condition"] == "counts"
    assert "it is dark" in entry["reason"]["message"]
    assert entry["orbits"] == []
    assert "theorem" not in entry["statement"]
    assert check(entry).stands
    assert not check(forged(entry, lambda entry: entry.update(verdict="proved", reason=None))).stands


def test_curves_of_other_systems_or_without_proof_have_no_index() -> None:
    from support.chain_cases import parabola

    with pytest.raises(InputError, match="system: no index is counted of falkner-skan; give"):
        certified_index(Certificate(atlas_certificate(*parabola())))
    surface = read_atlas(DATA / "surface-planar.json")
    with pytest.raises(InputError, match="kind: no index is counted of 'symmetry-br"):
        certified_index(Certificate(make_atlas_certificate(surface, [], None)))
    entry = copy.deepcopy(dict(curve_certificate().document))
    entry["verdict"] = "not proved"
    with pytest.raises(InputError, match="proves no curve"):
        certified_index(Certificate(entry))


def test_curves_without_an_index_are_refused_before_they_are_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from support.chain_cases import parabola

    def never(*_: Any) -> Any:
        raise AssertionError("the curve was checked")

    monkeypatch.setattr(proof_command, "examined", never)
    monkeypatch.setattr(index_command, "check_of", never)
    curve = tmp_path / "curve.json"
    write_certificate(curve, atlas_certificate(*parabola()))
    for words in (["-o", str(tmp_path / "index.json")], ["--recheck", str(curve)]):
        assert main(["index", "--curve", str(curve), *words]) == 2
    message = f"error: {curve}: field statement.atlas.system: no index is counted of falkner-skan; give the certificate"
    assert message in capsys.readouterr().err
    with pytest.raises(InputError, match="no index is counted"):
        verify.certify(IndexAlong("parabola"), rests_on=verify.read(curve), quiet=True)


def test_the_command_and_python_say_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    curve, output = tmp_path / "curve.json", tmp_path / "index.json"
    write_certificate(curve, curve_certificate().document)
    assert main(["index", "--curve", str(curve), "-o", str(output), "--quiet"]) == 0
    said = capsys.readouterr().out
    assert "in the plane 1 and across it 2" in " ".join(said.split())
    assert main(["index", "--recheck", str(output), "--curve", str(curve), "--quiet"]) == 0
    assert "2 conclusion" in capsys.readouterr().out
    known = read_certificate(output, "index-certificate")
    assert [orbit.index for orbit in known.orbits] == [2, 3]
    assert known.theorem is not None
    assert " ".join(known.theorem.split()) in " ".join(said.split())
    claim, file = IndexAlong(known.id), tmp_path / "python.json"
    (found,) = verify.certify(claim, rests_on=verify.read(curve), output=file, quiet=True)
    assert found.document == known.document == verify.read(file)[0].document
    with pytest.raises(InputError, match="rests on the curve another, once; give its certificate"):
        verify.certify(IndexAlong("another"), rests_on=verify.read(curve), quiet=True)
    assert verify.recheck(verify.read(output), rests_on=verify.read(curve), quiet=True)[0].stands
    write_certificate(output, forged(known.document, lambda entry: entry["orbits"][0].update(index=3)))
    assert main(["index", "--recheck", str(output), "--curve", str(curve), "--quiet"]) == 1
    output.write_text(output.read_text().replace('"index": 3', '"index": 5'))
    with pytest.raises(InputError, match="digest"):
        read_certificate(output, "index-certificate")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--integrate"], "give it together with --recheck"),
        (["--recheck"], "FILE: missing"),
        (["x.json"], "is taken with --recheck only"),
        (["--recheck", "x.json", "-o", "x.json"], "leave it out"),
        ([], "none.json"),
    ],
)
def test_wrong_options_are_told(capsys: pytest.CaptureFixture[str], words: list[str], said: str) -> None:
    assert main(["index", "--curve", "none.json", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error
