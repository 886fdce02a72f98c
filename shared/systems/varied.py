"""The CR3BP in Hill's units with a variation of its orbits (section 15.10).

An orbit and a solution of the equations linearised along it are one orbit of this system. Where the variation, led from
Fix(R), arrives in what R negates, while the orbit arrives in Fix(R), the orbit has the multiplier -1: period doublings
are symmetric orbits of this system, and its parameter is that of the mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.hill import HILL
from orbitproof.shared.systems.system import ReversibleSystem

TURN = "V"
"""The name of the symmetry that changes the sign of the variation."""


def _field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """The field of `hill` and its derivative along the variation; 1.5 t^5 du is the derivative of c = (1 - t^3)/h."""
    xi, eta, zeta, v_xi, v_eta, v_zeta, d_xi, d_eta, d_zeta, d_vxi, d_veta, d_vzeta = state
    (h,) = parameters
    larger_mass = 1 - h * h * h
    square = xi * xi + eta * eta + zeta * zeta
    slope = xi * d_xi + eta * d_eta + zeta * d_zeta
    root = square**-0.5
    inverse = root * root
    near = inverse * root
    u = 2 * xi + h * square
    t = (1 + h * u) ** -0.5
    t_2 = t * t
    t_3 = t_2 * t
    c = u * t_2 * (1 + t + t_2) / (1 + t)
    pull = larger_mass * t_3 + near
    rest = 1 - pull
    d_c = 3 * larger_mass * (t_3 * t_2) * (d_xi + h * slope)
    d_pull = -(h * d_c) - 3 * (near * inverse) * slope
    return (
        v_xi, v_eta, v_zeta,
        2 * v_eta + rest * xi + larger_mass * c, rest * eta - 2 * v_xi, -(pull * zeta),
        d_vxi, d_veta, d_vzeta,
        2 * d_veta + rest * d_xi - d_pull * xi + d_c, rest * d_eta - d_pull * eta - 2 * d_vxi,
        -(pull * d_zeta + d_pull * zeta),
    )  # fmt: skip


HILL_VARIED = ReversibleSystem(
    name="cr3bp-hill-varied",
    title="circular restricted three-body problem in Hill's units with a variation of its orbits",
    state=(*HILL.state, *(f"d{name}" for name in HILL.state)),
    parameters=HILL.parameters,
    vector_field=_field,
    reversing_symmetry=HILL.reversing_symmetry * 2,
    symmetries={TURN: (1,) * 6 + (-1,) * 6},
    section="eta",
    family_parameter="h",
    normalised={"dveta": Fraction(1)},
    arrival=TURN,
)
