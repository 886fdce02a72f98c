"""sin, cos, exp and log in reversible systems: closed forms, another integrator, false symmetries."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import cos, exp, log, sin
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import mpmath
import numpy as np
import pytest
from flint import arb, fmpz_poly
from scipy.integrate import solve_ivp
from support.balls import agree
from support.exact_elements import number
from support.within import within

from orbitproof.shared import define_system
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, Atlas, Candidate, Equation
from orbitproof.shared.systems import (
    DescriptionError,
    ReversibleSystem,
    completed,
    describe,
    described,
    evaluate_formula,
    has_parities,
    record,
    signs_with_functions,
)
from orbitproof.verify.__main__ import main as verify_main
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.branches.certified import certified_point
from orbitproof.verify.certificate import Certificate, Level, Limits, certify, digest, recheck
from orbitproof.verify.claim import check_symmetries, parities, point_on_fixed_set, quadratic_coefficient
from orbitproof.verify.claim.functions import keeps_its_functions
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    IntegrationFailure,
    NotEstablishedError,
    ball_from_json,
    bounds,
    enclose,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import OrbitResults
from orbitproof.verify.poincare import IntegratorSettings, at_start, enclose_iterates, initial_values
from orbitproof.verify.poincare.functions import function_of
from orbitproof.verify.stability.level import gradient
from orbitproof.verify.words.formulas import setting
from orbitproof.verify.words.lasting import _where

SWING: dict[str, Any] = {
    "name": "swing", "title": "Pendulum beside a spring", "state": "x y vx vy", "parameters": "w",
    "field": {"x": "vx", "y": "vy", "vx": "-sin(x)", "vy": "-w*y"},
    "R": {"x": -1, "y": -1}, "symmetries": {"S": {"y": -1, "vy": -1}}, "section": "x",
    "first_integral": "(vx**2 + vy**2)/2 - cos(x) + w*y**2/2", "first_integral_name": "energy",
    "level_coordinate": "vx",
}  # fmt: skip
"""x from 0 with vx = a comes back after the time T(a) = 2 K, K of the modulus a/2; y = vy sin(t w^(1/2))/w^(1/2)."""

MIXED: dict[str, Any] = {
    "name": "mixed", "state": "x y z", "parameters": "c", "where": {"r": "exp(-x**2/4)"},
    "field": {
        "x": "y*cos(x*z/4)", "y": "z*r + x*z**2*log(2 + y + x**2)/9", "z": "sin(c)**2 - sin(y) - x**2/2 - y*exp(c*r)/3"
    },
    "R": {"x": -1, "z": -1}, "section": "x", "family_parameter": "c",
}  # fmt: skip
BITS = 128

precision = within(lambda: mpmath.workprec(200))


def exactly(value: Any) -> Fraction:
    return Fraction(int(mpmath.floor(mpmath.ldexp(value, 160))), 2**160)


def holds(ball: arb, value: Any) -> bool:
    low, high = bounds(ball)
    return bool(low - Fraction(1, 2**140) <= exactly(value) <= high + Fraction(1, 2**140))


def half(a: Any) -> Any:
    """T(a)."""
    return 2 * mpmath.ellipk(a * a / 4)


def swing(start: Mapping[str, Fraction], equation: Equation, radius: Fraction = Fraction(1, 10**6)) -> Candidate:
    system = described(SWING)
    assert isinstance(system, ReversibleSystem)
    return Candidate(
        id="swing", system=system, parameters={"w": Fraction(1, 2)}, kind="orbit", k=1,
        centre=(start["vx"], start["vy"]), frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))),
        kernel_frame=((Fraction(1),),), radii=(radius, radius), crossings=1, equation=equation,
    )  # fmt: skip


@cache
def swings(name: str) -> tuple[Any, Any, Certificate]:
    """vx and vy of an orbit, and what is proved of it."""
    with mpmath.workprec(200):
        if name == "pendulum":
            a, vy = mpmath.mpf(3) / 2, mpmath.mpf(0)
            equation = Equation(COORDINATE, Fraction(3, 2), "vx")
        else:
            # The spring turns by pi in half a period of the pendulum.
            time = mpmath.pi * mpmath.sqrt(2)
            a, vy = mpmath.findroot(lambda value: half(value) - time, 1.7), mpmath.mpf(1) / 3
            equation = Equation(COORDINATE, Fraction(1, 3), "vy")
        off = Fraction(1, 10**8)
        candidate = swing({"vx": exactly(a) + off, "vy": exactly(vy) - off}, equation)
        return a, vy, certify(candidate, Limits(digits=12))


@pytest.mark.parametrize("name", ["pendulum", "both"])
def test_orbits_of_a_pendulum_are_those_of_the_elliptic_functions(name: str) -> None:
    a, vy, certificate = swings(name)
    assert certificate.proved, certificate.reason
    orbit = certificate.orbit
    assert isinstance(orbit, OrbitResults)
    time = half(a)
    turned = mpmath.cos(time / mpmath.sqrt(2))
    assert set(orbit.point) == {"vx", "vy"}
    assert holds(orbit.point["vx"], a)
    assert holds(orbit.point["vy"], vy)
    assert holds(orbit.other_point["vx"], -a)
    assert holds(orbit.other_point["vy"], vy * turned)
    assert holds(orbit.half_period, time)
    assert float(orbit.half_period.rad()) < 1e-12
    assert orbit.level is not None
    assert holds(orbit.level, a**2 / 2 + vy**2 / 2 - 1)
    (parameter,) = orbit.stability.parameters
    assert holds(parameter.real, mpmath.cos(time * mpmath.sqrt(2)) if name == "pendulum" else mpmath.mpf(1))


def test_the_twist_of_a_pendulum_beside_a_spring_is_that_of_the_elliptic_functions() -> None:
    """The spring turns by 2 T w^(1/2) in a period 2 T of the pendulum, which has the energy that the spring has not."""
    a, w = mpmath.mpf(3) / 2, mpmath.mpf(1) / 2
    claim = swing({"vx": Fraction(3, 2), "vy": Fraction(0)}, Equation(COORDINATE, Fraction(3, 2), "vx"))
    found = certify(replace(claim, kind="stable_orbit"), Limits(digits=8))
    assert found.proved, found.reason
    results = found.to_json()["results"]
    assert holds(ball_from_json(results["rotation_number"]), 1 - mpmath.sqrt(w) * half(a) / mpmath.pi)
    assert holds(ball_from_json(results["twist"]), w * mpmath.diff(half, a) / a)
    assert "system with exactly the coordinates x, y, vx, vy:" in found.to_json()["statement"]["theorem"]


def test_distances_go_through_the_functions() -> None:
    """The square of a chord, 2 - 2 cos x, and 1: from x = 0 up to cos x = 1 - a^2/2."""
    system = described(entry(squared_distance="3 - 2*cos(x)", distance_name="the pivot"))
    claim = swing({"vx": Fraction(3, 2), "vy": Fraction(0)}, Equation(COORDINATE, Fraction(3, 2), "vx"))
    found = certify(replace(claim, system=system, radii=(Fraction(1, 10**15),) * 2), Limits(digits=12))
    assert found.proved, found.reason
    results = found.to_json()["results"]
    assert holds(ball_from_json(results["least_distance"]["distance"]), mpmath.mpf(1))
    assert holds(ball_from_json(results["greatest_distance"]["distance"]), mpmath.sqrt(mpmath.mpf(13)) / 2)


def test_a_wrong_period_of_a_pendulum_is_not_proved() -> None:
    equation = Equation(HALF_PERIOD, exactly(half(mpmath.mpf(3) / 2)) + Fraction(1, 10**4))
    certificate = certify(swing({"vx": Fraction(3, 2), "vy": Fraction(0)}, equation), Limits(digits=12))
    assert not certificate.proved


STATED: dict[str, Callable[[list[dict[str, str]]], object]] = {
    "another coordinate": lambda f: f[0].update(coordinate="cos_x"),
    "other inputs": lambda f: f[0].update(argument=f[0]["argument"].replace("= y", "= u").replace("= x", "= y")),
    "another order": lambda f: f.reverse(),
    "too many": lambda f: f.extend(4 * f),
    "another function": lambda f: f[0].update(function="cos"),
    "another argument": lambda f: f[0].update(argument=f[0]["argument"].replace("return v0", "return v1")),
    "none": lambda f: f.clear(),
}


@pytest.mark.parametrize("what", ["", *STATED])
def test_a_system_that_is_stated_by_name_has_the_functions_that_are_stated(what: str) -> None:
    document = copy.deepcopy(swings("pendulum")[2].to_json())
    document["statement"]["candidate"]["system"] = "swing"
    if what:
        STATED[what](document["statement"]["functions"])
    if what == "none":
        del document["statement"]["functions"]
    found = recheck(Certificate.from_json({**document, "digest": digest(document)}))
    assert (found.level is Level.CONCLUSION) == (not what)
    if what in list(STATED)[:4]:
        assert "statement.functions: are not the last" in found.why


def mixed(state: Sequence[float], c: float) -> list[float]:
    x, y, z = state
    r = exp(-(x**2) / 4)
    return [
        y * cos(x * z / 4),
        z * r + x * z**2 * log(2 + y + x**2) / 9,
        sin(c) ** 2 - sin(y) - x**2 / 2 - y * exp(c * r) / 3,
    ]


def first_return(c: float, y: float) -> np.ndarray:
    """The state at the first crossing of x = 0, from (0, y, 0)."""

    def height(_time: float, state: Any) -> float:
        return float(state[0])

    height.terminal = 2  # type: ignore[attr-defined]
    found = solve_ivp(lambda _, s: mixed(s, c), (0, 60), [0.0, y, 0.0], "DOP853", events=height, rtol=3e-14, atol=1e-15)
    return np.array(found.y_events[0][1])


def test_derivatives_of_returns_go_through_the_functions_at_the_start() -> None:
    """In the coordinate and the parameter that the functions depend on, against differences of another integration."""
    system = described(MIXED)
    assert system.given_state == ("x", "y", "z")
    assert system.centre_coordinates == ("c", "y")
    one = Fraction(1)
    radius = Fraction(1, 500)
    candidate = Candidate(
        id="mixed", system=system, parameters={}, kind="period_tupling", k=2, centre=(Fraction(1, 2), Fraction(3, 5)),
        frame=((one, Fraction(0)), (Fraction(0), one)), kernel_frame=((one,),), radii=(radius**2, radius),
    )  # fmt: skip
    ((table,), _) = enclose_iterates(candidate, IntegratorSettings(BITS), ORACLE).iterates
    assert isinstance(table, DerivativeTable)
    c, y, step = 0.5, 0.6, 1e-3

    def q(i: float, j: float) -> float:
        return float(first_return(c + i * step, y + j * step)[2])

    expected = {
        (0, 0): (q(0, 0), 1e-11),
        (1, 0): ((8 * (q(1, 0) - q(-1, 0)) - (q(2, 0) - q(-2, 0))) / (12 * step), 1e-7),
        (0, 1): ((8 * (q(0, 1) - q(0, -1)) - (q(0, 2) - q(0, -2))) / (12 * step), 1e-7),
        (1, 1): ((q(1, 1) - q(1, -1) - q(-1, 1) + q(-1, -1)) / (4 * step**2), 1e-3),
        (0, 2): ((q(0, 1) - 2 * q(0, 0) + q(0, -1)) / step**2, 1e-3),
    }
    for index, (value, accuracy) in expected.items():
        ball = table.centre[index]
        assert float(ball.rad()) < accuracy
        assert abs(float(ball.mid()) - value) < accuracy * (1 + abs(value)), index
    source = random.Random(2)
    value = table.box[(0, 0)]
    for _ in range(5):
        u, v = source.uniform(-1, 1), source.uniform(-1, 1)
        there = float(first_return(c + u * float(radius) ** 2, y + v * float(radius))[2])
        assert agree(value, arb(there, 1e-11))


def test_initial_values_are_the_functions_of_the_others() -> None:
    system = described(MIXED)
    arithmetic = WideArithmetic(Grading((1,), 1), 90, 0, 4, width=12)
    point = {
        "c": arithmetic.polynomial({(0,): [Fraction(1, 2), Fraction(1, 8)]}),
        "y": arithmetic.polynomial(
            {(0,): [Fraction(1, 3), Fraction(-1, 10), Fraction(1, 20)], (1,): [Fraction(1, 100)]}
        ),
    }
    values = initial_values(system, arithmetic, point)
    source = random.Random(1)
    for _ in range(30):
        s, xi = Fraction(source.randint(-64, 64), 64), Fraction(source.randint(-64, 64), 64)
        c = Fraction(1, 2) + s / 8
        y = Fraction(1, 3) - s / 10 + s**2 / 20 + xi / 100
        exact = completed(system, [0.0, float(y), 0.0, *[0.0] * len(system.defined)], [float(c)])
        for element, expected in zip(values, [*exact, float(c)], strict=True):
            near = wide_value(element, s, xi)
            assert float(near.rad()) < 1e-4
            assert abs(float(near.mid()) - expected) <= float(near.rad()) + 1e-14


def wide_value(element: Series, s: Fraction, xi: Fraction) -> arb:
    """At a point of the polydisc, of an element of one variable and the wide one that does not depend on time."""
    total = arb(0)
    for exponents, scale, polynomial in zip(
        element.arithmetic.grading.monomials, element.arithmetic.scales, element.coefs, strict=True
    ):
        row = sum((enclose(Fraction(int(v), 2**scale) * s**n) for n, v in enumerate(polynomial.coeffs())), arb(0))
        total += row * enclose(xi ** exponents[0])
    return total + arb(0, sum(element.errors))


@pytest.mark.parametrize("name", ["sin", "cos", "exp", "log"])
def test_functions_of_wide_elements_contain_the_functions_of_their_values(name: str) -> None:
    source = random.Random(name)
    for _ in range(40):
        arithmetic = WideArithmetic(Grading((1,), source.choice((0, 1, 2))), 90, 0, 4, width=source.choice((3, 16)))
        size = Fraction(source.choice((1, 10, 40)), 200)
        powers = [Fraction(source.randint(4, 12), 10), *(size * source.randint(-9, 9) / 10**n for n in (1, 2, 3))]
        unknown = Fraction(source.choice((0, 1)), 2**30)
        terms = {(0,): powers, (1,): [Fraction(source.randint(-9, 9), 1000)]}
        element = arithmetic.polynomial(terms).widened(unknown)
        found = function_of(name, element)
        for _ in range(25):
            s, xi = Fraction(source.randint(-64, 64), 64), Fraction(source.randint(-64, 64), 64)
            argument = sum(value * s**n for n, value in enumerate(powers)) + terms[(1,)][0] * xi
            argument += unknown * source.choice((-1, 0, 1))
            exact = getattr(mpmath, name)(number(argument))
            near = wide_value(found, s, xi)
            middle, radius = near.mid(), near.rad()
            assert abs(exact - mpmath.mpf(str(middle.str(50, radius=False)))) <= float(radius) + mpmath.mpf(10) ** -40
            if arithmetic.width == 16 and arithmetic.grading.top == 2 and not unknown:
                assert float(radius) < 1e-4


def test_initial_values_that_depend_on_time_are_refused() -> None:
    arithmetic = WideArithmetic(Grading((1,), 0), 90, 0, 4, width=1)
    program = record(lambda s: (s[0] * s[0],), ("x",))
    still = arithmetic.constant(Fraction(1, 2))
    assert at_start(program, [still])[0].coefs == arithmetic.constant(Fraction(1, 4)).coefs
    moving = Series(arithmetic, [fmpz_poly([*still.coefs[0].coeffs(), *[0] * arithmetic.stride, 1])], still.errors)
    with pytest.raises(ValueError, match="depends on time"):
        at_start(program, [moving])


def test_a_function_of_too_wide_an_element_is_not_enclosed() -> None:
    arithmetic = WideArithmetic(Grading((1,), 0), 90, 0, 4, width=4)
    with pytest.raises(IntegrationFailure, match="not enclosed"):
        function_of("sin", arithmetic.polynomial({(0,): [Fraction(1), Fraction(3, 5)]}))


FALSE: dict[str, Any] = {
    "name": "false", "state": "x y vx vy", "field": {"x": "vx", "y": "vy", "vx": "cos(x)", "vy": "-y"},
    "R": {"y": -1, "vx": -1}, "section": "y", "first_integral": "vx**2/2 + vy**2/2 - sin(x) + y**2/2",
}  # fmt: skip


def test_signs_that_lead_away_from_the_functions_are_no_symmetry() -> None:
    """x -> -x, sin -> sin, cos -> -cos reverses the field in plain arithmetic, and no field with sin and cos."""
    system = described(FALSE)
    names = dict(zip(system.state, system.reversing_symmetry, strict=True))
    assert [names[n] for n in ("x", "sin_x", "cos_x")] == [1, -1, 1] if names["x"] < 0 else [1, 1, 1]
    signs = {"x": -1, "y": -1, "vx": 1, "vy": 1, "sin_x": 1, "cos_x": -1}
    forged = replace(system, reversing_symmetry=tuple(signs[name] for name in system.state))
    # The program alone does not show that anything is wrong.
    assert parities(forged.program, forged.reversing_symmetry) == [-sign for sign in forged.reversing_symmetry]
    with pytest.raises(NotEstablishedError, match="functions of others"):
        check_symmetries(Checklist(), forged)
    # So does (x, vx) -> -(x, vx), sin -> sin, cos -> -cos commute with it.
    signs = {"x": -1, "y": 1, "vx": -1, "vy": 1, "sin_x": 1, "cos_x": -1}
    commuting = tuple(signs[name] for name in system.state)
    assert parities(system.program, commuting) == list(commuting)
    with pytest.raises(NotEstablishedError, match="symmetry S"):
        check_symmetries(Checklist(), replace(system, symmetries={"S": commuting}), "S")
    check_symmetries(Checklist(), described(SWING), "S")


def test_coordinates_that_do_not_move_as_their_functions_are_refused() -> None:
    system = described(SWING)
    assert keeps_its_functions(system)
    assert all(map(keeps_its_functions, (described(MIXED), described(FALSE))))
    program, size = system.program, len(system.state)
    names = (*system.state, *system.parameters)

    def with_rates(**rates: str) -> ReversibleSystem:
        """The same with other rates of coordinates."""

        def changed(state: Sequence[Any], parameters: Sequence[Any]) -> list[Any]:
            values = system.vector_field(state, parameters)
            known = dict(zip(names, [*state, *parameters], strict=True))
            return [
                evaluate_formula(rates[name], known) if name in rates else value
                for name, value in zip(system.state, values, strict=True)
            ]

        return replace(system, vector_field=changed)

    assert len(program.outputs) == size
    assert keeps_its_functions(with_rates(sin_x="vx*cos_x", cos_x="-(sin_x*vx)"))
    for rates in ({"sin_x": "-cos_x*vx"}, {"cos_x": "sin_x*vx"}, {"sin_x": "x*vx"}, {"sin_x": "vx"}):
        forged = with_rates(**rates)
        assert not keeps_its_functions(forged)
        with pytest.raises(NotEstablishedError, match=r"stay functions of the others|have the symmetry R"):
            check_symmetries(Checklist(), forged)
    sine, cosine = system.defined
    assert not keeps_its_functions(replace(system, defined=(sine, replace(cosine, argument=lambda s, p: (2 * s[0],)))))
    assert not keeps_its_functions(replace(system, defined=(sine, replace(cosine, function="exp"))))
    # A sine without a cosine, which moves as an exponential does.
    alone = with_rates(sin_x="sin_x*vx", cos_x="cos_x*vx")
    assert not keeps_its_functions(replace(alone, defined=(sine, replace(cosine, function="exp"))))
    assert keeps_its_functions(replace(alone, defined=tuple(replace(each, function="exp") for each in system.defined)))
    # An argument has earlier coordinates only.
    both = tuple(replace(each, argument=lambda s, p: (s[0] + 0 * s[5],)) for each in (sine, cosine))
    assert not keeps_its_functions(replace(system, defined=both))
    grows = described({
        "name": "grows", "state": "x y z", "parameters": "c", "R": {"x": -1, "z": -1}, "section": "x",
        "field": {"x": "y + exp(z**2)", "y": "z*log(2 + z**2)", "z": "c - x**2"}, "family_parameter": "c",
    })  # fmt: skip
    assert keeps_its_functions(grows)
    twice = [replace(each, argument=lambda s, p: (2 * s[2] ** 2,)) for each in grows.defined]
    for place in range(2):
        defined = [twice[i] if i == place else each for i, each in enumerate(grows.defined)]
        assert not keeps_its_functions(replace(grows, defined=tuple(defined)))


@pytest.mark.parametrize(
    "argument", ["x*x - vx", "vx - vy*vx", "2 - vx", "1/(3 + vx)", "vx/(3 + vy)", "-vx", "(vx + 1)**3", "exp(-vx)*vy"]
)
@pytest.mark.parametrize("function", ["exp({})", "log(5 + {})", "sin(x*({}))"])
def test_rates_of_functions_are_shown_for_all_kinds_of_arguments(argument: str, function: str) -> None:
    call = function.format(f"({argument})")
    field = {**SWING["field"], "vx": f"-x*{call}" if function[:3] != "sin" else f"-{call}"}
    assert keeps_its_functions(described(entry(field=field)))


ODD = ("2*x", "x/3", "x*w", "x/w", "x*(1 + vx)", "x/(2 + vx)", "sqrt(2 + vx)*x", "3*x - 2*y", "x*exp(vx) + w*y")
EVEN = ("2*vx", "5 + vx", "5 - vx", "1/vx", "w", "2 - w*x**2", "1 + x*sin(x)", "2*cos(x)", "sqrt(1 + x**2)", "x*y")


@pytest.mark.parametrize("call", [*(f"sin({e})" for e in ODD), *(f"x*exp({e})" for e in EVEN), "x*log(w)", "x*cos(w)"])
def test_r_is_seen_to_reverse_fields_with_functions_of_numbers_and_parameters(call: str) -> None:
    """What does not move adds no 0 to rates, of which no parity is known."""
    system = described({
        "name": "turned", "state": "x y vx", "parameters": "w", "R": {"x": -1, "y": -1}, "section": "x",
        "field": {"x": "vx", "y": "vx + cos(x)", "vx": f"-{call}"}, "family_parameter": "w",
    })  # fmt: skip
    check_symmetries(Checklist(), system)


def test_mixed_has_its_symmetry() -> None:
    check_symmetries(Checklist(), described(MIXED))


def test_only_what_is_zero_is_both_even_and_odd() -> None:
    program = record(lambda s: (Fraction(0), Fraction(2), s[0], 0 * s[0], s[0] * s[0]), ("x",))
    for wanted, holds in (((1, 1, -1, -1, 1), True), ((-1, 1, -1, -1, 1), True), ((1, -1, -1, -1, 1), False),
                          ((1, 1, 1, -1, 1), False), ((1, 1, -1, 1, 1), False), ((1, 1, -1, -1), False)):  # fmt: skip
        assert has_parities(program, (-1,), wanted) == holds


def test_other_functions_than_four_are_refused() -> None:
    written = describe(described(SWING))
    assert isinstance(written, dict)
    first, *rest = written["defined"]
    with pytest.raises(DescriptionError, match="each one of sin, cos, exp, log"):
        described({**written, "defined": [[first[0], "tan", first[2]], *rest]})


@pytest.mark.parametrize(
    ("formula", "words"),
    [
        ("-x*exp(sqrt(2))", r"field: a root of a number in 'sqrt\(2\)' is not exact; make it a parameter"),
        ("-sin(q)", r"where.q: a root of a number in 'x\*sqrt\(2\)' is not exact"),
        ("-x*exp(tan(vx))", r"field: 'tan\(vx\)' is not allowed in a formula; write sin\(u\)/cos\(u\)$"),
    ],
)
def test_what_is_wrong_with_an_argument_is_said_of_the_formula(formula: str, words: str) -> None:
    with pytest.raises(DescriptionError, match=f"^{words}"):
        described(
            entry(field={**SWING["field"], "vx": formula}, where={"q": "x*sqrt(2)"} if "q" in formula[5:7] else {})
        )


def test_a_level_coordinate_is_followed_by_its_functions() -> None:
    level = {"value": "1/10", "sign": -1}
    system = described(entry(
        family_parameter="w", fixed_level=level, field={**SWING["field"], "vy": "-w*y + y*(cos(vx) - 1)*0"}
    ))  # fmt: skip
    arithmetic = WideArithmetic(Grading((1,), 0), 90, 0, 4, width=1)
    point = {"w": arithmetic.constant(Fraction(2)), "vy": arithmetic.constant(Fraction(1, 4))}
    values = [wide_value(each, Fraction(0), Fraction(0)) for each in initial_values(system, arithmetic, point)]
    found = dict(zip(system.state, (float(each.mid()) for each in values), strict=False))
    assert found["vx"] == pytest.approx(-((2 * (1.1 - 1 / 32)) ** 0.5))
    assert found["cos_vx"] == pytest.approx(cos(found["vx"]))
    there = completed(system, [0.0, 0.0, 0.0, 0.25, *[0.0] * len(system.defined)], [2.0])
    assert there == pytest.approx([found[name] for name in system.state])


def test_parities_of_functions() -> None:
    functions = (lambda s: (s[0] * s[0],), lambda s: (s[0],), lambda s: (s[0] + s[1],))
    even, odd, neither = (record(each, ("x", "y", "w")) for each in functions)
    for function, expected in (("sin", (1, -1, 0)), ("cos", (1, 1, 0)), ("exp", (1, 0, 0)), ("log", (1, 0, 0))):
        found = [signs_with_functions([function], [each], (-1, 1))[-1] for each in (even, odd, neither)]
        assert tuple(found) == expected


def entry(**changes: Any) -> dict[str, Any]:
    return {**SWING, "name": "changed", "symmetries": {}, **changes}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"field": {**SWING["field"], "vy": "-w*y*exp(x)"}}, "R: exp_x .* neither stays"),
        ({"field": {**SWING["field"], "vy": "-w*y*log(2 + x)"}}, "R: log_1 .* neither stays"),
        ({"field": {**SWING["field"], "vy": "-w*sin(y + vx)"}}, r"R: sin_1 .*write sin\(a \+ b\)"),
        ({"symmetries": {"T": {"vx": -1, "x": -1}}, "field": {**SWING["field"], "vx": "-sin(x)*exp(y*x)"}},
         "symmetries.T: exp_1 .*"),
        ({"section": "sin_x"}, "section: 'sin_x' is a function of others; there are x, y, vx, vy"),
        ({"level_coordinate": "cos_x"}, "level_coordinate"),
        ({"R": {"x": -1, "y": -1, "sin_x": -1}}, "R.sin_x: no state coordinate"),
        ({"R": {"x": -1}}, "R fixes 3 coordinates and negates 1"),
    ],
)  # fmt: skip
def test_descriptions_with_functions_that_cannot_be_are_refused(changes: Mapping[str, Any], words: str) -> None:
    with pytest.raises(DescriptionError, match=words):
        described(entry(**changes))


@pytest.mark.parametrize(
    ("integral", "is_quadratic"),
    [
        ("(vx**2 + vy**2)/2 - cos(x) + w*y**2/2", True),
        ("(vx**2 + vy**2)/2 - cos(x) + w*y**2/2 + sin(vy)", True),
        ("(vx**2 + vy**2)/2 - cos(x) + w*y**2/2 + cos(vx)", False),
        ("(vx**2 + vy**2)/2 - cos(x) + w*y**2/2 + exp(sin(x)**2*cos(vx))*0", True),
        ("(vx**2 + vy**2)/2 - cos(x) + w*y**2/2 + exp(sin(vx)**2)", False),
    ],
)
def test_a_level_coordinate_is_in_no_function(integral: str, is_quadratic: bool) -> None:
    system = described(entry(first_integral=integral))
    # What is multiplied by 0 is there all the same.
    assert bool(quadratic_coefficient(system)) == (is_quadratic and "*0" not in integral)


def test_a_point_of_the_level_has_the_functions_of_its_coordinates() -> None:
    system = described(entry(first_integral="(vx**2 + vy**2)/2 - cos(x) + w*y**2/2 + sin(vy)"))
    one = Fraction(1)
    candidate = Candidate(
        id="level", system=system, parameters={"w": one}, kind="period_tupling", k=2, level_sign=-1,
        centre=(one, one), frame=((one, Fraction(0)), (Fraction(0), one)), kernel_frame=((one,),), radii=(one, one),
    )  # fmt: skip
    point = point_on_fixed_set(candidate, {candidate.coordinates[0]: arb(1), "vy": arb("0.3")})
    expected = -mpmath.sqrt(2 * (2 - mpmath.mpf("0.3") ** 2 / 2 - mpmath.sin(mpmath.mpf("0.3"))))
    assert abs(float(point["vx"].mid()) - float(expected)) < 1e-14


def test_derivatives_of_the_first_integral_go_through_the_functions() -> None:
    system = described(entry(first_integral="(vx**2 + vy**2)/2 - cos(x) + w*y**2/2 + sin(vy)*exp(vx*vx) + log(2 + vy)"))
    program = system.first_integral_program
    assert program is not None
    at = {"vx": 0.4, "vy": 0.3, "w": 2.0}
    arguments = [arb(at.get(name, 0.0)) for name in program.inputs]
    found = gradient(program, arguments, ("vx", "vy"), system)
    expected = [
        0.4 + sin(0.3) * 2 * 0.4 * exp(0.16), 0.3 + cos(0.3) * exp(0.16) + 1 / 2.3
    ]  # fmt: skip
    assert [float(ball.mid()) for ball in found] == pytest.approx(expected, rel=1e-12)
    # H as a function of x moves as its cosine does.
    (along_x,) = gradient(
        program, [arb(1.0) if n == "x" else v for n, v in zip(program.inputs, arguments, strict=True)], ("x",), system
    )
    assert float(along_x.mid()) == pytest.approx(sin(1.0))


def test_a_system_with_functions_is_itself_again() -> None:
    system = define_system(SWING)
    assert described(SWING) is system
    assert system.reversing_symmetry == (-1, -1, 1, 1, -1, 1)
    assert system.symmetries["S"] == (1, -1, 1, -1, 1, 1)
    assert [system.state[i] for i in system.fixed_coordinates] == ["vx", "vy"]
    assert [system.state[i] for i in system.kernel_coordinates] == ["y"]


def test_a_certificate_about_other_functions_is_not_one_about_the_system_of_a_curve() -> None:
    """exp(u) and exp(u + 1) have the same field in plain arithmetic."""
    own = described(entry(field={**SWING["field"], "vy": "-w*y*exp(vx**2)"}))
    written = describe(own)
    assert isinstance(written, dict)
    *rest, (name, function, text) = written["defined"]
    *lines, last = text.split("\n")
    more = [f"v{len(lines)} = 1", f"v{len(lines) + 1} = {last.removeprefix('return ')} + v{len(lines)}"]
    shifted = "\n".join([*lines, *more, f"return v{len(lines) + 1}"])
    other = described({**written, "defined": [*rest, [name, function, shifted]]})
    assert keeps_its_functions(other)
    assert own.program == other.program
    curve = cast("Atlas", SimpleNamespace(system=own, parameters={"w": Fraction(1, 2)}))
    for system, problem in ((own, "the certificate says"), (other, "about other functions in the field")):
        claim = replace(
            swing({"vx": Fraction(3, 2), "vy": Fraction(0)}, Equation(COORDINATE, Fraction(0), "vy")), system=system
        )
        certificate = certify(claim, Limits(digits=12))
        # That H is no first integral is seen before anything is integrated.
        assert "first integral" in str(certificate.reason)
        found = certified_point(curve, certificate, lambda _: pytest.fail("it is not looked at"))
        assert problem in found.problem
        assert found.is_foreign == (system is other)


@pytest.mark.parametrize("factor", [1, 2])
def test_a_certificate_on_a_level_of_another_integral_is_foreign_to_a_curve(factor: int) -> None:
    level = {"value": "1/10", "sign": -1}
    integral = "(vx**2 + vy**2)/2 - cos(x) + w*y**2/2"
    own, other = (
        described(entry(family_parameter="w", fixed_level=level, first_integral=f"{n}*({integral})"))
        for n in (1, factor)
    )
    claim = Candidate(
        id="level", system=other, parameters={}, kind="orbit", k=1, centre=(Fraction(2), Fraction(1)),
        frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))), kernel_frame=((Fraction(0),),),
        radii=(Fraction(1, 100),) * 2, equation=Equation(COORDINATE, Fraction(1), "vy"),
    )  # fmt: skip
    certificate = certify(claim, Limits(digits=12))
    assert not certificate.proved
    curve = cast("Atlas", SimpleNamespace(system=own, parameters={}))
    found = certified_point(curve, certificate, lambda _: pytest.fail("it is not looked at"))
    assert found.is_foreign == (factor == 2)
    assert ("another first integral" in found.problem) == found.is_foreign


def test_no_letter_stands_for_two_things_in_a_statement() -> None:
    where = {"q": "y**2*vx**2 + y**4 + w", "r": "x**2*y**2 + x**4 + 1"}
    field = {**SWING["field"], "vx": "-sin(x)*q*q*q - q*x", "vy": "-w*y*exp(r*r*r + r)*exp(q*q*q)"}
    system = described(entry(field=field, where=where, first_integral="(vx**2 + vy**2)/2 - cos(x)*r*r + r*q*q"))
    lines = setting(system, {"w": Fraction(1, 2)}, None)
    letters = [line.partition(" = ")[0].strip() for line in lines if line.startswith("  ")]
    assert len([name for name in letters if len(name) == 1 and name not in "wH"]) >= 6
    assert len(set(letters)) == len(letters)
    # And each function is called by its own name.
    for each in system.defined:
        assert any(line.strip().startswith(f"{each.name} = {each.function}(") for line in lines), lines


def test_lasting_stability_is_said_of_the_coordinates_that_are_given() -> None:
    """Beside the states at which the further ones are these functions nothing is shown to be stable."""
    curve = cast("Atlas", SimpleNamespace(system=described(SWING)))
    assert "in the system with the states (x, y, vx, vy), on all" in _where(curve)


def test_at_most_twenty_further_coordinates() -> None:
    sums = {n: "+".join(f"exp({i}*vy)" for i in range(1, n + 1)) for n in (18, 19, 20, 21)}
    for count, last, allowed in ((18, "cos(vx)", True), (19, "cos(vx)", False), (20, "1", True), (21, "1", False)):
        text = {"vx": f"-x*({sums[count]})", "vy": f"-w*y*{last}"}
        changes = entry(field={**SWING["field"], **text}, first_integral="vx**2")
        if allowed:
            assert len(described(changes).defined) == 20
        else:
            with pytest.raises(DescriptionError, match="more than 20"):
                described(changes)


def test_names_of_further_coordinates_are_found_however_many_are_taken() -> None:
    names = " ".join(f"exp_{n}" for n in range(1, 70))
    system = described(entry(parameters=f"w {names}", field={**SWING["field"], "vy": "-w*y*exp(vx*vx)"}))
    assert "exp_70" in system.state


@pytest.mark.slow
def test_the_list_of_pendula_beside_a_spring_is_that_of_the_elliptic_functions(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A wide piece; the stability parameter is cos(2 T w^(1/2)), and 1:4 where that is 0."""
    piece = {
        "id": "p1", "kind": "regular", "centre": ["0.875", "0"], "frame": [["1", "0"], ["0", "1"]],
        "half_width": "0.375", "polynomial": [["0"]], "tube": ["1e-7"], "coordinates": "physical",
    }  # fmt: skip
    atlas = {
        "format": "orbitproof-atlas", "version": 1, "id": "swing", "title": "swing",
        "system": describe(described(SWING)),
        "parameters": {"w": "0.5"}, "pieces": [piece],
        "claim": {"kind": "arc", "symmetry": None, "covers": {"coordinate": "vx", "from": "0.55", "to": "1.2"}},
    }  # fmt: skip
    path, output = tmp_path / "atlas.json", tmp_path / "certificate.json"
    path.write_text(json.dumps(atlas), "utf-8")
    assert verify_main(["atlas", str(path), "--complete", "4", "-o", str(output), "--quiet"]) == 0
    capsys.readouterr()
    document = json.loads(output.read_text("utf-8"))
    assert document["verdict"] == "proved"
    assert [each["coordinate"] for each in document["statement"]["functions"]] == ["sin_x", "cos_x"]
    found = document["conclusion"]["complete"]
    assert found["gaps"] == []
    (point,) = found["points"]
    assert (point["kind"], point["k"]) == ("resonance", 4)
    a = mpmath.findroot(lambda value: 2 * half(value) / mpmath.sqrt(2) - 3 * mpmath.pi / 2, 1.0)
    assert holds(ball_from_json(point["half_period"]), half(a))
    assert holds(ball_from_json(point["level"]), a**2 / 2 - 1)
    assert verify_main(["atlas", "--recheck", str(output), "--quiet"]) == 0
