"""Orbits across which others move faster than they do themselves: normal modes, linear blocks."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import cos, pi

import mpmath
import pytest

from orbitproof import explore, verify
from orbitproof.explore.refinement.half_return import half_return
from orbitproof.shared import define_system
from orbitproof.shared.systems import ReversibleSystem

MODE = Fraction(401, 10)
"""Frequency across the orbit, in units of that of the orbit."""

OSCILLATORS = {
    "name": "oscillators", "state": "x y px py", "parameters": "w",
    "field": {"x": "px", "y": "py", "px": "-x", "py": "-w**2*y"},
    "R": {"x": -1, "py": -1}, "symmetries": {"S": {"y": -1, "py": -1}}, "section": "x",
    "first_integral": "(px**2 + py**2 + x**2 + w**2*y**2)/2", "level_coordinate": "px",
}  # fmt: skip

DIAMAGNETIC_KEPLER = {
    "name": "diamagnetic-kepler", "state": "mu nu pmu pnu", "parameters": {"eps": [None, "0"]},
    "field": {
        "mu": "pmu", "nu": "pnu",
        "pmu": "2*eps*mu - mu*nu**2*(2*mu**2 + nu**2)/4", "pnu": "2*eps*nu - nu*mu**2*(mu**2 + 2*nu**2)/4",
    },
    "R": {"mu": -1, "pnu": -1}, "symmetries": {"S": {"nu": -1, "pnu": -1}}, "section": "mu",
    "family_parameter": "eps", "level_coordinate": "pmu", "fixed_level": {"value": "2", "sign": 1},
    "first_integral": "(pmu**2 + pnu**2)/2 - eps*(mu**2 + nu**2) + mu**2*nu**2*(mu**2 + nu**2)/8",
}  # fmt: skip


@pytest.fixture(scope="module")
def oscillators() -> ReversibleSystem:
    return define_system(OSCILLATORS)


def test_the_stability_across_a_fast_mode_is_that_of_the_mode(oscillators: ReversibleSystem) -> None:
    start = {"y": 0.0, "px": 1.0}
    family = explore.trace_from(oscillators, start, parameters={"w": MODE}, max_orbits=1, quiet=True)
    assert family[0].stability[0].real == pytest.approx(cos(2 * pi * float(MODE)), abs=1e-9)


def test_the_derivative_of_a_half_return_holds_its_digits_across_a_fast_mode(oscillators: ReversibleSystem) -> None:
    context = mpmath.MPContext()
    context.prec = 200
    point = [Fraction(0), Fraction(1)]
    found = half_return(oscillators, {"w": MODE}, point, context)
    angle = context.mpf(MODE.numerator) / MODE.denominator * context.pi
    # Coordinates (y, px, py): y moves as cos(w t) y + sin(w t)/w py.
    assert abs(found.derivative[0, 0] - context.cos(angle)) < context.mpf(10) ** -45
    assert abs(found.derivative[2, 0] * 10 / 401 + context.sin(angle)) < context.mpf(10) ** -45


@pytest.mark.slow
def test_the_straight_orbits_of_the_diamagnetic_kepler_problem_are_followed_to_proofs() -> None:
    system = define_system(DIAMAGNETIC_KEPLER)
    family = explore.trace_from(system, {"eps": -0.33, "nu": 0.0}, bounds={"eps": (-0.35, -0.3)}, quiet=True)
    found = explore.resonances(family, k=(1, 3, 4), quiet=True)
    places = sorted((each.k, round(float(each.point[0]), 9)) for each in found)
    assert places == [(1, -0.327850585), (3, -0.307821108), (4, -0.314651862)]
    claims = [explore.refine(each, digits=30, quiet=True) for each in found]
    assert all(proof.proved for proof in verify.certify(claims, quiet=True))
    # S fixes the straight orbits: no touch-and-go at 1:3.
    (tripling,) = [claim for claim in claims if claim.k == 3]
    assert (tripling.kind, tripling.symmetry) == ("period_tupling", "S")


QUARTIC = {
    "name": "quartic", "state": "x y px py", "parameters": "a",
    "field": {"x": "px", "y": "py", "px": "-x**3 - a*x*y**2", "py": "-y**3 - a*y*x**2"},
    "R": {"x": -1, "py": -1}, "symmetries": {"S": {"y": -1, "py": -1}}, "section": "x",
    "family_parameter": "a", "level_coordinate": "px", "fixed_level": {"value": "1/4", "sign": 1},
    "first_integral": "(px**2 + py**2)/2 + (x**4 + y**4)/4 + a*x**2*y**2/2",
}  # fmt: skip


def test_a_tripling_by_symmetry_is_claimed_of_a_point_and_nothing_else_is_proved_there() -> None:
    claim = explore.refine_at(define_system(QUARTIC), {"a": 3.7113019, "y": 0.0}, k=3, digits=30, quiet=True)
    assert (claim.kind, claim.symmetry) == ("period_tupling", "S")
    touching = replace(claim, id="touching", kind="touch_and_go", symmetry=None)
    beside = replace(claim, id="beside", centre=(claim.centre[0] + claim.radii[0] * Fraction(33, 32), claim.centre[1]))
    proofs = verify.certify([claim, touching, beside], other_boxes=0, quiet=True)
    assert [proof.proved for proof in proofs] == [True, False, False]
    assert proofs[0].side == "above"
    assert proofs[1].reason is not None
    assert proofs[1].reason.condition in ("C3", "G_11")


def test_a_stability_parameter_that_touches_minus_one_gives_a_claim_that_is_proved() -> None:
    """Across the straight orbits lies Lame's equation, with period doublings at a = 35/8 and 99/8 exactly."""
    system = define_system(QUARTIC)
    family = explore.trace_from(system, {"a": 4.2, "y": 0.0}, bounds={"a": (4.1, 4.6)}, quiet=True)
    (doubling,) = explore.resonances(family, k=2, quiet=True)
    claim = explore.refine(doubling, digits=30, quiet=True)
    assert abs(claim.centre[0] - Fraction(35, 8)) < Fraction(1, 10**25)
    (proof,) = verify.certify([claim], quiet=True)
    assert proof.proved
    assert proof.parameter is not None
    assert proof.parameter.contains(35 / 8)


def test_a_time_limit_of_the_sampling_is_told_and_what_was_found_is_kept(
    capsys: pytest.CaptureFixture[str],
) -> None:
    family = explore.trace_from(define_system(QUARTIC), {"a": 2.0, "y": 0.0}, bounds={"a": (1.9, 5.0)}, quiet=True)
    assert explore.resonances(family, k=4, sampling_timeout=1e-9) == []
    assert "sampling ended after 1e-09 s" in capsys.readouterr().err
