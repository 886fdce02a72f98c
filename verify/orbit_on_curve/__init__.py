"""Single orbits of a proved curve (section 32)."""

from orbitproof.verify.orbit_on_curve.orbit_on_curve import PRECISION, OrbitOnCurve, OrbitPlace, OrbitsOfCurve
