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
from orbitproof.verify.atlas import AtlasCertificate
from orbitproof.verify.atlas.certificate import results_for
from orbitproof.verify.curve import Computation
from orbitproof.verify.evidence import NotKnown, Reason
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.lasting import TwistFunctions, unconfirmed_twist
from orbitproof.verify.periodic_curve import MultiplierFunctions, PeriodicIntervalResult, unconfirmed_multipliers

UNKNOWN = NotKnown(Reason("multipliers", "not enclosed", ""))


def certificate_of(case: Any) -> AtlasCertificate:
    atlas, results = case
    return AtlasCertificate(atlas, atlas_certificate(atlas, results))


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
        assert results_for(AtlasCertificate(atlas, made), atlas) == []
    reworded = {**stored.document, "software": {**software, "program": "another"}}
    assert len(results_for(AtlasCertificate(atlas, reworded), atlas)) == count


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
        (None, "not enclosed again"),
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
