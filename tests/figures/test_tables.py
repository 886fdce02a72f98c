"""Tables say what the certificates say, in every format, and their enclosures contain the certified ones."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st
from support.claims import known
from support.table_rows import CANDIDATES, CERTIFICATES, certificates, like, only_section, proved_only

from orbitproof.figures.__main__ import main
from orbitproof.figures.tables import (
    CertifiedRow,
    Enclosure,
    Interval,
    Table,
    build_tables,
    default_published,
    parse_interval,
    read_published,
    read_rows,
    to_csv,
    to_latex,
    to_markdown,
    to_text,
)
from orbitproof.figures.tables.cells import kind_of
from orbitproof.figures.tables.latex import aligned
from orbitproof.figures.tables.rows import _family_of
from orbitproof.figures.tables.tables import TableRow
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS
from orbitproof.verify.evidence import bounds, certain_digits


@pytest.mark.parametrize(
    ("text", "lower", "upper"),
    [
        ("3.0216[6,8]", "3.02166", "3.02168"),
        ("3.17435[03, 36]", "3.1743503", "3.1743536"),
        ("-0.98[16,18]", "-0.9818", "-0.9816"),
        ("-1.016[09,14]", "-1.01614", "-1.01609"),
        ("[-1, 2.5e1]", "-1", "25"),
        ("340.5 +- 1e-9", "340.499999999", "340.500000001"),
        ("-2±0.5", "-2.5", "-1.5"),
    ],
)
def test_printed_enclosure_is_read_exactly(text: str, lower: str, upper: str) -> None:
    assert parse_interval(text) == Interval(Fraction(lower), Fraction(upper))


@pytest.mark.parametrize(
    "text", ["", "3.1", "nan", "[nan, 1]", "[1, inf]", "[2, 1]", "1 +- -1", "3.[1,22]", "3.0[1,2]x", "[1,2,3]", "(1,2)"]
)
def test_text_that_is_not_an_enclosure_is_refused(text: str) -> None:
    with pytest.raises(ValueError):
        parse_interval(text)


@settings(max_examples=200)
@given(
    st.integers(-(10**40), 10**40),
    st.integers(-150, 20),
    st.integers(0, 2**29),
    st.integers(-200, 10),
    st.integers(3, 60),
)
def test_the_notation_of_a_table_contains_the_ball(
    mantissa: int, exponent: int, radius: int, radius_exponent: int, digits: int
) -> None:
    ball = arb((mantissa, exponent), (radius, radius_exponent))
    text = certain_digits(ball, digits)
    interval = Interval(*bounds(ball))
    read = parse_interval(text) if "[" in text else Interval(Fraction(text), Fraction(text))
    assert interval.inside(read)
    if interval.lower * interval.upper > 0:
        last_place = max(abs(interval.lower), abs(interval.upper)) * Fraction(10) ** (1 - digits)
        assert read.width - interval.width <= 2 * max(last_place, interval.width / 10)


def test_missing_outside_and_not_proved_rows_decide_the_exit_code(tmp_path: Path, halo: CertifiedRow) -> None:
    def code(path: Path, *options: str) -> int:
        return main(["tables", str(path), "-o", str(tmp_path / "out"), "--quiet", *options])

    good = certificates(tmp_path / "good.json", proved_only)
    assert code(good) == 1
    assert code(good, "--allow-missing") == 0
    assert code(CERTIFICATES, "--allow-missing") == 1
    document = json.loads(default_published().read_text())
    document["lists"][0]["rows"][3]["parameter"] = "3.0216192479264201986830801047[7,8]"
    published = tmp_path / "published.json"
    published.write_text(json.dumps(document))
    assert code(good, "--allow-missing", "--published", str(published)) == 1
    table = (tmp_path / "out" / "table-cr3bp-L1-halo.txt").read_text()
    assert "outside: Jacobi constant lies" in table


def test_without_folder_the_tables_are_printed(capsys: Any) -> None:
    assert main(["tables", str(CERTIFICATES)]) == 1
    output, errors = capsys.readouterr()
    assert "3.0216192479264201986830801047[6,7]" in output
    assert "[1] falkner-skan-odd-k4-1: family; the run said: 'interval Newton: " in output
    assert "falkner-skan odd: 2 of 3 proved; of 3 published: 2 inside" in errors


def test_files_are_named_on_standard_output_and_all_formats_are_there(tmp_path: Path, capsys: Any) -> None:
    main(["tables", str(CERTIFICATES), "-o", str(tmp_path / "new" / "out"), "--quiet"])
    output, errors = capsys.readouterr()
    assert errors == ""
    written = [Path(line) for line in output.splitlines()]
    assert sorted(written) == sorted((tmp_path / "new" / "out").iterdir())
    assert {path.suffix for path in written} == {".txt", ".md", ".csv", ".tex"}


def test_decimals_in_csv_contain_the_ball(rows: list[CertifiedRow]) -> None:
    seen = 0
    for table in build_tables(rows, read_published(default_published())):
        for line in csv.DictReader(to_csv(table, 20).splitlines()):
            row = next((row for row in rows if row.id == line["id"]), None)
            if row is None or row.parameter is None:
                continue
            for name, enclosure in ((row.parameter_name, row.parameter), *row.point.items()):
                if f"{name} lower" in line:
                    ends = Interval(Fraction(line[f"{name} lower"]), Fraction(line[f"{name} upper"]))
                    assert enclosure.interval.inside(ends)
                    assert parse_interval(line[f"{name} enclosure"]) == ends
                    seen += 1
    assert seen == 9


def test_period_doublings_are_called_so(rows: list[CertifiedRow], halo: CertifiedRow) -> None:
    other = next(row for row in rows if row.kind == "period_tupling" and row.k > 2)
    assert [kind_of(TableRow(row, None, None)) for row in (halo, other)] == ["period doubling", "period tupling"]


def test_fewer_digits_widen_the_printed_enclosure(halo: CertifiedRow) -> None:
    table = Table(CR3BP, "L1-halo", (only_section([halo]),))
    assert "3.021[6,7]" in to_text(table, 5)
    assert "3.02161924792642019868308010476991[2,3]" in to_text(table, 34)


def test_every_row_of_a_written_table_has_all_its_columns(rows: list[CertifiedRow]) -> None:
    odd = [replace(row, id=f"a|b_{{%}}\n\\{row.id}", reason=row.reason and f"{row.reason} <$&#~^>") for row in rows]
    for table in build_tables(odd, read_published(default_published())):
        markdown = [line for line in to_markdown(table, 30).splitlines() if line.startswith("|")]
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in markdown}) == 1
        assert len({len(line) for line in csv.reader(to_csv(table, 30).splitlines())}) == 1
        latex = to_latex(table, 30)
        plain = re.sub(r"\\[\\{}&%$#_]", "", latex.replace("\\\\\n", "\n"))
        assert plain.count("{") == plain.count("}")
        assert plain.count("$") % 2 == 0
        for columns, body in re.findall(
            r"\\begin\{tabular\}\{(l+)\}\n\\hline\n(.*?)\\end\{tabular\}", latex, re.DOTALL
        ):
            lines = [line for line in body.splitlines() if line != "\\hline"]
            assert lines
            assert {len(re.findall(r"(?<!\\)&", line)) for line in lines} == {len(columns) - 1}


def test_masses_stand_side_by_side(rows: list[CertifiedRow]) -> None:
    earth = [row for row in rows if row.system is CR3BP]
    jupiter = [replace(row, id=f"SJ {row.id}", parameters={"mu": MASS_PARAMETERS["sun-jupiter"]}) for row in earth[1:]]
    extra = replace(jupiter[0], id="SJ extra", crossing=-1)
    (table,) = build_tables([*earth, jupiter[0], extra, *jupiter[1:]], read_published(default_published()))
    ids = [tuple(row and row.certified and row.certified.id for row in line) for line in aligned(table.sections)]
    assert ids[: len(earth) + 1] == [
        (earth[0].id, None),
        (earth[1].id, jupiter[0].id),
        (None, "SJ extra"),
        (earth[2].id, jupiter[1].id),
    ]
    latex = to_latex(table, 30)
    assert r"($\mu_{\mathrm{EM}}$) & Jacobi constant ($\mu_{\mathrm{SJ}}$) \\" in latex
    number = r"3.0216192479264201986830801047[6,7]"
    assert f"3 & 2 & $y' > 0$ & {number} & {number} " in latex


def test_negative_numbers_in_latex_have_minus_signs(halo: CertifiedRow) -> None:
    row = like(halo, halo.id, Fraction("-0.98650909"))
    table = Table(CR3BP, "L1-halo", (only_section([replace(row, parameter=Enclosure(arb("-0.9865"), row.value))]),))
    assert "& $-$0.98" in to_latex(table, 20)


def test_candidates_give_family_and_order(tmp_path: Path, rows: list[CertifiedRow]) -> None:
    document = json.loads(CANDIDATES.read_text())
    for place, entry in enumerate(document["candidates"]):
        entry["provenance"] = {"family": f"{entry['system']} orbits", "arclength": -float(place)}
    path = tmp_path / "candidates.json"
    path.write_text(json.dumps(document))
    placed = build_tables(read_rows([CERTIFICATES], [path]), [])
    assert [table.family for table in placed] == ["falkner-skan orbits", "cr3bp orbits"]
    order = [entry["id"] for entry in document["candidates"] if entry["system"] == "cr3bp"]
    assert [row.id for row in placed[1].sections[0].certified] == [n for n in order[::-1] if n in {r.id for r in rows}]


@pytest.mark.parametrize(
    ("id", "family"),
    [
        ("earth-moon-L1-halo-k4-2-second", "L1-halo"),
        ("sun-jupiter-L2-halo-fold-1", "L2-halo"),
        ("cr3bp-L3-halo-k10-12", "L3-halo"),
        ("a-guess", "cr3bp"),
    ],
)
def test_the_id_tells_the_family(id: str, family: str) -> None:
    assert _family_of(replace(known("em1"), id=id)) == family
