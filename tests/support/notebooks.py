"""Notebooks, run cell by cell without a notebook."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any


def cells_of(path: Path) -> list[dict[str, Any]]:
    """The cells with code."""
    return [cell for cell in json.loads(path.read_text("utf-8"))["cells"] if cell["cell_type"] == "code"]


def stored_text(path: Path) -> str:
    """All text that the stored outputs show."""
    outputs = [output for cell in cells_of(path) for output in cell["outputs"]]
    texts = [output.get("text", output.get("data", {}).get("text/plain", "")) for output in outputs]
    return "\n".join("".join(text) for text in texts)


def run_notebook(path: Path) -> list[object]:
    """Run the cells as a notebook does; returns the last expression of every cell that ends in one."""
    names: dict[str, object] = {}
    shown: list[object] = []
    for cell in cells_of(path):
        body = ast.parse("".join(cell["source"])).body
        last = body.pop() if isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), path.name, "exec"), names)
        if last is not None:
            shown.append(eval(compile(ast.Expression(last.value), path.name, "eval"), names))
    return shown
