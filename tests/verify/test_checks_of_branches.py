"""Each thing that the check of a branch compares is compared: certificates that differ from the true ones in it."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from support import atlas_work
from support.atlas_runs import CURVE, go
from support.chain_cases import certificate, symmetric_arc
from support.claims import known
from support.conclusions import conclude, with_complete_list
from support.forgeries import atlas_certificate, forged, forged_elsewhere, honest, of_parabola
from support.stability_cases import results as stability_results
from support.stored import value_of, values

from orbitproof.shared import InputError, parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import read_atlas
from orbitproof.verify.branches import Means, ProvedBefore, make_atlas_certificate, order_of
from orbitproof.verify.branches import recheck as chapter
from orbitproof.verify.branches.certificate import results_for
from orbitproof.verify.branches.conclusion_as_json import _outward, shortened
from orbitproof.verify.branches.kinds import BranchKind
from orbitproof.verify.branches.places import _to_json as place_to_json
from orbitproof.verify.branches.recheck import _contradictions, _interval_findings
from orbitproof.verify.certificate import (
    Certificate,
    Finding,
    Given,
    Level,
    Recheck,
    read_certificate,
    recheck,
    write_certificate,
)
from orbitproof.verify.certificate import not_proved as unproved
from orbitproof.verify.curve import Bifurcation, IntervalResult, PlaceOnCurve
from orbitproof.verify.evidence import Reason, ball_to_json
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.run.branch_tasks import reusable, task_again
from orbitproof.verify.stability import StabilityFunctions, StabilityResult
from orbitproof.verify.surface import ProvedPart, SurfaceResult
from orbitproof.verify.theorems.curve import KIND as CURVES
from orbitproof.verify.theorems.surface import KIND as SURFACES

DATA = Path(__file__).parents[1] / "data"
Prove = Callable[[Atlas, Sequence[ProvedBefore], Callable[[str, Any], str]], None]


def checked(document: Any, prove: Prove | None = None) -> Recheck:
    return recheck(
        Certificate(document), prove is not None, given=Given((), means=Means(lambda entries, integrate: (), prove))
    )


def as_before(atlas: Atlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Any], str]) -> None:
    """A prover that finds what is true."""
    for each in intervals:
        argument = task_again(atlas, each, None).argument
        finished(each.name, value_of(atlas_work.proving(argument, lambda fraction, label: None)))


@pytest.fixture(scope="module")
def document() -> Any:
    return atlas_certificate(*of_parabola())


# Its form


@pytest.mark.parametrize(("name", "value"), [("precision", 10**6), ("order", -1), ("steps", 5000)])
def test_settings_of_the_integrator_are_possible(document: Any, name: str, value: int) -> None:
    found = checked(forged(document, lambda d: d["results"][1]["computation"].update({name: value})))
    assert (found.stands, found.level) == (False, Level.NONE)


@pytest.mark.parametrize("interval", [("0x0", "0x1"), ("-0x1", "0x0"), ("-0x1p-1", "0x1")])
def test_what_contains_the_symmetric_point_is_proved_about_it(interval: tuple[str, str]) -> None:
    atlas, results = symmetric_arc()
    assert atlas.pieces[0].kind == "symmetric"
    places = []
    for start, end in (interval, ("-0x1", "0x1")):
        changed = replace(value_of(results[0]), interval=(parse_exact(start), parse_exact(end)))
        unfinished = make_atlas_certificate(atlas, values([changed, *results[1:]]), None)
        places.append([finding.place for finding in checked(unfinished).findings])
    assert places == [["results[0].interval", "conclusion"], ["conclusion"]]


def test_a_certificate_of_an_id_is_carried_once(document: Any) -> None:
    carried = unproved(known("fs3"), Reason("time", "it is late", "give it more"), 0.0).to_json()
    twice = forged(document, lambda d: d.update(rests_on=[carried, carried]))
    messages = {finding.message for finding in checked(twice).findings if finding.place == "rests_on"}
    assert f"{carried['id']!r} appears twice: nothing says which of them the theorem is about" in messages


def not_proved() -> Any:
    run, _ = go(CURVE, atlas_work.proving)
    return atlas_certificate(CURVE, run.results[:2])  # type: ignore[arg-type]


def test_a_reason_is_a_hypothesis_or_what_ends_a_proof() -> None:
    document = not_proved()
    assert document["verdict"] == "not proved"
    assert checked(document).stands
    found = checked(forged(document, lambda d: d["reason"].update(condition="luck")))
    assert (found.level, [finding.place for finding in found.findings]) == (Level.NONE, ["reason"])


def test_what_is_not_proved_cannot_be_called_proved() -> None:
    found = checked(forged(not_proved(), lambda d: d.update(verdict="proved")))
    assert not found.stands


@pytest.mark.parametrize("order", [0, 100, -3, True, 2.0, "3"])
def test_the_order_of_a_list_is_one_from_1_to_99(order: Any) -> None:
    assert [order_of({"conclusion": {"complete": {"order": number}}}) for number in (1, 99)] == [1, 99]
    with pytest.raises(ValueError, match="1 to 99"):
        order_of({"conclusion": {"complete": {"order": order}}})


@pytest.mark.slow
@pytest.mark.parametrize(("order", "stands"), [(24, True), (99, False)])
def test_a_list_is_taken_for_a_longer_one_only_where_what_is_stored_shows_that(order: int, stands: bool) -> None:
    """The planar Lyapunov orbits meet no resonance of the orders 13 to 24, and some of those up to 99."""
    atlas, found = read_atlas(DATA / "atlas-lyapunov.json"), json.loads((DATA / "stability-lyapunov.json").read_text())
    assert isinstance(atlas, Atlas)
    curve = conclude(atlas, values(found))
    short, true = (
        make_atlas_certificate(atlas, values(found), with_complete_list(atlas, found, curve, number))
        for number in (12, order)
    )
    changed = forged_elsewhere(short, lambda d: d["conclusion"]["complete"].update(order=order))
    check = checked(changed)
    assert check.stands == stands
    # Its old words are about the shorter list; those that are printed are the words of the one that is shown.
    assert check.rendered is not None
    assert check.rendered["statement"]["theorem"] == true["statement"]["theorem"]
    assert f"k at most {order}" in true["statement"]["theorem"]
    assert (changed["conclusion"]["complete"] == true["conclusion"]["complete"]) == stands
    assert not checked({**changed, "digest": short["digest"]}).stands


# Its integration


def test_every_interval_is_asked_for_with_other_settings_and_without_an_answer_is_not_confirmed(document: Any) -> None:
    asked: list[Sequence[ProvedBefore]] = []
    found = checked(document, lambda atlas, intervals, finished: asked.append(list(intervals)))
    first, second, third, last = asked
    assert [each.piece.id for each in first] == [each["piece"] for each in document["results"]]
    assert all([each.name for each in other] == [each.name for each in first] for other in (second, third, last))
    assert [finding.place for finding in found.findings] == [each.name for each in first]
    assert {finding.message for finding in found.findings} == {"was not integrated again"}
    assert found.level is Level.CONCLUSION
    assert [dict(each.settings) for each in first] == [{"precision": 112, "order": 44, "width": 48, "top": 1}] * 3
    assert [dict(each.settings) for each in second] == [{"precision": 112, "order": 44, "width": 40, "top": 1}] * 3
    assert [dict(each.settings) for each in third] == [{"precision": 112, "order": 40, "width": 40, "top": 1}] * 3
    assert [dict(each.settings) for each in last] == [{"precision": 80, "order": 40, "width": 40, "top": 1}] * 3


def test_where_nothing_is_proved_there_is_nothing_to_integrate() -> None:
    atlas, results = of_parabola()
    none = [honest(())({"piece": {"id": each["piece"]}, "interval": each["interval"]}, print) for each in results]
    found = checked(atlas_certificate(atlas, none), as_before)  # type: ignore[arg-type]
    assert (found.stands, found.level) == (True, Level.CONCLUSION)


def test_a_theorem_that_the_new_results_do_not_prove_is_found(document: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    honestly = chapter.conclusion_of
    proved: list[str] = []

    def conclude(*arguments: Any) -> Any:
        conclusion = honestly(*arguments)
        return {**conclusion, "verdict": "not proved", "reason": {"message": "a gap"}} if proved else conclusion

    def prove(atlas: Atlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Any], str]) -> None:
        proved.extend(each.name for each in intervals)
        as_before(atlas, intervals, finished)

    monkeypatch.setattr(chapter, "conclusion_of", conclude)
    found = checked(document, prove)
    assert [finding.message for finding in found.findings] == ["the theorem is not proved again: a gap"]


# One interval


def kind_of(result: IntervalResult) -> BranchKind:
    return SURFACES if isinstance(result, SurfaceResult) else CURVES


def said(stored: IntervalResult, fresh: IntervalResult) -> list[str]:
    return [f"{finding.place}: {finding.message}" for finding in _interval_findings(stored, fresh, kind_of(stored))]


def test_bounds_across_the_curve_are_as_many() -> None:
    result = value_of(of_parabola()[1][0])
    assert not said(result, result)
    for name in ("deviation", "slope_deviation"):
        changed: dict[str, Any] = {name: (*getattr(result, name), Fraction(0))}
        (text,) = said(result, replace(result, **changed))
        assert text.endswith(f"another number of bounds {name}")


def test_half_periods_that_differ_contradict_each_other() -> None:
    result = value_of(of_parabola()[1][0])
    (finding,) = _contradictions(result, replace(result, time=arb(9, 0.25)), kind_of(result))
    assert finding.place.endswith("half period")
    assert not list(_contradictions(result, result, kind_of(result)))


def test_functions_are_those_of_the_stored_interval_and_confirmed() -> None:
    result = value_of(stability_results()[0])
    assert isinstance(result, StabilityResult)
    assert isinstance(result.stability, StabilityFunctions)
    assert not said(result, result)
    longer = replace(result, interval=(Fraction(-2), Fraction(2)))
    assert any("its functions are of another interval" in text for text in said(result, longer))
    other = replace(result.stability, half_period=StoredFunction((Fraction(7),), Fraction(1, 1024)))
    assert any("half period" in text for text in said(result, replace(result, stability=other)))
    assert said(result, replace(result, stability=None))


def surface() -> SurfaceResult:
    result = value_of(json.loads((DATA / "surface-results.json").read_text())[0])
    assert isinstance(result, SurfaceResult)
    assert len(result.parts) == 3
    return result


def with_part(number: int, **changes: Any) -> SurfaceResult:
    result = surface()
    parts = list(result.parts)
    parts[number] = replace(parts[number], **changes)
    return replace(result, parts=tuple(parts))


@pytest.mark.parametrize("number", range(2))
def test_each_part_is_proved_again_on_all_of_it(number: int) -> None:
    """By parts inside it: others have other sides, and their enclosures are of other orbits too."""
    assert not said(surface(), surface())
    parts = list(surface().parts)
    (start, end), (_, beyond) = (part.interval for part in parts[number : number + 2])
    for middle in ((start + end) / 2, (end + beyond) / 2):
        parts[number : number + 2] = (
            replace(surface().parts[number], interval=(start, middle)),
            replace(surface().parts[number + 1], interval=(middle, beyond)),
        )
        found = said(surface(), replace(surface(), parts=tuple(parts)))
        # One is proved on a half of it, the other by a part that reaches out of it.
        assert len(found) == 2
        assert all(text.endswith("is not proved again on all of it") for text in found)


@pytest.mark.parametrize("number", range(3))
def test_the_sides_of_all_parts_agree(number: int) -> None:
    (finding,) = _contradictions(surface(), with_part(number, side="above"), SURFACES)
    assert finding.place.endswith("side")


def enclosures(part: ProvedPart, change: Callable[[dict[str, dict[str, arb]]], Any]) -> dict[str, Any]:
    found = {name: dict(balls) for name, balls in part.enclosures.items()}
    return {"enclosures": change(found) or found}


def test_enclosures_of_a_part_are_those_of_a_new_proof_and_contain_them() -> None:
    part = surface().parts[1]
    ball = part.enclosures["HC3"]["g_0"]
    wider, narrower = ball + arb(0, 1), arb(ball.mid())

    def found(change: Callable[[dict[str, dict[str, arb]]], Any]) -> list[str]:
        return said(surface(), with_part(1, **enclosures(part, change)))

    assert any("stored hypotheses are" in text for text in found(lambda e: dict(reversed(e.items()))))
    for change in (lambda e: e["HC3"].update(more=ball), lambda e: e["HC3"].pop("g_0")):
        (text,) = found(lambda e, change=change: change(e) and None)
        assert text.endswith("HC3: has other enclosures than the new proof")
    (text,) = found(lambda e: e["HC3"].update(g_0=wider))
    assert "HC3, g_0: stored is" in text
    assert not found(lambda e: e["HC3"].update(g_0=narrower))
    (text,) = said(surface(), with_part(1, point=(part.point[0] + arb(0, 1), *part.point[1:])))
    assert "p_0: stored is" in text


# The certificates that it rests on


@pytest.mark.parametrize("standing", ["a", "b"])
def test_each_certificate_counts_as_far_as_it_stands_itself(standing: str) -> None:
    atlas, results = of_parabola()
    point = {"beta": arb(2, 2.0**-40), "y": arb(4) / 100}
    entries = [certificate(point, name=name) for name in "ab"]
    failing = (Finding("results", "is forged"),)

    def check(given: Sequence[Certificate]) -> list[Recheck]:
        return [Recheck(entry.id, "proved", 1, () if entry.id == standing else failing) for entry in given]

    found = chapter.conclusion_of(atlas, values(results), entries, check, None)["bifurcations"]
    falls = {entry["id"]: "does not stand: results: is forged" in entry["reason"] for entry in found}
    assert falls == {name: name != standing for name in "ab"}


def test_certificates_are_carried_without_their_places() -> None:
    atlas, results = of_parabola()
    point = certificate({"beta": arb(2, 2.0**-40), "y": arb(4) / 100}, name="a")
    placed = point.with_place({
        "rests_on": {"id": "parabola", "digest": "sha256:" + 64 * "0"}, "piece": "p001", "s": ball_to_json(arb(0, 1)),
        "mirrored": False, "other_point": False, "statement": "on it",
    })  # fmt: skip
    assert "place" in placed.to_json()
    (carried,) = make_atlas_certificate(atlas, values(results), None, [placed])["rests_on"]
    assert "place" not in carried
    assert carried["statement"] == point.to_json()["statement"]


# What is kept of it


def test_results_are_kept_of_the_same_claim_only() -> None:
    atlas, results = of_parabola()
    before = Certificate(atlas_certificate(atlas, results))
    assert len(results_for(before, atlas)) == 3
    for other in (
        replace(atlas, system=replace(atlas.system, name="another")),
        replace(atlas, parameters={"mu": Fraction(1, 2)}),
        replace(atlas, claim=replace(atlas.claim, symmetry="S")),
        replace(atlas, claim=replace(atlas.claim, crossings=2)),
    ):
        assert results_for(before, other) == []


def test_where_a_list_is_wanted_only_results_with_stability_are_kept() -> None:
    atlas, results = of_parabola()
    known = replace(value_of(stability_results()[0]), piece=atlas.pieces[0].id)
    before = Certificate(make_atlas_certificate(atlas, [known, *values(results[1:])], None))
    assert [result.piece for result in reusable(before, atlas, ())] == [piece.id for piece in atlas.pieces]
    assert [result.piece for result in reusable(before, atlas, (), stability=True)] == [atlas.pieces[0].id]


def test_a_file_that_does_not_fit_its_digest_is_not_read(document: Any, tmp_path: Path) -> None:
    path = tmp_path / "curve.json"
    write_certificate(path, document)
    assert read_certificate(path, "atlas-certificate").document == document
    write_certificate(path, {**document, "id": "another"})
    with pytest.raises(InputError, match="digest"):
        read_certificate(path, "atlas-certificate")


def test_a_branch_is_whole_if_all_that_was_asked_about_is_on_it(document: Any) -> None:
    def is_whole(*on_curve: bool, **complete: Any) -> bool:
        conclusion = {"bifurcations": [{"on_curve": on} for on in on_curve], "complete": complete}
        return Certificate({**document, "conclusion": conclusion}).is_whole

    assert is_whole()
    assert is_whole(True, True, gaps=[], undecided=[])
    assert not is_whole(True, False)
    assert not is_whole(True, gaps=[{}])
    assert not is_whole(True, undecided=[{}])


def test_results_stand_in_order_along_the_curve(document: Any) -> None:
    atlas, results = of_parabola()
    again = make_atlas_certificate(atlas, values(list(reversed(results))), None)
    assert again["results"] == document["results"]


def test_ends_of_intervals_are_written_outward() -> None:
    third = Fraction(1, 3)
    low, high = shortened(third, -1), shortened(third, 1)
    assert low < third < high
    assert high - low == Fraction(1, 2**60)
    assert [parse_exact(text) for text in _outward(third, third)] == [low, high]
    assert [parse_exact(text) for text in _outward(Fraction(-1), Fraction(1))] == [-1, 1]


def test_a_place_is_told_as_it_was_found() -> None:
    atlas, results = of_parabola()
    curve = Certificate(atlas_certificate(atlas, results))
    for mirrored, other_point in ((False, True), (True, False)):
        place = PlaceOnCurve("p001", arb(1, 2**-9), mirrored, other_point)
        told = place_to_json(curve, Bifurcation("a", "orbit", 1, place, "", {}, "period", None))
        assert (told["piece"], told["mirrored"], told["other_point"]) == ("p001", mirrored, other_point)
