"""Certificates of curves of periodic orbits without symmetry: written, read, checked, forged (sections 13, 26)."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.forgeries import checked, honest
from support.periodic_curves import ATLASES, TUBE, proved, shifted, turning_atlas

from orbitproof.shared.formats import Covers, InputError, PeriodicAtlas, read_atlas, validate_document, write_atlas
from orbitproof.verify.branches import SCHEMA, atlas_of, conclusion_of, make_atlas_certificate, results_from_json
from orbitproof.verify.branches.certificate import results_for
from orbitproof.verify.branches.interval_proof import prove_task
from orbitproof.verify.certificate import Certificate, read_certificate, recheck, write_certificate
from orbitproof.verify.certificate.stored_balls import to_json
from orbitproof.verify.periodic_curve import MultiplierFunctions, PeriodicIntervalResult, conclude_periodic
from orbitproof.verify.run.branch_command import main
from orbitproof.verify.theorems.periodic_curve import told

Document = dict[str, Any]


@cache
def certificate(name: str) -> Document:
    """The certificate of an atlas that is proved."""
    atlas, results = ATLASES[name], proved(name)
    document = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda entries: [], None))
    validate_document(document, SCHEMA, "the certificate")
    return json.loads(json.dumps(document))  # type: ignore[no-any-return]


@pytest.mark.parametrize("name", ATLASES)
def test_atlases_are_read_as_they_are_written(name: str, tmp_path: Path) -> None:
    path = tmp_path / "atlas.json"
    write_atlas(path, ATLASES[name])
    found = read_atlas(path)
    assert isinstance(found, PeriodicAtlas)
    assert found.pieces == ATLASES[name].pieces
    assert (found.claim, found.parameters) == (ATLASES[name].claim, ATLASES[name].parameters)


WRONG: dict[str, tuple[Callable[[Document], Any], str]] = {
    "parameter": (lambda e: e["claim"].update(parameter="b"), "field claim.parameter: turning has no parameter 'b'"),
    "parameters": (lambda e: e["parameters"].update(a="1"), "field parameters: turning takes the parameters: none"),
    "normal": (lambda e: e["claim"].update(normal=["0", "1", "0"]), "field claim.normal: 3 numbers"),
    "zero": (lambda e: e["claim"].update(normal=["0", "0"]), "field claim.normal: is zero"),
    "level": (lambda e: e["claim"].update(level="1"), "field claim.level: turning has no first integral"),
    "levels": (lambda e: e["claim"].pop("parameter"), "field claim.parameter: turning has no first integral"),
    "increasing": (lambda e: e["claim"].update(increasing=["y"]), "there are: a, x"),
    "covers": (
        lambda e: e["claim"].update(covers={"coordinate": "x", "from": "1", "to": "0x1p-1"}),
        "field claim.covers.to: not greater",
    ),
    "kind": (lambda e: e["pieces"][0].update(kind="symmetric"), "field pieces[0].kind: 'symmetric' in a curve that"),
    "coordinates": (lambda e: e["pieces"][0].update(coordinates="regularised"), "field pieces[0].coordinates"),
    "size": (lambda e: e["pieces"][0].update(centre=["0"]), "turning needs 2 here: a, x"),
    "same": (lambda e: e["pieces"][1].update(id="p1"), "appears twice"),
    "tube": (lambda e: e["pieces"][0].update(tube=["0"]), "field pieces[0].tube[0]: not positive"),
    "direction": (lambda e: e["claim"].update(direction=2), "field claim.direction"),
    "symmetry": (lambda e: e["claim"].update(symmetry="S"), "field claim"),
}


@pytest.mark.parametrize("name", WRONG)
def test_bad_atlases_are_refused_with_the_field(name: str, tmp_path: Path) -> None:
    change, said = WRONG[name]
    path = tmp_path / "atlas.json"
    write_atlas(path, turning_atlas())
    entry = json.loads(path.read_text())
    change(entry)
    path.write_text(json.dumps(entry))
    with pytest.raises(InputError) as caught:
        read_atlas(path)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_periods_that_are_not_stored_are_not_told() -> None:
    document = copy.deepcopy(certificate("turning"))
    del _results(document)[0]["time"]
    atlas = atlas_of(document)
    results = results_from_json(atlas, document["results"])
    again = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda entries: [], None))
    assert "period" not in again["conclusion"]
    assert "least periods lie" not in again["statement"]["theorem"]
    assert not recheck(Certificate(document)).stands


def _results(document: Document) -> list[Document]:
    results: list[Document] = document["results"]
    return results


def test_multipliers_that_an_integration_does_not_find_do_not_stand_it() -> None:
    atlas, (first, second) = ATLASES["turning"], proved("turning")
    assert isinstance(first, PeriodicIntervalResult)
    assert isinstance(first.multipliers, MultiplierFunctions)
    true = honest([to_json(first), to_json(second)])
    (function,) = first.multipliers.coefficients
    for factor in (1, 2):
        other = replace(function, coefficients=tuple(factor * value for value in function.coefficients))
        results = replace(first, multipliers=MultiplierFunctions((other,))), second
        document = make_atlas_certificate(atlas, results, told(conclude_periodic(atlas, results)), ())
        assert checked(document).stands
        assert checked(document, true).stands == (factor == 1)


def test_results_of_another_claim_are_not_used_again(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    write_certificate(path, certificate("turning"))
    stored = read_certificate(path, "atlas-certificate")
    atlas = stored.atlas
    assert isinstance(atlas, PeriodicAtlas)
    assert len(results_for(stored, atlas)) == 2
    assert not results_for(stored, replace(atlas, claim=replace(atlas.claim, crossings=2)))
    assert not results_for(stored, replace(atlas, claim=replace(atlas.claim, offset=Fraction(1, 10))))
    assert not results_for(stored, replace(atlas, claim=replace(atlas.claim, direction=-1)))
    assert not results_for(stored, replace(atlas, claim=replace(atlas.claim, normal=(Fraction(1), Fraction(2)))))
    assert not results_for(stored, replace(atlas, claim=replace(atlas.claim, level=Fraction(1))))
    assert not results_for(stored, replace(atlas, claim=replace(atlas.claim, parameter=None)))
    wider = replace(atlas, claim=replace(atlas.claim, covers=Covers("x", Fraction(4, 5), Fraction(1))))
    assert len(results_for(stored, wider)) == 2
    assert len(results_for(stored, shifted(atlas, TUBE))) == 1


@pytest.mark.parametrize(
    "change", [{"crossings": 2}, {"direction": -1}, pytest.param({"offset": "0x1p-10"}, marks=pytest.mark.slow)]
)
def test_certificates_of_another_section_do_not_stand_the_integration(
    change: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is stored of a piece does not say for which section it was found: that is seen when it is proved again."""
    document = copy.deepcopy(certificate("levels"))
    document["statement"]["atlas"]["claim"].update(change)
    changed = atlas_of(document)
    assert isinstance(changed, PeriodicAtlas)
    results = results_from_json(changed, document["results"])
    document = make_atlas_certificate(changed, results, told(conclude_periodic(changed, results)))
    output = tmp_path / "certificate.json"
    write_certificate(output, document)
    assert main(["--recheck", "--integrate", str(output), "--quiet"], prove_task) == 1
    assert "FAILED levels: piece p1" in capsys.readouterr().err


@pytest.mark.parametrize("option", [["--complete", "3"], ["--bifurcations", "none.json"]])
def test_what_belongs_to_symmetric_curves_is_refused(
    option: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "atlas.json"
    write_atlas(path, turning_atlas())
    assert main([str(path), *option, "--quiet"], prove_task) == 2
    assert "curve" in capsys.readouterr().err
