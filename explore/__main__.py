"""Command line of the search: ``orbitproof explore``; see ``--help``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from orbitproof.explore.commands.arguments import parser
from orbitproof.explore.names import Contradiction
from orbitproof.explore.search import check
from orbitproof.shared.answers import answered
from orbitproof.shared.formats import InputError, refused
from orbitproof.shared.interrupts import INTERRUPTED, run_command
from orbitproof.shared.output import what_is_written


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns 0 if everything asked for was found, 1 if something was not, 2 for bad input and `INTERRUPTED`
    after an interrupt. Bad options end in `SystemExit` with code 2.
    """
    options = parser().parse_args(arguments)
    return answered(f"orbitproof explore {options.command}", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    try:
        # Commands in a module of their own bring their `run` along; the others share the search.
        if hasattr(options, "run"):
            return int(options.run(options))
        request = check(options)
        from orbitproof.explore.search import search

        return search(request)
    except Contradiction as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 1
    except InputError as error:
        return refused(error)
    except KeyboardInterrupt:
        print(f"orbitproof explore {options.command}: interrupted, {what_is_written()}", file=sys.stderr)
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(run_command(main))
