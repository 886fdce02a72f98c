"""Certificates of tori at periodic orbits: what they say, checked again at three levels, forged ones refused."""

from __future__ import annotations

import copy
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import torus_cases as cases

from orbitproof.shared.formats import PERIODIC_DOUBLING, PERIODIC_FOLD, write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, Level, certify, digest, is_proof_of, recheck
from orbitproof.verify.certificate.rechecking import derived

CLAIMS = {"round": cases.round_claim(), "outside": cases.product_claim(d=Fraction(1), k=Fraction(-1, 8))}


@pytest.fixture(scope="module")
def proved() -> dict[str, Certificate]:
    found = {name: certify(claim, Limits(digits=12)) for name, claim in CLAIMS.items()}
    assert all(certificate.proved for certificate in found.values())
    return found


def _sealed(entry: dict[str, Any]) -> Certificate:
    """What a forger makes, who knows how digests are made."""
    content = {key: value for key, value in entry.items() if key != "digest"}
    return Certificate.from_json({**content, "digest": digest(content)})


def test_a_certificate_says_what_is_proved(proved: dict[str, Certificate]) -> None:
    certificate = proved["round"]
    assert str(certificate).startswith("torus at a periodic orbit, proved, above, a = ")
    assert certificate.side == "above"
    assert certificate.candidate == CLAIMS["round"]
    assert is_proof_of(certificate, CLAIMS["round"])
    assert not is_proof_of(certificate, CLAIMS["outside"])
    theorem = certificate.theorem or ""
    assert "it is a Neimark-Sacker bifurcation" in theorem
    assert "under the flow of the round (w, b, c, d as in the candidate), and a number" in theorem
    assert "a = 0" not in theorem
    told = certificate.statement["in_full"]
    assert "The interval of a: all values that differ from 0 by at most" in told
    assert "There are no other multipliers." in told
    assert "the pair crosses the circle outward as a grows" in told
    assert "the bifurcation is supercritical." in told
    assert "The torus is there at values of a above that of the bifurcation." in told
    assert (
        "the orbit is asymptotically stable below the value and unstable above it; the torus is asymptotically stable."
        in told
    )


def test_with_a_multiplier_outside_nothing_is_called_stable(proved: dict[str, Certificate]) -> None:
    told = proved["outside"].statement["in_full"]
    assert "the bifurcation is subcritical." in told
    assert "The torus is there at values of a below that of the bifurcation." in told
    assert "the torus and the orbit are unstable: a multiplier lies outside the unit circle." in told
    assert "asymptotically stable" not in told


def test_a_subcritical_torus_is_unstable_where_the_orbit_is_stable() -> None:
    told = certify(cases.round_claim(b=Fraction(0), d=Fraction(-1)), Limits(digits=12)).statement["in_full"]
    assert "the bifurcation is subcritical." in told
    assert "the orbit is asymptotically stable below the value and unstable above it; the torus is unstable." in told


def _derived(entry: dict[str, Any]) -> Certificate:
    """A forger's best work: all that follows from changed claims or enclosures is derived anew."""
    return _sealed({**derived(entry), "software": entry["software"]})


def _another_time(entry: dict[str, Any]) -> None:
    time = entry["enclosures"]["time"]
    for part in ("box", "centre"):
        time[part][0] = "0x7 +- 0x1p-20"


@pytest.mark.parametrize(
    "change",
    [
        _another_time,
        lambda entry: entry["statement"]["candidate"]["parameters"].update(d="1", b="0x0"),
        lambda entry: entry["statement"]["candidate"]["parameters"].update(b="1/3"),
    ],
)
def test_what_integration_alone_can_refuse_is_refused(proved: dict[str, Certificate], change: Any) -> None:
    entry = copy.deepcopy(proved["round"].to_json())
    change(entry)
    forged = _derived(entry)
    assert forged.proved
    assert recheck(forged).stands
    found = recheck(forged, integrate=True)
    assert not found.stands
    assert found.passed is Level.CONCLUSION


@pytest.mark.parametrize("kind", [PERIODIC_FOLD, PERIODIC_DOUBLING])
def test_a_torus_is_no_bifurcation_of_another_kind(kind: Any) -> None:
    claim = CLAIMS["round"]
    for vector in claim.kernel:
        other = replace(claim, kind=kind, kernel=(vector,), multiplier=None)
        assert not certify(other, Limits(digits=12)).proved


@pytest.mark.slow
def test_claims_are_proved_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = tmp_path / "claims.json", tmp_path / "certificates.json"
    claim = CLAIMS["round"]
    write_candidates(path, [claim])
    assert main([str(path), "-o", str(output), "--quiet", "--digits", "12"]) == 0
    assert "proved" in capsys.readouterr().out
    assert main(["--recheck", str(output), "--quiet"]) == 0
    capsys.readouterr()
    write_candidates(path, [replace(claim, parameters={**claim.parameters, "a": Fraction(1, 2**30)})])
    assert main([str(path), "--quiet"]) == 1
    assert "not proved" in capsys.readouterr().out
