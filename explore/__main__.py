"""Command line of the search: ``python -m explore``; see ``--help``."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from explore.arguments import parser
from explore.request import check
from shared.formats import InputError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns 0 if everything asked for was found, 1 if something was not, 2 for bad input and 130
    after an interrupt. Bad options end in `SystemExit` with code 2.
    """
    options = parser().parse_args(arguments)
    try:
        # Commands in a module of their own bring their `run` along; the others share the search.
        if hasattr(options, "run"):
            return int(options.run(options))
        request = check(options)
        from explore.search import run

        return run(request)
    except InputError as error:
        print(f"python -m explore {options.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"python -m explore {options.command}: interrupted, nothing was written", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
