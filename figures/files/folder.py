"""The folder into which a command writes."""

from __future__ import annotations

import re
from pathlib import Path

from orbitproof.shared.formats import InputError, check_writable


def check_folder(folder: Path) -> None:
    """Create the output folder; raises `InputError` if that is not possible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError(f"{folder}: is a file; give the path of a folder to write into") from None
    except OSError as error:
        raise InputError(f"{folder}: cannot be created ({error.strerror}); choose another folder") from None
    check_writable(folder / "file")


def file_name(text: str) -> str:
    """A name for files made of an id: what is no letter, digit or dot becomes a hyphen."""
    return re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-.") or "atlas"
