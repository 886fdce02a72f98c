"""Every kind of claim that has a second proof. README, sections 1 and 9."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import proof
from .periodic import PeriodicStatement, ProvedPeriodic, prove_periodic, read_periodic
from .proof import NotProved, Proved
from .statement import Statement, read, read_statement


def _is_periodic(certificate: Mapping[str, Any]) -> bool:
    return bool(read(certificate, "statement.candidate.kind", str) == "periodic")


def read_claim(certificate: Mapping[str, Any]) -> Statement | PeriodicStatement:
    """The statement of a certificate. Raises `BadCertificate`, and `CannotFollow` if no theorem is about it."""
    return read_periodic(certificate) if _is_periodic(certificate) else read_statement(certificate)


def second_proof(certificate: Mapping[str, Any]) -> Proved | ProvedPeriodic | NotProved:
    """Prove what a certificate claims, from its statement, centre and frames alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    return prove_periodic(certificate) if _is_periodic(certificate) else proof.second_proof(certificate)
