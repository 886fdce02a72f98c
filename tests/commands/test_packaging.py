"""What is installed: one package, all of it, found where it is looked for, with its extras named where they miss."""

from __future__ import annotations

import os
import re
import runpy
import shutil
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
from support.claims import known

from orbitproof.shared import write_candidates
from orbitproof.shared.sources import source_digests
from orbitproof.verify.evidence import ON_WHICH_NOTHING_RESTS

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("shared", "explore", "verify", "figures", "formal")
DATA = {".json", ".mplstyle", ".pyi", ".md", ".typed", ".bib", ".html", ".tex", ".v", ".sh"}


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sources that make a wheel, elsewhere."""
    folder = tmp_path_factory.mktemp("copy") / "orbitproof"
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for room in ROOMS:
        shutil.copytree(ROOT / room, folder / room, ignore=ignored)
    (folder / "src" / "orbitproof").mkdir(parents=True)
    for path in (ROOT / "src" / "orbitproof").iterdir():
        if path.is_file():
            shutil.copy(path, folder / "src" / "orbitproof")
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.fixture(scope="module")
def wheel(copy: Path) -> Path:
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*command, "-w", str(copy / "dist"), str(copy)], check=True, capture_output=True, text=True)
    (path,) = (copy / "dist").glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the wheel is unpacked, as in site-packages."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def sources(folder: Path) -> set[str]:
    """The Python files and the data of a package tree, as paths below it."""
    return {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and (path.suffix == ".py" or path.suffix in DATA) and "__pycache__" not in path.parts
    }


def test_a_wheel_lands_one_package_and_nothing_generic(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.split("/")[0] for name in names} == {
        "orbitproof",
        f"orbitproof-{metadata.version('orbitproof')}.dist-info",
    }


def test_a_wheel_holds_every_source_and_every_file_of_data(installed: Path) -> None:
    for room in ROOMS:
        missing = sources(ROOT / room) - sources(installed / "orbitproof" / room) - {"alone/sitecustomize.py"}
        assert not missing, room
    for example in ("figures/style/orbitproof.mplstyle", "explore/__init__.pyi", "verify/curve/README.md",
                    "shared/schemas/candidates.schema.json", "figures/tables/published.json",
                    "figures/report/templates/report.tex", "py.typed"):  # fmt: skip
        assert (installed / "orbitproof" / example).is_file(), example


def packages_of(folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The list that setup.py hands to setuptools."""
    found: dict[str, list[str]] = {}
    monkeypatch.setattr("setuptools.setup", lambda **options: found.update(options))
    runpy.run_path(str(folder / "setup.py"))
    return found["packages"]


def test_a_new_folder_is_installed_and_one_without_init_is_noticed(
    copy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = shutil.copytree(copy, tmp_path / "other", ignore=shutil.ignore_patterns("dist", "build"))
    (other / "verify" / "curve" / "deeper").mkdir()
    (other / "verify" / "curve" / "deeper" / "module.py").write_text("")
    assert set(packages_of(other, monkeypatch)) == set(packages_of(copy, monkeypatch))
    assert without_init(other) == {"verify/curve/deeper"}
    (other / "verify" / "curve" / "deeper" / "__init__.py").write_text("")
    assert set(packages_of(other, monkeypatch)) - set(packages_of(copy, monkeypatch)) == {
        "orbitproof.verify.curve.deeper"
    }
    assert without_init(other) == set()


def without_init(folder: Path) -> set[str]:
    """Folders with Python files that are no packages."""
    folders = {path.parent for room in ROOMS for path in (folder / room).rglob("*.py")}
    return {
        path.relative_to(folder).as_posix() for path in folders if not (path / "__init__.py").is_file()
    } - {"verify/alone"}  # fmt: skip


def test_every_folder_of_python_files_is_a_package_that_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert without_init(ROOT) == set()
    folders = {path.parent for room in ROOMS for path in (ROOT / room).rglob("__init__.py")}
    names = {".".join(("orbitproof", *folder.relative_to(ROOT).parts)) for folder in folders}
    assert set(packages_of(ROOT, monkeypatch)) == names | {"orbitproof"}


def test_the_digest_of_the_sources_covers_every_level(copy: Path, tmp_path: Path) -> None:
    verify = shutil.copytree(copy / "verify", tmp_path / "verify")
    before = source_digests([("verify", verify)], ())
    for place in ("more.py", "curve/more.py", "curve/deeper/more.py"):
        (verify / place).parent.mkdir(exist_ok=True)
        (verify / place).write_text("value = 1\n")
        after = source_digests([("verify", verify)], ())
        assert after != before, place
        before = after


SHARED = ("claims/atlas.py", "formats/atlas.py", "systems/system.py", "numbers.py", "codec.py", "stored.py")
MOVED_ONLY = ("oracle/more.py", "words/more.py", "run/more.py", "run/rows.py", "second_proof/more.py", "scripting.py")


@pytest.mark.parametrize("package", ["verify", "shared"])
def test_the_digest_of_a_proof_covers_what_it_rests_on_and_nothing_else(
    package: str, copy: Path, tmp_path: Path
) -> None:
    folder = shutil.copytree(copy / package, tmp_path / package)
    before = source_digests([(package, folder)], ON_WHICH_NOTHING_RESTS, ())
    rooms = [path.name for path in folder.iterdir() if path.is_dir() and (path / "__init__.py").exists()]
    known = {place.split("/")[1] for place in ON_WHICH_NOTHING_RESTS if place.startswith(package)}
    rests = [f"{room}/more.py" for room in rooms if room not in known] if package == "verify" else list(SHARED)
    assert len(rests) > 5
    moved = MOVED_ONLY if package == "verify" else ("processes.py", "interrupts.py", "wording.py")
    for place in (*rests, *moved):
        file = folder / place
        file.write_text((file.read_text("utf-8") if file.exists() else "") + "value = 1\n", "utf-8")
        after = source_digests([(package, folder)], ON_WHICH_NOTHING_RESTS, ())
        assert (after[0] != before[0]) == (place in rests), place
        assert after[1] != before[1], place
        before = after


def test_what_nothing_rests_on_is_there(copy: Path) -> None:
    for place in ON_WHICH_NOTHING_RESTS:
        assert (copy / place).exists(), place


def run(folder: Path, site: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A command where the wheel is installed, outside the checkout, whose package is not on the path."""
    start = f"import sys, runpy; sys.path[:] = [{str(site)!r}, *(p for p in sys.path if p != {str(ROOT / 'src')!r})]"
    code = f"{start}; sys.argv = {['orbitproof', *words]!r}; runpy.run_module('orbitproof', run_name='__main__')"
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "JAX_PLATFORMS": "cpu", **environment},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_an_installed_wheel_proves_with_worker_processes_outside_the_checkout(installed: Path, tmp_path: Path) -> None:
    write_candidates(tmp_path / "claims.json", [known("fs2")])
    for name in ROOMS:
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the module of the user was imported')\n")
    words = ("verify", "claims.json", "-o", "certificates.json", "--jobs", "2", "--quiet")
    result = run(tmp_path, installed, *words, PYTHONPATH=f"{installed}{os.pathsep}{ROOT / 'verify' / 'alone'}")
    assert result.returncode == 0, result.stderr
    assert "proved" in result.stdout
    where = "import orbitproof.verify; print(orbitproof.verify.__file__)"
    place = subprocess.run(
        [sys.executable, "-c", where],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert place.stdout.startswith(str(installed))


BLOCKER = """\
import sys
class Missing:
    def find_spec(self, fullname, path=None, target=None):
        if fullname.partition(".")[0] in {names!r}:
            raise ModuleNotFoundError(f"No module named {{fullname!r}}", name=fullname)
sys.meta_path.insert(0, Missing())
"""


@pytest.mark.parametrize(
    ("missing", "words", "extra"),
    [
        ("jax", ["-m", "orbitproof", "explore", "family", "--system", "falkner-skan", "-o", "f.json"], "explore"),
        ("diffrax", ["-m", "orbitproof.explore", "mass-curve", "--points", "L1", "-o", "f.json"], "explore"),
        ("mpmath", ["-m", "orbitproof.explore", "candidates", "--system", "falkner-skan", "-o", "f.json"], "explore"),
        ("ccsds_ndm", ["-m", "orbitproof", "explore", "trajectory", "claims.json", "--oem", "o.oem"], "oem"),
        (
            "spiceypy",
            ["-m", "orbitproof", "explore", "trajectory", "claims.json", "--frame", "inertial", "--spk", "o.bsp"],
            "spk",
        ),
        ("plotly", ["-m", "orbitproof", "figures", "interactive", "claims.json", "-o", "a.html"], "interactive"),
        ("matplotlib", ["-m", "orbitproof", "figures", "family", "claims.json", "-o", "out"], "figures"),
        ("matplotlib", ["-m", "orbitproof.figures", "family", "claims.json", "-o", "out"], "figures"),
    ],
)
def test_a_missing_extra_is_one_line_with_the_command_that_installs_it(
    missing: str, words: list[str], extra: str, tmp_path: Path
) -> None:
    (tmp_path / "sitecustomize.py").write_text(BLOCKER.format(names={missing}))
    write_candidates(tmp_path / "claims.json", [known("fs2")])
    result = subprocess.run(
        [sys.executable, *words],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "JAX_PLATFORMS": "cpu"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert result.returncode == 2, result.stderr
    assert result.stderr.splitlines()[-1] == f"error: {missing} is not installed: pip install 'orbitproof[{extra}]'"
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize("room", ["explore", "verify", "figures"])
@pytest.mark.parametrize("module", [False, True])
def test_usage_names_the_command(room: str, module: bool) -> None:
    words = ["-m", f"orbitproof.{room}"] if module else ["-m", "orbitproof", room]
    result = subprocess.run([sys.executable, *words, "--help"], capture_output=True, text=True, timeout=120, check=True)
    assert re.match(rf"usage: orbitproof {room} ", result.stdout)


def test_help_of_the_verifier_names_the_commands_for_certificates_and_for_atlases() -> None:
    words = ["-m", "orbitproof", "verify", "--help"]
    result = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=120, check=True)
    for words in ("atlas --help", "web --help", "index --help", "catalogue --help", "--second-proof"):
        assert f"orbitproof verify {words}" in result.stdout
