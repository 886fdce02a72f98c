"""One version: of the project, the command, certificates, reports, the citation and the list of changes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

from support.claims import known

from orbitproof import __version__
from orbitproof.figures.commands.report import main
from orbitproof.verify.certificate import Limits, certify, write_certificates

ROOT = Path(__file__).resolve().parents[2]
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]


def test_what_is_installed_is_the_version_of_the_project() -> None:
    assert metadata.version("orbitproof") == __version__ == VERSION, "install the project again"


def test_the_command_says_the_version() -> None:
    command = [sys.executable, "-m", "orbitproof", "--version"]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == f"orbitproof {VERSION}\n"


def test_certificates_and_their_report_carry_the_version(tmp_path: Path) -> None:
    certificate = certify(known("fs2"), Limits(max_precision=256))
    assert certificate.software["orbitproof"] == VERSION
    write_certificates(tmp_path / "rows.json", [certificate])
    assert json.loads((tmp_path / "rows.json").read_text())["software"]["orbitproof"] == VERSION
    for suffix in ("html", "tex", "md"):
        target = tmp_path / f"report.{suffix}"
        assert main([str(tmp_path / "rows.json"), "-o", str(target), "--no-pictures", "--quiet"]) == 0
        text = target.read_text("utf-8")
        assert f"With orbitproof {VERSION} installed" in text.replace("\\", "")
        assert re.search(rf"version\s+= {{{re.escape(VERSION)}}}", text)
        assert certificate.software["source"] in text.replace(r"\allowbreak{}", "")


def test_the_citation_and_the_list_of_changes_name_the_version() -> None:
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.findall(r"^version: (.*)$", citation, re.MULTILINE) == [VERSION]
    assert json.loads((ROOT / "codemeta.json").read_text("utf-8"))["version"] == VERSION
    for page in ("README.md", "docs/site/index.md"):
        assert re.findall(r"^  version = \{(.*)\},$", (ROOT / page).read_text("utf-8"), re.MULTILINE) == [VERSION]
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    assert re.findall(r"^## (\S+)", changes, re.MULTILINE)[0] == VERSION
