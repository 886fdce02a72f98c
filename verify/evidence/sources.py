"""What computes: names, versions and a digest of the sources (section 10.2)."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterator, Sequence
from functools import cache
from importlib import metadata, resources
from importlib.resources.abc import Traversable

import flint

ON_WHICH_NOTHING_RESTS = (
    *("verify/oracle", "verify/words", "verify/run", "verify/second_proof", "verify/alone", "verify/enclose"),
    *("verify/scripting.py", "verify/__main__.py", "verify/__init__.py"),
    *("shared/processes.py", "shared/interrupts.py", "shared/extras.py", "shared/arguments.py", "shared/wording.py"),
)
"""What finds, words and moves what is proved, and proves nothing: a change there makes no proof another one."""


@cache
def software() -> dict[str, str]:
    """Names and versions of what computes, with a digest of the sources that a proof rests on (section 10.2)."""
    return _with_digest(ON_WHICH_NOTHING_RESTS)


@cache
def installed() -> dict[str, str]:
    """The same with a digest of all sources of verify and shared: what workers of one run have in common."""
    return _with_digest(())


def _with_digest(left_out: Sequence[str]) -> dict[str, str]:
    try:
        version = metadata.version("orbitproof")
    except metadata.PackageNotFoundError:
        version = "not installed"
    packages = [(name, resources.files(f"orbitproof.{name}")) for name in ("shared", "verify")]
    return {
        "orbitproof": version,
        "source": source_digest(packages, left_out),
        "python": platform.python_version(),
        "python-flint": str(flint.__version__),
        "FLINT": str(flint.__FLINT_VERSION__),
        "numpy": metadata.version("numpy"),
    }


def source_digest(packages: Sequence[tuple[str, Traversable]], left_out: Sequence[str] = ()) -> str:
    """SHA-256 of every Python file in the packages, at all levels, with its path, but for what is left out."""
    digest = hashlib.sha256()
    for name, package in packages:
        for path, content in sorted(_sources(package, name)):
            if not any(path == place or path.startswith(f"{place}/") for place in left_out):
                digest.update(f"{path}\0".encode() + content + b"\0")
    return f"sha256:{digest.hexdigest()}"


def _sources(folder: Traversable, path: str) -> Iterator[tuple[str, bytes]]:
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _sources(entry, f"{path}/{entry.name}")
        elif entry.name.endswith(".py"):
            yield f"{path}/{entry.name}", entry.read_bytes()
