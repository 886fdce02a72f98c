"""What curves of planar orbits, some in units of `shared.systems.libration`, say about the CR3BP (16.4, 16.5)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, HILL_VARIED, LIFTED, ReversibleSystem
from orbitproof.verify.curve.bifurcations_on_it import LACKS_COORDINATES, CertifiedPoint
from orbitproof.verify.curve.libration_point import derived_parameter
from orbitproof.verify.curve.vertical_family import vertical_jacobi_constant, vertical_point
from orbitproof.verify.evidence import IntegrationFailure, enclose, excludes_zero, power


def point_name(system: ReversibleSystem) -> str | None:
    """The libration point around whose planar orbits a system is written; `None` for other systems."""
    return next((name for name, known in AROUND.items() if known is system), None)


def is_planar(system: ReversibleSystem) -> bool:
    """Whether it is the CR3BP in the plane, in its own units or in those of orbits around a libration point."""
    return system is CR3BP_PLANAR or point_name(system) is not None


def certified_systems(system: ReversibleSystem) -> tuple[ReversibleSystem, ...]:
    """The systems in which points of a curve of `system` are certified; first the one whose states they are.

    That is `system` itself, or the CR3BP. In the plane both reversing symmetries of the CR3BP are the same, so a planar
    orbit may break S under either (16.5). Axial orbits are symmetric under the second one, and born from planar and
    from vertical orbits (16.13). Period doublings over the mass are certified one by one, at given masses (15.10).
    """
    if vertical_point(system) is not None or system is HILL_VARIED:
        return (CR3BP,)
    if system is LIFTED:
        return CR3BP_AXIAL, CR3BP
    if not is_planar(system):
        return (system,)
    return (CR3BP, CR3BP_AXIAL, *((system,) if point_name(system) is None else ()))


def libration_point(system: ReversibleSystem, parameters: Mapping[str, Fraction]) -> arb | None:
    """Enclosure of x_l, the libration point on its axis, to the precision of Arb; `None` for other systems.

    Raises `IntegrationFailure` if it was not enclosed.
    """
    around = point_name(system) or vertical_point(system)
    return None if around is None else derived_parameter(system, "x_l", parameters, ctx.prec).ball


def carried(atlas: Atlas, certified: CertifiedPoint) -> dict[str, arb] | str:
    """A certified point of the CR3BP by the coordinates of a curve in units of its orbits, or why it is none of it."""
    if not {"x", "vy"} <= set(certified.point):
        return LACKS_COORDINATES
    if certified.is_of_orbit:
        return "the curve is one of orbits in units of their size"
    found = in_units_of_orbit(atlas.system, atlas.parameters, certified.point) if certified.is_planar else None
    return "it is not shown to be a planar orbit away from the libration point" if found is None else found


def in_units_of_orbit(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Mapping[str, arb]
) -> dict[str, arb] | None:
    """(eps, vy) of a point of the CR3BP's Fix(R) or Fix(R S) that S fixes, as in (16.2).

    Args:
        parameters: the mass parameter, exact.
        point: enclosures of x and vy; that z = 0 and vz = 0 is for the caller.

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
    """The level of the orbit of the CR3BP for which a point of a curve in other units stands; else `None`."""
    if system is LIFTED:
        from orbitproof.verify.curve.lifted_family import lifted_jacobi_constant

        return lifted_jacobi_constant(parameters, point)
    if vertical_point(system) is not None:
        return vertical_jacobi_constant(system, parameters, point)
    integral = CR3BP.first_integral_program
    if point_name(system) is None or integral is None:
        return None
    try:
        x_l = derived_parameter(system, "x_l", parameters, ctx.prec).ball
    except IntegrationFailure:
        return None
    zero = arb(0)
    state = [x_l + point["eps"], zero, zero, zero, point["eps"] * point["vy"], zero]
    (value,) = integral.evaluate([*state, enclose(parameters["mu"])], enclose, power)
    return arb(value)
