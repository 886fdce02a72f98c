"""``orbitproof figures data``: make the data files of the pictures that are missing, each by its own command."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from orbitproof.figures.scripting import make_data, missing_steps, print_path
from orbitproof.shared.answers import tell
from orbitproof.shared.help_text import add_command

_EXAMPLES = """\
examples:
  orbitproof figures data data/
  orbitproof figures data data/ --only portraits.json lyapunov.json
  orbitproof figures data data/ --dry-run                (print the commands, run nothing)

A file that is there is not made again: delete it to have it made, or put your own in its place. What was interrupted
goes on where it stopped. The search and the proof run as commands of their own; docs/figures.md has the times.
Exit codes: 0 all files there; 1 a command did not find or prove everything; 2 bad input or a failed command;
130 interrupted.
"""


def add_parser(commands: Any) -> None:
    """Add the subcommand to the parser's `commands`."""
    parser = add_command(commands, "data", "make the data files of the pictures that are missing", _EXAMPLES)
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of data files, created if need be")
    parser.add_argument("--only", nargs="+", metavar="FILE", help="these files, by name (with * and ?; default: all)")
    parser.add_argument("--dry-run", action="store_true", help="print the commands that would be run, run nothing")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the commands whose products are missing; returns the exit code. Raises `InputError`."""
    if options.dry_run:
        for step in missing_steps(options.data, options.only):
            command = step.text(options.data)
            tell(command, [{"command": command}])
        return 0
    made = make_data(options.data, only=options.only, told=print_path)
    return 2 if made.failed else 1 if made.not_made or made.incomplete else 0
