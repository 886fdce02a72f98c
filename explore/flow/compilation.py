"""How JAX compiles here: double precision, one kernel for a small loop, compiled code kept between runs.

Compiled code is kept in ``$ORBITPROOF_CACHE``, by default ``$XDG_CACHE_HOME/orbitproof/jax`` or
``~/.cache/orbitproof/jax``, in a folder of its own for each kind of processor: code for one may not run on another.
``ORBITPROOF_CACHE=off`` keeps nothing, and so does a folder that cannot be written. JAX's own settings
(``JAX_COMPILATION_CACHE_DIR``, ``XLA_FLAGS``) come first where they are set. What JAX keeps is the code that it would
compile again, and it runs that code without checking it: who can write the folder can change what a search finds, and
run what they like. So a folder that belongs to somebody else, or that others can write, is not used. Nothing that is
proved depends on it: the verifier does not use JAX.
"""

from __future__ import annotations

import hashlib
import os
import platform
import stat
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import jax

KERNEL_BYTES = 1_000_000_000
"""Loops that touch less memory become one kernel, which all loops over orbits do. XLA otherwise calls a kernel for
every few operations; for a single orbit that costs several times the arithmetic."""

_OPTION = "--xla_backend_extra_options"
_accelerated: list[bool] = []
_CORRUPT = "Error reading persistent compilation cache"


def cache_folder() -> Path | None:
    """Where compiled code is kept, or `None`: nowhere."""
    chosen = os.environ.get("ORBITPROOF_CACHE")
    if chosen is not None and chosen.strip().lower() in ("", "off"):
        return None
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "orbitproof" / "jax"
        return (Path(chosen).expanduser() if chosen else base) / _processor()
    except RuntimeError:  # no home folder
        return None


def _processor() -> str:
    """A short name for the processor's kind and instruction set."""
    lines: set[str] = set()
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text("utf-8", "replace").splitlines():
            if line.split("\t")[0].strip() in ("model name", "flags", "Features", "CPU part"):
                lines.add(line)
    text = "\n".join((platform.machine(), platform.processor(), *sorted(lines)))
    return f"{platform.machine()}-{hashlib.sha256(text.encode()).hexdigest()[:12]}"


def _only_ours(folder: Path) -> bool:
    """Whether nobody else can put anything into a folder, or another one in its place; the system's root always can."""
    if not hasattr(os, "getuid"):
        return True
    inner, outer = folder.stat(), folder.parent.stat()
    shared = stat.S_IWGRP | stat.S_IWOTH
    replaceable = outer.st_mode & shared and not outer.st_mode & stat.S_ISVTX
    return (
        inner.st_uid == os.getuid() and outer.st_uid in (os.getuid(), 0) and not (inner.st_mode & shared or replaceable)
    )


@cache
def configure_jax() -> None:
    """Double precision, small loops in one kernel and, where a folder can be written, a cache of compiled code.

    Computes on the processor unless ``JAX_PLATFORMS`` or `use_accelerator` says otherwise. To be called before
    anything is computed.
    """
    jax.config.update("jax_enable_x64", True)
    if "JAX_PLATFORMS" not in os.environ and not _accelerated:
        # Orbits one at a time are nothing for an accelerator.
        jax.config.update("jax_platforms", "cpu")
    flags = os.environ.get("XLA_FLAGS", "")
    if _OPTION not in flags:
        option = f"{_OPTION}=xla_cpu_small_while_loop_byte_threshold={KERNEL_BYTES}"
        os.environ["XLA_FLAGS"] = f"{flags} {option}".strip()
    if jax.config.jax_compilation_cache_dir is not None:
        return
    folder = cache_folder()
    if folder is None:
        return
    try:
        folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        if not _only_ours(folder):
            words = "belongs to somebody else, or others can write it: no compiled code is read or kept there"
            warnings.warn(f"{folder}: {words}; remove it, or set ORBITPROOF_CACHE", stacklevel=2)
            return
    except OSError:
        return
    if os.access(folder, os.W_OK | os.X_OK):
        jax.config.update("jax_compilation_cache_dir", str(folder))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.2)
        jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


def use_accelerator() -> None:
    """Let batches run on a GPU where JAX finds one; orbits one at a time stay on the processor.

    Without effect once JAX is configured.
    """
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    _accelerated.append(True)


@contextmanager
def compiling() -> Iterator[None]:
    """Around code that may compile: a cache that cannot be read or written only costs the time to compile.

    An entry that cannot be read, cut short by an interrupt, is removed; JAX would keep it for ever.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for warning in caught:
        message = str(warning.message)
        if not message.startswith(("Error reading persistent", "Error writing persistent")):
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)
        elif message.startswith(_CORRUPT) and (folder := cache_folder()) is not None:
            name = message.split("'")[1]
            for entry in folder.glob(f"{name}-*"):
                with suppress(OSError):
                    entry.unlink()


@contextmanager
def _without_callbacks() -> Iterator[None]:
    """Code without checks of its arguments at run time: these are callbacks, and JAX keeps no code with callbacks."""
    errors = sys.modules.get("equinox._errors")
    before = getattr(errors, "EQX_ON_ERROR", None)
    if errors is None or before != "raise":
        yield
        return
    errors.EQX_ON_ERROR = "off"
    try:
        yield
    finally:
        errors.EQX_ON_ERROR = before


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """`function`, compiled for the processor at its first call, for the shapes of the arguments of this call."""
    holder: list[Callable[..., Any]] = []

    def call(*arguments: Any) -> Any:
        if not holder:
            with compiling(), _without_callbacks(), jax.default_device(jax.local_devices(backend="cpu")[0]):
                holder.append(jax.jit(function).lower(*arguments).compile())
        return holder[0](*arguments)

    return call
