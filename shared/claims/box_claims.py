"""What a row of a candidates file may claim of a box."""

from orbitproof.shared.claims.candidate import Candidate
from orbitproof.shared.claims.equilibria import EQUILIBRIUM, HOPF, Equilibrium, HopfPoint
from orbitproof.shared.claims.periodic import PERIODIC, PeriodicOrbit
from orbitproof.shared.claims.periodic_bifurcation import PERIODIC_BIFURCATIONS, PeriodicBifurcation

InSection = PeriodicOrbit | PeriodicBifurcation
"""A claim of which no symmetry of a reversible system is used: its box lies in a section."""

WithoutReversor = InSection | Equilibrium | HopfPoint
"""A claim of which no symmetry of a reversible system is used."""

KINDS_WITHOUT_REVERSOR: dict[str, type[WithoutReversor]] = {
    PERIODIC: PeriodicOrbit,
    **dict.fromkeys(PERIODIC_BIFURCATIONS, PeriodicBifurcation),
    EQUILIBRIUM: Equilibrium,
    HOPF: HopfPoint,
}
"""The types of these, by kind."""

BoxClaim = Candidate | WithoutReversor
"""What a row of a candidates file claims of a box."""
