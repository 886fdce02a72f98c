"""Pieces whose claim is false or makes no sense are not proved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from support.exact_elements import number
from support.piece_cases import (
    FAST,
    LINE,
    ONE,
    REGULAR,
    SYMMETRIC,
    TINY,
    TUBE,
    TWISTED,
    WHOLE,
    WIDTH,
    ZERO,
    check_circle,
    known_piece,
    prove,
    proved_interval,
    refused,
    slow,
    with_terms,
)
from support.wide_checks import MU, OMEGA, TWIST
from support.within import within

from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, SYSTEMS
from orbitproof.verify.branches import condition_of
from orbitproof.verify.curve import SINGULAR, PieceLimits, prove_piece
from orbitproof.verify.oracle import ORACLE

_reference_precision = within(lambda: mpmath.workprec(200))


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
    result = prove(replace(THROUGH, tube=(Fraction(tube),)), interval)
    refused(result)
    if tube == "1e-6" and interval == WHOLE:
        assert condition_of(result.stored) == SINGULAR


@pytest.mark.parametrize("tube", ["1e-6", *slow("1e-4", "1e-2")])
def test_the_circle_through_the_symmetry_breaking_is_no_regular_piece(tube: str) -> None:
    regular = replace(SYMMETRIC, kind="regular", tube=(Fraction(tube),))
    refused(prove(regular, (Fraction(-1, 10**3), Fraction(1, 10**3))))
    away = replace(regular, tube=(TUBE,))
    check_circle(away, prove(away, (Fraction(1, 2), Fraction(1))))


def test_what_fails_without_a_bifurcation_in_it_may_be_proved_on_a_shorter_interval() -> None:
    assert condition_of(prove(with_terms(REGULAR, {6: Fraction(3, 10**6)})).stored) == "newton"


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
    assert "tube" in refused(prove_piece(TWIST, {"omega": OMEGA - Fraction(1, 10**5)}, REGULAR, WHOLE, ORACLE, FAST))
    near = prove_piece(TWIST, {"omega": OMEGA + Fraction(1, 10**8)}, REGULAR, WHOLE, ORACLE, FAST)
    assert proved_interval(near).deviation[0] > Fraction(9, 10**9)


def test_pieces_of_another_system_are_refused() -> None:
    refused(prove_piece(FALKNER_SKAN, {}, REGULAR, WHOLE, ORACLE, FAST))
    for system in SYSTEMS.values():
        refused(prove_piece(system, TWISTED, REGULAR, WHOLE, ORACLE, FAST, None, "S"))
    refused(prove_piece(TWIST, {}, REGULAR, WHOLE, ORACLE, FAST))


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
    refused(prove_piece(TWIST, {"omega": Fraction(1)}, piece, WHOLE, ORACLE, FAST))


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
        refused(prove_piece(CR3BP, {"mu": MU}, piece, WHOLE, ORACLE, PieceLimits(60, 20, 8)))


@pytest.mark.slow
def test_wrong_masses_are_refused() -> None:
    system, parameters, symmetry, piece = known_piece("symmetric")
    wrong = {"mu": parameters["mu"] * (1 + Fraction(1, 10**6))}
    part = (Fraction(-1, 16), Fraction(1, 16))
    assert "tube" in refused(prove_piece(system, wrong, piece, part, ORACLE, PieceLimits(60, 24, 8), None, symmetry))


def test_what_progress_raises_passes_through() -> None:
    class Stop(Exception):
        pass

    def stop(steps: float) -> None:
        assert steps == 1
        raise Stop

    with pytest.raises(Stop):
        prove_piece(TWIST, TWISTED, REGULAR, WHOLE, ORACLE, FAST, stop)


@pytest.mark.parametrize("arguments", [(8, 20, 12), (60, 8, 12), (60, 20, 0)])
def test_senseless_limits_are_refused(arguments: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match="too small"):
        PieceLimits(*arguments)
