"""Pieces of the curve of orbits that are born at a Hopf point, from there on, for the verifier (section 38)."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import factorial, log2

import numpy as np
from numpy.polynomial import chebyshev

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.atlas import (
    CoveredCurve,
    CurveControl,
    PieceInFloats,
    Trace,
    chart_about,
    piece_of,
    turned,
)
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.equilibria import field_slopes
from orbitproof.explore.periodic.flow import Matrix, Vector, arc_of, velocity_at
from orbitproof.explore.periodic.hopf import Hopf
from orbitproof.explore.periodic.section_curve import CurvePoint, NewtonCurve
from orbitproof.shared.claims import BirthAtlas, BirthCurveClaim
from orbitproof.shared.systems import ParameterRange, System, blown_up, blown_up_program, with_functions

_FIRST, _LEAST, _NARROWER = 1.0, 2.0**-10, 0.5
"""Half-widths of the first piece that are tried, in units of the scale of the amplitude."""
_OF_SIZE = 0.1
"""That scale, in units of the size of the equilibrium."""
_ROUNDING = 1e-6
"""An equilibrium nearer to the origin tells nothing of the size of orbits."""
_WITHIN, _TOWARDS, _MOST = 0.9, 0.3, 24
"""A last piece is entered so far inside; before it so many pieces, of so much of the amplitude, are tried at most."""
_SHIFT, _TERMS, _NEAR = 1e-30, 40, 0.1
_COMPLEX = {"sin": cmath.sin, "cos": cmath.cos, "exp": cmath.exp, "log": cmath.log}
_STRAIGHT = 1e-3
"""Small orbits across which the section cuts no more than so much are not followed."""
_NO_AMPLITUDE = 1e-3
"""The curve ends where the amplitude is so small again, in units of its scale."""


@dataclass(frozen=True)
class BirthCurve(NewtonCurve):
    """The equations of a curve: f(c, a) = 0, and y comes back to itself under the field in units of the amplitude.

    Coordinates are a, the amplitude, c, and y but for its coordinates on the plane and at the amplitude. What is
    integrated has further coordinates for the functions in the field, like the field in plain arithmetic.

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
        return [i for i in range(len(self.problem.system.given_state)) if i not in (self.section, self.amplitude)]

    def inputs(self, place: Vector) -> Vector:
        """Those of the field in units of the amplitude: y, all parameters, the amplitude, c; complex."""
        system, values = self.problem.system, self.problem.values.astype(complex)
        n, missing = len(system.given_state), [0j] * len(system.defined)
        values[self.place], amplitude, y = place[0], complex(place[1]), np.zeros(n, dtype=complex)
        y[self.amplitude], y[self.across] = 1.0, place[2 + n :]
        rest, found = with_functions(system, [*place[2 : 2 + n], *missing], values, _COMPLEX), list(y)
        for each, argument in zip(system.defined, system.argument_programs, strict=True):
            (before,) = argument.evaluate([*rest, *values])
            known = [*found, *missing[len(found) - n :], *values, amplitude, *rest]
            (slope,) = blown_up_program(argument, len(rest)).evaluate(known)
            found.append(slope * _mean_slope(each.function, before, amplitude * slope))
        return np.array([*found, *values, amplitude, *rest])

    def linearised(self, place: Vector, period: float) -> tuple[Vector, Matrix]:
        """What is zero on the curve, and its derivatives by coordinates in units of their scales and log T."""
        system, n, m = self.problem.system, len(self.problem.system.given_state), len(self.problem.system.state)
        values, rest = self.problem.values, place[2 : 2 + n]
        values[self.place] = place[0]
        inputs = self.inputs(place).real
        by_place = np.array([self.inputs(place + shift).imag / _SHIFT for shift in np.eye(2 * n) * 1j * _SHIFT]).T
        arc = arc_of(self.field, inputs[:m], period, inputs[m:])
        slopes, moved = field_slopes(system, rest, values), np.hstack([arc.by_state, arc.by_parameters]) @ by_place
        matrix = np.zeros((2 * n, 2 * n + 1))
        matrix[:n, 0], matrix[:n, 2 : 2 + n] = slopes[:, n + self.place], slopes[:, :n]
        matrix[n:, :-1], matrix[n:, -1] = (moved - by_place[:m])[:n], arc.velocity[:n] * period
        residual = np.concatenate([velocity_at(system, rest, values), (arc.end - inputs[:m])[:n]])
        return residual, matrix * np.append(self.scales, 1.0)


def cover_birth(
    hopf: Hopf,
    bounds: tuple[float, float],
    identity: str,
    control: CurveControl | None = None,
    progress: Callable[[str], None] | None = None,
) -> CoveredCurve:
    """The curve of the orbits that are born at a Hopf point, as pieces from there on.

    It ends with the first piece that reaches beyond `bounds`, at a second Hopf point, or where no further piece is
    found. Raises `PeriodicFailure` if there is none at all.
    """
    problem, system, control = hopf.problem, hopf.problem.system, control or CurveControl()
    section = int(np.argmax(np.abs(hopf.vector)))
    # On the plane the vector is imaginary in its coordinate, and its real part is y.
    at_plane = hopf.vector * 1j / hopf.vector[section]
    at_plane[section] = 1j
    amplitude = int(np.argmax(np.abs(at_plane.real)))
    if abs(at_plane.real[amplitude]) < _STRAIGHT:
        raise PeriodicFailure("the small orbits are nearly straight")
    y = at_plane / at_plane.real[amplitude]
    # The velocity over the plane is that of Re(i omega q).
    direction = 1 if -y[section].imag > 0 else -1
    place, n = list(system.parameters).index(hopf.name), len(system.given_state)
    size = float(np.abs(hopf.point).max())
    size = size if size > _ROUNDING else 1.0
    unit = 2.0 ** round(log2(_OF_SIZE * size))
    scales = np.concatenate([[bounds[1] - bounds[0], unit], np.full(n, size), np.ones(n - 2)])
    curve = BirthCurve(problem, place, scales, section, amplitude)
    start = np.concatenate([[hopf.value, 0.0], hopf.point, y.real[curve.across]])
    middle = _first(curve, start, hopf.period)
    trace = _FromBirth(curve, bounds, control, middle, progress)
    ahead, reason = trace.pieces(middle.ends[1])
    charts, kind = [middle, *ahead], "birth-arc"
    if ahead and trace.ends_with(ahead[-1]):
        charts.pop()
        try:
            charts += trace.to_rest(charts[-1].ends[1], ahead[-1])
            kind, reason = "birth-to-birth", "birth"
        except PeriodicFailure as failure:
            reason = f"{reason}, and no piece ends there: {failure}"
    state = system.given_state
    claim = BirthCurveClaim(kind, state[section], direction, state[amplitude], hopf.name)  # type: ignore[arg-type]
    parameters = {key: exact for key, exact in problem.parameters.items() if key != hopf.name}
    title = f"Orbits of the {system.title} from their birth on along {hopf.name}"
    pieces = tuple(piece_of(curve, f"p{number:03d}", chart, control) for number, chart in enumerate(charts, start=1))
    last = trace.value(charts[-1].ends[1])
    ends = f"{hopf.name} = {hopf.value:.10g}: birth", f"{hopf.name} = {last:.10g}: {reason}"
    reaches = kind == "birth-to-birth" or not bounds[0] <= last <= bounds[1]
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


class _FromBirth(Trace):
    """Piece after piece from a birth on, as long as there are orbits."""

    def ends_with(self, chart: PieceInFloats) -> str:
        """Why the curve ends before a piece."""
        places = np.linspace(-1.0, 1.0, 33)
        local = np.vstack([chart.half_width * places, *(chebyshev.chebval(places, row) for row in chart.series)])
        amplitudes = chart.centre.place[1] / self.curve.scales[1] + chart.frame[1] @ local
        return "" if amplitudes.min() > _NO_AMPLITUDE else "the amplitude is 0 again"

    def to_rest(self, end: CurvePoint, beyond: PieceInFloats) -> list[PieceInFloats]:
        """Pieces from a point on that end at the equilibrium near a piece. Raises `PeriodicFailure`."""
        near = min((*beyond.ends, beyond.centre), key=lambda point: abs(point.place[1]))
        along, origin = np.eye(len(near.place))[1], near.place.copy()
        origin[1] = 0.0
        rest = self.curve.solved(origin, near.period, along, origin, 0.0)
        last, found = turned(_first(self.curve, rest.place, rest.period)), list[PieceInFloats]()
        while (left := end.place[1] / self.curve.scales[1]) > _WITHIN * 2 * last.half_width:
            if len(found) == _MOST:
                raise PeriodicFailure(f"{_MOST} pieces do not come near it")
            found.append(self._next(end, _TOWARDS * left))
            end = found[-1].ends[1]
        return [*found, last]


def _mean_slope(function: str, at: complex, change: complex) -> complex:
    """(phi(e + d) - phi(e))/d, the derivative where d is 0, as in section 38.7."""
    half = change / 2
    middle, square = at + half, half * half
    if function == "log":
        ratio = half / middle
        near = abs(ratio) < _NEAR
        series = sum(ratio ** (2 * k) / (2 * k + 1) for k in range(_TERMS))
        return (series if near else cmath.atanh(ratio) / ratio) / middle
    sign, value = {"exp": (1, cmath.exp), "sin": (-1, cmath.cos), "cos": (-1, lambda u: -cmath.sin(u))}[function]
    return value(middle) * sum((sign * square) ** k / factorial(2 * k + 1) for k in range(_TERMS))
