"""A second proof of what a certificate claims that shares no code with the rest: see README.md of this folder."""

from .births import ProvedBirth
from .claims import Outcome, read_claim, second_proof
from .elliptic_tori import Torsion
from .equilibria import ProvedEquilibrium
from .equilibrium_curves import ProvedCurve
from .hopf_points import ProvedHopf
from .jets import CannotFollow
from .periodic import ProvedPeriodic
from .periodic_bifurcation import ProvedPeriodicBifurcation
from .periodic_torus import ProvedTorus
from .proof import NotProved, Proved
from .statement import BadCertificate, read_statement
from .symmetric_orbit import ProvedSymmetric

__all__ = [
    "BadCertificate", "CannotFollow", "NotProved", "Outcome", "Proved", "ProvedBirth", "ProvedCurve",
    "ProvedEquilibrium", "ProvedHopf", "ProvedPeriodic", "ProvedPeriodicBifurcation", "ProvedSymmetric", "ProvedTorus",
    "Torsion", "read_claim", "read_statement", "second_proof",
]  # fmt: skip
