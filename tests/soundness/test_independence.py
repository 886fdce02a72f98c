"""The proof side stands alone: it imports nothing of the search side, statically or when it runs."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SEARCH_SIDE = {"explore", "figures", "jax", "jaxlib", "diffrax", "equinox", "mpmath", "matplotlib", "scipy", "sympy"}
MODULES = sorted(path for package in ("shared", "verify") for path in (ROOT / package).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """What a module imports, wherever in the file: rooms of this package, top-level names of others."""
    modules: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            # The second proof imports from its own folder only, which its tests hold.
            assert node.level == int("second_proof" in path.parts) or not node.level, f"{path}: relative import"
            modules |= {f"{node.module}.{alias.name}" for alias in node.names if not node.level}
    return {module.removeprefix("orbitproof.").split(".")[0] for module in modules}


@pytest.mark.parametrize("path", MODULES, ids=[str(path.relative_to(ROOT)) for path in MODULES])
def test_no_module_of_the_proof_side_imports_the_search_side(path: Path) -> None:
    found = imported(path)
    assert not found & SEARCH_SIDE
    if path.is_relative_to(ROOT / "shared"):
        assert "verify" not in found


_GUESSES = ("orbitproof.verify.oracle", "orbitproof.verify.attempt")


def test_what_runs_proves_nothing_itself() -> None:
    """What encloses takes an oracle; the room whose sources no proof names (10.2) hands none to a chapter."""
    found = set()
    for path in (ROOT / "verify" / "run").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and str(node.module).startswith(_GUESSES):
                found |= {alias.name for alias in node.names}
    assert found == {"Limits", "first_precision", "box_asked_for", "steps_about"}


def test_sub_packages_are_looked_at_too() -> None:
    folders = {path.parent.relative_to(ROOT).parts for path in MODULES}
    assert {("shared", "systems"), ("verify", "algebra"), ("verify", "curve")} <= folders


def test_imports_of_the_proof_side_are_its_dependencies_and_the_standard_library() -> None:
    libraries = {"flint", "numpy", "jsonschema", "jsonschema_rs", "rich"}
    allowed = {"__version__", "shared", "verify", *libraries, *sys.stdlib_module_names}
    assert {name for path in MODULES for name in imported(path)} <= allowed


def test_the_verifier_runs_where_the_search_side_cannot_be_imported() -> None:
    code = f"""
import sys
import orbitproof.verify.__main__, orbitproof.verify.run.row_command, orbitproof.verify.run.branch_command
assert not {SEARCH_SIDE!r} & {{name.removeprefix("orbitproof.").split(".")[0] for name in sys.modules}}
for name in {sorted(SEARCH_SIDE | {"orbitproof.explore", "orbitproof.figures"})!r}:
    try:
        __import__(name)
    except ImportError as error:
        assert "must not import" in str(error), name
    else:
        sys.exit(name + " could be imported")
orbitproof.verify.__main__.main(["--help"])
"""
    run = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(ROOT / "verify" / "alone")},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "orbitproof verify" in run.stdout
