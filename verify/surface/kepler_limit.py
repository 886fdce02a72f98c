"""Where the symmetry breaking of the planar orbits of L3 goes as the mass tends to 0 (section 17.7).

At mu = 0 the orbits are Kepler's, and the symmetry breakings of small masses branch off from a simple zero of a
function of the eccentricity, an integral over one half of the ellipse. Ball arithmetic encloses the zero and shows that
it is simple.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, ctx

from orbitproof.verify.evidence import enclose, excludes_zero, hull, is_below, is_positive

_BITS = 96
_REACH = Fraction(1, 64)
"""Radius of the disc of complex eccentricities on which the function is bounded."""

LOWER, UPPER = Fraction("0.70721427"), Fraction("0.70721428")
"""The zero lies between these."""


@dataclass(frozen=True)
class KeplerLimit:
    """The eccentricity at mu = 0, and the derivative of the function there, both enclosed."""

    eccentricity: arb
    slope: arb


def melnikov(eccentricity: acb) -> acb:
    """D(e) of (17.6); not finite where the integrals are not enclosed."""
    e = eccentricity
    b = (1 - e * e).sqrt()

    def around(anomaly: acb) -> tuple[acb, acb, acb, acb, acb, acb, acb]:
        """cos t, sin t, R_1, R_2, r_2^-3, dt/dE and cos E - e on the ellipse that starts at its pericentre."""
        cosine, sine = anomaly.cos(), anomaly.sin()
        time = anomaly - e * sine
        x, y = -(cosine - e), -b * sine
        c, s = time.cos(), time.sin()
        # Not finite where the cut of the root is met: what is finite is analytic in the eccentricity as well.
        inverse = ((x - c) * (x - c) + (y - s) * (y - s)).rsqrt(analytic=True)
        return c, s, x, y, inverse * inverse * inverse, 1 - e * cosine, cosine - e

    def turn(anomaly: acb, analytic: bool) -> acb:
        c, s, x, y, near, rate, _ = around(anomaly)
        force_x, force_y = -(x - c) * near - c, -(y - s) * near - s
        # R_1' dt/dE = sin E.
        return -force_x * b * rate - anomaly.sin() * (x * force_y - y * force_x)

    def wronskian(anomaly: acb, analytic: bool) -> acb:
        c, _, _, _, near, rate, across = around(anomaly)
        return c * (1 - near) * across * rate / (1 - e)

    end = acb.pi()
    return ((1 + e) / (1 - e)).sqrt() * acb.integral(turn, acb(0), end) - e * acb.integral(wronskian, acb(0), end)


def kepler_limit() -> KeplerLimit | None:
    """The only zero of D between `LOWER` and `UPPER`, shown to be simple; `None` if it is not shown."""
    with ctx.workprec(_BITS):
        low, high = (melnikov(acb(enclose(value))).real for value in (LOWER, UPPER))
        if not (is_positive(low) and is_positive(-high)):
            return None
        if UPPER - LOWER > _REACH:
            return None
        middle, reach = enclose((LOWER + UPPER) / 2), enclose(_REACH)
        # |D''| <= 2 M/(rho/2)^2 at distances up to rho/2 from the middle, by Cauchy, with |D| <= M at rho.
        disc = acb(middle + arb(0, 1) * reach, arb(0, 1) * reach)
        bound = melnikov(disc).abs_upper()
        if not bound.is_finite():
            return None
        width = enclose(UPPER - LOWER)
        slope = (high - low) / width + arb(0, 1) * (width * 8 * bound / (reach * reach))
        if not (excludes_zero(slope) and is_below(slope, arb(0))):
            return None
        return KeplerLimit(hull(enclose(LOWER), enclose(UPPER)), slope)
