"""The help of commands, filled to the width of the terminal, and their errors in one line."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from textwrap import TextWrapper
from typing import Any, NoReturn

from orbitproof.shared.misspelt import with_remedy

_FILLED = 100
"""A line of a text that is longer goes on in the next one."""

_COMMENT = " " * 6
"""How far what is said of an example stands in."""


class HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Descriptions and examples line by line; what is longer than the terminal is wide is broken between words."""

    def start_section(self, heading: str | None) -> None:
        """Begin a group of options."""
        super().start_section(heading and "\n".join(filled(heading, self._width - 1)))

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return "\n".join(line for paragraph in _paragraphs(text) for line in filled(paragraph, width))

    def _split_lines(self, text: str, width: int) -> list[str]:
        """What an option does. Names such as sun-jupiter stay whole."""
        return _wrapper(width).wrap(" ".join(text.split()))

    def _format_usage(self, *arguments: Any, **options: Any) -> str:
        """The usage. Options of which one is to be given stand below each other where they do not fit."""
        lines = super()._format_usage(*arguments, **options).split("\n")
        margins = (line[: len(line) - len(line.lstrip())] for line in lines)
        return "\n".join(
            line if len(line) <= self._width else line.replace(" | ", f"\n{margin} | ")
            for line, margin in zip(lines, margins, strict=True)
        )


class Parser(argparse.ArgumentParser):
    """Reports a wrong command line in one line, exit code 2, like every other bad input."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and end."""
        self.exit(2, f"error: {with_remedy(message, self)}; see {self.prog} --help\n")


def add_command(commands: Any, name: str, meaning: str, examples: str) -> argparse.ArgumentParser:
    """A subcommand that does what `meaning` says, with examples below its help."""
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=meaning,
        description=f"{meaning[0].upper()}{meaning[1:]}.",
        epilog=examples,
        formatter_class=HelpFormatter,
        allow_abbrev=False,
    )
    return parser


def filled(text: str, width: int) -> list[str]:
    """A line as several that are not longer; those of a command end with a backslash.

    What follows a wide gap goes on below itself, or if it begins far to the right, stands below the command.

    >>> filled("  orbitproof verify candidates.json -o certificates.json", 42)
    ['  orbitproof verify candidates.json \\\\', '      -o certificates.json']
    >>> filled("  orbitproof explore   find families, write candidates", 40)
    ['  orbitproof explore   find families,', '                       write candidates']
    """
    if len(text) <= width:
        return [text]
    margin = " " * (len(text) - len(text.lstrip()))
    gap = re.search(r"(?<=\S) {2,}", text)
    if gap is None:
        is_command = text.lstrip().startswith("orbitproof ")
        return _command(text.strip(), width, margin) if is_command else _wrapper(width, margin).wrap(text.strip())
    if gap.end() > 0.6 * width:
        return [*filled(text[: gap.start()], width), *_wrapper(width, _COMMENT).wrap(text[gap.end() :].strip("()"))]
    lines = _wrapper(width, " " * gap.end()).wrap(text[gap.end() :])
    return [text[: gap.end()] + lines[0].lstrip(), *lines[1:]]


def _command(text: str, width: int, margin: str) -> list[str]:
    """Lines of a command, each but the last with a backslash; an option and the first of its values stay together."""
    words = re.findall(r"""-{1,2}[a-z][\w-]* (?!-)(?:'[^']*'|"[^"]*"|\S)+|(?:'[^']*'|"[^"]*"|\S)+""", text)
    lines = [margin + words[0]]
    for word in words[1:]:
        if len(lines[-1]) + 1 + len(word) > width - 2:
            lines.append(margin + "    " + word)
        else:
            lines[-1] += f" {word}"
    return [*(f"{line} \\" for line in lines[:-1]), lines[-1]]


def _wrapper(width: int, margin: str = "") -> TextWrapper:
    return TextWrapper(
        width, initial_indent=margin, subsequent_indent=margin, break_long_words=False, break_on_hyphens=False
    )


def _paragraphs(text: str) -> Iterator[str]:
    """The lines of a text, those joined that go on; exit codes begin a line."""
    paragraph = ""
    for line in text.strip("\n").splitlines():
        if paragraph and line.casefold().startswith("exit codes"):
            yield paragraph
            paragraph = ""
        paragraph = f"{paragraph} {line}" if paragraph else line
        if len(line) <= _FILLED or line.startswith(" "):
            yield paragraph
            paragraph = ""
    if paragraph:
        yield paragraph
