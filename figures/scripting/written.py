"""Which files a function wrote, and whom it tells."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path

from orbitproof.figures.files import check_folder
from orbitproof.shared.answers import tell

Source = str | Path
Told = Callable[[Path], object]


def quietly(path: Path) -> None:
    """Nobody wants to know."""


def print_path(path: Path) -> None:
    """For `told`: each file on standard output, as it comes."""
    tell(str(path))


class Written:
    """The files written so far, each told of."""

    def __init__(self, told: Told) -> None:
        self.paths: list[Path] = []
        self._told = told

    def add(self, paths: Iterable[Path]) -> None:
        for path in paths:
            self.paths.append(path)
            self._told(path)


def optional(path: Source | None) -> Path | None:
    return None if path is None else Path(path)


def folder_of(path: Source) -> Path:
    folder = Path(path)
    check_folder(folder)
    return folder


class Names:
    """Names of files that are not yet taken."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def new(self, text: str) -> str:
        stem = re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-.")
        name, number = stem, 2
        while name in self._taken:
            name, number = f"{stem}-{number}", number + 1
        self._taken.add(name)
        return name
