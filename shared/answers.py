"""What a command prints of its results: text for people or, with ``--json``, one document for programs.

The document stands on standard output at the end of the command::

    {"command": "orbitproof explore orbit", "exit_code": 0, "files": ["orbit.json"], "results": [{"id": ..}]}

There is one whatever was found, also after an interrupt (`exit_code` 130, with the results so far), and none for bad
input (exit code 2). Messages and errors stand on standard error, as ever.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from fractions import Fraction
from math import isfinite
from numbers import Complex, Integral, Real
from pathlib import Path
from typing import Any

from orbitproof.shared.output import written_files

_BAD_INPUT = 2
_results: ContextVar[list[Any] | None] = ContextVar("results", default=None)


def add_json_option(parser: argparse.ArgumentParser) -> None:
    """``--json``, of every command."""
    parser.add_argument("--json", action="store_true", help="print the results as one JSON document, and no text")


def tell(text: str, results: Sequence[Any] = ()) -> None:
    """Print the text on standard output; under ``--json`` keep the results for the document instead.

    Args:
        results: what the text says, for programs: mappings, sequences, texts, numbers. What JSON has no number for,
            an infinity say, becomes ``null``, a complex number the list of its two parts, a fraction its text.
    """
    kept = _results.get()
    if kept is not None:
        kept += results
    elif text:
        print(text, flush=True)


def answered(command: str, as_json: bool, run: Callable[[], int]) -> int:
    """The exit code of `run`; `as_json`: what it tells is printed as the document of this command at its end."""
    if not as_json:
        return run()
    token = _results.set([])
    try:
        code = run()
        results = _results.get()
    finally:
        _results.reset(token)
    if code != _BAD_INPUT:
        files = [str(path) for path in written_files()]
        document = {"command": command, "exit_code": code, "files": files, "results": _plain(results)}
        print(json.dumps(document, indent=1, allow_nan=False), flush=True)
    return code


def _plain(value: Any) -> Any:
    """A value as JSON has it."""
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, Mapping):
        return {str(name): _plain(entry) for name, entry in value.items()}
    if isinstance(value, (Fraction, Path)):
        return str(value)
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value) if isfinite(value) else None
    if isinstance(value, Complex):
        return [_plain(value.real), _plain(value.imag)]
    return [_plain(entry) for entry in value]
