"""What a complete list of a skew product has to say, and results of its pieces, both from closed forms."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
from flint import arb
from numpy.polynomial import chebyshev
from support.list_truths import KnownCurve
from support.skew_products import SkewProduct, energy, half_period, interpolated, powers

from orbitproof.shared import format_exact
from orbitproof.shared.claims import Atlas, Piece
from orbitproof.verify.evidence import ball_to_json
from orbitproof.verify.functions import REACH

_DEGREE = 24
_ENTRIES = ("11", "12", "21", "22")
_STEEP = 40.0
"""Stability parameters of curves that are made here are at most of this size."""


def _integers(source: random.Random, low: float, high: float) -> Fraction:
    return Fraction(round(source.uniform(low, high) * 16), 16)


def line(seed: int, n: int, symplectic: bool) -> SkewProduct:
    """A random system with a line of symmetric orbits y = 0, as long as no other orbits meet it."""
    source = random.Random(f"{seed} {n} {symplectic}")
    while True:
        matrices = []
        for least, most, coupling in ((0.2, 5.0, 1.0), (-0.8, 0.8, 0.5), (-1.0, 3.0, 1.0)):
            rows = [[_integers(source, -coupling, coupling) for _ in range(n)] for _ in range(n)]
            for i in range(n):
                rows[i][i] = _integers(source, least, most) or Fraction(1, 8)
                for j in range(i):
                    rows[i][j] = rows[j][i] if symplectic else rows[i][j]
            matrices.append(tuple(map(tuple, rows)))
        system = SkewProduct(f"line-{n}-{'symplectic' if symplectic else 'free'}-{seed}", tuple(matrices), 0.3, 2.0)
        places = np.linspace(0.3, 2.0, 341)
        meets = np.linalg.det(system.kernel_block(places))
        good = (np.abs(meets) > 0.05) & (np.abs(system.sigma(places)).max(axis=(-2, -1)) < _STEEP)
        breaks = [0, *(np.flatnonzero((meets[1:] * meets[:-1] < 0) | ~good[1:]) + 1), len(places)]
        first, last = max(pairwise(breaks), key=lambda pair: pair[1] - pair[0])
        begin, end = places[first] + 0.03, places[last - 1] - 0.03
        if end - begin > 0.6:
            return SkewProduct(system.name, system.stiffness, float(begin), float(end))


_ARCS = {"folds": (-0.9, pi - 0.4), "loop": (0.3, 0.3 + 2 * pi), "breaks": (0.0, pi)}


def ellipse(seed: int, n: int, kind: str) -> SkewProduct:
    """A random system with an ellipse of symmetric orbits.

    Args:
        kind: "folds", an arc with a fold; "loop", all of it; "breaks", the half that y_1 -> -y_1 maps to the other.
    """
    source = random.Random(f"{seed} {n} {kind}")
    breaks = kind == "breaks"
    while True:
        shape = (_integers(source, 1.0, 1.6), _integers(source, 1.0, 1.5), _integers(source, 0.4, 0.6))
        strength = source.uniform(0.1, 0.9) / float(shape[2])
        matrices = []
        for least, most, coupling in ((0.5, 1.0, 0.3), (-0.2, 0.2, 0.1), (-0.1, 0.5, 0.2)):
            rows = [[_integers(source, -coupling, coupling) for _ in range(n)] for _ in range(n)]
            for i in range(n):
                rows[i][i] = (
                    (_integers(source, least, most) or Fraction(1, 8))
                    * Fraction(round(strength * 16), 16)
                    * (1 + 3 * int(i > 0))
                )
            matrices.append(tuple(map(tuple, rows)))
        begin, end = _ARCS[kind]
        system = SkewProduct(f"{kind}-{n}-{seed}", tuple(matrices), begin, end, shape, breaks)
        places = np.linspace(begin - 0.05, end + 0.05, 340)
        # At a fold, where F_y = 0, the orbits that meet the curve are those of the curve.
        meets = np.linalg.det(system.kernel_block(places)) / (np.sin(places) ** (2 if breaks else 1))
        if (
            np.abs(system.sigma(places)).max() < _STEEP
            and (np.sign(meets) == np.sign(meets[0])).all()
            and np.abs(meets).min() > 0.02
        ):
            return system


def in_plane(seed: int, system: SkewProduct) -> SkewProduct:
    """The same as motion in a plane, with random variations out of it."""
    source = random.Random(f"{seed} across")
    across = (_integers(source, 2.0, 9.0), _integers(source, -4.0, 4.0), _integers(source, 8.0, 24.0))
    return replace(system, name=f"{system.name}-in-plane", across=across)


# Results, as a prover of pieces would give them


def results(system: SkewProduct, atlas: Atlas, split: bool = False, error: float = 1e-7) -> list[dict[str, Any]]:
    """Results of all pieces, true by the closed forms: the bounds contain the rounding of float64.

    Args:
        split: whether each piece has results on two intervals that overlap.
        error: of the stored functions.
    """
    found = []
    for piece in atlas.curve_pieces():
        middle = Fraction(1, 4) if piece.kind == "symmetric" else Fraction(1, 8)
        low = -middle if piece.kind == "symmetric" else Fraction(-1)
        intervals = [(low, middle), (middle - Fraction(1, 64), Fraction(1))] if split else [(Fraction(-1), Fraction(1))]
        found += [result(system, piece, interval, error) for interval in intervals]
    return found


def result(system: SkewProduct, piece: Piece, interval: tuple[Fraction, Fraction], error: float) -> dict[str, Any]:
    """What is true of a piece on an interval of s."""
    middle, radius = sum(interval) / 2, (interval[1] - interval[0]) / 2
    # On more than |tau| <= 1, so that the series in tau is known well there.
    beyond = float(REACH)
    places = system.places(piece, float(middle) + float(radius * REACH) * beyond * chebyshev.chebpts1(_DEGREE + 1))
    amplitudes, sigma = system.amplitude(places), system.sigma(places)
    functions = [
        *minors(sigma),
        energy(amplitudes),
        half_period(amplitudes),
        np.linalg.det(system.first_block(places)),
        *(() if system.across is None else system.variations(places)),
    ]
    rows = powers(interpolated(np.array(functions))) / beyond ** np.arange(_DEGREE + 1)[:, None]
    if piece.kind == "symmetric" and not middle:
        rows[1::2] = 0
    bound = format_exact(Fraction(error))
    stored = [
        {"coefficients": [format_exact(Fraction(float(value))) for value in row], "error": bound} for row in rows.T
    ]
    n = system.size
    times = functions[n + 1]
    return {
        "piece": piece.id,
        "interval": [format_exact(end) for end in interval],
        "verdict": "proved",
        "reason": None,
        "deviation": [format_exact(Fraction(1, 2**30))] * n,
        "slope_deviation": [format_exact(Fraction(1, 2**26))] * n,
        "time": ball_to_json(arb(float(times.max() + times.min()) / 2, float(np.ptp(times)))),
        "stability": {
            "characteristic": stored[:n],
            **dict(zip(("level", "half_period", "first_factor"), stored[n : n + 3], strict=True)),
            **({} if system.across is None else {"out_of_plane": dict(zip(_ENTRIES, stored[n + 3 :], strict=True))}),
        },
    }


def minors(sigma: Any) -> list[Any]:
    """a_1, .., a_n: the sums of principal minors, by Newton's identities; sigma of shape (.., n, n)."""
    found, sums, power = [np.ones(sigma.shape[:-2])], [], sigma
    for k in range(1, sigma.shape[-1] + 1):
        sums.append(np.trace(power, axis1=-2, axis2=-1))
        found.append(sum((-1) ** (i - 1) * found[k - i] * sums[i - 1] for i in range(1, k + 1)) / k)
        power = power @ sigma
    return found[1:]


# What is true


def curve_of(system: SkewProduct, atlas: Atlas) -> KnownCurve:
    """The curve that an atlas claims, from the closed forms."""
    pieces = {piece.id: piece for piece in atlas.curve_pieces()}

    def place(piece: str, s: float) -> float:
        return float(system.places(pieces[piece], np.array([s]))[0])

    begin, end = system.begin, system.end
    if atlas.claim.kind == "arc":
        # The pieces of an arc lead beyond its ends.
        names = list(pieces)
        begin, end = place(names[0], -1.0), place(names[-1], 1.0)
    return KnownCurve(
        system.size,
        begin,
        end,
        place,
        system.point,
        lambda places: minors(system.sigma(places)),
        lambda places: np.linalg.det(system.first_block(places)),
        lambda places: energy(system.amplitude(places)),
        lambda places: half_period(system.amplitude(places)),
        (begin, end) if system.breaks else (),
        0.0 if system.ellipse is None else 2 * pi,
        None if system.across is None else system.variations,
        distances=None if system.body is None else system.distances,
    )
