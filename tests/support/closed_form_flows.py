"""Systems whose flows are known in closed form, for tests of enclosures of any system."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from orbitproof.shared import System, define_system


@dataclass(frozen=True)
class ClosedForm:
    """A system, its flow in mpmath, called with time, state and parameters, and where boxes are placed.

    Attributes:
        centre: about which boxes are drawn, by name.
        longest: time.
        widest: radius.
        backwards: whether the flow is known for negative times, too.
    """

    system: System
    flow: Callable[..., Sequence[Any]]
    centre: Mapping[str, float]
    longest: float
    widest: float = 0.01
    backwards: bool = True


def _system(name: str, state: str, field: Mapping[str, str], parameters: str = "") -> System:
    return define_system({"name": name, "state": state, "field": field, "parameters": parameters})


def spiral(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = -a x - w y, y' = w x - a y, z' = -b z."""
    (x, y, z), (a, w, b) = state, parameters
    c, s, shrunk = mpmath.cos(w * t), mpmath.sin(w * t), mpmath.exp(-a * t)
    return [shrunk * (c * x - s * y), shrunk * (s * x + c * y), mpmath.exp(-b * t) * z]


def oscillator(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = v, v' = -x."""
    x, v = state
    return [mpmath.cos(t) * x + mpmath.sin(t) * v, mpmath.cos(t) * v - mpmath.sin(t) * x]


def logistic(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = r x (1 - x), y' = 1."""
    (x, y), (r,) = state, parameters
    grown = mpmath.exp(r * t)
    return [x * grown / (1 + x * (grown - 1)), y + t]


def riccati(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = 1 + x^2, y' = y/(1 + x^2), with x = tan and y' integrated."""
    x, y = state
    angle = mpmath.atan(x)
    integral = t / 2 + (mpmath.sin(2 * (angle + t)) - mpmath.sin(2 * angle)) / 4
    return [mpmath.tan(angle + t), y * mpmath.exp(integral)]


def duffing(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = v, v' = -x - x^3 for v = 0 at first: x = A cn(sqrt(1 + A^2) t), m = A^2/(2 (1 + A^2))."""
    amplitude, _ = state
    rate = mpmath.sqrt(1 + amplitude**2)
    m = amplitude**2 / (2 * (1 + amplitude**2))
    cn, sn, dn = (mpmath.ellipfun(name, rate * t, m=m) for name in ("cn", "sn", "dn"))
    return [amplitude * cn, -amplitude * rate * sn * dn]


def root_fall(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = x^(-1/2), y' = y/x."""
    x, y = state
    end = (x**1.5 + 1.5 * t) ** (mpmath.mpf(2) / 3)
    return [end, y * mpmath.exp(2 * (mpmath.sqrt(end) - mpmath.sqrt(x)))]


def tangent(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = cos(x)^2, y' = exp(-y): tan x and exp y grow by t."""
    x, y = state
    return [mpmath.atan(mpmath.tan(x) + t), mpmath.log(mpmath.exp(y) + t)]


def nested(t: Any, state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """x' = 1, y' = a cos(a exp(x)) exp(x), z' = log(x)."""
    (x, y, z), (a,) = state, parameters
    end = x + t
    moved = mpmath.sin(a * mpmath.exp(end)) - mpmath.sin(a * mpmath.exp(x))
    return [end, y + moved, z + end * mpmath.log(end) - end - x * mpmath.log(x) + x]


SPIRAL = ClosedForm(
    _system("spiral", "x y z", {"x": "-a*x - w*y", "y": "w*x - a*y", "z": "-b*z"}, "a w b"), spiral,
    {"x": 1.0, "y": 0.4, "z": 0.7, "a": 0.1, "w": 1.3, "b": 0.2}, 4.0, 0.05,
)  # fmt: skip
OSCILLATOR = ClosedForm(_system("oscillator", "x v", {"x": "v", "v": "-x"}), oscillator, {"x": 1.0, "v": 0.3}, 6.0, 0.1)
LOGISTIC = ClosedForm(
    _system("logistic", "x y", {"x": "r*x*(1 - x)", "y": "1"}, "r"), logistic, {"x": 0.2, "y": 0.0, "r": 1.5}, 3.0
)
RICCATI = ClosedForm(
    _system("riccati", "x y", {"x": "1 + x**2", "y": "y/(1 + x**2)"}), riccati, {"x": 0.1, "y": 1.0}, 1.0
)
DUFFING = ClosedForm(_system("duffing", "x v", {"x": "v", "v": "-x - x**3"}), duffing, {"x": 0.9, "v": 0.0}, 3.0,
    backwards=False,
)  # fmt: skip
ROOT = ClosedForm(_system("root-fall", "x y", {"x": "x**(-1/2)", "y": "y/x"}), root_fall, {"x": 1.2, "y": -0.5}, 2.0,
    backwards=False,
)  # fmt: skip
TANGENT = ClosedForm(
    _system("tangent", "x y", {"x": "cos(x)**2", "y": "exp(-y)"}), tangent, {"x": 0.3, "y": 0.2}, 2.0, backwards=False
)
NESTED = ClosedForm(
    _system("nested", "x y z", {"x": "1", "y": "a*cos(a*exp(x))*exp(x)", "z": "log(x)"}, "a"), nested,
    {"x": 0.7, "y": 0.1, "z": -0.3, "a": 0.8}, 0.5, backwards=False,
)  # fmt: skip
CLOSED_FORMS = (SPIRAL, OSCILLATOR, LOGISTIC, RICCATI, DUFFING, ROOT, TANGENT, NESTED)


def exact(value: Fraction) -> Any:
    """An exact number in mpmath, rounded to the working precision."""
    return mpmath.mpf(value.numerator) / value.denominator
