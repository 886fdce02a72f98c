"""The sentences of theorems, which ``python tests/sentences.py`` stores in tests/data/sentences.txt.

Read what changes: each sentence says what is proved, and no more.
"""

from __future__ import annotations

import re
import sys
from difflib import ndiff
from pathlib import Path

from flint import ctx

sys.path.insert(0, str(Path(__file__).parent))

from support.box_sentences import Told, box_sentences
from support.curve_sentences import curve_sentences

STORED = Path(__file__).parent / "data" / "sentences.txt"


def all_sentences() -> dict[str, str]:
    """By name; where a name begins with that of another, in what the text differs from that one."""
    texts = _texts()
    bases = {name: name.partition(" / ")[0] for name in texts}
    return {
        name: "\n".join(lines(text)) if base == name else changes(lines(texts[base]), lines(text))
        for (name, base), text in zip(bases.items(), texts.values(), strict=True)
        if base == name or text != texts[base]
    }


def _texts() -> dict[str, str]:
    with ctx.workprec(200):
        told: list[Told] = [box_sentences(), curve_sentences()]
        pairs = [pair for each in told for pair in each]
    texts = dict(pairs)
    assert len(texts) == len(pairs)
    return texts


def lines(text: str) -> list[str]:
    """One sentence to a line; a line that goes on one of the text begins with the space before it."""
    return re.sub(r"(?<=[.;:]) (?=\S)", "\n ", text).split("\n")


def changes(before: list[str], after: list[str]) -> str:
    """The lines that are only in one of the two, in order."""
    return "\n".join(line for line in ndiff(before, after, None, None) if line[0] in "+-")


def stored() -> dict[str, str]:
    """The sentences of the file, by name."""
    parts = re.split(r"(?m)^== (.*) ==\n", STORED.read_text(encoding="utf-8"))[1:]
    return {name: text.rstrip("\n") for name, text in zip(parts[::2], parts[1::2], strict=True)}


if __name__ == "__main__":
    STORED.write_text("".join(f"== {name} ==\n{text}\n\n" for name, text in all_sentences().items()), encoding="utf-8")
