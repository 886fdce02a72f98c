"""Transverse heteroclinic orbits between two symmetric periodic orbits (section 41)."""

from orbitproof.verify.heteroclinic.proved_heteroclinic import (
    End,
    HeteroclinicEnclosures,
    HeteroclinicResults,
    HeteroclinicTheorem,
    check_heteroclinic_exactly,
    enclose_heteroclinic,
    prove_heteroclinic,
)
