"""Symmetric orbits that are stable for ever: normal form and twist (section 28)."""

from orbitproof.verify.twist.following import StableOrbitEnclosures, enclose_stable_orbit
from orbitproof.verify.twist.normal_form import (
    NotEllipticError,
    Rotation,
    Twist,
    rotation_of,
    stability_parameter,
    twist_of,
)
from orbitproof.verify.twist.proved_stable_orbit import (
    StableOrbitResults,
    StableOrbitTheorem,
    check_stable_orbit_exactly,
    prove_stable_orbit,
    stable_orbit_theorem,
)
