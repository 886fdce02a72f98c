"""Places on a proved curve: told, checked again, and taken from nothing that does not stand."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.claims import known
from support.forgeries import atlas_certificate, fabricated, forged, of_parabola
from support.stored import values

from orbitproof.shared.formats import read_atlas
from orbitproof.verify.branches import make_atlas_certificate, places_on, recheck_place
from orbitproof.verify.certificate import Certificate, Finding, Level, Limits, Recheck, certify, recheck
from orbitproof.verify.run import CheckLimits
from orbitproof.verify.run.branch_checks import places_on_apart

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture(scope="module")
def point() -> Certificate:
    """Of a point of the curve, as far as can be told without an integration."""
    return fabricated(certify(known("fs3"), Limits(max_precision=256)), ("2", "4e-2"), "near")


@pytest.fixture(scope="module")
def curve() -> Certificate:
    """y = beta^2/100 for beta from 1 to 5."""
    atlas, results = of_parabola()
    return Certificate(atlas_certificate(atlas, results))


@pytest.fixture(scope="module")
def placed(curve: Certificate, point: Certificate) -> Certificate:
    (found,) = places_on(curve, [point])
    assert "lies on the proved curve parabola, piece p000, s" in found.line
    return found.certificate


def checked(curve: Certificate, entry: Certificate, examined: Recheck | None = None) -> Recheck:
    """With the place that it carries."""
    examined = recheck(curve) if examined is None else examined
    return recheck_place(curve, examined, entry, recheck(entry))


def test_a_place_stands_with_the_curve_that_it_rests_on(curve: Certificate, placed: Certificate) -> None:
    place = placed.to_json()["place"]
    assert place["rests_on"] == {"id": "parabola", "digest": curve.document["digest"]}
    assert (place["piece"], place["mirrored"], place["other_point"]) == ("p000", False, False)
    assert not recheck(placed).stands
    assert checked(curve, placed).stands


def test_a_curve_whose_results_were_read_can_be_handed_to_another_process(
    curve: Certificate, point: Certificate
) -> None:
    assert len(curve.results) == 3
    again = pickle.loads(pickle.dumps(curve))
    assert again == curve
    assert len(again.results) == len(copy.deepcopy(curve).results) == 3
    (found,) = places_on_apart(curve, [point], CheckLimits())
    assert "lies on the proved curve parabola" in found.line


CHANGES: dict[str, tuple[Callable[[dict[str, Any]], Any], str]] = {
    "another piece": (lambda place: place.update(piece="p001"), "piece"),
    "another s": (lambda place: place["s"].update(rad="0x1p-200"), "s"),
    "the other point": (lambda place: place.update(other_point=True), "other_point"),
    "its mirror image": (lambda place: place.update(mirrored=True), "mirrored"),
    "another digest": (lambda place: place["rests_on"].update(digest="sha256:" + 64 * "0"), "place"),
    "another curve": (lambda place: place["rests_on"].update(id="circle"), "place"),
}


@pytest.mark.parametrize(("change", "where"), CHANGES.values(), ids=CHANGES.keys())
def test_a_forged_place_is_found(
    change: Callable[[dict[str, Any]], Any], where: str, curve: Certificate, placed: Certificate
) -> None:
    place = placed.to_json()["place"]
    change(place)
    found = checked(curve, placed.with_place(place))
    assert not found.stands
    assert where in found.findings[0].place
    assert where != "place" or "rests on the curve" in found.findings[0].message


def test_other_words_of_a_place_are_a_forgery_or_told_anew(curve: Certificate, placed: Certificate) -> None:
    other = {**placed.to_json()["place"], "statement": "The orbit lies on every curve."}
    found = checked(curve, placed.with_place(other))
    assert "these sources, which word what it proves otherwise" in found.why
    assert found.rendered is None
    # A row of other sources, to which this program has added its place: nobody's words are all of one program.
    older = Certificate.from_json(forged(placed.to_json(), lambda d: d["software"].update(source="sha256:" + 64 * "0")))
    assert older.with_place(other).software == {**older.software, "program": "several"}
    assert placed.with_place(other).software == placed.software
    for entry, word in ((older, "stands"), (older.with_place(other), "stands, worded otherwise")):
        found = checked(curve, entry)
        assert found.word == word
        assert "every curve" not in json.dumps(found.rendered)


def test_a_curve_that_does_not_stand_places_nothing(curve: Certificate, placed: Certificate) -> None:
    falls = Recheck("parabola", "proved", 1, (Finding("digest", "does not fit the content"),))
    found = checked(curve, placed, falls)
    assert not found.stands
    assert "does not stand" in found.findings[0].message
    other = Certificate(forged(curve.document, lambda d: d["conclusion"]["joints"].pop()))
    (place,) = places_on(other, [placed])
    assert "place" not in place.certificate.to_json()
    assert "does not stand" in place.line


def test_no_orbit_is_placed_on_a_surface(placed: Certificate) -> None:
    atlas = read_atlas(DATA / "surface.json")
    results = values(json.loads((DATA / "surface-results.json").read_text()))
    surface = Certificate(make_atlas_certificate(atlas, results, None))
    (found,) = places_on(surface, [placed])
    assert "place" not in found.certificate.to_json()
    assert "that is no curve of symmetric orbits" in found.line


def test_a_place_is_checked_with_the_check_of_its_curve_and_no_further(curve: Certificate, placed: Certificate) -> None:
    examined, check = recheck(curve), recheck(placed)
    with pytest.raises(ValueError, match="not of the curve"):
        recheck_place(curve, replace(examined, digest="sha256:" + 64 * "0"), placed, check)
    deeper = replace(check, level=Level.INTEGRATION)
    assert recheck_place(curve, examined, placed, deeper).level is Level.CONCLUSION
    assert recheck_place(curve, replace(examined, level=Level.INTEGRATION), placed, deeper).level is Level.INTEGRATION
    falls = replace(check, findings=(Finding("results", "is forged"),))
    for rests_on, row in ((curve, falls), (None, check)):
        assert recheck_place(rests_on, examined, placed, row) is row
