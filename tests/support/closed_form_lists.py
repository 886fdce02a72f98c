"""What a complete list of a skew product has to say, and results of its pieces, both from closed forms."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import cos, pi
from typing import Any

import numpy as np
from flint import arb
from numpy.polynomial import chebyshev
from scipy.optimize import brentq
from support.skew_products import SkewProduct, energy, half_period, interpolated, powers

from orbitproof.shared.formats.atlas import Atlas, Piece
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.verify.evidence.balls_as_text import ball_from_json, ball_to_json
from orbitproof.verify.functions.functions import REACH
from orbitproof.verify.stability.complete_list import orders

_GRID = 2401
_DEGREE = 24
_STEEP = 40.0
"""Stability parameters of curves that are made here are at most of this size."""

Value = Callable[[Any], Any]


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
        kind: "folds", an arc with a fold; "loop", all of it; "breaks", n = 1, the half that y -> -y maps to the other.
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
            **dict(zip(("level", "half_period", "first_factor"), stored[n:], strict=True)),
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


@dataclass(frozen=True)
class Expected:
    """A point of the curve: `k`, `j`, `kind` as in the list, and where it is."""

    k: int
    j: int
    kind: str
    place: float


@dataclass(frozen=True)
class Truth:
    """All that a list up to an order has to say of a curve, found on a fine grid."""

    system: SkewProduct
    atlas: Atlas
    order: int

    def place(self, piece: str, s: float) -> float:
        """Where on the curve s of a piece is."""
        (found,) = [entry for entry in self.atlas.curve_pieces() if entry.id == piece]
        return float(self.system.places(found, np.array([s]))[0])

    @cached_property
    def grid(self) -> Any:
        """Places along the curve; the pieces of an arc lead beyond its ends."""
        pieces, begin, end = self.atlas.curve_pieces(), self.system.begin, self.system.end
        if self.atlas.claim.kind == "arc":
            begin, end = self.place(pieces[0].id, -1.0), self.place(pieces[-1].id, 1.0)
        return np.linspace(begin, end, _GRID)

    def points(self) -> Iterator[Expected]:
        """Resonances, folds, losses of R, doublings and Krein collisions."""
        for k, j in orders(self.order):
            yield from (
                Expected(k, j, self._kind(k, place), place)
                for place in self._zeros(self._chi(cos(2 * pi * j / k)), k == 1)
            )
        if self.system.size == 2:
            yield from (Expected(0, 0, "Krein collision", place) for place in self._zeros(self._discriminant, False))
        if self.system.breaks:
            yield from (Expected(1, 0, "symmetric point", place) for place in (self.system.begin, self.system.end))

    def _kind(self, k: int, place: float) -> str:
        if k == 1:
            return (
                "fold"
                if self._is_zero(lambda p: np.gradient(energy(self.system.amplitude(p)), p), place)
                else "loss of R"
            )
        if k == 2:
            here = self._is_zero(lambda p: np.linalg.det(self.system.first_block(p)), place)
            return "singular at this point" if here else "singular at the other point"
        return "resonance"

    @staticmethod
    def _is_zero(function: Value, place: float) -> bool:
        values = function(place + np.linspace(-1e-4, 1e-4, 9))
        return bool(values[1] * values[-2] < 0)

    def _chi(self, c: float) -> Value:
        return lambda place: np.linalg.det(c * np.eye(self.system.size) - self.system.sigma(place))

    def _discriminant(self, place: Any) -> Any:
        trace, determinant = minors(self.system.sigma(place))
        return trace * trace - 4 * determinant

    def _zeros(self, function: Value, double: bool) -> list[float]:
        """`double`: whether zeros at the symmetric points are left out."""
        grid = self.grid[1:-1] if self.system.breaks and double else self.grid
        values = function(grid)
        changes = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0)
        return [float(brentq(lambda p: float(function(p)), grid[i], grid[i + 1], xtol=1e-13)) for i in changes]

    def extrema(self, band: float) -> list[tuple[float, float]]:
        """Places and values of stationary real stability parameters, symmetric points excepted, for n = 1 and n = 2."""
        grid = self.grid[1:-1]
        found = []
        for branch in range(self.system.size):

            def slope(place: Any, branch: int = branch) -> Any:
                here, before, after = (self.parameters(place + shift)[branch] for shift in (0, -1e-5, 1e-5))
                return (after - before) / 2e-5 + 0 * here

            values = slope(grid)
            with np.errstate(invalid="ignore"):
                changes = np.flatnonzero(values[1:] * values[:-1] < 0)
            for i in changes:
                place = float(brentq(lambda p: float(slope(p)), grid[i], grid[i + 1], xtol=1e-9))
                value = float(self.parameters(place)[branch])
                if abs(value) < band:
                    found.append((place, value))
        return sorted(found)

    def parameters(self, place: Any) -> list[Any]:
        """The stability parameters in order, NaN where they are complex; n = 1 and n = 2."""
        found = minors(self.system.sigma(place))
        if len(found) == 1:
            return found
        trace, determinant = found
        with np.errstate(invalid="ignore"):
            root = np.sqrt(trace * trace - 4 * determinant)
        return [(trace - root) / 2, (trace + root) / 2]

    def is_stable(self, place: Any) -> Any:
        """Whether all stability parameters are real, distinct and in (-1, 1)."""
        with np.errstate(invalid="ignore"):
            values = self.parameters(place)
            inside = np.all([np.abs(value) < 1 for value in values], axis=0)
            return inside & (values[0] != values[-1]) if len(values) > 1 else inside


# What a list says


def misses(truth: Truth, found: Mapping[str, Any]) -> list[str]:
    """What is missing in the JSON object of a list, or false, in words."""
    return [*_wrong_points(truth, found), *_wrong_extrema(truth, found), *_wrong_stability(truth, found)]


_SAME = 1e-6
"""Places along a curve that are closer are the same."""


def _interval(truth: Truth, entry: Mapping[str, Any]) -> tuple[float, float]:
    """The places of a gap, or of an end of an interval of stability."""
    ends = sorted(truth.place(entry["piece"], float(parse_exact(text))) for text in entry["interval"])
    return ends[0] - _SAME, ends[1] + _SAME


def _within(truth: Truth, interval: tuple[float, float], place: float) -> bool:
    """Whether a place is in an interval, on an ellipse up to whole turns."""
    turns = (0, -1, 1) if truth.system.ellipse is not None else (0,)
    return any(interval[0] <= place + 2 * pi * turn <= interval[1] for turn in turns)


def _around(truth: Truth, entry: Mapping[str, Any]) -> tuple[float, float]:
    """The places of a point that is listed."""
    s = ball_from_json(entry["s"])
    ends = sorted(truth.place(entry["piece"], float(end)) for end in (s.lower(), s.upper()))
    return ends[0] - _SAME, ends[1] + _SAME


def _encloses(entry: Mapping[str, str], value: float) -> bool:
    return bool((ball_from_json(entry) + arb(0, _SAME)).contains(arb(value)))


def _wrong_points(truth: Truth, found: Mapping[str, Any]) -> Iterator[str]:
    gaps = [(entry["about"], _interval(truth, entry)) for entry in found["gaps"]]
    left = list(truth.points())
    for point in found["points"]:
        what, around = (point["k"], point["j"], point["kind"]), _around(truth, point)
        here = [e for e in left if (e.k, e.j, e.kind) == what and _within(truth, around, e.place)]
        if len(here) != 1:
            yield f"false: k, j, kind = {what} in {around}"
            continue
        left.remove(here[0])
        amplitude = truth.system.amplitude(here[0].place)
        for name, value in (("level", energy(amplitude)), ("half_period", half_period(amplitude))):
            if not _encloses(point[name], value):
                yield f"false: {name} of {what} in {around}"
    for entry in left:
        subjects = ({"k": entry.k, "j": entry.j} if entry.k else entry.kind, "everything")
        if not any(_within(truth, around, entry.place) for about, around in gaps if about in subjects):
            yield f"missing: {entry}"


def _wrong_extrema(truth: Truth, found: Mapping[str, Any]) -> Iterator[str]:
    if truth.system.size > 2:
        return
    gaps = [_interval(truth, entry) for entry in (*found["open_extrema"], *found["gaps"])]
    left = truth.extrema(1.2)
    for entry in found["extrema"]:
        around = _around(truth, entry)
        here = [e for e in left if _within(truth, around, e[0]) and _encloses(entry["value"], e[1])]
        if len(here) != 1:
            yield f"false: extremum in {around}"
        left = [e for e in left if e not in here]
    for place, value in left:
        if abs(value) < 1.1 - _SAME and not any(_within(truth, around, place) for around in gaps):
            yield f"missing: extremum {value:.9f} at {place:.9f}"


def _wrong_stability(truth: Truth, found: Mapping[str, Any]) -> Iterator[str]:
    if truth.system.size > 2:
        return
    grid = truth.grid[5:-5:7]
    said, open_ = np.zeros(len(grid), dtype=bool), np.zeros(len(grid), dtype=bool)
    for key, marks in (("stable", said), ("undecided", open_)):
        for entry in found[key]:
            begin, end = (_interval(truth, entry[name]) for name in ("from", "to"))
            marks |= _between(grid, begin[0], end[1])
            # Which side of a point an orbit within its enclosure is on is not known.
            open_ |= _between(grid, *begin) | _between(grid, *end)
    for place in grid[(truth.is_stable(grid) != said) & ~open_]:
        yield f"false: stability at {place:.6f} of {truth.system.name}"


def _between(grid: Any, low: float, high: float) -> Any:
    """Around the beginning of a loop if `low` is greater."""
    return (grid > low) & (grid < high) if low < high else (grid > low) | (grid < high)
