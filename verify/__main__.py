"""Command line of the verifier: hands a file over to the command for its format, or to the one that is named."""

from __future__ import annotations

import gc
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path

from orbitproof.shared.interrupts import run_command
from orbitproof.shared.misspelt import meant

_COMMANDS: Mapping[str, str] = {
    "rows": "row_command",
    "atlas": "branch_command",
    "catalogue": "catalogue_command",
    "web": "web_command",
    "life": "life_command",
    "index": "index_command",
    "second-proof": "second_proofs",
}
"""Modules of `run`, each loaded only when it is asked for: they take a moment."""
_FORMATS: Mapping[str, str] = {
    "atlas": "atlas",
    "atlas-certificate": "atlas",
    "catalogue-certificate": "catalogue",
    "web": "web",
    "web-certificate": "web",
    "life-claim": "life",
    "life-certificate": "life",
    "index-certificate": "index",
}
"""Commands by the formats that files say they have; rows are the rest."""
_UNNAMED = ("rows", "second-proof")
"""Commands that no word asks for."""
_FLAGS = ("--recheck", "--integrate", "--fresh", "--quiet", "--json", "--lasting", "--combinations", "--indices")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words and words[0] in _COMMANDS and words[0] not in _UNNAMED:
        name, words = words[0], words[1:]
    elif "--formal" in words:
        # It stands above this room, which does not know it otherwise.
        return int(import_module("orbitproof.formal.command").main([word for word in words if word != "--formal"]))
    elif "--second-proof" in words:
        name, words = "second-proof", [word for word in words if word != "--second-proof"]
    else:
        name = _command_for(words)
    if name == "rows" and words and words[0].isidentifier() and not Path(words[0]).exists():
        remedy = meant(words[0], [command for command in _COMMANDS if command not in _UNNAMED])
        if remedy:
            print(f"error: {words[0]}: there is no such command and no such file{remedy}", file=sys.stderr)
            return 2
    # While modules are loaded all that is made stays: nothing has to be looked for that could go.
    gc.disable()
    try:
        command = import_module(f"orbitproof.verify.run.{_COMMANDS[name]}")
    finally:
        gc.enable()
    gc.freeze()
    code: int = command.main(words)
    return code


def _command_for(words: Sequence[str]) -> str:
    """The command for the format of the file that is named; what is wrong with the file is for it to say."""
    # What follows an option belongs to it, unless that one takes nothing.
    alone = (word for before, word in zip(("", *words), words, strict=False) if before in _FLAGS or before[:1] != "-")
    file = next((Path(word) for word in alone if word.endswith(".json") and Path(word).is_file()), None)
    if file is None:
        return "rows"
    from orbitproof.shared.formats import InputError, stated_format

    try:
        return _FORMATS.get(stated_format(file, ""), "rows")
    except InputError:
        return "rows"


if __name__ == "__main__":
    sys.exit(run_command(main))
