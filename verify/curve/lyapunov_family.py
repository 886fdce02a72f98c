"""What curves in the units of `shared.systems.libration` say about the CR3BP (sections 16.4 and 16.5)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import AROUND, CR3BP, ReversibleSystem
from orbitproof.verify.curve.libration_point import derived_parameter
from orbitproof.verify.evidence import IntegrationFailure, decimal_interval, enclose, excludes_zero

PLANAR = "S"
"""The symmetry of the CR3BP that fixes the planar orbits, z -> -z."""


def point_name(system: ReversibleSystem) -> str | None:
    """The libration point around which a system is written; `None` for other systems."""
    return next((name for name, known in AROUND.items() if known is system), None)


def certified_system(system: ReversibleSystem) -> ReversibleSystem:
    """The system in which points of a curve of `system` are certified: the CR3BP, or `system` itself."""
    return system if point_name(system) is None else CR3BP


def in_units_of_orbit(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Mapping[str, arb]
) -> dict[str, arb] | None:
    """(eps, vy) of a point of the CR3BP's Fix(R) that `PLANAR` fixes, as in (16.2).

    Args:
        parameters: the mass parameter, exact.
        point: enclosures of x and vy; that z = 0 is for the caller.

    Returns:
        enclosures by name; `None` if the point is not shown to differ from the libration point.
    """
    try:
        x_l = derived_parameter(system, "x_l", parameters, ctx.prec).ball
    except IntegrationFailure:
        return None
    eps = point["x"] - x_l
    return {"eps": eps, "vy": point["vy"] / eps} if excludes_zero(eps) else None


def jacobi_constant(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Mapping[str, arb]
) -> arb | None:
    """The Jacobi constant of the orbit of the CR3BP that a point (eps, vy) stands for; `None` for other systems."""
    integral = CR3BP.first_integral_program
    if point_name(system) is None or integral is None:
        return None
    try:
        x_l = derived_parameter(system, "x_l", parameters, ctx.prec).ball
    except IntegrationFailure:
        return None
    zero = arb(0)
    state = [x_l + point["eps"], zero, zero, zero, point["eps"] * point["vy"], zero]
    (value,) = integral.evaluate(
        [*state, enclose(parameters["mu"])], enclose, lambda base, power: base ** enclose(power)
    )
    return arb(value)


_SIDES = {
    "L1": ("between the primaries", "(1 - mu)/(X + mu)^2 - mu/(X - 1 + mu)^2"),
    "L2": ("beyond the smaller primary", "(1 - mu)/(X + mu)^2 + mu/(X - 1 + mu)^2"),
    "L3": ("beyond the larger primary", "-(1 - mu)/(X + mu)^2 - mu/(X - 1 + mu)^2"),
}
"""Where the libration point lies on the axis, and what X is there."""

_SHOWN_DIGITS = 20


def libration_units(atlas: Atlas) -> str:
    """A sentence on the units of a system around a libration point; empty for other systems."""
    name = point_name(atlas.system)
    if name is None:
        return ""
    side, force = _SIDES[name]
    x_l = derived_parameter(atlas.system, "x_l", atlas.parameters, ctx.prec).ball
    return (
        f" In its coordinates X = x_l + eps x, Y = eps y of the three-body problem with primaries at -mu and 1 - mu, "
        f"x_l is the only root X of X = {force} {side}, in {decimal_interval(x_l, _SHOWN_DIGITS)}, and (eps, vy) "
        f"stands for the initial point x = 1, y = 0, x' = 0, y' = vy."
    )


def meaning(atlas: Atlas) -> str:
    """What a proved curve around a libration point says about the CR3BP; empty if it says nothing more.

    Theorem 16.3: eps increases along the curve and takes values on an interval that contains 0.
    """
    name, covers = point_name(atlas.system), atlas.claim.covers
    if name is None or covers is None or "eps" not in atlas.claim.increasing:
        return ""
    text = (
        "For eps other than 0 the orbit of (eps, vy) is the planar R-symmetric orbit of the circular restricted "
        "three-body problem through X = x_l + eps, Y' = eps vy on the axis, with the same half period."
    )
    if covers.coordinate != "eps" or not covers.start <= 0 <= covers.end:
        return text
    return (
        f"{text} At eps = 0 it is the orbit of the linear centre, so the curve is the planar Lyapunov family that "
        f"emanates from {name}."
    )
