"""A worker process of the verifier in which the integration of some rows goes wrong: each imports this afresh."""

from __future__ import annotations

import resource
import time
from functools import partial
from multiprocessing.connection import Connection
from typing import Any

from flint import fmpz

import verify.workers
from shared.formats import Candidate
from verify.certify import certify
from verify.poincare import enclose_iterates

EXCEPTIONS: dict[str, type[Exception]] = {
    kind.__name__: kind for kind in (MemoryError, TypeError, AssertionError, RecursionError, OSError, IndexError)
}


def integrate(candidate: Candidate, *arguments: Any) -> Any:
    """The integrator, except for candidates named after what goes wrong."""
    fault = candidate.id
    if fault in EXCEPTIONS:
        raise EXCEPTIONS[fault]
    if fault == "endless":
        time.sleep(600)
    if fault == "FLINT":
        # FLINT has no exceptions: it ends the process.
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        fmpz(2) ** (2**40)
    return enclose_iterates(candidate, *arguments)


def serve(connection: Connection) -> None:
    """In place of `verify.workers._serve`."""
    verify.workers.certify = partial(certify, integrate=integrate)  # type: ignore[assignment]
    verify.workers._serve(connection)
