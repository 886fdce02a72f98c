"""The CR3BP in units of the speed across the plane with which orbits leave the axis (section 16.9).

Z = eps z in the CR3BP, X = x and Y = y. The equations are analytic in eps^2, and at eps = 0 z is a variation out of the
plane along a planar orbit: what is born there by leaving the plane is a curve like any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.system import ParameterRange, ReversibleSystem


def _field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, vx, vy, vz = state
    mu, eps2 = parameters
    larger = x + mu
    smaller = larger - 1
    off_axis = y * y + eps2 * (z * z)
    pull_larger = (1 - mu) * (larger * larger + off_axis) ** -1.5
    pull_smaller = mu * (smaller * smaller + off_axis) ** -1.5
    pull = pull_larger + pull_smaller
    return (vx, vy, vz, x + 2 * vy - pull_larger * larger - pull_smaller * smaller, y - 2 * vx - pull * y, -(pull * z))


LIFTED = ReversibleSystem(
    name="cr3bp-lifted",
    title="circular restricted three-body problem in units of the speed across the plane, by the half turn",
    state=("x", "y", "z", "vx", "vy", "vz"),
    parameters={"mu": ParameterRange(Fraction(0), Fraction(1)), "eps2": ParameterRange(None, None)},
    vector_field=_field,
    reversing_symmetry=(1, -1, -1, -1, 1, 1),
    section="z",
    family_parameter="eps2",
    normalised={"vz": Fraction(1)},
)
"""Orbits that start on the axis, R being the half turn about it; the section is the plane of the primaries."""
