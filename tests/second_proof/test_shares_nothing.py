"""The second proof imports nothing but the standard library, flint and itself, and stays small."""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from itertools import chain
from pathlib import Path

from orbitproof.verify import second_proof

SOURCES = sorted(Path(second_proof.__file__).parent.glob("*.py"))


def test_imports_only_the_standard_library_and_flint() -> None:
    for source in SOURCES:
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level in (0, 1), f"{source.name}: an import from outside the folder"
                names = [] if node.level == 1 else [node.module or ""]
            else:
                continue
            for name in names:
                root = name.split(".")[0]
                assert root == "flint" or root in sys.stdlib_module_names, f"{source.name}: {name}"


def test_nothing_is_evaluated_as_python() -> None:
    for source in SOURCES:
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Name):
                assert node.id not in {"eval", "exec", "compile", "__import__"}, source.name


def lines_of_code(text: str) -> int:
    """Lines with code: without blank lines, comments and docstrings."""
    skipped: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef) and ast.get_docstring(node) is not None:
            first = node.body[0]
            skipped |= set(range(first.lineno, (first.end_lineno or first.lineno) + 1))
    blank = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
    used: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in blank:
            used |= set(range(token.start[0], token.end[0] + 1))
    return len(used - skipped)


def test_it_stays_small() -> None:
    lines = {source.name: lines_of_code(source.read_text(encoding="utf-8")) for source in SOURCES}
    alone = {limit: sum(lines.pop(name) for name in names) for limit, names in OF_ORBITS.items()}
    on_level = lines.pop("fixed_level.py")
    assert sum(lines.values()) < LIMIT
    assert on_level < LIMIT_ON_LEVEL
    assert all(size < limit for limit, size in alone.items()), alone


OF_ORBITS = {
    570: ("periodic_statement.py", "legs.py", "newton.py", "periodic.py", "multipliers.py", "claims.py"),
    260: ("periodic_bifurcation.py",),
    180: ("periodic_torus.py",),
    540: ("halves.py", "births.py", "full_return.py", "symmetric_orbit.py"),
    70: ("elliptic_tori.py",),
    350: ("equilibria.py", "hopf_points.py"),
    360: ("equilibrium_curves.py", "equilibrium_curve_statement.py"),
}
"""Nothing of these is read for a bifurcation of symmetric orbits; with the lines that they may have."""
LIMIT, LIMIT_ON_LEVEL = 830, 70


def test_bifurcations_are_proved_without_what_is_about_orbits() -> None:
    for source in SOURCES:
        if source.name not in (*chain(*OF_ORBITS.values()), "__init__.py"):
            tree = ast.parse(source.read_text(encoding="utf-8"))
            used = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
            assert not used & {name.removesuffix(".py") for name in chain(*OF_ORBITS.values())}, source.name
