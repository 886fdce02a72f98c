"""The circular restricted three-body problem in Hill's units: a vector field that is regular at mu = 0.

With h = mu^(1/3), positions are counted from the smaller mass in units of h, time is not changed:

    (x, y, z) = (1 - mu + h xi, h eta, h zeta).

Nothing cancels or becomes large as h tends to 0, where the equations are those of Hill's lunar problem. See
section 17.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.system import ParameterRange, ReversibleSystem, Reversor
from orbitproof.shared.systems.three_body import AXIAL


def hill_field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """The field in (xi, eta, zeta) and their velocities; the parameter is h.

    With u = 2 xi + h rho^2 the distance from the larger mass is (1 + h u)^(1/2); T is its reciprocal and
    c = (1 - T^3)/h, written without the division.
    """
    xi, eta, zeta, v_xi, v_eta, v_zeta = state
    (h,) = parameters
    larger_mass = 1 - h * h * h
    square = xi * xi + eta * eta + zeta * zeta
    near = square**-1.5
    u = 2 * xi + h * square
    t = (1 + h * u) ** -0.5
    t_2 = t * t
    c = u * t_2 * (1 + t + t_2) / (1 + t)
    pull = larger_mass * (t_2 * t) + near
    rest = 1 - pull
    return (v_xi, v_eta, v_zeta, 2 * v_eta + rest * xi + larger_mass * c, rest * eta - 2 * v_xi, -(pull * zeta))


def hill_integral(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """The first integral (C - (1 - mu)(3 - mu))/h^2, C the Jacobi constant."""
    xi, eta, zeta, v_xi, v_eta, v_zeta = state
    (h,) = parameters
    plane = xi * xi + eta * eta
    square = plane + zeta * zeta
    u = 2 * xi + h * square
    t = (1 + h * u) ** -0.5
    share = (1 + t) ** -1
    far = t * t * share * (xi * u * (1 + 2 * t) * share - square)
    return (plane + 2 * square**-0.5 + 2 * (1 - h * h * h) * far - (v_xi * v_xi + v_eta * v_eta + v_zeta * v_zeta),)


HILL = ReversibleSystem(
    name="cr3bp-hill",
    title="circular restricted three-body problem in Hill's units",
    state=("xi", "eta", "zeta", "vxi", "veta", "vzeta"),
    # Below h = 0 there is no mechanics, but the field is as regular there.
    parameters={"h": ParameterRange(Fraction(-1), Fraction(1))},
    vector_field=hill_field,
    reversing_symmetry=(1, -1, 1, -1, 1, -1),
    symmetries={"S": (1, 1, -1, 1, 1, -1)},
    section="eta",
    first_integral=hill_integral,
    first_integral_name="(C - (1 - mu)(3 - mu))/mu^(2/3)",
    reversors={AXIAL: Reversor((1, -1, -1, -1, 1, 1), "the half turn about the xi axis")},
)

HILL_AXIAL = HILL.under(AXIAL)

IN_HILL_UNITS = (HILL, HILL_AXIAL)
"""Hill's units, with the two reversing symmetries."""
