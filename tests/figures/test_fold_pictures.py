"""Folds in pictures: a mark of their own, and none where two curves that cross are drawn."""

from __future__ import annotations

from pathlib import Path

import pytest

from orbitproof.figures.model.certified_box import CertifiedCurves
from orbitproof.figures.pictures import certified_boxes
from orbitproof.figures.style.style import legend_handles
from orbitproof.shared.formats import InputError, read_candidates
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.certificate.certificate import write_certificates
from orbitproof.verify.certificate.certify import certify

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


def test_a_fold_has_no_two_curves_that_cross(certificate: Certificate, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no two curves cross there"):
        CertifiedCurves.of(certificate.to_json(), "here")
    file = tmp_path / "certificates.json"
    write_certificates(file, [certificate])
    with pytest.raises(InputError, match="folds only"):
        certified_boxes.write(file, [], tmp_path / "out")
    assert not (tmp_path / "out").exists()
