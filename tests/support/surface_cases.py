"""Pieces of surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath
from flint import arb
from support.exact_elements import number

from orbitproof.shared.claims import SurfacePiece, evaluate

WHOLE = (Fraction(-1), Fraction(1))
ONE = Fraction(1)


def point_of(piece: SurfacePiece, s: Fraction, p: Sequence[Fraction]) -> list[Any]:
    """The state on Fix(R) with coordinates p in the box at s, by the definition of the format."""
    p_0, p_1, p_2 = p
    bent = (
        p_0 + evaluate(piece.bend[0], s) * p_1**2,
        p_1,
        p_2 + evaluate(piece.tilt[0], s) * p_0 + evaluate(piece.bend[1], s) * p_1**2,
    )
    values = [
        evaluate(centre, s) + sum((a * b for a, b in zip(row, bent, strict=True)), Fraction(0))
        for centre, row in zip(piece.centre, piece.frame, strict=True)
    ]
    xi, zeta, veta = map(number, values)
    zero = mpmath.mpf(0)
    return [xi, zero, zeta, zero, veta, zero]


def exactly(value: Any) -> arb:
    sign, mantissa, exponent, _ = value._mpf_
    return arb((int(-mantissa if sign else mantissa), int(exponent)))
