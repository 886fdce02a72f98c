"""What curves of `shared.systems.VERTICAL` say about the CR3BP: vertical families (sections 16.6 to 16.8)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, VERTICAL, ReversibleSystem
from orbitproof.verify.curve.bifurcations_on_it import CertifiedPoint
from orbitproof.verify.curve.followed import Partner, Point
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.curve.libration_point import derived_parameter
from orbitproof.verify.evidence import Checklist, IntegrationFailure, enclose, is_positive, power

SIZE = "eps2"
"""The family parameter: the square of the speed across the plane where the orbit crosses the axis."""

ACROSS_PLANE = "S"
"""The symmetry z -> -z of the CR3BP, by which vertical orbits are shifted along themselves by half their period."""

CROSSINGS = 2
"""How often a half orbit, from Fix(R) to Fix(R), meets the section: on the axis, and at its end."""


def vertical_point(system: ReversibleSystem) -> str | None:
    """The libration point around whose vertical orbits a system is written; `None` for other systems."""
    return next((name for name, known in VERTICAL.items() if known is system), None)


def check_vertical(checklist: Checklist, atlas: Atlas, chain: Chain) -> None:
    """Hypothesis `vertical` (16.7): the curve leads from eps2 = 0 on, where the first return is after a quarter."""
    statement = "eps2 increases from 0 or less where it may be 0, and there the first return is before pi/c^(1/2)"
    remedy = "claim that eps2 covers a range from 0 on, in narrower pieces"
    with checklist.hypothesis("vertical", "16.7", statement, remedy) as evidence:
        covers = atlas.claim.covers
        from_rest = covers is not None and covers.coordinate == SIZE
        evidence.require(atlas.claim.is_arc, f"the claim is about no arc, but about a {atlas.claim.kind}")
        evidence.require(atlas.claim.crossings == 1, "the claim is about a later return")
        evidence.require(
            from_rest and covers is not None and covers.start <= 0 < covers.end, "the claim does not say the former"
        )
        half = evidence.record("pi/c^(1/2)", arb.pi() / stiffness_at_rest(atlas.system, atlas.parameters).sqrt())
        at_rest = [
            (stretch, part.time, first, last)
            for stretch in chain.stretches
            for part, first, last in stretch.run.between(stretch.enters, stretch.leaves)
            if stretch.tube.points(part.deviation, first, last)[0].contains(0) is True
        ]
        evidence.require(bool(at_rest), "no piece is shown to lie over eps2 = 0")
        for stretch, time, first, last in at_rest:
            increases = stretch.tube.coordinate_increases(0, stretch.run, first, last)
            evidence.require(increases, "eps2 is not shown to increase where it may be 0")
            evidence.record("time of the first return near eps2 = 0", time)
            evidence.require(is_positive(half - time), "the return at eps2 = 0 may be a later one")


def stiffness_at_rest(system: ReversibleSystem, parameters: Mapping[str, Fraction]) -> arb:
    """c = c_1 + c_2 of section 16.1, at the libration point of a system in units of section 16."""
    x_l, mu = derived_parameter(system, "x_l", parameters, ctx.prec).ball, enclose(parameters["mu"])
    return (1 - mu) / abs(x_l + mu) ** 3 + mu / abs(x_l + mu - 1) ** 3


def vertical_jacobi_constant(system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Point) -> arb | None:
    """The Jacobi constant of the orbit that a point (eps2, x, vy) stands for: that of vz = 0, less eps2 = vz^2."""
    integral = CR3BP.first_integral_program
    assert integral is not None
    try:
        x_l = derived_parameter(system, "x_l", parameters, ctx.prec).ball
    except IntegrationFailure:
        return None
    size, zero = point[SIZE], arb(0)
    state = [x_l + size * point["x"], zero, zero, zero, size * point["vy"], zero, enclose(parameters["mu"])]
    (value,) = integral.evaluate(state, enclose, power)
    return arb(value) - size


def in_units_of_vertical_orbit(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Point
) -> dict[str, arb] | None:
    """(eps2, x, vy) of a point of Fix(R S), given by enclosures of x, vy and vz; `None` if vz may be 0."""
    try:
        x_l = derived_parameter(system, "x_l", parameters, ctx.prec).ball
    except IntegrationFailure:
        return None
    size = point["vz"] ** 2
    if not is_positive(size):
        return None
    return {SIZE: size, "x": (point["x"] - x_l) / size, "vy": point["vy"] / size}


def carried_vertical(atlas: Atlas, certified: CertifiedPoint, partner: Partner) -> dict[str, arb] | str:
    """A loss of R at a vertical orbit by the coordinates of a curve of such orbits, or why it is none (16.8)."""
    if not certified.loses_reversor:
        return "only orbits that lose R are looked for among vertical orbits"
    if ACROSS_PLANE not in certified.shifted_by:
        return "it is not shown that z -> -z shifts its orbit by half the period"
    # The crossing between the two points on Fix(R), which is on the axis.
    on_axis = partner(CR3BP, atlas.parameters, certified.point, CROSSINGS - 1, CR3BP_AXIAL)
    found = None if on_axis is None else in_units_of_vertical_orbit(atlas.system, atlas.parameters, on_axis)
    return "its crossing of the axis is not enclosed" if found is None else found
