"""Standard streams of a command that are closed, full, or read by nobody."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, TextIO

from orbitproof.shared.printing import printable


class StreamError(Exception):
    """A standard stream that cannot be written, and why, in one line. No `OSError`, which some libraries pass over."""


def closed_stream() -> str:
    """Which of standard output and standard error is closed; empty if none is.

    No file that is opened later gets the number of a stream that is closed, so that nothing printed goes there.
    """
    number = -1
    while number < 2:
        # The lowest number that is free.
        number = os.open(os.devnull, os.O_RDWR)
        if number > 2:
            os.close(number)
        else:
            os.set_inheritable(number, True)
    if sys.stderr is None:
        return "standard error"
    return "standard output" if sys.stdout is None else ""


@contextmanager
def watched_streams() -> Iterator[None]:
    """While the body runs, what cannot be written to a standard stream raises `StreamError`.

    Where nobody reads standard output any more, that is `BrokenPipeError`, as ever.
    """
    streams = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Watched(sys.stdout, "standard output"), _Watched(sys.stderr, "standard error")
    try:
        yield
    finally:
        sys.stdout, sys.stderr = streams


class _Watched:
    """A stream as it is, but for how its failures are told, and for characters that a terminal would obey.

    Attributes:
        rich_proxied_file: the stream itself, to which rich draws.
    """

    def __init__(self, stream: TextIO, name: str) -> None:
        self._stream = self.rich_proxied_file = stream
        self._name = name

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write the text; what comes from a file does nothing to a terminal."""
        with self._watched():
            self._stream.write(printable(text, "\n\t"))
        return len(text)

    def flush(self) -> None:
        """Write what is kept back."""
        with self._watched():
            self._stream.flush()

    @contextmanager
    def _watched(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            if isinstance(error, BrokenPipeError) and self._name == "standard output":
                raise
            # What Python still has for it goes nowhere.
            silence(self._stream)
            raise StreamError(f"{self._name} cannot be written ({error.strerror}); give it another file") from None


def is_unread() -> bool:
    """Whether nobody can read standard output any more; what Python still has for it goes nowhere then."""
    if not hasattr(select, "poll"):
        return False
    output = select.poll()
    output.register(sys.stdout.fileno(), 0)
    if not any(events & select.POLLERR for _, events in output.poll(0)):
        return False
    silence(sys.stdout)
    return True


def silence(stream: TextIO) -> None:
    """Have what is written to a stream go nowhere."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
