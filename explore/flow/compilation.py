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
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, Literal

import jax

from orbitproof.shared.arguments import ArgumentError

KERNEL_BYTES = 1_000_000_000
"""Loops that touch less memory become one kernel, which all loops over orbits do. XLA otherwise calls a kernel for
every few operations; for a single orbit that costs several times the arithmetic."""

Device = Literal["cpu", "gpu"]

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

    Everything is computed on the processor but what `batches_on` hands to a GPU. To be called before anything is
    computed.
    """
    jax.config.update("jax_enable_x64", True)
    if "JAX_PLATFORMS" not in os.environ and not _accelerated:
        jax.config.update("jax_platforms", "cpu")
    flags = os.environ.get("XLA_FLAGS", "")
    if _OPTION not in flags:
        option = f"{_OPTION}=xla_cpu_small_while_loop_byte_threshold={KERNEL_BYTES}"
        os.environ["XLA_FLAGS"] = f"{flags} {option}".strip()
    if jax.config.jax_platforms != "cpu":
        # Orbits one at a time are nothing for a GPU.
        jax.config.update("jax_default_device", jax.local_devices(backend="cpu")[0])
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
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.05)
        jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


def batches_on(name: Device) -> AbstractContextManager[str]:
    """Inside, batches of orbits are computed on this device; one orbit at a time stays on the processor.

    The context is what the device calls itself. Raises `InputError` for a GPU that JAX does not have.
    """
    if name == "gpu" and not configure_jax.cache_info().currsize:
        os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
        _accelerated.append(True)
    configure_jax()
    try:
        return _computing_on(jax.local_devices(backend=name)[0])
    except RuntimeError:
        if (chosen := os.environ.get("JAX_PLATFORMS")) and "cuda" not in chosen:
            why = f"JAX_PLATFORMS={chosen} keeps JAX from it; unset it"
        elif name == "gpu" and not _accelerated:
            why = "JAX has begun with the processor alone; ask for the GPU first in a new process"
        else:
            why = "JAX finds none; pip install 'jax[cuda13]' beside a driver of NVIDIA, or leave it out"
        raise ArgumentError("{device} {0}: {1}", name, why) from None


@contextmanager
def _computing_on(device: jax.Device) -> Iterator[str]:
    with jax.default_device(device):
        yield "the processor" if device.platform == "cpu" else f"the GPU ({device.device_kind})"


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
