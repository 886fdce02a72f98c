"""Bifurcations of periodic orbits with closed forms, and of systems of the literature, as claims."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from support.periodic_cases import LOCKED, LORENZ, ONE, ZERO, unit
from support.systems import described

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.shared.systems import System

WIDTH = Fraction(1, 2**70)

FOLDING = described(
    name="folding",
    state="x y",
    parameters="a b c",
    where={"s": "x**2 + y**2 - 1 - b*a", "g": "c*a - s**2"},
    field={"x": "x*g/8 - y", "y": "x + y*g/8"},
)
"""Circles with s^2 = c a: a fold of the unit circle at a = 0. With r = 1 + y, a = 4 y^2/c to second order."""

DOUBLING = described(
    name="doubling",
    state="x y u v",
    parameters="a b c d e",
    where={
        "q": "x**2 + y**2",
        "w": "u**2 + v**2",
        "s": "1 + b*a - q - d*w",
        "g": "e*(q - 1) - c*w",
        "i": "(a - 1)/2 + g/2",
        "j": "(a + 1)/2 + g/2",
    },
    field={
        "x": "x*s/8 - y",
        "y": "x + y*s/8",
        "u": "i*u + j*(x*u + y*v) - v/2",
        "v": "i*v + j*(y*u - x*v) + u/2",
    },
)
"""About the circle of radius r, r^2 = 1 + b a, in the plane (u, v) turned by half its angle:

U' = (i + j r) U, V' = (i - j r) V. With U only, r^2 = 1 + b a - d U^2, so to first order
a (1 + (e + 1/4) b) = (c + (e + 1/4) d) U^2.
"""

BREAKING = described(
    name="breaking",
    state="x y u v",
    parameters="a b c d e",
    where={"q": "x**2 + y**2", "s": "1 + b*a - q - d*u**2"},
    field={"x": "x*s/8 - y", "y": "x + y*s/8", "u": "(a + e*(q - 1) - c*u**2)*u", "v": "-v/2"},
)
"""The circle with r^2 = 1 + b a in the fixed set of (u, v) -> (-u, -v); a (1 + e b) = (c + e d) u^2."""

HALF_A_PERIOD = described(
    name="half-a-period",
    state="x y z u",
    parameters="a b c d e",
    where={"q": "x**2 + y**2", "s": "1 + b*a - q - d*u**2"},
    field={
        "x": "x*s/8 - y",
        "y": "x + y*s/8",
        "z": "-4*x*y - z/4 + (x**2 - y**2)/4",
        "u": "(a + e*(q - 1) - c*u**2)*u",
    },
)
"""The same with z = x^2 - y^2; it is mapped to itself by (-x, -y, z, -u), and moved by half its period."""

LEVELS = described(
    name="levels",
    state="x y u v",
    parameters="c",
    where={
        "q": "x**2 + y**2",
        "g": "c*(u**2 + v**2)",
        "i": "(q - 2)/2 - g/2",
        "j": "q/2 - g/2",
    },
    field={
        "x": "-y",
        "y": "x",
        "u": "i*u + j*(x*u + y*v) - v/2",
        "v": "i*v + j*(y*u - x*v) + u/2",
    },
    first_integral="x**2 + y**2",
)
"""`DOUBLING` with q - 1 for a, q = h the level: (5/4) (h - 1) = c U^2 to first order."""

LEVEL_FOLD = described(
    name="level-fold",
    state="x y u",
    parameters="a",
    field={"x": "-y", "y": "x", "u": "(x**2 + y**2 - 1 - a - u**2)/4"},
    first_integral="x**2 + y**2",
)
"""On the level h of x^2 + y^2 circles with u^2 = h - 1 - a."""

AREA = described(
    name="area",
    state="x y u v",
    parameters="c",
    where={
        "k": "x**2 + y**2 - 1",
        "g": "(u**2 + v**2 + x*(u**2 - v**2) + 2*y*u*v)/2",
        "h": "(c*g - k)/2",
    },
    field={
        "x": "-y",
        "y": "x",
        "u": "-v/2 + (v + x*v - y*u)/2 + h*(v - x*v + y*u)",
        "v": "u/2 - (u - x*u - y*v)/2 - h*(u + x*u + y*v)",
    },
    first_integral="x**2 + y**2",
)
"""(u, v) by a Hamiltonian, V^2/2 - (h - 1) U^2/2 + c U^4/4 on the unit circle, where -1 is a double multiplier.

New orbits have V = 0 and (5/4) (h - 1) = c U^2 to first order.
"""

VERTICAL = described(
    name="vertical",
    state="x y u v w",
    parameters="a",
    where={"s": "1 - x**2 - y**2", "i": "(w - 1)/2 - (u**2 + v**2)/2", "j": "(w + 1)/2 - (u**2 + v**2)/2"},
    field={
        "x": "x*s/8 - y",
        "y": "x + y*s/8",
        "u": "i*u + j*(x*u + y*v) - v/2",
        "v": "i*v + j*(y*u - x*v) + u/2",
        "w": "a",
    },
)
"""`DOUBLING` with w for a: periodic orbits for a = 0 only, and for all w."""

ROESSLER = described(
    name="roessler", state="x y z", parameters="a b c", field={"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"}
)


def bifurcation(
    system: System, kind: str, place: int, centre: list[Fraction], kernel: list[Fraction], **more: Any
) -> PeriodicBifurcation:
    """A claim about a box in the plane where a coordinate has its value at the centre."""
    size = len(centre)
    claim: dict[str, Any] = {
        "id": kind,
        "system": system,
        "normal": unit(size, place),
        "offset": centre[place],
        "direction": 1,
        "crossings": 1,
        "centre": tuple(centre),
        "frame": tuple(tuple(Fraction(int(i == j)) for j in range(size) if j != place) for i in range(size)),
        "radii": (WIDTH,) * (size - 1),
        "kind": kind,
        "kernel": (tuple(kernel),),
        "kernel_radius": Fraction(1, 2**20),
        "parameter_radius": WIDTH,
    }
    return PeriodicBifurcation(**(claim | more))


def numbers(**values: Any) -> dict[str, Fraction]:
    """Parameters; a is 0."""
    return {"a": ZERO, **{name: Fraction(value) for name, value in values.items()}}


def folding(b: Any = 1, c: Any = 1, **more: Any) -> PeriodicBifurcation:
    """The fold of `FOLDING` through (1, 0), where y = 0 is crossed upwards."""
    given: dict[str, Any] = {"parameters": numbers(b=b, c=c), "parameter": "a", **more}
    return bifurcation(FOLDING, "periodic-fold", 1, [ONE, ZERO], [ONE], **given)


def forced_fold(**more: Any) -> PeriodicBifurcation:
    """A claim about `LOCKED`, of which nothing is true but its form; the speed of the force varies."""
    given: dict[str, Any] = {"parameters": {"r": Fraction(3), "k": ONE}, "parameter": "r", **more}
    return bifurcation(LOCKED, "periodic-fold", 1, [ONE, ZERO, ONE, ZERO], [ONE, ZERO, ZERO], **given)


def doubling(b: Any = 0, c: Any = 1, d: Any = 0, e: Any = 0, **more: Any) -> PeriodicBifurcation:
    """The doubling of `DOUBLING` through (1, 0, 0, 0)."""
    given: dict[str, Any] = {"parameters": numbers(b=b, c=c, d=d, e=e), "parameter": "a", **more}
    return bifurcation(DOUBLING, "periodic-doubling", 1, [ONE, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO], **given)


def breaking(b: Any = 0, c: Any = 1, d: Any = 0, e: Any = 0, **more: Any) -> PeriodicBifurcation:
    """The pitchfork of `BREAKING` through (1, 0, 0, 0)."""
    symmetry = (unit(4, 0), unit(4, 1), (ZERO, ZERO, -ONE, ZERO), (ZERO, ZERO, ZERO, -ONE))
    given: dict[str, Any] = {"parameters": numbers(b=b, c=c, d=d, e=e), "parameter": "a", "symmetry": symmetry, **more}
    return bifurcation(BREAKING, "periodic-pitchfork", 1, [ONE, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO], **given)


def half_a_period(b: Any = 0, c: Any = 1, d: Any = 0, e: Any = 0, **more: Any) -> PeriodicBifurcation:
    """The pitchfork of `HALF_A_PERIOD` through (-1/sqrt 2, 1/sqrt 2, 0, 0), where z = 0 is crossed upwards."""
    symmetry = ((-ONE, ZERO, ZERO, ZERO), (ZERO, -ONE, ZERO, ZERO), unit(4, 2), (ZERO, ZERO, ZERO, -ONE))
    root = Fraction(int("70710678118654752440084436210484903928483593768847"), 10**50)
    given: dict[str, Any] = {"parameters": numbers(b=b, c=c, d=d, e=e), "parameter": "a", "symmetry": symmetry, **more}
    return bifurcation(HALF_A_PERIOD, "periodic-pitchfork", 2, [-root, root, ZERO, ZERO], [ZERO, ZERO, ONE], **given)


def levels(c: Any = 1, **more: Any) -> PeriodicBifurcation:
    """The doubling of `LEVELS` at the level 1."""
    given: dict[str, Any] = {"parameters": {"c": Fraction(c)}, "level": ONE, **more}
    return bifurcation(LEVELS, "periodic-doubling", 1, [ONE, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO], **given)


def area(c: Any = 1, **more: Any) -> PeriodicBifurcation:
    """The doubling of `AREA` at the level 1."""
    given: dict[str, Any] = {"parameters": {"c": Fraction(c)}, "level": ONE, **more}
    return bifurcation(AREA, "periodic-doubling", 1, [ONE, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO], **given)


def vertical(**more: Any) -> PeriodicBifurcation:
    """The doubling of `VERTICAL` at w = 0."""
    given: dict[str, Any] = {"parameters": {"a": ZERO}, "parameter": "a", **more}
    centre, kernel = [ONE, ZERO, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO, ZERO]
    return bifurcation(VERTICAL, "periodic-doubling", 1, centre, kernel, **given)


def level_fold(**more: Any) -> PeriodicBifurcation:
    """The fold of `LEVEL_FOLD` at the level 1."""
    given: dict[str, Any] = {"parameters": {"a": ZERO}, "level": ONE, **more}
    return bifurcation(given.pop("system", LEVEL_FOLD), "periodic-fold", 1, [ONE, ZERO, ZERO], [ZERO, ONE], **given)


def _decimals(*texts: str) -> list[Fraction]:
    return [Fraction(text) for text in texts]


def roessler(**more: Any) -> PeriodicBifurcation:
    """The first period doubling of Roessler's system with a = b = 1/5, at y = 0 upwards."""
    centre = _decimals("5.1081491751523568313940818628970840315872", "0", "1.6384006889458854623329467948432555909587")
    kernel = _decimals("-0.4664554293329795809875744818211194435314", "-0.8845447034750621975299739089303844425223")
    value = Fraction("2.8324450278625389136738461356535016517090")
    given: dict[str, Any] = {
        "parameters": {"a": Fraction(1, 5), "b": Fraction(1, 5), "c": value}, "parameter": "c", **more
    }  # fmt: skip
    return bifurcation(ROESSLER, "periodic-doubling", 1, centre, kernel, **given)


TURN = ((-ONE, ZERO, ZERO), (ZERO, -ONE, ZERO), (ZERO, ZERO, ONE))
"""The symmetry of Lorenz' system."""


def _lorenz(kind: str, rho: str, centre: list[Fraction], kernel: list[Fraction], **more: Any) -> PeriodicBifurcation:
    parameters = {"sigma": Fraction(10), "rho": Fraction(rho), "beta": Fraction(8, 3)}
    given: dict[str, Any] = {"parameters": parameters, "parameter": "rho", "direction": -1, **more}
    return bifurcation(LORENZ, kind, 2, centre, kernel, **given)


def lorenz_pitchfork(**more: Any) -> PeriodicBifurcation:
    """Where the symmetric orbit of large rho loses its symmetry."""
    centre = _decimals(
        "-20.5831045756722317499301077507184285058467", "46.2759771051244295450119920890922092767637", "312"
    )
    kernel = _decimals("-0.0177121281603731254204606777063172556216", "-0.9998431279535957005474030190312870691871")
    given = {"symmetry": TURN, **more}
    return _lorenz("periodic-pitchfork", "312.9735329841616128630664753895300741784200", centre, kernel, **given)


def lorenz_second_pitchfork(**more: Any) -> PeriodicBifurcation:
    """The same of an orbit with two crossings in half a period."""
    centre = _decimals(
        "-9.6119258590428476454996074522387847754097", "35.1285570819961691676348872852039035987846", "154"
    )
    kernel = _decimals("0.1562366585772581393666580350474727851302", "0.9877196497572645824930574222622911614858")
    given = {"symmetry": TURN, "crossings": 2, **more}
    return _lorenz("periodic-pitchfork", "154.4363508828694394874550221832439026819311", centre, kernel, **given)


def lorenz_fold(**more: Any) -> PeriodicBifurcation:
    """Where the orbits of the window below rho = 166.06 vanish, four crossings."""
    centre = _decimals(
        "9.4510231333136822564180119896230918640945", "-42.9474831932462099721798084252109390188378", "165"
    )
    kernel = _decimals("-0.1300386836905722989546294819731996171306", "-0.9916678132044588060718202772147483303381")
    given = {"crossings": 4, **more}
    return _lorenz("periodic-fold", "166.0614921038597126691465393620967348327095", centre, kernel, **given)


def shifted(claim: PeriodicBifurcation, place: int, by: Fraction) -> PeriodicBifurcation:
    """The box moved in one of its directions, the last one that of what varies."""
    if place < len(claim.radii):
        centre = tuple(x + row[place] * by for x, row in zip(claim.centre, claim.frame, strict=True))
        return replace(claim, centre=centre)
    if claim.parameter is None:
        assert claim.level is not None
        return replace(claim, level=claim.level + by)
    return replace(claim, parameters={**claim.parameters, claim.parameter: claim.parameters[claim.parameter] + by})
