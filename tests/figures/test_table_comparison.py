"""Certified rows are compared exactly with published ones, and only with those that are meant."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from support.table_rows import TINY, around, certificates, like, listed, only_section, printed

from orbitproof.figures.tables import (
    CertifiedRow,
    Interval,
    PublishedRow,
    Table,
    build_tables,
    default_published,
    read_published,
    read_rows,
    to_csv,
    to_latex,
    to_markdown,
    to_text,
)
from orbitproof.figures.tables.published import compare, match
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS


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
            entry["statement"].pop("in_full", None)
            entry["reason"] = {"condition": "frames", "message": "not regular", "remedy": "refine again"}

    rows = {row.id: row for row in read_rows([certificates(tmp_path / "failed.json", fail)])}
    found = rows[halo.id].value
    assert found is not None
    assert halo.value is not None
    assert found.distance(halo.value) < Fraction(1, 10**12)
    assert rows[halo.id].crossing == halo.crossing == 1
