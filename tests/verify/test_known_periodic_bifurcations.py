"""Folds, doublings and pitchforks of maps in random coordinates, with what is known of them: proved as they are.

The maps stand for return maps of x' = 0, t' = 1: every function of x is a first integral, and linear maps of x are
symmetries.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.known_bifurcations import (
    BITS,
    CASES,
    ONE,
    SETTINGS,
    WIDTH,
    ZERO,
    case,
    claim_of,
    outcome_of,
)
from support.normal_form_maps import KnownBifurcation, derivatives_at, known_bifurcation, seen_from
from support.told import in_full

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import (
    NotProved,
    Proved,
    enclose,
    guarded,
    index_factorial,
)
from orbitproof.verify.periodic import Linearised, Multipliers, SectionReturn
from orbitproof.verify.periodic_bifurcation import (
    PeriodicBifurcationResults,
    PeriodicBifurcationTheorem,
)


def _proved(known: KnownBifurcation, claim: PeriodicBifurcation) -> PeriodicBifurcationResults:
    outcome = outcome_of(known, claim)
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


def _is(ball: arb, value: Fraction) -> bool:
    with ctx.workprec(400):
        return bool(agree(ball, enclose(value))) and bool(ball.rad() < 1e-10)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("kind", "setting"), CASES)
def test_maps_with_a_known_bifurcation_are_proved_with_all_that_is_known(kind: str, setting: str, seed: int) -> None:
    known, claim = case(kind, setting, seed)
    found = _proved(known, claim)
    assert _is(found.opening, known.opening)
    assert found.side == ("above" if known.opening > 0 else "below")
    assert _is(found.parameter, ZERO)
    for name, value in zip(claim.system.state, claim.centre, strict=True):
        assert _is(found.point[name], value)
    assert _is(found.period, ONE + (kind == "moved"))
    assert found.known == (-1 if kind == "periodic-doubling" else 1)
    assert found.is_fixed is {"fixed": True, "moved": False}.get(kind)
    assert found.multipliers.trivial == 1 + (setting != "free")
    if kind == "periodic-fold" or setting != "free":
        assert found.criticality is None
    else:
        assert found.criticality == ("supercritical" if known.bend > 0 else "subcritical")
    assert (found.level_name, found.level) == (
        ("first integral", 0) if setting == "parameter on a level" else ("", None)
    )
    _check_multipliers(found, known.others)


def _check_multipliers(found: PeriodicBifurcationResults, others: Sequence[Fraction]) -> None:
    """All of them, in any order; two that are the same are not counted."""
    values = sorted(found.multipliers.values, key=lambda value: float(value.real.mid()))
    for ball, value in zip(values, sorted(others), strict=True):
        with ctx.workprec(400):
            assert agree(ball.real, enclose(value))
            assert ball.imag.contains(0)
    if len(set(others)) == len(others):
        assert found.multipliers.inside == sum(abs(value) < 1 for value in others)
        assert found.multipliers.outside == sum(abs(value) > 1 for value in others)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
@pytest.mark.parametrize("by", [Fraction(-2), Fraction(3)])
def test_an_eigenvector_of_another_length_changes_the_opening_by_its_square(kind: str, by: Fraction) -> None:
    known, claim = case(kind, "free", 1)
    (kernel,) = claim.kernel
    found = _proved(known, replace(claim, kernel=(tuple(by * value for value in kernel),)))
    assert _is(found.opening, by * by * known.opening)
    assert found.side == ("above" if known.opening > 0 else "below")


def _return(claim: PeriodicBifurcation, crossings: int, distance: int) -> SectionReturn:
    """The centre, and so the point, comes to the distance from it in its last coordinate."""
    size = len(claim.radii)
    slopes = (arb(0),) * (size + (claim.parameter is not None))
    image = tuple(Linearised(arb(distance if place == size - 1 else 0), slopes) for place in range(size))
    return SectionReturn(crossings, image, Linearised(arb(1) / 2, slopes))


@pytest.mark.parametrize(("kind", "setting"), CASES)
def test_every_earlier_return_is_looked_at(kind: str, setting: str) -> None:
    known, claim = case(kind, setting, 0)
    claim = replace(claim, crossings=6)
    for distances, condition in (((1, 1), None), ((0, 1), "least-period"), ((1, 0), "least-period")):
        earlier = tuple(_return(claim, each, by) for each, by in zip((2, 3), distances, strict=True))
        outcome = outcome_of(known, claim, earlier)
        assert (outcome.reason.condition if isinstance(outcome, NotProved) else None) == condition
        for missing in (earlier[:1], earlier[1:], (*earlier, earlier[1])):
            refused = outcome_of(known, claim, missing)
            assert isinstance(refused, NotProved)
            assert refused.reason.condition == "return-map"


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_an_earlier_return_is_complete_and_finite(kind: str) -> None:
    known, claim = case(kind, "free", 1)
    claim = replace(claim, crossings=2)
    whole = _return(claim, 1, 1)
    first, *others = whole.image
    assert isinstance(outcome_of(known, claim, (whole,)), Proved)
    for changed in (
        replace(whole, image=tuple(others)),
        replace(whole, image=(replace(first, slopes=first.slopes[1:]), *others)),
        replace(whole, image=(replace(first, centre=arb("nan")), *others)),
        replace(whole, time=replace(whole.time, centre=arb("inf"))),
        replace(whole, time=replace(whole.time, slopes=(*whole.time.slopes, arb(0)))),
    ):
        outcome = outcome_of(known, claim, (changed,))
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "return-map"


def _seen_from(known: KnownBifurcation, origin: Sequence[Fraction]) -> KnownBifurcation:
    """The map about another point (p, a), in coordinates that are 0 there."""
    integral = None
    if known.integral is not None:
        found = derivatives_at({i: value * index_factorial(i) for i, value in known.integral.items()}, origin)
        integral = {index: value / index_factorial(index) for index, value in found.items()}
    return replace(known, derivatives=seen_from(known.derivatives, origin), integral=integral)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
@pytest.mark.parametrize("setting", SETTINGS)
def test_what_is_found_does_not_depend_on_the_centre(kind: str, setting: str, seed: int) -> None:
    known, claim = case(kind, setting, seed)
    chance = random.Random(f"{kind} {setting} {seed} elsewhere")
    wide = Fraction(1, 2**40)
    by = [wide * chance.choice([-1, 1]) / 64 for _ in range(len(claim.radii) + 1)]
    centre = tuple(
        x + sum((a * b for a, b in zip(row, by, strict=False)), ZERO)
        for x, row in zip(claim.centre, claim.frame, strict=True)
    )
    changes: dict[str, Any] = {"centre": centre, "kernel_radius": Fraction(1, 2**20)}
    changes |= {"radii": (wide,) * len(claim.radii), "parameter_radius": wide}
    changes |= {"level": by[-1]} if claim.parameter is None else {"parameters": {"a": by[-1]}}
    seen = _seen_from(known, [*by[:-1], ZERO if claim.parameter is None else by[-1]])
    found = _proved(seen, replace(claim, **changes))
    with guarded(BITS):
        assert agree(found.opening, enclose(known.opening))
        assert found.parameter.contains(0)
        assert all(found.point[name].contains(0) for name in claim.system.state)
        assert found.opening.rad() < 2.0**-50 * (1 + abs(found.opening))
        assert found.parameter.rad() < 1e-18


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_a_narrow_box_of_eigenvectors_is_enough(kind: str) -> None:
    """Over the box the eigenvector moves farther: wherever the multiplier is one, its eigenvector is there."""
    known, claim = case(kind, "free", 0)
    found = _proved(known, replace(claim, kernel_radius=WIDTH / 2**30))
    assert _is(found.opening, known.opening)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_a_box_of_eigenvectors_with_the_vector_0_is_refused(kind: str) -> None:
    """There the derivative of the equations is singular."""
    known, claim = case(kind, "free", 0)
    outcome = outcome_of(known, replace(claim, kernel_radius=Fraction(2**10)))
    assert isinstance(outcome, NotProved)
    assert (outcome.reason.condition, outcome.reason.excluded) == ("bifurcation", False)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_an_eigenvector_that_is_elsewhere_excludes_nothing(kind: str) -> None:
    known, claim = case(kind, "free", 0)
    (kernel,) = claim.kernel
    for place in range(2):
        moved = tuple(value + (i == place) * Fraction(1, 2**20) for i, value in enumerate(kernel))
        outcome = outcome_of(known, replace(claim, kernel=(moved,), kernel_radius=Fraction(1, 2**24)))
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "bifurcation"
        assert not outcome.reason.excluded


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_another_multiplier_is_refused(kind: str) -> None:
    known, claim = case(kind, "free", 1)
    other: Any = "periodic-doubling" if kind == "periodic-fold" else "periodic-fold"
    outcome = outcome_of(known, replace(claim, kind=other))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"


def test_a_second_multiplier_of_the_same_value_is_refused() -> None:
    for sigma, kind in ((1, "periodic-fold"), (-1, "periodic-doubling")):
        known = known_bifurcation(sigma, 2, random.Random(3), others=(Fraction(sigma),))
        assert isinstance(outcome_of(known, claim_of(known, kind)), NotProved)


def test_a_multiplier_1_at_a_doubling_is_refused() -> None:
    known = known_bifurcation(-1, 2, random.Random(3), others=(ONE,))
    assert isinstance(outcome_of(known, claim_of(known, "periodic-doubling")), NotProved)


def test_a_multiplier_minus_1_at_a_fold_is_not_called_inside() -> None:
    known = known_bifurcation(1, 2, random.Random(3), others=(-ONE,))
    found = _proved(known, claim_of(known, "periodic-fold"))
    assert (found.multipliers.inside, found.multipliers.outside, found.multipliers.undecided) == (0, 0, 1)
    assert not found.multipliers.is_attracting


def test_where_the_criticality_is_not_known_nothing_is_called_stable() -> None:
    known, claim = case("periodic-doubling", "free", 1)
    found = replace(_proved(known, claim), multipliers=Multipliers((), 0, 0, 0, 0, 1))
    theorem = PeriodicBifurcationTheorem(claim)
    assert "stable" in in_full(claim, theorem, found)
    assert "stable" not in in_full(claim, theorem, replace(found, criticality=None))
