"""Certificates of periodic orbits without symmetry: checked again at three levels, forged ones refused at each."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import periodic_cases as cases

from orbitproof import verify
from orbitproof.shared.formats import write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, Level, certify, contradictions, digest, is_proof_of, recheck
from orbitproof.verify.certificate.rechecking import derived
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import (
    Linearised,
    PeriodicEnclosures,
    enclose_periodic,
)
from orbitproof.verify.poincare import IntegratorSettings

CLAIMS = {"AB": cases.lorenz("AB"), "level": cases.oscillators()}
LIMITS = Limits(digits=16)


@pytest.fixture(scope="module")
def proved() -> dict[str, Certificate]:
    found = {name: certify(claim, LIMITS) for name, claim in CLAIMS.items()}
    assert all(certificate.proved for certificate in found.values())
    return found


def _sealed(entry: dict[str, Any]) -> Certificate:
    """What a forger makes, who knows how digests are made."""
    content = {key: value for key, value in entry.items() if key != "digest"}
    return Certificate.from_json({**content, "digest": digest(content)})


def test_a_certificate_says_what_is_proved(proved: dict[str, Certificate]) -> None:
    certificate = proved["AB"]
    assert str(certificate).startswith("periodic orbit, proved, period = 1.55865221071617472756")
    assert certificate.periodic is not None
    assert certificate.orbit is None
    assert certificate.candidate == CLAIMS["AB"]
    assert "crosses the section in that direction in exactly 2 points" in (certificate.theorem or "")
    told = certificate.statement["in_full"]
    assert "x' = sigma*(y - x)" in told
    assert "Of them 1 lies inside, 0 lie on, 1 lies outside the unit circle." in told
    level = proved["level"].statement["in_full"]
    assert "H = x^2 + y^2" in level
    assert "The multiplier 1 occurs at least twice" in level
    assert "Of them 0 lie inside, 2 lie on, 0 lie outside the unit circle." in level
    assert is_proof_of(certificate, CLAIMS["AB"])
    assert not is_proof_of(certificate, CLAIMS["level"])


def test_what_was_changed_without_a_new_digest_is_refused_by_form(proved: dict[str, Certificate]) -> None:
    entry = proved["AB"].to_json()
    entry["computation"]["seconds"] = 0.0
    found = recheck(Certificate.from_json(entry))
    assert not found.stands
    assert found.passed is Level.NONE


def _derived(entry: dict[str, Any]) -> Certificate:
    """A forger's best work: all that follows from changed claims or enclosures is derived anew."""
    return _sealed({**derived(entry), "software": entry["software"]})


def _another_time(entry: dict[str, Any]) -> None:
    time = entry["enclosures"]["returns"][-1]["time"]
    time[0] = "0x1p+1 +- " + time[0].partition(" +- ")[2]


def _another_slope(entry: dict[str, Any]) -> None:
    function = entry["enclosures"]["returns"][-1]["image"][0]
    function[1] = "0x0 +- 0x1p-200"


@pytest.mark.parametrize(
    "change",
    [
        _another_time,
        _another_slope,
        lambda entry: entry["statement"]["candidate"]["parameters"].update(rho="0x1d"),
        lambda entry: entry["statement"]["candidate"]["system"].update(
            field=entry["statement"]["candidate"]["system"]["field"].replace("v1 - v0", "v0 - v1")
        ),
    ],
)
def test_false_enclosures_are_refused_by_integration(proved: dict[str, Certificate], change: Any) -> None:
    entry = copy.deepcopy(proved["AB"].to_json())
    change(entry)
    forged = _derived(entry)
    assert forged.proved
    assert recheck(forged).stands
    found = recheck(forged, integrate=True)
    assert not found.stands
    assert found.passed is Level.CONCLUSION


def _each_changed(found: PeriodicEnclosures) -> Iterator[PeriodicEnclosures]:
    """The same with one number moved, for each number."""
    for number, each in enumerate(found.returns):
        for place, function in enumerate((*each.image, each.time)):
            balls = list(function.balls)
            for position in range(len(balls)):
                centre, *slopes = (ball + (index == position) for index, ball in enumerate(balls))
                functions = [*each.image, each.time]
                functions[place] = Linearised(centre, tuple(slopes))
                changed = replace(each, image=tuple(functions[:-1]), time=functions[-1])
                yield replace(found, returns=(*found.returns[:number], changed, *found.returns[number + 1 :]))


def test_every_number_that_a_certificate_carries_is_compared() -> None:
    found = enclose_periodic(CLAIMS["AB"], IntegratorSettings(200), ORACLE)
    assert not list(contradictions(found, found, "tables"))
    changed = list(_each_changed(found))
    assert len(changed) == 2 * 3 * 3
    for other in changed:
        assert len(list(contradictions(found, other, "tables"))) == 1


@pytest.mark.slow
def test_claims_are_proved_by_the_command_and_from_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = tmp_path / "claims.json", tmp_path / "certificates.json"
    false = cases.shifted(CLAIMS["AB"], 0, Fraction(1, 10**10))
    write_candidates(path, [CLAIMS["AB"]])
    assert main([str(path), "-o", str(output), "--quiet"]) == 0
    assert ": proved in " in capsys.readouterr().out
    assert main(["--recheck", str(output), "--quiet"]) == 0
    capsys.readouterr()
    write_candidates(path, [false])
    assert main([str(path), "--quiet"]) == 1
    assert "not proved" in capsys.readouterr().out
    (certificate,) = verify.certify(CLAIMS["AB"], quiet=True)
    assert certificate.proved
