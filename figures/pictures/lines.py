"""Orbits as lines in space, with what is known of each: of families, proved curves, catalogues, single files, tubes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from html import escape
from typing import Any

import numpy as np

from orbitproof.explore.flow import flow_batch
from orbitproof.explore.orbits import correct_batch, stability_index
from orbitproof.explore.three_body.catalogues import Catalogue
from orbitproof.explore.three_body.catalogues.distances import PARTS, distances_from_primaries
from orbitproof.explore.three_body.invariants import ManifoldRecord
from orbitproof.explore.three_body.trajectories import Trajectory
from orbitproof.figures.certified import Curve, heading_of
from orbitproof.figures.model import MarkedPoint, SampledFamily, level_of
from orbitproof.figures.orbits import Array, OrbitNotClosed, symmetric_orbit
from orbitproof.shared.systems import CR3BP, UNITS, ReversibleSystem, shown

SHOWN = 60
"""Orbits of a family, loop or catalogue that are drawn, at most."""

NUMERICAL = "numerical, not proved"

_TIMES = 600
"""Places of a single orbit."""


@dataclass(frozen=True)
class Line:
    """An orbit in space.

    Attributes:
        places: shape (N, 3).
        proved: what a certificate says of it.
        label: what the mouse shows.
        level: its Jacobi constant, or NaN.
    """

    places: Array
    proved: bool
    label: str
    level: float


def family_lines(family: SampledFamily, marks: Sequence[MarkedPoint]) -> list[Line]:
    """Orbits along a traced family, and those of its marked points with their verdicts."""
    drawn: list[tuple[Array, str, str, float, float, Any, int]] = []
    for index in _chosen(len(family.arclength)):
        rows = _orbit(family.system, family.parameters, family.points[index])
        if rows is not None:
            title = f"orbit {index + 1} of {escape(family.title)}"
            stability = np.roots(family.coefficients[index])
            drawn.append((rows, title, NUMERICAL, family.levels[index], family.periods[index], stability, 8))
    # Between the orbits of the file by cubic interpolation: good to five digits.
    fine = family.refined() if marks else family
    verdicts = [False] * len(drawn)
    for mark in marks:
        rows = _orbit(family.system, family.parameters, mark.point)
        if rows is None:
            continue
        place = fine.place(mark).arclength
        period = float(np.interp(place, fine.arclength, fine.periods))
        row = [np.interp(place, fine.arclength, column) for column in fine.coefficients.T]
        said = f"k = {mark.k}: the certificate says proved" if mark.certified else f"k = {mark.k}: {NUMERICAL}"
        drawn.append((rows, escape(shown(mark.candidate.id)), said, mark.level, period, np.roots(row), 5))
        verdicts.append(mark.certified)
    near = _nearest([each[0][0] for each in drawn], [each[4] for each in drawn], family.parameters["mu"])
    return [
        Line(
            rows[:, :3], proved, "<br>".join([title, facts(level, period, stability, digits), *said_of, verdict]), level
        )
        for (rows, title, verdict, level, period, stability, digits), proved, said_of in zip(
            drawn, verdicts, near, strict=True
        )
    ]  # fmt: skip


def curve_lines(curve: Curve) -> list[Line]:
    """Orbits along a curve from its certificate; each has the verdict of its piece."""
    points = np.concatenate([stretch.points for stretch in curve.stretches])
    proved = np.concatenate([[stretch.is_proved] * len(stretch.points) for stretch in curve.stretches])
    rows = [(index, _orbit(curve.system, curve.parameters, points[index])) for index in _chosen(len(points))]
    kept = [(index, places) for index, places in rows if places is not None]
    halves = [0.5 * _period(places) for _, places in kept]
    values = {name: float(value) for name, value in curve.parameters.items()}
    starts = np.column_stack([points[[index for index, _ in kept]], halves])
    # Many at once are corrected with a free level only.
    batch = None if curve.system.fixed_level else correct_batch(curve.system, values, starts, symmetry=None)
    near = _nearest([places[0] for _, places in kept], 2 * np.array(halves), curve.parameters["mu"])
    lines = []
    for number, (index, places) in enumerate(kept):
        level = level_of(curve.system, curve.parameters, list(points[index]))
        if batch is not None and batch.converged[number]:
            known = facts(level, 2 * float(batch.unknowns[number, -1]), batch.stability[number])
        else:
            known = facts(level, float("nan"), [])
        verdict = "on a piece that the certificate says is proved" if proved[index] else "on a piece that is not proved"
        label = "<br>".join([escape(heading_of(curve.atlas)), known, *near[number], verdict])
        lines.append(Line(places[:, :3], bool(proved[index]), label, level))
    return lines


def catalogue_lines(catalogue: Catalogue) -> list[Line]:
    """Orbits of a catalogue, as its rows say."""
    part = catalogue.chosen(_chosen(len(catalogue)))
    near = _nearest(list(part.states), part.periods, part.mass_ratio)
    # Orbit after orbit from place to place, all of them at once.
    places = [part.states]
    values, steps = np.full((len(part), 1), float(part.mass_ratio)), part.periods / _TIMES
    for _ in range(_TIMES):
        places.append(flow_batch(CR3BP, places[-1], steps, values).states)
    rows = np.array(places)[:, :, :3]
    lines = []
    for index, number in enumerate(part.numbers or ()):
        level = float(part.jacobi_constants[index])
        label = "<br>".join([
            f"row {number} of {escape(part.title)}", f"Jacobi constant {level:.10g}",
            f"period {part.periods[index]:.8g}", f"stability index {part.stability_indices[index]:.6g}", *near[index],
            NUMERICAL,
        ])  # fmt: skip
        lines.append(Line(rows[:, index], False, label, level))
    return lines


def orbit_line(trajectory: Trajectory) -> Line:
    """A single orbit of a file, over its period."""
    source, level = trajectory.source, trajectory.first_integral
    states = trajectory.states(np.linspace(0.0, trajectory.period, _TIMES))
    (near,) = _nearest([states[0]], [trajectory.period], Fraction(source.parameters["mu"]))
    stability = () if trajectory.stability is None else trajectory.stability
    known = facts(float("nan") if level is None else level, trajectory.period, stability)
    label = "<br>".join([escape(source.title), known, *near, escape(source.verdict)])
    return Line(states[:, :3], False, label, float("nan") if level is None else level)


def tube_lines(record: ManifoldRecord) -> tuple[Line, list[Line]]:
    """The periodic orbit of a tube, and the orbits that make it up."""
    tube, level = record.manifold, record.jacobi_constant
    centre = f"{escape(record.title)}<br>Jacobi constant {level:.10g}<br>{NUMERICAL}"
    lines = []
    for number, (path, time, end) in enumerate(zip(tube.paths, tube.times, tube.ends, strict=True), start=1):
        reached = "does not reach the plane" if np.isnan(time) else f"at the plane after {abs(time):.6g}, {_state(end)}"
        label = f"{tube.kind} manifold, orbit {number} of {len(tube.paths)}<br>{reached}<br>{NUMERICAL}"
        lines.append(Line(path, False, label, level))
    return Line(record.orbit, False, centre, level), lines


def facts(level: float, period: float, stability: Any, digits: int = 8) -> str:
    """What is known of an orbit, in lines for the mouse."""
    index = f"{stability_index(stability):.{min(digits, 6)}g}" if len(stability) else "unknown"
    time = f"{period:.{digits}g}" if np.isfinite(period) else "unknown"
    constant = f"{level:.10g}" if np.isfinite(level) else "unknown"
    return f"Jacobi constant {constant}<br>period {time}<br>stability index {index}"


def _nearest(starts: Sequence[Array], periods: Sequence[float] | Array, mass: Fraction) -> list[list[str]]:
    """The least distance of each orbit from the smaller primary, in km too where the units are known."""
    whole = np.array([start if len(start) == 6 else [start[0], start[1], 0, start[2], start[3], 0] for start in starts])
    times = np.array(periods, dtype=float)
    least = np.full(len(whole), np.nan)
    known = np.isfinite(times) & (times > 0)
    if known.any():
        least[known] = distances_from_primaries(whole[known], times[known], float(mass), 4 * PARTS).least
    units = UNITS.get(mass)
    found = []
    for value in least:
        if np.isnan(value):
            found.append([])
            continue
        said = f"least distance from the smaller primary {value:.6g}"
        if units is not None:
            altitude = value * units.length - units.radius
            word = f"altitude {altitude:,.0f} km" if altitude >= 0 else "the orbit hits it"
            said += f" ({value * units.length:,.0f} km, {word})"
        found.append([said])
    return found


def _state(state: Array) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in zip(CR3BP.state, state, strict=True))


def _chosen(count: int) -> Any:
    return np.unique(np.linspace(0, count - 1, SHOWN).round().astype(int))


def _orbit(system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Array) -> Array | None:
    try:
        return symmetric_orbit(system, parameters, list(point))
    except OrbitNotClosed:
        return None


def _period(rows: Array) -> float:
    """About the period: the length of the orbit over its speed, a guess that is corrected."""
    speeds = np.linalg.norm(rows[:, 3:], axis=1)
    return float(np.sum(2 * np.linalg.norm(np.diff(rows[:, :3], axis=0), axis=1) / (speeds[1:] + speeds[:-1])))
