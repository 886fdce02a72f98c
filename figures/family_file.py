"""Reading family files, the traced families that ``python -m explore`` writes."""

from __future__ import annotations

from pathlib import Path

from figures.family import Family


def read_families(path: Path) -> list[Family]:
    raise NotImplementedError
