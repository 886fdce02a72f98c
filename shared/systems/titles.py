"""What systems may be called, and how ids stand in sentences."""

from __future__ import annotations

from orbitproof.shared.systems.names import END

SYSTEM = r"^[A-Za-z][A-Za-z0-9_-]{0,59}" + END
"""The short name of a system."""

TITLE = (
    r"^(?=[^\n]{1,200}" + END + r")(?![^\n]*[.,] +[A-Z])"
    r"[(_A-Za-z0-9\u00c0-\u024f\u0370-\u03ff][A-Za-z0-9\u00c0-\u024f\u0370-\u03ff .,_+*/^=<>()'-]*" + END
)
"""What people call a system, its first integral, a body; with no second sentence."""


def shown(name: str) -> str:
    """An id as sentences and tables have it: one of several words in quotes, which no id contains.

    >>> shown("L1-k4"), shown("L1 k=4")
    ('L1-k4', '"L1 k=4"')
    """
    return f'"{name}"' if " " in name else name
