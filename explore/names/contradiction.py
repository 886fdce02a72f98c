"""Why there is no orbit where a file or a start names one."""

from __future__ import annotations


class NoOrbit(Exception):
    """The file's entry leads to no periodic orbit; one line says why."""


class Contradiction(NoOrbit):
    """The entry leads to an orbit of which something else is so than what is said; one line, with both numbers."""
