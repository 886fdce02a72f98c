"""Folds in pictures: a mark of their own, and one curve in the box of their certificate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.picture_texts import unreadable

from orbitproof.figures.certified import CertifiedCurves
from orbitproof.figures.pictures import certified_boxes, legend_handles
from orbitproof.figures.report import check_files, pictures_of
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import InputError, read_candidates
from orbitproof.verify.certificate import Certificate, certify, write_certificates

DATA = Path(__file__).parents[1] / "data" / "known-folds.json"


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    (fold,) = (item for item in read_candidates(DATA) if item.id.startswith("michelson"))
    found = certify(fold)
    assert found.proved
    return found


def test_a_fold_and_a_symmetry_breaking_are_told_apart_in_a_legend() -> None:
    handles = legend_handles([(1, "fold"), (1, "symmetry_breaking")])
    assert len({handle.get_marker() for handle in handles}) == 2
    assert len({handle.get_label() for handle in handles}) == 2
    # Of a k > 1 both kinds look alike, and have one entry.
    (both,) = legend_handles([(3, "touch_and_go"), (3, "period_tupling")])
    assert both.get_label() == "$k=3$, period tupling or touch-and-go"


def test_the_curve_of_a_fold_bends_as_its_coefficient_says(certificate: Certificate) -> None:
    curves = CertifiedCurves.of(certificate.to_json(), "here")
    assert curves.branch.shape == (0, 4)
    assert curves.beta is not None
    first, second = (float(radius) for radius in curves.radii)
    left, right, low, high = curves.family.T
    assert np.all(left <= right)
    assert (low[0], high[-1]) == (-1, 1)
    # To the left and right of the extremum the parameter, here p_0, is on the side that the certificate says.
    bend = float(curves.beta.mid()) * second**2 / first
    start, end = (float(0.5 * (left[row] + right[row])) for row in (0, -1))
    middle = float(curves.point[:2].mean())
    slack = float(np.max(right - left))
    for value in (start, end):
        assert (value > middle) == (curves.side == "above")
        assert value - middle == pytest.approx(bend, rel=0.1, abs=2 * slack)


def test_the_picture_of_a_fold_shows_one_curve_and_its_mark(certificate: Certificate, tmp_path: Path) -> None:
    file = tmp_path / "certificates.json"
    write_certificates(file, [certificate])
    written = certified_boxes.write(file, [], tmp_path / "out")
    assert [path.suffix for path in written] == [".pdf", ".png"]
    with use_style():
        figure = certified_boxes.draw_certified(CertifiedCurves.of(certificate.to_json(), "here"), None)
        (mark,) = (line for line in figure.axes[0].lines if str(line.get_gid()).startswith("candidate"))
        assert mark.get_marker() == legend_handles([(1, "fold")])[0].get_marker()
        said = " ".join(text.get_text() for legend in figure.legends for text in legend.get_texts())
        assert "family" in said
        assert "branch" not in said
        assert "along the family: two orbits" in figure.axes[1].get_title(loc="left")
        assert unreadable(figure) == []
        close(figure)


def test_a_certificate_of_an_orbit_has_no_curve(certificate: Certificate) -> None:
    document = certificate.to_json()
    document["statement"]["candidate"] |= {"kind": "orbit"}
    with pytest.raises(InputError, match="here"):
        CertifiedCurves.of(document, "here")


@pytest.mark.slow
def test_a_report_has_the_picture_of_a_fold(tmp_path: Path) -> None:
    fold = next(item for item in read_candidates(DATA) if item.id == "earth-moon-L1-halo-fold-1")
    write_certificates(tmp_path / "fold.json", [certify(fold)])
    (entry,) = check_files([tmp_path / "fold.json"])
    (picture,) = pictures_of(entry)
    assert picture.name == "box-earth-moon-L1-halo-fold-1"
    assert "(a) the family in the box" in picture.caption
    assert picture.png.startswith(b"\x89PNG")
