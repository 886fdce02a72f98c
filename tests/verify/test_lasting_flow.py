"""The twist along a line of orbits of two oscillators, on their levels, from its closed form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import cos, sin, sqrt
from types import SimpleNamespace
from typing import Any, cast

import pytest
from flint import arb
from scipy.special import ellipk
from support.skew_products import energy, half_period

from orbitproof.shared.claims import Atlas, Claim, Piece
from orbitproof.shared.systems import FALKNER_SKAN, Defined, ReversibleSystem
from orbitproof.verify.algebra import Grading, WideArithmetic
from orbitproof.verify.atlas.conclusion import conclusion_of
from orbitproof.verify.curve import PieceLimits, prove_piece
from orbitproof.verify.evidence import Proved
from orbitproof.verify.functions import error_of, known_part
from orbitproof.verify.lasting import LastingResult, TwistFunctions, twist_of_piece
from orbitproof.verify.lasting.half_map import _around, _jet
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import STABILITY_SLOPE_BITS, TubeOfOrbits, stability_of_piece

STIFFNESS, HARDENING = Fraction(7, 2), Fraction(3, 2)
HALF_WIDTH = Fraction(1, 64)


def _field(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
    x, v, y, w = state
    return (v, -x - x * x * x, w, -STIFFNESS * y - HARDENING * y * y * y)


def _energy(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
    x, v, y, w = state
    squares = x * x, y * y
    first = v * v / 2 + squares[0] / 2 + squares[0] * squares[0] / 4
    return (first + w * w / 2 + STIFFNESS * squares[1] / 2 + HARDENING * squares[1] * squares[1] / 4,)


SYSTEM = ReversibleSystem(
    name="two-oscillators",
    title="two oscillators side by side",
    state=("x", "v", "y", "w"),
    parameters={},
    vector_field=_field,
    reversing_symmetry=(1, -1, 1, -1),
    section="v",
    first_integral=_energy,
    first_integral_name="energy",
)


def _pendula(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
    _, v, _, w, sine, cosine, beside, other = state
    return (v, -sine, w, -STIFFNESS * beside, cosine * v, -sine * v, other * w, -beside * w)


PENDULA = replace(
    SYSTEM,
    name="pendula",
    title="two pendula side by side",
    state=("x", "v", "y", "w", "sine", "cosine", "beside", "other"),
    vector_field=_pendula,
    reversing_symmetry=(1, -1, 1, -1, 1, 1, 1, 1),
    first_integral=lambda z, _: ((z[1] * z[1] + z[3] * z[3]) / 2 - z[5] - STIFFNESS * z[7],),
    defined=(
        Defined("sine", "sin", lambda z, _: (z[0],)),
        Defined("cosine", "cos", lambda z, _: (z[0],)),
        Defined("beside", "sin", lambda z, _: (z[2],)),
        Defined("other", "cos", lambda z, _: (z[2],)),
    ),
)
"""The sine of y is y - y^3/6 + .., a soft spring."""


@dataclass(frozen=True)
class Case:
    """Two oscillators, period and energy of the first one by its amplitude, and what makes the second one hard."""

    system: ReversibleSystem
    period: Callable[[float], float]
    energy: Callable[[float], float]
    hardening: float


CASES = {
    "springs": Case(SYSTEM, lambda a: 2 * half_period(a), energy, float(HARDENING)),
    "pendula": Case(PENDULA, lambda a: 4 * ellipk(sin(a / 2) ** 2), lambda a: 1 - cos(a), -float(STIFFNESS) / 6),
}


def theta(case: Case, amplitude: float) -> tuple[float, float]:
    """Theta and Theta' in the coordinates (y, w) of the level.

    The section is met again after the period T(E) of x, in which y turns by Omega(I) T(E), I its action. On the level
    of E + h(I) the angle has the derivative Omega' T - Omega T' Omega by I, and |w|^2 = 2 I.
    """
    frequency = sqrt(STIFFNESS)
    step = 1e-4
    period = case.period(amplitude)
    rise = case.period(amplitude + step) - case.period(amplitude - step)
    rise /= case.energy(amplitude + step) - case.energy(amplitude - step)
    bend = 3 * case.hardening / (4 * frequency**2)
    angle = frequency * period
    s, size = cos(angle), abs(sin(angle))
    turning = (bend * period - frequency * rise * frequency) / 2 * (1 if sin(angle) > 0 else -1)
    b, c = size / frequency, size * frequency
    factor = 64 * size**2 * (1 - s) * (1 + 2 * s) * turning
    return factor * c**3, factor * b**3


def along(case: Case, amplitude: Fraction) -> tuple[Piece, LastingResult]:
    """The orbits about this amplitude with the second oscillator at rest, with what is proved of them."""
    frame = ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)))
    piece = Piece(
        "line", "regular", (amplitude, Fraction(0)), frame, HALF_WIDTH, ((Fraction(0),),), (Fraction(1, 2**24),)
    )
    limits, ends = PieceLimits(64, 24, 8), (Fraction(-1), Fraction(1))
    found = prove_piece(case.system, {}, piece, ends, ORACLE, limits, slope_bits=STABILITY_SLOPE_BITS)
    assert isinstance(found.outcome, Proved)
    known = found.outcome.results
    coordinates = str(found.computation.coordinates)
    tube = TubeOfOrbits(case.system, {}, piece, (known.start, known.end), limits, coordinates, ORACLE)
    more = {"stability": stability_of_piece(tube, None, known.half_return)}
    more |= {"twist": twist_of_piece(tube, None, known.half_return)}
    return piece, LastingResult(**{**vars(found.stored), **more})


@pytest.mark.parametrize(
    ("name", "amplitude"), [("springs", Fraction(3, 4)), ("springs", Fraction(3, 2)), ("pendula", Fraction(3, 2))]
)
def test_the_twist_on_levels_is_that_of_the_closed_form(name: str, amplitude: Fraction) -> None:
    case = CASES[name]
    twist = along(case, amplitude)[1].twist
    assert isinstance(twist, TwistFunctions)
    for s in (-0.9, -0.3, 0.4, 0.95):
        tau = arb(s) * 32 / 33
        expected = theta(case, float(amplitude) + s * float(HALF_WIDTH))
        for function, value in zip((twist.twist, twist.exchanged), expected, strict=True):
            enclosed = function.enclosed.value(tau)
            assert abs(float(enclosed.mid()) - value) < float(enclosed.rad()) + 1e-5 * abs(value)
            assert float(enclosed.rad()) < 1e-2 * abs(value)


def test_at_1_3_without_a_quadratic_term_nothing_is_said_of_the_twist() -> None:
    """y -> -y makes the return map odd: Theta is 1 + 2 c_1 times a function that has no zero at c_1 = -1/2."""
    case, amplitude = CASES["springs"], Fraction(303, 512)
    ends = [cos(sqrt(STIFFNESS) * case.period(float(amplitude) + s * float(HALF_WIDTH))) for s in (-1, 1)]
    assert ends[0] < -0.5 < ends[1] or ends[1] < -0.5 < ends[0]
    piece, result = along(case, amplitude)
    atlas = Atlas("modes", "normal modes", case.system, {}, Claim("arc"), (piece,))
    conclusion = conclusion_of(atlas, [result], (), lambda _: (), 4)
    assert conclusion["verdict"] == "proved"
    lasting = conclusion["complete"]["lasting"]
    assert [(entry["kind"], entry["k"], entry["fate"]) for entry in lasting["exceptions"]] == [("resonance", 3, "open")]
    assert [entry["twist"] for entry in lasting["stable"]] == ["negative", "negative"]
    assert len(lasting["undecided"]) == len(lasting["gaps"]) == 1


def test_what_is_unknown_of_a_grade_is_unknown_of_its_coefficients() -> None:
    flow = WideArithmetic(Grading((1, 1), 3), 80, 20, 4, width=4)
    own = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=4)
    errors = [2.0**-20, 2.0**-22, 2.0**-24, 2.0**-26, 1.0]
    element = flow.polynomial({(1, 0): Fraction(1, 8), (0, 0): Fraction(1)}).with_errors(errors)
    width = Fraction(1, 4)
    jet = _jet(cast(Any, SimpleNamespace(arithmetic=own)), element, width)
    assert set(jet.coefficients) == set(flow.grading.monomials)
    for index, function in jet.coefficients.items():
        assert error_of(function) >= Fraction(errors[sum(index)]) / width ** sum(index)
    assert float(known_part(jet.coefficients[1, 0], 0)[0]) == 0.5


def test_points_beside_the_curve_hold_what_is_unknown_of_it() -> None:
    flow = WideArithmetic(Grading((1, 1), 3), 80, 20, 4, width=4)
    start = {name: flow.polynomial({(0, 0): Fraction(1, 2)}).widened(Fraction(1, 2**30)) for name in ("y", "beta")}
    curve = SimpleNamespace(value=lambda element: element)
    tube, half = SimpleNamespace(system=FALKNER_SKAN), SimpleNamespace(start=start)
    found = _around(cast(Any, tube), cast(Any, half), cast(Any, curve), flow, ["y"], Fraction(1, 2**10))
    for name in ("y", "beta"):
        assert found[name].errors[0] >= 2.0**-30
    assert found["x"].errors[0] == 0
    assert [sum(map(len, [p.coeffs()])) for p in found["beta"].coefs[1:]] == [0] * 9
