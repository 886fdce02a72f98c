"""The proof side stands alone: it imports nothing of the search side, statically or when it runs."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SEARCH_SIDE = {"explore", "figures", "jax", "jaxlib", "diffrax", "equinox", "mpmath", "matplotlib", "scipy", "sympy"}
MODULES = sorted(path for package in ("shared", "verify") for path in (ROOT / package).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """Top-level names of everything that a module imports, wherever in the file."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.add((node.module or "").split(".")[0])
    return names


@pytest.mark.parametrize("path", MODULES, ids=[str(path.relative_to(ROOT)) for path in MODULES])
def test_no_module_of_the_proof_side_imports_the_search_side(path: Path) -> None:
    found = imported(path)
    assert not found & SEARCH_SIDE
    if path.parent.name == "shared":
        assert "verify" not in found


def test_imports_of_the_proof_side_are_its_dependencies_and_the_standard_library() -> None:
    allowed = {"shared", "verify", "flint", "numpy", "jsonschema", "rich"} | set(sys.stdlib_module_names)
    assert {name for path in MODULES for name in imported(path)} <= allowed


def test_the_verifier_runs_where_the_search_side_cannot_be_imported() -> None:
    code = f"""
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {SEARCH_SIDE!r}:
            raise ImportError(name)
sys.meta_path.insert(0, Blocked())
import verify.__main__, verify.poincare, verify.workers
assert not {SEARCH_SIDE!r} & {{name.split(".")[0] for name in sys.modules}}
try:
    import mpmath
except ImportError:
    verify.__main__.main(["--help"])
"""
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "python -m verify" in run.stdout
