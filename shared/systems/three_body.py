"""The circular restricted three-body problem (section 1.1)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.system import ParameterRange, ReversibleSystem, Reversor


def _circular_restricted_three_body(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, vx, vy, vz = state
    (mu,) = parameters
    larger = x + mu
    smaller = larger - 1
    off_axis = y * y + z * z
    pull_larger = (1 - mu) * (larger * larger + off_axis) ** -1.5
    pull_smaller = mu * (smaller * smaller + off_axis) ** -1.5
    pull = pull_larger + pull_smaller
    return (vx, vy, vz, x + 2 * vy - pull_larger * larger - pull_smaller * smaller, y - 2 * vx - pull * y, -(pull * z))


def _jacobi_constant(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, vx, vy, vz = state
    (mu,) = parameters
    larger = x + mu
    smaller = larger - 1
    off_axis = y * y + z * z
    potential = (1 - mu) * (larger * larger + off_axis) ** -0.5 + mu * (smaller * smaller + off_axis) ** -0.5
    return (x * x + y * y + 2 * potential - (vx * vx + vy * vy + vz * vz),)


def _from_smaller_primary(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z, *_ = state
    (mu,) = parameters
    along = x + mu - 1
    return (along * along + y * y + z * z,)


CR3BP = ReversibleSystem(
    name="cr3bp",
    title="circular restricted three-body problem",
    state=("x", "y", "z", "vx", "vy", "vz"),
    parameters={"mu": ParameterRange(Fraction(0), Fraction(1))},
    vector_field=_circular_restricted_three_body,
    reversing_symmetry=(1, -1, 1, -1, 1, -1),
    symmetries={"S": (1, 1, -1, 1, 1, -1)},
    section="y",
    first_integral=_jacobi_constant,
    first_integral_name="Jacobi constant",
    level_coordinate="vy",
    squared_distance=_from_smaller_primary,
    distance_name="the smaller primary",
    reversors={"axial": Reversor((1, -1, -1, -1, 1, 1), "the half turn about the x axis")},
)

AXIAL = "axial"
"""The name of R S, the half turn about the x axis, among the reversing symmetries of the CR3BP."""

CR3BP_AXIAL = CR3BP.under(AXIAL)


def _pulls_in_plane(state: Sequence[Any], parameters: Sequence[Any]) -> tuple[Any, Any]:
    """Pulls of the larger and the smaller primary, (1 - mu)/r_1^3 and mu/r_2^3."""
    x, y, *_ = state
    (mu,) = parameters
    larger, square = x + mu, y * y
    smaller = larger - 1
    return (1 - mu) * (larger * larger + square) ** -1.5, mu * (smaller * smaller + square) ** -1.5


def _planar_three_body(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, vx, vy = state
    (mu,) = parameters
    first, second = _pulls_in_plane(state, parameters)
    larger = x + mu
    return (vx, vy, x - first * larger - second * (larger - 1) + 2 * vy, y - (first + second) * y - 2 * vx)


def _stiffness_across(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """z'' = -z times it, to first order in z (21.1)."""
    first, second = _pulls_in_plane(state, parameters)
    return (first + second,)


def _jacobi_constant_in_plane(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, vx, vy = state
    (mu,) = parameters
    larger, square = x + mu, y * y
    smaller = larger - 1
    potential = (1 - mu) * (larger * larger + square) ** -0.5 + mu * (smaller * smaller + square) ** -0.5
    return (x * x + square + 2 * potential - (vx * vx + vy * vy),)


def _from_smaller_primary_in_plane(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, *_ = state
    (mu,) = parameters
    away = x - 1 + mu
    return (away * away + y * y,)


CR3BP_PLANAR = ReversibleSystem(
    name="cr3bp-planar",
    title="planar circular restricted three-body problem",
    state=("x", "y", "vx", "vy"),
    parameters={"mu": ParameterRange(Fraction(0), Fraction(1))},
    vector_field=_planar_three_body,
    reversing_symmetry=(1, -1, -1, 1),
    section="y",
    first_integral=_jacobi_constant_in_plane,
    first_integral_name="Jacobi constant",
    level_coordinate="vy",
    squared_distance=_from_smaller_primary_in_plane,
    distance_name="the smaller primary",
    stiffness_across=_stiffness_across,
)

THREE_BODY = (CR3BP, CR3BP_AXIAL)
"""The spatial problem with its two reversing symmetries: R, and R S, the half turn about the x axis."""
