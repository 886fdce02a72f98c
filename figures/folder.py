"""The folder into which a command writes."""

from __future__ import annotations

from pathlib import Path

from shared.formats import InputError, check_writable


def check_folder(folder: Path) -> None:
    """Create the output folder; raises `InputError` if that is not possible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError(f"{folder}: is a file; give the path of a folder to write into") from None
    except OSError as error:
        raise InputError(f"{folder}: cannot be created ({error.strerror}); choose another folder") from None
    check_writable(folder / "file")
