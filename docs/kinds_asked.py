"""Counts the lines that ask which kind of theorem, claim, piece or result they have: ``python docs/kinds_asked.py``.

A line counts if it compares ``.kind`` of something (``==``, ``!=``, ``in``, ``not in``), or asks ``isinstance`` with a
class that stands for some kinds only: a claim, a piece, a theorem, what is enclosed or proved of a claim or found on an
interval, the certificate or conclusion of it. What is asked of a kind (`KIND`, a property of the claim) does not count.
Tests are not looked at. ``--list`` prints the lines.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("shared", "verify", "explore", "figures", "formal", "src")
OF_SOME_KINDS = re.compile(
    r"\w+(Theorem|Candidate|Claim|Atlas|Piece|Results?|Enclosures|Conclusion|Document|Statement|Kind|Certificate)"
    r"|(Candidate|InSection|BoxClaim|Atlas|Piece|Web|IndexAlong|CatalogueRows|Claim)"
    r"|Periodic(Orbit|Bifurcation)|Equilibrium|HopfPoint|Certified\w+|Checked\w+"
)
"""Names of such classes."""


def lines_of(path: Path) -> Iterator[int]:
    """The numbers of the lines that ask, each once."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Compare):
            asks = [type(each) in (ast.Eq, ast.NotEq, ast.In, ast.NotIn) for each in node.ops]
            sides = [node.left, *node.comparators]
            if any(asks) and any(isinstance(each, ast.Attribute) and each.attr == "kind" for each in sides):
                yield node.lineno
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "isinstance":
            names = {each.id for each in ast.walk(node.args[1]) if isinstance(each, ast.Name)}
            names |= {each.attr for each in ast.walk(node.args[1]) if isinstance(each, ast.Attribute)}
            if any(OF_SOME_KINDS.fullmatch(name) for name in names):
                yield node.lineno


def main() -> None:
    """Print how many there are, by room."""
    total = 0
    for room in ROOMS:
        files = sorted((ROOT / room).rglob("*.py"))
        found = [(path, line) for path in files for line in sorted(set(lines_of(path)))]
        total += len(found)
        print(f"{room:8} {len(found):4}")
        if "--list" in sys.argv:
            for path, line in found:
                print(f"  {path.relative_to(ROOT)}:{line}: {path.read_text().splitlines()[line - 1].strip()}")
    print(f"in all   {total:4}")


if __name__ == "__main__":
    main()
