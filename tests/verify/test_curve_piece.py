"""A proved piece contains the curve, and nothing that is not a piece of a curve is proved.

In the system `TWIST` the symmetric orbits are the circle a^2 + c^2 = 1 and the line c = 0, exactly.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import pytest
from flint import arb, ctx
from support.exact_elements import number
from support.flow_checks import ball
from support.reference import Orbits, falkner_skan, three_body
from support.wide_checks import MU, OMEGA, TWIST, libration_point

from orbitproof.shared.formats.pieces import Piece, piece_from_json
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems.libration import BRANCH_SYSTEMS
from orbitproof.shared.systems.system import CR3BP, FALKNER_SKAN, SYSTEMS, ReversibleSystem
from orbitproof.verify.algebra.grading import Grading
from orbitproof.verify.algebra.wide import WideArithmetic
from orbitproof.verify.curve.equation import Equation
from orbitproof.verify.curve.piece import PieceLimits, prove_piece
from orbitproof.verify.curve.piece_result import PieceResult
from orbitproof.verify.curve.proved_intervals import ProvedInterval
from orbitproof.verify.evidence.outcome import NotProved, Proved

DATA = Path(__file__).parents[1] / "data"
FAST = PieceLimits(56, 18, 12)
WHOLE = (Fraction(-1), Fraction(1))
TWISTED = {"omega": OMEGA}
WIDTH = Fraction(1, 8)
TUBE = Fraction(1, 10**6)
ONE, ZERO, TINY = Fraction(1), Fraction(0), Fraction(1, 10**12)
BITS = 110


def slow(*values: Any) -> list[Any]:
    """Parameters of the long test run."""
    return [pytest.param(value, marks=pytest.mark.slow) for value in values]


@pytest.fixture(autouse=True)
def _reference_precision() -> Iterator[None]:
    with mpmath.workprec(200):
        yield


# The circle


def circle(cosine: Fraction, sine: Fraction, kind: str = "regular", width: Fraction = WIDTH) -> Piece:
    """The circle about a point of it, along its tangent: p_1 = sqrt(1 - p_0^2) - 1."""
    coefficients = [Fraction(0)] * 11
    term = Fraction(-1, 2) * width**2
    for n in range(1, 6):
        coefficients[2 * n] = Fraction(round(term * 2**80), 2**80)
        term *= Fraction(2 * n - 1, 2 * n + 2) * width**2
    frame = ((-sine, cosine), (cosine, sine))
    return Piece("circle", kind, (cosine, sine), frame, width, (tuple(coefficients),), (TUBE,), "physical")


SYMMETRIC = circle(Fraction(1), Fraction(0), "symmetric")
REGULAR = circle(Fraction(3, 5), Fraction(4, 5))
LINE = Piece(
    "line", "regular", (Fraction(1, 2), Fraction(0)), ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))), WIDTH,
    ((Fraction(0),),), (TUBE,), "physical",
)  # fmt: skip


@cache
def prove(
    piece: Piece, interval: tuple[Fraction, Fraction] = WHOLE, limits: PieceLimits = FAST, symmetry: str | None = "S"
) -> PieceResult[ProvedInterval]:
    return prove_piece(TWIST, TWISTED, piece, interval, limits, None, symmetry)


def proved_interval(result: PieceResult[ProvedInterval]) -> ProvedInterval:
    """What is known of a piece that is proved."""
    assert isinstance(result.outcome, Proved)
    return result.outcome.results


def with_terms(piece: Piece, terms: Mapping[int, Fraction]) -> Piece:
    """The piece with something added to coefficients of its first polynomial."""
    row = list(piece.polynomial[0]) + [Fraction(0)] * (max(terms) + 1)
    for power, value in terms.items():
        row[power] += value
    return replace(piece, polynomial=(tuple(row), *piece.polynomial[1:]))


def circle_distance(piece: Piece, s: Fraction) -> tuple[Any, Any]:
    """p_1 on the circle less the polynomial, and its derivative in s."""
    width, x = number(piece.half_width), number(s)
    root = mpmath.sqrt(1 - (width * x) ** 2)
    value = root - 1 - sum(number(c) * x**n for n, c in enumerate(piece.polynomial[0]))
    slope = -(width**2) * x / root - sum(n * number(c) * x ** (n - 1) for n, c in enumerate(piece.polynomial[0]) if n)
    return value, slope


def places(interval: tuple[Fraction, Fraction], count: int = 40) -> list[Fraction]:
    source = random.Random(str(interval))
    start, end = interval
    return [start, end, *(start + (end - start) * Fraction(source.randint(0, 10**6), 10**6) for _ in range(count))]


def check_circle(piece: Piece, result: PieceResult[ProvedInterval]) -> None:
    """The circle is within the deviation, with its slope, which for symmetric pieces is measured relative to s."""
    known = proved_interval(result)
    assert 0 <= known.deviation[0] < piece.tube[0]
    for s in places((known.start, known.end)):
        value, slope = circle_distance(piece, s)
        assert abs(value) <= number(known.deviation[0])
        scale = abs(s) if piece.kind == "symmetric" else Fraction(1)
        assert abs(slope) <= number(known.slope_deviation[0] * scale)


INTERVALS = [
    WHOLE,
    (Fraction(0), Fraction(1, 1000)),
    (Fraction(-1), Fraction(1, 3)),
    (Fraction(1, 100), Fraction(1)),
    (Fraction(-3, 7), Fraction(-1, 7)),
]


@pytest.mark.parametrize("interval", [*INTERVALS[:2], *slow(*INTERVALS[2:])], ids=str)
@pytest.mark.parametrize("piece", [SYMMETRIC, REGULAR], ids=["symmetric", "regular"])
def test_proved_pieces_hold_the_circle(piece: Piece, interval: tuple[Fraction, Fraction]) -> None:
    """Also through the symmetry breaking at s = 0; the interval of the proof covers what was asked for."""
    result = prove(piece, interval)
    check_circle(piece, result)
    known = proved_interval(result)
    assert known.start <= interval[0] < interval[1] <= known.end
    assert known.deviation[0] < Fraction(5, 10**8)
    for s in places(interval, 5):
        a = number(piece.point(s)[0])
        time = mpmath.pi / (1 + a * a / 4)
        assert abs(time - mpmath.mpf(known.time.mid().str(40, radius=False))) <= float(known.time.rad()) + 1e-6


@pytest.mark.parametrize("piece", [SYMMETRIC, REGULAR], ids=["symmetric", "regular"])
def test_deviations_are_about_as_large_as_they_are(piece: Piece) -> None:
    """A polynomial that is off by 1e-8 (1 - 3 s^2) lies so far from the curve, and not much farther."""
    off = with_terms(piece, {0: Fraction(1, 10**8), 2: Fraction(-3, 10**8)})
    result = prove(off)
    check_circle(off, result)
    known = proved_interval(result)
    assert Fraction(2, 10**8) <= known.deviation[0] <= Fraction(3, 10**8)
    assert Fraction(6, 10**8) <= known.slope_deviation[0] <= Fraction(2, 10**6)


@pytest.mark.parametrize("interval", [(ZERO, Fraction(1, 1000)), (Fraction(1, 10), Fraction(1, 5))], ids=str)
def test_slopes_of_symmetric_pieces_are_relative_to_s(interval: tuple[Fraction, Fraction]) -> None:
    off = with_terms(SYMMETRIC, {2: Fraction(5, 10**8)})
    check_circle(off, prove(off, interval))


@pytest.mark.slow
def test_parts_of_a_piece_agree() -> None:
    """What is proved on overlapping intervals is one curve: deviations leave room for it on both."""
    off = with_terms(REGULAR, {1: Fraction(1, 10**8)})
    parts = [(Fraction(-1), Fraction(-2, 5)), (Fraction(-1, 2), Fraction(1, 2)), (Fraction(2, 5), Fraction(1))]
    deviations = [proved_interval(prove(off, interval)).deviation[0] for interval in parts]
    assert deviations[1] < deviations[0]
    assert deviations[1] < deviations[2]
    assert Fraction(5, 10**9) <= deviations[1] < Fraction(6, 10**9)


def test_the_line_is_proved_away_from_the_symmetry_breaking() -> None:
    assert proved_interval(prove(LINE)).deviation[0] < Fraction(1, 10**9)


@pytest.mark.parametrize("seed", [0, 1, *slow(*range(2, 60))])
def test_whatever_is_proved_holds_the_circle(seed: int) -> None:
    """Random polynomials around the true one, with random tubes: proved or not, never wrong."""
    source = random.Random(seed)
    piece = source.choice((REGULAR, SYMMETRIC))
    power = 2 * source.randint(0, 5) if piece is SYMMETRIC else source.randint(0, 10)
    piece = replace(piece, tube=(Fraction(10.0 ** source.uniform(-7, -1.5)),))
    piece = with_terms(piece, {power: Fraction(10.0 ** source.uniform(-9, -2))})
    result = prove(piece, source.choice(INTERVALS))
    if result.is_proved:
        check_circle(piece, result)
    else:
        assert isinstance(result.outcome, NotProved)


@pytest.mark.parametrize("seed", range(20))
def test_derivatives_of_the_equation_hold_its_unknown_parts(seed: int) -> None:
    """F = 1/8 + s/4 + w + unknown parts of every grade, at real points with |s| <= 16/17 and |w| <= 1/2."""
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 4, width=2)
    known = arithmetic.polynomial({(0,): [Fraction(1, 8), Fraction(1, 4)], (1,): ONE})
    errors = [source.random() for _ in range(3)]
    powers = [source.choice((0, 1, 2, 7)), source.choice((0, 1, 2, 7)), source.choice((0, 3))]
    top = source.choice((2, 3))
    s, w = Fraction(source.choice((-16, 16, source.randint(-16, 16))), 17), Fraction(source.choice((-1, 1)), 2)
    monomials = [(powers[0], 0), (powers[1], 1), (powers[2], top)]
    value = Fraction(1, 8) + s / 4 + Fraction(errors[0]) * s ** powers[0]
    slope = 1 + sum(Fraction(e) * s**i * j * w ** (j - 1) for e, (i, j) in zip(errors, monomials, strict=True) if j)
    change = sum(Fraction(e) * i * s ** (i - 1) * w**j for e, (i, j) in zip(errors, monomials, strict=True) if i)
    equation = Equation(known.with_errors(errors))
    with ctx.workprec(100):
        part = ball(s) + arb(0, 1) / 64
        assert equation.value(part).contains(ball(value))
        assert equation.slope(0, part).contains(ball(slope))
        assert equation.wide_derivative([ball(w)], part, False).contains(ball(Fraction(1, 4) + change))


# Refusals


def refused(result: PieceResult[ProvedInterval]) -> str:
    """The reason why a piece is not proved."""
    assert isinstance(result.outcome, NotProved)
    assert result.to_json()["verdict"] == "not proved"
    assert result.outcome.reason.remedy
    return result.outcome.reason.message


@pytest.mark.parametrize("power", [6, *slow(0, 2, 4, 8, 10)])
@pytest.mark.parametrize("piece", [SYMMETRIC, REGULAR], ids=["symmetric", "regular"])
def test_tampered_polynomials_are_refused(piece: Piece, power: int) -> None:
    tampered = with_terms(piece, {power: Fraction(3, 10**6)})
    assert "tube" in refused(prove(tampered))


@pytest.mark.slow
def test_a_tampered_coefficient_is_found_on_the_part_where_it_matters() -> None:
    tampered = with_terms(REGULAR, {9: Fraction(3, 10**6)})
    refused(prove(tampered, (Fraction(1, 2), Fraction(1))))
    check_circle(tampered, prove(tampered, (Fraction(-1, 4), Fraction(1, 4))))


def shifted(piece: Piece, centre: Sequence[Fraction], **changes: Any) -> Piece:
    return replace(piece, centre=tuple(centre), **changes)


@pytest.mark.parametrize("side", [1, -1])
def test_polynomials_that_are_wrong_at_one_end_are_refused(side: int) -> None:
    """(s^10 + side s^9)/2 vanishes at one end and is below 0.1 up to 3/4 of the way to the other."""
    half = Fraction(3, 2 * 10**7)
    assert "tube" in refused(prove(with_terms(REGULAR, {10: half, 9: side * half})))


THROUGH = shifted(LINE, (Fraction(1), Fraction(0)))


@pytest.mark.parametrize("tube", ["1e-6", *slow("1e-9", "1e-3", "0.1", "0.5")])
@pytest.mark.parametrize("interval", [WHOLE, *slow((Fraction(-1, 10**4), Fraction(1, 10**4)))], ids=str)
def test_lines_through_the_symmetry_breaking_are_refused(tube: str, interval: tuple[Fraction, Fraction]) -> None:
    """The tube contains both curves, however narrow it is."""
    refused(prove(replace(THROUGH, tube=(Fraction(tube),)), interval))


@pytest.mark.parametrize("tube", ["1e-6", *slow("1e-4", "1e-2")])
def test_the_circle_through_the_symmetry_breaking_is_no_regular_piece(tube: str) -> None:
    regular = replace(SYMMETRIC, kind="regular", tube=(Fraction(tube),))
    refused(prove(regular, (Fraction(-1, 10**3), Fraction(1, 10**3))))
    away = replace(regular, tube=(TUBE,))
    check_circle(away, prove(away, (Fraction(1, 2), Fraction(1))))


@pytest.mark.parametrize("tube", ["0.15", *slow("0.25", "1")])
def test_tubes_that_contain_two_branches_are_refused(tube: str) -> None:
    """About the circle near c = 0.1, across the line c = 0."""
    centre = Fraction("0.99498743710661995473"), Fraction(1, 10)
    piece = shifted(LINE, centre, half_width=Fraction(1, 10**6), polynomial=((ZERO, Fraction(-9950, 10**9)),))
    assert prove(piece).is_proved
    refused(prove(replace(piece, tube=(Fraction(tube),))))


@pytest.mark.parametrize("tube", ["1e-2", *slow("1e-6", "0.1", "0.3")])
def test_a_piece_that_jumps_from_one_branch_to_the_other_is_refused(tube: str) -> None:
    """From the circle (a < 1) to the line (a > 1): the polynomial leaves one for the other at the symmetry breaking."""
    corner = (Fraction(1, 20), Fraction(-1, 10), Fraction(1, 20))
    refused(prove(replace(THROUGH, half_width=Fraction(1, 50), polynomial=(corner,), tube=(Fraction(tube),))))


def test_wrong_parameters_are_refused() -> None:
    assert "tube" in refused(prove_piece(TWIST, {"omega": OMEGA - Fraction(1, 10**5)}, REGULAR, WHOLE, FAST))
    near = prove_piece(TWIST, {"omega": OMEGA + Fraction(1, 10**8)}, REGULAR, WHOLE, FAST)
    assert proved_interval(near).deviation[0] > Fraction(9, 10**9)


def test_pieces_of_another_system_are_refused() -> None:
    refused(prove_piece(FALKNER_SKAN, {}, REGULAR, WHOLE, FAST))
    for system in SYSTEMS.values():
        refused(prove_piece(system, TWISTED, REGULAR, WHOLE, FAST, None, "S"))
    refused(prove_piece(TWIST, {}, REGULAR, WHOLE, FAST))


def test_curves_of_second_returns_are_refused() -> None:
    """For omega = 1, half of a full turn at the first return: symmetric at the second return only."""
    a0 = mpmath.mpf(1) / 2
    taylor = mpmath.taylor(lambda a: mpmath.sqrt(1 - mpmath.mpf(5) / 4 * a * a), a0, 12)
    row = tuple(Fraction(str(mpmath.nstr(c / 32**n, 30))) for n, c in enumerate(taylor))
    piece = Piece(
        "second", "regular", (Fraction(1, 2), Fraction(0)), LINE.frame, Fraction(1, 32), (row,), (TUBE,), "auto"
    )
    a, c = (number(x) for x in piece.point(Fraction(1, 3)))
    angle = mpmath.pi * (1 + a * a + c * c / 2) / (1 + a * a / 4)
    assert abs(mpmath.sin(2 * angle)) < 1e-10
    refused(prove_piece(TWIST, {"omega": Fraction(1)}, piece, WHOLE, FAST))


@pytest.mark.parametrize(
    "interval",
    [
        (Fraction(-2), Fraction(1)),
        (Fraction(0), Fraction(1) + Fraction(1, 10**30)),
        (Fraction(1, 2), Fraction(1, 2)),
        (Fraction(0), Fraction(0)),
        (Fraction(1), Fraction(-1)),
        (Fraction(3), Fraction(4)),
        (Fraction(-(10**400)), Fraction(10**400)),
    ],
    ids=lambda interval: f"{float(interval[0] % 7):.3g}",
)
@pytest.mark.parametrize("piece", [SYMMETRIC, REGULAR], ids=["symmetric", "regular"])
def test_intervals_that_are_none_are_refused(piece: Piece, interval: tuple[Fraction, Fraction]) -> None:
    assert "interval" in refused(prove(piece, interval))


NOT_SYMMETRIC: Mapping[str, Piece] = {
    "odd coefficient": with_terms(SYMMETRIC, {1: TINY}),
    "high odd coefficient": with_terms(SYMMETRIC, {9: TINY}),
    "centre off the plane": shifted(SYMMETRIC, (ONE, TINY)),
    "column 0 not odd": replace(SYMMETRIC, frame=((TINY, ONE), (ONE, ZERO))),
    "column 1 not even": replace(SYMMETRIC, frame=((ZERO, ONE), (ONE, TINY))),
    "column 0 even": replace(SYMMETRIC, frame=((ONE, ZERO), (ZERO, ONE))),
}


@pytest.mark.parametrize("name", NOT_SYMMETRIC)
@pytest.mark.parametrize("interval", [WHOLE, (Fraction(1, 10), ONE)], ids=["whole", "part"])
def test_symmetric_pieces_without_the_symmetry_are_refused(name: str, interval: tuple[Fraction, Fraction]) -> None:
    assert "not symmetric" in refused(prove(NOT_SYMMETRIC[name], interval))


@pytest.mark.parametrize("symmetry", [None, "T", ""])
def test_symmetric_pieces_of_a_claim_without_a_symmetry_are_refused(symmetry: str | None) -> None:
    assert "symmetry" in refused(prove(SYMMETRIC, symmetry=symmetry))


DEGENERATE: Mapping[str, Piece] = {
    "tube of width 0": replace(REGULAR, tube=(ZERO,)),
    "tube of negative width": replace(REGULAR, tube=(-TUBE,)),
    "no tube": replace(REGULAR, tube=()),
    "tube beyond floating point": replace(REGULAR, tube=(Fraction(10**400),)),
    "tube below floating point": replace(REGULAR, tube=(Fraction(1, 10**400),)),
    "half width 0": replace(REGULAR, half_width=ZERO),
    "negative half width": replace(REGULAR, half_width=-WIDTH),
    "half width 10^3": replace(REGULAR, half_width=Fraction(1000)),
    "half width 10^300": replace(REGULAR, half_width=Fraction(10**300)),
    "half width 10^400": replace(REGULAR, half_width=Fraction(10**400)),
    "wide tube": replace(REGULAR, tube=(Fraction(5),)),
    "huge coefficient": with_terms(REGULAR, {3: Fraction(10**320)}),
    "singular frame": replace(REGULAR, frame=((ONE, ONE), (ONE, ONE))),
    "frame without a direction along": replace(REGULAR, frame=((ZERO, Fraction(3, 5)), (ZERO, Fraction(4, 5)))),
    "frame of another size": replace(REGULAR, frame=((ONE,), (ZERO,))),
    "centre at infinity": shifted(REGULAR, (Fraction(10**400), ZERO)),
    "centre of another size": shifted(REGULAR, (ONE, ZERO, ZERO)),
    "unknown kind": replace(REGULAR, kind="loop"),
    "at rest": shifted(LINE, (ZERO, ZERO)),
}


LONG = ("half width 10^3", "wide tube")


@pytest.mark.parametrize("name", [*(name for name in DEGENERATE if name not in LONG), *slow(*LONG)])
def test_degenerate_pieces_are_refused(name: str) -> None:
    refused(prove(DEGENERATE[name]))


def test_frames_without_a_direction_along_are_refused_where_the_rest_is_right() -> None:
    """The same orbit for every s."""
    piece = replace(REGULAR, frame=((ZERO, Fraction(3, 5)), (ZERO, Fraction(4, 5))), polynomial=((ZERO,),))
    assert "frame" in refused(prove(piece))


@pytest.mark.parametrize("coordinates", ["physical", "regularised", "auto"])
def test_collisions_in_a_piece_are_refused(coordinates: str) -> None:
    identity = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))
    for centre in ((1 - MU, ZERO, Fraction(1, 2)), (1 - MU + Fraction(1, 200), ZERO, Fraction(1, 2))):
        piece = Piece(
            "collision", "regular", centre, identity, Fraction(1, 100), ((ZERO,), (ZERO,)), (TUBE, TUBE), coordinates
        )  # fmt: skip
        refused(prove_piece(CR3BP, {"mu": MU}, piece, WHOLE, PieceLimits(60, 20, 8)))


# Pieces of the theorems


@cache
def known_piece(name: str) -> tuple[ReversibleSystem, dict[str, Fraction], str | None, Piece]:
    entry = json.loads((DATA / "branch-pieces.json").read_text())[name]
    system = BRANCH_SYSTEMS[entry["system"]]
    parameters = {key: parse_exact(value) for key, value in entry["parameters"].items()}
    piece = piece_from_json(entry["piece"], system, name)
    # A tube wider than that of the atlas allows less precision.
    return system, parameters, entry["symmetry"], replace(piece, tube=tuple(8 * width for width in piece.tube))


def equations(system: ReversibleSystem) -> Callable[[Sequence[Fraction]], list[Any]]:
    """q at the first return, by an independent integrator."""
    if system is FALKNER_SKAN:
        orbits = Orbits(falkner_skan, system.section_index, BITS)
        return lambda point: [number(orbits.crossings([ZERO, point[1], ZERO], [point[0]], 1)[0].state[0])]
    orbits = Orbits(three_body, 1, BITS)
    if system is CR3BP:

        def spatial(point: Sequence[Fraction]) -> list[Any]:
            x, z, vy = point
            state = orbits.crossings([x, ZERO, z, ZERO, vy, ZERO], [MU], 1)[0].state
            return [number(state[3]), number(state[5])]

        return spatial

    def planar(point: Sequence[Fraction]) -> list[Any]:
        eps, vy = point
        start = [libration_point() + eps, ZERO, ZERO, ZERO, eps * vy, ZERO]
        return [number(orbits.crossings(start, [MU], 1)[0].state[3] / eps)]

    return planar


def true_distances(system: ReversibleSystem, piece: Piece, s: Fraction) -> list[Any]:
    """p_j of the orbit at s less the polynomial, by one Newton step with finite differences."""
    function, size = equations(system), len(piece.tube)
    columns = list(zip(*piece.frame, strict=True))[1:]
    point, shift = piece.point(s), Fraction(1, 2**50)
    value = function(point)
    slopes = mpmath.matrix(size, size)
    for j, column in enumerate(columns):
        moved = function([x + shift * direction for x, direction in zip(point, column, strict=True)])
        for i in range(size):
            slopes[i, j] = (moved[i] - value[i]) / number(shift)
    return [-x for x in mpmath.lu_solve(slopes, mpmath.matrix(value))]


CASES = {
    "falkner-skan": (Fraction(-1, 16), Fraction(1, 16)),
    "symmetric": (Fraction(-1, 16), Fraction(1, 16)),
    "lyapunov": (Fraction(1, 4), Fraction(5, 16)),
    "regularised": (Fraction(-1, 32), Fraction(1, 32)),
}


def check_orbits(name: str, interval: tuple[Fraction, Fraction], limits: PieceLimits, count: int) -> None:
    """The true branch, and its slope, at random s."""
    system, parameters, symmetry, piece = known_piece(name)
    result = prove_piece(system, parameters, piece, interval, limits, None, symmetry)
    known = proved_interval(result)
    if name == "regularised":
        assert result.computation["coordinates"] != "physical"
    step = Fraction(1, 2**20)
    for s in places((known.start, known.end), count)[-count:]:
        s = s or step
        here = true_distances(system, piece, s)
        there = true_distances(system, piece, s + step)
        for j, (value, other) in enumerate(zip(here, there, strict=True)):
            assert abs(value) <= number(known.deviation[j]) * (1 + mpmath.mpf(2) ** -20)
            scale = abs(s) + step if piece.kind == "symmetric" else ONE
            assert abs(other - value) / number(step) <= number(known.slope_deviation[j] * scale) + 1e-20


@pytest.mark.parametrize("name", ["falkner-skan", "symmetric"])
def test_proved_pieces_hold_independent_orbits(name: str) -> None:
    check_orbits(name, CASES[name], PieceLimits(60, 24, 10), 2)


@pytest.mark.slow
@pytest.mark.parametrize("interval", ["case", "whole", "end"])
@pytest.mark.parametrize("name", CASES)
def test_proved_pieces_hold_many_independent_orbits(name: str, interval: str) -> None:
    ranges = {"case": CASES[name], "whole": WHOLE, "end": (Fraction(3, 4), ONE)}
    check_orbits(name, ranges[interval], PieceLimits(), 8)


@pytest.mark.slow
def test_halo_and_lyapunov_orbits_are_not_one_piece() -> None:
    """The symmetric piece of halo orbits as a regular one, the planar orbits through it, and a jump between them."""
    system, parameters, _, piece = known_piece("symmetric")
    limits, part = PieceLimits(60, 24, 10), (Fraction(-1, 16), Fraction(1, 16))
    for tube in (piece.tube, (Fraction(1, 10**6),) * 2):
        regular = replace(piece, kind="regular", tube=tube)
        assert "derivative across the curve" in refused(prove_piece(system, parameters, regular, part, limits))
    # The tangent of the planar orbits at the symmetry breaking, along x.
    for bend in (ZERO, Fraction(1, 1000)):
        planar = Piece(
            "planar", "regular", piece.centre, ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (Fraction(-8), ZERO, ONE)),
            Fraction(1, 10**6), ((ZERO, bend), (ZERO,)), (Fraction(1, 10**4),) * 2, "physical",
        )  # fmt: skip
        refused(prove_piece(system, parameters, planar, WHOLE, limits))


def test_wrong_masses_are_refused() -> None:
    system, parameters, symmetry, piece = known_piece("symmetric")
    wrong = {"mu": parameters["mu"] * (1 + Fraction(1, 10**6))}
    part = (Fraction(-1, 16), Fraction(1, 16))
    assert "tube" in refused(prove_piece(system, wrong, piece, part, PieceLimits(60, 24, 8), None, symmetry))


def test_what_progress_raises_passes_through() -> None:
    class Stop(Exception):
        pass

    def stop(steps: float) -> None:
        assert steps == 1
        raise Stop

    with pytest.raises(Stop):
        prove_piece(TWIST, TWISTED, REGULAR, WHOLE, FAST, stop)


@pytest.mark.parametrize("arguments", [(8, 20, 12), (60, 8, 12), (60, 20, 0)])
def test_senseless_limits_are_refused(arguments: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match="too small"):
        PieceLimits(*arguments)
