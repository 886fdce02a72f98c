"""A worker process of the verifier in which the integration of some rows goes wrong, whether it is forked or new."""

from __future__ import annotations

import resource
import time
from collections.abc import Mapping
from functools import partial
from typing import Any

from flint import fmpz

import orbitproof.verify.run.other_boxes
from orbitproof.shared.claims import Candidate
from orbitproof.shared.processes import Report
from orbitproof.verify.certificate import certify
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import enclose_iterates
from orbitproof.verify.run.rows import certify_task as sound_task

EXCEPTIONS: dict[str, type[Exception]] = {
    kind.__name__: kind for kind in (MemoryError, TypeError, AssertionError, RecursionError, OSError, IndexError)
}


def integrate(candidate: Candidate, settings: Any, *arguments: Any) -> Any:
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
    return enclose_iterates(candidate, settings, ORACLE, *arguments)


def certify_task(argument: Mapping[str, Any], report: Report) -> Mapping[str, Any]:
    """In place of `verify.certificate.side_by_side.certify_task`."""
    orbitproof.verify.run.other_boxes.certify = partial(certify, integrate=integrate)  # type: ignore[assignment]
    return sound_task(argument, report)
