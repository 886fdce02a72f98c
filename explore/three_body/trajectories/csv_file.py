"""Trajectories as CSV: what it is in lines that begin with #, then one row for each time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from orbitproof.explore.names import told_apart
from orbitproof.explore.three_body.trajectories.interpolation import DEGREE
from orbitproof.explore.three_body.trajectories.sampling import SampledOrbit
from orbitproof.explore.three_body.trajectories.trajectory import Trajectory
from orbitproof.shared.formats import write_text
from orbitproof.shared.numbers import format_rational
from orbitproof.shared.systems import THREE_BODY, ReversibleSystem

NUMERICAL = "computed in double precision; nothing about these states is proved"


def write_csv(path: Path, samples: SampledOrbit) -> None:
    """Write the file, whole or not at all. Raises `InputError`."""
    write_table(path, description(samples), _columns(samples), np.column_stack([samples.times, samples.states]))


def write_table(path: Path, head: Sequence[str], columns: Sequence[str], rows: np.ndarray) -> None:
    """Write rows of numbers with what they are, whole or not at all."""
    lines = [f"# {line}" for line in head]
    lines.append(",".join(columns))
    lines += [",".join(f"{value:.17g}" for value in row) for row in rows.tolist()]
    write_text(path, "\n".join(lines) + "\n")


IN_KM = ("t (s)", "x (km)", "y (km)", "z (km)", "vx (km/s)", "vy (km/s)", "vz (km/s)")


def description(samples: SampledOrbit) -> list[str]:
    """What a trajectory is, as lines of text that stand in every file of it."""
    trajectory, units = samples.trajectory, samples.units
    lines = about(trajectory)
    if trajectory.source.system in THREE_BODY:
        lines.insert(4, f"frame: {samples.frame.described(trajectory.source.primaries or BODIES)}")
    if units is not None:
        lines.append(f"unit of length: {units.length:.15g} km, unit of time: {units.time:.15g} s, {units.source}")
    if samples.error is not None:
        unit = "(nondimensional)" if units is None else "km"
        lines.append(
            f"{len(samples.times)} states; interpolated with degree {DEGREE} (Hermite, any four neighbouring states) "
            f"the places are off by at most {samples.error:.1e} {unit}"
        )
    return lines


BODIES = ("larger primary", "smaller primary")


def about(trajectory: Trajectory) -> list[str]:
    """What an orbit is, as lines of text."""
    source, system = trajectory.source, trajectory.source.system
    lines = [
        f"{source.title}; {system.title}",
        NUMERICAL,
        source.verdict,
        *(f"{name} = {format_rational(value)} = {float(value):.17g}" for name, value in source.parameters.items()),
    ]
    lines += [
        f"{name} = {value:.17g}" for name, value in trajectory.parameters.items() if name not in source.parameters
    ]
    if source.distance is None:
        lines.append(f"period: {trajectory.period:.15g} (nondimensional)")
    else:
        lines += [
            "not periodic: a homoclinic orbit, from near its periodic orbit on the unstable manifold to Fix(R), and, "
            "mirrored by R, back to it on the stable one",
            f"time between its ends: {trajectory.period:.15g} (nondimensional)",
            f"a at its ends, where the periodic orbit has a = 0: {source.distance:.6g} (nondimensional)",
        ]
    if trajectory.first_integral is not None:
        lines.append(f"{system.first_integral_name}: {trajectory.first_integral:.15g} (nondimensional)")
    if trajectory.multipliers is not None:
        lines += [
            f"multipliers without the trivial pair: {', '.join(map(complex_text, trajectory.multipliers))}",
            f"stability index: {trajectory.stability_index:.10g}",
        ]
    mirrored = trajectory.solution.mirrored and isinstance(system, ReversibleSystem)
    what = "distance from Fix(R) after half a period" if mirrored else "gap after a period"
    if source.distance is not None:
        what = "distance from Fix(R) in the middle, and gaps on the way"
    lines.append(f"{what}: {trajectory.defect:.1e} (nondimensional)")
    if trajectory.drift is not None:
        lines.append(f"largest change of the {system.first_integral_name}: {trajectory.drift:.1e} (nondimensional)")
    if trajectory.moved:
        lines.append(f"what the file says was corrected by {trajectory.moved:.1e} (nondimensional)")
    return lines


def complex_text(value: complex) -> str:
    """A multiplier to ten digits, without an imaginary part that is zero."""
    return f"{value.real:.10g}" if value.imag == 0 else f"{value.real:.10g}{value.imag:+.10g}i"


def _columns(samples: SampledOrbit) -> Sequence[str]:
    names = samples.trajectory.source.system.state
    if samples.trajectory.source.system not in THREE_BODY:
        return (*told_apart("t", names), *names)
    length, time, velocity = ("LU", "TU", "LU/TU") if samples.units is None else ("km", "s", "km/s")
    labels = [f"{name} ({unit})" for name, unit in zip(names, [length] * 3 + [velocity] * 3, strict=True)]
    return (f"t ({time})", *labels)
