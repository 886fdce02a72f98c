"""The help of commands, filled to the width of the terminal."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from textwrap import TextWrapper

_FILLED = 100
"""A line of a text that is longer goes on in the next one."""


class HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Descriptions and examples line by line; what is longer than the terminal is wide is broken between words."""

    def start_section(self, heading: str | None) -> None:
        """Begin a group of options."""
        super().start_section(heading and "\n".join(filled(heading, self._width - 1)))

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return "\n".join(line for paragraph in _paragraphs(text) for line in filled(paragraph, width))


def filled(text: str, width: int) -> list[str]:
    """A line as several that are not longer; those of a command end with a backslash.

    >>> filled("  orbitproof verify candidates.json -o certificates.json", 42)
    ['  orbitproof verify candidates.json -o \\\\', '      certificates.json']
    """
    margin = " " * (len(text) - len(text.lstrip()))
    is_command = text.lstrip().startswith("orbitproof ") and "  " not in text.strip()
    wrapper = TextWrapper(
        width - 2 if is_command else width,
        initial_indent=margin,
        subsequent_indent=margin + "    " * is_command,
        break_long_words=False,
        break_on_hyphens=False,
    )
    whole = re.sub(r"""'[^']*'|"[^"]*\"""", lambda quoted: quoted[0].replace(" ", "\0"), text.strip())
    lines = [text] if len(text) <= width else [line.replace("\0", " ") for line in wrapper.wrap(whole)]
    return [*(f"{line} \\" for line in lines[:-1]), *lines[-1:]] if is_command else lines or [""]


def _paragraphs(text: str) -> Iterator[str]:
    """The lines of a text, those joined that go on."""
    paragraph = ""
    for line in text.strip("\n").splitlines():
        paragraph = f"{paragraph} {line}" if paragraph else line
        if len(line) <= _FILLED or line.startswith(" "):
            yield paragraph
            paragraph = ""
    if paragraph:
        yield paragraph
