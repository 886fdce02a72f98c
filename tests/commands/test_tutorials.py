"""Every block of the tutorials runs and prints what it shows; every cell of the notebooks runs."""

from __future__ import annotations

import ast
import re
import shlex
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from support.notebooks import cells_of, run_notebook, stored_text
from support.runs import done_here

DOCS = Path(__file__).resolve().parents[2] / "docs"
BLOCK = re.compile(r"^```(\w+)[ ]?(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
EXIT = "exit="


# The notebook below does from Python what the second page does.
@pytest.mark.parametrize("page", ["own-system", pytest.param("from-a-guess", marks=pytest.mark.slow)])
def test_every_block_of_a_tutorial_runs_and_prints_what_it_shows(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    printed = ""
    blocks = BLOCK.findall((DOCS / f"{page}.md").read_text("utf-8"))
    assert [language for language, _, _ in blocks].count("sh") >= 4
    for language, name, text in blocks:
        if name and not name.startswith(EXIT):
            (tmp_path / name).write_text(text, "utf-8")
        elif language in ("console", "math"):
            continue
        elif language == "text":
            for line in text.splitlines():
                assert line in printed
        else:
            printed = ""
            code = int(name.removeprefix(EXIT) or 0)
            if language == "python":
                words = [sys.executable, "-c", text]
                done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
                assert done.returncode == code, done.stderr
                printed = done.stdout
                continue
            for line in text.splitlines():
                program, *words = shlex.split(line)
                assert program == "orbitproof"
                found = done_here(words)
                output, errors = capsys.readouterr()
                assert found == code, errors
                printed += output


NOTEBOOKS = {
    "certificates": ["stands INTEGRATION", "DOES NOT STAND", "**Theorem 1**"],
    "from-a-guess-in-python": [
        "11.6",
        "period doubling (k = 2), proved, below, C = 3.0216193266007",
        "stands - integrated again",
    ],
    "periodic-orbit-of-lorenz": [
        "period [1.5586522107161747",
        "there is no zero in the set",
        "multiplier [4.7129472",
        "x = centre + ",
    ],
    "mission-design": ["6.649 days", "read back to 1.0 m", "6 of 6 orbits reach x = 0.98785"],
    "own-system-in-python": [
        "not reversible under R",
        "touch-and-go (k = 3), proved, both, c = 0.27634323081200157",
        "k3-1 stands",
    ],
}


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_every_cell_of_a_notebook_runs(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    shown = run_notebook(DOCS / f"{name}.ipynb")
    plt.close("all")
    printed = capsys.readouterr().out + "\n".join(map(repr, shown))
    for words in NOTEBOOKS[name]:
        assert words in printed


def test_notebooks_have_their_outputs_with_pictures_and_nothing_of_a_machine() -> None:
    for name, words in (
        NOTEBOOKS | {"first-proof": ["period doubling (k = 2), proved, below, beta = 340.1875349891"]}
    ).items():
        path = DOCS / f"{name}.ipynb"
        text = stored_text(path)
        assert all(each in text for each in words), name
        assert "image/png" in path.read_text("utf-8"), name
        assert path.stat().st_size < 600_000, name
        for cell in cells_of(path):
            assert cell["outputs"] or not isinstance(ast.parse("".join(cell["source"])).body[-1], ast.Expr), name
            assert not any(output["output_type"] == "error" for output in cell["outputs"]), name


@pytest.mark.slow
@pytest.mark.parametrize("page", sorted((DOCS / "coming-from").glob("*.md")), ids=lambda path: path.stem)
def test_what_pages_for_users_of_other_programs_print_runs(page: Path, tmp_path: Path) -> None:
    blocks = [text for language, _, text in BLOCK.findall(page.read_text("utf-8")) if language == "python"]
    commands = re.findall(r"^ {4}orbitproof (.*)$", page.read_text("utf-8"), re.MULTILINE)
    assert blocks or commands
    for words in [*(["-c", text] for text in blocks), *(["-m", "orbitproof", *shlex.split(line)] for line in commands)]:
        done = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_no_notebook_is_left_out() -> None:
    # The first proof is run with the Python face.
    assert {path.stem for path in DOCS.glob("*.ipynb")} == {*NOTEBOOKS, "first-proof"}
