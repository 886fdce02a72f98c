"""A digest of sources: what is computed by the same code."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from importlib.resources.abc import Traversable


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
