"""Checking certificates again: what is untouched stands, what was changed is named."""

from __future__ import annotations

import importlib
import json
import multiprocessing
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st
from support.claims import TOUCH_AND_GO, to_the_end
from support.refusals import refused
from support.wide_checks import TWIST

from orbitproof import verify
from orbitproof.shared import parse_exact
from orbitproof.shared.formats import InputError, candidate_from_json, read_candidates
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.numbers import format_dyadic
from orbitproof.shared.systems import ParameterRange, shown
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import (
    Certificate,
    Computation,
    Level,
    Recheck,
    certify,
    digest,
    make_certificate,
    read_certificates,
    recheck,
    rechecking,
    tables_to_json,
    write_certificates,
)
from orbitproof.verify.certificate.earlier import taken_names
from orbitproof.verify.certificate.tables import ball_from_text, ball_to_text
from orbitproof.verify.evidence import exact_value, spared
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import Enclosures, enclose_iterates
from orbitproof.verify.run import Display, checking_again
from orbitproof.verify.run.row_tables import recheck_table

MODULE = importlib.import_module("orbitproof.verify.certificate.rechecking")

TRUE = {**TOUCH_AND_GO, "id": "k=3"}
FALSE = {**TRUE, "id": "shifted", "centre": ["453.4425869", TRUE["centre"][1]]}
HOPELESS = {**TRUE, "id": "singular frame", "kernel_frame": [["0"]]}
EARLY = {**TRUE, "id": "too few bits"}
EXCLUDED = {**TRUE, "id": "k=4", "k": 4, "kind": "period_tupling"}


def certified(entry: dict[str, Any], **limits: Any) -> Certificate:
    return certify(candidate_from_json(entry, "test"), Limits(**limits))


@pytest.fixture(scope="module")
def proved() -> Certificate:
    return certified(TRUE)


@pytest.fixture(scope="module")
def refuted() -> Certificate:
    """With tables: the orbits are followed to the end."""
    return certify(candidate_from_json(FALSE, "test"), Limits(max_precision=256), integrate=to_the_end)


CertificateJson = dict[str, Any]


def forged(certificate: Certificate, change: Callable[[CertificateJson], Any]) -> Certificate:
    """A changed copy with a digest that fits."""
    entry = certificate.to_json()
    change(entry)
    entry["digest"] = digest(entry)
    return Certificate.from_json(entry)


def hypothesis(entry: CertificateJson, name: str) -> dict[str, Any]:
    return next(item for item in entry["hypotheses"] if item["name"] == name)


def shift(entry: dict[str, str], key: str, bits: int) -> None:
    """Change a number by one unit, `bits` bits below one."""
    entry[key] = format_dyadic(parse_exact(entry[key]) + Fraction(1, 2**bits))


def places(result: Recheck) -> str:
    return "; ".join(finding.place for finding in result.findings)


@given(st.integers(-(2**300), 2**300), st.integers(-2000, 200), st.integers(0, 2**30 - 1), st.sampled_from([53, 900]))
def test_a_ball_of_a_table_reads_back_to_the_same_ball(mantissa: int, exponent: int, radius: int, bits: int) -> None:
    ball = arb((mantissa, exponent), arb((radius, exponent)) if radius else 0)
    with ctx.workprec(bits):
        again = ball_from_text(ball_to_text(ball))
    assert (exact_value(again.mid()), exact_value(again.rad())) == (exact_value(ball.mid()), exact_value(ball.rad()))


@pytest.mark.parametrize(
    "text", ["", "0x1", "0x1 +- -0x1", "0x1 +- nan", "0.5 +- 0x1", "0x01 +- 0x0", "0x1 +- 0x1 +- 0x1"]
)
def test_text_that_is_no_ball_of_a_table_is_refused(text: str) -> None:
    with pytest.raises(ValueError):
        ball_from_text(text)


@pytest.fixture
def no_integration(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> Enclosures:
        raise AssertionError("an integration was started")

    monkeypatch.setattr(MODULE, "enclose", refuse)


@pytest.mark.usefixtures("no_integration")
def test_untouched_certificates_stand_without_integrating(proved: Certificate, refuted: Certificate) -> None:
    for entry in (proved, refuted, certified(HOPELESS), certified(EARLY, max_precision=64), certified(EXCLUDED)):
        result = recheck(entry)
        assert result.findings == ()
        assert result.stands
        assert result.hypotheses > 0
        assert result.verdict == entry.verdict
    assert recheck(proved).hypotheses == len(proved.hypotheses)


@pytest.mark.usefixtures("no_integration")
def test_no_hypothesis_holds_for_which_nothing_is_stored() -> None:
    stored = certified(EXCLUDED)
    shown = {"name": "poincare-map", "statement": "P exists", "section": "6", "enclosures": {}}

    def check(holds: bool) -> Recheck:
        return recheck(forged(stored, lambda entry: entry["hypotheses"].append({**shown, "holds": holds})))

    assert check(False).stands
    assert places(check(True)) == "hypothesis poincare-map"


def test_another_integration_overlaps_and_proves_again(proved: Certificate, refuted: Certificate) -> None:
    result = recheck(proved, integrate=True)
    assert result.findings == ()
    assert result.precision > proved.computation.precision
    assert recheck(refuted, integrate=True).stands


def test_what_stores_nothing_to_integrate_does_not_pass_the_last_level(refuted: Certificate) -> None:
    hopeless = certified(HOPELESS)
    found = {entry.id: recheck(entry, integrate=True) for entry in (hopeless, refuted)}
    assert [found[name].level for name in found] == [Level.CONCLUSION, Level.INTEGRATION]
    assert all(check.stands for check in found.values())
    lines = recheck_table(list(found), found).splitlines()
    assert any("2 conclusion" in line and line.endswith("no") for line in lines)
    assert [line for line in lines if "nothing was integrated again" in line] == [
        f"{shown(hopeless.id)}: nothing was integrated again: it stores no enclosures"
    ]


def _leaves(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    if isinstance(value, dict):
        return [leaf for key in value for leaf in _leaves(value[key], (*path, key))]
    if isinstance(value, list):
        return [leaf for index in range(len(value)) for leaf in _leaves(value[index], (*path, index))]
    return [path]


def test_any_changed_value_is_noticed_by_the_digest(proved: Certificate) -> None:
    for path in _leaves(proved.to_json()):
        entry = proved.to_json()
        target: Any = entry
        for key in path[:-1]:
            target = target[key]
        value = target[path[-1]]
        target[path[-1]] = value + "0" if isinstance(value, str) else 7 if value != 7 else 8
        if path == ("digest",):
            assert entry["digest"] != digest(entry)
        else:
            assert entry["digest"] != digest(entry), path


def _table(entry: CertificateJson, i: int, part: str, index: int, change: Callable[[Fraction, Fraction], Any]) -> None:
    """Change one ball of a table of P^i; the order of the derivatives in two variables is lexicographic."""
    texts = entry["enclosures"]["iterates"][i - 1][0][part]
    middle, radius = (parse_exact(number) for number in texts[index].split(" +- "))
    texts[index] = " +- ".join(format_dyadic(value) for value in change(middle, radius))


def _other_results(entry: CertificateJson) -> None:
    shift(entry["results"]["parameter"], "mid", 400)


FORGERIES: dict[str, tuple[Callable[[CertificateJson], Any], str]] = {
    "derivative of P^3 at the centre": (lambda e: _table(e, 3, "centre", 1, lambda m, r: (m + r, r)), "C3"),
    "derivative of P over the box": (lambda e: _table(e, 1, "box", 1, lambda m, r: (-m, r)), "poincare-map"),
    "radius of a derivative of P^3": (lambda e: _table(e, 3, "centre", 2, lambda m, r: (m, r * 2)), "G_11"),
    "derivative of P^2 over the box": (lambda e: _table(e, 2, "box", 1, lambda m, r: (m + r, r)), "regular-2"),
    "time of a crossing": (lambda e: e["enclosures"]["return_times"].reverse(), "time of crossing 1"),
    "a crossing left out": (lambda e: e["enclosures"]["return_times"].pop(), "time of crossing 3"),
    "an iterate left out": (lambda e: e["enclosures"]["iterates"].pop(), "verdict"),
    "all tables left out": (lambda e: e.update(enclosures=None), "enclosures"),
    "a derivative left out": (lambda e: e["enclosures"]["iterates"][0][0]["box"].pop(), "certificate"),
    "no ball in a table": (lambda e: e["enclosures"]["iterates"][0][0]["box"].__setitem__(0, "nan"), "certificate"),
    "middle of an enclosure": (lambda e: shift(hypothesis(e, "C3")["enclosures"]["g_0"], "mid", 600), "C3"),
    "radius of an enclosure": (lambda e: hypothesis(e, "C3")["enclosures"]["g_0"].update(rad="0x1p-600"), "C3"),
    "decimal of an enclosure": (lambda e: hypothesis(e, "G_11")["enclosures"]["G_11"].update(decimal="[1, 2]"), "G_11"),
    "an enclosure left out": (lambda e: hypothesis(e, "C3")["enclosures"].pop("g_0"), "g_0"),
    "an enclosure added": (lambda e: hypothesis(e, "C3")["enclosures"].update(more=e["results"]["parameter"]), "more"),
    "name of a hypothesis": (lambda e: hypothesis(e, "C3").update(name="C5"), "hypotheses"),
    "a hypothesis left out": (lambda e: e["hypotheses"].remove(hypothesis(e, "regular-2")), "hypotheses"),
    "a hypothesis added": (lambda e: e["hypotheses"].append(hypothesis(e, "C3")), "hypotheses"),
    "k": (lambda e: e["statement"]["candidate"].update(k=4, kind="period_tupling"), "hypotheses"),
    "kind": (lambda e: e["statement"]["candidate"].update(kind="period_tupling"), "hypotheses"),
    "radii that are too small": (lambda e: e["statement"]["candidate"].update(radii=["0x1p-80", "0x1p-90"]), "verdict"),
    "radii that are a little smaller": (
        lambda e: e["statement"]["candidate"].update(radii=["9.9e-12", "1e-15"]), "hypothesis",
    ),
    "centre": (lambda e: e["statement"]["candidate"]["centre"].__setitem__(0, "453.4425868"), "results"),
    "frame": (lambda e: e["statement"]["candidate"]["frame"][1].__setitem__(0, "3.7e-7"), "results"),
    "system": (lambda e: e["statement"]["candidate"].update(system="cr3bp"), "certificate"),
    "vector field": (lambda e: e["statement"].update(vector_field="v0 = x"), "vector_field"),
    "R": (lambda e: e["statement"].update(reversing_symmetry=[1, 1, -1]), "reversing_symmetry"),
    "section": (lambda e: e["statement"].update(section="x"), "section"),
    "id": (lambda e: e.update(id="another"), "id"),
    "parameter": (_other_results, "results, parameter"),
    "point": (lambda e: shift(e["results"]["point"]["y"], "mid", 500), "results, point"),
    "side": (lambda e: e["results"].update(side="above"), "results, side"),
    "normal form": (lambda e: e["results"]["normal_form"].pop("beta"), "normal_form"),
    "precision": (lambda e: e["computation"].update(precision=70), "hypothesis"),
    "an impossible precision": (lambda e: e["computation"].update(precision=1), "certificate"),
    "verdict": (
        lambda e: (
            (e["statement"].pop("theorem"), e["statement"].pop("in_full")),
            e.update(verdict="not proved", results=None, reason={"condition": "C3", "message": "m", "remedy": "r"}),
        ),
        "verdict",
    ),
}  # fmt: skip


@pytest.mark.usefixtures("no_integration")
@pytest.mark.parametrize(("change", "where"), FORGERIES.values(), ids=FORGERIES.keys())
def test_a_forgery_with_a_new_digest_is_named(proved: Certificate, change: Any, where: str) -> None:
    result = recheck(forged(proved, change))
    assert not result.stands
    assert where in places(result), result.findings
    assert "digest" not in places(result)


REWORDED: dict[str, Callable[[CertificateJson], Any]] = {
    "theorem": lambda e: e["statement"].update(theorem="There is life on Mars."),
    "theorem in full": lambda e: e["statement"].update(in_full=e["statement"]["in_full"] + "\nAnd on Venus."),
    "words of a hypothesis": lambda e: hypothesis(e, "C3").update(statement="anything"),
    "section of a hypothesis": lambda e: hypothesis(e, "C3").update(section="99.9"),
}


@pytest.mark.usefixtures("no_integration")
@pytest.mark.parametrize("change", REWORDED.values(), ids=REWORDED.keys())
def test_a_true_certificate_in_other_words_stands_and_is_told_in_those_of_this_version(
    proved: Certificate, change: Any
) -> None:
    def elsewhere(entry: CertificateJson) -> None:
        entry["software"]["orbitproof"] = "0.0.1"

    other = forged(proved, lambda entry: (change(entry), elsewhere(entry)))
    result = recheck(other)
    assert (result.stands, result.word) == (True, "stands, worded otherwise")
    assert "worded otherwise" in result.notes[-1]
    assert result.rendered is not None
    told, honest = dict(result.rendered), proved.to_json()
    assert told.pop("digest") == other.to_json()["digest"]
    elsewhere(honest)
    assert told == {key: value for key, value in honest.items() if key != "digest"}
    assert recheck(proved).rendered is None
    for also in (elsewhere, lambda entry: entry["software"].update(program="sha256:" + "0" * 64)):
        assert recheck(forged(proved, lambda entry, also=also: also(entry))).word == "stands"


@pytest.mark.usefixtures("no_integration")
@pytest.mark.parametrize("change", REWORDED.values(), ids=REWORDED.keys())
def test_other_words_than_the_program_has_that_is_named_are_a_forgery(proved: Certificate, change: Any) -> None:
    """The program makes one text of the same data; what names it and has another one was changed."""
    for also in (
        lambda entry: None,
        lambda entry: entry["software"].pop("program"),
        lambda entry: entry["software"].update(python="3.0"),
    ):
        result = recheck(forged(proved, lambda entry, also=also: (change(entry), also(entry))))
        assert (result.stands, result.word, result.level) == (False, "DOES NOT STAND", Level.FORM)
        assert result.rendered is None
        assert "these sources, which word what it proves otherwise" in result.why
    for other in ("source", "program", "orbitproof"):
        result = recheck(
            forged(proved, lambda entry, other=other: (change(entry), entry["software"].update({other: "x"})))
        )
        assert result.word == "stands, worded otherwise"


@pytest.mark.usefixtures("no_integration")
def test_not_proved_cannot_be_turned_into_proved(proved: Certificate, refuted: Certificate) -> None:
    assert refuted.verdict == "not proved"

    def fill(entry: CertificateJson, tables: bool) -> None:
        true = proved.to_json()
        for key in ("verdict", "reason", "hypotheses", "results", "computation"):
            entry[key] = true[key]
        for key in ("theorem", "in_full"):
            entry["statement"][key] = true["statement"][key]
        if tables:
            entry["enclosures"] = true["enclosures"]

    kept = recheck(forged(refuted, lambda entry: fill(entry, False)))
    assert "verdict" in places(kept)
    # With the tables of another box the hypotheses follow; that they are its own only an integration shows.
    borrowed = recheck(forged(refuted, lambda entry: fill(entry, True)))
    assert "results" in places(borrowed)


def test_what_a_wider_enclosure_does_not_confirm_is_enclosed_once_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """A row of the fourth-order equation: derivatives come out wider with more bits, and narrower with still more."""
    (candidate,) = read_candidates(Path(__file__).parents[1] / "data" / "beam-candidate.json")
    certificate = certify(candidate, Limits(max_precision=256))
    assert recheck(certificate, integrate=True).stands
    every = rechecking._settings
    monkeypatch.setattr(rechecking, "_settings", lambda stored: list(every(stored))[:1])
    findings = recheck(certificate, integrate=True).findings
    assert findings
    assert all("does not confirm" in str(finding) for finding in findings)


def test_the_last_integration_is_that_of_which_the_certificate_was_made(proved: Certificate) -> None:
    """It finds the very balls that were found at first, and those that are stored are wider."""
    stated = rechecking._read(proved.to_json())
    assert stated.enclosures is not None
    *others, last = rechecking._settings(stated.enclosures)
    assert len(others) == 3
    assert all(each.precision > last.precision == proved.computation.precision for each in others)
    found = rechecking.enclose(stated.claim, last)
    assert tables_to_json(spared(found, negligible=Fraction(1, 2**last.precision))) == proved.to_json()["enclosures"]
    assert tables_to_json(found) != proved.to_json()["enclosures"]


@pytest.mark.slow
def test_what_other_coordinates_enclose_more_widely_is_enclosed_in_those_of_the_certificate() -> None:
    """With more bits regularised coordinates take less time on this halo orbit, and enclose derivatives 10^11 times as
    widely."""
    (candidate,) = read_candidates(Path(__file__).parents[1] / "data" / "other-coordinates-candidate.json")
    certificate = certify(candidate)
    assert certificate.verdict == "proved"
    assert certificate.computation.coordinates == "physical"
    stored = MODULE._read(certificate.to_json()).enclosures
    assert stored is not None
    first, *others = rechecking._settings(stored)
    assert first.coordinates == "auto"
    assert {each.coordinates for each in others} == {"physical"}
    assert enclose_iterates(candidate, first, ORACLE).coordinates != "physical"
    assert recheck(certificate, integrate=True).stands


def test_tables_of_another_box_are_found_by_integrating(proved: Certificate) -> None:
    entry = proved.to_json()
    entry["statement"]["candidate"]["centre"][0] = "453.4425868"
    candidate = candidate_from_json(entry["statement"]["candidate"], "test")
    stored = MODULE._stored_enclosures(entry, candidate)
    assert stored is not None
    outcome = MODULE._conclude(candidate, entry["computation"]["precision"], stored)
    consistent = make_certificate(candidate, outcome, Computation(**entry["computation"]), stored)
    assert recheck(consistent).stands
    result = recheck(consistent, integrate=True)
    assert not result.stands
    assert "iterates 1 1 box" in places(result)


def test_a_second_integration_that_is_off_is_found(proved: Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    def moved(candidate: Any, settings: Any, progress: Any) -> Enclosures:
        found = enclose_iterates(candidate, settings, ORACLE, progress)
        table = found.iterates[1][0]
        changed = {**table.centre, (1, 1): table.centre[(1, 1)] * 2}
        iterates = (found.iterates[0], (type(table)(table.box, changed),), *found.iterates[2:])
        return Enclosures(iterates, None, found.return_times, found.order, found.precision, found.steps)

    monkeypatch.setattr(MODULE, "enclose", moved)
    result = recheck(proved, integrate=True)
    assert "iterates 2 1 centre (1, 1)" in places(result)


def test_a_certificate_without_digest_does_not_stand(proved: Certificate) -> None:
    entry = {key: value for key, value in proved.to_json().items() if key != "digest"}
    assert places(recheck(Certificate.from_json(entry))) == "digest"


def test_other_software_is_named_where_numbers_differ(proved: Certificate) -> None:
    def change(entry: CertificateJson) -> None:
        entry["software"]["FLINT"] = "1.0"
        _other_results(entry)

    result = recheck(forged(proved, change))
    assert result.findings[-1].place == "software"
    assert "FLINT 1.0" in result.findings[-1].message


@pytest.mark.parametrize("name", ["distance", "rate", "level", "energy"])
@pytest.mark.parametrize("version", ["0.1.0", "0.2.0", "0.2.9", "not installed", "0.3.0", "1.0"])
def test_versions_that_took_names_for_their_own_are_refused_where_a_system_has_such_a_name(
    name: str, version: str
) -> None:
    more = {**TWIST.parameters, name: ParameterRange(None, None)}
    taken = replace(TWIST, parameters=more, first_integral_name="energy")
    found = list(taken_names(taken, {"orbitproof": version}))
    assert [each.place for each in found] == ([] if version in ("0.3.0", "1.0") else ["software"])
    assert list(taken_names(TWIST, {"orbitproof": version})) == []


@pytest.mark.parametrize(
    "made_by", [{"all is\nproved": "1"}, {"All orbits are stable": "1"}, {"python": "3. All orbits are stable"}]
)
def test_names_and_versions_of_software_are_no_sentences(proved: Certificate, made_by: dict[str, str]) -> None:
    """A report prints them."""
    with pytest.raises(InputError, match="software"):
        forged(proved, lambda entry: entry["software"].update(made_by))


def test_a_key_of_a_file_forges_no_row_of_the_table(proved: Certificate) -> None:
    row = "other  proved  stands  3 integration  12  300 bits"
    result = recheck(
        forged(
            proved,
            lambda entry: entry["hypotheses"][0]["enclosures"].update(
                {f"x\n{row}\u202e": {"mid": "0x1", "rad": "0x0"}}
            ),
        )
    )
    assert not result.stands
    text = recheck_table([result.id], {result.id: result})
    assert sum(line.startswith(proved.id) for line in text.split("\n")) == 2
    assert not any(line.startswith("other") for line in text.split("\n"))
    assert "\u202e" not in text


def test_a_float_beyond_all_floats_is_bad_input(proved: Certificate, tmp_path: Path) -> None:
    path = tmp_path / "certificates.json"
    write_certificates(path, [proved])
    seconds = json.dumps(proved.to_json()["computation"]["seconds"])
    path.write_text(path.read_text().replace(f'"seconds": {seconds}', '"seconds": 1e999'))
    with pytest.raises(InputError, match="1e999 is too large"):
        read_certificates(path)


@pytest.mark.parametrize("options", [[], ["--jobs", "2"]], ids=["one process", "two processes"])
def test_the_command_says_which_certificate_and_which_number(
    proved: Certificate, refuted: Certificate, options: list[str], tmp_path: Path, capsys: Any
) -> None:
    path = tmp_path / "certificates.json"
    write_certificates(path, [proved, refuted])
    assert main(["--recheck", str(path), *options]) == 0
    output, errors = capsys.readouterr()
    assert output.count("stands") == 2
    assert "2/2" in errors
    entry = forged(proved, _other_results)
    write_certificates(path, [entry, refuted])
    assert main(["--recheck", str(path), "--quiet", *options]) == 1
    output, errors = capsys.readouterr()
    assert "DOES NOT STAND" in output
    assert "k=3: results, parameter: stored is [453.4425868" in output
    assert "FAILED k=3" in errors
    assert main(["--recheck", str(path), "--quiet", "--only", "shifted"]) == 0


class Interrupted(Display):
    """Ctrl-C as soon as the first row is shown."""

    def finish(self, name: str, word: str) -> None:
        super().finish(name, word)
        raise KeyboardInterrupt


def test_an_interrupted_check_has_what_was_found_and_leaves_no_process(
    proved: Certificate, refuted: Certificate, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    path = tmp_path / "certificates.json"
    write_certificates(path, [proved, refuted])
    monkeypatch.setattr(checking_again, "Display", Interrupted)
    assert main(["--recheck", str(path), "--quiet"]) == INTERRUPTED
    output, errors = capsys.readouterr()
    assert "interrupted: 1 of 2 certificates checked" in errors
    (first, second) = (next(line for line in output.splitlines() if line.startswith(n)) for n in ("k=3", "shifted"))
    assert "stands" in first
    assert "not finished" in second
    assert not multiprocessing.active_children()
    with pytest.raises(KeyboardInterrupt):
        verify.recheck([proved, refuted], quiet=True)
    assert not multiprocessing.active_children()


@pytest.mark.parametrize(
    ("options", "word"),
    [(["--recheck", "-o", "x.json"], "--output"), (["--recheck", "--fresh"], "--fresh"), (["--integrate"], "--recheck"),
     (["--recheck", "--only", "no such row"], "no such row")],
)  # fmt: skip
def test_options_that_contradict_each_other_are_refused(
    proved: Certificate, options: list[str], word: str, tmp_path: Path, capsys: Any
) -> None:
    path = tmp_path / "certificates.json"
    write_certificates(path, [proved])
    assert word in refused(main, [str(path), *options], capsys)
