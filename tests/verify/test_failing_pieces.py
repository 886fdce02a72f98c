"""A piece that fails says why in words about pieces: no box, no radii, no exceptions, a remedy that a piece has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb_mat
from support.piece_cases import FAST, LINE, REGULAR, TWISTED, WHOLE, prove
from support.wide_checks import MU, TWIST

from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.curve import HalfReturn, PieceLimits, PieceResult, ProvedInterval, broken_off, prove_piece
from orbitproof.verify.curve import piece as curve_piece
from orbitproof.verify.evidence import NotProved, Reason
from orbitproof.verify.oracle import ORACLE

FOREIGN = ("Error", "solve()", "radii", "radius", "box", "another centre", "a better centre")

HALO = Piece(
    "halo", "regular", (Fraction(4, 5), Fraction(0), Fraction(3, 10)),
    ((Fraction(1), Fraction(0), Fraction(0)), (Fraction(0), Fraction(1), Fraction(0)),
     (Fraction(0), Fraction(0), Fraction(1))), Fraction(1, 10**4),
    ((Fraction(0),), (Fraction(0),)), (Fraction(1, 10**9), Fraction(1, 10**9)), "physical",
)  # fmt: skip


def reason_of(result: PieceResult[ProvedInterval]) -> Reason:
    assert isinstance(result.outcome, NotProved)
    reason = result.outcome.reason
    for word in FOREIGN:
        assert word not in reason.message
        assert word not in reason.remedy
    assert "piece" in reason.remedy or "tube" in reason.remedy
    return reason


def in_space(piece: Piece) -> PieceResult[ProvedInterval]:
    return prove_piece(CR3BP, {"mu": MU}, piece, WHOLE, ORACLE, PieceLimits(56, 18, 8), None, "S")


def longer(piece: Piece, factor: int) -> Piece:
    """The piece with the same polynomial over a longer stretch."""
    rows = tuple(tuple(c * factor**n for n, c in enumerate(row)) for row in piece.polynomial)
    return replace(piece, half_width=piece.half_width * factor, polynomial=rows)


def at_the_primary() -> PieceResult[ProvedInterval]:
    return in_space(replace(HALO, centre=(1 - MU, Fraction(0), Fraction(0))))


def at_rest() -> PieceResult[ProvedInterval]:
    """The orbit starts on the section without crossing it."""
    return in_space(replace(HALO, centre=(*HALO.centre[:2], Fraction(0))))


@pytest.mark.parametrize(
    ("result", "conditions"),
    [
        (lambda: prove(longer(REGULAR, 64)), {"size", "tube", "newton", "slope", "singularity"}),
        (lambda: prove(longer(REGULAR, 10**30)), {"size", "singularity"}),
        (lambda: prove(replace(LINE, tube=(Fraction(2),))), {"newton", "slope", "tube"}),
        (lambda: prove(replace(LINE, tube=(Fraction(10**30),))), {"size", "tube", "newton", "slope", "singularity"}),
        (lambda: prove(replace(REGULAR, polynomial=((Fraction(1, 10),),))), {"newton"}),
        (at_rest, {"crossing count"}),
        (at_the_primary, {"singularity"}),
    ],
    ids=["long", "very long", "wide tube", "very wide tube", "no curve", "tangent to the section", "collision"],
)
def test_a_piece_that_fails_says_why_in_words_about_pieces(
    result: Callable[[], PieceResult[ProvedInterval]], conditions: set[str]
) -> None:
    assert reason_of(result()).condition in conditions


def test_a_singular_matrix_is_a_derivative_across_the_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_solution(*_: Any) -> Any:
        return arb_mat([[0]]).solve(arb_mat([[1]]))

    monkeypatch.setattr(curve_piece, "newton_image", no_solution)
    found = reason_of(prove(REGULAR))
    assert found.condition == "slope"
    assert found.message == "the derivative across the curve may be singular"


@pytest.mark.parametrize("fault", [ZeroDivisionError("singular matrix in solve()"), OverflowError("(34, 'x')")])
def test_arithmetic_that_has_no_result_is_put_into_words(
    fault: ArithmeticError, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: Any) -> Any:
        raise fault

    monkeypatch.setattr(HalfReturn, "of", broken)
    found = reason_of(prove_piece(TWIST, TWISTED, REGULAR, WHOLE, ORACLE, FAST))
    assert str(fault) not in found.message
    assert "may be singular" in broken_off("verification", ZeroDivisionError("singular matrix in solve()")).message
