"""Pieces of the curve of orbits that are born at a Hopf point, from there on, for the verifier (section 38)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import log2

import numpy as np
from numpy.polynomial import chebyshev

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.atlas import CoveredCurve, CurveControl, PieceInFloats, Trace, chart_about, piece_of
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.equilibria import field_slopes
from orbitproof.explore.periodic.flow import Matrix, Vector, arc_of, velocity_at
from orbitproof.explore.periodic.hopf import Hopf
from orbitproof.explore.periodic.section_curve import CurvePoint, NewtonCurve
from orbitproof.shared.claims import BirthAtlas, BirthCurveClaim
from orbitproof.shared.systems import ParameterRange, System, blown_up

_FIRST, _LEAST, _NARROWER = 1.0, 2.0**-10, 0.5
"""Half-widths of the first piece that are tried, in units of the scale of the amplitude."""
_OF_SIZE = 0.1
"""That scale, in units of the size of the equilibrium."""
_ROUNDING = 1e-6
"""An equilibrium nearer to the origin tells nothing of the size of orbits."""
_SHRINKS = 1e-3
"""The curve ends where the amplitude grows so little, in units of the scales."""


@dataclass(frozen=True)
class BirthCurve(NewtonCurve):
    """The equations of a curve: f(c, a) = 0, and y comes back to itself under the field in units of the amplitude.

    Coordinates are a, the amplitude, c, and y but for its coordinates on the plane and at the amplitude.

    Attributes:
        place: of the parameter that varies, among all.
        scales: shape (2 N,), in which lengths are measured.
        section, amplitude: coordinates of the state, by their places.
    """

    problem: PeriodicProblem
    place: int
    scales: Vector
    section: int
    amplitude: int

    @cached_property
    def field(self) -> System:
        """The field in units of the amplitude; parameters: those of the system, the amplitude, c."""
        system = self.problem.system
        taken = {*system.state, *system.parameters}
        names = [next(f"{stem}{'_' * k}" for k in range(1, 99) if f"{stem}{'_' * k}" not in taken)
                 for stem in ("eps", *(f"c_{name}" for name in system.state))]  # fmt: skip
        free = dict.fromkeys(names, ParameterRange(None, None))
        return System(f"{system.name}-born", system.title, system.state, {**system.parameters, **free},
                      blown_up(system))  # fmt: skip

    @property
    def across(self) -> list[int]:
        """Places of the coordinates of y that are unknown."""
        return [i for i in range(len(self.problem.system.state)) if i not in (self.section, self.amplitude)]

    def linearised(self, place: Vector, period: float) -> tuple[Vector, Matrix]:
        """What is zero on the curve, and its derivatives by coordinates in units of their scales and log T."""
        system, n = self.problem.system, len(self.problem.system.state)
        values = self.problem.values
        values[self.place] = place[0]
        rest, y = place[2 : 2 + n], np.zeros(n)
        y[self.amplitude], y[self.across] = 1.0, place[2 + n :]
        arc = arc_of(self.field, y, period, np.concatenate([values, place[1 : 2 + n]]))
        slopes, count = field_slopes(system, rest, values), len(values)
        matrix = np.zeros((2 * n, 2 * n + 1))
        matrix[:n, 0], matrix[:n, 2 : 2 + n] = slopes[:, n + self.place], slopes[:, :n]
        matrix[n:, 0], matrix[n:, 1 : 2 + n] = arc.by_parameters[:, self.place], arc.by_parameters[:, count:]
        matrix[n:, 2 + n : -1] = (arc.by_state - np.eye(n))[:, self.across]
        matrix[n:, -1] = arc.velocity * period
        residual = np.concatenate([velocity_at(system, rest, values), arc.end - y])
        return residual, matrix * np.append(self.scales, 1.0)


def cover_birth(
    hopf: Hopf,
    bounds: tuple[float, float],
    identity: str,
    control: CurveControl | None = None,
    progress: Callable[[str], None] | None = None,
) -> CoveredCurve:
    """The curve of the orbits that are born at a Hopf point, as pieces from there on.

    It ends with the first piece that reaches beyond `bounds`, where the amplitude does not grow, or where no further
    piece is found. Raises `PeriodicFailure` if there is none at all.
    """
    problem, system, control = hopf.problem, hopf.problem.system, control or CurveControl()
    if system.defined:
        raise PeriodicFailure("a field with sin, cos, exp or log is not followed from the birth of its orbits")
    section = int(np.argmax(np.abs(hopf.vector)))
    # On the plane the vector is imaginary in its coordinate, and its real part is y.
    turned = hopf.vector * 1j / hopf.vector[section]
    turned[section] = 1j
    amplitude = int(np.argmax(np.abs(turned.real)))
    if abs(turned.real[amplitude]) < _SHRINKS:
        raise PeriodicFailure("the small orbits are nearly straight")
    y = turned / turned.real[amplitude]
    # The velocity over the plane is that of Re(i omega q).
    direction = 1 if -y[section].imag > 0 else -1
    place, n = list(system.parameters).index(hopf.name), len(system.state)
    size = float(np.abs(hopf.point).max())
    size = size if size > _ROUNDING else 1.0
    unit = 2.0 ** round(log2(_OF_SIZE * size))
    scales = np.concatenate([[bounds[1] - bounds[0], unit], np.full(n, size), np.ones(n - 2)])
    curve = BirthCurve(problem, place, scales, section, amplitude)
    start = np.concatenate([[hopf.value, 0.0], hopf.point, y.real[curve.across]])
    middle = _first(curve, start, hopf.period)
    trace = Trace(curve, bounds, control, middle, progress)
    ahead, reason = trace.pieces(middle.ends[1])
    charts = [middle, *ahead]
    for number, chart in enumerate(charts):
        if not _grows(chart.series, chart.frame, chart.half_width):
            charts, reason = charts[:number], "the amplitude does not grow any further"
            break
    if not charts:
        raise PeriodicFailure("the amplitude does not grow")
    state = system.state
    claim = BirthCurveClaim("birth-arc", state[section], direction, state[amplitude], hopf.name)  # type: ignore[arg-type]
    parameters = {key: exact for key, exact in problem.parameters.items() if key != hopf.name}
    title = f"Orbits of the {system.title} from their birth on along {hopf.name}"
    pieces = tuple(piece_of(curve, f"p{number:03d}", chart, control) for number, chart in enumerate(charts, start=1))
    last = trace.value(charts[-1].ends[1])
    ends = f"{hopf.name} = {hopf.value:.10g}: birth", f"{hopf.name} = {last:.10g}: {reason or 'it is closed'}"
    reaches = not bounds[0] <= last <= bounds[1]
    return CoveredCurve(BirthAtlas(identity, title, system, parameters, claim, pieces, {}), ends, reaches)


def _first(curve: BirthCurve, start: Vector, period: float) -> PieceInFloats:
    """The piece that begins at the equilibrium. Raises `PeriodicFailure` if none is narrow enough."""
    along = np.zeros(len(start))
    along[1] = 1.0
    width, failure = _FIRST, PeriodicFailure("")
    while width >= _LEAST:
        try:
            found = curve.solved(start + width * along * curve.scales, period, along, start, width)
            place = found.place.copy()
            # Exactly, so that the amplitude is 0 at s = -1.
            place[1] = width * curve.scales[1]
            return chart_about(curve, CurvePoint(place, found.period, along, found.error), width)
        except (PeriodicFailure, FlowFailure) as error:
            width, failure = width * _NARROWER, PeriodicFailure(str(error))
    raise failure


def _grows(series: Matrix, frame: Matrix, half_width: float) -> bool:
    """Whether the amplitude grows all along a piece."""
    places = np.linspace(-1.0, 1.0, 33)
    slopes = [chebyshev.chebval(places, chebyshev.chebder(row)) for row in series]
    along = frame[1, 0] * half_width + sum(
        factor * slope for factor, slope in zip(frame[1, 1:], slopes, strict=True)
    )  # fmt: skip
    return bool(np.all(along > _SHRINKS * half_width))
