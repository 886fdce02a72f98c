"""The picture of the rooms of the proof side: ``python docs/house.py``, into docs/images/house.png.

Rows are the layers that import-linter holds the code to, so imports run down; sizes are counted.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.patches import FancyBboxPatch

ROOT = Path(__file__).resolve().parents[1]
CONTRACT = "verify is read from evidence to scripting"

ARGUMENT, APPROXIMATION, RUN = "#cfe3f5", "#fbe3c0", "#e4e4e4"
KINDS = {"oracle": APPROXIMATION, "attempt": APPROXIMATION} | dict.fromkeys(
    ("scripting", "enclose", "run", "branches", "theorems", "certificate", "words"), RUN
)
LEGEND = {"the argument: what these rooms return is true": ARGUMENT, "guesses: nothing rests on them": APPROXIMATION,
          "words, certificates, checking again, runs": RUN}  # fmt: skip

WIDTH, HEIGHT, GAP = 7.0, 0.62, 0.18


def layers() -> list[list[str]]:
    """The rooms of verify/, from the top: those of one row do not import each other."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    (found,) = (contract["layers"] for contract in contracts if contract["name"] == CONTRACT)
    return [layer.split(" : ") for layer in found]


def lines_of(room: Path) -> int:
    """Physical lines of a room, or of a module."""
    files = room.rglob("*.py") if room.is_dir() else [room.with_suffix(".py")]
    return sum(len(path.read_text("utf-8").splitlines()) for path in files)


def title_of(room: Path) -> str:
    """What its chapter is called."""
    chapter = room / "README.md"
    return chapter.read_text("utf-8").partition("\n")[0].removeprefix("# ") if chapter.exists() else "the Python face"


def draw(path: Path) -> None:
    """Draw the house."""
    rows = [*layers(), ["shared"]]
    figure, axes = plt.subplots(figsize=(8.4, 0.52 * len(rows) + 0.9))
    for number, rooms in enumerate(reversed(rows)):
        for place, name in enumerate(rooms):
            room = ROOT / "shared" if name == "shared" else ROOT / "verify" / name
            width = (WIDTH - GAP * (len(rooms) - 1)) / len(rooms)
            left, bottom = place * (width + GAP), number * (HEIGHT + GAP)
            box = FancyBboxPatch(
                (left, bottom), width, HEIGHT, "round,pad=0.02", fc=KINDS.get(name, ARGUMENT), ec="#555555", lw=0.6
            )
            axes.add_patch(box)
            size, margin, apart = (9, 0.12, 0.0) if len(rooms) < 4 else (6.7, 0.06, 0.2)
            middle = bottom + HEIGHT / 2
            axes.text(left + margin, middle + apart * HEIGHT, name, va="center", fontsize=size, family="monospace")
            words = f"{title_of(room)}, {lines_of(room):,}" if len(rooms) == 1 else f"{lines_of(room):,}"
            axes.text(
                left + width - margin, middle - apart * HEIGHT, words, va="center", ha="right", fontsize=min(size, 8)
            )
    handles = [plt.Rectangle((0, 0), 1, 1, fc=color, ec="#555555", lw=0.6) for color in LEGEND.values()]
    axes.legend(handles, LEGEND, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3, fontsize=7.5, frameon=False)
    axes.set(xlim=(-0.1, WIDTH + 0.1), ylim=(-0.1, len(rows) * (HEIGHT + GAP)))
    axes.set_axis_off()
    figure.savefig(path, dpi=160, bbox_inches="tight")


if __name__ == "__main__":
    draw(ROOT / "docs" / "images" / "house.png")
