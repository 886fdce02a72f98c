"""Transverse homoclinic orbits of a symmetric periodic orbit (section 40)."""

from orbitproof.verify.homoclinic.following import (
    HomoclinicEnclosures,
    Way,
    enclose_homoclinic,
    reversible,
    width_of_sliver,
)
from orbitproof.verify.homoclinic.proved_homoclinic import (
    HomoclinicResults,
    HomoclinicTheorem,
    along_manifold,
    check_end,
    check_homoclinic_exactly,
    prove_homoclinic,
)
