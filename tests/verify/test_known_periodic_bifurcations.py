"""Folds, doublings and pitchforks of maps in random coordinates, with what is known of them: proved as they are.

The maps stand for return maps of x' = 0, t' = 1: every function of x is a first integral, and linear maps of x are
symmetries.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from support.normal_form_maps import KnownBifurcation, Polynomial, derivatives_at, known_bifurcation, seen_from
from support.told import in_full

from orbitproof.shared.formats import PeriodicBifurcation, define_system
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    enclose,
    guarded,
    index_factorial,
    indices_up_to,
    symmetric,
    total,
)
from orbitproof.verify.periodic import Linearised, Multipliers, SectionReturn
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    PeriodicBifurcationResults,
    PeriodicBifurcationTheorem,
    check_bifurcation_exactly,
    prove_periodic_bifurcation,
)

BITS = 200
ZERO, ONE = Fraction(0), Fraction(1)
WIDTH = Fraction(1, 2**60)


def _claim(known: KnownBifurcation, kind: str, **more: Any) -> PeriodicBifurcation:
    size = len(known.derivatives)
    names = [f"x{place}" for place in range(size)]
    description: dict[str, Any] = {
        "name": "map",
        "state": [*names, "t"],
        "parameters": "a",
        "field": {**dict.fromkeys(names, "0*t"), "t": "1 + t**2"},
    }
    if known.integral is not None:
        description["first_integral"] = _written(known.integral, [*names, "a"])
    claim: dict[str, Any] = {
        "id": "map",
        "system": define_system(description),
        "parameters": {"a": ZERO},
        "parameter": "a",
        "normal": (ZERO,) * size + (ONE,),
        "offset": ZERO,
        "direction": 1,
        "crossings": 1,
        "centre": (ZERO,) * (size + 1),
        "frame": tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size + 1)),
        "radii": (WIDTH,) * size,
        "kind": kind,
        "kernel": (known.eigenvector,),
        "kernel_radius": Fraction(1, 2**20),
        "parameter_radius": WIDTH,
    }
    return PeriodicBifurcation(**(claim | more))


def _written(polynomial: Polynomial, names: list[str]) -> str:
    terms = []
    for index, value in polynomial.items():
        powers = [name for name, power in zip(names, index, strict=True) for _ in range(power)]
        terms.append("*".join([f"({value.numerator})/{value.denominator}", *powers]))
    return " + ".join(terms)


def _enclosures(known: KnownBifurcation, claim: PeriodicBifurcation) -> BifurcationEnclosures:
    """As if the map were the return map of the claim."""
    varies = claim.parameter is not None
    sides = list(map(symmetric, (*claim.radii, *([claim.parameter_radius] if varies else []))))
    indices = indices_up_to(len(sides), 3)

    def table(values: Mapping[tuple[int, ...], Fraction]) -> DerivativeTable:
        known_here = {index if varies else index[:-1]: x for index, x in values.items() if varies or not index[-1]}
        centre = {index: enclose(known_here.get(index, ZERO)) for index in indices}
        return DerivativeTable({index: _over(centre, index, sides) for index in indices}, centre)

    integral = None
    if known.integral is not None:
        integral = table({index: value * index_factorial(index) for index, value in known.integral.items()})
    time = table({(0,) * (len(claim.radii) + 1): ONE})
    return BifurcationEnclosures((), tuple(map(table, known.derivatives)), time, integral, 1, BITS, 1)


def _over(centre: dict[tuple[int, ...], arb], index: tuple[int, ...], sides: list[arb]) -> arb:
    """The derivative of a polynomial of degree 3 on a box."""
    terms = []
    for shift in indices_up_to(len(index), 3 - sum(index)):
        term = centre[tuple(map(sum, zip(index, shift, strict=True)))] / index_factorial(shift)
        for side, power in zip(sides, shift, strict=True):
            for _ in range(power):
                term = term * side
        terms.append(term)
    return total(terms)


def _outcome(
    known: KnownBifurcation, claim: PeriodicBifurcation, earlier: tuple[SectionReturn, ...] = ()
) -> Outcome[PeriodicBifurcationResults]:
    checklist = Checklist()
    with guarded(BITS):
        try:
            check_bifurcation_exactly(checklist, claim)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        return prove_periodic_bifurcation(claim, checklist, replace(_enclosures(known, claim), earlier=earlier))


def _proved(known: KnownBifurcation, claim: PeriodicBifurcation) -> PeriodicBifurcationResults:
    outcome = _outcome(known, claim)
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


SETTINGS = ["free", "level", "parameter on a level"]
KINDS = ["periodic-fold", "periodic-doubling", "fixed", "moved"]
CASES = [(kind, setting) for kind in KINDS for setting in SETTINGS if (kind, setting[-5:]) != ("moved", "level")]


def _case(kind: str, setting: str, seed: int) -> tuple[KnownBifurcation, PeriodicBifurcation]:
    """A map of two or three coordinates and a claim about it; its other multipliers as those of the orbit."""
    chance = random.Random(f"{kind} {setting} {seed}")
    size, on_level = 2 + seed % 2, setting != "free"
    signs = (-1, *(chance.choice([1, -1]) for _ in range(1, size - on_level)), *([1] if on_level else []))
    known = known_bifurcation(
        1 if kind == "periodic-fold" else -1, size, chance, on_level, setting == "level",
        signs if kind == "fixed" else None,
    )  # fmt: skip
    more: dict[str, Any] = {"free": {}, "level": {"parameter": None, "level": ZERO}}.get(setting, {"level": ZERO})
    if kind == "fixed":
        more["symmetry"] = _diagonal(*signs, 1)
        others = tuple(value * sign for value, sign in zip(known.others, signs[1:], strict=False))
        known = replace(known, others=others)
    if kind == "moved":
        more |= {"symmetry": _diagonal(*[-1] * size, 1), "centre": (ONE,) * size + (ZERO,)}
        known = replace(known, others=tuple(value**2 for value in known.others))
    return known, _claim(known, kind if kind.startswith("periodic") else "periodic-pitchfork", **more)


def _diagonal(*entries: int) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(Fraction(entry * (i == j)) for j in range(len(entries))) for i, entry in enumerate(entries))


def _is(ball: arb, value: Fraction) -> bool:
    with ctx.workprec(400):
        return bool(ball.overlaps(enclose(value))) and bool(ball.rad() < 1e-10)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("kind", "setting"), CASES)
def test_maps_with_a_known_bifurcation_are_proved_with_all_that_is_known(kind: str, setting: str, seed: int) -> None:
    known, claim = _case(kind, setting, seed)
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
            assert ball.real.overlaps(enclose(value))
            assert ball.imag.contains(0)
    if len(set(others)) == len(others):
        assert found.multipliers.inside == sum(abs(value) < 1 for value in others)
        assert found.multipliers.outside == sum(abs(value) > 1 for value in others)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
@pytest.mark.parametrize("by", [Fraction(-2), Fraction(3)])
def test_an_eigenvector_of_another_length_changes_the_opening_by_its_square(kind: str, by: Fraction) -> None:
    known, claim = _case(kind, "free", 1)
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
    known, claim = _case(kind, setting, 0)
    claim = replace(claim, crossings=6)
    for distances, condition in (((1, 1), None), ((0, 1), "least-period"), ((1, 0), "least-period")):
        earlier = tuple(_return(claim, each, by) for each, by in zip((2, 3), distances, strict=True))
        outcome = _outcome(known, claim, earlier)
        assert (outcome.reason.condition if isinstance(outcome, NotProved) else None) == condition
        for missing in (earlier[:1], earlier[1:], (*earlier, earlier[1])):
            refused = _outcome(known, claim, missing)
            assert isinstance(refused, NotProved)
            assert refused.reason.condition == "return-map"


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_an_earlier_return_is_complete_and_finite(kind: str) -> None:
    known, claim = _case(kind, "free", 1)
    claim = replace(claim, crossings=2)
    whole = _return(claim, 1, 1)
    first, *others = whole.image
    assert isinstance(_outcome(known, claim, (whole,)), Proved)
    for changed in (
        replace(whole, image=tuple(others)),
        replace(whole, image=(replace(first, slopes=first.slopes[1:]), *others)),
        replace(whole, image=(replace(first, centre=arb("nan")), *others)),
        replace(whole, time=replace(whole.time, centre=arb("inf"))),
        replace(whole, time=replace(whole.time, slopes=(*whole.time.slopes, arb(0)))),
    ):
        outcome = _outcome(known, claim, (changed,))
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
    known, claim = _case(kind, setting, seed)
    chance = random.Random(f"{kind} {setting} {seed} elsewhere")
    wide = Fraction(1, 2**40)
    by = [wide * chance.choice([-1, 1]) / 64 for _ in range(len(claim.radii) + 1)]
    changes: dict[str, Any] = {"centre": (*by[:-1], ZERO), "kernel_radius": Fraction(1, 2**20)}
    changes |= {"radii": (wide,) * len(claim.radii), "parameter_radius": wide}
    changes |= {"level": by[-1]} if claim.parameter is None else {"parameters": {"a": by[-1]}}
    seen = _seen_from(known, [*by[:-1], ZERO if claim.parameter is None else by[-1]])
    found = _proved(seen, replace(claim, **changes))
    with guarded(BITS):
        assert found.opening.overlaps(enclose(known.opening))
        assert found.parameter.contains(0)
        assert all(found.point[name].contains(0) for name in claim.system.state)
        assert found.opening.rad() < 2.0**-50 * (1 + abs(found.opening))
        assert found.parameter.rad() < 1e-18


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_a_narrow_box_of_eigenvectors_is_enough(kind: str) -> None:
    """Over the box the eigenvector moves farther: wherever the multiplier is one, its eigenvector is there."""
    known, claim = _case(kind, "free", 0)
    found = _proved(known, replace(claim, kernel_radius=WIDTH / 2**30))
    assert _is(found.opening, known.opening)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_a_box_of_eigenvectors_with_the_vector_0_is_refused(kind: str) -> None:
    """There the derivative of the equations is singular."""
    known, claim = _case(kind, "free", 0)
    outcome = _outcome(known, replace(claim, kernel_radius=Fraction(2**10)))
    assert isinstance(outcome, NotProved)
    assert (outcome.reason.condition, outcome.reason.excluded) == ("bifurcation", False)


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_an_eigenvector_that_is_elsewhere_excludes_nothing(kind: str) -> None:
    known, claim = _case(kind, "free", 0)
    (kernel,) = claim.kernel
    for place in range(2):
        moved = tuple(value + (i == place) * Fraction(1, 2**20) for i, value in enumerate(kernel))
        outcome = _outcome(known, replace(claim, kernel=(moved,), kernel_radius=Fraction(1, 2**24)))
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "bifurcation"
        assert not outcome.reason.excluded


@pytest.mark.parametrize("kind", ["periodic-fold", "periodic-doubling"])
def test_another_multiplier_is_refused(kind: str) -> None:
    known, claim = _case(kind, "free", 1)
    other: Any = "periodic-doubling" if kind == "periodic-fold" else "periodic-fold"
    outcome = _outcome(known, replace(claim, kind=other))
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "bifurcation"


def test_a_second_multiplier_of_the_same_value_is_refused() -> None:
    for sigma, kind in ((1, "periodic-fold"), (-1, "periodic-doubling")):
        known = known_bifurcation(sigma, 2, random.Random(3), others=(Fraction(sigma),))
        assert isinstance(_outcome(known, _claim(known, kind)), NotProved)


def test_a_multiplier_1_at_a_doubling_is_refused() -> None:
    known = known_bifurcation(-1, 2, random.Random(3), others=(ONE,))
    assert isinstance(_outcome(known, _claim(known, "periodic-doubling")), NotProved)


def test_a_multiplier_minus_1_at_a_fold_is_not_called_inside() -> None:
    known = known_bifurcation(1, 2, random.Random(3), others=(-ONE,))
    found = _proved(known, _claim(known, "periodic-fold"))
    assert (found.multipliers.inside, found.multipliers.outside, found.multipliers.undecided) == (0, 0, 1)
    assert not found.multipliers.is_attracting


def test_where_the_criticality_is_not_known_nothing_is_called_stable() -> None:
    known, claim = _case("periodic-doubling", "free", 1)
    found = replace(_proved(known, claim), multipliers=Multipliers((), 0, 0, 0, 0, 1))
    theorem = PeriodicBifurcationTheorem(claim)
    assert "stable" in in_full(claim, theorem, found)
    assert "stable" not in in_full(claim, theorem, replace(found, criticality=None))
