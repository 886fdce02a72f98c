"""Parameters at which two 1:k resonances of a family meet (section 34)."""

from orbitproof.verify.double_resonance.equations import ResonanceEquations, Unfolding, equations_of
from orbitproof.verify.double_resonance.following import ResonanceEnclosures, enclose_resonance
from orbitproof.verify.double_resonance.proved_double_resonance import (
    ResonanceResults,
    ResonanceTheorem,
    check_resonance_exactly,
    prove_resonance,
    theorem_of_resonance,
)
