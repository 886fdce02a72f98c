"""An arc of a web: what is proved of a curve, and enclosures of the levels of its orbits (sections 33.1 and 33.5)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import LIFTED, ReversibleSystem
from orbitproof.verify.curve import (
    Bifurcation,
    ProvedCurve,
    certified_systems,
    jacobi_constant,
    point_name,
    vertical_point,
)
from orbitproof.verify.evidence import enclose, hull, power
from orbitproof.verify.stability import point_over
from orbitproof.verify.web.indices import Indices

_PARTS = 32
"""Into so many parts a proved interval is divided for the levels of its orbits."""

_NOT_KNOWN = arb(float("nan"))


@dataclass(frozen=True)
class Arc:
    """A curve of a web.

    Attributes:
        atlas: the claim about it.
        curve: what is proved of it; `None` if that is nothing.
        problem: why it counts for nothing, if it does.
        placed: the certificates of vertices that were looked for on it, by id.
        indices: what is known of the index of its orbits; `None` without a certificate of that.
    """

    atlas: Atlas
    curve: ProvedCurve | None
    problem: str = ""
    placed: Mapping[str, Bifurcation] = field(default_factory=dict)
    indices: Indices | None = None

    @property
    def id(self) -> str:
        """The id of the atlas."""
        return self.atlas.id

    @property
    def system(self) -> ReversibleSystem:
        """The system in whose states its orbits are: of a family around a libration point the CR3BP."""
        return certified_systems(self.atlas.system)[0]

    @property
    def equations(self) -> tuple[object, ...]:
        """What two arcs have in common if their orbits are orbits of the same equations with the same level."""
        system, integral = self.system, self.system.first_integral_program
        functions = [(each.name, each.function) for each in system.defined]
        arguments = [argument.text() for argument in system.argument_programs]
        return (
            system.program.text(),
            *(tuple(functions), tuple(arguments)),
            *(None if integral is None else integral.text(), system.family_parameter, system.fixed_level),
        )

    @property
    def setting(self) -> tuple[object, ...]:
        """In what its pieces are written, by no name that a file gives its system."""
        system = self.atlas.system
        return (
            *(system.program.text(), system.section, system.reversing_symmetry),
            *(system.centre_coordinates, point_name(system) or vertical_point(system)),
        )

    @property
    def period(self) -> arb:
        """A ball with the periods of all orbits; a time is a quarter of vertical ones and at births (16.7, 16.12)."""
        assert self.curve is not None
        period = (2 if vertical_point(self.atlas.system) is None else 4) * self.curve.half_period
        birth = self.curve.birth
        return period if birth is None else hull(period, 4 * birth.tube.proved.time)

    def levels(self) -> arb:
        """A ball with the levels of all orbits over the pieces; not finite if they are not enclosed (33.5)."""
        assert self.curve is not None
        names, found = self.atlas.system.centre_coordinates, []
        for stretch in self.curve.chain.stretches:
            for _, first, last in stretch.run.between(stretch.enters, stretch.leaves):
                for number in range(_PARTS):
                    low, high = (first + (last - first) * Fraction(n, _PARTS) for n in (number, number + 1))
                    middle, reach = enclose((low + high) / 2), enclose((high - low) / 2)
                    point = point_over(stretch, middle + reach * arb(0, 1))
                    found.append(level_at(self.atlas, dict(zip(names, point, strict=True))))
        birth = self.curve.birth
        for number in range(_PARTS) if birth is not None else ():
            assert birth is not None
            s = enclose(birth.tube.proved.end) * (arb(2 * number + 1 - _PARTS) + arb(0, 1)) / _PARTS
            found.append(level_at(self.atlas, birth.tube.states(s)))
        return hull(found[0], *found[1:])


def level_at(atlas: Atlas, point: Mapping[str, arb]) -> arb:
    """The level of the orbit through a point of Fix(R): the family parameter, or the first integral there.

    Not finite where it is not known: of states with coordinates that are functions of others.
    """
    system = atlas.system
    if point_name(system) is not None or vertical_point(system) is not None or system is LIFTED:
        level = jacobi_constant(system, atlas.parameters, point)
        return _NOT_KNOWN if level is None else level
    if system.family_parameter is not None:
        return point[system.family_parameter]
    integral = system.first_integral_program
    if integral is None or system.defined:
        return _NOT_KNOWN
    # What R negates is 0 on Fix(R).
    known = {name: arb(0) for name in system.state} | {k: enclose(v) for k, v in system.normalised.items()}
    known |= {**point, **{name: enclose(value) for name, value in atlas.parameters.items()}}
    (value,) = integral.evaluate([known[name] for name in integral.inputs], enclose, power)
    return arb(value)


def libration_vertex(arc: Arc) -> str | None:
    """The libration point to which the orbits of a proved arc shrink (Theorems 16.3, 16.6); `None` if there is none."""
    if vertical_point(arc.atlas.system) is not None:
        return vertical_point(arc.atlas.system)
    name, claim = point_name(arc.atlas.system), arc.atlas.claim
    covers = claim.covers
    if name is None or covers is None or covers.coordinate != "eps" or "eps" not in claim.increasing:
        return None
    return name if covers.start <= 0 <= covers.end else None
