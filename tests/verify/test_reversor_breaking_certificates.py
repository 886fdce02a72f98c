"""Certificates that R is lost: checked again at three levels, forged ones refused at each; what they say."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import breaking_cases as cases
from support.forgeries import is_confirmed_ball_by_ball

from orbitproof import verify
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate, Level, certify, contradictions, digest, is_proof_of, recheck
from orbitproof.verify.certificate.rechecking import derived
from orbitproof.verify.evidence import DerivativeTable
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import (
    BreakingEnclosures,
    enclose_breaking,
)


@pytest.fixture(scope="module")
def proved() -> Certificate:
    certificate = certify(cases.modes())
    assert certificate.proved
    return certificate


def _sealed(entry: dict[str, Any]) -> Certificate:
    """What a forger makes, who knows how digests are made."""
    content = {key: value for key, value in entry.items() if key != "digest"}
    return Certificate.from_json({**content, "digest": digest(content)})


def test_a_certificate_stands_at_all_levels(proved: Certificate) -> None:
    found = recheck(proved, integrate=True)
    assert found.stands, found.findings
    assert found.passed is Level.INTEGRATION
    assert is_proof_of(proved, cases.modes())
    assert not is_proof_of(proved, cases.modes(radii=(Fraction(1, 2**61),) * 2))


def test_a_certificate_says_what_is_proved(proved: Certificate) -> None:
    assert str(proved).startswith("loss of R, proved, above, twice the energy = 0.13314942598420541173")
    told = proved.statement["in_full"]
    for words in (
        "D(P^2)(x) - 1, on the level of the first integral, has a kernel vector that R negates",
        "exactly one in Fix(R), whose orbit is symmetric",
        "exactly two more, not in Fix(R), which R exchanges",
        "R maps each of these to the other with time reversed, and neither to itself.",
        "Of other symmetries nothing is said: the new orbits may have some.",
        "The box is in the coordinates twice the energy, x, with vy > 0.",
        "meets the section in a period at x and P(x) only",
        "The two orbits exist for values of the parameter greater than that.",
        "The parameter there, twice the energy, lies in [0.13314942598420541173613660584361252192",
        "The period of the orbit of x lies in [6.283185307179586476925286766559005768",
        "vy in [0.36489645926509",
        "at which the parameter has that value and P^2(x') = x' are these",
        "the vector w with vx",
        "kappa in [2.09926",
    ):
        assert words in told, words
    here, there = told[told.index("The point x has") :].split("; P(x) has ")
    assert "vy in [0.3648" in here
    assert "vy in [-0.3648" in there.splitlines()[0]
    for words in ("stable", "symmetry breaking", "exactly two periodic orbits"):
        assert words not in told, words


Forgery = Callable[[dict[str, Any]], Any]
BALL = {"mid": "0x1", "rad": "0x0", "decimal": "[1, 1]"}
FORGERIES: dict[str, Forgery] = {
    "the side": lambda entry: entry["results"].update(side="below"),
    "the parameter": lambda entry: entry["results"].update(parameter=BALL),
    "its name": lambda entry: entry["results"].update(parameter_name="energy"),
    "the period": lambda entry: entry["results"].update(period=BALL),
    "the opening": lambda entry: entry["results"].update(opening=BALL),
    "gamma": lambda entry: entry["results"].update(gamma=BALL),
    "beta": lambda entry: entry["results"].update(beta=BALL),
    "the direction": lambda entry: entry["results"]["direction"].update(vx={**BALL, "mid": "0x2"}),
    "the point": lambda entry: entry["results"]["point"].update(x=BALL),
    "the other point": lambda entry: entry["results"]["other_point"].update(x=BALL),
    "a hypothesis less": lambda entry: entry["hypotheses"].pop(),
    "a hypothesis that does not hold": lambda entry: entry["hypotheses"][-1].update(holds=False),
    "the kind": lambda entry: entry["statement"]["candidate"].update(kind="fold"),
    "an orbit": lambda entry: entry["statement"]["candidate"].update(kind="orbit"),
    "the sign of the sheet": lambda entry: entry["statement"]["candidate"].update(level_sign=-1),
    "the half-widths": lambda entry: entry["statement"]["candidate"].update(radii=["0x1p-300", "0x1p-300"]),
    "the centre": lambda entry: entry["statement"]["candidate"].update(centre=["0x1", "0x0"]),
    "the crossings": lambda entry: entry["statement"]["candidate"].update(crossings=2),
    "the frame": lambda entry: entry["statement"]["candidate"].update(kernel_frame=[["0x2"]]),
    "no image": lambda entry: entry["enclosures"].update(image=[]),
    "no sheet": lambda entry: entry["enclosures"].update(sheet=[]),
    "the other sheet": lambda entry: entry["enclosures"].update(sheet=["0x1 +- 0x0"]),
    "no enclosures": lambda entry: entry.update(enclosures=None),
    "the words": lambda entry: entry["statement"].update(theorem="Both orbits are stable."),
}


@pytest.mark.parametrize("name", FORGERIES)
def test_forgeries_are_refused_without_integration(proved: Certificate, name: str) -> None:
    entry = copy.deepcopy(proved.to_json())
    FORGERIES[name](entry)
    try:
        certificate = _sealed(entry)
    except InputError:
        return
    found = recheck(certificate)
    assert not found.stands or found.rendered is not None


def _moved(entry: dict[str, Any], index: tuple[int, ...], by: str) -> None:
    """A derivative of the image that is another number."""
    position = sorted(_indices()).index(index)
    (table,) = entry["enclosures"]["image"]
    for part in ("box", "centre"):
        table[part][position] = f"{by} +- 0x1p-200"


def _indices() -> Iterator[tuple[int, ...]]:
    for number in range(4**3):
        index = tuple(number // 4**place % 4 for place in range(3))
        if sum(index) <= 3:
            yield index


@pytest.mark.parametrize(
    "change",
    [
        lambda entry: _moved(entry, (0, 0, 3), "-0x1p+10"),
        lambda entry: _moved(entry, (1, 0, 1), "-0x1p+4"),
        lambda entry: entry["statement"]["candidate"]["parameters"].update(a="1"),
    ],
)
def test_false_enclosures_are_refused_by_integration(proved: Certificate, change: Forgery) -> None:
    entry = copy.deepcopy(proved.to_json())
    change(entry)
    forged = _sealed({**derived(entry), "software": entry["software"]})
    assert forged.proved
    assert recheck(forged).stands
    found = recheck(forged, integrate=True)
    assert not found.stands
    assert found.passed is Level.CONCLUSION


def _each_changed(found: BreakingEnclosures) -> Iterator[BreakingEnclosures]:
    """The same with one number moved."""

    def moved(table: DerivativeTable) -> Iterator[DerivativeTable]:
        for index in table.box:
            yield DerivativeTable({**table.box, index: table.box[index] + 2**200}, table.centre)
            yield DerivativeTable(table.box, {**table.centre, index: table.centre[index] + 2**200})

    ((kernel,),), (image,) = found.iterates, found.image
    yield from (replace(found, iterates=((table,),)) for table in moved(kernel))
    yield from (replace(found, image=(table,)) for table in moved(image))
    yield from (replace(found, half_period=table) for table in moved(found.half_period))
    yield replace(found, sheet=(found.sheet[0] + 1,))


def test_every_number_that_a_certificate_carries_is_compared() -> None:
    found = enclose_breaking(cases.modes(), IntegratorSettings(160), ORACLE)
    assert not list(contradictions(found, found, "tables"))
    for other in _each_changed(found):
        assert len(list(contradictions(found, other, "tables"))) == 1


def test_every_enclosure_that_a_certificate_carries_is_found_again(proved: Certificate) -> None:
    entry, claim = proved.to_json(), cases.modes()
    settings = IntegratorSettings(entry["computation"]["precision"], entry["computation"]["order"])
    found = enclose_breaking(claim, settings, ORACLE)
    assert is_confirmed_ball_by_ball(entry, claim, found)


@pytest.mark.slow
def test_claims_are_proved_by_the_command_and_from_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = tmp_path / "claims.json", tmp_path / "certificates.json"
    write_candidates(path, [cases.modes()])
    assert main([str(path), "-o", str(output), "--quiet"]) == 0
    assert "loss of R, new orbits above\n  twice the energy = 0.1331" in capsys.readouterr().out
    assert main(["--recheck", str(output), "--quiet"]) == 0
    assert main(["--second-proof", str(output)]) == 0
    assert "agrees" in capsys.readouterr().out
    write_candidates(path, [cases.modes(centre=(Fraction(1, 8), Fraction(0)))])
    assert main([str(path), "--quiet"]) == 1
    assert "not proved" in capsys.readouterr().out
    (certificate,) = verify.certify(cases.modes(), quiet=True)
    assert certificate.proved
