"""The command lines that check certificates again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from orbitproof.figures.report.statements import is_proved
from orbitproof.figures.report.theorems import VERTEX, Checked, has_second_proof
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate.kinds import LIFE, WEB

Named = Callable[[Path], str]
"""How a file is called on the command line."""


def check_again(entries: Sequence[Checked], path: Path, named: Named, integrate: bool = False) -> str:
    """The command that checks the certificates of a file again, with all files that it needs."""
    there = [entry for entry in entries if entry.path == path]
    words = ["orbitproof", there[0].command, "--recheck", *(["--integrate"] if integrate else []), named(path)]
    files: list[Path] = []
    option = "--curve"
    for entry in there:
        option = "--certificates" if entry.part in (WEB, LIFE) else option
        files += [each.path for each in entry.rests_on]
        if (place := entry.document.get("place")) is not None:
            curve = curve_of(place, entries)
            if curve is None:
                return " ".join([*words, option, "CERTIFICATE-OF-THE-CURVE"])
            files.append(curve.path)
    names = [named(each) for each in dict.fromkeys(files)]
    return " ".join([*words, *([option, *names] if names else [])])


def curve_of(place: Any, entries: Sequence[Checked]) -> Checked | None:
    """The curve on which an orbit has a place, if it is among the certificates."""
    return next((each for each in entries if each.document["digest"] == place["rests_on"]["digest"]), None)


def second_proofs(entries: Sequence[Checked], named: Named) -> list[str]:
    """The commands for what is proved and has a second proof; the others of its file are left out by name."""
    rows = [entry for entry in entries if entry.part == VERTEX]
    lines = []
    for path in dict.fromkeys(entry.path for entry in rows):
        there = [entry for entry in rows if entry.path == path]
        followed = [entry.name for entry in there if is_proved(entry) and has_second_proof(entry)]
        only = "" if len(followed) == len(there) else f" --only {' '.join(map(shown, followed))}"
        lines += [f"orbitproof verify --second-proof {named(path)}{only}"] if followed else []
    return lines
