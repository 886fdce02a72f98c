"""What ids and names may look like: short, one line, and no sentences.

They stand in theorems and in tables, and nothing is concluded from them. Each is a pattern for the whole text, in a
form that JSON schemas share with Python; tests hold the schemas to them.
"""

from __future__ import annotations

import re

END = r"(?![\s\S])"

IDENTIFIER = r"^[A-Za-z_][A-Za-z0-9_]{0,59}" + END
"""The name of a coordinate, a parameter, a symmetry."""

ID = r"^(?=[^\n]{1,100}" + END + r")(?![^\n]*\. )[A-Za-z0-9][A-Za-z0-9._+=/()'-]*( [A-Za-z0-9._+=/()'-]+){0,4}" + END
"""The id of a claim, an atlas: at most five words; `titles.shown` says where it ends."""

ID_IN_WORDS = "use letters, digits and . _ + = / ( ) ' -, at most five words and 100 characters"

PIECE = r"^[A-Za-z0-9][A-Za-z0-9._+=/()'-]{0,99}" + END
"""The id of a piece of an atlas: one word."""

PIECE_IN_WORDS = "use one word of letters, digits and . _ + = / ( ) ' -"

LINE = (
    r"^[^\u0000-\u001f\u007f-\u009f\u00ad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff\ufff9-\ufffb]{0,4000}"
    + END
)
"""One line of free text without characters that steer how it is shown; it is quoted where it is printed."""


def own_name(name: str) -> str:
    """The name of something of ours beside names that files choose: no `IDENTIFIER`, so that no file can write it."""
    return f"({name})"


LEVEL_NAME = own_name("level")
"""The value of the first integral, as an input of a program or as the first coordinate of a claim."""


def fits(pattern: str, text: object) -> bool:
    """Whether a value is a text of this form."""
    return isinstance(text, str) and re.search(pattern, text) is not None
