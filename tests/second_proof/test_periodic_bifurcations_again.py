"""Folds and doublings of periodic orbits proved once more: closed forms, certificates, what is not confirmed."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import Any

import pytest
from flint import arb, ctx
from support import periodic_bifurcation_cases as cases

from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.verify import second_proof as package
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import BadCertificate, NotProved, ProvedPeriodicBifurcation, second_proof

bifurcation = import_module(f"{package.__name__}.periodic_bifurcation")
jets = import_module(f"{package.__name__}.jets")


@pytest.fixture(scope="module")
def certificate() -> dict[str, Any]:
    return certify(replace(cases.folding(1, 2), kernel=((Fraction(2),),)), Limits(digits=8)).to_json()


@pytest.fixture(scope="module")
def proof(certificate: dict[str, Any]) -> ProvedPeriodicBifurcation:
    found = second_proof(certificate)
    assert isinstance(found, ProvedPeriodicBifurcation), str(found)
    return found


def test_a_fold_with_a_closed_form_is_proved(proof: ProvedPeriodicBifurcation) -> None:
    """a = 4 y^2/c for the point at 1 + y; the vector of the claim is 2, so that a = 4 (2 y)^2/c."""
    assert (proof.side, proof.known, proof.criticality) == ("above", 1, None)
    assert proof.parameter.contains(0)
    assert proof.point["x"].contains(1)
    assert float(proof.parameter.rad()) < 1e-30
    with ctx.workprec(400):
        assert proof.period.contains(2 * arb.pi())
        assert proof.opening.contains(8)
    assert float(proof.opening.rad()) < 1e-20
    assert [h.name for h in proof.hypotheses] == ["newton", "direction", "crossings", "side"]
    assert all(h.holds for h in proof.hypotheses)


def test_its_certificate_agrees(certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    found = compare(certificate, proof)
    assert found.verdict == "agrees", found.reason
    assert "holds no other bifurcations" in found.reason


def changed(certificate: dict[str, Any], change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    other = copy.deepcopy(certificate)
    change(other)
    return other


def move(entry: dict[str, str], by: Fraction) -> None:
    entry["mid"] = format_exact(parse_exact(entry["mid"]) + by)


DIFFERENCES: dict[str, Callable[[dict[str, Any]], object]] = {
    "parameter:": lambda c: move(c["results"]["parameter"], Fraction(1, 2**60)),
    "period": lambda c: move(c["results"]["period"], Fraction(1, 2**60)),
    "point.x": lambda c: move(c["results"]["point"]["x"], Fraction(1, 2**60)),
    "point:": lambda c: c["results"]["point"].pop("x"),
    "kappa": lambda c: move(c["results"]["opening"], Fraction(1, 2**20)),
    "side": lambda c: c["results"].update(side="below"),
    "known": lambda c: c["results"].update(known=-1),
    "kind": lambda c: c["statement"]["candidate"].update(kind="periodic-doubling"),
    "parameter_name": lambda c: c["results"].update(parameter_name="b"),
    "not in the box": lambda c: c["statement"]["candidate"]["parameters"].update(a="0x1p-60"),
    "the value is not in": lambda c: c["statement"]["candidate"]["centre"].__setitem__(0, "0x10001p-16"),
    "level": lambda c: c["results"].update(level=c["results"]["period"]),
    "1 for every orbit": lambda c: c["results"]["multipliers"].update(trivial=2),
    "another number of them": lambda c: c["results"]["multipliers"].update(outside=1),
}


@pytest.mark.parametrize("what", DIFFERENCES)
def test_each_difference_is_reported(what: str, certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    found = compare(changed(certificate, DIFFERENCES[what]), proof)
    assert found.verdict == "disagrees"
    assert what.rstrip(":") in found.reason


def test_criticality_is_confirmed_or_not(certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    stated = changed(certificate, lambda c: c["results"].update(criticality="supercritical"))
    for mine, verdict in (("supercritical", "agrees"), ("subcritical", "disagrees"), (None, "cannot follow")):
        assert compare(stated, replace(proof, criticality=mine)).verdict == verdict


def test_what_is_not_enclosed_is_not_confirmed(certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    for nothing in ({"parameter": arb("nan")}, {"opening": arb(0, 100)}, {"period": arb("nan")}):
        assert compare(certificate, replace(proof, **nothing)).verdict == "cannot follow"


@pytest.mark.parametrize("kind", ["periodic-pitchfork", "periodic-torus"])
def test_kinds_without_a_second_proof_cannot_be_followed(kind: str, certificate: dict[str, Any]) -> None:
    other = changed(certificate, lambda c: c["statement"]["candidate"].update(kind=kind))
    found = second_proof(other)
    assert isinstance(found, NotProved)
    assert kind in found.reason
    assert compare(other, found).verdict == "cannot follow"


BAD: dict[str, Callable[[dict[str, Any]], object]] = {
    "kernel": lambda c: c["statement"]["candidate"].update(kernel=[["0x0"]]),
    "parameter": lambda c: c["statement"]["candidate"].update(parameter="x"),
}


@pytest.mark.parametrize("field", BAD)
def test_bad_input_names_the_field(field: str, certificate: dict[str, Any]) -> None:
    with pytest.raises(BadCertificate, match=f"statement.candidate.{field}"):
        second_proof(changed(certificate, BAD[field]))


def attempt(certificate: dict[str, Any], kind: str) -> Any:
    """An attempt with the vector (1, 0, 0) in (x, y, T)."""
    claim = replace(bifurcation.read_bifurcation(certificate), kind=kind)
    found = bifurcation._Proof(claim, 128)
    found.vector = found.weights = [arb(1), arb(0), arb(0)]
    found.length = arb(1)
    return found


def rows(first: dict[tuple[int, ...], float]) -> list[Any]:
    """E for x -> first and y -> y + t on the line y = 0; variables are x, y, a and -1 for t."""
    terms = [first, {(1,): 1, (-1,): 1}, {(1,): 1}]
    return [jets.Jet({a: arb(c) for a, c in row.items()}, 3) for row in terms]


FLIP = {(0,): -1.0, (0, 2): -1.0, (2,): 2.0, (0, 0): 3.0, (0, 0, 0): -4.0, (-1,): 5.0}
"""-(1 + a) x + 2 a + 3 x^2 - 4 x^3, and 5 t."""


def test_coefficients_of_a_flip(certificate: dict[str, Any]) -> None:
    """x = a along the fixed points, with the multiplier -1 + 5 a; 3^2 - 4 > 0 decides where period 2 is."""
    found = attempt(certificate, "periodic-doubling")
    hypothesis, kappa, outwards = found.coefficients(rows(FLIP), found.vector)
    assert hypothesis.holds
    assert outwards.overlaps(arb(5))
    assert kappa.overlaps(arb(-1))
    _, _, inwards = found.coefficients(rows(FLIP | {(0, 0, 0): -10.0}), found.vector)
    assert inwards.overlaps(arb(-1))


def test_coefficients_of_a_fold(certificate: dict[str, Any]) -> None:
    found = attempt(certificate, "periodic-fold")
    fold = {(0,): 1.0, (2,): 2.0, (0, 0): 3.0, (-1,): 5.0}
    hypothesis, kappa, _ = found.coefficients(rows(fold), found.vector)
    assert hypothesis.holds
    assert kappa.overlaps(arb(-3) / 2)
    for missing in ((2,), (0, 0)):
        other = {a: c for a, c in fold.items() if a != missing}
        assert not found.coefficients(rows(other), found.vector)[0].holds


def test_the_derivative_of_the_extended_system(certificate: dict[str, Any]) -> None:
    found = attempt(certificate, "periodic-doubling")
    matrix = found.extended(rows(FLIP), found.vector).tolist()
    assert [[float(entry) for entry in row] for row in matrix] == [
        [-2, 0, 5, 2, 0, 0, 0],
        [0, 0, 1, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 0, 0],
        [6, 0, 0, -1, 0, 0, 5],
        [0, 0, 0, 0, 0, 2, 1],
        [0, 0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 1, 0, 0],
    ]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["the fold as a doubling", "a value that is another one"])
def test_false_claims_are_not_confirmed(kind: str, certificate: dict[str, Any]) -> None:
    def change(c: dict[str, Any]) -> None:
        claim = c["statement"]["candidate"]
        if kind == "the fold as a doubling":
            claim.update(kind="periodic-doubling")
        else:
            claim["parameters"].update(a="0x1p-20")

    other = changed(certificate, change)
    assert compare(other, second_proof(other)).verdict != "agrees"


CASES = {
    "doubling": lambda: cases.doubling(2, 1, 1, -1),
    "a parameter on a level": lambda: cases.level_fold(parameter="a"),
    "a level": cases.levels,
    "Roessler": cases.roessler,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_certificates_of_bifurcations_agree(name: str) -> None:
    stored = certify(CASES[name](), Limits(digits=10)).to_json()
    result = second_proof(stored)
    found = compare(stored, result)
    assert found.verdict == "agrees", found.reason
    if name == "doubling":
        for other in (
            changed(stored, lambda c: c["results"].update(criticality="subcritical")),
            changed(stored, lambda c: c["results"].update(side="above")),
        ):
            assert compare(other, result).verdict == "disagrees"
