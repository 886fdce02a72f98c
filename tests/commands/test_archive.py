"""The archive of certificates: a guide with every certificate and its digest, and no archive of what does not stand."""

from __future__ import annotations

import hashlib
import json
import runpy
import tarfile
from pathlib import Path

import pytest
from support.claims import known
from support.forgeries import forged
from support.joined import retrograde_index, write_catalogue, write_indexed_web, write_web

from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.certificate import Limits, certify, write_certificate, write_certificates

ROOT = Path(__file__).resolve().parents[2]
ARCHIVE = runpy.run_path(str(ROOT / "docs" / "archive.py"))["main"]


def test_pages_of_theorems_get_the_words_of_certificates_and_keep_what_has_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    script = runpy.run_path(str(ROOT / "docs" / "theorems.py"))
    made, pages = tmp_path / "made", tmp_path / "pages"
    made.mkdir()
    pages.mkdir()
    write_web(made)
    page = "# Page\n\n<!-- theorem {} -->\n\nold words\n\n<!-- end -->\n\nafter\n"
    (pages / "known.md").write_text(page.format("parabola"))
    (pages / "unknown.md").write_text(page.format("elsewhere"))
    assert script["main"]([str(made), "--pages", str(pages)]) == 1
    known = (pages / "known.md").read_text()
    assert "old words" not in known
    assert "\n\nThere is a smooth curve" in known
    assert known.endswith("<!-- end -->\n\nafter\n")
    assert (pages / "unknown.md").read_text() == page.format("elsewhere")
    assert "elsewhere: no certificate" in capsys.readouterr().err
    listed = "Consider.\n- one\n- two\nEnd.\nHypothesis level of the list: x.\n- c"
    assert script["as_page"](listed) == "Consider.\n\n- one\n- two\n\nEnd."


def test_an_archive_names_every_certificate_and_refuses_one_that_was_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made, out = tmp_path / "made", tmp_path / "out"
    made.mkdir()
    (made / "candidates.json").write_text("{}")
    certificate = certify(known("fs2"), Limits(max_precision=256))
    write_certificates(made / "rows.json", [certificate])
    assert ARCHIVE([str(made), "-o", str(out), "--no-pictures"]) == 0
    guide = (out / "content" / "README.md").read_text("utf-8")
    digest = json.loads((made / "rows.json").read_text())["certificates"][0]["digest"]
    (line,) = [line for line in guide.splitlines() if digest in line]
    assert "rows.json" in line
    assert f"`{certificate.id}`" in line
    assert "| proved | stands |" in line
    for line in (out / "content" / "SHA256SUMS").read_text().splitlines():
        value, name = line.split("  ")
        assert hashlib.sha256((out / "content" / name).read_bytes()).hexdigest() == value
    assert verify(["--recheck", str(out / "content" / "certificates" / "rows.json"), "--quiet"]) == 0
    (packed,) = out.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert names == {"README.md", "SHA256SUMS", "theorems.html", "theorems.md", "certificates/rows.json"}

    document = json.loads((made / "rows.json").read_text())
    document["certificates"][0]["results"]["side"] = "above"
    (made / "rows.json").write_text(json.dumps(document))
    other = tmp_path / "other"
    assert ARCHIVE([str(made), "-o", str(other), "--no-pictures"]) in (1, 2)
    assert not other.exists()
    assert capsys.readouterr().err
    empty = tmp_path / "empty"
    empty.mkdir()
    assert ARCHIVE([str(empty), "-o", str(other)]) == 2


def test_folders_with_the_same_names_in_them_are_told_apart_and_what_rests_on_others_is_checked_as_the_guide_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    webs, rows, out = (tmp_path / name for name in ("webs", "rows", "out"))
    for folder, write in ((webs, write_web), (rows, write_catalogue)):
        folder.mkdir()
        write(folder)
    assert ARCHIVE([str(webs), str(rows), "-o", str(out), "--no-pictures"]) == 0
    content = out / "content"
    guide = (content / "README.md").read_text("utf-8")
    lines = [line.split()[1:] for line in guide.splitlines() if line.startswith("    orbitproof verify")]
    assert sum("--recheck" in line for line in lines) == 5
    monkeypatch.chdir(content)
    for line in lines:
        if "web" in line or "catalogue" in line:
            assert verify([*line[1:], "--quiet"]) == 0
    told = (content / "theorems-webs.md").read_text() + (content / "theorems-rows.md").read_text()
    assert "passes through near" in told
    assert "For each of 4 of 4 rows" in told

    monkeypatch.chdir(tmp_path)
    (webs / "curve.json").unlink()
    assert ARCHIVE([str(webs), "-o", str(tmp_path / "none"), "--no-pictures"]) == 2
    assert "parabola, and no such certificate is given" in capsys.readouterr().err


def test_indices_are_told_and_checked_with_their_curves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made, out = tmp_path / "made", tmp_path / "out"
    made.mkdir()
    _, index, _ = write_indexed_web(made)
    assert ARCHIVE([str(made), "-o", str(out), "--no-pictures"]) == 0
    guide = (out / "content" / "README.md").read_text("utf-8")
    lines = [line.split()[1:] for line in guide.splitlines() if line.startswith("    orbitproof verify")]
    assert {line[1] for line in lines} == {"atlas", "index", "web"}
    monkeypatch.chdir(out / "content")
    for line in lines:
        assert verify([*line[1:], "--quiet"]) == 0
    told = (out / "content" / "theorems.md").read_text()
    assert told.count("in the plane 1 and across it 2") == 2
    assert "The index of orbits of a curve" in guide

    monkeypatch.chdir(tmp_path)
    write_certificate(index, forged(retrograde_index().document, lambda d: d["orbits"][0].update(index=9)))
    assert ARCHIVE([str(made), "-o", str(tmp_path / "none"), "--no-pictures"]) == 1
    assert '"dro"' in capsys.readouterr().err
    index.unlink()
    assert ARCHIVE([str(made), "-o", str(tmp_path / "none"), "--no-pictures"]) == 2
    assert "claims the index of dro, and no such certificate" in capsys.readouterr().err
