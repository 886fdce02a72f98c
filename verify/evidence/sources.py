"""What computes: names, versions and a digest of all sources (section 10.2)."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterator
from functools import cache
from importlib import metadata, resources
from importlib.resources.abc import Traversable

import flint


@cache
def software() -> dict[str, str]:
    """Names and versions of what computes, with a digest of all sources of verify and shared."""
    try:
        version = metadata.version("orbitproof")
    except metadata.PackageNotFoundError:
        version = "not installed"
    return {
        "orbitproof": version,
        "source": source_digest([(name, resources.files(f"orbitproof.{name}")) for name in ("shared", "verify")]),
        "python": platform.python_version(),
        "python-flint": str(flint.__version__),
        "FLINT": str(flint.__FLINT_VERSION__),
        "numpy": metadata.version("numpy"),
    }


def source_digest(packages: list[tuple[str, Traversable]]) -> str:
    """SHA-256 of every Python file in the packages, at all levels, with its path."""
    digest = hashlib.sha256()
    for name, package in packages:
        for path, content in sorted(_sources(package, name)):
            digest.update(f"{path}\0".encode() + content + b"\0")
    return f"sha256:{digest.hexdigest()}"


def _sources(folder: Traversable, path: str) -> Iterator[tuple[str, bytes]]:
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _sources(entry, f"{path}/{entry.name}")
        elif entry.name.endswith(".py"):
            yield f"{path}/{entry.name}", entry.read_bytes()
