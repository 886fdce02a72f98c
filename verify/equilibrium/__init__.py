"""Equilibria of vector fields, and the Hopf points at which periodic orbits are born from them (section 36)."""

from orbitproof.verify.equilibrium.enclosures import (
    EquilibriumEnclosures,
    HopfEnclosures,
    enclose_equilibrium,
    enclose_hopf,
)
from orbitproof.verify.equilibrium.proved_equilibrium import (
    EquilibriumResults,
    EquilibriumTheorem,
    check_equilibrium_exactly,
    prove_equilibrium,
)
from orbitproof.verify.equilibrium.proved_hopf import HopfResults, HopfTheorem, prove_hopf
from orbitproof.verify.equilibrium.spectrum import Spectrum
