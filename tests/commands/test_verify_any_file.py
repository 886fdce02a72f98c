"""What a file holds decides which command checks it; options and their files do not."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from orbitproof.verify import __main__ as command

FORMATS = {
    "candidates": "row_command",
    "certificates": "row_command",
    "atlas": "branch_command",
    "atlas-certificate": "branch_command",
    "web": "web_command",
    "web-certificate": "web_command",
    "life-claim": "life_command",
    "life-certificate": "life_command",
    "index-certificate": "index_command",
    "catalogue-certificate": "catalogue_command",
}


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The commands that were handed something."""
    found: list[str] = []

    def load(name: str) -> SimpleNamespace:
        def main(words: list[str]) -> int:
            found.append(name.rpartition(".")[2])
            return 0

        return SimpleNamespace(main=main)

    monkeypatch.setattr(command, "import_module", load)
    return found


def written(folder: Path, name: str) -> Path:
    path = folder / f"{name}.json"
    path.write_text(json.dumps({"format": f"orbitproof-{name}"}))
    return path


@pytest.mark.parametrize(("name", "wanted"), FORMATS.items())
def test_a_file_goes_to_the_command_of_its_format(name: str, wanted: str, tmp_path: Path, asked: list[str]) -> None:
    file, other = written(tmp_path, name), written(tmp_path, "atlas-certificate")
    row = written(tmp_path, "candidates")
    for words in ([file], ["--recheck", file], [file, "--curve", other], ["--curve", other, file, "-o", row]):
        assert command.main([*map(str, words)]) == 0
    assert asked == [wanted] * 4


@pytest.mark.parametrize("name", ["atlas", "web", "life", "index", "catalogue"])
def test_a_command_that_is_named_gets_the_file_whatever_it_is(name: str, tmp_path: Path, asked: list[str]) -> None:
    command.main([name, str(written(tmp_path, "candidates"))])
    command.main([name, "--help"])
    assert len(set(asked)) == 1
    assert asked[0] != "row_command"


def test_what_cannot_be_read_is_told_by_the_command_for_rows(tmp_path: Path, asked: list[str]) -> None:
    broken, folder = tmp_path / "broken.json", tmp_path / "folder.json"
    broken.write_text("{")
    folder.mkdir()
    for word in (broken, folder, tmp_path / "missing.json", "--help"):
        command.main([str(word)])
    assert asked == ["row_command"] * 4


def test_a_second_proof_is_asked_for_wherever_the_option_stands(tmp_path: Path, asked: list[str]) -> None:
    file = str(written(tmp_path, "certificates"))
    command.main(["--second-proof", file])
    command.main([file, "--second-proof"])
    assert asked == ["second_proofs"] * 2
