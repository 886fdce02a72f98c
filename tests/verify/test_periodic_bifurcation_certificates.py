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
from support.forgeries import is_confirmed_ball_by_ball

from orbitproof import verify
from orbitproof.shared.errors import InputError
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


@pytest.mark.slow
def test_certificates_stand_at_all_levels(proved: dict[str, Certificate]) -> None:
    for certificate in proved.values():
        found = recheck(certificate, integrate=True)
        assert found.stands, found.findings
        assert found.passed is Level.INTEGRATION


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
FORGERIES: dict[str, tuple[str, Forgery]] = {
    "the side": ("doubling", lambda entry: entry["results"].update(side="above")),
    "the criticality": ("doubling", lambda entry: entry["results"].update(criticality="subcritical")),
    "no criticality": ("doubling", lambda entry: entry["results"].pop("criticality")),
    "a criticality on a level": ("level", lambda entry: entry["results"].update(criticality="supercritical")),
    "the multiplier that is known": ("doubling", lambda entry: entry["results"].update(known=1)),
    "where it is fixed": ("pitchfork", lambda entry: entry["results"].update(is_fixed=True)),
    "the parameter": ("doubling", lambda entry: entry["results"]["parameter"].update(mid="0x1", decimal="[1, 1]")),
    "the period": ("doubling", lambda entry: entry["results"]["period"].update(mid="0x2", decimal="[2, 2]")),
    "the opening": ("doubling", lambda entry: entry["results"]["opening"].update(mid="0x1", decimal="[1, 1]")),
    "multipliers outside": ("doubling", lambda entry: entry["results"]["multipliers"].update(inside=1, outside=1)),
    "the kind": ("doubling", lambda entry: entry["statement"]["candidate"].update(kind="periodic-fold")),
    "a fold for a pitchfork": ("pitchfork", lambda entry: _without_symmetry(entry, "periodic-fold")),
    "a doubling for a pitchfork": ("pitchfork", lambda entry: _without_symmetry(entry, "periodic-doubling")),
    "the symmetry": (
        "pitchfork",
        lambda entry: entry["statement"]["candidate"]["symmetry"][0].__setitem__(0, "0x1"),
    ),
    "the number of crossings": ("doubling", lambda entry: entry["statement"]["candidate"].update(crossings=2)),
    "the direction": ("doubling", lambda entry: entry["statement"]["candidate"].update(direction=-1)),
    "the half-width of the parameter": (
        "doubling",
        lambda entry: entry["statement"]["candidate"].update(parameter_radius="1e-90"),
    ),
    "the kernel": ("pitchfork", lambda entry: entry["statement"]["candidate"]["kernel"][0].reverse()),
    "the half-width of the kernel": (
        "pitchfork",
        lambda entry: entry["statement"]["candidate"].update(kernel_radius="1e-60"),
    ),
    "what varies": ("doubling", lambda entry: entry["statement"]["candidate"].update(parameter="b")),
    "the level": ("level", lambda entry: entry["statement"]["candidate"].update(level="0x2")),
    "the level beside a parameter": (
        "parameter on a level",
        lambda entry: entry["statement"]["candidate"].update(level="0x2"),
    ),
    "a hypothesis less": ("doubling", lambda entry: entry["hypotheses"].pop()),
    "a coordinate less": ("doubling", lambda entry: entry["enclosures"]["image"].pop()),
    "no enclosures": ("doubling", lambda entry: entry.update(enclosures=None)),
    "no first integral": ("level", lambda entry: entry["enclosures"].update(integral=None)),
}


def _without_symmetry(entry: dict[str, Any], kind: str) -> None:
    entry["statement"]["candidate"].update(kind=kind)
    del entry["statement"]["candidate"]["symmetry"]


@pytest.mark.parametrize("forgery", FORGERIES)
def test_forgeries_are_refused_without_integration(proved: dict[str, Certificate], forgery: str) -> None:
    name, change = FORGERIES[forgery]
    entry = copy.deepcopy(proved[name].to_json())
    change(entry)
    try:
        certificate = _sealed(entry)
    except InputError:
        return
    assert not recheck(certificate).stands


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


def test_every_enclosure_that_a_certificate_carries_is_found_again(proved: dict[str, Certificate]) -> None:
    entry, claim = proved["pitchfork"].to_json(), CLAIMS["pitchfork"]
    settings = IntegratorSettings(entry["computation"]["precision"], entry["computation"]["order"])
    found = enclose_periodic_bifurcation(claim, settings, ORACLE)
    assert is_confirmed_ball_by_ball(entry, claim, found)


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
