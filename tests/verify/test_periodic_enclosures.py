"""Periodic orbits without symmetry: what is enclosed holds on the whole box, and what is concluded uses all of it."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from flint import acb, arb
from support import periodic_cases as cases
from support.balls import agree
from support.systems import described

from orbitproof.shared.formats import PeriodicOrbit, define_system
from orbitproof.verify.certificate.rechecking import _conclude
from orbitproof.verify.evidence import NotProved, Outcome, Proved, guarded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import (
    Linearised,
    PeriodicEnclosures,
    PeriodicResults,
    SectionReturn,
    enclose_periodic,
    multipliers_of,
)
from orbitproof.verify.poincare import IntegratorSettings

BITS = 200
ZERO, ONE = Fraction(0), Fraction(1)
WIDTH = Fraction(1, 2**90)

RICCATI = define_system({"name": "riccati", "state": "x y w", "field": {"x": "-y", "y": "x", "w": "w**2"}})
"""After one turn w has become w / (1 - 2 pi w), whose derivative is (1 - 2 pi w)^-2."""

_OSCILLATOR = {"name": "oscillator", "state": "x y", "field": {"x": "y", "y": "-x"}}

ASIDE = define_system(
    {"name": "aside", "state": "x y", "field": {"x": "y", "y": "1 - x"}, "first_integral": "(x - 1)**2 + y**2"}
)
"""Circles about (1, 0): the first integral is not even."""

BOTH = described(
    name="both",
    state="x y u v",
    field={"x": "y", "y": "-x", "u": "v", "v": "-2*u"},
    first_integral="x**2 + y**2 + 2*u**2 + v**2",
)


def _outcome(claim: PeriodicOrbit, found: PeriodicEnclosures | None = None) -> Outcome[PeriodicResults]:
    """By enclosures that are given, or by those that are found."""
    if found is None:
        found = enclose_periodic(claim, IntegratorSettings(BITS), ORACLE)
    return _conclude(claim, BITS, found)


def _by_hand(*image: Linearised) -> PeriodicEnclosures:
    """A return of one crossing, after the time 6."""
    time = Linearised(arb(6), (arb(0),) * len(image))
    return PeriodicEnclosures((SectionReturn(1, image, time),), 20, BITS, 1)


def _results(outcome: Outcome[PeriodicResults]) -> PeriodicResults:
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


def _refused(outcome: Outcome[Any]) -> str:
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


@pytest.mark.parametrize("radius", [Fraction(1, 1000), Fraction(1, 200)])
def test_derivatives_are_enclosed_where_they_differ_most_from_those_at_the_centre(radius: Fraction) -> None:
    claim = cases.in_plane(RICCATI, 1, [ONE, ZERO, ZERO], radius)
    (found,) = enclose_periodic(claim, IntegratorSettings(BITS), ORACLE).returns
    with guarded(BITS):
        for number in range(-8, 9):
            w = number * radius / 8
            one_less = 1 - 2 * arb.pi() * w.numerator / w.denominator
            assert found.image[1].slopes[1].contains(1 / one_less**2), number
        assert found.image[1].slopes[1].rad() < 50 * radius.numerator / radius.denominator


@pytest.mark.parametrize(("wide", "proved"), [(1, True), (2**89, True), (2**92, False)])
def test_the_level_is_strictly_monotone_up_to_the_image_of_every_point(wide: int, proved: bool) -> None:
    """An image is at most `wide` radii away: 1/2 leaves x = 2 positive, and 4 does not."""
    system = define_system({**_OSCILLATOR, "first_integral": "x**2 + y**2"})
    claim = cases.in_plane(system, 1, [Fraction(2), ZERO], WIDTH, direction=-1, level=Fraction(4))
    outcome = _outcome(claim, _by_hand(Linearised(arb(0), (arb(0, wide),))))
    if proved:
        assert _results(outcome).point["x"].contains(2)
    else:
        assert _refused(outcome) == "last-coordinate"


def test_multipliers_on_a_level_are_those_at_the_point_and_not_at_the_centre() -> None:
    """F(p) = (p_0, p_0 + p_1/2 + 1/32, 16/7 p_2) has the fixed point (0, 1/16, 0), where dH = (4, 1/4, 0).

    On the kernel of dH its derivative is diag(1/2 - 1/16, 16/7).
    """
    image = (
        Linearised(arb(0), (arb(1), arb(0), arb(0))),
        Linearised(arb(1) / 32, (arb(1), arb(1) / 2, arb(0))),
        Linearised(arb(0), (arb(0), arb(0), arb(16) / 7)),
    )
    claim = cases.in_plane(
        BOTH, 1, [Fraction(2), ZERO, ZERO, ZERO], Fraction(1, 8), direction=-1, level=4 + Fraction(2, 256)
    )
    results = _results(_outcome(claim, _by_hand(*image)))
    with guarded(BITS):
        assert results.point["u"].contains(arb(1) / 16)
        assert any(value.contains(acb(7) / 16) for value in results.multipliers.values)


def test_the_level_is_that_at_a_centre_with_a_negative_coordinate() -> None:
    claim = cases.in_plane(ASIDE, 1, [-ONE, ZERO], WIDTH, level=Fraction(4))
    results = _results(_outcome(claim))
    with guarded(BITS):
        assert results.point["x"].contains(-1)
        assert agree(results.period, 2 * arb.pi())


def test_a_level_of_the_mirror_image_of_the_centre_is_refused() -> None:
    """H is 0 at (1, 0), and 4 at (-1, 0)."""
    assert _refused(_outcome(cases.in_plane(ASIDE, 1, [-ONE, ZERO], WIDTH, level=ZERO))) == "periodic"


def test_eigenvalues_that_may_be_a_pair_are_not_called_real() -> None:
    """Of the matrices one has 1/2 +- i 2^-20, and another 1/2 +- 2^-20."""
    matrix = [[arb(0.5), arb(0, 2**-30)], [arb(2**-10), arb(0.5)]]
    values = multipliers_of(matrix, 1, False).values
    assert len(values) == 2
    for exact in (acb(0.5, 2**-20), acb(0.5, -(2**-20)), acb(0.5 + 2**-20), acb(0.5 - 2**-20)):
        assert any(value.contains(exact) for value in values)


def test_a_constant_in_the_form_of_a_power_0_does_not_change_the_derivatives_of_the_level() -> None:
    system = define_system({**_OSCILLATOR, "first_integral": "x**2 + y**2 + x**0"})
    point = [2 + WIDTH / 4, ZERO]
    results = _results(_outcome(cases.in_plane(system, 1, point, WIDTH, direction=-1, level=Fraction(5))))
    assert results.point["x"].contains(2)
    assert results.point["x"].rad() < 1e-40


@pytest.mark.parametrize(("integral", "shown"), [("x**2 + y**2", True), ("(x**2 + y**2)/(1 + x**2 + y**2)", False)])
def test_a_first_integral_that_is_not_recognised_is_not_called_wrong(integral: str, shown: bool) -> None:
    """Both are constant along orbits; the second divides by what the vector field does not."""
    system = define_system({**_OSCILLATOR, "first_integral": integral})
    level = Fraction(4) if shown else Fraction(4, 5)
    claim = cases.in_plane(system, 1, [Fraction(2), ZERO], WIDTH, direction=-1, level=level)
    outcome = _outcome(claim)
    assert isinstance(outcome, Proved) == shown
    if isinstance(outcome, NotProved):
        assert outcome.reason.condition == "first-integral"
        assert not outcome.reason.excluded
        assert "if H is constant along orbits, write it without divisors and roots" in outcome.reason.remedy
