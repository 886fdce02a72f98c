"""What computes: names, versions and a digest of the sources (section 10.2)."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import flint
import numpy

from orbitproof import __version__, shared
from orbitproof.shared.sources import source_digests

ON_WHICH_NOTHING_RESTS = (
    *(
        "verify/oracle",
        "verify/attempt",
        "verify/words",
        "verify/run",
        "verify/second_proof",
        "verify/alone",
        "verify/enclose",
    ),
    *("verify/scripting.py", "verify/__main__.py", "verify/__init__.py"),
    *("shared/processes.py", "shared/cluster.py", "shared/interrupts.py", "shared/extras.py", "shared/arguments.py"),
    "shared/wording.py",
)
"""What finds, words and moves what is proved, and proves nothing: a change there makes no proof another one."""

_PROGRAM = "program"
_SEVERAL = "several"


@cache
def software() -> dict[str, str]:
    """Names and versions of what computes, with two digests of sources (section 10.2).

    ``source`` is that of the sources that a proof rests on, ``program`` that of all sources of verify and shared, by
    which words are made too, and what workers of one run have in common.
    """
    packages = [("shared", Path(shared.__file__).parent), ("verify", Path(__file__).parents[1])]
    source, program = source_digests(packages, ON_WHICH_NOTHING_RESTS, ())
    return {
        "orbitproof": __version__,
        "source": source,
        _PROGRAM: program,
        "python": sys.version.split()[0],
        "python-flint": str(flint.__version__),
        "FLINT": str(flint.__FLINT_VERSION__),
        "numpy": numpy.__version__,
    }


def differs_here(made_by: Mapping[str, str]) -> dict[str, str]:
    """The software that a proof rests on where it is another one here, with the versions here; empty if all agree."""
    here = software()
    return {name: here[name] for name in here if name != _PROGRAM and made_by.get(name) != here[name]}


def is_of_this_program(made_by: Mapping[str, str]) -> bool:
    """Whether a certificate says that this very program made all of it, its words included.

    Sources of one version that only word things otherwise have another ``program``.
    """
    here = software()
    same = all(made_by.get(name) == here[name] for name in ("orbitproof", "source"))
    return same and made_by.get(_PROGRAM, here[_PROGRAM]) == here[_PROGRAM]


def completed_here(made_by: Mapping[str, str]) -> dict[str, str]:
    """What made a certificate to which this program has added something."""
    return {**made_by} if is_of_this_program(made_by) else {**made_by, _PROGRAM: _SEVERAL}
