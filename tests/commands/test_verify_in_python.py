"""Branches, places and second proofs from Python: what the commands do, as values."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.claims import known

from orbitproof import verify
from orbitproof.shared import IndexAlong, InputError, read_atlas, write_candidates
from orbitproof.verify.__main__ import main
from orbitproof.verify.certificate import Certificate

SOURCE = Path(__file__).parents[1] / "data" / "atlas-falkner-skan.json"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("python")


@pytest.fixture(scope="module")
def row() -> verify.Certificate:
    (certificate,) = verify.certify(known("fs3"), quiet=True)
    return certificate


@pytest.fixture(scope="module")
def curve(folder: Path, row: verify.Certificate) -> verify.Certificate:
    (found,) = verify.certify(read_atlas(SOURCE), rests_on=row, output=folder / "curve.json", quiet=True)
    return found


def told(document: Any) -> Any:
    """Without how long it took."""
    if isinstance(document, dict):
        return {key: told(value) for key, value in document.items() if key not in ("seconds", "digest")}
    return [told(value) for value in document] if isinstance(document, list) else document


def test_a_branch_is_proved_as_by_the_command(curve: verify.Certificate, folder: Path, row: Any) -> None:
    assert curve.proved
    assert curve.is_whole
    assert repr(curve) == f"<Certificate {curve.id!r}: proved, {len(curve.atlas.pieces)} pieces>"
    assert (curve.theorem or "").startswith("Consider the Falkner-Skan equation")
    assert (curve.reason, folder.joinpath("curve.json").exists()) == (None, True)
    assert verify.read(folder / "curve.json")[0].document == curve.document
    verify.write(folder / "row.json", [row])
    words = ["atlas", str(SOURCE), "-o", str(folder / "there.json"), "--bifurcations", str(folder / "row.json")]
    assert main([*words, "--quiet"]) == 0
    assert told(verify.read(folder / "there.json")[0].document) == told(curve.document)


def test_a_run_goes_on_from_its_file(curve: verify.Certificate, folder: Path, capsys: Any) -> None:
    (again,) = verify.certify(read_atlas(SOURCE), output=folder / "curve.json")
    assert "pieces settled already, kept" in capsys.readouterr().err
    assert again.document["results"] == curve.document["results"]
    verify.write(folder / "curve.json", curve)
    assert verify.read(folder / "curve.json")[0].document == curve.document


def test_rows_and_branches_are_checked_again_in_their_order(curve: verify.Certificate, row: verify.Certificate) -> None:
    first, second = verify.recheck([curve, row], quiet=True)
    assert (first.id, second.id) == (curve.id, row.id)
    assert first.stands
    assert second.stands
    assert repr(first) == f"<Recheck {curve.id!r}: stands, level 2 conclusion>"
    document = json.loads(json.dumps(curve.document))
    document["results"][0]["deviation"][0] = "0x1p-100"
    (forged,) = verify.recheck(Certificate(document), quiet=True)
    assert not forged.stands


def test_a_row_is_no_orbit_with_a_place(curve: verify.Certificate, row: verify.Certificate) -> None:
    (placed,) = verify.places(curve, [row])
    assert row.id in placed.line
    again = verify.recheck([placed.certificate], rests_on=curve, quiet=True)
    assert all(check.stands for check in again)


def test_what_one_rests_on_has_to_be_given_and_files_hold_one_or_rows(
    curve: verify.Certificate, row: verify.Certificate, folder: Path
) -> None:
    rests_on = {"id": curve.id, "digest": ""}
    index = Certificate({"format": "orbitproof-index-certificate", "id": curve.id, "rests_on": rests_on})
    with pytest.raises(InputError, match=f"rests on the curve {curve.id} .*, which is not given; give its file"):
        verify.recheck(index, rests_on=row, quiet=True)
    for entries, words in (([curve, row], "a file of its own"), ([], "no certificates to write")):
        with pytest.raises(InputError, match=words):
            verify.write(folder / "both.json", entries)
    assert not (folder / "both.json").exists()


def test_what_cannot_be_asked_is_refused_in_a_line(row: verify.Certificate) -> None:
    atlas = read_atlas(SOURCE)
    for given, words in (
        ({"rests_on": [row, row]}, "appears twice"),
        ({"digits": 20}, "digits: is not asked of a claim about a branch"),
        ({"within": "1"}, "within: is not asked of a claim about a branch"),
        ({"precision": 1}, "give larger numbers"),
    ):
        with pytest.raises(InputError, match=words):
            verify.certify(atlas, quiet=True, **given)
    for wrong in ({"complete": 0}, {"complete": 100}, {"max_splits": -1}, {"timeout": -1.0}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))}: {next(iter(wrong.values()))}"):
            verify.certify(atlas, quiet=True, **wrong)
    for claims, more, words in (
        (known("fs3"), {"rests_on": row}, "a claim about a box rests on nothing"),
        (known("fs3"), {"complete": 3}, "complete: is not asked of a claim about a box"),
        ([atlas, known("fs3")], {"complete": 3}, "complete: is not asked of a claim about a box"),
        ([atlas, known("fs3")], {"output": "out.json"}, "output: holds rows, or one certificate of another kind"),
        ([atlas, atlas], {"output": "out.json"}, "prove these claims one by one"),
        (IndexAlong("x"), {"scheduler": "tcp://nowhere:1"}, "scheduler: is not asked of a claim about an index"),
        (IndexAlong("x"), {"rests_on": row}, "rests_on: the claim rests on the curve x, once; give its certificate"),
    ):
        with pytest.raises(InputError, match=words):
            verify.certify(claims, quiet=True, **more)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="jobs: 0"):
        verify.certify(atlas, jobs=0, quiet=True)
    with pytest.raises(InputError, match="appears twice"):
        verify.prove_again([row, row], quiet=True)


def test_rows_are_kept_in_a_file_as_they_come(folder: Path, capsys: Any) -> None:
    (first,) = verify.certify(known("fs2"), output=folder / "rows.json", quiet=True)
    assert verify.read(folder / "rows.json") == [first]
    (second,) = verify.certify(known("fs2"), output=folder / "rows.json")
    assert second == first
    assert "1 of 1 proved already, kept" in capsys.readouterr().err
    with pytest.raises(InputError, match="holds certificates of other candidates"):
        verify.certify(known("fs3"), output=folder / "rows.json", quiet=True)
    (third,) = verify.certify(known("fs2"), output=folder / "rows.json", fresh=True)
    assert "kept" not in capsys.readouterr().err
    assert (third.proved, str(third.parameter)) == (first.proved, str(first.parameter))


@pytest.mark.slow
def test_a_second_proof_agrees_and_a_changed_certificate_does_not(folder: Path) -> None:
    (row,) = verify.certify(known("fs2"), quiet=True)
    (found,) = verify.prove_again(row, output=folder / "again.json", quiet=True)
    assert found.verdict == "agrees"
    entry = row.to_json()
    entry["results"]["side"] = "below" if entry["results"]["side"] == "above" else "above"
    (other,) = verify.prove_again(verify.Certificate.from_json(entry), quiet=True)
    assert other.verdict == "disagrees"
    assert "side" in other.reason


def test_claims_of_several_kinds_and_files_of_claims_are_proved_by_one_function(folder: Path) -> None:
    write_candidates(folder / "claims.json", [known("fs2")])
    (alone,) = verify.certify(folder / "claims.json", quiet=True)
    atlas = replace(read_atlas(SOURCE), pieces=read_atlas(SOURCE).pieces[:1])
    branch, row = verify.certify([atlas, known("fs2")], quiet=True)
    assert told(row.to_json()) == told(alone.to_json())
    assert (branch.id, branch.kind) == (atlas.id, atlas.claim.kind)
