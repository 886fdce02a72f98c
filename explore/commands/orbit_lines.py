"""What ``orbitproof explore orbit`` prints of an orbit, in double precision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbitproof.explore.names import NoOrbit
from orbitproof.explore.three_body.names import units_of_system
from orbitproof.shared.answers import tell
from orbitproof.shared.printed_tables import filled, terminal_width
from orbitproof.shared.systems import MASS_PARAMETERS, THREE_BODY, UNITS

if TYPE_CHECKING:
    from orbitproof.explore.families import TracedFamily

_DAY = 86400.0
_NEAR = 1e-3
"""So much mass parameters of the same two bodies differ."""
_EARTH_MOON = 0.0121, 0.0122


def tell_refined(name: str, path: Path) -> None:
    """Tell what an orbit of a candidates file is, in double precision."""
    from orbitproof.explore.values import read_orbit

    try:
        orbit = read_orbit(path, id=name)
    except NoOrbit as error:
        tell(f"{name}: {error}", [{"id": name, "failure": str(error)}])
        return
    values = dict(zip(orbit.system.state, map(float, orbit.point), strict=True))
    orbit_told = _Told({"id": name, "system": orbit.system.name, "parameters": orbit.parameters})
    orbit_told.place("state", values, 12)
    orbit_told.period(orbit.period, orbit.parameters, 12)
    if orbit.first_integral is not None:
        orbit_told.level(orbit.system.first_integral_name, orbit.first_integral, 12)
    orbit_told.stability(orbit.stability)
    if orbit.system in THREE_BODY:
        orbit_told.nearest(orbit.point, orbit.period, orbit.parameters["mu"])
    tell("\n".join([name, *_aligned(orbit_told.rows, "  ")]), [orbit_told.result])


def tell_corrected(item: TracedFamily) -> None:
    """Tell what a corrected orbit is."""
    problem, (orbit,) = item.family.problem, item.family.orbits
    system, half_period = problem.system, float(orbit.half_period)
    orbit_told = _Told({"id": item.title, "system": system.name, "parameters": problem.parameters})
    orbit_told.rows.append(("orbit", item.title))
    if item.branch is not None:
        orbit_told.add("branch", f"{item.branch}ern", {"branch": item.branch})
    for title, centre in (("point", orbit.centre("first")), ("other point", orbit.centre("second"))):
        orbit_told.place(title, dict(zip(system.centre_coordinates, map(float, centre), strict=True)), 15)
    orbit_told.add("half period", f"{half_period:.15g}", {"half_period": half_period})
    orbit_told.period(2 * half_period, problem.parameters, 15)
    crossings = {"crossings": orbit.crossings}
    orbit_told.add("crossings", f"{orbit.crossings} in the half period", crossings)
    if orbit.first_integral is not None:
        orbit_told.level(system.first_integral_name, float(orbit.first_integral), 15)
    error = None if orbit.derivative is None else orbit.derivative.error
    orbit_told.stability(tuple(orbit.stability), error)
    if system in THREE_BODY:
        state = [0.0] * len(system.state)
        for index, value in zip(system.fixed_coordinates, orbit.centre("first"), strict=True):
            state[index] = float(value)
        orbit_told.nearest(state, 2 * half_period, float(problem.parameters["mu"]))
    if problem.symmetry is not None:
        orbit_told.add("symmetry", problem.symmetry, {"symmetry": problem.symmetry})
    tell("\n".join(_aligned(orbit_told.rows)), [orbit_told.result])


class _Told:
    """What is said of an orbit.

    Attributes:
        rows: titles, and the texts beside them.
        result: the same for programs.
    """

    def __init__(self, result: dict[str, Any]) -> None:
        self.rows: list[tuple[str, str]] = []
        self.result = result

    def add(self, title: str, text: str, result: Mapping[str, Any]) -> None:
        self.rows.append((title, text))
        self.result |= result

    def place(self, title: str, values: Mapping[str, float], digits: int) -> None:
        text = ", ".join(f"{name} = {value:.{digits}g}" for name, value in values.items())
        self.add(title, text, {title.replace(" ", "_"): values})

    def period(self, period: float, parameters: Mapping[str, Any], digits: int) -> None:
        mass, result = parameters.get("mu"), {"period": period}
        units = units_of_system(mass)
        remark = "" if mass is None else _unknown(float(mass))
        if units is not None:
            result["period_days"] = period * units.time / _DAY
            remark = f"  ({result['period_days']:.6g} days)"
        self.add("period", f"{period:.{digits}g}{remark}", result)

    def level(self, name: str | None, value: float, digits: int) -> None:
        title = name or "first integral"
        self.add(title, f"{value:.{digits}g}", {"first_integral_name": title, "first_integral": value})

    def stability(self, parameters: Sequence[complex], error: float | None = None) -> None:
        from orbitproof.explore.orbits import stability_index

        words = ", ".join(f"{value.real:.10g}" if value.imag == 0 else f"{value:.10g}" for value in parameters)
        known = "" if error is None else f"  (float64, error about {error:.0e})"
        index = stability_index(tuple(parameters))
        self.add("stability", f"{words}{known}", {"stability": list(parameters)})
        self.add("stability index", f"{index:.6g}", {"stability_index": index})

    def nearest(self, state: Sequence[float], period: float, mass: float) -> None:
        import numpy as np

        from orbitproof.explore.three_body.catalogues import distances_from_primaries

        least = float(distances_from_primaries(np.array([state], float), np.array([period]), mass).least[0])
        result, far, units = {"least_distance": least}, "", units_of_system(mass)
        if units is not None:
            result["least_distance_km"] = least * units.length
            far = f"  ({result['least_distance_km']:.6g} km)"
        is_moon = _EARTH_MOON[0] < mass < _EARTH_MOON[1]
        self.add("perilune" if is_moon else "periapsis", f"{least:.8g}{far}", result)


def _unknown(mass: float) -> str:
    """Under which name a mass parameter has units, if one that is nearly the same has."""
    named = ((name, value) for name, value in MASS_PARAMETERS.items() if value in UNITS)
    near = [name for name, value in named if abs(mass / float(value) - 1) < _NEAR]
    return f"  (days and km: --mass {near[0]})" if near else ""


def _aligned(rows: Sequence[tuple[str, str]], margin: str = "") -> list[str]:
    """Titles, and what they are beside them, in lines that fit."""
    column, width = max(len(title) for title, _ in rows), terminal_width()
    other = margin + " " * (column + 2)
    return [line for title, text in rows for line in filled(text, width, f"{margin}{title:{column}}  ", other)]
