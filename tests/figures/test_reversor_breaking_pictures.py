"""Where R is lost: tables, pictures and reports say what the certificate says, in the coordinates of Fix(R)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support import breaking_cases as cases
from support.picture_texts import unreadable

from orbitproof.figures.__main__ import main
from orbitproof.figures.model import mark_candidates
from orbitproof.figures.pictures import draw_reversor_breaking
from orbitproof.figures.scripting import write_report
from orbitproof.figures.style import close, use_style
from orbitproof.figures.tables import build_tables, default_published, read_published, read_rows
from orbitproof.shared.formats import write_candidates
from orbitproof.verify.certificate import Certificate, certify, write_certificates
from orbitproof.verify.reversor_breaking import BreakingResults


@pytest.fixture(scope="module")
def proof() -> Certificate:
    found = certify(cases.modes())
    assert found.proved
    return found


@pytest.fixture
def files(proof: Certificate, tmp_path: Path) -> tuple[Path, Path]:
    candidates, certificates = tmp_path / "candidates.json", tmp_path / "certificates.json"
    write_candidates(candidates, [cases.modes()])
    write_certificates(certificates, [proof])
    return candidates, certificates


def test_a_table_has_the_row_with_its_kind_side_and_level(files: tuple[Path, Path]) -> None:
    (row,) = read_rows([files[1]])
    assert (row.kind, row.k, row.side, row.proved) == ("reversor_breaking", 1, "above", True)
    assert row.parameter is not None
    assert row.parameter.interval.lower <= cases.level_of(odd=True) <= row.parameter.interval.upper
    (table,) = build_tables([row], read_published(default_published()))
    (entry,) = table.sections[0].rows
    assert (entry.status, entry.published) == ("-", None)


def test_a_row_that_is_not_proved_stands_at_the_level_of_its_box(tmp_path: Path) -> None:
    claim = cases.modes(centre=(cases.level_of(odd=True) + 1, cases.modes().centre[1]))
    path = tmp_path / "certificates.json"
    write_certificates(path, [certify(claim)])
    (row,) = read_rows([path])
    assert not row.proved
    assert row.value is not None
    assert float(row.value.middle) == pytest.approx(float(claim.centre[0]))


def test_no_list_of_published_resonances_is_about_it(proof: Certificate, files: tuple[Path, Path]) -> None:
    (row,) = read_rows([files[1]])
    (*lists,) = read_published(default_published())
    system = next(each.system for each in lists if each.complete)
    parameters = next(each.parameters for each in lists if each.complete and each.system is system)
    family = next(each.family for each in lists if each.complete and each.system is system)
    alike = replace(row, system=system, parameters=parameters, family=family)
    (table,) = build_tables([alike], lists)
    (ours,) = [entry for entry in table.sections[0].rows if entry.certified is not None]
    assert ours.status == "-"
    (table,) = build_tables([replace(alike, kind="symmetry_breaking")], lists)
    assert [entry.status for entry in table.sections[0].rows if entry.certified is not None] != ["-"]


def test_the_mark_of_a_claim_on_a_level_lies_on_fix_r(files: tuple[Path, Path]) -> None:
    (mark,) = mark_candidates([cases.modes()], files[1], files[0])
    names = cases.MODES.centre_coordinates
    h = float(cases.level_of(odd=True))
    assert dict(zip(names, mark.point, strict=True)) == pytest.approx({"x": 0.0, "vy": np.sqrt(h)})
    assert mark.level == pytest.approx(h)
    assert mark.certified


def test_the_picture_opens_to_the_certified_side(proof: Certificate) -> None:
    assert isinstance(proof.results, BreakingResults)
    with use_style():
        figure = draw_reversor_breaking(cases.modes(), proof.results)
        assert unreadable(figure) == []
        curve = figure.axes[0].lines[0]
        y, level = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert level.min() == pytest.approx(0, abs=1e-20)
        assert level[-1] == pytest.approx(float(proof.results.opening.mid()) * y[-1] ** 2)
        orbit = figure.axes[1].lines[0]
        assert np.asarray(orbit.get_xydata())[0] == pytest.approx(np.asarray(orbit.get_xydata())[-1], abs=1e-6)
        close(figure)


def test_a_report_draws_it_and_names_its_own_normal_form(files: tuple[Path, Path], tmp_path: Path) -> None:
    page = tmp_path / "report.md"
    write_report([files[1]], [page])
    text = page.read_text(encoding="utf-8")
    assert "normal form (section 27.5): $\\gamma$ in" in text
    assert "birth-modes.png" in text
    assert "section 9.5" not in text


def test_the_commands_draw_and_tabulate(files: tuple[Path, Path], tmp_path: Path) -> None:
    folder = tmp_path / "out"
    assert main(["tables", str(files[1]), "-o", str(folder), "--quiet"]) == 0
    assert "loss of R" in (folder / "table-modes-modes.txt").read_text(encoding="utf-8")
    assert main(["family", *map(str, files), "-o", str(folder), "--format", "png", "--dpi", "50", "--quiet"]) == 0
    assert list(folder.glob("points-modes.png"))
