"""What a shell is told when it completes a command line: by argcomplete, extra `completion`."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from importlib import import_module
from typing import Any

_BY_NAME = ("atlas", "web", "life", "index", "catalogue")
"""What `verify` is told to do by a word of its own."""


def complete(rooms: Mapping[str, str]) -> None:
    """Answer the shell that asks, and end the process; `rooms` are the modules of the commands by name.

    The parser is that of the command that stands on the line, as far as the cursor.
    """
    argcomplete: Any = import_module("argcomplete")
    line = os.environ["COMP_LINE"][: int(os.environ["COMP_POINT"])]
    words = line.split()[1:]
    done = words if line.endswith(" ") else words[:-1]
    if not done or done[0] not in rooms:
        parser = argparse.ArgumentParser("orbitproof")
        parser.add_argument("command", choices=rooms)
        argcomplete.autocomplete(parser)
        return

    def answer(parser: argparse.ArgumentParser, *_: object, **__: object) -> None:
        argcomplete.autocomplete(parser)

    skipped = 3 if done[0] == "verify" and done[1:2] and done[1] in _BY_NAME else 2
    # So many words come before those of the parser.
    os.environ["_ARGCOMPLETE"] = str(skipped)
    argparse.ArgumentParser.parse_args = answer  # type: ignore[method-assign,assignment]
    import_module(f"orbitproof.{rooms[done[0]]}").main(done[1:])
