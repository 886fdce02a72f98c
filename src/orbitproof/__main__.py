"""The command ``orbitproof``: hands over to one of its rooms."""

from __future__ import annotations

import importlib
import os
import sys

from orbitproof import __version__
from orbitproof.shared.interrupts import run_command
from orbitproof.shared.misspelt import meant

_COMMANDS = {
    "explore": ("explore.__main__", "find families, bifurcations and branches; write candidates and atlases"),
    "verify": (
        "verify.__main__",
        "prove candidates (verify FILE) and whole branches (verify atlas FILE); check certificates again",
    ),
    "figures": ("figures.__main__", "draw families, branches, certificates; set tables"),
    "report": ("figures.commands.report", "tell what certificates prove, as HTML, LaTeX or Markdown"),
    "doctor": ("doctor", "say what is installed, and make a small proof"),
}
"""The module of each command, and what the command does."""


def main() -> int:
    """Run the command line; returns the exit code, the same for all commands; see `_help`."""
    return run_command(_run)


def _run() -> int:
    if "_ARGCOMPLETE" in os.environ:
        from orbitproof.completion import complete

        complete({name: module for name, (module, _) in _COMMANDS.items()})
        return 0
    arguments = sys.argv[1:]
    name = arguments[0] if arguments else "--help"
    if name in ("-h", "--help"):
        print(_help())
        return 0
    if name == "--version":
        print(f"orbitproof {__version__}")
        return 0
    if name not in _COMMANDS:
        known = ", ".join(_COMMANDS)
        print(f"error: {name}: there is no such command; there are {known}{meant(name, _COMMANDS)}", file=sys.stderr)
        return 2
    if name in ("explore", "verify", "doctor"):
        # The matrices are small, and processes of a single thread can be copied (shared/processes.py).
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    room = importlib.import_module(f"orbitproof.{_COMMANDS[name][0]}")
    code: int = room.main(arguments[1:])
    return code


def _help() -> str:
    from shutil import get_terminal_size
    from textwrap import fill

    width = get_terminal_size().columns
    rows = (
        fill(text, width, initial_indent=f"  {name:9}", subsequent_indent=" " * 11)
        for name, (_, text) in _COMMANDS.items()
    )
    codes = "Exit codes of all: 0 done, 1 something not proved or not found, 2 bad input, 130 interrupted"
    return "\n".join(
        [
            f"usage: orbitproof {{{','.join(_COMMANDS)}}} ...\n",
            "Finds bifurcations of symmetric periodic orbits and proves them.\n",
            *rows,
            "\noptions:\n  --version   print the version\n",
            "Each explains itself: orbitproof verify --help",
            fill(codes, width),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
