"""What ids, names and titles may look like: short, one line, and no sentences.

They stand in theorems and in tables, and nothing is concluded from them. Each is a pattern for the whole text, in a
form that JSON schemas share with Python; tests hold the schemas to them.
"""

from __future__ import annotations

import re

_END = r"(?![\s\S])"

IDENTIFIER = r"^[A-Za-z_][A-Za-z0-9_]{0,59}" + _END
"""Of a coordinate, a parameter, a symmetry."""

SYSTEM = r"^[A-Za-z][A-Za-z0-9_-]{0,59}" + _END
"""Of a system, a short one."""

ID = r"^(?=[^\n]{1,100}" + _END + r")(?![^\n]*\. )[A-Za-z0-9][A-Za-z0-9._+=/()'-]*( [A-Za-z0-9._+=/()'-]+){0,4}" + _END
"""Of a claim, an atlas: at most five words; `shown` says where it ends."""

ID_IN_WORDS = "use letters, digits and . _ + = / ( ) ' -, at most five words and 100 characters"

PIECE = r"^[A-Za-z0-9][A-Za-z0-9._+=/()'-]{0,99}" + _END
"""Of a piece of an atlas: one word."""

PIECE_IN_WORDS = "use one word of letters, digits and . _ + = / ( ) ' -"

TITLE = (
    r"^(?=[^\n]{1,200}" + _END + r")(?![^\n]*[.,] +[A-Z])"
    r"[(A-Za-z0-9\u00c0-\u024f\u0370-\u03ff][A-Za-z0-9\u00c0-\u024f\u0370-\u03ff .,_+*/^=<>()'-]*" + _END
)
"""What people call a system, its first integral, a body; with no second sentence."""

LONGEST_TITLE = 64
"""Of what is not known to every installation."""

LINE = (
    r"^[^\u0000-\u001f\u007f-\u009f\u00ad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff\ufff9-\ufffb]{0,4000}"
    + _END
)
"""One line of free text without characters that steer how it is shown; it is quoted where it is printed."""


def fits(pattern: str, text: object) -> bool:
    """Whether a value is a text of this form."""
    return isinstance(text, str) and re.search(pattern, text) is not None


def shown(name: str) -> str:
    """An id as sentences and tables have it: one of several words in quotes, which no id contains.

    >>> shown("L1-k4"), shown("L1 k=4")
    ('L1-k4', '"L1 k=4"')
    """
    return f'"{name}"' if " " in name else name


def is_title(text: object) -> bool:
    """Whether a value is a title that a user may give."""
    return isinstance(text, str) and len(text) <= LONGEST_TITLE and fits(TITLE, text)
