"""A claim that is not proved on its box is tried on the box that its failure asks for; what is said is of that box."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path
from typing import Any

import pytest
from support.claims import known

from orbitproof import verify
from orbitproof.shared.formats import BoxClaim, Candidate, Equation, candidate_to_json
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import certify, is_proof_of
from orbitproof.verify.run.other_boxes import answers, certify_on_some_box, given_radii, remark

TRUE = known("fs2")


def scaled(claim: Candidate, *factors: float) -> Candidate:
    return replace(claim, radii=tuple(r * F(f) for r, f in zip(claim.radii, factors, strict=True)))


def orbit(radius: F) -> Candidate:
    """The orbit of Falkner-Skan's equation at the beta of its 1:2 resonance, alone in boxes that are not too wide."""
    value = Equation("coordinate", TRUE.centre[0], "beta")
    return replace(TRUE, kind="orbit", k=1, equation=value, radii=(radius, radius))


BOXES = {
    "P_0 too narrow": (1e3, 1e3),
    "P_0 far too narrow": (1e-2, 1e1),
    "P_0 too wide": (1e4, 1.0),
    "too small in all directions": (1e-10, 1e-10),
    "too large": (1e6, 1e6),
    "so large that its orbits part": (1e12, 1e12),
}


FARTHER = ("P_0 far too narrow", "too large")
"""The same on longer ways."""


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=pytest.mark.slow if case in FARTHER else ()) for case in BOXES]
)
def test_a_bifurcation_is_proved_on_the_box_that_its_failure_asks_for(case: str) -> None:
    given = scaled(TRUE, *BOXES[case])
    assert not certify(given).proved
    found = certify_on_some_box(given, Limits())
    assert found.proved
    about(found, given)


@pytest.mark.parametrize("radius", [F(1, 100), F(1)])
def test_an_orbit_is_proved_on_the_box_that_its_failure_asks_for(radius: F) -> None:
    given = orbit(radius)
    assert not certify(given, Limits(max_precision=256)).proved
    found = certify_on_some_box(given, Limits(max_precision=256))
    assert found.proved
    about(found, given)


def about(found: verify.Certificate, given: BoxClaim) -> None:
    """The certificate is a proof of the claim on the box that it states, not on the one given, and says so."""
    stated = found.candidate
    assert stated.radii != given.radii
    assert replace(stated, radii=given.radii, provenance={}) == replace(given, provenance={})
    assert is_proof_of(found, stated)
    assert not is_proof_of(found, given)
    assert given_radii(found) == given.radii
    assert answers(found, given)
    assert not answers(found, replace(given, radii=tuple(2 * r for r in given.radii)))
    elsewhere = (given.centre[0], given.centre[1] + F(1, 2**40), *given.centre[2:])
    assert not answers(found, replace(given, centre=elsewhere))
    axis, old, new = next(
        (i, *two) for i, two in enumerate(zip(given.radii, stated.radii, strict=True)) if two[0] != two[1]
    )
    assert "another" in str(remark(found))
    assert f"P_{axis} {float(old):.4g} -> {float(new):.4g}" in str(remark(found))
    (check,) = verify.recheck(found, quiet=True)
    assert check.stands


def test_without_other_boxes_a_claim_is_what_it_was() -> None:
    given = scaled(TRUE, 1e6, 1e6)
    found = certify_on_some_box(given, Limits(other_boxes=0))
    assert not found.proved
    assert found.candidate.radii == given.radii
    with pytest.raises(ValueError, match="other_boxes"):
        Limits(other_boxes=-1)


def test_what_is_proved_on_its_own_box_is_not_tried_on_another() -> None:
    found = certify_on_some_box(TRUE, Limits())
    assert found.candidate.radii == TRUE.radii
    assert given_radii(found) is None
    assert remark(found) is None
    assert answers(found, TRUE)


FALSE: dict[str, Candidate] = {
    "no resonance of this k": replace(TRUE, k=4),
    "another kind": replace(TRUE, k=3, kind="touch_and_go"),
    "off the family": replace(TRUE, centre=(TRUE.centre[0], TRUE.centre[1] + F(1, 100))),
    "no orbit in the box": replace(orbit(F(1, 10**9)), centre=(TRUE.centre[0], TRUE.centre[1] + F(1, 10**8))),
}


@pytest.mark.parametrize("case", FALSE)
@pytest.mark.parametrize("factor", [1.0, 1e6])
def test_a_false_claim_is_proved_on_no_box(case: str, factor: float) -> None:
    given = scaled(FALSE[case], factor, factor)
    if case == "no orbit in the box" and factor > 1:
        pytest.skip("there is one in this box")
    found = certify_on_some_box(given, Limits(max_precision=256))
    assert not found.proved
    assert found.candidate.radii == given.radii
    assert given_radii(found) is None


def test_the_command_says_which_box_is_proved_and_keeps_it(tmp_path: Path, capsys: Any) -> None:
    given = scaled(TRUE, 1e6, 1e6)
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    rows = [candidate_to_json(given)]
    source.write_text(json.dumps({"format": "orbitproof-candidates", "version": 1, "candidates": rows}))
    words = [str(source), "-o", str(target), "--quiet"]
    assert main([*words, "--other-boxes", "0"]) == 1
    assert main(words) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "the box in the certificate is another, around the one given: half-widths P_0" in said
    assert main(words) == 0
    assert "proved by an earlier run" in capsys.readouterr().out
    assert main(["--recheck", str(target), "--quiet"]) == 0
