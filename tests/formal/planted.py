"""Numbers of the files of a row, each changed by one unit, and whether Coq still accepts the lemma about it."""

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
BEGINNING = "From Bignums Require Import BigZ.\nFrom Orbitproof Require Import Rows.\nRequire Import Row.\n"
"""Before the lemma on the beginning, which `Conclusion.v` has among all else."""


@dataclass(frozen=True)
class Planted:
    """A number of a file, of which the digits begin at a place.

    Attributes:
        file: its name without ending.
        of: what the number belongs to, by the name of the definition.
    """

    file: str
    of: str
    begin: int
    end: int

    @property
    def seen_by(self) -> str:
        """The lemma that compares it: a position is where a step ends, or the beginning; an image, of a crossing."""
        what, _, number = self.of.rpartition("_")
        match what:
            case "position":
                return f"step_{number}" if int(number) else "beginning"
            case "image":
                return f"crossing_{number}"
            case "the":
                return self.file.replace("Crossing", "crossing_")
            case _:
                return f"step_{number}"

    def text(self, original: str, change: int) -> str:
        """The file with this number changed; 0 becomes 1, which is a number everywhere."""
        value = int(original[self.begin : self.end], 0)
        value += change if value else abs(change)
        return f"{original[: self.begin]}{value}{original[self.end :]}"


def choices(text: str) -> Iterator[tuple[int, int]]:
    """Where the definition of steps has what may be any that holds.

    These are tubes, and on the way onto the section guesses for powers, which count only times the distance to it, and
    the elapsed time of the last step, which is compared with the times of other crossings: Coq bounds all their errors.
    """
    for tube in re.finditer(r"\n  \[\[[^\]]*\](?:;\s*\[[^\]]*\])*(\] \d+)", text):
        yield tube.start(), tube.start(1)
        if text.startswith("Definition the_steps "):
            powers = text.rindex("\n  [[[", 0, tube.start())
            yield powers, tube.start()
            if text.find("Step ", tube.start()) < 0:
                yield text.rindex("];\n  [[", 0, powers), powers


def numbers(file: Path) -> Iterator[Planted]:
    """All numbers in the definitions of a file but those that are a choice.

    Of `Row.v` those of where the orbits are: the rest is what is claimed.
    """
    text = file.read_text("utf-8")
    for found in re.finditer(r"^Definition (\w+)(.*?)\.$", text, re.MULTILINE | re.DOTALL):
        if file.stem == "Row" and not re.fullmatch(r"(position|image)_\d+", found[1]):
            continue
        free = list(choices(found[0])) if file.stem != "Row" else []
        for number in NUMBER.finditer(found[0], found[0].index(":=")):
            if not any(begin < number.start() < end for begin, end in free):
                begin, end = number.span()
                yield Planted(file.stem, found[1], found.start() + begin, found.start() + end)


def lemma(folder: Path, name: str) -> str:
    """The file of a row with this lemma, without the other steps in it."""
    if name == "beginning":
        (found,) = re.findall(r"^Lemma beginning .*?Qed\.$", (folder / "Conclusion.v").read_text("utf-8"), re.M | re.S)
        return BEGINNING + found
    head = r"^(?=Definition the_step_\d)"
    for path in folder.glob(f"{name.split('_')[0].capitalize()}*.v"):
        first, *steps = re.split(head, path.read_text("utf-8"), flags=re.MULTILINE)
        for text in [first + step for step in steps] or [first]:
            if f"Lemma {name} " in text:
                return text
    raise ValueError(name)


def accepted(folder: Path, planted: Planted, change: int, work: Path) -> bool:
    """Whether Coq accepts the lemma about a number that is changed, of a row that is compiled."""
    work.mkdir(exist_ok=True)
    for path in work.iterdir():
        path.unlink()
    original = (folder / f"{planted.file}.v").read_text("utf-8")
    changed = work / f"{planted.file}.v"
    changed.write_text(planted.text(original, change), "utf-8")
    files = ["Lemma"]
    if planted.file == "Row":
        files = ["Row", "Lemma"]
        text = lemma(folder, planted.seen_by)
    else:
        shutil.copy(folder / "Row.vo", work)
        text = lemma(work, planted.seen_by)
        changed.unlink()
    (work / "Lemma.v").write_text(text, "utf-8")
    command = ["coqc", "-q", "-R", str(folder.parent / "theory"), "Orbitproof", "-Q", ".", ""]
    done = [
        subprocess.run([*command, f"{name}.v"], cwd=work, capture_output=True, check=False).returncode for name in files
    ]
    assert done[:-1] == [0] * (len(files) - 1), planted
    return done[-1] == 0


def drawn(folder: Path, names: list[str], how_many: int, seed: int) -> list[Planted]:
    """Numbers of some files, as many of each, drawn at random."""
    source = random.Random(seed)
    each = -(-how_many // len(names))
    found = [source.sample(list(numbers(folder / f"{name}.v")), each) for name in names]
    return [planted for together in zip(*found, strict=True) for planted in together][:how_many]


if __name__ == "__main__":
    # python tests/formal/planted.py FOLDER/ROW 100: which of so many numbers of a compiled row Coq accepts changed.
    row, count = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    names = sorted(path.stem for path in row.glob("*.v") if path.stem not in ("Conclusion", "Statement"))
    kept = []
    for n, planted in enumerate(drawn(row, names, count, seed=51), start=1):
        if accepted(row, planted, (-1) ** n, row.parent / "planted"):
            kept.append(planted)
        print(f"{n} of {count}: {planted}, {n - len(kept)} refused", file=sys.stderr)
    print(f"{row.name}: {count - len(kept)} of {count} refused", *kept, sep="\n  ")
