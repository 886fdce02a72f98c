"""Digests of sources: what is computed by the same code."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path


def source_digests(packages: Sequence[tuple[str, Path]], *left_out: Sequence[str]) -> list[str]:
    """SHA-256 of paths and SHA-256 of all Python files in the packages, for each choice of what is left out."""
    digests = [hashlib.sha256() for _ in left_out]
    for name, package in packages:
        for path, content in sorted(_sources(package, name)):
            for digest, places in zip(digests, left_out, strict=True):
                if not any(path == place or path.startswith(f"{place}/") for place in places):
                    digest.update(f"{path}\0".encode() + content)
    return [f"sha256:{digest.hexdigest()}" for digest in digests]


def _sources(folder: Path, path: str) -> Iterator[tuple[str, bytes]]:
    for entry in folder.iterdir():
        if entry.name.endswith(".py"):
            yield f"{path}/{entry.name}", hashlib.sha256(entry.read_bytes()).digest()
        # A file with another ending is not looked up: names of folders have no point.
        elif "." not in entry.name and entry.is_dir():
            yield from _sources(entry, f"{path}/{entry.name}")
