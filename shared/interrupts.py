"""How a run comes to an end before it is done: Ctrl-C, SIGTERM and SIGHUP are all `KeyboardInterrupt`."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from orbitproof.shared.errors import InputError
from orbitproof.shared.extras import missing_extra
from orbitproof.shared.output import files_of_a_command
from orbitproof.shared.streams import StreamError, closed_stream, is_unread, watched_streams

ENDING_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""The signals that ask a run to end, as far as the system knows them."""

INTERRUPTED = 130
"""The exit code of every command after an interrupt, whatever it has done by then; what shells give for Ctrl-C."""

_WATCH_SECONDS = 0.5
_AGAIN_SECONDS = 0.05
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
    """The exit code of a command line, which signals end as Ctrl-C does: `INTERRUPTED` if one came, whatever was done.

    Where a package of an extra is missing, the memory is short, a number too large, or a standard stream closed or
    full, one line says so, as far as it can be told, and the code is 2: commands that read, search and draw do so in
    their own process. Where nobody reads on what is printed, as in ``orbitproof .. | head -1``, it ends without a word,
    and the code is 1.
    """
    closed = closed_stream()
    if closed:
        return _refused(f"{closed} is closed; give it a file, or {os.devnull}")
    code = INTERRUPTED
    # An interrupt may come at the very end too.
    with suppress(KeyboardInterrupt), ending_by_signals() as is_ending, watched_streams():
        code = _code(main)
        code = INTERRUPTED if is_ending() and code in (0, 1) else code
    return code


def _code(main: Callable[[], int]) -> int:
    try:
        try:
            with not_swallowed(), files_of_a_command():
                code = main()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 2
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        if not is_unread():
            raise
        return 1
    except (InputError, StreamError) as error:
        return _refused(str(error))
    except ModuleNotFoundError as error:
        line = missing_extra(error)
        if line is None:
            raise
        return _refused(line)
    except (MemoryError, OverflowError) as error:
        why = "there is not enough memory" if isinstance(error, MemoryError) else "a number is too large"
        return _refused(f"{why} for what is asked; is the file one that you trust?")
    except KeyboardInterrupt:
        _say("interrupted")
        return INTERRUPTED


def _refused(line: str) -> int:
    _say(f"error: {line}")
    return 2


def _say(line: str) -> None:
    """On standard error, if that can be written."""
    if sys.stderr is not None:
        with suppress(OSError, StreamError):
            print(line, file=sys.stderr, flush=True)


@contextmanager
def ending_by_signals() -> Iterator[Callable[[], bool]]:
    """While the body runs, SIGTERM and SIGHUP raise `KeyboardInterrupt`, as Ctrl-C does. For the main thread.

    What is yielded tells whether one of the three has come.

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
        yield lambda: ending
    finally:
        for number in ours:
            signal.signal(number, before[number])


@contextmanager
def not_swallowed() -> Iterator[None]:
    """While the body runs, an interrupt that comes where Python only tells of it, as in a finalizer, comes again."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    def tell(found: sys.UnraisableHookArgs) -> None:
        if issubclass(found.exc_type, KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, _AGAIN_SECONDS)
        else:
            hook(found)

    hook, handler = sys.unraisablehook, signal.signal(signal.SIGALRM, interrupt)
    sys.unraisablehook = tell
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, handler)
        sys.unraisablehook = hook


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
