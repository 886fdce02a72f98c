"""What a complete list of a curve has to say if all functions along the curve are known otherwise, and what it misses.

Every zero and extremum is looked for on a fine grid. Nothing here takes part in a proof: of the code under test only
the texts of balls are read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import cos, gcd, pi
from typing import Any

import numpy as np
from flint import arb
from scipy.optimize import brentq

from orbitproof.shared import parse_exact
from orbitproof.verify.evidence import ball_from_json

Value = Callable[[Any], Any]
"""A function of places along a curve."""

SAME = 1e-8
"""Places along a curve, or values, that are closer are the same."""


@dataclass(frozen=True)
class KnownCurve:
    """A curve of symmetric orbits as functions of a place on it, a number.

    Attributes:
        size: n, the number of stability parameters.
        begin, end: its first and its last place.
        place: of s on a piece with this id.
        coordinates: those of Fix(R); shape (1 + n, ..).
        minors: a_1, .., a_n.
        first_factor: zero where a vector of Fix(R) across the curve goes to one along it after half an orbit.
        level, half_period: as in the list.
        symmetric: the places of symmetric points, at its ends.
        turn: of a loop: the place begin + turn is `begin` again; else 0.
        across: V_11, V_12, V_21, V_22 of variations out of the plane of motion.
        jacobi_constant: of planar orbits, as in the list of variations out of the plane.
        distances: the least and the greatest over an orbit, and at its two points on Fix(R), this one first;
            shape (4, ..).
        grid_size: zeros are looked for between so many places.
    """

    size: int
    begin: float
    end: float
    place: Callable[[str, float], float]
    coordinates: Value
    minors: Value
    first_factor: Value
    level: Value
    half_period: Value
    symmetric: tuple[float, ...] = ()
    turn: float = 0.0
    across: Value | None = None
    jacobi_constant: Value | None = None
    distances: Value | None = None
    grid_size: int = 2401

    @cached_property
    def grid(self) -> Any:
        """Places from end to end."""
        return np.linspace(self.begin, self.end, self.grid_size)

    def zeros(self, function: Value, inside: bool = False) -> list[float]:
        """Places at which a function changes its sign; `inside`: without the symmetric points, where it may vanish."""
        grid = self.grid[1:-1] if inside and self.symmetric else self.grid
        values = function(grid)
        changes = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0)
        return [float(brentq(lambda p: float(function(p)), grid[i], grid[i + 1], xtol=1e-13)) for i in changes]

    def is_zero(self, function: Value, place: float) -> bool:
        """Whether a function changes its sign at a place."""
        values = function(place + np.linspace(-1e-4, 1e-4, 9))
        return bool(values[1] * values[-2] < 0)


@dataclass(frozen=True)
class Expected:
    """A point of the curve: `k`, `j`, `kind` as in the list, and where it is."""

    k: int
    j: int
    kind: str
    place: float


def resonances(order: int) -> Iterator[tuple[int, int]]:
    """All (k, j) with k <= order, each value of cos(2 pi j/k) once."""
    return ((k, j) for k in range(1, order + 1) for j in range(k // 2 + 1) if gcd(j, k) == 1)


@dataclass(frozen=True)
class Truth:
    """All that a list up to an order has to say of a curve."""

    curve: KnownCurve
    order: int

    @cached_property
    def points(self) -> list[Expected]:
        """Resonances, folds, losses of R, doublings and Krein collisions."""
        curve = self.curve
        found = [
            Expected(k, j, self._kind(k, place), place)
            for k, j in resonances(self.order)
            for place in curve.zeros(self._characteristic(cos(2 * pi * j / k)), k == 1)
        ]
        if curve.size == 2:
            found += [Expected(0, 0, "Krein collision", place) for place in curve.zeros(self._discriminant)]
        return found + [Expected(1, 0, "symmetric point", place) for place in curve.symmetric]

    @cached_property
    def across(self) -> Truth:
        """The same of variations out of the plane."""
        return TruthAcross(self.curve, self.order)

    def _kind(self, k: int, place: float) -> str:
        curve = self.curve
        if k == 1:
            is_fold = curve.is_zero(lambda p: np.gradient(curve.level(p), p), place)
            return "fold" if is_fold else "loss of R"
        if k == 2:
            is_here = curve.is_zero(curve.first_factor, place)
            return "singular at this point" if is_here else "singular at the other point"
        return "resonance"

    def _characteristic(self, c: float) -> Value:
        return lambda place: sum(
            (-1) ** k * a * c ** (self.curve.size - k) for k, a in enumerate([1.0, *self.curve.minors(place)])
        )

    def _discriminant(self, place: Any) -> Any:
        trace, determinant = self.curve.minors(place)
        return trace * trace - 4 * determinant

    @cached_property
    def extrema(self) -> list[tuple[float, float]]:
        """Places and values of stationary real stability parameters, symmetric points excepted, for n = 1 and n = 2.

        Those with values somewhat beyond the band of the list too.
        """
        grid = self.curve.grid[1:-1]
        found = []
        for branch in range(self.curve.size):

            def slope(place: Any, branch: int = branch) -> Any:
                here, before, after = (self.parameters(place + shift)[branch] for shift in (0, -1e-5, 1e-5))
                return (after - before) / 2e-5 + 0 * here

            values = slope(grid)
            with np.errstate(invalid="ignore"):
                changes = np.flatnonzero(values[1:] * values[:-1] < 0)
            for i in changes:
                place = float(brentq(lambda p: float(slope(p)), grid[i], grid[i + 1], xtol=1e-9))
                value = float(self.parameters(place)[branch])
                if abs(value) < 1.2:
                    found.append((place, value))
        return sorted(found)

    def parameters(self, place: Any) -> list[Any]:
        """The stability parameters in order, NaN where they are complex; n = 1 and n = 2."""
        found = list(self.curve.minors(place))
        if len(found) == 1:
            return found
        trace, determinant = found
        with np.errstate(invalid="ignore"):
            root = np.sqrt(trace * trace - 4 * determinant)
        return [(trace - root) / 2, (trace + root) / 2]

    @cached_property
    def asked(self) -> Any:
        """Places at which stability is compared."""
        return self.curve.grid[5:-5:7]

    @cached_property
    def is_stable(self) -> Any:
        """Whether all stability parameters are real, distinct and in (-1, 1) there."""
        with np.errstate(invalid="ignore"):
            values = self.parameters(self.asked)
            inside = np.all([np.abs(value) < 1 for value in values], axis=0)
            return inside & (values[0] != values[-1]) if len(values) > 1 else inside


_ENTRIES = {
    1: (("axial birth out of the plane", 1), ("birth out of the plane", 2)),
    2: (("minus one out of the plane", 0), ("minus one out of the plane", 3)),
}
"""Entries of V that vanish where the parameter across is 1 (k = 1) or -1."""


class TruthAcross(Truth):
    """The same of variations out of the plane of motion."""

    @cached_property
    def points(self) -> list[Expected]:
        """Resonances of the parameter across; where it is 1 or -1, the zeros of the entries of V one by one."""
        return [
            Expected(k, j, kind, place)
            for k, j in resonances(self.order)
            for kind, function in self._functions(k, j)
            for place in self.curve.zeros(function)
        ]

    def _functions(self, k: int, j: int) -> Iterator[tuple[str, Value]]:
        if k > 2:
            yield "resonance", lambda place: self.parameters(place)[0] - cos(2 * pi * j / k)
        for kind, entry in _ENTRIES.get(k, ()):
            yield kind, lambda place, entry=entry: self._entries(place)[entry]

    def _entries(self, place: Any) -> Any:
        assert self.curve.across is not None
        return self.curve.across(place)

    def parameters(self, place: Any) -> list[Any]:
        """Half the trace over the whole orbit: that of K V^-1 K V."""
        one, two, three, four = self._entries(place)
        return [one * four + two * three]


# What a list says


def misses(truth: Truth, found: Mapping[str, Any]) -> list[str]:
    """What is missing in the JSON object of a list, or false, in words."""
    wrong = [_wrong_points(truth, found), _wrong_extrema(truth, found), _wrong_stability(truth, found)]
    if truth.curve.across is not None:
        across = found["out_of_plane"]
        wrong += [_wrong_points(truth.across, across), _wrong_stability(truth.across, across)]
    return list(chain.from_iterable(wrong))


Interval = tuple[float, float]
"""Of places."""


def _interval(truth: Truth, entry: Mapping[str, Any]) -> Interval:
    """The places of a gap, or of an end of an interval of stability."""
    ends = sorted(truth.curve.place(entry["piece"], float(parse_exact(text))) for text in entry["interval"])
    return ends[0] - SAME, ends[1] + SAME


def _within(truth: Truth, interval: Interval, place: float) -> bool:
    """Whether a place is in an interval, on a loop up to whole turns."""
    turn = truth.curve.turn
    return any(interval[0] <= place + shift <= interval[1] for shift in {0.0, -turn, turn})


def _around(truth: Truth, entry: Mapping[str, Any]) -> Interval:
    """The places of a point that is listed."""
    s = ball_from_json(entry["s"])
    ends = sorted(truth.curve.place(entry["piece"], float(end)) for end in (s.lower(), s.upper()))
    return ends[0] - SAME, ends[1] + SAME


def encloses(entry: Mapping[str, str], value: float) -> bool:
    """Whether a ball contains a value that is known to about `SAME`."""
    return bool((ball_from_json(entry) + arb(0, SAME)).contains(arb(value)))


def _wrong_points(truth: Truth, found: Mapping[str, Any]) -> Iterator[str]:
    gaps = [(entry["about"], _interval(truth, entry)) for entry in found["gaps"]]
    left = list(truth.points)
    for point in found["points"]:
        what, around = (point["k"], point["j"], point["kind"]), _around(truth, point)
        here = [e for e in left if (e.k, e.j, e.kind) == what and _within(truth, around, e.place)]
        if len(here) != 1:
            yield f"false: k, j, kind = {what} in {around}"
            continue
        left.remove(here[0])
        place = here[0].place
        known = {"level": truth.curve.level(place), "half_period": truth.curve.half_period(place)}
        if "jacobi_constant" in point:
            assert truth.curve.jacobi_constant is not None
            known["jacobi_constant"] = truth.curve.jacobi_constant(place)
        said = {name: point[name] for name in known} | point["point"]
        known |= dict(zip(point["point"], truth.curve.coordinates(place), strict=True))
        for name, value in known.items():
            if not encloses(said[name], float(value)):
                yield f"false: {name} of {what} in {around}"
    for entry in left:
        subjects = ({"k": entry.k, "j": entry.j} if entry.k else entry.kind, "everything")
        if not any(_within(truth, around, entry.place) for about, around in gaps if about in subjects):
            yield f"missing: {entry}"


def _wrong_extrema(truth: Truth, found: Mapping[str, Any]) -> Iterator[str]:
    if truth.curve.size > 2:
        return
    gaps = [_interval(truth, entry) for entry in (*found["open_extrema"], *found["gaps"])]
    left = truth.extrema
    for entry in found["extrema"]:
        around = _around(truth, entry)
        here = [e for e in left if _within(truth, around, e[0]) and encloses(entry["value"], e[1])]
        if len(here) != 1:
            yield f"false: extremum in {around}"
        left = [e for e in left if e not in here]
    for place, value in left:
        if abs(value) < 1.1 - SAME and not any(_within(truth, around, place) for around in gaps):
            yield f"missing: extremum {value:.9f} at {place:.9f}"


def _wrong_stability(truth: Truth, found: Mapping[str, Any]) -> Iterator[str]:
    if truth.curve.size > 2:
        return
    grid = truth.asked
    said, open_ = np.zeros(len(grid), dtype=bool), np.zeros(len(grid), dtype=bool)
    for key, marks in (("stable", said), ("undecided", open_)):
        for entry in found[key]:
            begin, end = (_interval(truth, entry[name]) for name in ("from", "to"))
            marks |= _between(truth, begin[0], end[1])
            # Which side of a point an orbit within its enclosure is on is not known.
            open_ |= _between(truth, *begin) | _between(truth, *end)
            if key == "stable":
                yield from _wrong_ranges(truth.curve, entry, begin, end)
    for place in grid[(truth.is_stable != said) & ~open_]:
        yield f"false: stability at {place:.6f}"


_MANY = 33
"""Places at which half periods and distances are compared."""
_WHERE = ("this point", "the other point")


def _wrong_ranges(curve: KnownCurve, entry: Mapping[str, Any], begin: Interval, end: Interval) -> Iterator[str]:
    """Half periods and distances that are given of an interval of stability and of its ends."""
    last = end[1] + curve.turn * (end[1] < begin[0])
    for name, (low, high) in {"from": begin, "to": end, "between": (begin[0], last)}.items():
        if "half_period" not in entry[name]:
            continue
        places = np.linspace(low + SAME, high - SAME, _MANY)
        known = {"half_period": curve.half_period(places)}
        if curve.distances is not None:
            known["least_distance"], known["greatest_distance"], *ends = curve.distances(places)
        for what, values in known.items():
            ball = entry[name][what]
            if not all(encloses(ball, float(value)) for value in values):
                yield f"false: {what}, {name} {begin} to {end}"
            # A little more than what is true, for all of a part.
            if 2 * float(ball_from_json(ball).rad()) > 1.5 * np.ptp(values) + 0.03 * np.abs(values).max():
                yield f"wide: {what}, {name} {begin} to {end}"
            where = entry[name].get(f"{what}_at")
            if where in _WHERE and np.abs(values - ends[_WHERE.index(where)]).max() > SAME:
                yield f"false: {what} at {where}, {name} {begin} to {end}"


def _between(truth: Truth, low: float, high: float) -> Any:
    """Which of the places that are asked for; around the beginning of a loop if `low` is greater."""
    grid, turn = truth.asked, truth.curve.turn
    high += turn * (high < low)
    return np.any([(grid + shift > low) & (grid + shift < high) for shift in (0.0, -turn, turn)], axis=0)
