"""The twist along a line of orbits of two oscillators, on their levels, from its closed form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import zip_longest
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
from orbitproof.verify.branches.conclusion import conclusion_of
from orbitproof.verify.curve import PieceLimits, prove_piece
from orbitproof.verify.evidence import Proved
from orbitproof.verify.functions import error_of, known_part, norm_of
from orbitproof.verify.lasting import (
    CurveIntervalResult,
    FunctionJet,
    TwistFunctions,
    compose,
    half_map,
    twist_of_piece,
)
from orbitproof.verify.lasting.half_map import _around, _elements, _jet, _on_level
from orbitproof.verify.lasting.odd import odd_coordinate
from orbitproof.verify.lasting.stored import require_zero
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import TubeOfOrbits, sharpened, stability_of_piece, stability_slope_bits

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
    "known symmetry": Case(
        replace(SYSTEM, symmetries={"S": (1, 1, -1, -1)}), lambda a: 2 * half_period(a), energy, float(HARDENING)
    ),
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


def along(case: Case, amplitude: Fraction) -> tuple[Piece, CurveIntervalResult]:
    """The orbits about this amplitude with the second oscillator at rest, with what is proved of them."""
    frame = ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)))
    piece = Piece(
        "line", "regular", (amplitude, Fraction(0)), frame, HALF_WIDTH, ((Fraction(1, 2**30),),), (Fraction(1, 2**24),)
    )
    limits, ends = PieceLimits(64, 24, 8), (Fraction(-1), Fraction(1))
    slopes = stability_slope_bits(limits.precision)
    found = prove_piece(case.system, {}, piece, ends, ORACLE, limits, slope_bits=slopes)
    assert isinstance(found.outcome, Proved)
    known = found.outcome.results
    coordinates = str(found.computation.coordinates)
    tube = TubeOfOrbits(case.system, {}, piece, (known.start, known.end), limits, coordinates, ORACLE)
    closer, half = sharpened(tube, known.half_return)
    assert closer is not tube
    assert half is not None
    # The curve is known far better in the narrower tube, which lies in the first one.
    assert half.widths[0] < Fraction(1, 2**8) * known.half_return.widths[0]
    assert error_of(closer.curve(half).omega[0]) < Fraction(1, 2)
    polynomials = [row[0] for row in (closer.piece.polynomial, piece.polynomial)]
    apart = sum(abs(a - b) for a, b in zip_longest(*polynomials, fillvalue=Fraction(0)))
    assert apart > Fraction(1, 2**31)
    assert apart + closer.piece.tube[0] <= piece.tube[0]
    more = {"stability": stability_of_piece(closer, None, half), "twist": twist_of_piece(closer, None, half)}
    return piece, CurveIntervalResult(**{**vars(found.stored), **more})


@pytest.mark.parametrize(
    ("name", "amplitude"),
    [
        ("springs", Fraction(3, 4)),
        pytest.param("springs", Fraction(3, 2), marks=pytest.mark.slow),
        pytest.param("pendula", Fraction(3, 2), marks=pytest.mark.slow),
    ],
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


def test_at_1_3_orbits_that_a_symmetry_fixes_are_stable_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same orbits, where it is known that y -> -y makes the return map odd (29.7)."""

    def choose(_: Sequence[Any]) -> list[Fraction]:
        raise AssertionError("where a symmetry fixes the orbits no direction is chosen")

    monkeypatch.setattr(half_map, "_direction", choose)
    case, amplitude = CASES["known symmetry"], Fraction(303, 512)
    piece, result = along(case, amplitude)
    twist = result.twist
    assert isinstance(twist, TwistFunctions)
    assert twist.odd
    for s in (-0.9, 0.4, 0.95):
        place = float(amplitude) + s * float(HALF_WIDTH)
        without = 1 + 2 * cos(sqrt(STIFFNESS) * case.period(place))
        for function, value in zip((twist.twist, twist.exchanged), theta(case, place), strict=True):
            enclosed = function.enclosed.value(arb(s) * 32 / 33)
            assert abs(float(enclosed.mid()) - value / without) < float(enclosed.rad()) + 1e-4 * abs(value / without)
    atlas = Atlas("modes", "normal modes", case.system, {}, Claim("arc"), (piece,))
    lasting = conclusion_of(atlas, [result], (), lambda _: (), 4)["complete"]["lasting"]
    assert [(entry["k"], entry["fate"]) for entry in lasting["exceptions"]] == [(3, "stable")]
    assert [entry["twist"] for entry in lasting["stable"]] == ["negative", "negative"]
    assert lasting["undecided"] == lasting["gaps"] == []
    # Nothing is concluded from such functions where no symmetry is known, or none is shown to fix the orbits.
    for other in (replace(atlas, system=SYSTEM), replace(atlas, pieces=(off_the_line(piece),))):
        said = conclusion_of(other, [result], (), lambda _: (), 4)["complete"]["lasting"]
        assert not said["stable"]
        assert said["gaps"]
        assert {entry["fate"] for entry in said["exceptions"]} <= {"open"}


def off_the_line(piece: Piece) -> Piece:
    """A tube that does not reach y = 0 for certain."""
    return replace(piece, polynomial=((Fraction(1, 2**24),),))


def test_a_symmetry_fixes_orbits_only_if_that_is_shown() -> None:
    system = CASES["known symmetry"].system
    frame = ((Fraction(1), Fraction(1)), (Fraction(0), Fraction(-2)))
    polynomial = ((Fraction(1, 64), Fraction(-1, 64)),)
    piece = Piece("line", "regular", (Fraction(1), Fraction(0)), frame, HALF_WIDTH, polynomial, (Fraction(3, 64),))
    assert odd_coordinate(system, piece) == "y"
    for change in (
        {"polynomial": ((Fraction(1, 64), Fraction(-1, 32)),)},
        {"centre": (Fraction(1), Fraction(1, 2**60))},
        {"frame": ((Fraction(1), Fraction(1)), (Fraction(1, 2**60), Fraction(-2)))},
        {"frame": ((Fraction(1), Fraction(1)), (Fraction(0), Fraction(0)))},
        {"kind": "symmetric"},
    ):
        assert odd_coordinate(system, replace(piece, **change)) is None
    # One that leaves q alone, one that negates all, one that the field has not, and one that the integral has not.
    for signs in ((-1, -1, 1, 1), (-1, -1, -1, -1), (1, 1, -1, 1)):
        assert odd_coordinate(replace(system, symmetries={"S": signs}), piece) is None
    # Where all is negated, points with the first coordinate 0 are not fixed.
    other = replace(piece, centre=piece.centre[::-1], frame=frame[::-1])
    assert odd_coordinate(replace(system, symmetries={"S": (-1, -1, 1, -1)}), other) is None
    assert odd_coordinate(replace(system, symmetries={"S": (-1, -1, -1, -1)}), other) is None
    # One of the system that negates x, which is 0, and leaves q alone.
    assert odd_coordinate(replace(system, symmetries={"S": (-1, -1, 1, 1)}), other) is None
    uneven = replace(system, first_integral=lambda z, _: (_energy(z, _)[0] + z[2],))
    assert odd_coordinate(uneven, piece) is None
    turned = replace(system, first_integral=lambda z, _: (z[2] * _energy(z, _)[0],))
    assert odd_coordinate(turned, piece) is None
    bent = replace(system, vector_field=lambda z, _: (*_field(z, _)[:3], _field(z, _)[3] + z[2] * z[2]))
    assert odd_coordinate(bent, piece) is None
    with_functions = replace(PENDULA, symmetries={"S": (1, 1, -1, -1, 1, 1, -1, 1)})
    assert odd_coordinate(with_functions, piece) is None


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
    own = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=4)
    start = {name: own.constant(Fraction(1, 2)).widened(Fraction(1, 2**30)) for name in ("y", "beta")}
    curve = SimpleNamespace(value=lambda element: element)
    tube: Any = SimpleNamespace(
        system=FALKNER_SKAN, arithmetic=own, parameters={}, limits=PieceLimits(80, 20, 4)
    )  # fmt: skip
    points = _around(tube, cast(Any, SimpleNamespace(start=start)), cast(Any, curve), ["y"])
    found = _elements(tube, points, Fraction(1, 2**10))
    for name in ("y", "beta"):
        assert found[name].errors[0] >= 2.0**-30
    assert found["x"].errors[0] < 1e-300
    assert [len(p.coeffs()) for p in found["beta"].coefs[1:]] == [0] * 9
    assert [float(known_part(found[name], n)[0]) for name, n in (("y", 2), ("x", 1))] == [2.0**-10] * 2


def test_coefficients_of_points_bring_their_errors_to_their_grades() -> None:
    own = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=4)
    tube: Any = SimpleNamespace(system=FALKNER_SKAN, parameters={}, limits=PieceLimits(80, 20, 4))
    width = Fraction(1, 2**10)
    errors = {(0, 0): 2**-20, (0, 1): 2**-22, (1, 0): 2**-23, (1, 1): 2**-24, (3, 0): 2**-26, (0, 3): 2**-27}
    jet = FunctionJet({index: own.constant(Fraction(1, 3)).widened(Fraction(e)) for index, e in errors.items()})
    element = _elements(tube, {"y": jet}, width)["y"]
    for grade in range(4):
        assert element.errors[grade] >= sum(e * 2.0 ** (-10 * grade) for i, e in errors.items() if sum(i) == grade)
    for index in errors:
        known = float(known_part(element, element.arithmetic.grading.index[index])[0])
        assert known * 2 ** (10 * sum(index)) == pytest.approx(1 / 3, rel=1e-5)


@pytest.mark.parametrize("bend", [Fraction(0), Fraction(1, 3)])
def test_points_on_levels_keep_the_first_integral_up_to_order_3(bend: Fraction) -> None:
    """Of K = 2 p_1 + p_2 + p_1^2 + bend p_1 q^2 + p_2^3 about the origin."""
    own = WideArithmetic(Grading((1,), 0), 160, 0, 0, width=4)
    terms = {(1, 0, 0): 2, (0, 1, 0): 1, (2, 0, 0): 1, (1, 0, 2): bend, (0, 3, 0): 1}
    indices = [(i, j, k) for i in range(4) for j in range(4) for k in range(4) if i + j + k <= 3]
    level = FunctionJet({index: own.constant(Fraction(terms.get(index, 0))) for index in indices})
    units = {"a": (1, 0, 0), "b": (0, 1, 0), "q": (0, 0, 1)}
    points = {name: FunctionJet({unit: own.constant(Fraction(1))}) for name, unit in units.items()}
    points["a"] = points["a"] + FunctionJet({(0, 0, 0): own.constant(Fraction(5))})
    found = _on_level(cast(Any, SimpleNamespace(arithmetic=own)), level, points)
    assert float(known_part(found["a"].coefficients[0, 0], 0)[0]) == 5
    held = compose(level, [found[name].of_degrees(1) for name in units])
    for index, value in held.coefficients.items():
        assert float(norm_of(value)) < 1e-30, index
    # Every point of the level is hit: the derivative of (p, q) on it is regular.
    slopes = [float((known_part(found[name].coefficients[1, 0], 0) or [0])[0]) for name in ("a", "b")]
    assert abs(2 * slopes[0] + slopes[1]) < 1e-30
    assert max(map(abs, slopes)) > 0.4
    assert float(known_part(found["q"].coefficients[0, 1], 0)[0]) == 1


def test_what_reversibility_makes_zero_is_zero_or_nothing_is_stored() -> None:
    own = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=4)
    small = own.polynomial({(0,): [Fraction(1, 2**30), Fraction(-1, 2**31)]})
    require_zero(small.widened(Fraction(3, 2**31)))
    require_zero(own.constant(Fraction(0)))
    for radius in (Fraction(5, 2**32), Fraction(0)):
        with pytest.raises(ArithmeticError, match="reversibility"):
            require_zero(small.widened(radius))
