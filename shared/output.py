"""Files that commands write: whole or not at all, where links lead; what is no regular file is written into.

A FIFO or a terminal takes one document. While a command runs, what is written to one several times, as results that
are saved as they come, goes there at the end, once.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from orbitproof.shared.errors import InputError

_READER_SECONDS = 10.0
"""So long a reader of a FIFO is waited for."""
_LOOK_SECONDS = 0.05


@dataclass
class _Files:
    """The files of one command: what was written, and what is to be written at its end to what is no regular file."""

    written: dict[Path, None] = field(default_factory=dict)
    waiting: dict[Path, bytes] = field(default_factory=dict)


_files: ContextVar[_Files | None] = ContextVar("files", default=None)


def check_writable(path: Path) -> None:
    """Raise `InputError` if a file at `path` could not be written; call it before a long run."""
    if path.name == "-":
        raise InputError(f"{path}: files are written whole, to a path and not to standard output; give a path")
    try:
        mode, target = _mode(path), Path(os.path.realpath(path))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be written ({_why(error)}); choose another path") from None
    if mode is not None and not stat.S_ISREG(mode):
        _check_special(path, mode)
        return
    if not target.parent.is_dir():
        raise InputError(f"{path}: folder {target.parent} does not exist; create it or choose another path")
    if not os.access(target.parent, os.W_OK) or (mode is not None and not os.access(target, os.W_OK)):
        raise InputError(f"{path}: cannot be written (permission denied); choose another path")
    if mode is not None and _is_standard_stream(target):
        raise InputError(f"{path}: what is printed goes to this file too; give another path")


def _check_special(path: Path, mode: int) -> None:
    if stat.S_ISDIR(mode):
        raise InputError(f"{path}: is a folder; give the path of a file to write")
    if not (stat.S_ISFIFO(mode) or stat.S_ISCHR(mode)):
        what = "a disk" if stat.S_ISBLK(mode) else "a socket"
        raise InputError(f"{path}: is {what} and no file; give the path of a file to write")
    if not os.access(path, os.W_OK):
        raise InputError(f"{path}: cannot be written (permission denied); choose another path")


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all; raises `InputError`."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file. Raises `InputError`.

    A regular file is written atomically: a temporary file in the folder where links lead, then a rename. Into a FIFO
    or a device the data are written, at the end of a command.
    """
    check_writable(path)
    files = _files.get()
    try:
        if _is_regular(path):
            _replace(Path(os.path.realpath(path)), data)
        elif files is None:
            _write_into(path, data)
        else:
            files.waiting[path] = data
        if files is not None:
            files.written[path] = None
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({_why(error)}); free space or choose another path") from None


def written_files() -> tuple[Path, ...]:
    """The files that the command that runs has written so far."""
    files = _files.get()
    return () if files is None else tuple(files.written)


def what_is_written() -> str:
    """What the command that runs has written so far, in words."""
    written = ", ".join(map(str, written_files()))
    return f"written before: {written}" if written else "nothing was written"


@contextmanager
def files_of_a_command() -> Iterator[None]:
    """While the body runs, what goes to FIFOs and devices is kept back; at its end the last of it is written.

    Raises `InputError`.
    """
    files = _Files()
    token = _files.set(files)
    try:
        yield
    finally:
        _files.reset(token)
        for path, data in files.waiting.items():
            write_bytes(path, data)


def _mode(path: Path) -> int | None:
    """What there is at a path, links followed; `None` if nothing is."""
    with suppress(FileNotFoundError):
        return path.stat().st_mode
    return None


def _is_regular(path: Path) -> bool:
    mode = _mode(path)
    return mode is None or stat.S_ISREG(mode)


def _is_standard_stream(path: Path) -> bool:
    """Whether standard output or standard error goes to a file."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):
            if os.path.samestat(os.fstat(stream.fileno()), path.stat()):
                return True
    return False


def _replace(path: Path, data: bytes) -> None:
    # Late: it takes longer to load than all the rest here.
    from tempfile import mkstemp

    descriptor, temporary = mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    finally:
        # After an interrupt too; of what was renamed there is nothing.
        with suppress(OSError):
            os.unlink(temporary)


def _write_into(path: Path, data: bytes) -> None:
    descriptor = _opened(path)
    try:
        os.set_blocking(descriptor, True)
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(descriptor, rest) :]
    finally:
        os.close(descriptor)


def _opened(path: Path) -> int:
    """A file that exists, to write into. Raises `InputError` for a FIFO that nobody reads."""
    last = time.monotonic() + _READER_SECONDS
    while True:
        try:
            # A FIFO is not waited for without end.
            return os.open(path, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY)
        except OSError as error:
            if error.errno != errno.ENXIO:
                raise
        if time.monotonic() > last:
            raise InputError(f"{path}: nobody reads what is written there; start its reader first")
        time.sleep(_LOOK_SECONDS)


def _why(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
