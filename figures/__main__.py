"""Command line: pictures of families with their certified bifurcations."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from shared.formats import InputError, read_candidates

_EXAMPLES = """\
examples:
  python -m figures family candidates.json certificates.json -o figures-out/
  python -m figures family candidates.json certificates.json --family halo-family.json -o figures-out/
  python -m figures family candidates.json -o figures-out/        (no certificates: all points hollow)

A marker is filled if the certificate of its candidate says "proved", and hollow otherwise. Family files
are written by explore, with its option --family-output.
Exit codes: 0 pictures written, 2 bad input.
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """One line and exit code 2, like every other bad input."""
        self.exit(2, f"error: {message}; see {self.prog} --help\n")


def argument_parser() -> argparse.ArgumentParser:
    """The command line: its commands and options."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = _Parser(
        prog="python -m figures",
        description="Pictures of families of symmetric periodic orbits (PDF and PNG).",
        epilog=_EXAMPLES,
        formatter_class=raw,
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    family = commands.add_parser(
        "family", help="a family, its resonances and what is certified", epilog=_EXAMPLES, formatter_class=raw
    )
    family.add_argument("candidates", type=Path, help="candidates file (JSON)")
    family.add_argument("certificates", type=Path, nargs="?", help="certificates file; without it nothing is filled")
    family.add_argument("--family", type=Path, nargs="+", default=[], metavar="FILE", help="traced families (JSON)")
    family.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder for the pictures")
    family.add_argument("--quiet", action="store_true", help="no messages on standard error")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    arguments = argument_parser().parse_args(argv)
    try:
        for path in draw(arguments):
            print(path)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: pictures already written are kept", file=sys.stderr)
        return 1
    return 0


def draw(arguments: argparse.Namespace) -> list[Path]:
    """Read everything, then write the pictures; returns their paths. Raises `InputError`."""
    from figures.family import MarkedPoint, assign, mark_candidates
    from figures.family_file import read_families

    candidates = read_candidates(arguments.candidates)
    marks = mark_candidates(candidates, arguments.certificates, arguments.candidates)
    families = [family.refined() for path in arguments.family for family in read_families(path)]

    # Matplotlib takes a second to load: only after the input is known to be good.
    from figures.draw import draw_family, draw_marks
    from figures.style import check_folder, close, save, use_style

    check_folder(arguments.output)
    written: list[Path] = []
    names: set[str] = set()
    with use_style():
        on_family, alone = assign(families, marks)
        for family, members in zip(families, on_family, strict=True):
            figure = draw_family(family, members)
            written += save(figure, arguments.output / _name(f"family-{family.system.name}-{family.name}", names))
            close(figure)
        groups: dict[str, list[MarkedPoint]] = {}
        for mark in alone:
            groups.setdefault(mark.candidate.system.name, []).append(mark)
        for system, members in groups.items():
            if not arguments.quiet:
                print(f"{system}: {len(members)} points lie on no family given with --family", file=sys.stderr)
            figure = draw_marks(members)
            written += save(figure, arguments.output / _name(f"points-{system}", names))
            close(figure)
    return written


def _name(text: str, taken: set[str]) -> str:
    stem = re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-.")
    name, number = stem, 2
    while name in taken:
        name, number = f"{stem}-{number}", number + 1
    taken.add(name)
    return name


if __name__ == "__main__":
    sys.exit(main())
