"""What computes: names, versions and a digest of the sources (section 10.2)."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from functools import cache
from importlib import metadata, resources

import flint

from orbitproof.shared.sources import source_digest

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


@cache
def software() -> dict[str, str]:
    """Names and versions of what computes, with a digest of the sources that a proof rests on (section 10.2)."""
    return _with_digest(ON_WHICH_NOTHING_RESTS)


@cache
def installed() -> dict[str, str]:
    """The same with a digest of all sources of verify and shared: what workers of one run have in common."""
    return _with_digest(())


def _with_digest(left_out: Sequence[str]) -> dict[str, str]:
    try:
        version = metadata.version("orbitproof")
    except metadata.PackageNotFoundError:
        version = "not installed"
    packages = [(name, resources.files(f"orbitproof.{name}")) for name in ("shared", "verify")]
    return {
        "orbitproof": version,
        "source": source_digest(packages, left_out),
        "python": platform.python_version(),
        "python-flint": str(flint.__version__),
        "FLINT": str(flint.__FLINT_VERSION__),
        "numpy": metadata.version("numpy"),
    }
