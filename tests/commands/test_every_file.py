"""Every kind of file through every command that takes files: done or refused, and a refusal names the file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from support.every_kind_of_file import write_every_kind

from orbitproof.explore.__main__ import main as explore
from orbitproof.figures.__main__ import main as figures
from orbitproof.figures.commands.report import main as report
from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.run.row_command import main as verify_rows

Main = Callable[[list[str]], int]
HERE, OUT = "{file}", "{out}"
"""Stand for the file that is tried and for one to write; {copy} is a copy of the first, {folder} that of all files."""

_PROOF = ("--max-precision", "64", "--other-boxes", "0", "--row-timeout", "60", "--quiet", "-o", OUT)
_DRAWN = ("-o", "{pictures}", "--format", "svg")
ORBITS = (
    "candidates certificates families branches periodic-family atlas atlas-certificate tori manifold mass-curve "
    "catalogue catalogue-certificate"
)
COMMANDS: dict[str, tuple[Main, str, tuple[str, ...]]] = {
    "verify": (verify_rows, "", (HERE, *_PROOF)),
    "verify --curve": (verify_rows, "", ("{folder}/claim-fold.json", "--curve", HERE, *_PROOF)),
    "verify --recheck": (verify_rows, "", (HERE, "--recheck", "--quiet")),
    "verify --second-proof": (verify, "", ("--second-proof", HERE)),
    "verify atlas": (verify, "", ("atlas", HERE, "-o", OUT, "--quiet")),
    "verify atlas --recheck": (verify, "", ("atlas", HERE, "--recheck", "--quiet")),
    "verify atlas --bifurcations": (
        verify, "", ("atlas", "{folder}/atlas-falkner-skan.json", "--bifurcations", HERE, "-o", OUT, "--quiet"),
    ),
    "verify catalogue": (verify, "", ("catalogue", HERE, "--curve", "{folder}/rows-curve.json", "-o", OUT, "--quiet")),
    "verify catalogue --curve": (
        verify, "", ("catalogue", "{folder}/catalogue-halo.json", "--curve", HERE, "-o", OUT, "--quiet"),
    ),
    "verify catalogue --recheck": (
        verify, "", ("catalogue", HERE, "--curve", "{folder}/rows-curve.json", "--recheck", "--quiet"),
    ),
    "verify web": (verify, "", ("web", HERE, "--certificates", "{folder}/indexed-dro.json", "-o", OUT, "--quiet")),
    "verify web --certificates": (
        verify, "", ("web", "{folder}/web.json", "--certificates", HERE, "-o", OUT, "--quiet"),
    ),
    "verify web --recheck": (
        verify, "", ("web", HERE, "--certificates", "{folder}/indexed-dro.json", "--recheck", "--quiet"),
    ),
    "verify index": (verify, "", ("index", "--curve", HERE, "-o", OUT, "--quiet")),
    "verify index --recheck": (
        verify, "", ("index", HERE, "--curve", "{folder}/indexed-dro.json", "--recheck", "--quiet"),
    ),
    "report": (report, "", (HERE, "-o", "{pictures}/report.md", "--no-pictures", "--quiet")),
    "figures family": (figures, "candidates", ("family", HERE, *_DRAWN)),
    "figures family ..": (figures, "", ("family", "{folder}/claim-fold.json", HERE, *_DRAWN)),
    "figures family --family": (
        figures, "families", ("family", "{folder}/claim-fold.json", "--family", HERE, *_DRAWN),
    ),
    "figures resonances": (figures, "families", ("resonances", HERE, *_DRAWN)),
    "figures tables": (figures, "certificates", ("tables", HERE, "-o", "{pictures}", "--allow-missing")),
    "figures tables --candidates": (
        figures, "candidates",
        ("tables", "{folder}/figures-certificates.json", "--candidates", HERE, "-o", "{pictures}", "--allow-missing"),
    ),
    "figures tables --published": (
        figures, "published", ("tables", "{folder}/figures-certificates.json", "--published", HERE, "-o", "{pictures}"),
    ),
    "figures atlas": (figures, "", ("atlas", HERE, *_DRAWN)),
    "figures branches": (figures, "branches", ("branches", HERE, *_DRAWN)),
    "figures branches --family": (
        figures, "families", ("branches", "{folder}/branches.json", "--family", HERE, *_DRAWN),
    ),
    "figures catalogue": (figures, "catalogue-certificate", ("catalogue", HERE, *_DRAWN)),
    "figures distances": (figures, "families", ("distances", HERE, *_DRAWN)),
    "figures periodic": (figures, "candidates periodic-family life", ("periodic", HERE, *_DRAWN)),
    "figures tori": (figures, "tori", ("tori", HERE, *_DRAWN)),
    "figures web": (
        figures, "web-certificate", ("web", HERE, "--certificates", "{folder}/indexed-dro.json", *_DRAWN),
    ),
    "figures web --certificates": (
        figures, "", ("web", "{folder}/indexed-web.json", "--certificates", HERE, *_DRAWN),
    ),
    "figures interactive": (figures, "", ("interactive", HERE, "-o", "{pictures}/page.html")),
    "figures interactive --candidates": (
        figures, "",
        ("interactive", "{folder}/figures-halo-family.json", "--candidates", HERE, "-o", "{pictures}/page.html"),
    ),
    "explore trajectory": (explore, ORBITS, ("trajectory", HERE, "-o", "{pictures}/t.csv", "--points", "5")),
    "explore tori": (explore, "", ("tori", HERE, "-o", OUT, "--curves", "1", "--quiet")),
    "explore losses": (explore, "", ("losses", HERE, "-o", OUT, "--quiet")),
    "explore catalogue": (explore, "", ("catalogue", HERE, "-o", OUT, "--quiet")),
    "explore catalogue --from-family": (
        explore, "families", ("catalogue", "--from-family", HERE, "-o", OUT, "--rows", "3", "--quiet"),
    ),
    "explore family --from-family": (
        explore, "families", ("family", "--from-family", HERE, "--max-orbits", "3", "-o", OUT, "--quiet"),
    ),
    "explore family --from-catalogue": (
        explore, "catalogue", ("family", "--from-catalogue", HERE, "--max-orbits", "3", "-o", OUT, "--quiet"),
    ),
    "explore family --from-orbit": (
        explore, "", ("family", "--from-orbit", HERE, "--max-orbits", "3", "-o", OUT, "--quiet"),
    ),
    "explore candidates --from-family": (
        explore, "families", ("candidates", "--from-family", HERE, "-k", "5", "-o", OUT, "--quiet"),
    ),
    "explore orbit --from-family": (
        explore, "families", ("orbit", "--from-family", HERE, "--period", "3", "-o", OUT, "--quiet"),
    ),
    "explore orbit --extrema": (
        explore, "families", ("orbit", "--from-family", HERE, "--extrema", "-o", OUT, "--quiet"),
    ),
    "explore orbit --from-catalogue": (
        explore, "catalogue",
        ("orbit", "--from-catalogue", HERE, "--catalogue-orbit", "1", "--digits", "15", "-o", OUT, "--quiet"),
    ),
    "explore orbit --certificates": (
        explore, "certificates",
        ("orbit", "--from-catalogue", "{folder}/catalogue-halo.json", "--certificates", HERE),
    ),
    "explore periodic --system": (explore, "system", ("periodic", "--system", HERE, "--start", "x=0", "y=0")),
    "explore equilibria --system": (explore, "system", ("equilibria", "--system", HERE, "--start", "x=0", "y=0")),
    "explore periodic --from-branches": (
        explore, "", ("periodic", "--from-branches", HERE, "--digits", "15", "-o", OUT, "--quiet"),
    ),
    "explore refine --system": (
        explore, "system", ("refine", "--system", HERE, "-k", "2", "--point", "x=1", "-o", OUT),
    ),
    "explore atlas --from-family": (
        explore, "", ("atlas", "--from-family", HERE, "--covers", "x", "0.1", "0.2", "-o", OUT, "--quiet"),
    ),
    "explore atlas --check": (explore, "", ("atlas", "--check", HERE, "--quiet")),
    "explore branches": (
        explore, "candidates", ("branches", HERE, "-o", OUT, "--orbits", "4", "--length", "0.01", "--quiet"),
    ),
    "explore refine --append": (
        explore, "candidates",
        ("refine", "--system", "falkner-skan", "-k", "3", "--point", "beta=453", "y=0.93", "--append", "-o", "{copy}"),
    ),
    "explore mass-curve -o": (
        explore, "mass-curve",
        ("mass-curve", "--points", "L1", "--mu-min", "0.0099", "--mu-max", "0.01", "-o", "{copy}", "--quiet"),
    ),
}  # fmt: skip

LONG = {
    ("verify", "candidates"), ("verify --curve", "atlas-certificate"), ("verify atlas", "atlas"),
    ("verify atlas --recheck", "atlas-certificate"), ("verify atlas --bifurcations", "certificates"),
    ("verify catalogue", "catalogue"), ("verify catalogue --curve", "atlas-certificate"),
    ("verify catalogue --recheck", "catalogue-certificate"), ("verify web --certificates", "atlas-certificate"),
    ("verify web --recheck", "web-certificate"), ("verify index", "atlas-certificate"),
    ("verify index --recheck", "index-certificate"), ("verify --second-proof", "certificates"),
    ("explore mass-curve -o", "mass-curve"), ("explore candidates --from-family", "families"),
}  # fmt: skip
"""Commands with files that they prove or check: other tests are about that."""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, str]:
    return write_every_kind(tmp_path_factory.mktemp("files"))


def chosen(files: dict[Path, str], name: str) -> list[Path]:
    """All files of the formats that a command takes, and one of each of the others."""
    takes, one_of_each = COMMANDS[name][1].split(), {kind: path for path, kind in files.items()}
    found = [path for path, kind in files.items() if kind in takes or not kind or one_of_each[kind] == path]
    return [path for path in found if (name, files[path]) not in LONG]


@pytest.mark.parametrize("name", COMMANDS)
def test_a_file_is_taken_or_refused_by_its_name(
    name: str, files: dict[Path, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main, _, words = COMMANDS[name]
    wrong = []
    for number, path in enumerate(chosen(files, name)):
        folder = tmp_path / str(number)
        folder.mkdir()
        before = path.read_bytes()
        copy = folder / path.name
        if "{copy}" in words:
            copy.write_bytes(before)
        places = {"file": path, "copy": copy, "out": folder / "out.json", "pictures": folder, "folder": path.parent}
        try:
            code = main([word.format(**places) for word in words])
        except SystemExit as stopped:
            code = stopped.code if isinstance(stopped.code, int) else -1
        except Exception as error:
            wrong.append(f"{path.name}: {error!r}")
            continue
        output, errors = capsys.readouterr()
        if code not in (0, 1, 2) or "Traceback" in errors + output:
            wrong.append(f"{path.name}: {code}: {errors}")
        elif code == 2 and (errors.count("\n") != 1 or not (path.name in errors or "give its file" in errors)):
            wrong.append(f"{path.name}: refused in these words: {errors}")
        elif code == 1 and not errors + output:
            wrong.append(f"{path.name}: nothing is said")
        elif path.read_bytes() != before:
            wrong.append(f"{path.name}: is changed")
    assert not wrong
