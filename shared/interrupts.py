"""How a run comes to an end before it is done: Ctrl-C, SIGTERM and SIGHUP are all `KeyboardInterrupt`."""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from orbitproof.shared.extras import missing_extra

ENDING_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""The signals that ask a run to end, as far as the system knows them."""

INTERRUPTED = 130
"""The exit code of every command after an interrupt, whatever it has done by then; what shells give for Ctrl-C."""

_WATCH_SECONDS = 0.5
_ENDS_WITH = "ORBITPROOF_ENDS_WITH"


@contextmanager
def held_back() -> Iterator[None]:
    """Keep signals that end a run back; a process that is started meanwhile never sees them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING_SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def run_command(main: Callable[[], int]) -> int:
    """The exit code of a command line that signals end as Ctrl-C does; `INTERRUPTED` where it does not care for itself.

    Where a package of an extra is missing, the memory is short or a number too large, one line says so, and the code
    is 2: commands that read, search and draw do so in their own process. Where nobody reads on what is printed, as in
    ``orbitproof .. | head -1``, it ends without a word, and the code is 1.
    """
    with ending_by_signals():
        try:
            code = main()
            sys.stdout.flush()
            return code
        except BrokenPipeError:
            if not _is_unread():
                raise
            return 1
        except ModuleNotFoundError as error:
            line = missing_extra(error)
            if line is None:
                raise
            print(f"error: {line}", file=sys.stderr)
            return 2
        except (MemoryError, OverflowError) as error:
            why = "there is not enough memory" if isinstance(error, MemoryError) else "a number is too large"
            print(f"error: {why} for what is asked; is the file one that you trust?", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            return INTERRUPTED


def _is_unread() -> bool:
    """Whether nobody can read standard output any more; what Python still has for it goes nowhere then."""
    if not hasattr(select, "poll"):
        return False
    output = select.poll()
    output.register(sys.stdout.fileno(), 0)
    if not any(events & select.POLLERR for _, events in output.poll(0)):
        return False
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return True


@contextmanager
def ending_by_signals() -> Iterator[None]:
    """While the body runs, SIGTERM and SIGHUP raise `KeyboardInterrupt`, as Ctrl-C does. For the main thread.

    Once the run is ending they do nothing more; a second Ctrl-C does. What is ignored from the start stays ignored:
    SIGHUP under nohup, SIGINT in the background of a script. A process that was started with `bound_to_this` gets
    SIGTERM when the one that it is bound to is gone.
    """
    ending = False

    def end(number: int, frame: FrameType | None) -> None:
        nonlocal ending
        if number == signal.SIGINT or not ending:
            ending = True
            raise KeyboardInterrupt

    before = {number: signal.getsignal(number) for number in ENDING_SIGNALS}
    ours = [number for number, handler in before.items() if handler in (signal.SIG_DFL, signal.default_int_handler)]
    for number in ours:
        signal.signal(number, end)
    bound_to = os.environ.pop(_ENDS_WITH, "")
    if bound_to.isdecimal() and os.name == "posix":
        threading.Thread(target=_end_with, args=(int(bound_to),), daemon=True).start()
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, before[number])


def bound_to_this() -> dict[str, str]:
    """The environment of a command that ends, as by an interrupt, when this process is gone."""
    return {**os.environ, _ENDS_WITH: str(os.getpid())}


def _end_with(number: int) -> None:
    """Send this process SIGTERM when the process of that number is gone."""
    try:
        while True:
            with suppress(PermissionError):
                os.kill(number, 0)
            time.sleep(_WATCH_SECONDS)
    except ProcessLookupError:
        os.kill(os.getpid(), signal.SIGTERM)
