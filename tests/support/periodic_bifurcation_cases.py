"""Bifurcations of periodic orbits with closed forms, and of systems of the literature, as claims."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from support.periodic_cases import ONE, ZERO, unit

from orbitproof.shared.formats import PeriodicBifurcation, define_system
from orbitproof.shared.systems import System

WIDTH = Fraction(1, 2**70)

FOLDING = define_system(
    {
        "name": "folding",
        "state": "x y",
        "parameters": "a b c",
        "where": {"s": "x**2 + y**2 - 1 - b*a", "g": "c*a - s**2"},
        "field": {"x": "x*g/8 - y", "y": "x + y*g/8"},
    }
)
"""Circles with s^2 = c a: a fold of the unit circle at a = 0. With r = 1 + y, a = 4 y^2/c to second order."""

DOUBLING = define_system(
    {
        "name": "doubling",
        "state": "x y u v",
        "parameters": "a b c d e",
        "where": {
            "q": "x**2 + y**2",
            "w": "u**2 + v**2",
            "s": "1 + b*a - q - d*w",
            "g": "e*(q - 1) - c*w",
            "i": "(a - 1)/2 + g/2",
            "j": "(a + 1)/2 + g/2",
        },
        "field": {
            "x": "x*s/8 - y",
            "y": "x + y*s/8",
            "u": "i*u + j*(x*u + y*v) - v/2",
            "v": "i*v + j*(y*u - x*v) + u/2",
        },
    }
)
"""About the circle of radius r, r^2 = 1 + b a, in the plane (u, v) turned by half its angle:

U' = (i + j r) U, V' = (i - j r) V. With U only, r^2 = 1 + b a - d U^2, so to first order
a (1 + (e + 1/4) b) = (c + (e + 1/4) d) U^2.
"""

BREAKING = define_system(
    {
        "name": "breaking",
        "state": "x y u",
        "parameters": "a b c d e",
        "where": {"q": "x**2 + y**2", "s": "1 + b*a - q - d*u**2"},
        "field": {"x": "x*s/8 - y", "y": "x + y*s/8", "u": "(a + e*(q - 1) - c*u**2)*u"},
    }
)
"""The circle with r^2 = 1 + b a in the fixed set of u -> -u; a (1 + e b) = (c + e d) u^2."""

HALF_A_PERIOD = define_system(
    {
        "name": "half-a-period",
        "state": "x y z u",
        "parameters": "a b c d e",
        "where": {"q": "x**2 + y**2", "s": "1 + b*a - q - d*u**2"},
        "field": {
            "x": "x*s/8 - y",
            "y": "x + y*s/8",
            "z": "-4*x*y - z/4 + (x**2 - y**2)/4",
            "u": "(a + e*(q - 1) - c*u**2)*u",
        },
    }
)
"""The same with z = x^2 - y^2; it is mapped to itself by (-x, -y, z, -u), and moved by half its period."""

LEVELS = define_system(
    {
        "name": "levels",
        "state": "x y u v",
        "parameters": "c",
        "where": {
            "q": "x**2 + y**2",
            "g": "c*(u**2 + v**2)",
            "i": "(q - 2)/2 - g/2",
            "j": "q/2 - g/2",
        },
        "field": {
            "x": "-y",
            "y": "x",
            "u": "i*u + j*(x*u + y*v) - v/2",
            "v": "i*v + j*(y*u - x*v) + u/2",
        },
        "first_integral": "x**2 + y**2",
    }
)
"""`DOUBLING` with q - 1 for a, q = h the level: (5/4) (h - 1) = c U^2 to first order."""

LEVEL_FOLD = define_system(
    {
        "name": "level-fold",
        "state": "x y u",
        "parameters": "a",
        "field": {"x": "-y", "y": "x", "u": "(x**2 + y**2 - 1 - a - u**2)/4"},
        "first_integral": "x**2 + y**2",
    }
)
"""On the level h of x^2 + y^2 circles with u^2 = h - 1 - a."""

ROESSLER = define_system(
    {
        "name": "roessler",
        "state": "x y z",
        "parameters": "a b c",
        "field": {"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"},
    }
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


def doubling(b: Any = 0, c: Any = 1, d: Any = 0, e: Any = 0, **more: Any) -> PeriodicBifurcation:
    """The doubling of `DOUBLING` through (1, 0, 0, 0)."""
    given: dict[str, Any] = {"parameters": numbers(b=b, c=c, d=d, e=e), "parameter": "a", **more}
    return bifurcation(DOUBLING, "periodic-doubling", 1, [ONE, ZERO, ZERO, ZERO], [ZERO, ONE, ZERO], **given)


def breaking(b: Any = 0, c: Any = 1, d: Any = 0, e: Any = 0, **more: Any) -> PeriodicBifurcation:
    """The pitchfork of `BREAKING` through (1, 0, 0)."""
    symmetry = (unit(3, 0), unit(3, 1), (ZERO, ZERO, -ONE))
    given: dict[str, Any] = {"parameters": numbers(b=b, c=c, d=d, e=e), "parameter": "a", "symmetry": symmetry, **more}
    return bifurcation(BREAKING, "periodic-pitchfork", 1, [ONE, ZERO, ZERO], [ZERO, ONE], **given)


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


def level_fold(**more: Any) -> PeriodicBifurcation:
    """The fold of `LEVEL_FOLD` at the level 1."""
    given: dict[str, Any] = {"parameters": {"a": ZERO}, "level": ONE, **more}
    return bifurcation(LEVEL_FOLD, "periodic-fold", 1, [ONE, ZERO, ZERO], [ZERO, ONE], **given)
