"""Krein collisions of symmetric orbits, n = 2: two pairs of multipliers meet on the unit circle (section 31)."""

from orbitproof.verify.krein.equations import CollisionEquations, equations_of
from orbitproof.verify.krein.normal_form import cubic_coefficient
from orbitproof.verify.krein.proved_krein import (
    KreinResults,
    KreinTheorem,
    check_krein_exactly,
    enclose_krein,
    prove_krein,
    theorem_of_krein,
)
