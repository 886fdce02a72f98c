"""Claims that R is lost, about a system in which the points are known, and a claim about halo orbits."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from orbitproof.shared.formats import REVERSOR_BREAKING, Candidate, candidate_from_json
from orbitproof.shared.systems import Defined, FixedLevel, ParameterRange, ReversibleSystem
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.reversor_breaking import BreakingResults

DATA = Path(__file__).parents[1] / "data"
A = Fraction(9, 10)

MODES = ReversibleSystem(
    name="modes",
    title="two oscillators that stiffen each other",
    state=("x", "y", "vx", "vy"),
    parameters={"a": ParameterRange(None, None)},
    vector_field=lambda s, p: (s[2], s[3], -p[0] * s[0] - s[0] * s[1] ** 2, -s[1] - s[0] ** 2 * s[1]),
    reversing_symmetry=(1, -1, -1, 1),
    section="y",
    symmetries={"S": (-1, 1, -1, 1)},
    first_integral=lambda s, p: (s[2] ** 2 + s[3] ** 2 + p[0] * s[0] ** 2 + s[1] ** 2 + s[0] ** 2 * s[1] ** 2,),
    first_integral_name="twice the energy",
    level_coordinate="vy",
)
"""x = 0, y = h^(1/2) sin t on the level h. Beside it x'' + (a + h/2 - (h/2) cos 2t) x = 0, an equation of Mathieu's:
R is lost where it has the odd solution x(0) = x(pi) = 0, S breaks where it has the even one x'(0) = x'(pi) = 0.
"""


@cache
def level_of(odd: bool, a: Fraction = A) -> Fraction:
    """h, from the expansions of Mathieu's functions in sin (2k + 1)t or cos (2k + 1)t, to 60 digits."""
    with mpmath.workdps(70):
        number = mpmath.mpf(a.numerator) / a.denominator

        def singular(q: Any) -> Any:
            """The determinant of the matrix with these entries on its diagonal and q beside it."""
            before, found = 0, mpmath.mpf(1)
            for k in range(16):
                entry = (2 * k + 1) ** 2 - number - 2 * q + (0 if k else -q if odd else q)
                before, found = found, entry * found - q * q * before
            return found

        h = 4 * mpmath.findroot(singular, (1 - number) / (3 if odd else 1))
        return Fraction(int(mpmath.nint(h * mpmath.mpf(2) ** 200)), 2**200)


def modes(**changes: Any) -> Candidate:
    """The claim that R is lost on the normal mode x = 0."""
    claim = Candidate(
        id="modes",
        system=MODES,
        parameters={"a": A},
        kind=REVERSOR_BREAKING,
        k=1,
        centre=(level_of(odd=True), Fraction(0)),
        frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))),
        kernel_frame=((Fraction(1),),),
        radii=(Fraction(1, 2**60),) * 2,
        level_sign=1,
    )
    return replace(claim, **changes)


def on_level(sign: int = 1) -> Candidate:
    """The same on a fixed level, where a is the parameter."""
    level = FixedLevel(level_of(odd=True).limit_denominator(10**40), sign)
    system = replace(MODES, name="modes-on-level", family_parameter="a", fixed_level=level)
    return modes(system=system, parameters={}, level_sign=None, centre=(A, Fraction(0)))


def later() -> Candidate:
    """Of a family whose half orbits meet the section twice: where P_q and B of P^2 vanish, found by Newton's method."""
    centre = (
        Fraction(0xE86975A602420AFEF16E09D0F57245DDD, 2**129),
        Fraction(0x2D7F763AC46FAE84C596AF0E1DFF45073, 2**130),
    )
    return modes(crossings=2, centre=centre)


ANGLE = ReversibleSystem(
    name="modes-of-angle",
    title="pendulum beside an oscillator",
    state=("x", "y", "vx", "vy", "s", "c"),
    parameters={"a": ParameterRange(None, None)},
    vector_field=lambda s, p: (
        s[2], s[3], -(p[0] + s[1] ** 2) * s[4], -s[1] - 2 * s[1] * (1 - s[5]), s[5] * s[2], -s[4] * s[2]
    ),
    reversing_symmetry=(1, -1, -1, 1, 1, 1),
    section="y",
    first_integral=lambda s, p: (s[2] ** 2 + s[3] ** 2 + 2 * (p[0] + s[1] ** 2) * (1 - s[5]) + s[1] ** 2,),
    first_integral_name="twice the energy",
    level_coordinate="vy",
    defined=(Defined("s", "sin", lambda s, p: (s[0],)), Defined("c", "cos", lambda s, p: (s[0],))),
)  # fmt: skip
"""With sin x and cos x in place of x and 1 - x^2/2: the same equation of Mathieu beside x = 0, other orbits off it."""


def halo() -> Candidate:
    """The claim about the halo orbits of L1 in the Earth-Moon system."""
    return candidate_from_json(json.loads((DATA / "loss-of-r.json").read_text(encoding="utf-8")), "loss-of-r.json")


def flow(state: Any, end: Any, angle: bool = False) -> Any:
    """A state of `MODES`, or `ANGLE`, at the next crossing of the section, or at a time, by DOP853."""

    def rates(_t: float, s: Any) -> list[Any]:
        if angle:
            return [s[2], s[3], -(float(A) + s[1] ** 2) * np.sin(s[0]), -s[1] - 2 * s[1] * (1 - np.cos(s[0]))]
        return [s[2], s[3], -float(A) * s[0] - s[0] * s[1] ** 2, -s[1] - s[0] ** 2 * s[1]]

    def crossed(t: float, s: Any) -> Any:
        return s[1] if t > 0.5 else 1.0

    crossed.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(rates, (0.0, end), state, method="DOP853", rtol=1e-13, atol=1e-15, events=crossed)
    return found.y[:, -1]


def halo_crossing(found: Any, along: tuple[float, float], size: float = 1e-4) -> list[float]:
    """By how much x and z where the orbit crosses the section next change with (vx, vz), on the level, by DOP853."""
    claim = halo()
    system, parameters = claim.system, [float(value) for value in claim.parameters.values()]
    x, z = (float(found.point[name].mid()) for name in ("x", "z"))

    def integral(vx: float, vy: float, vz: float) -> Any:
        assert system.first_integral is not None
        return system.first_integral((x, 0.0, z, vx, vy, vz), parameters)[0]

    def crossed(t: float, s: Any) -> Any:
        return s[1] if t > 0.1 else 1.0

    crossed.terminal = True  # type: ignore[attr-defined]
    ends = []
    for side in (size, -size):
        vx, vz = (side * value for value in along)
        rest, unit = integral(vx, 0.0, vz), integral(vx, 1.0, vz)
        vy = np.sign(float(found.point["vy"].mid())) * np.sqrt((float(found.parameter.mid()) - rest) / (unit - rest))
        path = solve_ivp(
            lambda _t, s: system.vector_field(s, parameters), (0.0, 10.0), [x, 0.0, z, vx, vy, vz],
            method="DOP853", rtol=1e-13, atol=1e-14, events=crossed,
        )  # fmt: skip
        ends.append(path.y[:, -1])
    return [float((ends[0][place] - ends[1][place]) / (2 * size)) for place in (0, 2)]


def level_beside(y: float, angle: bool = False) -> float:
    """The level of the orbit through x = y = 0 with vx = y that passes there again, which is not symmetric under R."""

    def miss(h: float) -> float:
        return float(flow([0.0, 0.0, y, np.sqrt(h - y * y)], 10.0, angle)[0])

    h = float(level_of(odd=True))
    return float(brentq(miss, 0.5 * h, 2.0 * h, xtol=1e-15))


def results_of(certificate: Certificate) -> BreakingResults:
    """What a certificate proves."""
    assert certificate.proved, certificate.reason
    assert isinstance(certificate.results, BreakingResults)
    return certificate.results
