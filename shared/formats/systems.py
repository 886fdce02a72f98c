"""Files of systems: a description as JSON, or the same names defined in a Python file.

A JSON file is data. A Python file is the user's own program: it is run when it is named on a command line.
"""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from orbitproof.shared.formats.documents import InputError, read_document
from orbitproof.shared.systems import (
    KEYS,
    DescriptionError,
    ReversibleSystem,
    System,
    described,
    described_plainly,
    fault,
)


def load_system(path: str | Path) -> System:
    """The system that a file describes, its symmetries and first integral tried at sample points.

    A `ReversibleSystem`; of a description with neither R nor section a `System`, which `verify.enclose` takes.

    Arguments:
        path: of a ``.json`` file, or of a ``.py`` file, which is run; ``FILE:REVERSOR`` takes a further reversing
            symmetry of the system in place of R.

    Raises `InputError`, one line that names the file, what is wrong and the remedy.
    """
    file = Path(path)
    name, colon, reversor = str(path).rpartition(":")
    if colon and not file.exists():
        return under_reversor(load_system(name), reversor, str(path))
    if file.suffix == ".py":
        return _tried(_definitions(file), f"{file}: ")
    entry = read_document(file, "system")
    return _tried({key: value for key, value in entry.items() if key not in ("format", "version")}, f"{file}: ")


def define_system(description: Mapping[str, Any]) -> System:
    """The system of a description: the keys of a system's file (docs/own-system.md), formulas as text or functions.

    A `ReversibleSystem`; of a description with neither R nor section a `System`, which `verify.enclose` takes.

    Raises `InputError`, one line that says what is wrong.

    >>> from orbitproof import shared
    >>> shared.define_system({
    ...     "name": "michelson", "state": "x y z", "parameters": "c", "family_parameter": "c", "section": "x",
    ...     "field": lambda x, y, z, c: (y, z, c**2 - y - x**2 / 2), "R": {"x": -1, "z": -1},
    ... })
    <ReversibleSystem michelson: state x y z, parameters c>
    """
    return _tried(description, "")


def under_reversor(system: System, reversor: str, source: str) -> ReversibleSystem:
    """The system with one of its further reversing symmetries for R. Raises `InputError`."""
    if not isinstance(system, ReversibleSystem):
        raise InputError(f"{source}: {system.name} has no reversing symmetry; leave the name after the colon out")
    try:
        return system.under(reversor)
    except ValueError as error:
        raise InputError(f"{source}: {error}") from None


def _tried(entry: Mapping[str, Any], source: str) -> System:
    try:
        plain = isinstance(entry, Mapping) and "R" not in entry and "section" not in entry
        system: System = described_plainly(entry) if plain else described(entry)
    except DescriptionError as error:
        raise InputError(f"{source}{error}") from None
    wrong = fault(system)
    if wrong is not None:
        raise InputError(f"{source}{wrong}")
    return system


def _definitions(path: Path) -> Mapping[str, Any]:
    """What a Python file defines under the names of a description."""
    if not path.is_file():
        raise InputError(f"{path}: cannot be read; give the path of a system's file")
    try:
        names = runpy.run_path(str(path))
    except (Exception, SystemExit) as error:
        line = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"{path}: cannot be run: {line}; correct the file") from None
    for name, value in names.items():
        near = [] if name in KEYS or name.startswith("_") or callable(value) else get_close_matches(name, KEYS, 1, 0.75)
        if near:
            raise InputError(f"{path}: {name}: is no key; write {near[0]}, or begin a name of your own with _")
    return {key: names[key] for key in KEYS if key in names}
