"""What somebody may have meant who has misspelt an option or a command."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from itertools import pairwise

_ALIKE = 0.75
"""Share of letters that two words have in common if one may be the other, misspelt."""


def meant(word: str, known: Iterable[str]) -> str:
    """The remedy for a word that is none of those known: ``; did you mean verify?``, or nothing.

    >>> meant("verfy", ["explore", "verify"]), meant("--jobs", ["--orbit", "--mass"])
    ('; did you mean verify?', '')
    """
    close = get_close_matches(word.casefold(), list(known), 1, _ALIKE)
    return f"; did you mean {close[0]}?" if close else ""


def with_remedy(message: str, parser: argparse.ArgumentParser) -> str:
    """The message of a parser, in one line, with the option that may have been meant where one is not known."""
    line = " ".join(message.split())
    choice = re.search(r"argument COMMAND: invalid choice: '(.*?)' \(choose from (.*)\)", line)
    if choice is not None:
        return line + meant(choice[1], re.findall(r"[\w-]+", choice[2]))
    alone = re.search(r"argument (?:-\w, |-\w/)?(--[\w-]+).*: expected .* argument", line)
    if alone is not None:
        value = next(
            (word for option, word in pairwise(sys.argv) if option == alone[1] and re.match(r"-[\d.]", word)), ""
        )
        return line + (f"; write {alone[1]}={value}" if value else "")
    unknown = re.search(r"unrecognized arguments: (?:.* )?(--[\w-]+)", line)
    known = set(_options(parser))
    return line if unknown is None or unknown[1] in known else line + meant(unknown[1], sorted(known))


def _options(parser: argparse.ArgumentParser) -> Iterator[str]:
    """The long options of a parser and of its subcommands."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for each in action.choices.values():
                yield from _options(each)
        yield from (option for option in action.option_strings if option.startswith("--"))
