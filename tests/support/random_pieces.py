"""Random pieces with random proved intervals, and their curves in exact numbers."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from orbitproof.shared.claims import Piece
from orbitproof.verify.curve.proved_intervals import ProvedInterval, Run


def number(chance: random.Random, size: int = 1) -> Fraction:
    return Fraction(chance.randint(-64 * size, 64 * size), 64)


def bounds(chance: random.Random, count: int, most: int) -> tuple[Fraction, ...]:
    return tuple(Fraction(chance.randint(1, 63), 64 * most) for _ in range(count))


def random_piece(chance: random.Random, size: int, degree: int = 2, symmetric: bool = False, name: str = "p") -> Piece:
    """With so many coordinates across the curve; of a symmetric one the symmetry negates the coordinate 0."""
    frame = [[number(chance) for _ in range(size + 1)] for _ in range(size + 1)]
    for place in range(size + 1):
        frame[place][place] += chance.choice([-3, 3])
    if symmetric:
        frame[0] = [frame[0][0], *[Fraction(0)] * size]
        frame[1:] = [[Fraction(0), *row[1:]] for row in frame[1:]]
    step = 2 if symmetric else 1
    rows = [[number(chance) if n % step == 0 else Fraction(0) for n in range(degree + 1)] for _ in range(size)]
    centre = [number(chance, 4) for _ in range(size + 1)]
    return Piece(
        name,
        "symmetric" if symmetric else "regular",
        tuple([Fraction(0), *centre[1:]] if symmetric else centre),
        tuple(map(tuple, frame)),
        Fraction(chance.randint(1, 8), 8),
        tuple(map(tuple, rows)),
        tuple(Fraction(1, 4) for _ in range(size)),
    )


def random_run(chance: random.Random, size: int, most: int = 8, **more: Any) -> Run:
    """Of intervals that overlap, with bounds of their own, at most 1/`most`."""
    places = [Fraction(-1), Fraction(-1, 2), Fraction(1, 4), Fraction(1)]
    ends = [(start, min(end + Fraction(1, 16), Fraction(1))) for start, end in pairwise(places)]
    return Run(
        tuple(ProvedInterval(*each, bounds(chance, size, most), bounds(chance, size, most), **more) for each in ends)
    )


def corners(errors: Sequence[Fraction], chance: random.Random) -> list[Fraction]:
    return [chance.choice([-1, 1]) * error for error in errors]


def values(coefficients: Sequence[Fraction], s: Fraction, order: int = 0) -> Fraction:
    """Of a polynomial, or of its derivative."""
    for _ in range(order):
        coefficients = [n * c for n, c in enumerate(coefficients)][1:]
    return sum((c * s**n for n, c in enumerate(coefficients)), Fraction(0))


def image(rows: Sequence[Sequence[Fraction]], vector: Sequence[Fraction]) -> list[Fraction]:
    return [sum((a * b for a, b in zip(row, vector, strict=True)), Fraction(0)) for row in rows]


def coordinates(piece: Piece, p: Sequence[Fraction]) -> list[Fraction]:
    return [c + value for c, value in zip(piece.centre, image(piece.frame, p), strict=True)]
