"""Pieces of a curve of periodic orbits in one section, for the verifier: over a parameter or the levels of an integral.

From one orbit the curve is followed both ways, piece after piece. On each piece the coordinates across the curve are
interpolated at Chebyshev nodes by orbits from Newton's method in float64; the direction of a piece is that of the
curve, so folds in the parameter are nothing special.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from orbitproof.explore.numerics import ALONG
from orbitproof.explore.periodic.correction import PeriodicFailure
from orbitproof.explore.periodic.equilibrium_search import FoundEquilibrium
from orbitproof.explore.periodic.flow import Matrix, Vector
from orbitproof.explore.periodic.rest_curve import RestCurve
from orbitproof.explore.periodic.search import FoundOrbit
from orbitproof.explore.periodic.section_curve import CurvePoint, NewtonCurve, SectionCurve
from orbitproof.shared.claims import EquilibriumAtlas, EquilibriumCurveClaim
from orbitproof.shared.formats import Covers, PeriodicAtlas, PeriodicCurveClaim, Piece

_NODES, _DEGREE = 24, 16
"""Orbits on a piece, and the degree from which on its coefficients are small."""
_SMALL, _TINY = 1e-11, 1e-15
"""So small are they, relative to the curve's scale; a piece whose coefficients fall faster might be wider."""
_OVERLAP = 0.1
_FIRST, _LEAST = 0.05, 1e-6
_WIDER, _NARROWER = 1.6, 0.6
_MARGIN = 50.0
"""A tube is so many times wider than the noise of its polynomial."""
_LEAST_CHANGES = 0.2, 0.01
_STRAIGHT = 0.8
"""Least cosine of the angle between neighbours."""
_INSIDE, _NEAR = 0.8, 1e-3
"""A curve is closed if it comes back to its first piece, not next to its ends, and so near in units of its width."""


@dataclass(frozen=True)
class CurveControl:
    """How a curve is covered.

    Attributes:
        tube: least half-width of the tubes, in units of the scale of each coordinate.
        most: number of pieces in each direction.
        widest: half-width of a piece, in units of the scales.
    """

    tube: float = 1e-10
    most: int = 200
    widest: float = inf


@dataclass(frozen=True)
class PieceInFloats:
    """A piece in float64.

    Attributes:
        centre: the orbit at s = 0.
        half_width: in units of the scales.
        series: shape (n, terms), Chebyshev coefficients of p_1, .., p_n in s, in the same units.
        frame: shape (1 + n, 1 + n), orthonormal in units of the scales; column 0 along the curve.
        ends: the orbits at s = -1 and 1.
        noise: of the coefficients.
    """

    centre: CurvePoint
    half_width: float
    series: Matrix
    frame: Matrix
    ends: tuple[CurvePoint, CurvePoint]
    noise: float


@dataclass(frozen=True)
class CoveredCurve:
    """The atlas of a curve.

    Attributes:
        ends: why it ends where it does, at its beginning and at its end; one line if it is closed.
        reaches: whether it is closed, or both ends lie beyond the interval that was asked for.
    """

    atlas: PeriodicAtlas
    ends: tuple[str, ...]
    reaches: bool


def cover_curve(
    found: FoundOrbit,
    name: str | None,
    bounds: tuple[float, float],
    identity: str,
    control: CurveControl | None = None,
    progress: Callable[[str], None] | None = None,
) -> CoveredCurve:
    """The curve of an orbit in a parameter (`None`: over the levels of the first integral), as pieces.

    Both ways it ends with the first piece that reaches beyond `bounds`, or where no further piece is found. Raises
    `PeriodicFailure` if there is none at all.
    """
    # Where a curve turns sharply in some units it may not in others.
    tried: list[CoveredCurve] = []
    failure = PeriodicFailure("no piece is found")
    for least in _LEAST_CHANGES[: 1 if name is None else None]:
        try:
            tried.append(_covered(found, name, bounds, identity, control or CurveControl(), progress, least))
        except PeriodicFailure as error:
            failure = error
    if not tried:
        raise failure
    whole = [each for each in tried if each.reaches]
    return min(whole, key=_number) if whole else max(tried, key=_number)


def _number(found: CoveredCurve) -> int:
    return len(found.atlas.pieces)


def _covered(
    found: FoundOrbit,
    name: str | None,
    bounds: tuple[float, float],
    identity: str,
    control: CurveControl,
    progress: Callable[[str], None] | None,
    least: float,
) -> CoveredCurve:
    """The pieces of `cover_curve`, with coordinates measured by at least `least` of the size of the orbit."""
    problem, section = found.problem, found.section
    system = problem.system
    place = None if name is None else list(system.parameters).index(name)
    others = [i for i in range(len(system.given_state)) if i != section.pivot]
    start, scales = found.orbit.point[others], np.full(len(others), found.orbit.size)
    if place is not None:
        start = np.append(problem.values[place], start)
        scales = np.append(bounds[1] - bounds[0], scales)
    if len(start) < 2:
        raise PeriodicFailure("the orbits of a curve have no coordinate across it; there is nothing to prove")
    level = found.level if place is not None else None
    curve = SectionCurve(problem, section, place, scales, None if level is None else float(level))
    if place is not None:
        # The curve shall not look straight where it turns: coordinates are measured by how much they change.
        scales[1:] *= min(max(_change(curve, start, found.orbit.period), least), 1.0)
        curve = replace(curve, scales=scales)
    tangent = curve.tangent(start, found.orbit.period)
    tangent = tangent / np.linalg.norm(tangent) * (-1.0 if tangent[0] < 0 else 1.0)
    first = curve.solved(start, found.orbit.period, tangent, start, 0.0)
    varies = name or system.first_integral_name or "the first integral"
    walk = _walked(curve, first, bounds, control, varies, progress)
    claim = PeriodicCurveClaim(
        "periodic-loop" if walk.is_closed else "periodic-arc", section.normal, section.offset, section.direction,
        found.crossings, name, level, (), walk.covers(name, bounds),
    )  # fmt: skip
    parameters = {key: exact for key, exact in problem.parameters.items() if key != name}
    title = f"Periodic orbits of the {system.title} along {varies}"
    atlas = PeriodicAtlas(identity, title, system, parameters, claim, walk.pieces(curve, control), {})
    return CoveredCurve(atlas, walk.ends, walk.reaches)


def cover_equilibria(
    found: FoundEquilibrium,
    name: str,
    bounds: tuple[float, float],
    identity: str,
    control: CurveControl | None = None,
    progress: Callable[[str], None] | None = None,
) -> CoveredCurve:
    """The curve of an equilibrium in a parameter as pieces, as `cover_curve` gives that of an orbit.

    Raises `PeriodicFailure` if there is no piece at all.
    """
    problem, system = found.problem, found.problem.system
    control, place = control or CurveControl(), list(system.parameters).index(name)
    start = np.append(problem.values[place], found.equilibrium.point)
    size = float(np.abs(found.equilibrium.point).max()) or 1.0
    scales = np.append(bounds[1] - bounds[0], np.full(len(start) - 1, size))
    curve = RestCurve(problem, place, scales)
    scales[1:] *= min(max(_change(curve, start, 0.0), _LEAST_CHANGES[0]), 1.0)
    curve = replace(curve, scales=scales)
    tangent = curve.tangent(start, 0.0)
    first = curve.solved(start, 0.0, tangent * (-1.0 if tangent[0] < 0 else 1.0), start, 0.0)
    walk = _walked(curve, first, bounds, control, name, progress)
    claim = EquilibriumCurveClaim(
        "equilibrium-loop" if walk.is_closed else "equilibrium-arc", name, (), walk.covers(name, bounds)
    )
    parameters = {key: exact for key, exact in problem.parameters.items() if key != name}
    title = f"Equilibria of the {system.title} along {name}"
    atlas = EquilibriumAtlas(identity, title, system, parameters, claim, walk.pieces(curve, control), {})
    return CoveredCurve(atlas, walk.ends, walk.reaches)


@dataclass(frozen=True)
class _Walk:
    """All pieces of a curve in float64, and why it ends, as `CoveredCurve` says."""

    charts: list[PieceInFloats]
    ends: tuple[str, ...]
    reaches: bool
    is_closed: bool

    def pieces(self, curve: NewtonCurve, control: CurveControl) -> tuple[Piece, ...]:
        return tuple(
            piece_of(curve, f"p{number:03d}", chart, control) for number, chart in enumerate(self.charts, start=1)
        )

    def covers(self, name: str | None, bounds: tuple[float, float]) -> Covers | None:
        if self.is_closed:
            return None
        return _covers(name, self.charts[0].ends[0], self.charts[-1].ends[1], bounds)


def _walked(
    curve: NewtonCurve,
    first: CurvePoint,
    bounds: tuple[float, float],
    control: CurveControl,
    varies: str,
    progress: Callable[[str], None] | None,
) -> _Walk:
    """The pieces of a curve both ways from a point of it. Raises `PeriodicFailure` if there is none."""
    middle = _first_chart(curve, first)
    trace = Trace(curve, bounds, control, middle, progress)
    ahead, reason = trace.pieces(middle.ends[1])
    if reason is None:
        return _Walk([middle, *ahead], (f"the curve is closed: {len(ahead) + 1} pieces",), True, True)
    behind, other = trace.pieces(replace(middle.ends[0], tangent=-middle.ends[0].tangent))
    charts = [*(turned(chart) for chart in reversed(behind)), middle, *ahead]
    values = [trace.value(charts[0].ends[0]), trace.value(charts[-1].ends[1])]
    ends = tuple(
        f"{varies} = {value:.10g}: {why}" for value, why in zip(values, (other or "", reason), strict=True)
    )  # fmt: skip
    return _Walk(charts, ends, not any(bounds[0] <= value <= bounds[1] for value in values), False)


def _change(curve: NewtonCurve, start: Vector, period: float) -> float:
    """How much the coordinates of the section change with the parameter, at an orbit and not far from it."""
    tangents = [curve.tangent(start, period)]
    for length in (sign * part * _FIRST for part in (1.0, 0.2) for sign in (1.0, -1.0)):
        with suppress(PeriodicFailure):
            guess = start + length * tangents[0] * curve.scales
            tangents.append(curve.solved(guess, period, tangents[0], start, length).tangent)
    return max(float(np.abs(each[1:]).max() / (abs(each[0]) or 1.0)) for each in tangents)


def _first_chart(curve: NewtonCurve, point: CurvePoint) -> PieceInFloats:
    width = _FIRST
    while True:
        try:
            return chart_about(curve, point, width)
        except PeriodicFailure:
            width *= _NARROWER
            if width < _LEAST:
                raise


@dataclass(frozen=True)
class Trace:
    """Piece after piece along a curve.

    Attributes:
        first: the piece from which it begins, both ways.
    """

    curve: NewtonCurve
    bounds: tuple[float, float]
    control: CurveControl
    first: PieceInFloats
    progress: Callable[[str], None] | None

    def value(self, point: CurvePoint) -> float:
        """The parameter, or the level."""
        if not isinstance(self.curve, SectionCurve) or self.curve.place is not None:
            return float(point.place[0])
        x, values = self.curve.state(point.place)
        return self.curve.problem.level(x, values) or 0.0

    def pieces(self, start: CurvePoint) -> tuple[list[PieceInFloats], str | None]:
        """Pieces from an end of the first one on, and why they end; `None` if they come back to the first."""
        found: list[PieceInFloats] = []
        end, width, low_high = start, min(self.first.half_width * _WIDER, self.control.widest), self.bounds
        while low_high[0] <= self.value(end) <= low_high[1]:
            if len(found) == self.control.most:
                return found, f"{self.control.most} pieces are the most that were asked for"
            why, chart = "", None
            while chart is None and width > _LEAST:
                try:
                    chart = self._next(end, width)
                except PeriodicFailure as failure:
                    why = str(failure)
                    width *= _NARROWER
            if chart is None:
                return found, f"no further piece: {why}"
            found.append(chart)
            if why := self.ends_with(chart):
                return found, why
            end = chart.ends[1]
            width = chart.half_width * (_WIDER if chart.series.shape[1] < _DEGREE - 4 else 1.0)
            width = min(width, self.control.widest)
            if self.progress is not None:
                self.progress(f"{len(found)} pieces, at {self.value(end):.8g}")
            if len(found) > 1 and self._is_back(end):
                return found, None
        return found, "beyond what was asked for"

    def ends_with(self, chart: PieceInFloats) -> str:
        """Why the curve ends with a piece; empty where it goes on."""
        return ""

    def _next(self, end: CurvePoint, width: float) -> PieceInFloats:
        """The piece that begins at the end of another one. Raises `PeriodicFailure`."""
        step = (1 - _OVERLAP) * width
        guess = end.place + step * end.tangent * self.curve.scales
        centre = self.curve.solved(guess, end.period, end.tangent, end.place, step)
        chart = chart_about(self.curve, centre, width)
        if chart.centre.tangent @ end.tangent < _STRAIGHT:
            raise PeriodicFailure("it turns too fast")
        return chart

    def _is_back(self, end: CurvePoint) -> bool:
        """Whether a point lies on the first piece."""
        first = self.first
        local = first.frame.T @ ((end.place - first.centre.place) / self.curve.scales)
        s = float(local[0]) / first.half_width
        return abs(s) < _INSIDE and bool(
            np.abs(local[1:] - chebyshev.chebval(s, first.series.T)).max() < _NEAR * first.half_width
        )


def chart_about(curve: NewtonCurve, centre: CurvePoint, half_width: float) -> PieceInFloats:
    """The piece about an orbit. Raises `PeriodicFailure` if it is too wide."""
    frame = _frame(centre.tangent)
    nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    across = np.zeros((_NODES, len(centre.place) - 1))
    periods = np.zeros(_NODES)
    error = centre.error
    # From the middle outwards, so that each orbit is near the one before.
    for sign in (1.0, -1.0):
        before = centre
        for index in sorted(np.flatnonzero(nodes * sign > 0), key=lambda i: float(abs(nodes[i]))):
            before = _at(curve, centre, before, frame, half_width * float(nodes[index]))
            local = frame.T @ ((before.place - centre.place) / curve.scales)
            across[index], periods[index] = local[1:], before.period
            error = max(error, before.error)
    series = np.atleast_2d(chebyshev.chebfit(nodes, across, _NODES - 1).T)
    tail = float(np.abs(series[:, _DEGREE:]).max())
    # A step that has converged is far longer than what is left.
    left = error if error > ALONG.tolerance else 0.0
    if tail > max(_SMALL, 20 * left):
        raise PeriodicFailure("the piece is too wide")
    ends = tuple(_at(curve, centre, centre, frame, sign * half_width, across, nodes, periods) for sign in (-1.0, 1.0))
    noise = max(tail, left, _TINY)
    large = np.flatnonzero(np.abs(series).max(axis=0) > noise)
    kept = series[:, : min(_DEGREE, int(large[-1]) if len(large) else 0) + 1]
    return PieceInFloats(centre, half_width, kept, frame, (ends[0], ends[1]), noise)


def _at(
    curve: NewtonCurve,
    centre: CurvePoint,
    near: CurvePoint,
    frame: Matrix,
    length: float,
    across: Matrix | None = None,
    nodes: Vector | None = None,
    periods: Vector | None = None,
) -> CurvePoint:
    """The orbit of a piece at p_0 = length, from one nearby or from those at all nodes."""
    here = float(centre.tangent @ ((near.place - centre.place) / curve.scales))
    step = (length - here) / float(centre.tangent @ near.tangent)
    guess, period = near.place + step * near.tangent * curve.scales, near.period
    if across is not None and nodes is not None and periods is not None:
        nearest = int(np.argmin(np.abs(nodes - np.sign(length))))
        local = np.concatenate([[length], across[nearest]])
        guess, period = centre.place + (frame @ local) * curve.scales, float(periods[nearest])
    return curve.solved(guess, period, centre.tangent, centre.place, length)


def _frame(tangent: Vector) -> Matrix:
    """Orthonormal, its first column the tangent."""
    columns = [tangent]
    size = len(tangent)
    while len(columns) < size:
        rest = np.eye(size) - sum(np.outer(column, column) for column in columns)
        chosen = rest[:, int(np.argmax(np.linalg.norm(rest, axis=0)))]
        columns.append(chosen / float(np.linalg.norm(chosen)))
    return np.column_stack(columns)


def turned(chart: PieceInFloats) -> PieceInFloats:
    """A piece run through backwards."""
    signs = np.where(np.arange(chart.series.shape[1]) % 2, -1.0, 1.0)
    frame = chart.frame.copy()
    frame[:, 0] = -frame[:, 0]
    return replace(chart, series=chart.series * signs, frame=frame, ends=(chart.ends[1], chart.ends[0]))


def piece_of(curve: NewtonCurve, name: str, chart: PieceInFloats, control: CurveControl) -> Piece:
    centre = tuple(Fraction(float(value)) for value in chart.centre.place)
    frame = tuple(
        tuple(Fraction(float(entry)) for entry in row) for row in chart.frame * curve.scales[:, None]
    )  # fmt: skip
    tube = Fraction(float(f"{max(control.tube, _MARGIN * chart.noise):.1e}"))
    rows = tuple(_powers(row) for row in chart.series)
    return Piece(
        name, "regular", centre, frame, Fraction(chart.half_width), rows, (tube,) * len(rows), "physical"
    )  # fmt: skip


def _powers(series: Sequence[float] | Any) -> tuple[Fraction, ...]:
    """Coefficients of 1, s, s^2, .. of a Chebyshev series, to 80 bits; sums of its small terms would lose them."""
    exact = [Fraction(float(value)) for value in series]
    before, now = [Fraction(1)], [Fraction(0), Fraction(1)]
    result = [Fraction(0)] * max(2, len(exact))
    for number, value in enumerate(exact):
        polynomial = before if number == 0 else now
        for power, coefficient in enumerate(polynomial):
            result[power] += value * coefficient
        if number > 0:
            doubled = [Fraction(0), *(2 * c for c in now)]
            before, now = now, [c - (before[i] if i < len(before) else 0) for i, c in enumerate(doubled)]
    unit = Fraction(1, 2**80)
    return tuple(round(value / unit) * unit for value in result)


def _covers(name: str | None, first: CurvePoint, last: CurvePoint, bounds: tuple[float, float]) -> Covers | None:
    """The range of the parameter, where the curve goes through all of it."""
    if name is None or not (first.place[0] < bounds[0] and bounds[1] < last.place[0]):
        return None
    return Covers(name, Fraction(str(bounds[0])), Fraction(str(bounds[1])))
