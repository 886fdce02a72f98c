"""Curves of periodic orbits without symmetry in reports and pictures."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.periodic_curves import ATLASES, proved

from orbitproof.figures.certified import Curve
from orbitproof.figures.commands.report import main
from orbitproof.figures.pictures import draw_curves
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.certificate import Certificate, write_certificate


@pytest.mark.parametrize("name", ["turning", "levels"])
def test_curves_have_theorem_table_and_pictures_in_a_report(name: str, tmp_path: Path) -> None:
    atlas, results = ATLASES[name], proved(name)
    document = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda entries: [], None))
    path, page = tmp_path / "certificate.json", tmp_path / "report.html"
    write_certificate(path, document)
    assert main([str(path), "-o", str(page), "--quiet"]) == 0
    text = page.read_text()
    for words in ("A curve of periodic orbits", "Proved intervals", "periods", "drawn from the polynomials"):
        assert words in text
    assert "half periods" not in text


def test_the_axes_of_a_curve_are_its_parameter_and_a_coordinate() -> None:
    atlas, results = ATLASES["turning"], proved("turning")
    document = make_atlas_certificate(atlas, results, conclusion_of(atlas, results, [], lambda entries: [], None))
    curve = Curve.of(Certificate(document))
    assert curve.has_parameter
    assert all(stretch.is_proved for stretch in curve.stretches)
    (axes,) = draw_curves([curve]).axes
    assert ("a" in axes.get_xlabel(), "x" in axes.get_ylabel()) == (True, True)
