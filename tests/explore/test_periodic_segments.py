"""Periodic orbits shot in segments: where errors grow too much for one shot over the period."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from orbitproof.explore.periodic import (
    FOLD,
    ClosedOrbit,
    PeriodicFailure,
    PeriodicProblem,
    PeriodicRequest,
    continue_orbit,
    correct,
    correct_in_segments,
    find_periodic,
    refine_bifurcation,
    refined,
)
from orbitproof.explore.periodic.flow import growth_in_frames, stiff_path
from orbitproof.explore.periodic.segments import nodes_of, segments_for
from orbitproof.shared.formats import define_system
from orbitproof.verify import certify

UNSTABLE = define_system(
    {
        "name": "unstable", "state": "x y u", "parameters": "k",
        "field": {"x": "x*s - y", "y": "x + y*s", "u": "2*x*(x*s - y) + k*(u - x**2)"},
        "where": {"s": "1 - x**2 - y**2"},
    }
)  # fmt: skip
"""The circle with u = x^2; errors of u grow by exp(2 pi k) over the period."""
ANGLES = np.linspace(0.3, 0.3 + 2 * np.pi, 257)


GUESS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.cos(ANGLES) ** 2 + 1e-3])
CANARDS = define_system(
    {
        "name": "fitzhugh-nagumo", "state": "v w", "parameters": "eps I",
        "field": {"v": "v - v**3/3 - w + I", "w": "eps*(v + 7/10 - 4/5*w)"},
    }
)  # fmt: skip
OREGONATOR = define_system(
    {
        "name": "oregonator", "state": "x y z", "parameters": "eps delta q f",
        "field": {"x": "(q*y - x*y + x*(1 - x))/eps", "y": "(-q*y - x*y + f*z)/delta", "z": "x - z"},
    }
)  # fmt: skip


def _is_the_circle(orbit: ClosedOrbit, k: float) -> None:
    assert orbit.nodes is not None
    assert orbit.period == pytest.approx(2 * np.pi, abs=1e-10)
    assert np.abs(orbit.nodes[:, 2] - orbit.nodes[:, 0] ** 2).max() < 1e-10
    assert np.abs(orbit.loop[:, 0] ** 2 + orbit.loop[:, 1] ** 2 - 1).max() < 1e-6
    assert abs(orbit.multipliers[0]) == pytest.approx(np.exp(2 * np.pi * k), rel=1e-8)


def test_an_orbit_that_amplifies_errors_by_fourteen_digits_is_found_in_segments() -> None:
    problem = PeriodicProblem(UNSTABLE, {"k": Fraction(5)})
    _is_the_circle(correct(problem, nodes_of(GUESS, 16), 6.28), 5)


@pytest.mark.slow
def test_a_family_is_followed_to_where_one_shot_does_not_close() -> None:
    problem = PeriodicProblem(UNSTABLE, {"k": Fraction(5)})
    with pytest.raises(PeriodicFailure, match="too unstable"):
        correct(problem, GUESS[0], 6.28)
    found = correct_in_segments(problem, GUESS, 6.28)
    assert found.segments == segments_for(UNSTABLE, GUESS, 6.28, problem.values) == 16
    _is_the_circle(found, 5)
    problem = PeriodicProblem(UNSTABLE, {"k": Fraction(5, 2)})
    once = correct(problem, GUESS[0], 6.28)
    assert once.segments == 1
    for orbit, (low, high) in ((once, (2.4, 5.0)), (found, (4.95, 5.05))):
        family = continue_orbit(problem, orbit, "k", (low, high))
        assert family.members[-1].value > high
        assert family.members[0].value < low
        assert not family.bifurcations
        _is_the_circle(family.members[-1].orbit, family.members[-1].value)


@pytest.mark.slow
def test_canards_are_followed_from_relaxation_to_a_hopf_point_and_proved() -> None:
    problem = PeriodicProblem(CANARDS, {"eps": Fraction(2, 25), "I": Fraction(1, 2)})
    orbit = correct(problem, (-0.1, -0.166831789881), 39.474414980242)
    family = continue_orbit(problem, orbit, "I", (0.3, 0.6))
    (hopf,) = family.hopf
    assert hopf.value == pytest.approx(0.331281337454746, abs=1e-12)
    (fold,) = family.bifurcations
    assert fold.kind == FOLD
    assert fold.value == pytest.approx(0.32417852250371, abs=1e-13)
    # Within 1e-11 of the fold there are canards without a head and with one.
    inside = [each for each in family.members if abs(each.value - fold.value) < 1e-11]
    assert min(each.orbit.period for each in inside) < 66
    assert len(inside) > 20
    claim = refine_bifurcation(fold, "fold", 50)
    (certificate,) = certify(claim, quiet=True)
    assert certificate.proved, certificate.reason
    chosen = next(each for each in inside if each.orbit.multipliers[0].real > 10)
    request = PeriodicRequest(
        CANARDS, {"eps": Fraction(2, 25), "I": Fraction(chosen.value)}, tuple(chosen.orbit.point), chosen.orbit.period
    )
    (found,) = find_periodic(request, lambda _message, _fraction: None)
    canard = refined(found, "canard", 50)
    assert max(canard.radii) < Fraction(1, 10**30)
    (certificate,) = certify(canard, quiet=True)
    assert certificate.proved, certificate.reason


def test_errors_in_frames_grow_as_solutions_do_and_not_by_the_worst_rates() -> None:
    field = {"u": "1", "x": "3*u*x", "y": "-50*y + 1000*x"}
    shear = define_system({"name": "shear", "state": "u x y", "field": field})
    states = np.column_stack([np.linspace(-1, 1, 257), np.zeros(257), np.zeros(257)])
    # Errors that are made at u = 0 grow by exp(3/2), those of y are some 20 times those of x; the worst rate is 475.
    assert 1.5 / np.log(10) < growth_in_frames(shear, states, 2.0, ()) < 5


@pytest.mark.slow
def test_the_oregonator_with_three_variables_is_found_and_proved() -> None:
    """The scales of Tyson, and milder ones: the fast rates of a period add up to some 200,000 and 10,000."""
    start, orbits = (0.5, 0.5, 0.5), []
    tyson = {"eps": Fraction("0.0099"), "delta": Fraction("1.98e-5"), "q": Fraction("7.62e-5"), "f": Fraction(1)}
    milder = {"eps": Fraction("0.04"), "delta": Fraction("4e-4"), "q": Fraction("8e-4"), "f": Fraction(1)}
    for values, period in ((milder, 6.20943640513), (tyson, 7.736523599)):
        stiff_path(OREGONATOR, start, 20.0, [float(value) for value in values.values()])
        request = PeriodicRequest(OREGONATOR, values, start, transient=20)
        (found,) = find_periodic(request, lambda _message, _fraction: None)
        assert found.orbit.period == pytest.approx(period, rel=1e-9)
        orbits.append(found)
    assert orbits[1].orbit.segments > 1
    (certificate,) = certify(refined(orbits[0], "oregonator", 30), quiet=True)
    assert certificate.proved, certificate.reason
