"""Run the notebooks and keep their outputs in them: ``python docs/notebooks.py [NAME ..]`` (``make notebooks``)."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

FOLDER = Path(__file__).resolve().parent
_SECONDS = 1800
_OBJECT = re.compile(r"^<(Figure size .*|IPython\.core\.display\.Image object)>$")
_TEMPORARY = re.compile(r"/\S*/tmp\w+")


def run(path: Path) -> None:
    """Execute a notebook from its first cell on, and write it with its outputs.

    What belongs to the machine is left out: times of execution, numbers of cells, folders.

    Raises:
        CellExecutionError: if a cell fails. The file stays as it is.
    """
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=_SECONDS, resources={"metadata": {"path": str(FOLDER)}}).execute()
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.execution_count = None
            for output in cell.outputs:
                _clean(output)
    path.write_text(nbformat.writes(notebook, indent=1) + "\n", "utf-8")


def _clean(output: nbformat.NotebookNode) -> None:
    if "execution_count" in output:
        output.execution_count = None
    if "text" in output:
        output.text = _TEMPORARY.sub("..", output.text)
    for kind, text in output.get("data", {}).items():
        if kind == "text/plain":
            output.data[kind] = "a picture" if _OBJECT.match(text) else _TEMPORARY.sub("..", text)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 1 if a cell fails."""
    parser = argparse.ArgumentParser(description="Run the notebooks, and keep their outputs in them.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="without the ending (default: all)")
    options = parser.parse_args(arguments)
    failed = 0
    for path in sorted(FOLDER.glob("*.ipynb")):
        if options.names and path.stem not in options.names:
            continue
        try:
            run(path)
        except CellExecutionError as error:
            print(f"{path.name}: {error}", file=sys.stderr)
            failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
