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

from orbitproof import verify
from orbitproof.shared.formats import write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate, Level, certify, contradictions, digest, recheck
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
