"""Small planar orbits about the triangular points L4 and L5 of the CR3BP, from the linear equations there."""

from __future__ import annotations

from math import pi, sqrt

from orbitproof.explore.three_body.names import WITHOUT_SYMMETRY as TRIANGULAR

_AMPLITUDE = 0.02


def triangular_orbit(mass: float, name: str, amplitude: float = _AMPLITUDE) -> tuple[dict[str, float], float]:
    """A state near a periodic orbit of the short- or long-period family, by name, and its period.

    The frequencies s are the roots of s^4 - s^2 + (27/4) mass (1 - mass) = 0, the periods near 2 pi/s (V. Szebehely,
    Theory of Orbits, 1967, section 5.4); both are real below Routh's mass, 0.0385...

    Arguments:
        mass: mass parameter of the CR3BP.
        name: one of `TRIANGULAR`.
        amplitude: distance from the point, nondimensional.

    Raises `ValueError` for other names, and above Routh's mass.
    """
    if name not in TRIANGULAR:
        raise ValueError(f"there is no {name!r}; there are {', '.join(TRIANGULAR)}")
    half = 1 - 27 * mass * (1 - mass)
    if half <= 0:
        raise ValueError("the triangular points have no such orbits above Routh's mass, 0.0385...; give a smaller one")
    point, kind = name.split("-")
    side = 1.0 if point == "L4" else -1.0
    s = sqrt((1 + (sqrt(half) if kind == "short" else -sqrt(half))) / 2)
    across, along = side * 3 * sqrt(3) / 4 * (1 - 2 * mass), 2.25
    # x'' - 2 y' = 3/4 x + across y and y'' + 2 x' = across x + 9/4 y: y for x = cos(s t), from the second equation.
    answer = (across - 2j * s) / (-(s**2) - along)
    size = amplitude / sqrt(1 + abs(answer) ** 2)
    start = {
        "x": 0.5 - mass + size,
        "y": side * sqrt(3) / 2 + size * answer.real,
        "z": 0.0,
        "vx": 0.0,
        "vy": -size * s * answer.imag,
        "vz": 0.0,
    }
    return {key: float(value) for key, value in start.items()}, 2 * pi / s
