"""Pictures, tables, pages and reports from Python: the files that the commands write, and the same refusals."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.claims import known

from orbitproof import figures, shared, verify
from orbitproof.figures.__main__ import main
from orbitproof.figures.commands.report import main as report
from orbitproof.shared import InputError


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A claim and its certificate."""
    folder = tmp_path_factory.mktemp("files")
    claim = known("fs2")
    candidates, certificates = folder / "candidates.json", folder / "certificates.json"
    shared.write_candidates(candidates, [claim])
    verify.write(certificates, verify.certify(claim, quiet=True))
    return candidates, certificates


def same_files(left: Path, right: Path) -> bool:
    names = [sorted(path.name for path in folder.iterdir()) for folder in (left, right)]
    return names[0] == names[1] and all((left / name).read_bytes() == (right / name).read_bytes() for name in names[0])


def test_a_picture_is_the_one_of_the_command(files: tuple[Path, Path], tmp_path: Path) -> None:
    told: list[Path] = []
    how = figures.Files(formats=("svg",), width=6.0)
    paths = figures.draw_family(files[0], tmp_path / "here", certificates=str(files[1]), files=how, told=told.append)
    assert [path.suffix for path in paths] == [".svg"]
    assert paths == told
    words = ["family", *map(str, files), "-o", str(tmp_path / "there"), "--format", "svg", "--width", "6", "--quiet"]
    assert main(words) == 0
    assert same_files(tmp_path / "here", tmp_path / "there")


def test_tables_are_values_and_files(files: tuple[Path, Path], tmp_path: Path) -> None:
    (table,) = figures.tables_of([files[1]], candidates=[files[0]])
    assert table.system.name == "falkner-skan"
    paths = figures.write_tables([table], tmp_path / "here", digits=20)
    assert {path.suffix for path in paths} == {".txt", ".md", ".csv", ".tex"}
    words = ["tables", str(files[1]), "--candidates", str(files[0]), "-o", str(tmp_path / "there"), "--digits", "20"]
    assert main([*words, "--allow-missing", "--quiet"]) == 0
    assert same_files(tmp_path / "here", tmp_path / "there")


def test_a_report_is_the_one_of_the_command(files: tuple[Path, Path], tmp_path: Path) -> None:
    found = figures.write_report([files[1]], tmp_path / "here.md", pictures=False, quiet=True)
    assert (found.proved, found.told, [path.name for path in found.paths]) == (1, 1, ["here.md"])
    assert report([str(files[1]), "-o", str(tmp_path / "there.md"), "--no-pictures", "--quiet"]) == 0
    assert (tmp_path / "here.md").read_text() == (tmp_path / "there.md").read_text()


def test_a_certificate_that_does_not_stand_is_refused(files: tuple[Path, Path], tmp_path: Path) -> None:
    forged = tmp_path / "forged.json"
    forged.write_text(files[1].read_text().replace('"side": "above"', '"side": "below"').replace('"k": 2', '"k": 4'))
    with pytest.raises(figures.Refused) as refused:
        figures.write_report([forged], tmp_path / "report.md", quiet=True)
    assert not refused.value.rechecks[0][1].stands
    assert not (tmp_path / "report.md").exists()


def test_what_cannot_be_is_refused_in_a_line(files: tuple[Path, Path], tmp_path: Path) -> None:
    for change in ({"dpi": 7}, {"width": 1.0}, {"formats": ("gif",)}):
        with pytest.raises(InputError, match="give "):
            figures.Files(**change)
    with pytest.raises(InputError, match="is a file; give the path of a folder"):
        figures.draw_family(files[0], files[1])
    with pytest.raises(InputError, match="need their candidates"):
        figures.draw_resonances([], tmp_path, certificates=files[1])
    with pytest.raises(InputError, match="are not in space; give one of cr3bp"):
        figures.write_page(files[0], tmp_path / "page.html")
    with pytest.raises(AttributeError, match="it has Drawn, Files"):
        figures.draw_everything  # noqa: B018
