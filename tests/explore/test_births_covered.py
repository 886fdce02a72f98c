"""The curves of orbits that are born at Hopf points, found and proved (section 38)."""

from __future__ import annotations

import cmath
from fractions import Fraction as Q
from math import exp
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from support import birth_cases
from support.balls import agree

from orbitproof import explore
from orbitproof.explore.periodic import birth_curve, cover_birth
from orbitproof.explore.periodic.atlas import CurveControl
from orbitproof.shared.claims import BirthAtlas
from orbitproof.shared.formats import define_system, read_atlas, write_atlas
from orbitproof.shared.systems import AMPLITUDE
from orbitproof.verify.birth_curve import BirthLimits, ProvedBirthCurve, conclude_births, prove_birth_curve_piece
from orbitproof.verify.curve import IntervalResult
from orbitproof.verify.evidence import Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.run.splitting import halves

LIVES: dict[str, tuple[dict[str, Any], dict[str, Any], dict[str, Any], str, tuple[float, float], float]] = {
    "brusselator": (
        {"name": "brusselator", "state": "x y", "parameters": "A B",
         "field": {"x": "A - (B + 1)*x + x**2*y", "y": "B*x - x**2*y"}},
        {"x": 1.75, "y": 2.3}, {"A": "7/4", "B": 4}, "A", (1.65, 2.5), 3.0**0.5,
    ),
    "lorenz": (
        {"name": "lorenz", "state": "x y z", "parameters": "sigma rho beta",
         "field": {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}},
        {"x": 8, "y": 8, "z": 25}, {"sigma": 10, "rho": 26, "beta": "8/3"}, "rho", (24.5, 30), 470 / 19,
    ),
    "lure": (
        {"name": "lure", "state": "x y z", "parameters": "alpha beta",
         "field": {"x": "y", "y": "z", "z": "-alpha*z - beta*y - x + x**2"}},
        {"x": 0, "y": 0, "z": 0}, {"alpha": "6/5", "beta": 1}, "alpha", (0.99, 1.4), 1.0,
    ),
}  # fmt: skip
"""A system, a start, its parameters, the one that varies and its interval, and the Hopf point."""


def results_of(atlas: BirthAtlas, limits: BirthLimits) -> list[IntervalResult]:
    """All pieces, halved where that is needed."""
    found, pending = [], [(piece, (Q(-1), Q(1)), 0) for piece in atlas.curve_pieces()]
    while pending:
        piece, interval, depth = pending.pop()
        result = prove_birth_curve_piece(atlas, piece, interval, ORACLE, limits).stored
        if result.is_proved or depth > 3:
            found.append(result)
        else:
            pending += [(piece, half, depth + 1) for half in halves(interval)]
    return found


def proved(atlas: BirthAtlas, limits: BirthLimits) -> ProvedBirthCurve:
    outcome = conclude_births(atlas, results_of(atlas, limits)).outcome
    assert isinstance(outcome, Proved), outcome
    found: ProvedBirthCurve = outcome.results
    return found


def hopf_of(system: Any, start: Any, parameters: Any, name: str, bounds: tuple[float, float]) -> Any:
    found = explore.find_equilibria(system, start, parameters=parameters, quiet=True)
    (hopf,) = explore.follow_equilibrium(found[0], name, bounds, quiet=True).hopf
    return hopf


def test_a_curve_of_circles_begins_where_they_are_born(tmp_path: Path) -> None:
    """Exactly at amplitude 0; it is written and read again."""
    system, bounds = birth_cases.circles("a", "2"), (-0.5, 0.01)
    hopf = hopf_of(system, {"x": 0.0, "y": 0.0}, {"a": "-1/10"}, "a", bounds)
    covered = cover_birth(hopf, bounds, "circles", CurveControl(most=1, widest=0.5))
    atlas = covered.atlas
    assert isinstance(atlas, BirthAtlas)
    piece, place = atlas.curve_pieces()[0], atlas.coordinates.index(AMPLITUDE)
    assert piece.frame[place][0] * piece.half_width == piece.centre[place]
    assert not any(piece.frame[place][1:])
    assert "birth" in covered.ends[0]
    write_atlas(tmp_path / "a.json", atlas)
    assert read_atlas(tmp_path / "a.json") == atlas


@pytest.mark.parametrize("function", ["sin", "cos", "exp", "log"])
def test_mean_slopes_are_those_of_differences(function: str) -> None:
    """And derivatives where there is no difference; their derivatives follow by a complex step."""
    apply = getattr(cmath, function)
    for at, change in ((1.25, 0.0), (1.0, 1e-3), (0.5, 2.0), (2.0, -1.5), (3.0, 0.75)):
        found = birth_curve._mean_slope(function, complex(at), complex(change))
        expected = (apply(at + change) - apply(at)) / change if change else apply(at + 1e-30j).imag / 1e-30
        assert abs(found - expected) < 1e-12 + (change == 1e-3) * 1e-10
        moved = birth_curve._mean_slope(function, complex(at), change + 1e-30j).imag / 1e-30
        after, before = (birth_curve._mean_slope(function, complex(at), change + step) for step in (1e-5, -1e-5))
        assert abs(moved - (after - before).real / 2e-5) < 1e-8


@pytest.mark.slow
def test_circles_in_bent_coordinates_are_covered() -> None:
    """Those of log(x) and y: at the exact place, with further coordinates that begin as they must."""
    system, bounds = birth_cases.bent_circles("log(x)", "x", Q(1)).system, (-0.5, 0.01)
    hopf = hopf_of(system, {"x": 1.0, "y": 0.0}, {"a": "-1/10"}, "a", bounds)
    atlas = cover_birth(hopf, bounds, "bent", CurveControl(most=1, widest=0.5)).atlas
    assert isinstance(atlas, BirthAtlas)
    found = proved(atlas, BirthLimits(precision=96, order=40, width=28, top=2))
    assert found.frequency.contains(1)
    assert agree(found.period, 2 * arb.pi())


@pytest.mark.slow
@pytest.mark.parametrize("name", LIVES)
def test_orbits_are_proved_from_their_birth_on(name: str) -> None:
    described, start, parameters, varies, bounds, value = LIVES[name]
    hopf = hopf_of(define_system(described), start, parameters, varies, bounds)
    covered = cover_birth(hopf, bounds, name, CurveControl(most=1))
    assert isinstance(covered.atlas, BirthAtlas)
    found = proved(covered.atlas, BirthLimits(precision=96, order=40, width=28, top=2))
    assert abs(found.ends["start"][varies] - value) < 1e-8
    assert found.ends["start"][AMPLITUDE] == 0
    assert found.ends["end"][AMPLITUDE] > arb(0.1)
    assert found.ends["end"][varies] < found.ends["start"][varies]
    assert abs(found.frequency - hopf.frequency) < 1e-8


NEURON = {
    "name": "neuron", "state": "v w", "parameters": "I a b e",
    "field": {"v": "v - v**3/3 - w + I", "w": "e*(v + a - b*w)"},
}  # fmt: skip
FOLD = 0.473644106
"""From scipy, where the return to v = -4/5 and the derivative of what it moves by vanish."""


@pytest.mark.slow
def test_orbits_are_proved_from_their_birth_on_through_a_fold() -> None:
    """FitzHugh and Nagumo's neuron: born below, they turn back, and go on beyond the Hopf point, which is known."""
    bounds = (0.4, 0.48)
    given = {"I": "9/20", "a": "7/10", "b": "7/10", "e": "1/2"}
    hopf = hopf_of(define_system(NEURON), {"v": -1.0, "w": -0.5}, given, "I", bounds)
    covered = cover_birth(hopf, bounds, "neuron")
    assert covered.reaches
    assert isinstance(covered.atlas, BirthAtlas)
    found = proved(covered.atlas, BirthLimits())
    (turn,) = found.turns
    assert not turn.is_maximum
    assert all(FOLD - 1e-8 < value < FOLD + 1e-4 for value in turn.values)
    v = -(arb(13) / 20).sqrt()
    start = found.ends["start"]
    assert agree(start["I"], 10 * v / 7 + 1 - v + v**3 / 3)
    assert start["I"] < found.ends["end"]["I"]


@pytest.mark.slow
def test_circles_are_proved_from_one_birth_to_another() -> None:
    """Of the square of the radius a (1 - a)/4; the frequency is 1 + a."""
    hopf = hopf_of(birth_cases.born_twice().system, {"x": 0.0, "y": 0.0}, {"a": "-1/10"}, "a", (-0.5, 0.5))
    covered = cover_birth(hopf, (-0.5, 2.0), "bubble")
    assert covered.reaches
    assert isinstance(covered.atlas, BirthAtlas)
    assert covered.atlas.claim.kind == "birth-to-birth"
    found = proved(covered.atlas, BirthLimits(precision=80, order=30, width=24, top=2))
    assert found.pair_at_end is not None
    for key, a, omega in (("start", 0, found.frequency), ("end", 1, found.pair_at_end[0])):
        assert found.ends[key]["a"].contains(a)
        assert found.ends[key]["a"].rad() < 1e-8
        assert omega.contains(1 + a)
    assert found.turns == ()


@pytest.mark.slow
def test_the_orbits_of_a_reactor_are_followed_from_birth_to_birth() -> None:
    """From D = e^(-3/2) through the fold to 5 e^(-5/2), both known; of the pieces nothing is proved here."""
    reactor = {
        "name": "reactor", "state": "u v", "parameters": "D B c", "where": {"k": "D*(1 - u)*exp(v)"},
        "field": {"u": "k - u", "v": "B*k - v - c*v"},
    }  # fmt: skip
    hopf = hopf_of(define_system(reactor), {"u": 0.4, "v": 1.2}, {"D": "21/100", "B": 12, "c": 3}, "D", (0.2, 0.24))
    covered = cover_birth(hopf, (0.2, 0.5), "reactor")
    assert covered.reaches
    assert isinstance(covered.atlas, BirthAtlas)
    assert covered.atlas.claim.kind == "birth-to-birth"
    first, *_, last = covered.atlas.curve_pieces()
    for piece, s, known in ((first, Q(-1), exp(-1.5)), (last, Q(1), 5 * exp(-2.5))):
        value, amplitude = (
            centre + sum(a * p for a, p in zip(row, piece.local(s), strict=True))
            for centre, row in zip(piece.centre[:2], piece.frame[:2], strict=True)
        )
        assert abs(value - known) < 1e-9
        assert amplitude == 0
    assert min(float(piece.centre[0]) for piece in covered.atlas.curve_pieces()) < 0.2205
