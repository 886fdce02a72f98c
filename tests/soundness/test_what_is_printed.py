"""What a file says never passes for what the program says: ids, quotations, names and titles in print."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from support.claims import known
from support.forgeries import Document, atlas_certificate, checked, forged
from test_forged_certificates import of_parabola

from orbitproof.figures.report import check_files, report_of
from orbitproof.figures.tables import read_rows
from orbitproof.shared.formats import InputError, atlas_from_json, atlas_to_json
from orbitproof.shared.systems import shown
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import (
    Certificate,
    Finding,
    Limits,
    certify,
    climb,
    differences,
    digest,
    other_hypotheses,
    recheck,
    write_certificates,
)
from orbitproof.verify.evidence import quoted, quoted_name
from orbitproof.verify.run import Display
from orbitproof.verify.run.row_tables import recheck_table, verdict_text

# Ids of several words


COLUMNS = "x proved stands 3 integration"


def called(certificate: Certificate, name: str) -> Certificate:
    def rename(entry: Document) -> None:
        entry["id"] = entry["statement"]["candidate"]["id"] = name

    return Certificate.from_json(forged(certificate.to_json(), rename))


def test_an_id_like_the_columns_of_a_table_stands_in_quotes(point: Certificate) -> None:
    named = called(point, COLUMNS)
    bad = Certificate.from_json(forged(named.to_json(), lambda entry: entry["results"].update(side="above")))
    for table in (
        recheck_table([COLUMNS], {COLUMNS: recheck(named)}),
        recheck_table([COLUMNS], {COLUMNS: recheck(bad)}),
        recheck_table([COLUMNS], {}),
        verdict_text([replace(known("fs3"), id=COLUMNS)], {COLUMNS: named}),
        verdict_text([replace(known("fs3"), id=COLUMNS)], {}),
    ):
        assert table.count(f'"{COLUMNS}"') == table.count(COLUMNS) > 0
    assert shown(point.id) == point.id
    assert recheck_table([point.id], {point.id: recheck(point)}).splitlines()[1].startswith(f"{point.id}  ")


def test_lines_of_commands_quote_ids_of_several_words(point: Certificate, tmp_path: Any, capsys: Any) -> None:
    bad = called(Certificate.from_json(forged(point.to_json(), lambda d: d["results"].update(side="above"))), COLUMNS)
    path = tmp_path / "bad.json"
    write_certificates(path, [bad])
    assert main(["--recheck", str(path)]) == 1
    captured = capsys.readouterr()
    for text in captured:
        assert text.count(f'"{COLUMNS}"') == text.count(COLUMNS) > 0
    assert f'FAILED "{COLUMNS}": ' in captured.err


def test_progress_quotes_ids_and_no_intervals(capsys: Any) -> None:
    display = Display({COLUMNS: 1.0, "1: p001 [-0x1, 0x1]": 1.0}, False)
    for name in (COLUMNS, "1: p001 [-0x1, 0x1]"):
        display.finish(name, "stands")
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith(f'[1/2] "{COLUMNS}": stands')
    assert second.startswith("[2/2] 1: p001 [-0x1, 0x1]: stands")


def test_a_theorem_quotes_ids_of_several_words(point: Certificate, tmp_path: Any) -> None:
    document = atlas_certificate(*of_parabola(), [called(point, "y and all others")])
    assert '- "y and all others" (k = 3): ' in document["statement"]["theorem"]
    write_certificates(tmp_path / "one.json", [called(point, "all orbits are stable forever")])
    report = str(report_of(check_files([tmp_path / "one.json"])))
    assert 'Theorem 1: "all orbits are stable forever"' in report


def test_a_piece_is_called_by_one_word() -> None:
    claim = atlas_to_json(of_parabola()[0])
    for name in ("two words", "", "a\nb", "x" * 101):
        claim["pieces"][0]["id"] = name
        with pytest.raises(InputError, match="id"):
            atlas_from_json(claim, "test")
    claim["pieces"][0]["id"] = "L1(north)"
    assert atlas_from_json(claim, "test").pieces[0].id == "L1(north)"


# Quotations


LIE = "'. FAILED nothing: it is proved that there are infinitely many"


@pytest.mark.parametrize("text", ["a'b", 'a"b', LIE, "'\"" * 80, "a\nFAILED x: y", "a\u202eb", "x" * 5000])
def test_a_quotation_is_not_ended_by_what_it_quotes(text: str) -> None:
    found = quoted(text)
    inner = found.removesuffix(" ..")
    assert inner[0] == inner[-1] != "\\"
    assert inner[0] in "'\""
    assert not inner[1:-1].replace(f"\\{inner[0]}", "").count(inner[0])
    assert found.isprintable()
    assert len(found) < 300
    assert quoted_name(text) == (text if text == "a'b" else found)


def test_findings_quote_what_is_stored() -> None:
    for stored, again in ((LIE, "below"), ([LIE] * 9, []), ({LIE: "1"}, {}), ({"a": LIE}, {"a": 1}), (LIE * 9, "x")):
        for finding in differences(stored, again, "results"):
            line = f"{finding.place}: {finding.message}"
            assert LIE not in line.replace(quoted(LIE), "").replace(quoted(LIE * 9), "")
    (finding,) = list(other_hypotheses(["C2", LIE], ["C2"], {}))[:1]
    assert f"stored are C2, {quoted(LIE)}; the theorem takes C2" == finding.message


def test_an_exception_that_quotes_the_file_is_quoted() -> None:
    def fails(examination: Any) -> list[Finding]:
        raise KeyError(LIE)

    found = climb({"id": "x", "verdict": "proved"}, [fails])
    assert found.findings[0].message == f"the check broke off: KeyError: {quoted(repr(LIE))}"


def _key(entry: Document) -> None:
    ball = next(ball for item in entry["hypotheses"] for ball in item["enclosures"].values())
    entry["hypotheses"][-1]["enclosures"][LIE] = ball


PLACES: dict[str, Callable[[Document], Any]] = {
    "name of a hypothesis": lambda entry: entry["hypotheses"][0].update(name=LIE[:60]),
    "key of the enclosures": _key,
    "key of a point": lambda entry: entry["results"]["point"].update({LIE: entry["results"]["parameter"]}),
    "section": lambda entry: entry["statement"].update(vector_field=LIE),
}


@pytest.mark.parametrize("change", PLACES.values(), ids=PLACES.keys())
def test_a_line_of_a_failed_check_has_no_words_of_the_file_unquoted(
    change: Callable[[Document], Any], point: Certificate, tmp_path: Any, capsys: Any
) -> None:
    path = tmp_path / "forged.json"
    write_certificates(path, [Certificate.from_json(forged(point.to_json(), change))])
    assert main(["--recheck", "--quiet", str(path)]) == 1
    for line in "".join(capsys.readouterr()).splitlines():
        assert "FAILED nothing" not in line or quoted(LIE)[:40] in line or quoted(LIE[:60])[:40] in line, line


def test_the_same_of_an_atlas() -> None:
    document = atlas_certificate(*of_parabola())
    ball = document["results"][0]["time"]
    other = forged(document, lambda entry: entry["conclusion"]["hypotheses"][0]["enclosures"].update({LIE: ball}))
    (finding,) = checked(other).findings[:1]
    assert finding.place.endswith(quoted(LIE))
    assert digest(other) == other["digest"]


def test_reasons_are_told_as_what_a_run_said_wherever_a_certificate_prints(tmp_path: Any) -> None:
    hopeless = certify(replace(known("fs3"), kernel_frame=((Fraction(0),),)), Limits(max_precision=256))
    told = forged(hopeless.to_json(), lambda entry: entry["reason"].update(message=LIE, remedy=LIE[1:]))
    entry = Certificate.from_json(told)
    said = f"the run said: {LIE!r}, and to try: {LIE[1:]!r}"
    assert str(entry) == f"touch-and-go (k = 3), not proved, frames; {said}"
    page = html.unescape(entry._repr_html_())
    assert page.count(said) == 1
    assert page.replace(said, "").count("FAILED") == 0
    write_certificates(tmp_path / "one.json", [entry])
    (row,) = read_rows([tmp_path / "one.json"])
    assert row.reason == f"frames; {said}"
