"""What ``orbitproof explore orbit`` prints of an orbit, in double precision."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from orbitproof.explore.names import NoOrbit
from orbitproof.shared.systems import THREE_BODY

if TYPE_CHECKING:
    from orbitproof.explore.families import TracedFamily


def described(name: str, path: Path) -> list[str]:
    """What an orbit of a candidates file is, in double precision."""
    import numpy as np

    from orbitproof.explore.catalogues.distances import distances
    from orbitproof.explore.values import read_orbit

    try:
        orbit = read_orbit(path, id=name)
    except NoOrbit as error:
        return [f"{name}: {error}"]
    units = orbit.units
    days = "" if units is None else f"  ({orbit.period_days:.6g} days)"
    places = [f"{name} = {value:.12g}" for name, value in zip(orbit.system.state, orbit.point.tolist(), strict=True)]
    rows = [("state", ", ".join(places[:3])), *([("", ", ".join(places[3:]))] if places[3:] else [])]
    rows.append(("period", f"{orbit.period:.12g}{days}"))
    if orbit.first_integral is not None:
        rows.append((orbit.system.first_integral_name or "first integral", f"{orbit.first_integral:.12g}"))
    rows.append(("stability index", f"{orbit.stability_index:.6g}"))
    if orbit.system in THREE_BODY:
        mass, times = orbit.parameters["mu"], np.array([orbit.period])
        least = float(distances(orbit.point[None, :], times, mass).least[0])
        far = "" if units is None else f"  ({least * units.length:.6g} km)"
        rows.append(("perilune" if 0.0121 < mass < 0.0122 else "periapsis", f"{least:.8g}{far}"))
    return [name, *(f"  {line}" for line in _aligned(rows))]


def lines_of(item: TracedFamily) -> list[str]:
    """What a corrected orbit is."""
    problem, (orbit,) = item.family.problem, item.family.orbits
    system = problem.system
    rows = [("orbit", item.title), *([] if item.branch is None else [("branch", f"{item.branch}ern")])]
    for title, side in (("point", "first"), ("other point", "second")):
        place = zip(system.centre_coordinates, orbit.centre("first" if side == "first" else "second"), strict=True)
        rows.append((title, ", ".join(f"{name} = {value:.15g}" for name, value in place)))
    rows += [("half period", f"{orbit.half_period:.15g}"), ("crossings", f"{orbit.crossings} in the half period")]
    if orbit.first_integral is not None:
        rows.append((system.first_integral_name or "first integral", f"{orbit.first_integral:.15g}"))
    rows.append(
        (
            "stability",
            ", ".join(f"{value.real:.10g}" if value.imag == 0 else f"{value:.10g}" for value in orbit.stability),
        )
    )
    if orbit.derivative is not None:
        rows[-1] = (rows[-1][0], f"{rows[-1][1]}   (float64, error about {orbit.derivative.error:.0e})")
    if problem.symmetry is not None:
        rows.append(("symmetry", problem.symmetry))
    return _aligned(rows)


def _aligned(rows: Sequence[tuple[str, str]]) -> list[str]:
    width = max(len(title) for title, _ in rows)
    return [f"{title:{width}}  {text}" for title, text in rows]
