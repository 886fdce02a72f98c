"""Certificates of Krein collisions: checked again at three levels, forged ones refused at each; what they say."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import krein_cases as cases

from orbitproof import verify
from orbitproof.shared.formats import write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate, Level, certify, contradictions, digest, recheck
from orbitproof.verify.certificate.rechecking import derived
from orbitproof.verify.evidence import DerivativeTable
from orbitproof.verify.krein import enclose_krein
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import BreakingEnclosures


@pytest.fixture(scope="module")
def proved() -> Certificate:
    certificate = certify(cases.clock())
    assert certificate.proved
    return certificate


def _sealed(entry: dict[str, Any]) -> Certificate:
    """What a forger makes, who knows how digests are made."""
    content = {key: value for key, value in entry.items() if key != "digest"}
    return Certificate.from_json({**content, "digest": digest(content)})


def test_a_certificate_says_what_is_proved_of_a_subcritical_collision(proved: Certificate) -> None:
    assert str(proved).startswith("Krein collision, proved, below, energy of the clock = 2.2")
    told = proved.statement["in_full"]
    for words in (
        "the two stability parameters of the orbit, on the level of the first integral, are equal: a Krein collision",
        "are double, on the unit circle, no roots of unity of order 1 to 4, and each has one Jordan block",
        "The box is in the coordinates energy of the clock, x1, x2, with x > 0.",
        "the symmetric orbits are linearly stable for values of the parameter less than that",
        "their multipliers have left the unit circle for values greater than that",
        "omega/(2 pi) in [0.29999",
        "The collision is subcritical, b0 > 0.",
        "in which for this value and for those greater than it only the point of the symmetric orbit stays",
        ": no other periodic orbit and no invariant curve or torus of P^2 lies in it whole.",
        "The orbit of x is not stable. For values near it that are less all points that stay are within a constant",
        "What these are is not said.",
    ):
        assert words in told, words
    assert "supercritical" not in told


def test_a_certificate_says_what_is_proved_of_a_supercritical_collision() -> None:
    told = certify(cases.clock(a="-1", b="-1/2")).statement["in_full"]
    for words in (
        "the symmetric orbits are linearly stable for values of the parameter greater than that",
        "The collision is supercritical, b0 < 0. For all small d and abs(mu) <= d^2, on both sides,",
        "Nothing is said of longer times: neither that the orbit of x is stable, nor that there are invariant curves",
    ):
        assert words in told, words
    for words in ("subcritical", "is not stable", "no other periodic"):
        assert words not in told, words


Forgery = Callable[[dict[str, Any]], Any]


def _indices() -> Iterator[tuple[int, ...]]:
    for number in range(4**5):
        index = tuple(number // 4**place % 4 for place in range(5))
        if sum(index) <= 3:
            yield index


def _moved(entry: dict[str, Any], index: tuple[int, ...], by: str) -> None:
    """A derivative of the first coordinate of the image that is another number."""
    position = sorted(_indices()).index(index)
    for part in ("box", "centre"):
        entry["enclosures"]["image"][0][part][position] = f"{by} +- 0x1p-200"


def test_false_enclosures_are_refused_by_integration(proved: Certificate) -> None:
    entry = copy.deepcopy(proved.to_json())
    # Third derivatives by h count nowhere.
    _moved(entry, (3, 0, 0, 0, 0), "-0x1p+10")
    forged = _sealed({**derived(entry), "software": entry["software"]})
    assert forged.proved
    assert recheck(forged).stands
    found = recheck(forged, integrate=True)
    assert not found.stands
    assert found.passed is Level.CONCLUSION


def test_another_system_is_refused_by_integration(proved: Certificate) -> None:
    entry = copy.deepcopy(proved.to_json())
    entry["statement"]["candidate"]["parameters"].update(b="-1/2")
    forged = _sealed({**derived(entry), "software": entry["software"]})
    assert recheck(forged).stands
    found = recheck(forged, integrate=True)
    assert not found.stands
    assert found.passed is Level.CONCLUSION


def _each_changed(found: BreakingEnclosures) -> Iterator[BreakingEnclosures]:
    """The same with one number moved; every seventh derivative."""

    def moved(table: DerivativeTable) -> Iterator[DerivativeTable]:
        for index in list(table.box)[::7]:
            yield DerivativeTable({**table.box, index: table.box[index] + 2**200}, table.centre)
            yield DerivativeTable(table.box, {**table.centre, index: table.centre[index] + 2**200})

    ((first, second),), image = found.iterates, found.image
    yield from (replace(found, iterates=((table, second),)) for table in moved(first))
    yield from (replace(found, iterates=((first, table),)) for table in moved(second))
    yield from (replace(found, image=(table, image[1])) for table in moved(image[0]))
    yield from (replace(found, half_period=table) for table in moved(found.half_period))
    yield replace(found, sheet=(found.sheet[0] + 1,))


def test_every_number_that_a_certificate_carries_is_compared() -> None:
    found = enclose_krein(cases.clock(), IntegratorSettings(128), ORACLE)
    assert not list(contradictions(found, found, "tables"))
    for other in _each_changed(found):
        assert len(list(contradictions(found, other, "tables"))) == 1


def test_claims_are_proved_by_the_command_and_from_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = tmp_path / "claims.json", tmp_path / "certificates.json"
    write_candidates(path, [cases.clock()])
    assert main([str(path), "-o", str(output), "--quiet"]) == 0
    assert "Krein collision, linearly stable below energy of the clock = 2.2" in " ".join(
        capsys.readouterr().out.split()
    )
    assert main(["--recheck", str(output), "--quiet"]) == 0
    assert main(["--second-proof", str(output)]) == 1
    assert "cannot follow" in capsys.readouterr().out
    write_candidates(path, [cases.clock(kernel_frame=((Fraction(1), Fraction(0)),) * 2)])
    assert main([str(path), "--quiet"]) == 1
    assert "not proved" in capsys.readouterr().out
    (certificate,) = verify.certify(cases.clock(), quiet=True)
    assert certificate.proved
