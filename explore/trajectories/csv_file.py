"""Trajectories as CSV: what it is in lines that begin with #, then one row for each time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from orbitproof.explore.trajectories.trajectory import Trajectory
from orbitproof.explore.trajectories.units import Units
from orbitproof.shared.formats import write_text
from orbitproof.shared.numbers import format_rational
from orbitproof.shared.systems import THREE_BODY


def write_csv(path: Path, trajectory: Trajectory, units: Units | None) -> None:
    """Write the file, whole or not at all; `units` `None`: nondimensional. Raises `InputError`."""
    names, scales = _columns(trajectory, units)
    rows = np.column_stack([trajectory.times, trajectory.states]) * scales
    lines = [f"# {line}" for line in description(trajectory, units)]
    lines.append(",".join(names))
    lines += [",".join(f"{value:.17g}" for value in row) for row in rows.tolist()]
    write_text(path, "\n".join(lines) + "\n")


def description(trajectory: Trajectory, units: Units | None) -> list[str]:
    """What a trajectory is, as lines of text that stand in every file of it."""
    source, orbit = trajectory.source, trajectory.orbit
    system = source.system
    lines = [
        f"{source.title}; {system.title}",
        "computed in double precision; nothing about these states is proved",
        source.verdict,
        *(f"{name} = {format_rational(value)} = {float(value):.17g}" for name, value in source.parameters.items()),
    ]
    if system.family_parameter is not None:
        lines.append(f"{system.family_parameter} = {orbit.unknowns[0]:.17g}")
    if system in THREE_BODY:
        lines.append("frame: turns with the primaries, origin in their centre of mass, x towards the smaller one")
    lines.append(f"period: {orbit.period:.15g} (nondimensional)")
    if orbit.first_integral is not None:
        lines.append(f"{system.first_integral_name}: {orbit.first_integral:.15g} (nondimensional)")
    lines += [
        f"multipliers without the trivial pair: {', '.join(complex_text(value) for value in trajectory.multipliers)}",
        f"stability index: {trajectory.stability_index:.10g}",
        f"distance from Fix(R) after half a period: {trajectory.defect:.1e} (nondimensional)",
    ]
    if trajectory.drift is not None:
        lines.append(f"largest change of the {system.first_integral_name}: {trajectory.drift:.1e} (nondimensional)")
    if units is not None:
        lines.append(f"unit of length: {units.length:.15g} km, unit of time: {units.time:.15g} s, {units.source}")
    return lines


def complex_text(value: complex) -> str:
    """A multiplier to ten digits, without an imaginary part that is zero."""
    return f"{value.real:.10g}" if value.imag == 0 else f"{value.real:.10g}{value.imag:+.10g}i"


def _columns(trajectory: Trajectory, units: Units | None) -> tuple[Sequence[str], np.ndarray]:
    names = trajectory.source.system.state
    if trajectory.source.system not in THREE_BODY:
        return ("t", *names), np.ones(1 + len(names))
    length, time, velocity = ("LU", "TU", "LU/TU") if units is None else ("km", "s", "km/s")
    labels = [f"{name} ({unit})" for name, unit in zip(names, [length] * 3 + [velocity] * 3, strict=True)]
    scales = np.ones(7) if units is None else np.array([units.time, *[units.length] * 3, *[units.velocity] * 3])
    return (f"t ({time})", *labels), scales
