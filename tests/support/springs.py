"""Orbits of a hard spring beside a soft one, whose motions are known."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
from flint import arb
from support.exact_elements import number

from orbitproof.shared.formats import COORDINATE, STABLE_ORBIT, Candidate, Equation
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.evidence import bounds, exact_value
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import OrbitEnclosures, OrbitResults, enclose_orbit
from orbitproof.verify.poincare import IntegratorSettings

BITS = 160

SPRINGS = ReversibleSystem(
    name="springs",
    title="hard spring beside a soft one",
    state=("x", "y", "vx", "vy"),
    parameters={"w": ParameterRange(None, None)},
    vector_field=lambda s, p: (s[2], s[3], -s[0] - s[0] ** 3, -p[0] * s[1]),
    reversing_symmetry=(1, 1, -1, -1),
    section="vx",
    first_integral=lambda s, p: (s[2] ** 2 + s[3] ** 2 + s[0] ** 2 + s[0] ** 4 / 2 + p[0] * s[1] ** 2,),
    first_integral_name="twice the energy",
    squared_distance=lambda s, _: (3 + s[1],),
    distance_name="something",
)
"""x'' = -x - x^3 from x = a is at -a after the time T(a); y = y_0 cos(t w^(1/2))."""

Y = Fraction(1, 2)


def exactly(value: Any) -> Fraction:
    return Fraction(int(mpmath.floor(mpmath.ldexp(value, BITS))), 2**BITS)


def half(a: Any) -> Any:
    """T(a)."""
    return 2 * mpmath.ellipk(a * a / (2 + 2 * a * a)) / mpmath.sqrt(1 + a * a)


def claim(w: int, turns: Fraction, crossings: int, radii: tuple[Fraction, Fraction], off: Fraction) -> Candidate:
    """The orbit through y = Y on which the soft spring turns by `turns` times pi in half a period.

    The centre is `off` radii away from it.
    """
    time = number(turns) * mpmath.pi / mpmath.sqrt(w)
    a = mpmath.findroot(lambda value: crossings * half(value) - time, 1.0)
    tilt = Fraction(1, 4)
    return Candidate(
        id="springs",
        system=SPRINGS,
        parameters={"w": Fraction(w)},
        kind="orbit",
        k=1,
        centre=(exactly(a) + off * radii[0], Y + off * (radii[1] + tilt * radii[0])),
        frame=((Fraction(1), Fraction(0)), (tilt, Fraction(1))),
        kernel_frame=((Fraction(1),),),
        radii=radii,
        crossings=crossings,
        equation=Equation(COORDINATE, Y, "y"),
    )


SMALL = (Fraction(1, 2**50), Fraction(1, 2**54))
CLAIMS = {
    "once": lambda: claim(111, Fraction(8), 1, SMALL, Fraction(1, 2)),
    "twice": lambda: claim(11, Fraction(5), 2, SMALL, Fraction(1, 2)),
}


@cache
def springs(name: str) -> tuple[Candidate, OrbitEnclosures]:
    """A claim, and its enclosures."""
    with mpmath.workprec(BITS):
        candidate = CLAIMS[name]()
    return candidate, enclose_orbit(candidate, IntegratorSettings(128), ORACLE)


def contains(ball: arb, value: Any, accuracy: float = 1e-18) -> bool:
    """Whether a ball contains a number that is known up to `accuracy`."""
    low, high = bounds(ball)
    return bool(number(low) - accuracy <= value <= number(high) + accuracy)


@cache
def spring() -> Candidate:
    """The orbit along the hard spring, the soft one at rest."""
    with mpmath.workprec(BITS):
        found = claim(111, Fraction(8), 1, SMALL, Fraction(1, 2))
    return replace(
        found,
        system=replace(SPRINGS, squared_distance=None, distance_name=None, first_integral_name="energy"),
        parameters={"w": Fraction(2)},
        kind=STABLE_ORBIT,
        centre=(Fraction(3, 2) + SMALL[0] / 2, SMALL[1] / 2),
        frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))),
        equation=Equation(COORDINATE, Fraction(3, 2), "x"),
    )


def middle(ball: arb) -> Any:
    return number(exact_value(ball.mid()))


def start_of(orbit: OrbitResults) -> list[Fraction]:
    """The state from which an orbit of the three-body problem starts, in the middle of what is known."""
    x, z, vy = (exact_value(ball.mid()) for ball in orbit.point.values())
    return [x, Fraction(0), z, Fraction(0), vy, Fraction(0)]
