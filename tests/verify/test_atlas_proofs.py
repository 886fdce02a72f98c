"""Real pieces through the command: proved, and refused if polynomial or certificate are not what they should be."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support import atlas_work
from support.atlas_runs import write
from support.claims import TOUCH_AND_GO

from orbitproof.shared.claims import Piece
from orbitproof.shared.formats import candidate_from_json, read_atlas
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import certify, read_certificate, write_certificates
from orbitproof.verify.run.branch_command import main

SOURCE = Path(__file__).parents[1] / "data" / "atlas-falkner-skan.json"


def lifted(piece: Piece, height: Fraction) -> Piece:
    """The piece with its polynomial moved across the curve."""
    return replace(piece, polynomial=tuple((row[0] + height, *row[1:]) for row in piece.polynomial))


@pytest.mark.slow
def test_a_branch_is_proved_and_proved_again_in_another_way(tmp_path: Path, capsys: Any) -> None:
    target = str(tmp_path / "curve.json")
    assert main([str(SOURCE), "-o", target]) == 0
    assert "Along it beta increases strictly." in capsys.readouterr().out
    assert main(["--recheck", target]) == 0
    assert main(["--recheck", "--integrate", target, "--jobs", "2"]) == 0
    assert "stands  3 integration" in capsys.readouterr().out


@pytest.mark.slow
def test_certified_bifurcations_are_found_on_the_branch_or_missed(tmp_path: Path, capsys: Any) -> None:
    target, certificates = tmp_path / "curve.json", tmp_path / "certificates.json"
    claim = candidate_from_json(TOUCH_AND_GO, "test")
    vague = replace(claim, id="not proved", kernel_frame=((Fraction(0),),))
    write_certificates(certificates, [certify(candidate, Limits()) for candidate in (claim, vague)])
    asked = [str(SOURCE), "-o", str(target), "--bifurcations", str(certificates)]
    assert main([*asked, "--only", "touch*"]) == 0
    assert "- touch-and-go: touch-and-go of order 3, beta in [453.44258682138482" in capsys.readouterr().out
    (entry,) = read_certificate(target, "atlas-certificate").document["conclusion"]["bifurcations"]
    assert entry["on_curve"]
    assert entry["piece"] == "p015"

    # All pieces are kept; one of the two points is not certified, so it cannot be said to lie there.
    assert main([*asked, "--quiet"]) == 1
    output, _ = capsys.readouterr()
    assert "PROVED" in output
    assert 'Of these it is not shown that they lie on it:\n- "not proved"' in output
    assert main(["--recheck", str(target), "--bifurcations", str(certificates)]) == 0
    assert main(["--recheck", str(target), "--bifurcations", str(certificates), "--only", "touch*"]) == 1
    assert 'rests_on: "not proved": the certificate is sha256:' in capsys.readouterr().err


@pytest.mark.slow
def test_a_polynomial_that_was_changed_is_found(tmp_path: Path, capsys: Any) -> None:
    atlas = read_atlas(SOURCE)
    first, second = atlas.curve_pieces()
    changed = replace(atlas, pieces=(first, lifted(second, 2 * second.tube[0])))
    target = tmp_path / "curve.json"
    assert main([write(tmp_path / "atlas.json", changed), "-o", str(target), "--max-splits", "0"]) == 1
    output, errors = capsys.readouterr()
    assert "NOT PROVED" in output
    assert f"{second.id}: not proved" in errors
    assert {r.piece for r in read_certificate(target, "atlas-certificate").results if r.is_proved} == {first.id}


@pytest.mark.slow
def test_a_forged_certificate_is_found_by_integrating(tmp_path: Path, capsys: Any) -> None:
    """Consistent in itself, with a right digest: but no orbit is where it says."""
    atlas = read_atlas(SOURCE)
    wide = [replace(piece, tube=(10 * piece.tube[0],)) for piece in atlas.curve_pieces()]
    forged = replace(atlas, pieces=tuple(lifted(piece, 5 * piece.tube[0]) for piece in wide))
    target = str(tmp_path / "curve.json")
    assert main([write(tmp_path / "atlas.json", forged), "-o", target, "--quiet"], atlas_work.proving) == 0
    assert main(["--recheck", target]) == 0
    capsys.readouterr()
    assert main(["--recheck", "--integrate", target]) == 1
    output, errors = capsys.readouterr()
    assert "DOES NOT STAND" in output
    assert f"piece {wide[0].id}, s in [-0x1, 0x1]: is not proved again" in errors
