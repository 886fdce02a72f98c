"""Covering a curve by pieces, each as wide as the decay of its Taylor coefficients allows.

The rule for the width: coefficient number `degree` of the half return's flow in s, relative to its first, falls to
`decay`. It is read off the coefficients themselves (`Expansion.best_half_width`), first in a chart of a fraction of the
expected width and then in the chart itself. Of physical and regularised coordinates those are taken in which a unit of
length costs fewer multiplications.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from orbitproof.explore.atlases.complex_flow import Coordinates, HalfReturns
from orbitproof.explore.atlases.curve import Curve, FamilyPoint, coordinate_time
from orbitproof.explore.atlases.expansion import Chart, Expansion, ExpansionFailure, expand
from orbitproof.explore.engines import Progress
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.shared.systems import REGULARISATIONS
from orbitproof.shared.wording import counted

STAGE, STAGES = 0.2, 4
"""A chart is first tried with this part of its width, and less if Newton's method does not converge there."""

WIDER, NARROWER = 1.1, 0.8
STRETCHED = 1.12
"""A last piece may be so much wider than its first half, if that saves another one."""

ATTEMPTS = 12

FAR = 2.0
"""A chart is not tried at once if it goes beyond so many best half-widths of the one before."""

MUCH_DEARER, REST = 2.5, 4
"""Coordinates in which a unit of length costs so many times more are not tried again for some pieces."""


GROWTH = 2.0
"""Physical coordinates count as so many times dearer: a verifier's error bounds grow with each of their many steps."""


class CoverFailure(Exception):
    """The curve cannot be covered; one line says where and why."""


@dataclass(frozen=True)
class CoverControl:
    """How pieces are chosen.

    Attributes:
        degree, decay: coefficient `degree` of the flow falls to `decay`.
        overlap: part of a half-width by which neighbours overlap.
        smallest: half-width, relative to the curve's `scale`, below which covering is given up.
    """

    degree: int = 28
    decay: float = 1e-13
    overlap: float = 0.08
    smallest: float = 1e-7


@dataclass
class Coverer:
    """Covers one curve.

    Attributes:
        curve: what is covered.
        coordinates: in which the orbits are followed; `None`: whatever is cheaper.
        failure: why the pieces end before the curve does, if they do.
    """

    curve: Curve
    control: CoverControl
    coordinates: Coordinates | None = None
    failure: str | None = None
    _times: dict[Coordinates, float] = field(default_factory=dict)
    _resting: dict[Coordinates, int] = field(default_factory=dict)
    _returns: dict[Coordinates, HalfReturns] = field(default_factory=dict)

    def __post_init__(self) -> None:
        problem = self.curve.family.problem
        names: tuple[Coordinates, ...] = ("physical",)
        if problem.system.name in REGULARISATIONS:
            names = ("regularised", "physical")
        for name in names if self.coordinates is None else (self.coordinates,):
            self._returns[name] = HalfReturns(problem.system, problem.parameters, name)
            self._times[name] = 1.0

    def expansion(
        self, chart: Chart, half_period: float, *, even: bool = False, before: Expansion | None = None
    ) -> Expansion:
        """The curve in a chart, in the cheapest coordinates. Raises `ExpansionFailure`.

        With the result for a chart nearby, `before`, its coordinates are taken, and Newton's method begins with it.
        The result has a narrower chart if the coefficients in that one show that the other is much too wide.
        """
        result = None
        if before is not None and before.reach(chart) < FAR * self.best(before):
            with suppress(ExpansionFailure):
                result = expand(before.returns, chart, before.times[0], guess=before.predicted(chart), even=even)
        if result is None:
            result = self._staged(chart, half_period, even, before and before.returns.coordinates)
        self._times[result.returns.coordinates] = float(result.times[0])
        return result

    def _staged(self, chart: Chart, half_period: float, even: bool, only: Coordinates | None) -> Expansion:
        """The curve in a chart, first in narrower ones."""
        found: list[tuple[float, Expansion]] = []
        failures = []
        for name in self._candidates(only):
            try:
                small = self._first_stage(chart, half_period, even, name, 1 if found else STAGES)
            except (ExpansionFailure, FlowFailure) as error:
                failures.append(str(error))
                self._resting[name] = REST if found else 0
                continue
            cost = small.steps * small.returns.products / self.best(small)
            found.append((cost if name == "regularised" else cost * GROWTH, small))
        if not found:
            raise ExpansionFailure(failures[0])
        cost, small = min(found, key=lambda entry: entry[0])
        for other, loser in found:
            if other > MUCH_DEARER * cost:
                self._resting[loser.returns.coordinates] = REST
        while small.chart.half_width < chart.half_width:
            if self.best(small) < min(0.5 * chart.half_width, 2 * small.chart.half_width):
                return small
            wider = replace(chart, half_width=min(chart.half_width, small.chart.half_width / STAGE))
            small = expand(small.returns, wider, small.times[0], guess=small.predicted(wider), even=even)
        return small

    def _candidates(self, only: Coordinates | None) -> list[Coordinates]:
        """The coordinates worth a try: coordinates that were much dearer on the last pieces rest for a while."""
        if only is not None:
            return [only]
        for name, rest in self._resting.items():
            self._resting[name] = max(rest - 1, 0)
        return [name for name in self._returns if not self._resting.get(name)]

    def _first_stage(self, chart: Chart, half_period: float, even: bool, name: Coordinates, stages: int) -> Expansion:
        """In a chart so narrow that its axis is a sufficient first approximation of the curve."""
        returns = self._returns[name]
        time = self._times[name] = coordinate_time(returns, chart.centre, half_period, self._times[name])
        width = STAGE * chart.half_width
        for _ in range(stages):
            try:
                return expand(returns, replace(chart, half_width=width), time, even=even)
            except ExpansionFailure as error:
                failure = error
                width *= STAGE
        raise failure

    def best(self, expansion: Expansion) -> float:
        """The best half-width of a piece there, by what the coefficients of an expansion say."""
        return expansion.best_half_width(self.control.degree, self.control.decay)

    def symmetric(self, point: FamilyPoint, direction: Vector, across: Matrix) -> Expansion:
        """The piece about a point where the curve meets Fix(S), along `direction`. Raises `CoverFailure`."""
        scale = self.curve.scale(point.point)
        chart = Chart(point.point, np.column_stack([direction, across]), 0.02 * scale, scale)
        result = None
        for _ in range(ATTEMPTS):
            try:
                result = self.expansion(chart, point.half_period, even=True, before=result)
            except ExpansionFailure:
                chart = replace(chart, half_width=0.4 * chart.half_width)
                continue
            best = self.best(result)
            if result.chart.half_width == chart.half_width and NARROWER * best <= chart.half_width <= WIDER * best:
                return result
            chart = replace(chart, half_width=best)
        raise CoverFailure(f"no piece about the symmetric point {self._text(point.point)}")

    def pieces(
        self,
        start: Vector,
        start_place: float,
        end: Vector,
        end_place: float,
        width: float,
        progress: Progress | None = None,
    ) -> list[Expansion]:
        """Pieces from the point `start` to the point `end`, both on the curve; `width` is a first guess.

        `start_place` and `end_place` are their arclengths on the family, roughly. Where no further piece is found,
        those so far, and `failure` says why. Raises `CoverFailure` if there is none.
        """
        result: list[Expansion] = []
        left, place = start, start_place
        while True:
            try:
                piece, centre, last = self._next(left, place, end, end_place, width)
            except CoverFailure as error:
                if not result:
                    raise
                self.failure = str(error)
                return result
            result.append(piece)
            if progress is not None:
                progress(counted(len(result), "piece"), (centre - start_place) / (end_place - start_place))
            if last:
                return result
            s = 1.0 - self.control.overlap
            left, width = piece.point(s), piece.chart.half_width
            place = centre + (centre - place) * s
            place = self._place_of(piece.chart, centre, place, s)

    def _place_of(self, chart: Chart, centre: float, guess: float, s: float) -> float:
        """The family's arclength at which p_0 in `chart` is s half-widths."""
        target = s * chart.half_width
        before, value_before = centre, 0.0
        last = self.curve.family.arclengths[-1]
        place = min(guess, last)
        for _ in range(8):
            value = float(chart.local(self.curve.at(place).point)[0])
            if abs(value - target) < 1e-3 * chart.half_width or value == value_before:
                break
            new = place + (target - value) * (place - before) / (value - value_before)
            before, value_before, place = place, value, min(max(new, centre), last)
        return place

    def _next(
        self, left: Vector, place: float, end: Vector, end_place: float, width: float
    ) -> tuple[Expansion, float, bool]:
        """The next piece from `left`, the place of its centre and whether it reaches `end`."""
        curve, control = self.curve, self.control
        here, piece = curve.at(place), None
        for attempt in range(ATTEMPTS):
            scale = curve.scale(here.point)
            if width < control.smallest * scale:
                break
            centre, chart = self._chart(left, here, width)
            reach = float(chart.local(end)[0])
            # The curve may turn back: only what is near along the curve is in the chart.
            near = end_place < centre.place + 2 * (centre.place - here.place)
            last = near and reach <= STRETCHED * chart.half_width
            if last and reach < 0.9 * chart.half_width:
                # The piece would go beyond the end: put it in the middle.
                width = max(0.5 * (chart.half_width + reach), 0.1 * chart.half_width)
                continue
            if last:
                chart = replace(chart, half_width=max(chart.half_width, reach))
            try:
                piece = self.expansion(chart, centre.half_period, before=piece)
            except ExpansionFailure:
                width *= 0.4
                continue
            best = self.best(piece)
            wide = chart.half_width <= WIDER * best and piece.chart.half_width == chart.half_width
            if wide and (last or attempt > ATTEMPTS // 2 or chart.half_width >= NARROWER * best):
                return piece, centre.place, last
            width = 0.97 * best
        raise CoverFailure(f"no piece beyond {self._text(left)}")

    def _text(self, point: Vector) -> str:
        names = self.curve.family.problem.system.centre_coordinates
        return ", ".join(f"{name} = {value:.8g}" for name, value in zip(names, point, strict=True))

    def _chart(self, left: Vector, here: FamilyPoint, width: float) -> tuple[FamilyPoint, Chart]:
        """The chart whose left end, s = -1, is `left`, about `width` wide."""
        curve = self.curve
        limit = curve.family.arclengths[-1]
        speed = abs(here.tangent[0]) if curve.graph else float(np.linalg.norm(here.tangent))
        place = here.place + width / speed
        for _ in range(4):
            try:
                centre = curve.at(min(place, limit))
            except CorrectionFailure as error:
                raise CoverFailure(f"the family is lost beyond {self._text(left)}: {error}") from None
            chart = Chart(centre.point, curve.frame(centre.tangent), width, curve.scale(centre.point))
            found = -float(chart.local(left)[0])
            chart = replace(chart, half_width=found)
            if place >= limit or 0.97 * width < found < 1.03 * width:
                break
            place = here.place + (place - here.place) * (width / found if found > 0.1 * width else 0.5)
        return centre, chart
