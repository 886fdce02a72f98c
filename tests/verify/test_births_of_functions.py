"""Fields with functions where orbits are born, without following one: what begins, what is compared (section 38.7)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb, ctx
from support import birth_cases as cases
from support.balls import agree

from orbitproof.shared.formats import define_system
from orbitproof.shared.systems import AMPLITUDE
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic
from orbitproof.verify.birth_curve import BirthCurveTheorem, BirthLimits, functions, proved_curve
from orbitproof.verify.birth_curve.piece import _BornOrbits
from orbitproof.verify.claim.functions import enclose_functions
from orbitproof.verify.evidence import Checklist, enclose, power
from orbitproof.verify.poincare import function_of
from orbitproof.verify.poincare.crossing import range_of

FAST = BirthLimits(precision=80, order=24, width=16, top=1)


def test_an_orbit_begins_where_its_functions_are_and_is_compared_in_the_given_coordinates() -> None:
    """About s = 1/2, beside the equilibrium, so that the field is not 0 there."""
    atlas = cases.bent_circles("exp(sin(x)) - 1", "exp(-sin(x))/cos(x)", Q(1, 3))
    atlas = replace(atlas, claim=replace(atlas.claim, section="y", amplitude="x"))
    piece, system = atlas.pieces[0], atlas.system
    widths = [width / 2**40 for width in piece.tube]
    arithmetic = FAST.arithmetic(widths, FAST.precision // 2)
    orbits = _BornOrbits(atlas, piece, (Q(1, 2), Q(1, 2**60)), widths, arithmetic)
    given, eps = len(system.given_state), Q(3, 64)
    with ctx.workprec(120):
        a, c = enclose(eps**2), [enclose(Q(1, 3)), arb(0)]

        def state(shift: Q) -> list[arb]:
            point = [c[0] + enclose(shift), c[1]]
            return enclose_functions(system, [*point, *[arb(0)] * len(system.defined)], [a])

        rest, there = state(Q(0)), state(eps)
        slopes = [(after - before) / enclose(eps) for before, after in zip(rest, there, strict=True)]
        rates = system.program.evaluate([*rest, a], enclose, power)[:given]
    assert len(system.defined) > 2
    assert orbits.section.normal == (0, 1, *[0] * len(system.defined))
    ends = list(orbits.others(orbits.state))
    for wanted, elements in (
        ([arb(1), arb(0), *slopes[given:]], orbits.state),
        ([a, enclose(eps), *rest], orbits.constants),
        ([*rates, arb(0)], orbits.equations(ends)),
        ([*rates, arb(1)], orbits.equations([each + each for each in ends])),
    ):
        for exact, element in zip(wanted, elements, strict=True):
            found = range_of(element)
            assert agree(found, exact)
            assert found.rad() < 1e-12
    assert all(abs(rate) > 0.02 for rate in rates)


def test_the_pair_is_that_of_the_derivative_through_the_functions() -> None:
    """x' = -sin(4 y), y' = exp(x) - 1: omega = 2, as b has the value 4."""
    field = {"x": "a*x - sin(b*y)", "y": "exp(x) - 1"}
    system = define_system({"name": "w", "state": "x y", "parameters": "b a", "field": field})
    atlas = cases.circles_born(system, parameters={"b": Q(4)})
    with ctx.workprec(128):
        start = dict.fromkeys(("a", AMPLITUDE, "x", "y"), arb(0))
        omega, others = proved_curve._check_pair(Checklist(), atlas, start)
    assert omega.contains(2)
    assert omega.rad() < 1e-30
    assert others.values == ()
    plain = BirthCurveTheorem(cases.circles_born()).hypotheses
    assert BirthCurveTheorem(atlas).hypotheses == ("functions", *plain)


def test_the_rest_of_a_series_is_bounded_by_what_it_is() -> None:
    """After 200 terms of artanh(r)/r, r^2 = 0.4489, and 120 of log: neither is cut where its terms are small."""
    with ctx.workprec(700):
        ratio, arithmetic = Q(67, 100), Arithmetic(Grading((1,), 1), 400, 0, 4)
        change = 2 * ratio / (1 - ratio)
        found = functions.mean_slope("log", arithmetic.constant(Q(1)), arithmetic.constant(change))
        ball = arb(found.coefs[0][0]) / 2**400 + arb(0, sum(found.errors))
        assert ball.contains(enclose(1 + change).log() / enclose(change))
        assert ball.rad() < 2.0**-230
        wide = WideArithmetic(Grading((1,), 1), 400, 0, 4, width=150)
        found = function_of("log", wide.polynomial({(0,): [Q(1), Q(9, 20)]}))
        # Beyond what is printed as a float the polynomial is exact.
        value = sum(int(c) * arb(1) for c in found.coefs[0].coeffs()) / 2**400
        error = abs(value - enclose(Q(29, 20)).log())
        assert error > 2.0**-200
        assert error < sum(found.errors) < 2.0**-130


@pytest.mark.parametrize("function", ["sin", "cos", "exp", "log"])
def test_coefficients_fall_as_they_are_said_to(function: str, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def noted(element: Series, coefficient: Callable[[int], Q], falls: Callable[[int], Q] = lambda k: Q(1)) -> Series:
        asked.append((coefficient, falls))
        return element

    monkeypatch.setattr(functions, "_sum", noted)
    arithmetic = Arithmetic(Grading((1,), 1), 64, 0, 4)
    functions.mean_slope(function, arithmetic.constant(Q(1)), arithmetic.constant(Q(1, 4)))
    ((coefficient, falls),) = asked
    for n in range(1, 30):
        assert all(abs(coefficient(k + 1)) <= falls(n) * abs(coefficient(k)) for k in range(n, n + 30))
