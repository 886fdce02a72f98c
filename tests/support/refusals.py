"""Commands that refuse what they are given."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def refused(main: Callable[[list[str]], int], arguments: list[str], capsys: Any, code: int = 2) -> str:
    """The one line that a command writes to stderr; fails unless it ends with that code and prints nothing else."""
    try:
        found = main(arguments)
    except SystemExit as stopped:
        found = stopped.code if isinstance(stopped.code, int) else 1
    output, errors = capsys.readouterr()
    assert (found, output) == (code, ""), errors
    assert len(errors.splitlines()) == 1, errors
    assert "Traceback" not in errors
    return str(errors)
