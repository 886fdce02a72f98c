"""What is followed for a claim is the return to the crossing that it names: derivatives of a clock beside a spring.

x'' = -x and u'' = -c u from (x, u) at rest: the crossing of x' = 0 number m is at the time m pi. There u is
u cos(m pi c^(1/2)) + u' sin(m pi c^(1/2))/c^(1/2), and on the way back to Fix(R) twice as far along.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree

from orbitproof.shared.claims import COORDINATE, DOUBLE_RESONANCE, Candidate, Equation
from orbitproof.shared.formats import REVERSOR_BREAKING
from orbitproof.shared.systems import ParameterRange, ReversibleSystem
from orbitproof.verify.double_resonance import enclose_resonance
from orbitproof.verify.evidence import enclose
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import enclose_orbit
from orbitproof.verify.poincare import IntegratorSettings, enclose_half_return
from orbitproof.verify.reversor_breaking import enclose_breaking

CLOCK = ReversibleSystem(
    name="clock-and-spring",
    title="clock beside a spring",
    state=("x", "u", "vx", "vu"),
    parameters={"c": ParameterRange(None, None)},
    vector_field=lambda s, p: (s[2], s[3], -s[0], -p[0] * s[1]),
    reversing_symmetry=(1, 1, -1, -1),
    section="vx",
    first_integral=lambda s, p: (s[0] ** 2 + s[2] ** 2,),
    first_integral_name="energy of the clock",
    level_coordinate="x",
)
X, U, C = Fraction(3, 2), Fraction(1, 8), Fraction(9, 25)
SETTINGS = IntegratorSettings(96)


def claim(m: int, kind: str, **changes: Any) -> Candidate:
    size = len(changes.get("centre", (X, U)))
    unit = tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size))
    known: dict[str, Any] = {
        "id": "clock", "system": CLOCK, "parameters": {"c": C}, "kind": kind, "k": 1, "centre": (X, U), "frame": unit,
        "kernel_frame": ((Fraction(1),),), "radii": (Fraction(1, 2**30),) * size, "crossings": m,
    }  # fmt: skip
    return Candidate(**{**known, **changes})


@pytest.mark.parametrize("m", [1, 2, 3])
def test_all_kinds_of_claims_are_followed_to_their_crossing(m: int) -> None:
    orbit = enclose_orbit(claim(m, "orbit", equation=Equation(COORDINATE, U, "u")), SETTINGS, ORACLE)
    losing = enclose_breaking(
        claim(m, REVERSOR_BREAKING, centre=(X**2, U), level_sign=1), SETTINGS, ORACLE, alike=False
    )
    varied = {"parameters": {}, "centre": (C, X, U), "k": 4}
    resonance = enclose_resonance(claim(m, DOUBLE_RESONANCE, **varied), SETTINGS, ORACLE)
    half = enclose_half_return(claim(m, "orbit", equation=Equation(COORDINATE, U, "u")), SETTINGS, ORACLE)
    with ctx.workprec(96):
        root, (u, time) = enclose(C).sqrt(), (enclose(U), m * arb.pi())

        def at(number: int) -> tuple[arb, arb, arb]:
            """cos, sin/c^(1/2) and -c^(1/2) sin of the phase at a crossing."""
            phase = number * arb.pi() * root
            return phase.cos(), phase.sin() / root, -root * phase.sin()

        for found in (orbit, losing, resonance):
            assert len(found.iterates) == m
            zero = (0,) * len(next(iter(found.half_period.centre)))
            assert agree(found.half_period.centre[zero], time)
            for number, (kernel,) in enumerate(found.iterates, start=1):
                assert agree(kernel.centre[zero], u * at(number)[2])
                assert kernel.centre[zero].rad() < arb(2) ** -40
        cosine, sine, slope = at(m)
        assert agree(orbit.image[1].centre[0, 0], u * cosine)
        assert agree(orbit.image[0].centre[0, 0], (-1) ** m * enclose(X))
        assert agree(orbit.back[1][1], cosine)
        assert agree(orbit.back[0][0], arb((-1) ** m))
        assert orbit.back[1][1].rad() < arb(2) ** -10
        (image,) = losing.image
        assert agree(image.centre[0, 0, 0], u * cosine)
        assert agree(image.centre[0, 1, 0], cosine)
        assert agree(image.centre[0, 0, 1], sine)
        back = at(2 * m)[0]
        assert agree(resonance.image[1].centre[0, 0, 0], u * back)
        assert agree(resonance.image[1].centre[0, 0, 1], back)
        assert resonance.image[1].centre[0, 0, 0].rad() < arb(2) ** -40
        assert agree(resonance.image[0].centre[0, 0, 0], enclose(X))
        values = [row[0] for row in half.image]
        for value, wanted in zip(values, ((-1) ** m * enclose(X), u * cosine, u * slope), strict=True):
            assert agree(value, wanted)
            assert value.rad() < arb(2) ** -10
