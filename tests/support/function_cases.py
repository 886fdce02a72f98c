"""Periodic orbits of fields with sin, cos, exp and log: closed forms in coordinates that are such functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import exp, log
from typing import Any

from support import periodic_bifurcation_cases as bifurcations
from support import periodic_curves
from support.periodic_cases import in_plane

from orbitproof.shared.formats import PeriodicAtlas, PeriodicBifurcation, PeriodicOrbit, define_system
from orbitproof.shared.systems import System

Q = Fraction
RADIUS = Q(1, 2**40)

SWING = define_system(
    {
        "name": "swing", "state": "x y", "parameters": {"e": [None, None]},
        "field": {"x": "y", "y": "-sin(x) - e*y*(y**2/2 - cos(x))"},
    }
)  # fmt: skip
"""For e > 0 all orbits with energy below 1, but for the equilibrium, go to y^2/2 = cos(x): period 4 K(1/sqrt 2)."""

PENDULUM = define_system(
    {
        "name": "pendulum", "state": "x y", "field": {"x": "y", "y": "-sin(x)"},
        "first_integral": "y**2/2 - cos(x)", "first_integral_name": "energy",
    }
)  # fmt: skip

OTHERS: dict[str, tuple[str, str, Callable[[float, float], tuple[float, float]]]] = {
    "sine": ("u + a*sin(v)", "p - a*cos(v)*q", lambda x, a: (x, 0.0)),
    "cosine": ("u + a*cos(v)", "p + a*sin(v)*q", lambda x, a: (x - a, 0.0)),
    "exponential": ("exp(u) - 2", "p*exp(-u)", lambda x, a: (log(x + 2), 0.0)),
    "logarithm": ("log(u)", "p*u", lambda x, a: (exp(x), 0.0)),
    "nested": (
        "u + a*sin(v + cos(v)/3)", "p - a*cos(v + cos(v)/3)*(1 - sin(v)/3)*q",
        lambda x, a: (x - a * 0.3271946967961523, 0.0),
    ),
    "root": (
        "(u*u + exp(v)**2)**(1/2) - 3", "((x + 3)*p - exp(v)**2*q)/u",
        lambda x, a: (((x + 3) ** 2 - 1) ** 0.5, 0.0),
    ),
}  # fmt: skip
"""x as a function of new coordinates u and v = y, u' from p = x' and q = y', and where u is at y = 0."""


def conjugated(kind: str) -> System:
    """The unit circle of x' = x s/4 - w y, y' = w x + y s/4, s = 1 - x^2 - y^2, where x is a function of u and y."""
    x, rate, _ = OTHERS[kind]
    where = {"x": x, "s": "1 - x**2 - v**2", "p": "x*s/4 - w*v", "q": "w*x + v*s/4"}
    return define_system(
        {"name": kind, "state": "u v", "parameters": "w a", "where": where, "field": {"u": rate, "v": "q"}}
    )


def circle(kind: str, w: Fraction, a: Fraction, **more: Any) -> PeriodicOrbit:
    """Where x = 1: period 2 pi/w, multiplier exp(-pi/w)."""
    u, v = OTHERS[kind][2](1.0, float(a))
    centre = [Q(round(u * 2**48), 2**48), Q(v)]
    return in_plane(conjugated(kind), 1, centre, RADIUS, parameters={"w": w, "a": a}, **more)


def swing(e: str = "1/10", **more: Any) -> PeriodicOrbit:
    """The limit cycle of `SWING` where x = 0 grows: y = sqrt 2."""
    y = Q(round(2**0.5 * 2**48), 2**48)
    return in_plane(SWING, 0, [Q(0), y], RADIUS, parameters={"e": Q(e)}, **more)


def pendulum(**more: Any) -> PeriodicOrbit:
    """The swing of `PENDULUM` to a right angle: energy 0."""
    return replace(swing(), **({"system": PENDULUM, "parameters": {}, "level": Q(0)} | more))


FOLDING = define_system(
    {
        "name": "folding", "state": "u v", "parameters": "a b c",
        "where": {"x": "1 + log(u)", "y": "2*sin(v)", "s": "x**2 + y**2 - 1 - b*a", "g": "c*a - s**2"},
        "field": {"u": "u*(x*g/8 - y)", "v": "(x + y*g/8)/(2*cos(v))"},
    }
)  # fmt: skip
"""`periodic_bifurcation_cases.FOLDING` with x = 1 + log(u) and y = 2 sin(v)."""

BREAKING = define_system(
    {
        "name": "breaking", "state": "x y m n", "parameters": "a b c d e",
        "where": {"u": "sin(m)", "v": "(exp(n) - exp(-n))/2", "q": "x**2 + y**2", "s": "1 + b*a - q - d*u**2"},
        "field": {
            "x": "x*s/8 - y", "y": "x + y*s/8", "m": "(a + e*(q - 1) - c*u**2)*u/cos(m)", "n": "-v/(exp(n) + exp(-n))",
        },
    }
)  # fmt: skip
"""`periodic_bifurcation_cases.BREAKING` with u = sin(m) and v = sinh(n)."""

LEVEL_FOLD = define_system(
    {
        "name": "level-fold", "state": "x v u", "parameters": "a",
        "field": {"x": "-2*sin(v)", "v": "x/(2*cos(v))", "u": "(x**2 + 4*sin(v)**2 - 1 - a - u**2)/4"},
        "first_integral": "x**2 + 4*sin(v)**2",
    }
)  # fmt: skip
"""`periodic_bifurcation_cases.LEVEL_FOLD` with y = 2 sin(v)."""

FASTER = define_system(
    {
        "name": "faster", "state": "u v", "parameters": "a",
        "where": {"x": "u + sin(v)/3", "r": "(1 - x**2 - v**2)/8", "s": "1 + a/4", "q": "r*v + s*x"},
        "field": {"u": "r*x - s*v - cos(v)/3*q", "v": "q"},
    }
)  # fmt: skip
"""`periodic_curves.FASTER` with x = u + sin(v)/3 and y = v."""

LEVELS = define_system(
    {
        "name": "levels", "state": "x v z", "parameters": "a",
        "field": {"x": "2*sin(v)", "v": "-x/(2*cos(v))", "z": "a*x - z"},
        "first_integral": "x**2 + 4*sin(v)**2",
    }
)  # fmt: skip
"""`periodic_curves.LEVELS` with y = 2 sin(v)."""


def folding(**more: Any) -> PeriodicBifurcation:
    """The fold of `FOLDING` through (1, 0)."""
    return replace(bifurcations.folding(**more), system=FOLDING)


def breaking(**more: Any) -> PeriodicBifurcation:
    """The pitchfork of `BREAKING` through (1, 0, 0, 0)."""
    return replace(bifurcations.breaking(**more), system=BREAKING)


def level_fold() -> PeriodicBifurcation:
    """The fold of `LEVEL_FOLD`."""
    return replace(bifurcations.level_fold(), system=LEVEL_FOLD)


def faster_atlas() -> PeriodicAtlas:
    """u = 1, a from 0 to 1."""
    return replace(periodic_curves.faster_atlas(), system=FASTER)


def levels_atlas() -> PeriodicAtlas:
    """Over the levels."""
    return replace(periodic_curves.levels_atlas(), system=LEVELS)
