"""Proofs of bifurcations of symmetric periodic orbits, in ball arithmetic (docs/method.md).

`certify` takes claims, `Candidate` values, and gives a `Certificate` for each; `write` and `read` are their files,
`recheck` checks them again. Whole branches are proved by the command ``orbitproof verify atlas``. Nothing here imports
`orbitproof.explore`.
"""

from orbitproof.shared.formats import InputError
from orbitproof.verify.certificate import Certificate, Computation, Finding, Recheck
from orbitproof.verify.evidence import Hypothesis, Reason, bounds, certain_digits, decimal_interval
from orbitproof.verify.scripting import certify, read, recheck, write

__all__ = [
    "Certificate",
    "Computation",
    "Finding",
    "Hypothesis",
    "InputError",
    "Reason",
    "Recheck",
    "bounds",
    "certain_digits",
    "certify",
    "decimal_interval",
    "read",
    "recheck",
    "write",
]
