"""Bifurcations of periodic orbits proved once more: closed forms, certificates, what is not confirmed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import Any

import pytest
from flint import acb, arb, ctx
from support import periodic_bifurcation_cases as cases
from support import torus_cases
from support.forgeries import changed, move
from support.steps import few_bits
from support.systems import described
from support.within import within

from orbitproof.shared.numbers import format_exact
from orbitproof.verify import second_proof as package
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.evidence import ball_from_json
from orbitproof.verify.run.second_proofs import compare
from orbitproof.verify.second_proof import (
    BadCertificate,
    CannotFollow,
    NotProved,
    ProvedPeriodicBifurcation,
    ProvedTorus,
    read_claim,
    second_proof,
)

bifurcation = import_module(f"{package.__name__}.periodic_bifurcation")

derivatives_need_few_bits = within(lambda: few_bits(), "module")


FOLDING = described(
    name="folding",
    state="x y",
    parameters="a b c",
    where={"s": "x*x + y*y - 1 - b*a", "g": "c*a - s*s"},
    field={"x": "x*g - 8*y", "y": "8*x + y*g"},
)
"""That of `cases.FOLDING` at eight times the speed, without powers, which take the second proof longer."""


@pytest.fixture(scope="module")
def certificate() -> dict[str, Any]:
    claim = replace(cases.folding(1, 2), system=FOLDING, kernel=((Fraction(2),),))
    return certify(claim, Limits(digits=8)).to_json()


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
    assert float(proof.parameter.rad()) < 1e-25
    with ctx.workprec(400):
        assert proof.period.contains(arb.pi() / 4)
        assert proof.opening.contains(8)
    assert float(proof.opening.rad()) < 1e-14
    assert [h.name for h in proof.hypotheses] == ["newton", "direction", "crossings", "side"]
    assert all(h.holds for h in proof.hypotheses)


def test_its_certificate_agrees(certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    found = compare(certificate, proof)
    assert found.verdict == "agrees", found.reason
    assert "holds no other bifurcations" in found.reason


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
    for wide in ({"parameter": arb(0, 2.0**-40)}, {"point": proof.point | {"x": arb(1, 2.0**-40)}}):
        found = compare(certificate, replace(proof, **wide))
        assert (found.verdict, "too wide to tell" in found.reason) == ("cannot follow", True)


def test_the_level_of_a_bifurcation_is_compared(certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    """On a certificate and a proof that agree otherwise."""
    one = {"mid": format_exact(Fraction(1)), "rad": "0x0"}
    stated = changed(certificate, lambda c: c["results"].update(level=one))
    for level, verdict in ((arb(1), "agrees"), (arb(2), "disagrees"), (arb("nan"), "cannot follow")):
        assert compare(stated, replace(proof, level=level)).verdict == verdict


def test_kinds_without_a_second_proof_cannot_be_followed(certificate: dict[str, Any]) -> None:
    other = changed(certificate, lambda c: c["statement"]["candidate"].update(kind="periodic-other"))
    found = second_proof(other)
    assert isinstance(found, NotProved)
    assert "periodic-other" in found.reason
    assert compare(other, found).verdict == "cannot follow"


PARAMETERS = {name: format_exact(value) for name, value in cases.folding(1, 2).parameters.items()}
BAD: dict[str, Callable[[dict[str, Any]], object]] = {
    "kernel": lambda c: c["statement"]["candidate"].update(kernel=[["0x0"]]),
    "parameter": lambda c: c["statement"]["candidate"].update(parameter="x", parameters={**PARAMETERS, "x": "0x1"}),
}


@pytest.mark.parametrize("field", BAD)
def test_bad_input_names_the_field(field: str, certificate: dict[str, Any]) -> None:
    with pytest.raises(BadCertificate, match=f"statement.candidate.{field}"):
        second_proof(changed(certificate, BAD[field]))


@pytest.fixture(scope="module")
def torus() -> dict[str, Any]:
    return certify(torus_cases.product_claim(), Limits(digits=8)).to_json()


@pytest.fixture(scope="module")
def torus_proof(torus: dict[str, Any]) -> ProvedTorus:
    """What a second proof that agrees would say."""
    results = torus["results"]
    numbers = {name: ball_from_json(results[name]) for name in ("parameter", "period", "speed", "lyapunov")}
    pair = acb(*(ball_from_json(results["multiplier"][part]) for part in ("real", "imaginary")))
    others = tuple(acb(ball_from_json(value["real"])) for value in results["multipliers"]["values"])
    point = {name: ball_from_json(entry) for name, entry in results["point"].items()}
    return ProvedTorus(
        "periodic-torus", point, "a", multiplier=pair, multipliers=others, inside=1, on=0, outside=0,
        side=results["side"], criticality=results["criticality"], hypotheses=(), width=1, bits=1, steps=1, **numbers,
    )  # fmt: skip


def test_a_torus_that_is_the_same_agrees(torus: dict[str, Any], torus_proof: ProvedTorus) -> None:
    found = compare(torus, torus_proof)
    assert found.verdict == "agrees", found.reason
    assert "holds no other bifurcations" in found.reason


OF_TORI: dict[str, Callable[[dict[str, Any]], object]] = {
    "parameter:": lambda c: move(c["results"]["parameter"], Fraction(1, 2**20)),
    "period": lambda c: move(c["results"]["period"], Fraction(1, 2**20)),
    "point.x": lambda c: move(c["results"]["point"]["x"], Fraction(1, 2**20)),
    "speed": lambda c: move(c["results"]["speed"], Fraction(1)),
    "lyapunov": lambda c: move(c["results"]["lyapunov"], Fraction(1)),
    "multiplier, real": lambda c: move(c["results"]["multiplier"]["real"], Fraction(1, 2**20)),
    "multiplier, imaginary": lambda c: move(c["results"]["multiplier"]["imaginary"], Fraction(1, 2**20)),
    "side": lambda c: c["results"].update(side="below"),
    "criticality": lambda c: c["results"].update(criticality="subcritical"),
    "kind": lambda c: c["statement"]["candidate"].update(kind="periodic-fold"),
    "parameter_name": lambda c: c["results"].update(parameter_name="b"),
    "outside the circle": lambda c: c["results"]["multipliers"].update(outside=1, inside=0),
    "not in the box": lambda c: c["statement"]["candidate"]["parameters"].update(a="0x1p-10"),
}


@pytest.mark.parametrize("what", OF_TORI)
def test_each_difference_of_a_torus_is_reported(what: str, torus: dict[str, Any], torus_proof: ProvedTorus) -> None:
    assert torus["results"]["side"] == "above"
    assert torus["results"]["criticality"] == "supercritical"
    found = compare(changed(torus, OF_TORI[what]), torus_proof)
    assert found.verdict == "disagrees"
    assert what.rstrip(":") in found.reason


def test_signs_of_a_torus_that_are_not_shown_are_not_confirmed(torus: dict[str, Any], torus_proof: ProvedTorus) -> None:
    for name in ("speed", "lyapunov"):
        wide = replace(torus_proof, **{name: arb(0, 1000)})
        assert compare(torus, wide).verdict == "cannot follow"


TORUS_BAD: dict[str, tuple[type[Exception], Callable[[dict[str, Any]], object]]] = {
    "kernel": (BadCertificate, lambda c: c["kernel"].pop()),
    "multiplier": (BadCertificate, lambda c: c["multiplier"].pop()),
    "symmetry": (BadCertificate, lambda c: c.update(symmetry=[["0x1"]])),
}


@pytest.mark.parametrize("field", TORUS_BAD)
def test_bad_claims_of_tori(field: str, torus: dict[str, Any]) -> None:
    error, change = TORUS_BAD[field]
    other = changed(torus, lambda c: change(c["statement"]["candidate"]))
    with pytest.raises(error, match=field):
        second_proof(other)


def test_a_torus_on_a_level_is_not_followed(torus: dict[str, Any]) -> None:
    def change(c: dict[str, Any]) -> None:
        c["statement"]["first_integral"] = "v0 = x\nreturn v0"
        c["statement"]["candidate"]["level"] = "0x1"

    found = second_proof(changed(torus, change))
    assert isinstance(found, NotProved)
    assert "level" in found.reason


@pytest.fixture(scope="module")
def pitchfork() -> dict[str, Any]:
    return certify(cases.breaking(2, 1, 1, 1), Limits(digits=8)).to_json()


def test_the_symmetry_of_a_pitchfork_is_read(pitchfork: dict[str, Any]) -> None:
    claim = read_claim(pitchfork)
    assert isinstance(claim, bifurcation.BifurcationStatement)
    assert claim.orbit.symmetry == (1, 1, -1, -1)
    claim.orbit.check()
    for wrong in ((-1, 1, -1, -1), (1, -1, -1, -1), (-1, -1, 1, 1)):
        with pytest.raises(CannotFollow, match="respect"):
            replace(claim.orbit, symmetry=wrong).check()
    normal = tuple(map(Fraction, (0, 1, 1, 0)))
    flat = tuple(map(Fraction, (0, 0, 0)))
    slanted = replace(claim.orbit, normal=normal, frame=(*claim.orbit.frame[:1], flat, flat, *claim.orbit.frame[3:]))
    with pytest.raises(CannotFollow, match="respect"):
        slanted.check()


def test_a_symmetry_that_moves_the_level_is_refused(pitchfork: dict[str, Any]) -> None:
    claim = read_claim(pitchfork)
    assert isinstance(claim, bifurcation.BifurcationStatement)
    level = bifurcation.read_periodic(pitchfork).field.from_text("v0 = u\nreturn v0")
    with pytest.raises(CannotFollow, match="respect"):
        replace(claim.orbit, integral=level).check()


SYMMETRIES: dict[str, tuple[type[Exception], Callable[[list[list[str]]], object]]] = {
    "no matrix": (BadCertificate, lambda rows: rows.pop()),
    "by signs": (CannotFollow, lambda rows: rows[2].__setitem__(3, "0x1")),
    "the coordinates by signs": (CannotFollow, lambda rows: rows[2].__setitem__(2, "0x1p-1")),
}


@pytest.mark.parametrize("what", SYMMETRIES)
def test_symmetries_that_are_not_followed(what: str, pitchfork: dict[str, Any]) -> None:
    error, change = SYMMETRIES[what]
    other = changed(pitchfork, lambda c: change(c["statement"]["candidate"]["symmetry"]))
    with pytest.raises(error, match=what):
        read_claim(other)


def test_where_a_pitchfork_lies_is_compared(certificate: dict[str, Any], proof: ProvedPeriodicBifurcation) -> None:
    """On a certificate and a proof that agree otherwise."""
    for mine, theirs, verdict in ((True, True, "agrees"), (True, False, "disagrees"), (False, None, "disagrees")):
        stated = changed(certificate, lambda c: c["results"].update(is_fixed=theirs))  # noqa: B023
        assert compare(stated, replace(proof, is_fixed=mine)).verdict == verdict


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
    "a pitchfork in Fix(S)": lambda: cases.breaking(2, 1, 1, 1),
    "a pitchfork of Lorenz": cases.lorenz_pitchfork,
    "another one of Lorenz": cases.lorenz_second_pitchfork,
    "a fold of Lorenz": cases.lorenz_fold,
    "a torus": torus_cases.round_claim,
    "a torus with two crossings": torus_cases.bent_claim,
    "Langford": torus_cases.langford,
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
