"""Pieces of the circle and the line through its symmetry breaking, and their proofs."""

from __future__ import annotations

import json
import random
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import pytest
from support.exact_elements import number
from support.stored import entry_of
from support.wide_checks import OMEGA, TWIST

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Piece
from orbitproof.shared.formats import piece_from_json
from orbitproof.shared.systems import BRANCH_SYSTEMS, ReversibleSystem
from orbitproof.verify.curve import PieceLimits, PieceResult, ProvedInterval, prove_piece
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.oracle import ORACLE

DATA = Path(__file__).parents[1] / "data"
FAST = PieceLimits(56, 18, 12)
WHOLE = (Fraction(-1), Fraction(1))
TWISTED = {"omega": OMEGA}
WIDTH = Fraction(1, 8)
TUBE = Fraction(1, 10**6)
ONE, ZERO, TINY = Fraction(1), Fraction(0), Fraction(1, 10**12)


def slow(*values: Any) -> list[Any]:
    """Parameters of the long test run."""
    return [pytest.param(value, marks=pytest.mark.slow) for value in values]


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
    return prove_piece(TWIST, TWISTED, piece, interval, ORACLE, limits, None, symmetry)


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


def refused(result: PieceResult[ProvedInterval]) -> str:
    """The reason why a piece is not proved."""
    assert isinstance(result.outcome, NotProved)
    assert entry_of(result)["verdict"] == "not proved"
    assert result.outcome.reason.remedy
    return result.outcome.reason.message


@cache
def known_piece(name: str) -> tuple[ReversibleSystem, dict[str, Fraction], str | None, Piece]:
    entry = json.loads((DATA / "branch-pieces.json").read_text())[name]
    system = BRANCH_SYSTEMS[entry["system"]]
    parameters = {key: parse_exact(value) for key, value in entry["parameters"].items()}
    piece = piece_from_json(entry["piece"], system, name)
    # A tube wider than that of the atlas allows less precision.
    return system, parameters, entry["symmetry"], replace(piece, tube=tuple(8 * width for width in piece.tube))
