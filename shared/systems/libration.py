"""The CR3BP around a collinear libration point, in units of the size of the orbit: planar orbits, and vertical ones.

With x_l the libration point, X = x_l + eps x and Y = eps y, the equations of (x, y) are analytic in eps
through eps = 0, where they are the linearisation at the libration point. An orbit that starts on the axis at
X is measured in the unit eps = X - x_l, so that it starts at x = 1; eps is negative on the left of the
libration point. Vertical orbits cross the axis, and eps is their speed across the plane there: they are of the size
eps across it and eps^2 in it. Section 16 proves what this says about the CR3BP.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.known import SYSTEMS
from orbitproof.shared.systems.lifted import LIFTED
from orbitproof.shared.systems.system import DerivedParameter, ParameterRange, ReversibleSystem, VectorField
from orbitproof.shared.systems.varied import HILL_VARIED


def _relative_field(sides: tuple[int, int]) -> VectorField:
    """(F(x_l + eps x) - F(x_l)) / eps for the vector field F of the planar CR3BP, as in (16.1).

    `sides` are the signs of x_l + mu and x_l + mu - 1.
    """

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        x, y, vx, vy = state
        mu, x_l, eps = parameters
        square = x * x + y * y
        along, across = x + 2 * vy, y - 2 * vx
        for mass, distance, side in ((1 - mu, x_l + mu, sides[0]), (mu, x_l + mu - 1, sides[1])):
            inverse = distance**-1
            stiffness = side * mass * (inverse * inverse * inverse)
            linear = 2 * x + eps * (inverse * square)
            ratio = (1 + eps * (inverse * linear)) ** -0.5
            inverse_square = ratio * ratio
            cube = inverse_square * ratio
            # (cube - 1) / eps = -linear * inverse * quotient without a division by eps.
            quotient = inverse_square * (ratio + 1 / (1 + ratio))
            along = along - stiffness * (x * cube - linear * quotient)
            across = across - stiffness * (y * cube)
        return (vx, vy, along, across)

    return field


def _stiffness_across(sides: tuple[int, int]) -> VectorField:
    """(1 - mu)/r_1^3 + mu/r_2^3: z'' = -z times it in the CR3BP, to first order in z."""

    def stiffness(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        x, y, *_ = state
        mu, x_l, eps = parameters
        result = 0
        for mass, distance, side in ((1 - mu, x_l + mu, sides[0]), (mu, x_l + mu - 1, sides[1])):
            inverse = distance**-1
            linear = 2 * x + eps * (inverse * (x * x + y * y))
            cube = (1 + eps * (inverse * linear)) ** -1.5
            result = result + side * mass * (inverse * inverse * inverse) * cube
        return (result,)

    return stiffness


def _force_on_axis(value: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    """The force along the axis at rest; increasing between the primaries and on either side of them."""
    (x,), (mu,) = value, parameters
    larger = x + mu
    smaller = larger - 1
    return (x - (1 - mu) * larger * (larger * larger) ** -1.5 - mu * smaller * (smaller * smaller) ** -1.5,)


def _between_primaries(parameters: Sequence[Any]) -> tuple[Any, Any]:
    (mu,) = parameters
    return -mu, 1 - mu


def _beyond_smaller(parameters: Sequence[Any]) -> tuple[Any, Any]:
    (mu,) = parameters
    return 1 - mu, None


def _beyond_larger(parameters: Sequence[Any]) -> tuple[Any, Any]:
    (mu,) = parameters
    return None, -mu


def _around(point: str, sides: tuple[int, int], interval: Any) -> ReversibleSystem:
    return ReversibleSystem(
        name=f"cr3bp-{point.lower()}",
        title=f"planar circular restricted three-body problem in units of the orbit's size around {point}",
        state=("x", "y", "vx", "vy"),
        parameters={
            "mu": ParameterRange(Fraction(0), Fraction(1)),
            "x_l": ParameterRange(None, None),
            "eps": ParameterRange(None, None),
        },
        vector_field=_relative_field(sides),
        reversing_symmetry=(1, -1, -1, 1),
        section="y",
        family_parameter="eps",
        normalised={"x": Fraction(1)},
        derived_parameters={"x_l": DerivedParameter(_force_on_axis, interval)},
        stiffness_across=_stiffness_across(sides),
    )


def _vertical_field(sides: tuple[int, int]) -> VectorField:
    """The CR3BP with X = x_l + eps^2 x, Y = eps^2 y, Z = eps z, in u = z^2, v = z z', w = z'^2, as in (16.5).

    `sides` are the signs of x_l + mu and x_l + mu - 1.
    """

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        x, y, vx, vy, u, v, w = state
        mu, x_l, eps2 = parameters
        square = u + eps2 * (x * x + y * y)
        along, across = x + 2 * vy, y - 2 * vx
        pull: Any = 0
        for mass, distance, side in ((1 - mu, x_l + mu, sides[0]), (mu, x_l + mu - 1, sides[1])):
            inverse = distance**-1
            stiffness = side * mass * (inverse * inverse * inverse)
            # The squared distance from the primary is distance^2 (1 + eps2 inverse linear).
            linear = 2 * x + inverse * square
            ratio = (1 + eps2 * (inverse * linear)) ** -0.5
            inverse_square = ratio * ratio
            cube = stiffness * (inverse_square * ratio)
            # (ratio^3 - 1) / eps2 = -linear * inverse * quotient without a division by eps2.
            quotient = stiffness * (inverse_square * (ratio + 1 / (1 + ratio)))
            along = along - (x * cube - linear * quotient)
            pull = pull + cube
        return (vx, vy, along, across - pull * y, 2 * v, w - pull * u, -2 * (pull * v))

    return field


def _vertical(point: str, sides: tuple[int, int], interval: Any) -> ReversibleSystem:
    return ReversibleSystem(
        name=f"cr3bp-{point.lower()}-vertical",
        title=f"circular restricted three-body problem around {point} in units of vertical orbits, up to z -> -z",
        state=("x", "y", "vx", "vy", "u", "v", "w"),
        parameters={
            "mu": ParameterRange(Fraction(0), Fraction(1)),
            "x_l": ParameterRange(None, None),
            "eps2": ParameterRange(None, None),
        },
        vector_field=_vertical_field(sides),
        reversing_symmetry=(1, -1, -1, 1, 1, -1, 1),
        section="y",
        family_parameter="eps2",
        normalised={"u": Fraction(0), "w": Fraction(1)},
        derived_parameters={"x_l": DerivedParameter(_force_on_axis, interval)},
    )


def mass_of_distance(side: int, distance: Any) -> Any:
    """k(b) = mu/b^3 for the mass mu at which L1 (side -1) or L2 (side 1) has x_l = 1 - mu + b, as in (16.3)."""
    square = distance * distance
    larger = 1 + distance
    return (3 + 3 * distance + square) / (side * (larger * larger) + square * distance * (2 + distance))


def _over_masses_field(side: int) -> VectorField:
    """The planar CR3BP about L1 or L2 in units of b eps, b the signed distance from the smaller mass, as in (16.4)."""

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        x, y, vx, vy = state
        distance, eps = parameters
        square = x * x + y * y
        ratio_of_masses = mass_of_distance(side, distance)
        larger_mass = 1 - distance * distance * distance * ratio_of_masses
        inverse = (1 + distance) ** -1
        along, across = x + 2 * vy, y - 2 * vx
        for stiffness, unit, linear in (
            (
                larger_mass * (inverse * inverse * inverse),
                distance * inverse,
                2 * x + eps * distance * inverse * square,
            ),
            (side * ratio_of_masses, 1, 2 * x + eps * square),
        ):
            ratio = (1 + eps * unit * linear) ** -0.5
            inverse_square = ratio * ratio
            cube = inverse_square * ratio
            quotient = inverse_square * (ratio + 1 / (1 + ratio))
            along = along - stiffness * (x * cube - linear * quotient)
            across = across - stiffness * (y * cube)
        return (vx, vy, along, across)

    return field


def _over_masses(point: str, side: int) -> ReversibleSystem:
    lower, upper = (Fraction(-1), None) if side < 0 else (Fraction(-1, 4), None)
    return ReversibleSystem(
        name=f"cr3bp-{point.lower()}-masses",
        title=f"planar circular restricted three-body problem around {point} in units of the orbit's size, all masses",
        state=("x", "y", "vx", "vy"),
        parameters={"b": ParameterRange(lower, upper), "eps": ParameterRange(None, None)},
        vector_field=_over_masses_field(side),
        reversing_symmetry=(1, -1, -1, 1),
        section="y",
        family_parameter="eps",
        normalised={"x": Fraction(1)},
    )


_POINTS: Mapping[str, tuple[tuple[int, int], Any]] = {
    "L1": ((1, -1), _between_primaries),
    "L2": ((1, 1), _beyond_smaller),
    "L3": ((-1, -1), _beyond_larger),
}

AROUND: Mapping[str, ReversibleSystem] = {point: _around(point, *known) for point, known in _POINTS.items()}
"""The system of planar orbits around each collinear libration point, by the name of the point."""

VERTICAL: Mapping[str, ReversibleSystem] = {point: _vertical(point, *known) for point, known in _POINTS.items()}
"""The systems of vertical orbits, by the point around which they are."""

SIDES: Mapping[str, int] = {"L1": -1, "L2": 1}
"""On which side of the smaller mass the libration point lies."""

OVER_MASSES: Mapping[str, ReversibleSystem] = {point: _over_masses(point, side) for point, side in SIDES.items()}
"""The system around L1 and L2 with the distance from the smaller mass as parameter, which determines the mass."""

BRANCH_SYSTEMS: Mapping[str, ReversibleSystem] = {
    **SYSTEMS, **{system.name: system for around in (AROUND, VERTICAL) for system in around.values()},
    LIFTED.name: LIFTED, HILL_VARIED.name: HILL_VARIED,
}  # fmt: skip
"""Systems whose branches can be proved, by name; those that are not in `SYSTEMS` not by candidates."""

UNLISTED = (HILL_VARIED,)
"""Systems of whose curves no list of resonances is made."""
