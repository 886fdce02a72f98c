"""The statements of docs/theorems, from certificates: ``python docs/theorems.py FOLDER ..``.

Between ``<!-- theorem ID -->`` and ``<!-- end -->`` a page has the words of the proved certificate ID, without its
list of resonances. Each certificate is checked again first. A page keeps the words of a certificate that no folder
holds, and the command names it.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path

from archive import certificates_in

from orbitproof.figures.report import Refused, check_files
from orbitproof.figures.report.formulas import typeset
from orbitproof.shared import InputError

PAGES = Path(__file__).resolve().parent / "theorems"
MARKED = re.compile(r"(<!-- theorem (\S+) -->\n\n)(.*?)(\n\n<!-- end -->)", re.DOTALL)
EXACT = re.compile(r"-?0x[0-9a-f]+p[-+]?[0-9]+")
LIST = re.compile(r"^Hypothesis \S+ of the list:", re.MULTILINE)
"""The line with which the list of a curve begins. Lists come last."""


def as_page(theorem: str) -> str:
    """A theorem as Markdown: each line a paragraph, but for the points of a list, which stay together."""
    lines = list(map(in_markdown, LIST.split(theorem)[0].strip().splitlines()))
    told = lines[0]
    for before, line in pairwise(lines):
        told += ("\n" if before.startswith("- ") and line.startswith("- ") else "\n\n") + line
    return re.sub(r"\n{3,}", "\n\n", told)


def in_markdown(line: str) -> str:
    """A line with its formulas between dollars, and exact numbers as code."""
    runs = (run if isinstance(run, str) else f"${_latex(run.latex)}$" for run in typeset(line))
    return EXACT.sub(r"`\g<0>`", "".join(runs))


def _latex(text: str) -> str:
    """LaTeX that Markdown leaves as it is: no sign that it would take for an escape."""
    return re.sub(r" +", " ", text.replace(r"\{", r"\lbrace ").replace(r"\}", r"\rbrace"))


def theorems(folder: Path) -> dict[str, str]:
    """The words of every certificate of a curve, surface or web in a folder, by its id; each is checked again.

    Raises:
        InputError: if there is none, or a file cannot be read.
        Refused: if one does not stand.
    """
    ((_, files),) = certificates_in([folder]).items()
    checked = [each for each in check_files(files, quiet=False) if each.part in ("arc", "web")]
    return {
        each.name: each.document["statement"]["theorem"] for each in checked if each.document["verdict"] == "proved"
    }


def written(page: str, known: Mapping[str, str]) -> tuple[str, list[str]]:
    """A page with the words that are known, and the ids of those that are not."""
    missing = [id for _, id, _, _ in MARKED.findall(page) if id not in known]
    text = MARKED.sub(
        lambda found: found[1] + (as_page(known[found[2]]) if found[2] in known else found[3]) + found[4], page
    )
    return text, missing


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 1 if there is no certificate for some theorem."""
    parser = argparse.ArgumentParser(description="Write the statements of docs/theorems from certificates.")
    parser.add_argument(
        "folders", nargs="+", type=Path, metavar="FOLDER", help="certificates, as make branches makes them"
    )
    parser.add_argument("--pages", type=Path, default=PAGES, help="the folder of pages (default: docs/theorems)")
    options = parser.parse_args(arguments)
    known: dict[str, str] = {}
    try:
        for folder in options.folders:
            known |= theorems(folder)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except Refused as error:
        print(f"error: {error}: a certificate that does not stand is not told; prove it again", file=sys.stderr)
        return 1
    left: list[str] = []
    for path in sorted(options.pages.glob("*.md")):
        text, missing = written(path.read_text("utf-8"), known)
        path.write_text(text, "utf-8")
        left += missing
    for id in left:
        print(f"{id}: no certificate; its words stay as they are", file=sys.stderr)
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
