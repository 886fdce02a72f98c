"""Whatever can be proved goes through every format of a report, and tables and pictures hide nothing of it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb
from matplotlib.figure import Figure
from support import atlas_work, chain_cases
from support.claims import known
from support.forgeries import DATA, atlas_certificate, forged, read
from support.joined import write_catalogue, write_web

from orbitproof.figures.certified import CertifiedPoint, Curve
from orbitproof.figures.commands.report import main
from orbitproof.figures.pictures import draw_curves, draw_surface, surface_of
from orbitproof.figures.report import (
    check_files,
    hypothesis_table,
    margin_on_atlas,
    parameter_text,
    piece_table,
)
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import Atlas, read_candidates
from orbitproof.shared.systems import CR3BP, HILL_VARIED, VERTICAL, ReversibleSystem
from orbitproof.verify.certificate import Certificate, Limits, certify, write_certificates
from orbitproof.verify.evidence import bounds
from orbitproof.verify.run.branch_command import main as verify_atlas

LIMITS = Limits(digits=5, max_precision=256)

Document = dict[str, Any]


def results_for(atlas: Atlas, deviation: str = "0x1p-30") -> list[Document]:
    """What a prover of exact cases gives for any piece."""
    asked = {"integrator": {"precision": 80, "order": 40, "width": 40}, "interval": ["-0x1", "0x1"]}
    results = []
    for piece in atlas.pieces:
        entry = to_json(piece)
        tube = entry["tube"] if isinstance(entry["tube"], list) else [entry["tube"]]
        argument = {**asked, "piece": {**entry, "tube": tube}}
        bounds = {"deviation": [deviation] * len(tube)}
        results.append({**atlas_work.proving(argument, lambda fraction, label: None), **bounds})
    return results


def of_atlas(name: str) -> Document:
    atlas = read(name)
    return atlas_certificate(atlas, results_for(atlas, "0x1p-60"))


def planar_surface() -> Document:
    names = ("surface-results.json", "surface-planar-results.json")
    results = [result for name in names for result in json.loads((DATA / name).read_text())]
    return atlas_certificate(read("surface-planar.json"), results)


def loop() -> Document:
    atlas, _ = chain_cases.symmetric_loop()
    return atlas_certificate(atlas, results_for(atlas))


ATLASES: dict[str, Callable[[], Document]] = {
    "surface": planar_surface,
    "loop": loop,
    "libration family": lambda: of_atlas("atlas-lyapunov.json"),
    "curve on a fixed level": lambda: of_atlas("atlas-fixed-level.json"),
    "arc of orbits that cross twice": lambda: of_atlas("atlas-crossings.json"),
}


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A file for each kind of atlas."""
    folder = tmp_path_factory.mktemp("atlases")
    paths = {kind: folder / f"{kind.replace(' ', '-')}.json" for kind in ATLASES}
    for kind, make in ATLASES.items():
        document = json.loads(json.dumps(make()))
        assert document["verdict"] == "proved", (kind, document["reason"])
        paths[kind].write_text(json.dumps(document))
    return paths


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with a symmetry breaking, a touch-and-go bifurcation, a fold and an orbit."""
    fold = next(item for item in read_candidates(DATA / "known-folds.json") if item.id.startswith("michelson"))
    orbit = read_candidates(DATA / "orbit-candidates.json")[0]
    proofs = [certify(candidate, LIMITS) for candidate in (known("em1"), known("fs3"), fold, orbit)]
    assert all(proof.proved for proof in proofs)
    path = tmp_path_factory.mktemp("rows") / "rows.json"
    write_certificates(path, proofs)
    return path


def reports(paths: list[Path], folder: Path) -> dict[str, str]:
    """What is written about certificates, by format."""
    targets = {suffix: folder / f"report.{suffix}" for suffix in ("html", "tex", "md")}
    outputs = [word for target in targets.values() for word in ("-o", str(target))]
    assert main([*map(str, paths), *outputs, "--quiet"]) == 0
    return {suffix: target.read_text("utf-8") for suffix, target in targets.items()}


@pytest.mark.parametrize("kind", ATLASES)
def test_every_kind_of_atlas_is_told_in_every_format(kind: str, written: dict[str, Path], tmp_path: Path) -> None:
    (entry,) = check_files([written[kind]])
    assert entry.part == "arc"
    for text in reports([written[kind]], tmp_path).values():
        assert text.count(entry.certificate.atlas.id) > 2
        for piece in entry.certificate.atlas.pieces:
            assert piece.id in text
    drawn = tmp_path / "report-pictures"
    assert {path.suffix for path in drawn.glob("*")} == {".pdf", ".png"}


@pytest.mark.slow
def test_every_kind_of_row_is_told_in_every_format(rows: Path, tmp_path: Path) -> None:
    for text in reports([rows], tmp_path).values():
        for words in ("Symmetry breaking", "Touch-and-go", "Fold", "periodic orbit"):
            assert words in text
        # A certificate of other words stands, and they are not printed.
        assert "words those that follow from them" in " ".join(text.split())


def test_a_curve_with_its_complete_list_is_told_in_every_format(tmp_path: Path) -> None:
    certificate = tmp_path / "curve.json"
    source = str(DATA / "atlas-falkner-skan.json")
    assert verify_atlas([source, "-o", str(certificate), "--quiet", "--complete", "12"], atlas_work.stored) == 0
    for text in reports([certificate], tmp_path).values():
        assert "list of resonances to k = 12" in text


def test_the_summary_of_a_curve_does_not_count_orbits_as_bifurcations(written: dict[str, Path]) -> None:
    (entry,) = check_files([written["loop"]])
    assert entry.part == "arc"
    on_it = [
        {"kind": kind, "on_curve": kind != "period_tupling"} for kind in ("fold", "orbit", "orbit", "period_tupling")
    ]
    conclusion = {**entry.document["conclusion"], "bifurcations": on_it}
    text = parameter_text(replace(entry, certificate=Certificate({**entry.document, "conclusion": conclusion})))
    assert text.endswith("one certified bifurcation on it; 2 certified orbits on it")


def test_planar_pieces_below_a_surface_have_tubes_and_no_parts(written: dict[str, Path]) -> None:
    (entry,) = check_files([written["surface"]])
    assert entry.part == "arc"
    table = piece_table(entry)
    cells = {str(row[0][0]): dict(zip(table.header, row, strict=True)) for row in table.rows}
    for piece in entry.certificate.atlas.surface_pieces():
        assert cells[piece.id]["parts"] != ()
        assert cells[piece.id]["deviation from the polynomial"] == ()
    for piece in entry.certificate.atlas.libration_pieces():
        assert cells[piece.id]["parts"] == ()
        assert "of the tube" in str(cells[piece.id]["deviation from the polynomial"])


@pytest.mark.parametrize(("system", "times"), [(CR3BP, "half periods"), (VERTICAL["L2"], "T"), (HILL_VARIED, "T")])
def test_times_of_quarters_are_not_called_half_periods(
    system: ReversibleSystem, times: str, written: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    (entry,) = check_files([written["loop"]])
    assert entry.part == "arc"
    monkeypatch.setitem(vars(entry.certificate), "atlas", replace(entry.certificate.atlas, system=system))
    table = piece_table(entry)
    assert [name for name in table.header if name in ("half periods", "periods", "T")] == [times]


@pytest.mark.parametrize("kind", ["surface", "loop"])
def test_hypotheses_on_pieces_have_margins(kind: str, written: dict[str, Path]) -> None:
    (entry,) = check_files([written[kind]])
    header, rows = hypothesis_table(entry).header, hypothesis_table(entry).rows
    margins = [str(row[header.index("margin")]) for row in rows]
    assert any("of the tube" in margin for margin in margins) == (kind == "surface")
    assert any("widths from 0" in margin for margin in margins) == (kind == "loop")


def test_margins_on_an_atlas_are_rounded_to_be_safe() -> None:
    atlas = read("surface-planar.json")
    (piece, *_), (planar, *_) = atlas.surface_pieces(), atlas.libration_pieces()
    atlas = replace(atlas, pieces=(replace(piece, id="before"), *atlas.pieces))
    ball = arb(0, float(piece.radii[0]) / 3)
    assert margin_on_atlas(atlas, "glued", f"p_0 of {piece.id} in before", ball) == ""
    margin = margin_on_atlas(atlas, "glued", f"p_0 of before in {piece.id}", ball)
    assert Fraction(margin.split()[2]) >= bounds(ball)[1] / piece.radii[0]
    assert margin.endswith("R_0")
    ball = arb(0, float(planar.tube) / 7)
    margin = margin_on_atlas(atlas, "planar-family", f"vy of the symmetry breaking in {planar.id}", ball)
    assert Fraction(margin.split()[2]) >= bounds(ball)[1] / planar.tube
    curve, _ = chain_cases.parabola()
    covers = curve.claim.covers
    assert covers is not None
    margin = margin_on_atlas(curve, "covers", "beginning", arb(float(covers.start) - 0.5, 0.17))
    assert Fraction(margin.split()[2]) <= Fraction(33, 100)
    assert margin_on_atlas(curve, "covers", "end", arb(float(covers.end), 0.1)) == ""
    assert margin_on_atlas(curve, "covers", "end", arb("nan")) == ""


def test_neighbouring_pieces_of_a_surface_leave_no_gap_in_its_picture(written: dict[str, Path]) -> None:
    document = json.loads(written["surface"].read_text())
    surface = surface_of(Certificate(document))
    reach = draw_surface(surface).axes[0]
    assert len(reach.patches) == len(surface.sheets)
    for bar in reach.patches:
        assert bar.get_linewidth() == 0.0


def insets_and_curves(figure: Figure) -> tuple[list[Any], np.ndarray[Any, Any]]:
    """Where insets lie with their labels, and what else is drawn in the first panel, in pixels."""
    figure.canvas.draw()
    axes = figure.axes[0]
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    curves = [line for line in axes.get_lines() if len(line.get_xydata()) > 2]
    lines = [line.get_transform().transform(line.get_xydata()) for line in curves]
    return [inset.get_tightbbox(renderer) for inset in axes.child_axes], np.concatenate(lines)


def test_insets_hide_no_part_of_a_loop() -> None:
    document = loop()
    whole = Curve.of(Certificate(document))
    marks = [CertifiedPoint(f"point {n}", "period_tupling", 2, "p000", n / 10, False) for n in (1, 2, 3, 4)]
    near = replace(marks[0], id="near", s=0.102)
    curve = replace(whole, marks=(marks[0], near, *marks[1:]))
    boxes, drawn = insets_and_curves(draw_curves([curve]))
    assert len(boxes) == 2
    for box in boxes:
        assert not any(box.contains(*point) for point in drawn)


@pytest.mark.slow
def test_webs_and_rows_of_catalogues_are_told_with_what_they_rest_on_and_forged_ones_are_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    webs, rows = tmp_path / "webs", tmp_path / "rows"
    for folder in (webs, rows):
        folder.mkdir()
    point, arc, web = write_web(webs)
    curve, catalogue = write_catalogue(rows)
    given = [str(path) for path in (catalogue, web, arc, point, curve)]
    outputs = [word for suffix in ("html", "tex", "md") for word in ("-o", str(tmp_path / f"report.{suffix}"))]
    assert main([*given, *outputs, "--quiet"]) == 0
    text = (tmp_path / "report.md").read_text()
    for words in ("It rests on parabola ([Theorem ", "4 of 4 rows", "1 arc, 1 vertex", "largest bound"):
        assert words in text, words
    for name in ("near", "halo-from-the-plane-rows"):
        assert all(name in (tmp_path / f"report.{suffix}").read_text() for suffix in ("html", "tex", "md"))
    assert len(list((tmp_path / "report-pictures").glob("rows-*.p*"))) == 2

    told = ["-o", str(tmp_path / "other.md"), "--no-pictures", "--quiet"]
    assert main([str(web), str(arc), *told]) == 2
    assert "no such certificate is given" in capsys.readouterr().err
    assert main([str(catalogue), *told]) == 2
    assert "rests on the curve" in capsys.readouterr().err
    for path, change in (
        (web, lambda d: d["arcs"][0]["meets"][0].update(piece="p002")),
        (catalogue, lambda d: d["rows"][0]["orbit"]["period"].update(rad="0x1p-300")),
    ):
        path.write_text(json.dumps(forged(json.loads(path.read_text()), change)))
        assert main([*given, *told]) == 1
        assert f"REFUSED {path}" in capsys.readouterr().err
        assert not (tmp_path / "other.md").exists()
