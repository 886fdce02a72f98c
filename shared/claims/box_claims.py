"""What a row of a candidates file may claim of a box."""

from typing import get_args

from orbitproof.shared.claims.candidate import Candidate
from orbitproof.shared.claims.equilibria import Equilibrium, HopfPoint
from orbitproof.shared.claims.heteroclinic import HeteroclinicOrbit
from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
from orbitproof.shared.claims.homoclinic_curve import HomoclinicCurve
from orbitproof.shared.claims.periodic import PeriodicOrbit
from orbitproof.shared.claims.periodic_bifurcation import PeriodicBifurcation
from orbitproof.shared.codec import kinds_said

InSection = PeriodicOrbit | PeriodicBifurcation
"""A claim of which no symmetry of a reversible system is used: its box lies in a section."""

WithoutReversor = InSection | Equilibrium | HopfPoint | HomoclinicOrbit | HeteroclinicOrbit | HomoclinicCurve
"""A claim of which no symmetry of a reversible system is used."""

KINDS_WITHOUT_REVERSOR: dict[str, type[WithoutReversor]] = {
    name: claim for claim in get_args(WithoutReversor) for name in kinds_said(claim)
}
"""The types of these, by kind."""

BoxClaim = Candidate | WithoutReversor
"""What a row of a candidates file claims of a box."""
