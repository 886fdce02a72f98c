"""Bifurcations of periodic orbits without symmetry as rows of a certificates file."""

from __future__ import annotations

from dataclasses import replace

from orbitproof.shared.claims import PERIODIC_BIFURCATIONS
from orbitproof.verify.certificate.periodic_rows import PERIODIC_ORBITS
from orbitproof.verify.evidence import Reason

_NOT_YET = Reason(
    "theorem",
    "bifurcations of periodic orbits without symmetry are not proved by this version",
    "claim a periodic orbit",
)

BIFURCATIONS_OF_PERIODIC_ORBITS = replace(
    PERIODIC_ORBITS,
    names=PERIODIC_BIFURCATIONS,
    theorem_of=lambda claim, form: _NOT_YET,
    said=lambda k, kind: kind,
)
