"""Numbers of the files of a row, each changed by one unit, and whether Coq still accepts the file."""

from __future__ import annotations

import random
import re
import shutil
import subprocess
import sys
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

    @property
    def files(self) -> list[str]:
        """What has to be compiled to see it: of `Row.v` also the step that goes there, or the crossing."""
        if self.file != "Row":
            return [self.file]
        what, number = self.of.split("_")
        return ["Row", f"Crossing{number}" if what == "image" else f"Step{max(1, int(number))}"]

    def text(self, original: str, change: int) -> str:
        """The file with this number changed."""
        value = int(original[self.begin : self.end], 0) + change
        return f"{original[: self.begin]}{value}{original[self.end :]}"


def numbers(file: Path) -> Iterator[Planted]:
    """All numbers in the definitions of a file but those of a tube, which may be any that holds.

    Of `Row.v` those of where the orbits are: the rest is what is claimed.
    """
    text = file.read_text("utf-8")
    for found in re.finditer(r"^Definition (\w+)(.*?)\.$", text, re.MULTILINE | re.DOTALL):
        if file.stem == "Row" and not re.fullmatch(r"(position|image)_\d+", found[1]):
            continue
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
    """Whether Coq accepts the files of a compiled row in which one number is changed."""
    work.mkdir(exist_ok=True)
    for path in work.iterdir():
        path.unlink()
    if planted.file != "Row":
        shutil.copy(folder / "Row.vo", work)
    for name in planted.files:
        shutil.copy(folder / f"{name}.v", work)
    original = (folder / f"{planted.file}.v").read_text("utf-8")
    (work / f"{planted.file}.v").write_text(planted.text(original, change), "utf-8")
    command = ["coqc", "-q", "-R", str(folder.parent / "theory"), "Orbitproof", "-Q", ".", ""]
    return all(
        subprocess.run([*command, f"{name}.v"], cwd=work, capture_output=True, check=False).returncode == 0
        for name in planted.files
    )


if __name__ == "__main__":
    # python tests/formal/planted.py FOLDER/ROW 100: which of so many numbers of a compiled row Coq accepts changed.
    row, count = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    names = sorted(path.stem for path in row.glob("*.v") if path.stem not in ("Conclusion", "Statement"))
    planted = drawn(row, names, count, seed=51)
    kept = [p for n, p in enumerate(planted) if accepted(row, p, (-1) ** n, row.parent / "planted")]
    print(f"{row.name}: {len(planted) - len(kept)} of {len(planted)} refused", *kept, sep="\n  ")
