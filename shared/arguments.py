"""Bad arguments of functions that commands call too: each side reads its own names."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from string import Formatter

from orbitproof.shared.errors import InputError
from orbitproof.shared.printing import printable


class ArgumentError(InputError):
    """Bad input to a function that a command line calls too: in Python the line names arguments, there their options.

    Made of words with the arguments in braces and values by their numbers; an option of another name, and one that is
    a value of an argument, follow a colon.

    >>> error = ArgumentError("{max_splits} {0}: give less, or {fresh=True:--fresh} and {formats:--format}", 10)
    >>> print(error)
    max_splits 10: give less, or fresh=True and formats
    >>> print(error.on_command_line)
    --max-splits 10: give less, or --fresh and --format
    """

    def __init__(self, words: str, *values: object) -> None:
        super().__init__(words, *values)

    def __str__(self) -> str:
        words, *values = self.args
        return printable(Formatter().vformat(words, values, _Names(_Argument)))

    @property
    def on_command_line(self) -> str:
        """The line as a command says it."""
        words, *values = self.args
        said = [as_command_says(value) if isinstance(value, InputError) else value for value in values]
        return printable(Formatter().vformat(words, said, _Names(_Option)))


class _Names(dict[str, str]):
    """Every name there is, as text of this kind."""

    def __init__(self, kind: type[str]) -> None:
        super().__init__()
        self._kind = kind

    def __missing__(self, name: str) -> str:
        return self._kind(name)


class _Argument(str):
    """An argument, as Python calls it."""

    def __format__(self, option: str) -> str:
        return str(self)


class _Option(str):
    """The argument as an option of a command."""

    def __format__(self, option: str) -> str:
        return option or f"--{self.replace('_', '-')}"


def as_options(words: str, **options: str) -> str:
    """Words of a result as a command says them.

    What results say of settings, as remedies and obstacles do, is the same whoever asked for them: Python's name,
    between backticks. `options` are those that are called otherwise.

    >>> as_options("give `max_precision` more, or `timeout` more seconds", timeout="--row-timeout")
    'give --max-precision more, or --row-timeout more seconds'
    """
    return _SETTING.sub(lambda found: options.get(found[1], f"--{found[1].replace('_', '-')}"), words)


_SETTING = re.compile(r"`([a-z]+(?:_[a-z]+)*)`")


def as_command_says(error: InputError) -> str:
    """The line of an error, with options for arguments."""
    return error.on_command_line if isinstance(error, ArgumentError) else str(error)


class _FileError(ArgumentError):
    """A refused argument whose message names its file."""


@contextmanager
def about(path: Path | None) -> Iterator[None]:
    """While the body runs, errors of what was read from a file name it. `None`: it was read from none."""
    try:
        yield
    except InputError as error:
        if path is None or isinstance(error, _FileError) or str(path) in as_command_says(error):
            raise
        raise _FileError("{0}: {1}", path, error) from None


def refused(error: InputError) -> int:
    """Say on standard error what is wrong with the input of a command, in one line; the exit code for it."""
    print(f"error: {as_command_says(error)}", file=sys.stderr)
    return 2
