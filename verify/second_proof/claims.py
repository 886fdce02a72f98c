"""Every kind of claim that has a second proof. README, sections 1, 9, 13, 17 and 18."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import proof
from .births import ProvedBirth, prove_birth
from .equilibria import EquilibriumStatement, ProvedEquilibrium, prove_equilibrium, read_equilibrium
from .equilibrium_curve_statement import CurveStatement, read_curve
from .equilibrium_curves import ProvedCurve, prove_curve
from .halves import SymmetricStatement, read_symmetric
from .hopf_points import ProvedHopf, prove_hopf
from .periodic import ProvedPeriodic, prove_periodic
from .periodic_bifurcation import (
    BifurcationStatement,
    ProvedPeriodicBifurcation,
    prove_bifurcation,
    read_bifurcation,
)
from .periodic_statement import PeriodicStatement, read_periodic
from .periodic_torus import ProvedTorus, prove_torus
from .proof import NotProved, Proved
from .statement import Statement, read, read_statement
from .symmetric_orbit import ProvedSymmetric, prove_symmetric

TORUS = "periodic-torus"
PROOFS = {
    "periodic": prove_periodic, TORUS: prove_torus, "reversor_breaking": prove_birth,
    "equilibrium": prove_equilibrium, "hopf": prove_hopf,
    "stable_orbit": prove_symmetric, "orbit": prove_symmetric, "invariant_tori": prove_symmetric,
}  # fmt: skip
"""By kinds that are named in full."""
Outcome = (
    Proved | ProvedPeriodic | ProvedPeriodicBifurcation | ProvedTorus | ProvedBirth | ProvedSymmetric
    | ProvedEquilibrium | ProvedHopf | ProvedCurve | NotProved
)  # fmt: skip


def _is_of_curve(certificate: Mapping[str, Any]) -> bool:
    return "atlas" in read(certificate, "statement", dict)


def _kind(certificate: Mapping[str, Any]) -> str:
    kind: str = read(certificate, "statement.candidate.kind", str)
    return kind


def read_claim(
    certificate: Mapping[str, Any],
) -> Statement | PeriodicStatement | BifurcationStatement | SymmetricStatement | EquilibriumStatement | CurveStatement:
    """The statement of a certificate. Raises `BadCertificate`, and `CannotFollow` if no theorem is about it."""
    if _is_of_curve(certificate):
        return read_curve(certificate)
    kind = _kind(certificate)
    if kind == "periodic":
        return read_periodic(certificate)
    if kind.startswith("periodic-"):
        return read_bifurcation(certificate, torus=kind == TORUS)
    if kind in ("equilibrium", "hopf"):
        return read_equilibrium(certificate)
    return read_symmetric(certificate) if kind in PROOFS else read_statement(certificate)


def second_proof(certificate: Mapping[str, Any]) -> Outcome:
    """Prove what a certificate claims, from its statement, centre and frames alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    if _is_of_curve(certificate):
        return prove_curve(certificate)
    kind = _kind(certificate)
    if kind in PROOFS:
        return PROOFS[kind](certificate)
    return prove_bifurcation(certificate) if kind.startswith("periodic-") else proof.second_proof(certificate)
