"""What a row of a candidates file may claim of a box."""

from orbitproof.shared.claims.candidate import Candidate
from orbitproof.shared.claims.periodic import PERIODIC, PeriodicOrbit
from orbitproof.shared.claims.periodic_bifurcation import PERIODIC_BIFURCATIONS, PeriodicBifurcation

InSection = PeriodicOrbit | PeriodicBifurcation
"""A claim of which no symmetry of a reversible system is used: its box lies in a section."""
KINDS_IN_SECTION = (PERIODIC, *PERIODIC_BIFURCATIONS)

BoxClaim = Candidate | InSection
"""What a row of a candidates file claims of a box."""
