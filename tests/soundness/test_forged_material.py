"""Forgeries of what a certificate is made of: whose functions, whose checks, how narrow, of what types."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from support import atlas_work, stability_cases
from support.chain_cases import symmetric_arc
from support.claims import known
from support.forgeries import Document, atlas_certificate, checked, forged
from test_forged_certificates import fabricated, of_parabola

from orbitproof.verify.atlas.__main__ import main
from orbitproof.verify.atlas.certificate import make_atlas_certificate, write_atlas_certificate
from orbitproof.verify.atlas.conclusion import conclusion_of
from orbitproof.verify.certificate import Certificate, Level, Limits, digest, recheck
from orbitproof.verify.certificate.certify import certify
from orbitproof.verify.curve.theorem import conclude


@pytest.fixture(scope="module")
def point() -> Certificate:
    """A certificate of the Falkner-Skan touch-and-go bifurcation."""
    return certify(known("fs3"), Limits(max_precision=256))


# Functions of s belong to the interval on which they were found


@pytest.mark.parametrize("ends", [["-0x7p-3", "0x1"], ["-0x1", "0x7p-3"]])
def test_functions_that_were_moved_to_another_interval_are_found_by_integrating(ends: list[str]) -> None:
    """They are written in a variable that runs over their interval: a proof on more than the stored one is another."""
    atlas, true = stability_cases.atlas(), stability_cases.results()

    def whole(argument: Mapping[str, Any], report: Any) -> Document:
        return next(result for result in true if result["piece"] == argument["piece"]["id"])

    moved = copy.deepcopy(true)
    moved[1]["interval"] = ends
    document = make_atlas_certificate(atlas, moved, stability_cases.listed(moved))
    if document["verdict"] == "proved":
        assert checked(document).stands
    found = checked(document, whole)
    assert not found.stands
    assert any(entry.place.endswith("stability") and "interval" in entry.message for entry in found.findings)


@pytest.mark.parametrize("ends", [["-0x1", "0x7p-3"], ["0x0", "0x1"]])
def test_an_interval_about_a_symmetric_point_is_centred_there(ends: list[str]) -> None:
    """What is proved there is proved of both sides at once: any other interval is no run's."""
    atlas, _ = symmetric_arc()
    asked = {"integrator": {"precision": 80, "order": 40, "width": 40}, "interval": ["-0x1", "0x1"]}
    results = [atlas_work.proving({**asked, "piece": piece.to_json()}, lambda *_: None) for piece in atlas.pieces]
    assert checked(atlas_certificate(atlas, results)).stands
    results[0]["interval"] = ends
    found = checked(atlas_certificate(atlas, results))
    assert found.level is Level.NONE
    assert [entry.place for entry in found.findings] == ["results[0].interval"]


# Each certificate that a theorem rests on is checked itself


def test_a_forged_certificate_before_an_honest_one_of_the_same_id_is_refused(
    point: Certificate, tmp_path: Path, capsys: Any
) -> None:
    false = fabricated(point, ("2", "4e-2"), point.id).to_json()
    false["results"]["side"] = "above"
    false["digest"] = digest(false)
    lie = Certificate.from_json(false)
    assert not recheck(lie).stands
    atlas, results = of_parabola()

    both = conclude(atlas, results, [lie, point], lambda entry: recheck(point)).to_json()
    assert [entry["on_curve"] for entry in both["bifurcations"]] == [True, False]
    document = make_atlas_certificate(atlas, results, both, [lie, point])
    write_atlas_certificate(tmp_path / "forged.json", document)
    assert main(["--recheck", str(tmp_path / "forged.json"), "--quiet"]) == 1
    assert "appears twice" in capsys.readouterr().err
    assert checked(document).level is Level.NONE
    with pytest.raises(ValueError, match="appears twice"):
        conclusion_of(atlas, results, [lie, point], lambda entries: [recheck(point) for _ in entries], None)


def test_checks_belong_to_certificates_and_not_to_their_ids(point: Certificate) -> None:
    """A check in another place than its certificate would be seen: here the first one falls."""
    atlas, results = of_parabola()
    near = fabricated(point, ("2", "4e-2"), "near")
    bad = Certificate.from_json(forged(near.to_json(), lambda entry: entry["results"].update(side="above")))
    bad = Certificate.from_json(
        forged(bad.to_json(), lambda entry: (entry.update(id="bad"), entry["statement"]["candidate"].update(id="bad")))
    )
    document = atlas_certificate(atlas, results, [bad, near])
    assert [entry["on_curve"] for entry in document["conclusion"]["bifurcations"]] == [False, True]
    assert checked(document).stands
