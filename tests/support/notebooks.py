"""Notebooks, run cell by cell without a notebook."""

from __future__ import annotations

import ast
import json
from pathlib import Path


def run_notebook(path: Path) -> list[object]:
    """Run the cells as a notebook does; returns the last expression of every cell that ends in one."""
    names: dict[str, object] = {}
    shown: list[object] = []
    for cell in json.loads(path.read_text("utf-8"))["cells"]:
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"] == []
        body = ast.parse("".join(cell["source"])).body
        last = body.pop() if isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), path.name, "exec"), names)
        if last is not None:
            shown.append(eval(compile(ast.Expression(last.value), path.name, "eval"), names))
    return shown
