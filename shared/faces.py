"""Faces of rooms: the names that a room hands on, each loaded when it is asked for."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

_IMPORT = re.compile(r"^from (\.\S*) import (\w+) as \2$", re.MULTILINE)


def face(room: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of the room whose ``__init__.py`` is `file`.

    The stub beside it, which type checkers read, says on a line each which module has a name, or that it is one.
    """
    with open(f"{file}i", encoding="utf-8") as stub:
        sources = {name: source for source, name in _IMPORT.findall(stub.read())}

    def attribute(name: str) -> Any:
        if name not in sources:
            raise AttributeError(f"{room} has no {name!r}")
        source = sources[name]
        if source == ".":
            return import_module(f"{room}.{name}")
        value = getattr(import_module(source, room), name)
        # Asked for once.
        setattr(sys.modules[room], name, value)
        return value

    return attribute, lambda: sorted(sources), sorted(sources)
