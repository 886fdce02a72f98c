"""Numbers of the files of a row, each changed by one unit, and whether Coq still accepts the file."""

from __future__ import annotations

import random
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

NUMBER = re.compile(r"(?<![\w])(?:0x[0-9a-f]+|\d+)(?![\w])")


@dataclass(frozen=True)
class Planted:
    """A number of a file, of which the digits begin at a place.

    Attributes:
        file: its name without ending.
        of: what the number belongs to, by the name of the definition, and which part of that.
    """

    file: str
    of: str
    begin: int
    end: int

    def text(self, original: str, change: int) -> str:
        """The file with this number changed."""
        value = int(original[self.begin : self.end], 0) + change
        return f"{original[: self.begin]}{value}{original[self.end :]}"


def numbers(file: Path) -> Iterator[Planted]:
    """All numbers in the definitions of a file but those of a tube, which may be any that holds."""
    text = file.read_text("utf-8")
    for found in re.finditer(r"^Definition (\w+)(.*?)\.$", text, re.MULTILINE | re.DOTALL):
        start = text.index(":=", found.start())
        # The tube of a step is its last list, before the number of terms.
        tube = text.rfind("\n  [[", start, found.end()) if "step" in found[1] else found.end()
        after = text.rfind("]]", start, found.end())
        for number in NUMBER.finditer(text, start, found.end()):
            if tube < number.start() < after:
                continue
            yield Planted(file.stem, found[1], number.start(), number.end())


def drawn(folder: Path, names: list[str], how_many: int, seed: int) -> list[Planted]:
    """Numbers of some files, as many of each, drawn at random."""
    source = random.Random(seed)
    return [
        planted
        for name in names
        for planted in source.sample(list(numbers(folder / f"{name}.v")), -(-how_many // len(names)))
    ][:how_many]


def accepted(folder: Path, planted: Planted, change: int, work: Path) -> bool:
    """Whether Coq accepts a file of a compiled row with one number changed."""
    work.mkdir(exist_ok=True)
    for path in work.iterdir():
        path.unlink()
    for path in folder.glob("*.vo"):
        if path.stem not in (planted.file, "Conclusion"):
            shutil.copy(path, work)
    original = (folder / f"{planted.file}.v").read_text("utf-8")
    (work / f"{planted.file}.v").write_text(planted.text(original, change), "utf-8")
    command = ["coqc", "-q", "-R", str(folder.parent / "theory"), "Orbitproof", "-Q", ".", "", f"{planted.file}.v"]
    return subprocess.run(command, cwd=work, capture_output=True, check=False).returncode == 0
