"""What lies on a curve: mirror images, crossings, contradictions; derived parameters, whatever the search finds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb
from support.chain_cases import certificate, circle, circle_point, concluded, symmetric_arc

from orbitproof.shared.claims import Claim
from orbitproof.shared.systems import AROUND, DerivedParameter
from orbitproof.verify.algebra import Grading, WideArithmetic
from orbitproof.verify.curve import derived_parameter, libration_point, parameter_series
from orbitproof.verify.curve.libration_point import Root
from orbitproof.verify.evidence import IntegrationFailure, NotProved

SYSTEM, NAME, MASS = AROUND["L1"], "x_l", {"mu": Fraction(1, 80)}


@pytest.mark.parametrize("symmetry", [None, "S"])
def test_an_arc_has_no_mirror_image_though_a_symmetry_is_named(symmetry: str | None) -> None:
    above, below = (certificate(circle_point(angle)) for angle in (1.0, -1.0))
    on, off = concluded(circle(Claim("arc", symmetry), [0.7, 1.3]), above, below).bifurcations
    assert on.place is not None
    assert off.place is None


@pytest.mark.parametrize(("shift", "is_possible"), [(2e-10, True), (1e-8, False)])
def test_no_point_of_a_tube_lies_farther_off_the_polynomial_than_is_proved(shift: float, is_possible: bool) -> None:
    """The tube has a half width of 1e-6, and the curve is within 2^-30 of the polynomial."""
    point = certificate({**circle_point(0.7), "vy": arb(3 - math.cos(0.7) + shift, 2**-40)})
    conclusion = concluded(symmetric_arc(), point)
    assert conclusion.is_proved == is_possible
    if is_possible:
        assert conclusion.bifurcations[0].place is not None
    else:
        assert isinstance(conclusion.outcome, NotProved)
        assert "no such point so far off" in conclusion.outcome.reason.message


@pytest.mark.parametrize("crossings", [1, 2])
def test_on_a_curve_lie_orbits_that_cross_the_section_as_often(crossings: int) -> None:
    claim = Claim("symmetric-arc", "S", crossings=crossings)
    (found,) = concluded(symmetric_arc(claim), certificate(circle_point(0.7))).bifurcations
    assert (found.place is not None) == (crossings == 1)
    assert ("meet the section 1 times, those of the curve 2" in found.reason) == (crossings == 2)


def test_a_derived_parameter_is_known_to_half_its_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    wide = Root(Fraction(1, 4), Fraction(3, 4))
    monkeypatch.setattr(libration_point, "derived_parameter", lambda *_: wide)
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 4, width=2)
    assert arb(parameter_series(arithmetic, SYSTEM, MASS)[NAME].errors[0]) >= arb(0.25)


SEARCHES: Mapping[str, tuple[int, Fraction, Fraction]] = {
    "the zero": (0, Fraction(-1, 4), Fraction(1, 4)),
    "nothing but negative values": (0, Fraction(-1, 2), Fraction(-1, 4)),
    "nothing but positive values": (0, Fraction(1, 4), Fraction(1, 2)),
    "a place beyond the lower end": (-3, Fraction(-5, 4), Fraction(-1, 2)),
    "a place beyond the upper end": (3, Fraction(1, 2), Fraction(5, 4)),
}


@pytest.mark.parametrize("name", SEARCHES)
def test_what_a_search_finds_is_checked(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """4 x = n for x in (-1, 1), to 1 only: nothing is halved."""
    n, *ends = SEARCHES[name]

    def equation(x: Any, parameters: Any) -> Any:
        return (4 * x[0] - n + 0 * parameters[0],)

    definition = DerivedParameter(equation=equation, interval=lambda _: (-1, 1))
    system = replace(SYSTEM, derived_parameters={NAME: definition})
    monkeypatch.setattr(libration_point._Search, "_first", lambda _, wanted, bits: ends[wanted > 0])
    if name == "the zero":
        assert derived_parameter(system, NAME, MASS, 0) == Root(*ends)
    else:
        with pytest.raises(IntegrationFailure, match="was not enclosed"):
            derived_parameter(system, NAME, MASS, 0)
