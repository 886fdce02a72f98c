"""Tables say what the certificates say, compare it exactly with what is published, and claim nothing more."""

from __future__ import annotations

import copy
import csv
import json
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from figures.__main__ import main
from figures.certified import CertifiedRow, Enclosure, read_rows
from figures.intervals import Interval, parse_interval
from figures.published import Printed, PublishedList, PublishedRow, compare, default_published, match, read_published
from figures.table_latex import aligned, to_latex
from figures.table_text import to_csv, to_markdown, to_text
from figures.tables import Section, Table, build_tables
from shared.formats import InputError
from shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS
from verify.ball_text import bounds, certain_digits

DATA = Path(__file__).parent / "data"
CANDIDATES, CERTIFICATES = DATA / "figures-candidates.json", DATA / "figures-certificates.json"
DOCUMENT = json.loads(CERTIFICATES.read_text())
TINY = Fraction(1, 10**300)


@pytest.fixture(scope="module")
def rows() -> list[CertifiedRow]:
    return read_rows([CERTIFICATES])


@pytest.fixture(scope="module")
def halo(rows: list[CertifiedRow]) -> CertifiedRow:
    """The Earth-Moon row with k = 2, C = 3.0216."""
    return next(row for row in rows if row.id == "earth-moon-L1-halo-k2-1")


def printed(lower: Fraction, upper: Fraction) -> Printed:
    return Printed("as printed", Interval(lower, upper))


def around(row: CertifiedRow, low: Fraction, high: Fraction, k: int | None = None) -> PublishedRow:
    """A published row from `low` below our lower end to `high` above our upper end."""
    assert row.parameter is not None
    ours = row.parameter.interval
    return PublishedRow(7, k or row.k, printed(ours.lower - low, ours.upper + high), {})


def like(row: CertifiedRow, id: str, value: Fraction, radius: Fraction = Fraction(1, 10**30)) -> CertifiedRow:
    """A row of ours with another id and another enclosure."""
    interval = Interval(value - radius, value + radius)
    return replace(row, id=id, parameter=Enclosure(arb(float(value)), interval), value=interval)


def listed(row: CertifiedRow, *members: PublishedRow, complete: bool = True, family: str = "") -> PublishedList:
    return PublishedList(
        "a source", row.system, row.parameters, family or row.family, row.parameter_name, complete, members
    )


def only_section(rows: Sequence[CertifiedRow], *published: PublishedList) -> Section:
    (table,) = build_tables(rows, published)
    (section,) = table.sections
    return section


def certificates(path: Path, change: Callable[[list[Any]], list[Any] | None]) -> Path:
    """A copy of the stored certificates with a change."""
    document = copy.deepcopy(DOCUMENT)
    changed = change(document["certificates"])
    path.write_text(json.dumps({**document, "certificates": document["certificates"] if changed is None else changed}))
    return path


def proved_only(entries: list[Any]) -> list[Any]:
    return [entry for entry in entries if entry["verdict"] == "proved"]


# Notation


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


@settings(deadline=None, max_examples=200)
@given(
    st.integers(-(10**40), 10**40), st.integers(-150, 20), st.integers(0, 2**29), st.integers(-200, 10),
    st.integers(3, 60),
)  # fmt: skip
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


# Comparison


def test_stored_proofs_lie_inside_what_the_paper_prints(rows: list[CertifiedRow]) -> None:
    found = {}
    for table in build_tables(rows, read_published(default_published())):
        for section in table.sections:
            found |= {row.certified.id: (row.j, row.verdict) for row in section.rows if row.certified}
    assert found == {
        "earth-moon-L1-halo-k1-1": ("0", "inside"),
        "earth-moon-L1-halo-k2-1": ("3", "inside"),
        "earth-moon-L1-halo-k3-2": ("4", "inside"),
        "falkner-skan-odd-k2-1": ("-", "inside"),
        "falkner-skan-odd-k3-1": ("-", "inside"),
        "falkner-skan-odd-k4-1": ("-", "-"),
    }


def test_comparison_is_exact_at_the_ends(halo: CertifiedRow) -> None:
    def status(low: Fraction, high: Fraction) -> str:
        comparison = compare(halo, around(halo, low, high))
        assert comparison is not None
        return comparison.status

    assert halo.parameter is not None
    width = halo.parameter.interval.width
    assert status(Fraction(0), Fraction(0)) == "inside"
    assert status(-TINY, Fraction(0)) == "overlaps"
    assert status(Fraction(0), -TINY) == "overlaps"
    assert status(-width, Fraction(1)) == "overlaps"
    assert status(-width - TINY, Fraction(1)) == "outside"
    assert status(Fraction(1), -width - TINY) == "outside"


def test_outside_says_on_which_side_and_how_far(halo: CertifiedRow) -> None:
    assert halo.parameter is not None
    width = halo.parameter.interval.width
    gap = Fraction(1, 10**19)
    below = str(compare(halo, around(halo, -width - gap, Fraction(1))))
    above = str(compare(halo, around(halo, Fraction(1), -width - gap)))
    assert below.startswith("outside: Jacobi constant lies 1e-19 below")
    assert above.startswith("outside: Jacobi constant lies 1e-19 above")


def test_distances_beyond_the_range_of_doubles_are_printed(halo: CertifiedRow) -> None:
    huge = Fraction(10) ** 400
    comparison = compare(halo, PublishedRow(7, halo.k, printed(huge, huge + 1 / huge), {}))
    assert str(comparison).startswith("outside: Jacobi constant lies 1.0e+400 below")
    assert str(comparison).endswith("1e-400 wide")


def test_a_coordinate_outside_makes_the_row_outside(rows: list[CertifiedRow]) -> None:
    row = next(row for row in rows if row.id == "falkner-skan-odd-k2-1")
    y = row.point["y"].interval
    good = replace(around(row, TINY, TINY), point={"y": printed(y.lower, y.upper)})
    bad = replace(good, point={"y": printed(y.upper + TINY, y.upper + 1)})
    assert str(compare(row, good)) == "inside"
    assert str(compare(row, bad)).startswith("outside: y lies")


# Which row is which


def test_rows_of_another_multiplicity_mass_or_system_are_not_compared(halo: CertifiedRow) -> None:
    target = around(halo, TINY, TINY)
    assert match([halo], [target]) == {halo.id: target}
    assert match([halo], [replace(target, k=3)]) == {}
    other = replace(listed(halo, target), parameters={"mu": MASS_PARAMETERS["sun-jupiter"]})
    assert only_section([halo], other).rows[0].verdict == "-"
    elsewhere = replace(listed(halo, target), system=FALKNER_SKAN)
    assert only_section([halo], elsewhere).rows[0].verdict == "-"


def test_a_near_row_belongs_to_a_published_one_only_if_nothing_else_can_be_meant(halo: CertifiedRow) -> None:
    one, two = Fraction(3), Fraction(4)
    published = [PublishedRow(j, 2, printed(v, v), {}) for j, v in enumerate((one, two))]
    near, far = like(halo, "near", one + Fraction(9, 10**4)), like(halo, "far", one + Fraction(11, 10**4))
    exact = like(halo, "exact", one)
    assert match([near, far], published) == {"near": published[0]}
    assert match([far], published) == {}
    assert match([near, exact], published) == {"exact": published[0]}
    assert match([near, like(halo, "nearer", one + Fraction(1, 10**4))], published) == {"nearer": published[0]}
    assert match([near], published[:1]) == {}


def test_the_double_of_a_published_row_is_new_even_when_the_row_itself_is_absent(halo: CertifiedRow) -> None:
    # C = 3.02066 at the other point of Fix(R) is no misprint of C = 3.02161.
    double = like(halo, "earth-moon-L1-halo-k2-2", Fraction("3.02066456104522640932793326319549"))
    section = only_section([double], *read_published(default_published()))
    assert section.rows[0].j == "new"
    assert section.count("missing") == 12


def test_one_bifurcation_certified_at_both_points_is_no_new_one(halo: CertifiedRow) -> None:
    second = replace(halo, id="second", crossing=-halo.crossing)
    section = only_section([halo, second], listed(halo, around(halo, TINY, TINY)))
    assert [(row.j, row.verdict) for row in section.rows] == [("7", "inside"), ("7", "inside")]


def test_unlisted_rows_are_new_only_beside_a_complete_list(halo: CertifiedRow) -> None:
    other = around(halo, Fraction(-1), Fraction(1))
    complete = only_section([halo], listed(halo, other))
    partial = only_section([halo], listed(halo, other, complete=False))
    none = only_section([halo])
    assert [section.rows[0].j for section in (complete, partial, none)] == ["new", "-", "-"]
    assert [section.count("missing") for section in (complete, partial, none)] == [1, 1, 0]
    assert complete.rows[-1].verdict == "missing"


def test_a_list_of_another_family_is_used_only_where_values_meet(halo: CertifiedRow) -> None:
    here, elsewhere = around(halo, TINY, TINY), around(halo, Fraction(-1), Fraction(2))
    assert only_section([halo], listed(halo, elsewhere, family="other")).sources == ()
    assert only_section([halo], listed(halo, here, elsewhere, family="other")).count("inside") == 1
    both = only_section([halo], listed(halo, elsewhere), listed(halo, here, family="other"))
    assert (both.count("new"), both.count("missing")) == (1, 1)


def test_not_proved_rows_show_no_digits_and_are_never_inside(halo: CertifiedRow) -> None:
    assert halo.value is not None
    middle = halo.value.middle
    failed = replace(
        halo,
        proved=False,
        reason="HC3: cause; remedy",
        parameter=None,
        point={},
        side="",
        value=Interval(middle, middle),
    )
    section = only_section([failed], listed(halo, around(halo, TINY, TINY)))
    assert [(row.j, row.verdict) for row in section.rows] == [("7", "-")]
    assert only_section([failed], listed(halo, around(halo, Fraction(-1), Fraction(2)))).rows[0].j == "-"
    table = Table(CR3BP, "L1-halo", (section,))
    for write in (to_text, to_markdown, to_latex):
        text = write(table, 30)
        assert "3.0216" not in text
        assert "not proved" in text
        assert "cause" in text
    assert "3.0216" not in to_csv(table, 30)


def test_the_value_of_a_row_that_is_not_proved_is_that_of_its_centre(tmp_path: Path, halo: CertifiedRow) -> None:
    def fail(entries: list[Any]) -> None:
        for entry in entries:
            entry.update(verdict="not proved", results=None)
            entry["statement"].pop("theorem", None)
            entry["reason"] = {"condition": "frames", "message": "not regular", "remedy": "refine again"}

    rows = {row.id: row for row in read_rows([certificates(tmp_path / "failed.json", fail)])}
    found = rows[halo.id].value
    assert found is not None
    assert halo.value is not None
    assert found.distance(halo.value) < Fraction(1, 10**12)
    assert rows[halo.id].crossing == halo.crossing == 1


# Files


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
    assert "[1] falkner-skan-odd-k4-1: family:" in output
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


# Refusals


def change_ball(key: str, value: Callable[[str], str]) -> Callable[[list[Any]], None]:
    """Change mid or rad of the parameter of the third Earth-Moon row, whose radius is visible in its decimal."""

    def change(entries: list[Any]) -> None:
        entry = next(entry for entry in entries if entry["id"] == "earth-moon-L1-halo-k3-2")
        ball = entry["results"]["parameter"]
        ball[key] = value(ball[key])

    return change


def in_first(*path: str, value: Any) -> Callable[[list[Any]], None]:
    def change(entries: list[Any]) -> None:
        target = entries[0]
        for key in path[:-1]:
            target = target[key]
        target[path[-1]] = value

    return change


BAD_CERTIFICATES: dict[str, tuple[Callable[[list[Any]], list[Any] | None], str]] = {
    "midpoint moved": (change_ball("mid", lambda text: text.replace("p", "1p", 1)), "do not agree"),
    "another sign": (change_ball("mid", lambda text: f"-{text}"), "do not agree"),
    "radius made zero": (change_ball("rad", lambda text: "0x0"), "do not agree"),
    "radius made larger": (change_ball("rad", lambda text: text.replace("p-1", "p-", 1)), "do not agree"),
    "absurd size": (change_ball("rad", lambda text: "0x1p999999"), "size"),
    "negative radius": (change_ball("rad", lambda text: f"-{text}"), "radius"),
    "NaN midpoint": (change_ball("mid", lambda text: "nan"), "mid"),
    "NaN radius": (change_ball("rad", lambda text: float("nan")), "NaN"),  # type: ignore[arg-type, return-value]
    "infinite radius": (change_ball("rad", lambda text: "inf"), "rad"),
    "decimal that is no interval": (change_ball("decimal", lambda text: "[nan, nan]"), "do not agree"),
    "decimal of another number": (change_ball("decimal", lambda text: "[3.0216, 3.0217]"), "do not agree"),
    "id that the statement does not have": (in_first("id", value="other"), "id"),
    "statement of nothing": (in_first("statement", "candidate", value={}), "statement.candidate"),
    "unknown system": (in_first("statement", "candidate", "system", value="pendulum"), "pendulum"),
    "parameter of another system": (in_first("results", "parameter_name", value="energy"), "results"),
    "coordinate missing": (in_first("results", "point", value={}), "results"),
    "infinite time": (in_first("computation", "seconds", value=-1), "seconds"),
    "same certificate twice": (lambda entries: [entries[0], entries[0]], "twice"),
    "no certificate": (lambda entries: [], "certificates"),
}


def refused(arguments: list[str], capsys: Any) -> str:
    """The one line of a command that exits 2 and writes nothing else."""
    try:
        code = main(["tables", *arguments])
    except SystemExit as stopped:
        code = int(stopped.code or 0)
    output, errors = capsys.readouterr()
    assert code == 2, errors
    assert output == ""
    assert len(errors.splitlines()) == 1
    return str(errors)


@pytest.mark.parametrize("case", BAD_CERTIFICATES)
def test_certificates_that_were_changed_are_refused(case: str, tmp_path: Path, capsys: Any) -> None:
    change, word = BAD_CERTIFICATES[case]
    path = certificates(tmp_path / "certificates.json", change)
    message = refused([str(path), "-o", str(tmp_path / "out")], capsys)
    assert word in message
    assert str(path) in message
    assert len(message) < 500
    assert not (tmp_path / "out").exists()


def published_with(**entries: Any) -> str:
    document = json.loads(default_published().read_text())
    document["lists"][0].update(entries)
    return json.dumps(document)


BAD_PUBLISHED = {
    "not JSON": ("published: none", "not valid JSON"),
    "other format": (json.dumps({**json.loads(default_published().read_text()), "format": "x"}), "format"),
    "unknown key": (published_with(comment="x"), "comment"),
    "unknown system": (published_with(system="pendulum"), "pendulum"),
    "no mass": (published_with(parameters={}), "mu"),
    "mass as a float": (published_with(parameters={"mu": 0.01}), "mu"),
    "other parameter": (published_with(parameter_name="energy"), "Jacobi constant"),
    "NaN": (published_with(rows=[{"j": 0, "k": 1, "parameter": "nan"}]), "rows[0].parameter"),
    "NaN as a number": (published_with(rows=[{"j": 0, "k": 1, "parameter": float("nan")}]), "NaN"),
    "ends exchanged": (published_with(rows=[{"j": 0, "k": 1, "parameter": "[3, 2]"}]), "rows[0].parameter"),
    "unknown coordinate": (
        published_with(rows=[{"j": 0, "k": 1, "parameter": "[2, 3]", "point": {"w": "[1, 2]"}}]), "'w'",
    ),
    "k = 0": (published_with(rows=[{"j": 0, "k": 0, "parameter": "[2, 3]"}]), "rows[0].k"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_PUBLISHED)
def test_bad_published_files_are_refused(case: str, tmp_path: Path, capsys: Any) -> None:
    text, word = BAD_PUBLISHED[case]
    path = tmp_path / "published.json"
    path.write_text(text)
    message = refused([str(CERTIFICATES), "--published", str(path)], capsys)
    assert word in message
    assert str(path) in message


def test_a_certificate_in_two_files_and_a_candidate_of_another_claim_are_refused(tmp_path: Path, capsys: Any) -> None:
    again = certificates(tmp_path / "again.json", lambda entries: entries[:1])
    assert "as well" in refused([str(CERTIFICATES), str(again)], capsys)
    document = json.loads(CANDIDATES.read_text())
    document["candidates"][0]["radii"][0] = "1"
    path = tmp_path / "candidates.json"
    path.write_text(json.dumps(document))
    assert "differs from" in refused([str(CERTIFICATES), "--candidates", str(path)], capsys)


@pytest.mark.parametrize(
    "options", [["--digits", "0"], ["--digits", "nan"], ["--digits", "9" * 6000], ["--sources", "x"]]
)
def test_bad_options_are_refused(options: list[str], capsys: Any) -> None:
    assert "--help" in refused([str(CERTIFICATES), *options], capsys)


def test_a_folder_that_cannot_be_made_is_refused_before_anything_is_written(tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        assert str(folder) in refused([str(CERTIFICATES), "-o", str(folder)], capsys)
    with pytest.raises(InputError, match="cannot be read"):
        read_rows([tmp_path / "absent.json"])
