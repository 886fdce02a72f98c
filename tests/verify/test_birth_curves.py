"""Orbits from their birth on: closed forms, the field in units of the amplitude, and claims that are false (38)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction as Q
from functools import cache
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from flint import arb, ctx
from support import birth_cases as cases
from support.balls import agree
from support.forgeries import checked, forged
from support.systems import described

from orbitproof.shared.claims import BirthAtlas
from orbitproof.shared.formats import define_system
from orbitproof.shared.systems import AMPLITUDE, Program, System, blown_up, own_name, record
from orbitproof.verify.algebra import Arithmetic, Grading, WideArithmetic
from orbitproof.verify.birth_curve import (
    BirthCurveTheorem,
    BirthLimits,
    ProvedBirthCurve,
    conclude_births,
    prove_birth_curve_piece,
    proved_curve,
)
from orbitproof.verify.birth_curve import piece as proved_piece
from orbitproof.verify.birth_curve.functions import mean_slope, slopes_at_start
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.claim.functions import enclose_functions
from orbitproof.verify.curve import IntervalResult, check_newton
from orbitproof.verify.curve.tube import Tube
from orbitproof.verify.evidence import (
    FUNCTIONS,
    Checklist,
    IntegrationFailure,
    NotEstablishedError,
    NotProved,
    Proved,
    enclose,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import functions_at_start
from orbitproof.verify.poincare import defined_values
from orbitproof.verify.theorems.birth_curve import told
from orbitproof.verify.words.birth_curve import birth_curve_in_words

FAST = BirthLimits(precision=80, order=24, width=16, top=1)
FASTEST = BirthLimits(precision=64, order=20, width=6, top=1)
"""Enough for circles up to the amplitude 1/16."""


def results_of(atlas: BirthAtlas, parts: int = 1, limits: BirthLimits = FAST) -> list[IntervalResult]:
    ends = [Q(2 * number, parts) - 1 for number in range(parts + 1)]
    return [
        prove_birth_curve_piece(atlas, piece, part, ORACLE, limits).stored
        for piece in atlas.curve_pieces()
        for part in pairwise(ends)
    ]


def proved(atlas: BirthAtlas, parts: int = 1) -> ProvedBirthCurve:
    outcome = conclude_births(atlas, results_of(atlas, parts)).outcome
    assert isinstance(outcome, Proved), outcome
    found: ProvedBirthCurve = outcome.results
    return found


@cache
def honest(name: str = "circles") -> list[IntervalResult]:
    return results_of({"circles": cases.circles_born, "slaved": cases.slaved_born}[name]())


def reason(atlas: BirthAtlas, results: Sequence[IntervalResult] | None = None) -> str:
    outcome = conclude_births(atlas, results_of(atlas) if results is None else results).outcome
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


def why_not(atlas: BirthAtlas, limits: BirthLimits = FAST) -> str:
    (result,) = results_of(atlas, 1, limits)
    assert result.reason is not None, "proved"
    return result.reason.condition


def in_units(system: System) -> Program:
    return record(blown_up(system), system.state, (*system.parameters, AMPLITUDE, *map(own_name, system.state)))


# The field


def exactly(program: Program, arguments: Sequence[Q]) -> list[Q]:
    def power(base: Q, exponent: Q) -> Q:
        if exponent.denominator == 1:
            return base**exponent.numerator
        root = Q(round(base.numerator**0.5), round(base.denominator**0.5))
        assert root**exponent.denominator == base
        return root**exponent.numerator

    return [Q(value) for value in program.evaluate(arguments, lambda value: value, power)]


EVERY_OPERATION = define_system(
    {
        "name": "f", "state": "x y z", "parameters": "a b",
        "field": {
            "x": "a*x - x**2*y/(1 + z**2) + b - (a - 2)*(x - y) + 7",
            "y": "x*y*z - 1/x**3 + a/(b*z + y) + (x/a)**4",
            "z": "a*b/(x + y) + (a - x)/b - (2 - z)/(3*x) - a**2/b**3",
        },
    }
)  # fmt: skip


def test_the_field_in_units_of_the_amplitude_is_a_quotient_of_differences() -> None:
    """Exactly, and at amplitude 0 the derivative, as the limit of a polynomial in it."""
    field, source = in_units(EVERY_OPERATION), Random(38)
    for _ in range(300):
        c = [Q(source.randrange(1, 9), source.randrange(1, 5)) for _ in range(3)]
        y = [Q(source.randrange(-9, 10), 7) for _ in range(3)]
        known = [Q(source.randrange(1, 9), 3) for _ in range(2)]
        eps = Q(source.choice((-1, 1)), source.randrange(20, 90))

        def rates(shift: Q, c: Sequence[Q] = c, y: Sequence[Q] = y, known: Sequence[Q] = known) -> list[Q]:
            point = [origin + shift * along for origin, along in zip(c, y, strict=True)]
            return exactly(EVERY_OPERATION.program, [*point, *known])

        differences = [(after - before) / eps for after, before in zip(rates(eps), rates(Q(0)), strict=True)]
        assert exactly(field, [*y, *known, eps, *c]) == differences
        tiny = Q(1, 10**40)
        nearly = [(after - before) / (2 * tiny) for after, before in zip(rates(tiny), rates(-tiny), strict=True)]
        at_rest = exactly(field, [*y, *known, Q(0), *c])
        assert all(abs(u - v) < Q(1, 10**60) for u, v in zip(at_rest, nearly, strict=True))


def test_roots_are_divided_too() -> None:
    """Of squares and cubes, exactly; what does not depend on the state does not change."""
    system = define_system(
        {"name": "r", "state": "x y z", "parameters": "a",
         "field": {"x": "x**(3/2) - y**(-1/2) + a**(1/2)", "y": "(x*y)**(1/2) + y**(-3/2) + x**0*z", "z": "a"}}
    )  # fmt: skip
    field = in_units(system)
    for before, after in (((4, 9, 1), (16, 25, 3)), ((1, 36, 0), (9, 4, 5)), ((25, 4, 2), (4, 4, 2))):
        eps = Q(1, 3)
        y = [(Q(v) - u) / eps for u, v in zip(before, after, strict=True)]
        found = exactly(field, [*y, Q(9), eps, *map(Q, before)])
        rates = [exactly(system.program, [*map(Q, point), Q(9)]) for point in (after, before)]
        assert found == [(u - v) / eps for u, v in zip(*rates, strict=True)]


@pytest.mark.quick
@pytest.mark.parametrize("function", ["sin", "cos", "exp", "log"])
def test_mean_slopes_of_functions_contain_those_of_the_points(function: str) -> None:
    """Of sets of values and of changes, 0 included, from much higher precision."""
    arithmetic, apply = Arithmetic(Grading((1,), 1), 100, 0, 4), FUNCTIONS[function]
    for at, change in ((Q(1), Q(0)), (Q(5, 4), Q(1, 10**12)), (Q(3, 2), Q(3)), (Q(9, 4), Q(-3, 2)), (Q(1), Q(3, 4))):
        for radius in (Q(0), Q(1, 64)):
            with ctx.workprec(400):
                found = mean_slope(function, arithmetic.constant(at).widened(radius), arithmetic.constant(change))
                assert sum(found.errors) < (1.0 if radius else 2.0**-80)
                ball = arb(found.coefs[0][0]) / 2**100 + arb(0, sum(found.errors))
                for place in {at - radius, at, at + radius}:
                    step = change or Q(1, 10**40)
                    exact = (apply(enclose(place + step)) - apply(enclose(place))) / enclose(step)
                    # Where the change is 0 it is the derivative, up to the step.
                    assert (ball + (0 if change else arb(0, 1e-35))).contains(exact), (at, change, radius)


NESTED = described(
    name="f", state="x y", parameters="a", field={"x": "exp(a*exp(x)/3) + a*y", "y": "sin(x*y)*log(y + 2)"}
)


def test_slopes_at_the_start_are_quotients_of_differences() -> None:
    """Of functions of functions, for points, from balls at the equilibrium and beside it."""
    arithmetic, (x, y, a, eps) = Arithmetic(Grading((1,), 1), 100, 0, 4), (Q(1, 3), Q(5, 4), Q(3, 2), Q(3, 4))
    along = [Q(1, 2), Q(-2, 3)]
    with ctx.workprec(200):
        rest, there = (
            enclose_functions(NESTED, [enclose(v) for v in point] + [arb(0)] * len(NESTED.defined), [enclose(a)])
            for point in ((x, y), (x + eps * along[0], y + eps * along[1]))
        )
        own = [arithmetic.constant(value) for value in (x, y)]
        held = [*own, *defined_values(functions_at_start(NESTED), own, [arithmetic.constant(a)])]
        given, known = [arithmetic.constant(value) for value in along], [arithmetic.constant(a)]
        found = slopes_at_start(NESTED, given, known, arithmetic.constant(eps), held)
        assert len(found) == len(NESTED.defined) == 5
        for each, before, after in zip(found, rest[2:], there[2:], strict=True):
            assert sum(each.errors) < 2.0**-80
            ball = arb(each.coefs[0][0]) / 2**100 + arb(0, sum(each.errors))
            assert agree(ball, (after - before) / enclose(eps))


def test_slopes_at_the_start_do_not_depend_on_time() -> None:
    """Also where products of elements have more powers of sigma than are kept."""
    system = NESTED
    arithmetic = WideArithmetic(Grading((1,), 1), 80, 20, 24, width=12)
    x, y, a = (arithmetic.polynomial({(0,): [Q(1, k + m) / 8**k for k in range(13)]}) for m in (3, 4, 5))
    own = defined_values(functions_at_start(system), [x, y], [a])
    for each in (*own, *slopes_at_start(system, [x, y], [a], a, [x, y, *own])):
        assert each.arithmetic is arithmetic
        assert all(p.length() <= arithmetic.stride for p in each.coefs)
        assert any(p.length() > 1 for p in each.coefs)


def test_mean_slopes_are_enclosed_or_not_at_all() -> None:
    """The ratio of two arguments of a logarithm is too large, or an argument is not positive."""
    arithmetic = Arithmetic(Grading((1,), 1), 64, 0, 4)
    for at, change in ((1, 50), (1, -2), (3, -3)):
        with pytest.raises(IntegrationFailure):
            mean_slope("log", arithmetic.constant(Q(at)), arithmetic.constant(Q(change)))
    with pytest.raises(ValueError, match="no function of a field"):
        mean_slope("tan", arithmetic.constant(Q(1)), arithmetic.constant(Q(1)))


# Curves of closed form


@pytest.mark.quick
def test_circles_from_their_birth_on() -> None:
    for atlas, end in ((cases.circles_born(), Q(1, 16)), (cases.slaved_born(), Q(1, 32))):
        outcome = conclude_births(atlas, honest(atlas.id)).outcome
        assert isinstance(outcome, Proved), outcome
        found = outcome.results
        for name, value in (("a", end), ("x", end), ("y", Q(0)), (AMPLITUDE, Q(1, 4))):
            assert found.ends["end"][name].contains(arb(value.numerator) / value.denominator)
            assert found.ends["start"][name].contains(0)
            assert found.ends["end"][name].rad() < 1e-14
        assert found.ends["start"][AMPLITUDE] == 0
        assert found.frequency.contains(1)
        assert found.frequency.rad() < 1e-14
        assert found.period.contains(2 * arb.pi())
        assert found.turns == ()
        assert (found.eigenvalues.left, found.eigenvalues.right) == (len(atlas.system.state) - 2, 0)
    assert agree(found.ends["end"][own_name("along z")], arb(3) / 20)


BENT: dict[str, tuple[str, str, Q, int]] = {
    "exp": ("exp(x) - 1", "exp(-x)", Q(0), -1),
    "log": ("log(x)", "x", Q(1), -1),
    "sin": ("sin(x)", "1/cos(x)", Q(0), -1),
    "cos": ("cos(x)", "-1/sin(x)", Q(884279719003555, 562949953421312), 1),
    "both": ("exp(sin(x)) - 1", "exp(-sin(x))/cos(x)", Q(0), -1),
}
"""Circles in other coordinates: that of x, its inverse derivative, where it is 0, and the direction."""


@pytest.mark.slow
@pytest.mark.parametrize("name", BENT)
def test_circles_in_coordinates_that_are_bent(name: str) -> None:
    """A function of x and y go round on circles: all periods are 2 pi, and a = eps^2."""
    atlas = cases.bent_circles(*BENT[name])
    found = proved(atlas)
    assert found.ends["end"]["a"].contains(arb(1) / 256)
    assert found.ends["end"]["a"].rad() < 1e-14
    assert abs(found.ends["start"]["x"] - (arb.pi() / 2 if name == "cos" else enclose(BENT[name][2]))) < 1e-14
    assert found.frequency.contains(1)
    assert agree(found.period, 2 * arb.pi())
    assert found.period.rad() < 1e-4
    assert {"x", "y", "a", AMPLITUDE} == {*found.ends["start"]}


@pytest.mark.slow
def test_circles_in_bent_coordinates_are_no_others() -> None:
    """About another point, the other way round, or on the other side."""
    exact = cases.bent_circles("log(x)", "x", Q(1))
    (piece,), claim = exact.curve_pieces(), exact.claim
    elsewhere = replace(piece, centre=(*piece.centre[:2], Q(1, 2), *piece.centre[3:]))
    assert why_not(replace(exact, claim=replace(claim, direction=1))) == "direction"
    minus = cases.squares(Q(1, 32), Q(-1))
    for wrong in (elsewhere, replace(piece, polynomial=(minus, *piece.polynomial[1:]))):
        assert why_not(replace(exact, pieces=(wrong,))) in ("newton", "slope")


def test_what_is_no_function_of_the_state_is_noticed() -> None:
    """x' = x (..) keeps w = log(x) + k for any k, and no sine."""
    atlas = cases.bent_circles("log(x)", "x", Q(1))
    (log,) = atlas.system.defined
    wrong = replace(atlas, system=replace(atlas.system, defined=(replace(log, function="exp"),)))
    assert reason(wrong, []) == "functions"


def test_the_parameter_may_turn_back() -> None:
    """a = eps^2 - 16 eps^4: a maximum at eps = 1/sqrt(32)."""
    reach, powers = Q(1, 8), [Q(0)] * 5
    for number, (fourth, second) in enumerate(zip((1, 4, 6, 4, 1), (1, 2, 1, 0, 0), strict=True)):
        powers[number] = second * reach**2 - 16 * fourth * reach**4
    piece = cases.piece(reach, (powers, powers, (Q(0),)), tube=(Q(1, 2**20),) * 3)
    atlas = cases.circles_born(cases.circles("a + 16*(u**2 + y**2)**2"), pieces=(piece,))
    found = proved(atlas, 2)
    (turn,) = found.turns
    assert turn.is_maximum
    s = 8 / arb(32).sqrt() - 1
    assert enclose(turn.between[0]) < s < enclose(turn.between[1])
    said = birth_curve_in_words(BirthCurveTheorem(atlas), found)
    assert "Along it a has at least one extremum: a maximum" in said
    assert "For every value of a between" not in said


def test_what_is_said() -> None:
    atlas = cases.slaved_born()
    outcome = conclude_births(atlas, honest("slaved")).outcome
    assert isinstance(outcome, Proved)
    said = birth_curve_in_words(outcome.theorem, outcome.results)
    for part in (
        "with b = 2",
        "speed that is not 0, as Hopf's theorem takes it. Of the other eigenvalues 1 has a negative and 0 a positive",
        "crosses the plane where y is that of the equilibrium exactly once in the direction in which y grows",
        "it does so where x is greater than that of the equilibrium",
        "For every value of a between its two ends there is such an orbit on the curve.",
        "is 0 where the curve begins and [0.25000",
        "and the orbit through ([0.28124",
        ", [0.03749",
    ):
        assert part in said
    outcome = conclude_births(cases.circles_born(), honest()).outcome
    assert isinstance(outcome, Proved)
    assert "other eigenvalues" not in birth_curve_in_words(outcome.theorem, outcome.results)


# Claims that are false


@pytest.mark.quick
def test_false_claims_about_a_piece_are_not_proved() -> None:
    atlas = cases.circles_born()
    (piece,), claim = atlas.curve_pieces(), atlas.claim
    reach, square, zero = Q(1, 32), cases.squares(Q(1, 32)), (Q(0),)
    # The orbits go round the other way, or the section and the amplitude are others.
    assert why_not(replace(atlas, claim=replace(claim, direction=-1))) == "direction"
    assert why_not(replace(atlas, claim=replace(claim, section="x", amplitude="y"))) == "direction"
    # They are on the other side of the Hopf point, or there is no equilibrium.
    minus, other = cases.squares(reach, Q(-1)), cases.squares(reach, Q(9, 8))
    for rows in ((minus, minus, zero), (square, other, zero)):
        assert why_not(replace(atlas, pieces=(cases.piece(reach, rows),)), FASTEST) == "newton"
    # Claims that say nothing.
    for changes in ({"section": "x"}, {"amplitude": "a"}, {"section": "w"}, {"parameter": "b"}, {"direction": 2}):
        assert why_not(replace(atlas, claim=replace(claim, **changes))) == "piece"
    assert why_not(replace(atlas, parameters={"a": Q(0)})) == "piece"
    for wrong in (replace(piece, tube=piece.tube[:-1]), replace(piece, frame=(piece.frame[0],) * 4)):
        assert why_not(replace(atlas, pieces=(wrong,))) == "piece"
    bent = cases.bent_circles("log(x)", "x", Q(1))
    assert why_not(replace(bent, claim=replace(bent.claim, section=bent.system.state[2]))) == "piece"


def test_the_velocity_has_its_sign_on_all_parts_of_a_tube() -> None:
    atlas, plus = cases.circles_born(), arb(1)
    proved_piece._check_direction(Checklist(), atlas, [plus, plus])
    for other in (-plus, arb(0), arb(1, 2), arb("nan")):
        for across in ([plus, other], [other, plus]):
            with pytest.raises(NotEstablishedError):
                proved_piece._check_direction(Checklist(), atlas, across)


@pytest.mark.parametrize("start", [Q(-1), Q(1, 2)])
def test_bounds_hold_up_to_the_ends_of_an_interval(start: Q, monkeypatch: pytest.MonkeyPatch) -> None:
    """The polynomial of a is wrong by 2^-17 s^8, which is 0.62 of it at s = 16/17; omega is in units of two tubes."""
    atlas, wrong, found = cases.circles_born(), Q(1, 2**17), list[Any]()
    (piece,) = atlas.curve_pieces()
    first, *others = piece.polynomial
    other = replace(piece, polynomial=((*first, *[Q(0)] * 5, wrong), *others))

    def noted(*given: Any) -> Any:
        found.append(check_newton(*given))
        return found[-1]

    monkeypatch.setattr(proved_piece, "check_newton", noted)
    result = prove_birth_curve_piece(replace(atlas, pieces=(other,)), other, (start, Q(1)), ORACLE, FAST).stored
    assert result.interval == (start, 1)
    assert result.is_proved, result.reason
    assert wrong <= result.deviation[0] < Q(3, 2) * wrong
    for stored, omega in zip((result.deviation, result.slope_deviation), *found, strict=True):
        for value, ball, tube in zip(stored, omega, piece.tube, strict=True):
            assert ball.abs_upper() * enclose(2 * tube) <= enclose(value)


@pytest.mark.parametrize("interval", [(Q(-2), Q(1)), (Q(0), Q(2)), (Q(1), Q(-1))])
def test_a_piece_is_proved_within_its_interval_only(interval: tuple[Q, Q]) -> None:
    atlas = cases.circles_born()
    outcome = prove_birth_curve_piece(atlas, atlas.curve_pieces()[0], interval, ORACLE, FAST).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "piece"


def test_eigenvalues_that_do_not_cross_the_axis_give_no_curve() -> None:
    """Their real part is a^2; then it is that of a pair that stays on the axis, of a centre."""
    zero = (Q(0),)
    for growth in ("a**2", "0*a + u**2 + y**2"):
        straight = cases.piece(Q(1, 8), (zero, zero, zero))
        assert why_not(cases.circles_born(cases.circles(growth), pieces=(straight,))) in ("newton", "slope")


@pytest.mark.slow
def test_no_rotation_is_no_birth() -> None:
    """A saddle: nothing comes back."""
    system = define_system({"name": "s", "state": "x y", "parameters": "a", "field": {"x": "a + y - a", "y": "x"}})
    zero = (Q(0),)
    outcome = why_not(cases.circles_born(system, pieces=(cases.piece(Q(1, 8), (zero, zero, zero)),)))
    assert outcome in ("return-map", "steps", "singularity", "flow", "size", "step size", "tube")


def four(second: str) -> BirthAtlas:
    """Circles beside the plane of u and v."""
    where = {"g": "a - x**2 - y**2"}
    u, v = second.split(";")
    field = {"x": "g*x - y", "y": "x + g*y", "u": u, "v": v}
    system = define_system({"name": "four", "state": "x y u v", "parameters": "a", "where": where, "field": field})
    zero, square = (Q(0),), cases.squares(Q(1, 8))
    return cases.circles_born(system, pieces=(cases.piece(Q(1, 8), (square, *[zero] * 6)),))


@pytest.mark.parametrize("second", ["2*v;-2*u", "u*0;-v"])
def test_a_resonance_is_no_regular_birth(second: str) -> None:
    assert why_not(four(second)) in ("newton", "slope")


def test_another_pair_beside_it_is_allowed() -> None:
    """At 3 i/2."""
    found = proved(four("3/2*v;-3/2*u"))
    assert (found.eigenvalues.left, found.eigenvalues.right, found.eigenvalues.undecided) == (0, 0, 2)


def pair_of(system: System, start: dict[str, Any]) -> str:
    atlas = cases.circles_born(system)
    checklist = Checklist()
    with ctx.workprec(128):
        try:
            proved_curve._check_pair(checklist, atlas, {name: arb(value) for name, value in start.items()})
        except NotEstablishedError as error:
            return error.reason.condition
    return "simple"


def test_a_pair_that_is_not_simple_is_noticed() -> None:
    """With one eigenvector, of which the equations see nothing: x' = -y + u, ..; and a saddle has no such pair."""
    rest = {"a": 0, AMPLITUDE: 0, "x": 0, "y": 0, "u": 0, "v": 0, own_name("along u"): 0, own_name("along v"): 0}
    for turn, wanted in (("1", "simple-pair"), ("2", "simple")):
        field = {"x": "-y + u + a*x", "y": "x + v", "u": f"-{turn}*v", "v": f"{turn}*u"}
        system = define_system({"name": "j", "state": "x y u v", "parameters": "a", "field": field})
        assert pair_of(system, rest) == wanted
    saddle = define_system({"name": "s", "state": "x y", "parameters": "a", "field": {"x": "y + a*x", "y": "x"}})
    assert pair_of(saddle, {"a": 0, AMPLITUDE: 0, "x": 0, "y": 0}) == "simple-pair"


def test_the_frequency_is_that_of_the_pair_there() -> None:
    """omega^2 = 2 (a + 2)^3 (1 + x), 16 where both are 0; then 4 i beside it is one more i omega, and 16 i is none."""
    rest: dict[str, Any] = dict.fromkeys(
        ("a", AMPLITUDE, "x", "y", "u", "v", own_name("along u"), own_name("along v")), 0
    )
    for turn, wanted in (("4", "simple-pair"), ("16", "simple")):
        field = {"x": "-2*(a + 2)**2*(1 + x)*y", "y": "(a + 2)*x", "u": f"-{turn}*v", "v": f"{turn}*u"}
        system = define_system({"name": "w", "state": "x y u v", "parameters": "a", "field": field})
        assert pair_of(system, rest) == wanted
    with ctx.workprec(128):
        for name in ("", "a", "x"):
            start = {key: arb(0, 0.1 if key == name else 0) for key in rest}
            omega, others = proved_curve._check_pair(Checklist(), cases.circles_born(system), start)
            for sign in (-1, 0, 1):
                a, x = (Q(sign, 10) if key == name else Q(0) for key in ("a", "x"))
                assert omega.contains(enclose(2 * (a + 2) ** 3 * (1 + x)).sqrt().mid())
            assert omega.rad() < (1 if name else 1e-30)
            assert [value.imag.overlaps(arb(turn)) for value in others.values] in ([False, True], [True, False])


def test_false_claims_about_the_whole_are_not_proved() -> None:
    atlas = cases.circles_born()
    (piece,), given = atlas.curve_pieces(), honest()
    assert reason(atlas, []) == "curve"
    assert reason(replace(atlas, pieces=()), given) == "pieces"
    assert reason(replace(atlas, pieces=(piece, piece)), given) == "pieces"
    assert reason(replace(atlas, claim=replace(atlas.claim, section="x")), given) == "pieces"
    assert reason(replace(atlas, claim=replace(atlas.claim, kind="birth")), given) == "pieces"  # type: ignore[arg-type]
    for wrong in (replace(piece, tube=piece.tube[1:]), replace(piece, frame=(piece.frame[0],) * 4)):
        assert reason(replace(atlas, pieces=(wrong,)), given) == "pieces"
        assert reason(replace(atlas, pieces=(piece, replace(wrong, id="p2"))), given) == "pieces"
    # The first piece does not begin at the equilibrium, or not straight from it.
    later = replace(piece, centre=(piece.centre[0], piece.centre[1] + Q(1, 2**40), *piece.centre[2:]))
    assert reason(replace(atlas, pieces=(later,)), given) == "birth"
    tilted = (piece.frame[0], (Q(1), Q(0), Q(1, 2**30), Q(0)), *piece.frame[2:])
    assert reason(replace(atlas, pieces=(replace(piece, frame=tilted),)), given) == "birth"
    backwards = tuple((-row[0], *row[1:]) for row in piece.frame)
    behind = (piece.centre[0], -piece.centre[1], *piece.centre[2:])
    assert reason(replace(atlas, pieces=(replace(piece, frame=backwards, centre=behind),)), given) == "birth"


def test_the_amplitude_may_fall_and_is_positive(monkeypatch: pytest.MonkeyPatch) -> None:
    """Results as of a second piece along a = c_1 on which eps falls; near a = 81/1600 it is 9/40, as on the first."""
    atlas, is_beyond = cases.circles_born(), Tube.coordinate_is_beyond_zero
    first, middle, zero, one = atlas.curve_pieces()[0], Q(81, 1600), Q(0), Q(1)
    frame = ((one, zero, zero, zero), (zero, one, zero, zero), (one, zero, one, zero), (zero, zero, zero, one))
    for slope, wanted in ((Q(-1, 4), "amplitude"), (Q(1, 100), ""), (Q(-1, 100), "")):
        second = replace(
            first, id="p2", centre=(middle, Q(9, 40), middle, zero), frame=frame, half_width=Q(1, 50),
            polynomial=((zero, slope), (zero,), (zero,)), tube=(Q(1, 16),) * 3,
        )  # fmt: skip
        (result,) = honest()
        results = [result, replace(result, piece="p2")]
        asked: list[Any] = []
        monkeypatch.setattr(
            Tube, "coordinate_is_beyond_zero", lambda *given, asked=asked: asked.append(given) or is_beyond(*given)
        )
        outcome = conclude_births(replace(atlas, pieces=(first, second)), results).outcome
        assert ("" if isinstance(outcome, Proved) else outcome.reason.condition) == wanted
    # All s at which the curve may enter a piece.
    assert isinstance(outcome, Proved)
    stretches = outcome.results.chain.stretches
    assert [(*given[4:],) for given in asked] == [(stretches[1].enters, stretches[1].leaves)]
    assert stretches[1].enters < stretches[1].entered
    said = birth_curve_in_words(BirthCurveTheorem(atlas), outcome.results)
    assert "increases" not in said.partition("Along it")[0]


# From birth to birth


def as_of(atlas: BirthAtlas) -> list[IntervalResult]:
    """Results as of all its pieces."""
    (result,), bounds = honest(), (Q(1, 2**15),) * 3
    return [replace(result, piece=piece.id, deviation=bounds, slope_deviation=bounds) for piece in atlas.curve_pieces()]


def test_a_curve_from_one_birth_to_another() -> None:
    atlas = cases.born_twice()
    concluded = conclude_births(atlas, as_of(atlas))
    outcome = concluded.outcome
    assert isinstance(outcome, Proved), outcome
    found = outcome.results
    assert told(concluded)["eigenvalues_at_end"] == told(concluded)["eigenvalues"]
    assert tuple(each.name for each in outcome.hypotheses) == outcome.theorem.hypotheses
    assert outcome.theorem.hypotheses[-2:] == ("simple-pair-at-end", "two-points")
    for key, a in (("start", 0), ("end", 1)):
        assert found.ends[key][AMPLITUDE] == 0
        assert found.ends[key]["a"].contains(a)
    assert found.pair_at_end is not None
    for omega, value in ((found.frequency, 1), (found.pair_at_end[0], 2)):
        assert omega.contains(value)
        assert omega.rad() < 0.01
    said = birth_curve_in_words(outcome.theorem, found)
    assert "At every point between the ends of the curve the orbit is periodic." in said
    assert "the amplitude, is 0 at both ends of the curve." in said
    assert "no other such orbits near the curve.\n" in said
    assert ", to which the orbits shrink. There the derivative" in said
    assert said.count("a speed that is not 0") == 2


def test_false_claims_of_a_second_birth_are_not_proved() -> None:
    atlas = cases.born_twice()
    (*others, last), results, (zero, one) = atlas.curve_pieces(), as_of(atlas), (Q(0), Q(1))
    # The claim is that of an arc, or an arc does not end so.
    assert reason(replace(atlas, claim=replace(atlas.claim, kind="birth-arc")), results) == "amplitude"
    arc = cases.circles_born()
    assert reason(replace(arc, claim=replace(arc.claim, kind="birth-to-birth")), honest()) == "birth"
    # The amplitude is not 0 at the end, or not a multiple of 1 - s.
    beside = (last.centre[0], last.centre[1] + Q(1, 2**40), *last.centre[2:])
    tilted = (last.frame[0], (-one, zero, Q(1, 2**30), zero), *last.frame[2:])
    for wrong in (replace(last, centre=beside), replace(last, frame=tilted), replace(last, frame=others[0].frame)):
        assert reason(replace(atlas, pieces=(*others, wrong)), results) == "birth"


def test_the_ends_are_other_equilibria_or_belong_to_other_parameters() -> None:
    atlas, start = cases.born_twice(), {"a": arb(0, 0.1), "x": arb(1), "y": arb(2, 0.1), AMPLITUDE: arb(0)}
    for changes, wanted in (
        ({}, False), ({AMPLITUDE: arb(1)}, False), ({"a": arb("0.15", 0.1)}, False), ({"a": arb("nan")}, False),
        ({"a": arb(1)}, True), ({"x": arb(0)}, True), ({"y": arb(1)}, True),
    ):  # fmt: skip
        checklist = Checklist()
        with ctx.workprec(64), suppress(NotEstablishedError):
            proved_curve._check_two_points(checklist, atlas, {"start": start, "end": {**start, **changes}})
        assert checklist.hypotheses[-1].holds == wanted, changes


def test_the_certificate_of_a_curve_from_birth_to_birth_says_both() -> None:
    """It has the form of its schema, and is concluded again; a forged frequency of the end is noticed."""
    atlas = cases.born_twice()
    results = as_of(atlas)
    document = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda _: [], None))
    stored = json.loads(json.dumps(document))
    assert stored["verdict"] == "proved"
    assert checked(stored).stands
    conclusion = stored["conclusion"]
    assert conclusion["eigenvalues_at_end"] == conclusion["eigenvalues"]
    wrong = {**stored, "conclusion": {**conclusion, "frequency_at_end": conclusion["frequency"]}}
    assert not checked(forged(wrong, lambda entry: None)).stands
