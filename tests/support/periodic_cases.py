"""Claims about periodic orbits without symmetry, with closed forms and from the literature."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from support.systems import described

from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.shared.systems import System

LORENZ = described(
    name="lorenz",
    state="x y z",
    parameters="sigma rho beta",
    field={"x": "sigma*(y - x)", "y": "rho*x - y - x*z", "z": "x*y - beta*z"},
)

HOPF = described(
    name="hopf",
    state="x y w",
    parameters="c",
    where={"s": "1 - x**2 - y**2"},
    field={"x": "x*s - y", "y": "x + y*s", "w": "-c*w"},
)
"""The unit circle, period 2 pi, multipliers exp(-4 pi) and exp(-2 pi c)."""

PLANAR = described(
    name="planar",
    state="x y",
    parameters="w",
    where={"s": "1 - x**2 - y**2"},
    field={"x": "x*s/4 - w*y", "y": "w*x + y*s/4"},
)
"""The unit circle, period 2 pi/w, multiplier exp(-pi/w)."""

TURNING = described(
    name="turning",
    state="x y u v",
    parameters="a",
    where={"s": "1 - x**2 - y**2"},
    field={"x": "x*s - y", "y": "x + y*s", "u": "a*u - v/3", "v": "u/3 + a*v"},
)
"""The unit circle, period 2 pi, multipliers exp(-4 pi) and exp(2 pi (a +- i/3))."""

OSCILLATORS = described(
    name="oscillators",
    state="x y u v",
    field={"x": "y", "y": "-x", "u": "v", "v": "-2*u"},
    first_integral="x**2 + y**2",
)
"""On the level h of x^2 + y^2 the circle in u = v = 0, period 2 pi, multipliers 1, 1 and exp(+-2 pi i sqrt 2)."""

PRODUCT = described(
    name="product",
    state="x y u v",
    field={"x": "y", "y": "-x", "u": "v", "v": "-2*u"},
    first_integral="(x**2 + y**2)*(1 + (x**2 + y**2)**2)",
)
"""The same with another first integral."""

ZERO, ONE = Fraction(0), Fraction(1)


def unit(size: int, place: int) -> tuple[Fraction, ...]:
    """A row with a 1."""
    return tuple(Fraction(int(i == place)) for i in range(size))


def in_plane(system: System, place: int, centre: list[Fraction], radius: Fraction, **more: Any) -> PeriodicOrbit:
    """A claim about a box in the plane where a coordinate has its value at the centre."""
    size = len(centre)
    claim: dict[str, Any] = {
        "id": "orbit",
        "system": system,
        "parameters": {},
        "normal": unit(size, place),
        "offset": centre[place],
        "direction": 1,
        "crossings": 1,
        "centre": tuple(centre),
        "frame": tuple(tuple(Fraction(int(i == j)) for j in range(size) if j != place) for i in range(size)),
        "radii": (radius,) * (size - 1),
    }
    return PeriodicOrbit(**(claim | more))


def hopf(**more: Any) -> PeriodicOrbit:
    """The unit circle through (1, 0, 0), where y = 0 is crossed upwards."""
    given: dict[str, Any] = {"parameters": {"c": Fraction(1, 4)}, **more}
    return in_plane(HOPF, 1, [ONE, ZERO, ZERO], Fraction(1, 2**90), **given)


def planar(w: Fraction, **more: Any) -> PeriodicOrbit:
    """The unit circle of `PLANAR` through (3/5, 4/5), on the section 4 x = 3 y."""
    return PeriodicOrbit(
        id="planar",
        system=PLANAR,
        parameters={"w": w},
        normal=(Fraction(4), Fraction(-3)),
        offset=ZERO,
        direction=-1,
        crossings=1,
        centre=(Fraction(3, 5), Fraction(4, 5)),
        frame=((Fraction(3),), (Fraction(4),)),
        radii=(Fraction(1, 2**90),),
        **more,
    )


def turning(a: Fraction, **more: Any) -> PeriodicOrbit:
    """The unit circle of `TURNING`."""
    return in_plane(TURNING, 1, [ONE, ZERO, ZERO, ZERO], Fraction(1, 2**90), parameters={"a": a}, **more)


def oscillators(
    level: Fraction = Fraction(4), system: System = OSCILLATORS, point: Fraction = Fraction(2), **more: Any
) -> PeriodicOrbit:
    """The circle through (point, 0, 0, 0), where y falls."""
    given: dict[str, Any] = {"direction": -1, "level": level, **more}
    return in_plane(system, 1, [point, ZERO, ZERO, ZERO], Fraction(1, 2**90), **given)


def lorenz(name: str = "AB", **more: Any) -> PeriodicOrbit:
    """The shortest orbits of the Lorenz system at r = 28; section z = 27 downwards."""
    places = {
        "AB": ("-2.14736763191811612564765799483", "2.07804821146124940031747857977", 2),
        "AAB": ("-2.52882238294585842638863182410", "1.55505505785879690340790859207", 3),
        "ABB": ("2.52882238294585842638863182410", "-1.55505505785879690340790859207", 3),
    }
    x, y, crossings = places[name]
    given: dict[str, Any] = {
        "id": name,
        "parameters": {"sigma": Fraction(10), "rho": Fraction(28), "beta": Fraction(8, 3)},
        "direction": -1,
        "crossings": crossings,
        **more,
    }
    return in_plane(LORENZ, 2, [Fraction(x), Fraction(y), Fraction(27)], Fraction(1, 10**20), **given)


def shifted(claim: PeriodicOrbit, place: int, by: Fraction) -> PeriodicOrbit:
    """The box moved in one of its directions."""
    centre = tuple(x + row[place] * by for x, row in zip(claim.centre, claim.frame, strict=True))
    return replace(claim, centre=centre)


LOCKED = described(
    name="locked",
    state="x y",
    parameters="r k",
    where={"s": "1 - x**2 - y**2"},
    field={
        "x": "x*s - r*y/2 + k*(x*cos(r*t) + y*sin(r*t) - x)",
        "y": "y*s + r*x/2 + k*(x*sin(r*t) - y*cos(r*t) - y)",
    },
)
"""z = x + iy follows half the angle of the force: z' = z (1 - |z|^2 + ir/2) + k (exp(irt) conj(z) - z)."""


def locked(r: Fraction, **more: Any) -> PeriodicOrbit:
    """z = exp(irt/2), of twice the period of the force, on the section y = 0."""
    parameters = {"r": r, "k": Fraction(1, 4)}
    return in_plane(LOCKED, 1, [ONE, ZERO, ONE, ZERO], Fraction(1, 2**70), parameters=parameters, **more)
