"""Stored results count for what they are about alone, and stored functions only if each of them is found again."""

from __future__ import annotations

from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb
from support.chain_cases import circle, parabola, symmetric_loop
from support.forgeries import atlas_certificate

from orbitproof.shared.claims import Claim, Covers
from orbitproof.verify.branches.certificate import results_for
from orbitproof.verify.branches.recheck import _contradictions, _interval_findings
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.curve import Computation, IntervalResult
from orbitproof.verify.evidence import NotKnown, Reason
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.lasting import CurveIntervalResult, TwistFunctions, unconfirmed_twist
from orbitproof.verify.lasting.reversibility import reversibility
from orbitproof.verify.periodic_curve import MultiplierFunctions, PeriodicIntervalResult, unconfirmed_multipliers
from orbitproof.verify.surface import ProvedPart, SurfaceResult
from orbitproof.verify.theorems.curve import KIND as CURVES
from orbitproof.verify.theorems.surface import KIND as SURFACES

UNKNOWN = NotKnown(Reason("multipliers", "not enclosed", ""))


def certificate_of(case: Any) -> Certificate:
    atlas, results = case
    return Certificate(atlas_certificate(atlas, results))


CASES = {
    "an arc": lambda: circle(Claim("arc"), [0.3, 0.8, 1.3]),
    "a symmetric loop": symmetric_loop,
    "levels of a parameter": parabola,
}


@pytest.mark.parametrize("name", CASES)
def test_results_count_for_the_system_the_parameters_and_the_claim_that_they_were_proved_with(name: str) -> None:
    stored = certificate_of(CASES[name]())
    atlas: Any = stored.atlas
    count = len(stored.results)
    assert count == len(atlas.pieces)
    assert results_for(stored, atlas) == list(stored.results)
    other = {key: value + Fraction(1, 10**9) for key, value in atlas.parameters.items()} or {"mu": Fraction(1, 80)}
    for change in (
        {"system": replace(atlas.system, title="another")},
        {"parameters": other},
        {"parameters": {**atlas.parameters, "more": Fraction(1)}},
        {"claim": replace(atlas.claim, crossings=2)},
        {"claim": replace(atlas.claim, symmetry="S" if atlas.claim.symmetry is None else None)},
    ):
        assert results_for(stored, replace(atlas, **change)) == [], change
    # What is said of the whole curve does not matter to a piece.
    for change in (
        {"claim": replace(atlas.claim, increasing=("y",), covers=Covers("y", Fraction(0), Fraction(1)))},
        {"id": "another", "title": "another"},
        {"pieces": tuple(reversed(atlas.pieces))},
    ):
        assert len(results_for(stored, replace(atlas, **change))) == count
    for index, piece in enumerate(atlas.pieces):
        for own in (
            {"centre": (piece.centre[0] + Fraction(1, 2**60), *piece.centre[1:])},
            {"tube": (piece.tube[0] * 2, *piece.tube[1:])},
            {"half_width": piece.half_width / 2},
            {"polynomial": ((*piece.polynomial[0], Fraction(1)), *piece.polynomial[1:])},
            {"frame": tuple(tuple(2 * entry for entry in row) for row in piece.frame)},
        ):
            pieces = [replace(piece, **own) if n == index else each for n, each in enumerate(atlas.pieces)]
            kept = results_for(stored, replace(atlas, pieces=tuple(pieces)))
            assert [result.piece for result in kept] == [each.id for each in atlas.pieces if each.id != piece.id]
    software = stored.document["software"]
    for key in set(software) - {"program"}:
        made = {**stored.document, "software": {**software, key: "another"}}
        assert results_for(Certificate(made), atlas) == []
    reworded = {**stored.document, "software": {**software, "program": "another"}}
    assert len(results_for(Certificate(reworded), atlas)) == count


def function(value: float, error: float) -> StoredFunction:
    return StoredFunction.near([arb(value), arb(1)], arb(error))


def multipliers(*values: float, error: float = 2.0**-20) -> MultiplierFunctions:
    return MultiplierFunctions(tuple(function(value, error) for value in values))


def result_of(found: Any, end: Fraction = Fraction(1)) -> PeriodicIntervalResult:
    return PeriodicIntervalResult("p", (Fraction(-1), end), "proved", Computation(1.0), multipliers=found)


def test_every_coefficient_of_multipliers_has_to_be_found_again() -> None:
    known = multipliers(1, 2, 3)
    assert not list(unconfirmed_multipliers(result_of(known), result_of(multipliers(1, 2, 3, error=2.0**-22))))
    for place in range(3):
        for other in (function(place + 1.5, 2.0**-22), function(place + 1, 2.0**-16)):
            changed = [other if n == place else each for n, each in enumerate(known.coefficients)]
            (found,) = unconfirmed_multipliers(result_of(known), result_of(MultiplierFunctions(tuple(changed))))
            assert f"coefficient {place + 1} " in found
    for fresh, why in (
        (result_of(known, Fraction(1, 2)), "on this interval"),
        (result_of(UNKNOWN), "not enclosed again"),
        (result_of(None), "not enclosed again"),
        (result_of(multipliers(1, 2)), "another number"),
    ):
        (found,) = unconfirmed_multipliers(result_of(known), fresh)
        assert why in found
    for unknown in (UNKNOWN, None):
        assert not list(unconfirmed_multipliers(result_of(unknown), result_of(None)))


def test_every_function_of_the_twist_has_to_be_found_again() -> None:
    names = [field.name for field in fields(TwistFunctions) if field.name != "odd"]
    assert names == ["twist", "exchanged", "fourth", "defect"]

    def twist(error: float) -> TwistFunctions:
        first, second, third, fourth = (function(n, error) for n in range(4))
        return TwistFunctions(first, second, third, fourth)

    known, fresh = twist(2.0**-20), twist(2.0**-22)
    assert not list(unconfirmed_twist(known, fresh))
    for place, name in enumerate(names):
        for other in (function(place + 0.5, 2.0**-22), function(place, 2.0**-16)):
            (found,) = unconfirmed_twist(known, replace(fresh, **{name: other}))  # type: ignore[arg-type]
            assert f"function {name} " in found
    (found,) = unconfirmed_twist(known, replace(fresh, odd=True))
    assert "is not confirmed" in found
    for missing in (None, UNKNOWN):
        (found,) = unconfirmed_twist(known, missing)
        assert "is not enclosed again" in found
        assert not list(unconfirmed_twist(missing, fresh))


def interval(deviation: tuple[Fraction, ...], slopes: tuple[Fraction, ...]) -> IntervalResult:
    ends = Fraction(-1), Fraction(1)
    return IntervalResult("p", ends, "proved", Computation(1.0), None, deviation, slopes, arb(3, 0.25))


def test_every_bound_of_every_coordinate_has_to_be_found_again() -> None:
    sizes = tuple(Fraction(n, 2**20) for n in (3, 4, 5))
    stored, less = interval(sizes, sizes), tuple(size - Fraction(1, 2**40) for size in sizes)
    for fresh in (stored, interval(less, less)):
        assert not list(_interval_findings(stored, fresh, CURVES))
    for place in range(3):
        more = tuple(size + Fraction(n == place, 2**60) for n, size in enumerate(sizes))
        for fresh, name in ((interval(more, sizes), "deviation"), (interval(sizes, more), "slope_deviation")):
            (found,) = _interval_findings(stored, fresh, CURVES)
            assert found.place.endswith(f", {name} {place + 1}")
    for fresh, name in ((interval(sizes[:2], sizes), "deviation"), (interval(sizes, sizes[:2]), "slope_deviation")):
        assert any(f"bounds {name}" in found.message for found in _interval_findings(stored, fresh, CURVES))


@pytest.mark.parametrize("sides", [("above", "below"), ("below", "above"), ("above", "above")])
def test_a_part_contradicts_one_of_its_halves_that_is_on_the_other_side(sides: tuple[str, str]) -> None:
    def surface(*parts: tuple[int, int, str]) -> SurfaceResult:
        own = (ProvedPart((Fraction(low), Fraction(high)), (arb(0),), side, {}) for low, high, side in parts)
        whole = Fraction(-1), Fraction(1)
        return SurfaceResult("p", whole, "proved", Computation(1.0), time=arb(3, 0.25), parts=tuple(own))

    stored, fresh = surface((-1, 1, "above")), surface((-1, 0, sides[0]), (0, 1, sides[1]))
    assert len(list(_contradictions(stored, fresh, SURFACES))) == sides.count("below")


@pytest.mark.parametrize(("value", "error", "holds"), [(0, 0, True), (1, 2, True), (1, 0, False), (2, 1, False)])
def test_what_reversibility_makes_zero_is_enclosed_with_zero(value: int, error: int, holds: bool) -> None:
    """Also where its error is said to be 0."""
    size, unknown = Fraction(value, 2**20), Fraction(error, 2**20)
    other = function(1, 2.0**-20)
    known = TwistFunctions(other, other, other, StoredFunction((size,), unknown))
    whole = Fraction(-1), Fraction(1)
    result = CurveIntervalResult("p", whole, "proved", Computation(1.0), twist=known)
    if holds:
        found = reversibility([result])
        assert found is not None
        assert found.intervals == 1
    else:
        with pytest.raises(ValueError, match="is not"):
            reversibility([result])
