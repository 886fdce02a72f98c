"""Forged certificates: well formed, with a new digest, and found at the level that can see them."""

from __future__ import annotations

import copy
import json
from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest
from flint import arb
from support import forgeries
from support.claims import known
from support.forgeries import (
    DATA,
    Document,
    atlas_certificate,
    changes,
    checked,
    fabricated,
    forged,
    forged_elsewhere,
    honest,
    of_parabola,
    read,
)

from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import (
    SYSTEMS,
    ReversibleSystem,
    program_from_text,
)
from orbitproof.verify.branches import atlas_of, curve_conclusion
from orbitproof.verify.certificate import Certificate, Given, Level, Limits, Recheck, certify, recheck
from orbitproof.verify.evidence import ball_from_json, ball_to_json, spared


@pytest.fixture(scope="module")
def curve(point: Certificate) -> Document:
    """A curve, and a bifurcation that is not shown to lie on it."""
    atlas, results = of_parabola()
    return json.loads(json.dumps(atlas_certificate(atlas, results, [point])))  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def family() -> Document:
    """A libration family, with a result that a prover could have found."""
    atlas = read("atlas-lyapunov.json")
    result = {
        **of_parabola()[1][0],
        "piece": "p001",
        "deviation": ["0x1p-40"],
        "slope_deviation": ["0x1p-36"],
    }
    return json.loads(json.dumps(atlas_certificate(atlas, [result])))  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def surface() -> Document:
    """A surface, from stored results."""
    results = json.loads((DATA / "surface-results.json").read_text())
    return json.loads(json.dumps(atlas_certificate(read("surface.json"), results)))  # type: ignore[no-any-return]


def with_honest_prover(document: Document, original: Document) -> Recheck:
    return checked(document, honest(original["results"], original["statement"]["atlas"]["pieces"]))


@pytest.mark.parametrize("kind", ["curve", "family", "surface"])
def test_an_honest_certificate_stands_at_every_level(kind: str, request: pytest.FixtureRequest) -> None:
    document = request.getfixturevalue(kind)
    assert document["verdict"] == "proved", document["reason"]
    assert checked(document).findings == ()
    found = with_honest_prover(document, document)
    assert (found.findings, found.level) == ((), Level.INTEGRATION)


def test_a_certificate_of_a_point_stands_at_every_level(point: Certificate) -> None:
    found = recheck(point, True)
    assert (found.findings, found.level) == ((), Level.INTEGRATION)


# What is printed follows from what is stored


def _listed(document: Document) -> None:
    document["conclusion"]["bifurcations"][0].update(on_curve=True, piece="p000", reason="")


def _dropped_from_the_list(document: Document) -> None:
    document["conclusion"]["bifurcations"] = []
    document["rests_on"] = []


CONCLUSION: dict[str, tuple[Callable[[Document], Any], str]] = {
    "end": (lambda d: d["conclusion"]["ends"]["end"].update(d["conclusion"]["ends"]["start"]), "ends"),
    "bifurcation put on the curve": (_listed, "bifurcations"),
    "sign in the field": (
        lambda d: d["statement"].update(vector_field=d["statement"]["vector_field"].replace(" - ", " + ", 1)),
        "vector_field",
    ),
    "sign of R": (lambda d: d["statement"].update(reversing_symmetry=[1, 1, -1]), "reversing_symmetry"),
    "section": (lambda d: d["statement"].update(section="x"), "section"),
    "name of the system": (lambda d: d["statement"]["names"].update(system="the weather"), "names"),
    "joint": (lambda d: d["conclusion"]["joints"].pop(), "joints"),
}


@pytest.mark.parametrize(("change", "where"), CONCLUSION.values(), ids=CONCLUSION.keys())
def test_what_does_not_follow_is_found_without_integrating(curve: Document, change: Any, where: str) -> None:
    found = checked(forged(curve, change))
    assert found.level is Level.FORM, found.findings
    assert where in " ".join(finding.place for finding in found.findings)


def _infinitely_many(document: Document) -> None:
    text = "infinitely many period doublings for beta from 1 to 1000000"
    document["statement"].update(theorem=text, in_full=text)
    document["conclusion"]["statement"] = text


REWORDED: dict[str, Callable[[Document], Any]] = {
    "theorem": _infinitely_many,
    "theorem of the statement alone": lambda d: d["statement"].update(theorem="more"),
    "hypothesis": lambda d: d["conclusion"]["hypotheses"][0].update(statement="anything"),
    "bifurcation left out, and not in the words": _dropped_from_the_list,
}


@pytest.mark.parametrize("change", REWORDED.values(), ids=REWORDED.keys())
def test_a_true_certificate_in_other_words_is_told_in_those_of_this_version(curve: Document, change: Any) -> None:
    assert "these sources, which word what it proves otherwise" in checked(forged(curve, change)).why
    other = forged_elsewhere(curve, change)
    found = checked(other)
    assert (found.findings, found.word) == ((), "stands, worded otherwise")
    assert found.rendered is not None
    again = atlas_certificate(
        atlas_of(other), other["results"], [Certificate.from_json(entry) for entry in other["rests_on"]]
    )
    assert found.rendered == {**again, "software": other["software"], "digest": other["digest"]}
    assert "infinitely" not in json.dumps(found.rendered)
    assert checked(curve).rendered is None


def test_a_certificate_with_other_bifurcations_than_it_lists_is_malformed(curve: Document) -> None:
    found = checked(forged(curve, lambda d: d.update(rests_on=[])))
    assert found.level is Level.NONE
    assert [finding.place for finding in found.findings] == ["rests_on"]


def test_certificates_beside_the_file_have_to_be_those_in_it(curve: Document, point: Certificate) -> None:
    assert checked(curve, given=[point]).stands
    other = Certificate.from_json(forged(point.to_json(), lambda d: d["computation"].update(seconds=0)))
    for given in ([other], [point, Certificate.from_json(forged(point.to_json(), lambda d: d.update(id="x")))]):
        assert [finding.place for finding in checked(curve, given=given).findings] == ["rests_on"]


@pytest.mark.parametrize("key", ["rests_on", "names", "in_full"])
def test_a_file_that_lacks_what_it_rests_on_or_says_is_malformed(curve: Document, key: str) -> None:
    found = checked(forged(curve, lambda d: (d if key in d else d["statement"]).pop(key)))
    assert found.level is Level.NONE
    assert repr(key) in found.findings[0].message


# What is stored is integrated again


@pytest.mark.parametrize("key", ["deviation", "slope_deviation"])
def test_deviations_that_are_too_small_are_found_by_integrating(curve: Document, key: str) -> None:
    def smaller(document: Document) -> None:
        for result in document["results"]:
            result[key] = ["0x0"]

    atlas, results = of_parabola()
    document = copy.deepcopy(results)
    for result in document:
        result[key] = ["0x0"]
    consistent = atlas_certificate(atlas, document)
    assert checked(consistent).stands
    found = checked(consistent, honest(results))
    assert found.level is Level.CONCLUSION
    assert all(f"{key} 1" in finding.place for finding in found.findings)
    assert len(found.findings) == len(results)


def test_what_only_polynomials_of_higher_degree_enclose_more_widely_is_confirmed() -> None:
    atlas, results = of_parabola()
    document = atlas_certificate(atlas, results)
    widths: list[int] = []

    def wide(argument: Document, report: Any) -> Document:
        found = dict(honest(results)(argument, report))
        widths.append(argument["integrator"]["width"])
        return found if widths[-1] == 40 else {**found, "deviation": ["0x1"]}

    assert checked(document, wide).stands
    assert Counter(widths) == {48: len(results), 40: len(results)}


def test_what_more_bits_do_not_make_smaller_is_confirmed_by_the_integration_of_the_run() -> None:
    """Bounds about an exact solution, for one; a proof that is not that of the run does not count for it."""
    atlas, results = of_parabola()
    document = atlas_certificate(atlas, results)
    settings: list[tuple[int, ...]] = []

    def noisy(argument: Document, report: Any) -> Document:
        settings.append(tuple(argument["integrator"][name] for name in ("precision", "order", "width")))
        found = dict(honest(results)(argument, report))
        return found if settings[-1] == (80, 40, 40) else {**found, "deviation": ["0x1"]}

    assert checked(document, noisy).stands
    assert len(settings) == 4 * len(results)
    assert not checked(forged(document, lambda d: d["results"][0]["computation"].update(precision=81)), noisy).stands


@pytest.mark.parametrize("off", [1, -1])
def test_half_periods_that_contain_what_is_found_only_nearly_are_not_confirmed(off: int) -> None:
    """A wide ball that leaves a part of a narrow one out, however small it is beside its own width."""
    atlas, results = of_parabola()
    found = [{**result, "time": ball_to_json(spared(arb(3, 2.0**-40)))} for result in results]
    wide = arb(0, 8)
    beside = wide + 3 + off * (wide.rad() - 2.0**-41)
    for reach, stands in ((spared(arb(3, 2.0**-40)), True), (beside, False)):
        stored = [{**result, "time": ball_to_json(reach)} for result in results]
        assert checked(atlas_certificate(atlas, stored), honest(found)).stands is stands


def test_a_contradiction_is_not_mended_by_a_second_integration_that_agrees() -> None:
    atlas, results = of_parabola()

    def first_apart(argument: Document, report: Any) -> Document:
        found = dict(honest(results)(argument, report))
        return found if argument["integrator"]["width"] == 40 else {**found, "time": ball_to_json(arb(300))}

    found = checked(atlas_certificate(atlas, results), first_apart)
    assert not found.stands
    assert "disjoint" in found.findings[0].message


def test_half_periods_that_are_too_narrow_are_found_by_integrating() -> None:
    atlas, results = of_parabola()
    narrow = [{**result, "time": ball_to_json(arb(3, 2**-9))} for result in results]
    consistent = atlas_certificate(atlas, narrow)
    assert checked(consistent).stands
    found = checked(consistent, honest(results))
    assert "half period" in found.findings[0].place


def test_a_bifurcation_that_does_not_exist_is_found_by_integrating(point: Certificate) -> None:
    doubling = fabricated(point, ("2", "4e-2"), "fabricated")
    assert recheck(doubling).stands
    atlas, results = of_parabola()
    document = atlas_certificate(atlas, results, [doubling])
    assert "- fabricated: touch-and-go of order 3" in document["statement"]["theorem"]
    assert checked(document).stands
    found = checked(document, honest(results))
    assert found.level is Level.CONCLUSION
    assert "bifurcation fabricated" in found.findings[0].place


def test_a_point_farther_off_than_the_deviation_is_a_contradiction(point: Certificate) -> None:
    """Inside the tube, where there is exactly one orbit, but not where that is."""
    atlas, results = of_parabola()
    apart = fabricated(point, ("2", "400001e-7"), "apart")
    document = atlas_certificate(atlas, results, [apart])
    assert document["verdict"] == "not proved"
    assert document["reason"]["condition"] == "bifurcations"
    assert "contradict" in document["reason"]["message"]
    near = fabricated(point, ("2", "4e-2"), "near")
    assert atlas_certificate(atlas, results, [near])["verdict"] == "proved"


def _vague(document: Document) -> None:
    for result in document["results"]:
        for part in result["parts"]:
            for balls in part["hypotheses"].values():
                for name in balls:
                    balls[name] = ball_to_json(arb(0, 1))


def _turned(document: Document) -> None:
    for result in document["results"]:
        for part in result["parts"]:
            part["side"] = {"below": "above", "above": "below"}[part["side"]]


@pytest.mark.parametrize("change", [_vague, _turned])
def test_parts_of_a_surface_that_show_nothing_or_another_side_are_found(surface: Document, change: Any) -> None:
    found = checked(forged(surface, change))
    assert found.level is Level.FORM
    assert "results[0].parts[0]" in found.findings[0].place


def test_a_side_that_is_consistent_with_a_false_enclosure_is_found_by_integrating(surface: Document) -> None:
    results = copy.deepcopy(surface["results"])
    for result in results:
        for part in result["parts"]:
            balls = part["hypotheses"]["h_b''"]
            balls["h_b''"] = ball_to_json(-ball_from_json(balls["h_b''"]))
            part["side"] = {"below": "above", "above": "below"}[part["side"]]
    consistent = atlas_certificate(read("surface.json"), results)
    assert checked(consistent).stands
    found = checked(consistent, honest(surface["results"]))
    assert found.level is Level.CONCLUSION
    assert any("side" in finding.place for finding in found.findings)


def _without_parts(document: Document) -> None:
    del document["results"][0]["parts"]


def _with_no_part(document: Document) -> None:
    document["results"][0]["parts"] = []


def _without_the_last_part(document: Document) -> None:
    document["results"][0]["parts"].pop()


def _backwards(document: Document) -> None:
    document["results"][0]["parts"].reverse()


def _with_another_that_has_no_parts(document: Document) -> None:
    document["results"].insert(0, {**document["results"][0], "parts": []})


PARTS = [_without_parts, _with_no_part, _without_the_last_part, _backwards, _with_another_that_has_no_parts]


@pytest.mark.parametrize("change", PARTS)
def test_a_proved_result_of_a_surface_that_lacks_parts_is_malformed(surface: Document, change: Any) -> None:
    assert len(surface["results"][0]["parts"]) > 1
    found = checked(forged(surface, change))
    assert (found.level, found.findings[0].place) == (Level.NONE, "results[0].parts")


def test_results_in_another_order_than_along_the_curve_are_found(curve: Document) -> None:
    found = checked(forged(curve, lambda d: d["results"].reverse()))
    assert found.level is Level.FORM
    assert found.findings[0].place.startswith("results[0]")


def test_a_result_of_a_curve_has_nothing_of_one_of_a_surface(curve: Document, surface: Document) -> None:
    reason = {"condition": "stability", "message": "it was not tried", "remedy": ""}
    parts, stability = surface["results"][0]["parts"], {"reason": reason}
    for document, key, value in ((curve, "parts", parts), (curve, "parts", []), (surface, "stability", stability)):
        found = checked(forged(document, lambda d, key=key, value=value: d["results"][0].update({key: value})))
        assert (found.level, found.findings[0].place) == (Level.NONE, f"results[0].{key}")


def test_a_claim_of_an_unknown_kind_is_refused_with_the_kinds_that_are_known(point: Certificate) -> None:
    for kind in ("kindless", ["orbit"]):
        with pytest.raises(InputError, match=r"statement\.candidate\.kind: .*\"touch_and_go\""):
            Certificate.from_json(
                forged(point.to_json(), lambda d, kind=kind: d["statement"]["candidate"].update(kind=kind))
            )


# Systems that are not known here


def renamed(document: Document, change: Callable[[Document], Any] = lambda document: None) -> Document:
    """The same by another version, with the system under a name that nobody knows."""

    def rename(entry: Document) -> None:
        for claim in (entry["statement"].get("candidate"), entry["statement"].get("level_form"),
                      entry["statement"].get("atlas")):  # fmt: skip
            if claim is not None:
                claim["system"] = "somebody-elses"
        change(entry)

    return forged_elsewhere(document, rename)


@pytest.mark.parametrize("name", ["fs3", "em1"])
def test_a_system_that_is_not_known_is_checked_by_the_program_of_the_file(name: str) -> None:
    certificate = certify(known(name), Limits(max_precision=256))
    assert ("level_form" in certificate.statement) == (name == "em1")
    found = recheck(Certificate.from_json(renamed(certificate.to_json())), True)
    assert (found.findings, found.obstacle, found.level) == ((), "", Level.INTEGRATION)
    assert "not known here" in found.notes[0]


def test_a_field_of_an_unknown_system_that_gives_no_such_orbit_is_found_by_integrating(point: Certificate) -> None:
    def turn(entry: Document) -> None:
        entry["statement"]["vector_field"] = entry["statement"]["vector_field"].replace("v9 = v7 - v8", "v9 = v8 - v7")

    document = renamed(point.to_json(), turn)
    assert document["statement"]["vector_field"] != point.statement["vector_field"]
    entry = Certificate.from_json(document)
    assert recheck(entry).stands
    assert recheck(entry, True).level is Level.CONCLUSION


def test_a_curve_of_an_unknown_system_is_checked_too() -> None:
    atlas, results = of_parabola()
    document = renamed(atlas_certificate(atlas, results))
    asked: list[Any] = []

    def prover(argument: Any, report: Any) -> Any:
        asked.append(argument)
        return honest(results)(argument, report)

    found = checked(document, prover)
    assert (found.findings, found.level) == ((), Level.INTEGRATION)
    assert asked[0]["stated"]["statement"]["vector_field"] == document["statement"]["vector_field"]


def test_bifurcations_of_an_unknown_system_are_looked_for_on_its_curve(point: Certificate) -> None:
    atlas, results = of_parabola()
    unknown = atlas_of(renamed(atlas_certificate(atlas, results)))
    near = Certificate.from_json(renamed(fabricated(point, ("2", "4e-2"), "near").to_json()))
    document = atlas_certificate(unknown, results, [near])
    assert document["conclusion"]["bifurcations"][0]["on_curve"]
    assert checked(document).stands
    assert checked(document, honest(results)).level is Level.CONCLUSION


def test_a_statement_without_its_names_is_malformed(point: Certificate) -> None:
    with pytest.raises(InputError, match="names"):
        Certificate.from_json(forged(point.to_json(), lambda d: d["statement"].pop("names")))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "return v0",
        "v0 = x\nreturn v1",
        "v0 = x\nv1 = v0 ** (__import__('os'))\nreturn v1",
        "v0 = x\nv1 = v0.real\nreturn v1",
        "v0 = x\nv1 = v1 + v0\nreturn v1",
        "v0 = x\nv2 = v0 + v0\nreturn v2",
        "v0 = x\nv1 = v0 + v0\nv2 = y\nreturn v1",
        "v0 = x\nv1 = 1/0\nreturn v1",
        "v0 = x\nv1 = 2/4\nreturn v1",
        "v0 = x\nv1 = v0 + v0\nv2 = v0 + v0\nreturn v2",
        "v0 = x\nreturn v0\n",
        "v0 = x\nv1 = v0 ** (1.5)\nreturn v1",
    ],
)
def test_a_text_that_is_no_program_is_refused(text: str) -> None:
    with pytest.raises(ValueError):
        program_from_text(text)


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS.keys())
def test_a_program_is_read_as_it_was_written(system: Any) -> None:
    assert program_from_text(system.program.text()) == system.program


# Every field of every format


Survey = dict[tuple[str, str], set[str]]


def survey(document: Document, check: Callable[[Document], Recheck], each: int) -> Survey:
    """For each field and way of changing what found it: "form", "conclusion", "integration", or "nothing".

    Where only words are changed, "words": the certificate stands, and is told in other words.

    At most `each` places of a field are tried.
    """
    found: Survey = {}
    tried: Counter[tuple[str, str]] = Counter()
    for change in changes(document):
        key = (change.field, change.how)
        tried[key] += 1
        if tried[key] > each:
            continue
        try:
            result = check(forged(document, change.apply))
        except InputError:
            finder = "form"
        else:
            # What was passed is one less than what found it.
            finder = "nothing" if result.stands else Level(result.level + 1).name.lower()
            finder = "words" if result.stands and result.rendered is not None else finder
        found.setdefault(key, set()).add(finder)
    return found


def by(finder: str, found: Survey) -> set[tuple[str, str]]:
    """The changes that were found by this level, or by nothing."""
    return {key for key, finders in found.items() if finder in finders}


def says_how_it_was_made(field: str) -> bool:
    """Settings, times and versions: they are part of no claim."""
    return field.startswith(("software.", "computation.", "results.*.computation."))


IS_WEAKER = ("deviation.*", "slope_deviation.*", ".rad")
"""Bounds that are larger are true as well, and what is concluded from them is derived from them."""


@pytest.fixture
def checked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """One check of each certificate that an atlas rests on, and one integration to the other point of its orbit."""
    checks: dict[tuple[str, bool], Recheck] = {}
    points: dict[str, Any] = {}
    enclose = curve_conclusion.partner

    def recheck_once(entry: Certificate, integrate: bool = False, given: Given | None = None) -> Recheck:
        if given is not None:
            return recheck(entry, integrate, given=given)
        key = json.dumps(entry.to_json(), sort_keys=True), integrate
        if key not in checks:
            checks[key] = recheck(entry, integrate)
        return checks[key]

    def enclose_once(system: ReversibleSystem, parameters: Any, point: Any, crossings: int) -> Any:
        what = system.program.text(), system.reversing_symmetry, system.section, system.fixed_level
        exact = {name: ball_to_json(ball) for name, ball in point.items()}
        key = repr((what, parameters, exact, crossings))
        if key not in points:
            points[key] = enclose(system, parameters, point, crossings)
        return points[key]

    monkeypatch.setattr(forgeries, "recheck", recheck_once)
    monkeypatch.setattr(curve_conclusion, "partner", enclose_once)


@pytest.mark.usefixtures("checked_once")
@pytest.mark.parametrize("each", [1, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["curve", "family", "surface"])
def test_every_changed_field_of_an_atlas_is_found_but_for_names(
    kind: str, each: int, request: pytest.FixtureRequest
) -> None:
    document = request.getfixturevalue(kind)
    found = survey(document, lambda changed: with_honest_prover(changed, document), each)
    missed = {
        (field, how)
        for field, how in by("nothing", found)
        if not says_how_it_was_made(field) and not (how == "larger" and field.endswith(IS_WEAKER))
    }
    assert missed == {("statement.atlas.title", "other words")}
    assert by("integration", found)
    assert ("statement.theorem", "other words") in by("conclusion", found)
    assert ("conclusion.hypotheses.*.name", "other words") in by("form", found)
