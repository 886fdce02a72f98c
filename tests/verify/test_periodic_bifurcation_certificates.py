"""Certificates of bifurcations of periodic orbits: checked again at three levels, forged ones refused at each."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import periodic_bifurcation_cases as cases

from orbitproof import verify
from orbitproof.shared.formats import write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, Level, certify, contradictions, digest, is_proof_of, recheck
from orbitproof.verify.certificate.rechecking import derived
from orbitproof.verify.evidence import DerivativeTable
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    PeriodicBifurcationResults,
    enclose_periodic_bifurcation,
)
from orbitproof.verify.poincare import IntegratorSettings

CLAIMS = {
    "fold": cases.folding(),
    "doubling": cases.doubling(2, 1, 1, -1),
    "pitchfork": cases.lorenz_pitchfork(),
    "level": cases.levels(),
    "parameter on a level": cases.level_fold(parameter="a"),
}
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
    certificate = proved["pitchfork"]
    assert str(certificate).startswith("symmetry breaking of periodic orbits, proved, below, rho = 312.97353298416")
    assert isinstance(certificate.results, PeriodicBifurcationResults)
    assert certificate.side == "below"
    assert certificate.candidate == CLAIMS["pitchfork"]
    assert is_proof_of(certificate, CLAIMS["pitchfork"])
    assert not is_proof_of(certificate, replace(CLAIMS["pitchfork"], kernel_radius=Fraction(1, 2**21)))
    assert not is_proof_of(certificate, CLAIMS["fold"])


SAID = {
    "fold": [
        "exactly two points near the point come back to themselves at that crossing",
        "  b = 1",
        "The interval of a: all values that differ from 0 by at most 8.4703294725430034e-22 (exactly 0x1p-70).",
        "One more multiplier is 1 exactly",
        "There are no other multipliers.",
        "The new orbits are at values of a above",
        "one of the two orbits is asymptotically stable",
    ],
    "doubling": [
        "exactly one further periodic orbit passes near the point",
        "at crossing number 2;",
        "One more multiplier is -1 exactly",
        "kappa lies in [-0.5",
        "The bifurcation is supercritical: the new orbits are where the multiplier of the old one that passes through "
        "-1 is outside",
        "The new orbits are at values of a below",
        "the old one is asymptotically stable above the value and unstable below it",
    ],
    "pitchfork": [
        "The symmetry S maps (x, y, z) to (-x, -y, z).",
        "at which S, the symmetry of the candidate, takes crossing number 1 of the section in the direction of the",
        "exactly two further periodic orbits pass near the point",
        "S moves the orbit by half its period; it crosses the section in 2 points.",
        "S maps one to the other and neither to itself",
        "new orbits are asymptotically stable; the old one is asymptotically stable above the value",
    ],
    "level": [
        "restricted to the level, has the eigenvalue -1",
        "The interval of the level of H: all values that differ from 1",
        "one further periodic orbit of the level",
        "The new orbits are at values of the level of H above",
        "H = x^2 + y^2",
    ],
    "parameter on a level": ["All is on the level H = 1.", "on a level of the first integral H = 1"],
}
NOT_SAID = {
    "level": ["critical", "asymptotically stable"],
    "parameter on a level": ["asymptotically stable"],
    "fold": ["critical"],
}


@pytest.mark.parametrize("name", SAID)
def test_the_words_are_those_of_the_kind(proved: dict[str, Certificate], name: str) -> None:
    told = proved[name].statement["in_full"]
    for words in SAID[name]:
        assert words in told, words
    for words in NOT_SAID.get(name, []):
        assert words not in told, words


def test_a_subcritical_bifurcation_is_told_as_one() -> None:
    told = certify(cases.breaking(0, -1)).statement["in_full"]
    assert "The orbit lies in the fixed set of S." in told
    assert "The bifurcation is subcritical" in told
    assert "new orbits are unstable; the old one is asymptotically stable below the value and unstable above it" in told


Forgery = Callable[[dict[str, Any]], Any]


def _derived(entry: dict[str, Any]) -> Certificate:
    """A forger's best work: all that follows from changed claims or enclosures is derived anew."""
    return _sealed({**derived(entry), "software": entry["software"]})


def _moved(entry: dict[str, Any], variables: int, index: tuple[int, ...], function: int, by: str) -> None:
    """A derivative of the return that is another number."""
    position = sorted(_indices(variables)).index(index)
    table = entry["enclosures"]["image"][function]
    for part in ("box", "centre"):
        table[part][position] = f"{by} +- 0x1p-200"


def _indices(variables: int) -> Iterator[tuple[int, ...]]:
    for number in range(4**variables):
        index = tuple(number // 4**place % 4 for place in range(variables))
        if sum(index) <= 3:
            yield index


@pytest.mark.parametrize(
    ("name", "change"),
    [
        # The third derivative of U decides the side.
        ("doubling", lambda entry: _moved(entry, 4, (0, 3, 0, 0), 1, "-0x1p+10")),
        ("doubling", lambda entry: _moved(entry, 4, (0, 3, 0, 0), 1, "0x1p+10")),
        ("fold", lambda entry: _moved(entry, 2, (2, 0), 0, "0x1p+4")),
        ("doubling", lambda entry: entry["statement"]["candidate"]["parameters"].update(c="-0x1p+3")),
    ],
)
def test_false_enclosures_are_refused_by_integration(
    proved: dict[str, Certificate], name: str, change: Forgery
) -> None:
    entry = copy.deepcopy(proved[name].to_json())
    change(entry)
    forged = _derived(entry)
    assert forged.proved
    assert recheck(forged).stands
    found = recheck(forged, integrate=True)
    assert not found.stands
    assert found.passed is Level.CONCLUSION


def _each_changed(found: BifurcationEnclosures) -> Iterator[BifurcationEnclosures]:
    """The same with one number moved, for each number of the first function and one of each other."""
    tables = {"time": found.time, "integral": found.integral}
    for name, table in tables.items():
        if table is not None:
            first = next(iter(table.box))
            yield replace(found, **{name: DerivativeTable({**table.box, first: table.box[first] + 1}, table.centre)})
            yield replace(found, **{name: DerivativeTable(table.box, {**table.centre, first: table.centre[first] + 1})})
    for place, table in enumerate(found.image):
        for index in table.box:
            changed = DerivativeTable({**table.box, index: table.box[index] + 2**200}, table.centre)
            yield replace(found, image=(*found.image[:place], changed, *found.image[place + 1 :]))


def test_every_number_that_a_certificate_carries_is_compared() -> None:
    found = enclose_periodic_bifurcation(CLAIMS["level"], IntegratorSettings(200), ORACLE)
    assert not list(contradictions(found, found, "tables"))
    for other in _each_changed(found):
        assert len(list(contradictions(found, other, "tables"))) == 1
    twice = enclose_periodic_bifurcation(replace(CLAIMS["fold"], crossings=2), IntegratorSettings(200), ORACLE)
    (earlier,) = twice.earlier
    for changed in (
        replace(earlier, image=(replace(earlier.image[0], centre=earlier.image[0].centre + 1),)),
        replace(earlier, time=replace(earlier.time, slopes=(earlier.time.slopes[0] + 1, earlier.time.slopes[1]))),
    ):
        assert len(list(contradictions(twice, replace(twice, earlier=(changed,)), "tables"))) == 1


@pytest.mark.slow
def test_claims_are_proved_by_the_command_and_from_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = tmp_path / "claims.json", tmp_path / "certificates.json"
    write_candidates(path, [CLAIMS["fold"]])
    assert main([str(path), "-o", str(output), "--quiet"]) == 0
    assert "two orbits above\n  a = " in capsys.readouterr().out
    assert main(["--recheck", str(output), "--quiet"]) == 0
    write_candidates(path, [cases.shifted(CLAIMS["fold"], 1, Fraction(1, 10**10))])
    assert main([str(path), "--quiet"]) == 1
    assert "not proved" in capsys.readouterr().out
    (certificate,) = verify.certify(CLAIMS["fold"], quiet=True)
    assert certificate.proved
