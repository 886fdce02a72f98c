"""The archive of certificates: a guide with every certificate and its digest, and no archive of what does not stand."""

from __future__ import annotations

import hashlib
import json
import runpy
import tarfile
from pathlib import Path

import pytest
from support.claims import known

from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.certificate import Limits, certify, write_certificates

ROOT = Path(__file__).resolve().parents[2]
ARCHIVE = runpy.run_path(str(ROOT / "docs" / "archive.py"))["main"]


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
