"""Forgeries of what a certificate is made of: whose functions, whose checks, how narrow, of what types."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from support import atlas_work, stability_cases
from support.chain_cases import symmetric_arc
from support.claims import known
from support.conclusions import conclude
from support.forgeries import Document, atlas_certificate, checked, forged, honest
from support.stored import value_of, values
from test_forged_certificates import fabricated, of_parabola

import orbitproof.verify.certificate.rechecking as rechecking
from orbitproof import verify
from orbitproof.figures.report import check_files, report_of
from orbitproof.shared import define_system, format_exact, parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import InputError, candidate_from_json
from orbitproof.shared.formats.documents import validator
from orbitproof.shared.systems import ID, IDENTIFIER, LINE, PIECE, SYSTEM, TITLE, describe
from orbitproof.verify.branches import Means, ProvedBefore, conclusion_of, make_atlas_certificate
from orbitproof.verify.branches.curve_conclusion import told
from orbitproof.verify.certificate import (
    UNCHECKED_REASON,
    Certificate,
    Given,
    Level,
    Limits,
    certify,
    differences,
    digest,
    recheck,
    write_certificate,
    write_certificates,
)
from orbitproof.verify.certificate.tables import ball_to_text
from orbitproof.verify.evidence import STOPS, ball_to_json, bounds
from orbitproof.verify.run.branch_command import main
from orbitproof.verify.run.branch_tasks import task_again

# Functions of s belong to the interval on which they were found


@pytest.mark.parametrize("ends", [["-0x7p-3", "0x1"], ["-0x1", "0x7p-3"]])
def test_functions_that_were_moved_to_another_interval_are_found_by_integrating(ends: list[str]) -> None:
    """They are written in a variable that runs over their interval: a proof on more than the stored one is another."""
    atlas, true = stability_cases.atlas(), stability_cases.results()

    def whole(argument: Mapping[str, Any], report: Any) -> Document:
        return next(result for result in true if result["piece"] == argument["piece"]["id"])

    moved = copy.deepcopy(true)
    moved[1]["interval"] = ends
    document = make_atlas_certificate(atlas, values(moved), stability_cases.listed(moved))
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
    results = [atlas_work.proving({**asked, "piece": to_json(piece)}, lambda *_: None) for piece in atlas.pieces]
    assert checked(atlas_certificate(atlas, results)).stands
    results[0]["interval"] = ends
    found = checked(atlas_certificate(atlas, results))
    assert found.level is Level.NONE
    assert [entry.place for entry in found.findings] == ["results[0].interval"]


# A number that is a thousand times too narrow is not confirmed


def narrowed(ball: str) -> str:
    """A ball of a table with the same middle, a thousandth as wide, and off by half of what it was."""
    middle, radius = (parse_exact(part) for part in ball.split(" +- "))
    off = format_exact(middle + radius / 2)
    return f"{off} +- {ball_to_text(arb(0, float(radius / 1000))).split(' +- ')[1] if radius else '0x0'}"


@pytest.mark.parametrize("part", ["box", "centre"])
def test_tables_a_thousand_times_too_narrow_do_not_stand(point: Certificate, part: str) -> None:
    """All that follows from them is derived again, and overlaps what another integration gives."""
    entry = point.to_json()
    for components in entry["enclosures"]["iterates"]:
        for table in components:
            table[part] = [narrowed(ball) for ball in table[part]]
    assert recheck(point, True).stands
    again = Certificate.from_json(rechecking.derived(entry))
    if again.proved:
        assert recheck(again).stands
    found = recheck(again, True)
    assert not found.stands
    assert found.findings


@pytest.mark.parametrize("name", ["em1", "fs5"])
def test_honest_tables_are_confirmed_by_one_integration_or_another(name: str) -> None:
    """Of the first some entries are zero by symmetry; of the second those of a higher order are a little wider."""
    found = recheck(certify(known(name), Limits(max_precision=256)), True)
    assert (found.findings, found.level) == ((), Level.INTEGRATION)


BESIDE = {
    "name": "beside", "state": "x w y v", "R": {"w": -1, "v": -1}, "section": "w",
    "field": {"x": "w", "w": "-x", "y": "v", "v": "2/3 - 2*y"}, "first_integral": "x**2 + w**2 + v**2 + 2*y**2 - 4*y/3",
}  # fmt: skip
"""x'' = -x beside an oscillator about y = 1/3: half a period takes pi."""
AROUND = {
    "name": "around", "state": "x w y v", "R": {"w": -1, "v": -1}, "section": "w",
    "field": {"x": "w", "w": "-x", "y": "-(3/10 + y**2 + v**2)*v", "v": "(3/10 + y**2 + v**2)*y"},
    "first_integral": "x**2 + w**2 + y**2 + v**2",
}  # fmt: skip
"""x'' = -x beside z' = i (3/10 + |z|^2) z, z = y + i v; the plane z = 0 is invariant."""


def orbit_of(system: Mapping[str, Any], y: str, kind: str = "orbit") -> Any:
    """The orbit through x = 1 and this y, which is at rest."""
    return candidate_from_json(
        {
            "id": "orbit", "system": describe(define_system(system)), "parameters": {}, "kind": kind, "k": 1,
            "centre": ["1", y], "frame": [["1", "0"], ["0", "1"]], "kernel_frame": [["1"]], "radii": ["1e-15", "1e-15"],
            "equation": {"quantity": "coordinate", "coordinate": "x", "value": "1"},
        },
        "claim",
    )  # fmt: skip


def test_a_ball_that_leaves_the_true_value_out_by_a_small_part_of_its_width_does_not_stand() -> None:
    """A wide one, beside the number by less than the first integration sees, and all that follows from it."""
    entry = certify(orbit_of(BESIDE, "0." + "3" * 30), Limits(digits=12)).to_json()
    assert recheck(Certificate.from_json(entry), True).level is Level.INTEGRATION
    stated = rechecking._read(entry)
    assert stated.enclosures is not None
    seen = rechecking.enclose(stated.claim, next(rechecking._settings(stated.enclosures)))
    with ctx.workprec(600):
        below, above = bounds(arb.pi())
        _, end = bounds(seen.half_period.box[0, 0])  # type: ignore[union-attr]
        start, width = (above + end) / 2, Fraction(1, 8)
        assert below < above < start < end
        false = f"{format_exact(start + width)} +- {format_exact(width)}"
        for part in ("box", "centre"):
            entry["enclosures"]["half_period"][part][0] = false
        consistent = Certificate.from_json(rechecking.derived(entry))
    assert consistent.proved
    assert recheck(consistent).stands
    found = recheck(consistent, True)
    assert found.level is Level.CONCLUSION
    assert "half_period" in found.why


@pytest.mark.parametrize("kind", ["orbit", "stable_orbit"])
def test_an_orbit_whose_centre_is_exact_stands_with_another_integration(kind: str) -> None:
    """What is 0 there is known up to the underflow of bounds, which more bits do not make smaller."""
    certificate = certify(orbit_of(AROUND, "0", kind), Limits(digits=8))
    assert certificate.proved
    assert certificate.point["y"].contains(0)
    assert certificate.point["y"].rad() < 1e-200
    found = recheck(certificate, True)
    assert (found.findings, found.level) == ((), Level.INTEGRATION)


# What claims nothing says nothing


SENTENCE = "SHOWN TO BE FALSE. There is no such orbit, and period 17-tupling happens at beta = 500"


@pytest.fixture(scope="module")
def refused() -> Certificate:
    """A certificate that proves nothing, with tables."""
    return certify(replace(known("fs3"), centre=(Fraction(450), Fraction("0.93"))), Limits(max_precision=256))


@pytest.mark.parametrize("kind", ["condition", "theorem", "in_full", "control", "hypothesis"])
def test_what_is_not_proved_has_no_theorem_and_a_reason_that_a_run_gives(refused: Certificate, kind: str) -> None:
    assert recheck(refused).stands
    assert UNCHECKED_REASON in recheck(refused).notes

    def change(entry: Document) -> None:
        if kind == "condition":
            entry["reason"]["condition"] = "there is no such orbit"
        elif kind == "control":
            entry["reason"]["message"] = "first line\n  falkner-skan  proved  stands"
        elif kind == "hypothesis":
            entry["hypotheses"].append({**entry["hypotheses"][-1], "name": "C17", "statement": SENTENCE})
        else:
            entry["statement"][kind] = SENTENCE

    try:
        found = recheck(Certificate.from_json(forged(refused.to_json(), change)))
    except InputError:
        assert kind in ("theorem", "in_full", "control")
    else:
        assert not found.stands


def test_the_reasons_of_a_run_are_quoted_in_a_report(refused: Certificate, tmp_path: Path) -> None:
    text = forged(refused.to_json(), lambda entry: entry["reason"].update(message=SENTENCE))
    write_certificates(tmp_path / "forged.json", [Certificate.from_json(text)])
    report = str(report_of(check_files([tmp_path / "forged.json"])))
    assert f"the run said: '{SENTENCE}'" in report
    assert "claim nothing" in report


def test_a_reason_does_not_end_its_quotation(refused: Certificate, tmp_path: Path) -> None:
    text = forged(refused.to_json(), lambda entry: entry["reason"].update(message=f"over'. {SENTENCE}"))
    write_certificates(tmp_path / "forged.json", [Certificate.from_json(text)])
    assert "said: 'over'." not in str(report_of(check_files([tmp_path / "forged.json"])))


def test_every_condition_that_the_verifier_gives_is_a_hypothesis_or_a_stop() -> None:
    """What a certificate may give as a reason is a closed set; nothing that a run says is outside of it."""
    names = set()
    for path in Path(verify.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
                called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                if called in ("Reason", "IntegrationFailure", "broken_off"):
                    names.add(node.args[0].value)
    assert {"time", "process", "memory"} <= STOPS
    assert len(names) > 20
    assert names <= STOPS


# Names are names, and types are types


BAD_NAMES = (
    "", " ", "a\nb", "b\n", "a\u202eb", "a\x1b[31m", "it is proved that there are infinitely many of them",
    "weather. It is proved", "x" * 101,
)  # fmt: skip


@pytest.mark.parametrize("text", BAD_NAMES)
def test_an_id_is_no_sentence(point: Certificate, text: str) -> None:
    with pytest.raises(InputError):
        Certificate.from_json(forged(point.to_json(), lambda entry: entry.update(id=text)))
    with pytest.raises(InputError):
        replace(known("fs3"), id=text)


@pytest.mark.parametrize("text", ["weather. It is proved", "a\nb", "b\n", "a\u2028b", "x" * 201, ""])
@pytest.mark.parametrize("key", ["system", "first_integral", "distance_from"])
def test_a_title_in_a_statement_is_no_sentence(point: Certificate, key: str, text: str) -> None:
    with pytest.raises(InputError):
        Certificate.from_json(forged(point.to_json(), lambda entry: entry["statement"]["names"].update({key: text})))


def test_the_title_of_a_system_that_is_not_known_here_is_short(point: Certificate) -> None:
    def rename(entry: Document) -> None:
        entry["statement"]["candidate"]["system"] = "somebody-elses"
        entry["statement"]["names"]["system"] = "x" * 121

    found = recheck(Certificate.from_json(forged(point.to_json(), rename)))
    assert "is no title" in found.findings[0].message


@pytest.mark.parametrize("name", ["S is proved to break", "S\n", "", "1S"])
def test_a_symmetry_has_a_name(point: Certificate, name: str) -> None:
    entry = forged(point.to_json(), lambda entry: entry["statement"]["candidate"].update(symmetry=name))
    assert not recheck(Certificate.from_json(entry)).stands


def test_the_schemas_have_the_patterns_of_names() -> None:
    patterns = {"id": ID, "identifier": IDENTIFIER, "line": LINE, "piece_id": PIECE, "system": SYSTEM, "title": TITLE}
    seen = set()
    for name in ("candidates", "atlas", "system", "certificates", "atlas-certificate"):
        for key, entry in validator(name).schema["$defs"].items():
            if key in patterns:
                assert entry["pattern"] == patterns[key]
                seen.add(key)
    assert seen == set(patterns)


TYPES: dict[str, Any] = {
    "order": lambda entry: entry["computation"].update(order=65536),
    "holds": lambda entry: entry["hypotheses"][0].update(holds=1),
    "key of the results": lambda entry: entry["results"].update(more="SHOWN"),
    "key of a hypothesis": lambda entry: entry["hypotheses"][0].update(more="SHOWN"),
    "k": lambda entry: entry["statement"]["candidate"].update(k=True),
    "precision": lambda entry: entry["computation"].update(precision=10**7),
}


@pytest.mark.parametrize("change", TYPES.values(), ids=TYPES.keys())
def test_values_of_other_types_and_keys_that_nobody_knows_are_malformed(point: Certificate, change: Any) -> None:
    try:
        entry = Certificate.from_json(forged(point.to_json(), change))
    except InputError:
        return
    assert recheck(entry).level is Level.NONE


ATLAS_TYPES: dict[str, Any] = {
    "order": lambda entry: entry["results"][0]["computation"].update(order=65536),
    "key of the computation": lambda entry: entry["results"][0]["computation"].update(more="SHOWN"),
    "key of a result": lambda entry: entry["results"][0].update(more="SHOWN"),
    "key of the conclusion": lambda entry: entry["conclusion"].update(more="SHOWN"),
    "holds": lambda entry: entry["conclusion"]["hypotheses"][0].update(holds=1),
    "key of a hypothesis": lambda entry: entry["conclusion"]["hypotheses"][0].update(more="SHOWN"),
}


@pytest.mark.parametrize("change", ATLAS_TYPES.values(), ids=ATLAS_TYPES.keys())
def test_the_same_of_an_atlas(change: Any) -> None:
    document = atlas_certificate(*of_parabola())
    assert checked(forged(document, lambda entry: None)).stands
    assert checked(forged(document, change)).level is Level.NONE


def test_types_are_compared_inside_of_what_is_equal_otherwise() -> None:
    assert [entry.place for entry in differences({"a": [1, {"b": True}]}, {"a": [1, {"b": 1}]}, "")] == ["a[1], b"]
    assert not list(differences({"a": [1, True]}, {"a": [1, True]}, ""))


# A place on a curve is checked with the curve, or not at all


PLACE = {
    "rests_on": {"id": "curve", "digest": "sha256:" + 64 * "0"},
    "piece": "p001",
    "s": ball_to_json(arb(0, 0.5)),
    "mirrored": False,
    "other_point": False,
    "statement": "The point x lies on every curve.",
}


def test_a_place_is_open_without_its_curve(point: Certificate) -> None:
    placed = point.with_place(PLACE)
    found = recheck(placed)
    assert (found.stands, found.stands_without_place, found.word) == (False, True, "cannot be checked here")
    assert found.passed is Level.FORM
    assert "`curve`" in found.open_place
    (from_python,) = verify.recheck(placed, quiet=True)
    assert not from_python.stands
    assert recheck(placed.with_place(None)).stands


def test_a_curve_carries_certificates_without_their_places(point: Certificate) -> None:
    """It says itself where they lie, and checks no other curve."""
    near = fabricated(point, ("2", "4e-2"), "near")
    placed = near.with_place(PLACE)
    document = atlas_certificate(*of_parabola(), [placed])
    assert document == atlas_certificate(*of_parabola(), [near])
    assert checked(document, given=[placed]).stands
    forgery = forged(document, lambda entry: entry.update(rests_on=[placed.to_json()]))
    found = {finding.place: finding.message for finding in checked(forgery).findings}
    assert found["rests_on[0], place"] == "does not belong here"


def test_a_changed_certificate_with_a_place_gets_no_digest_that_fits(point: Certificate) -> None:
    placed = fabricated(point, ("2", "4e-2"), "near").with_place(PLACE).to_json()
    placed["results"]["side"] = "above"
    document = atlas_certificate(*of_parabola(), [Certificate.from_json(placed)])
    (entry,) = document["conclusion"]["bifurcations"]
    assert not entry["on_curve"]
    assert "digest" in entry["reason"]
    assert checked(document).stands


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

    both = told(conclude(atlas, results, [lie, point], lambda entry: recheck(point)))
    assert [entry["on_curve"] for entry in both["bifurcations"]] == [True, False]
    document = make_atlas_certificate(atlas, values(results), both, [lie, point])
    write_certificate(tmp_path / "forged.json", document)
    assert main(["--recheck", str(tmp_path / "forged.json"), "--quiet"]) == 1
    assert "appears twice" in capsys.readouterr().err
    assert checked(document).level is Level.NONE
    with pytest.raises(ValueError, match="appears twice"):
        conclusion_of(atlas, values(results), [lie, point], lambda entries: [recheck(point) for _ in entries], None)


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


def test_an_interval_that_no_answer_comes_back_of_is_not_confirmed() -> None:
    # The theorem follows without the first of them.
    atlas, results = of_parabola()
    results.insert(0, {**results[0], "interval": ["-0x1", "0x1p-1"]})
    document = atlas_certificate(atlas, results)
    for first in (0, 1):

        def prove(
            atlas: Atlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Any], str], first: int = first
        ) -> None:
            for each in intervals[first:]:
                argument = task_again(atlas, each, None).argument
                finished(each.name, value_of(honest(document["results"])(argument, lambda fraction, label: None)))

        check = recheck(Certificate(document), True, given=Given((), means=Means(lambda entries, integrate: [], prove)))
        assert check.stands == (first == 0), check.why
