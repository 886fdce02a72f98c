"""Claims about symmetric homoclinic orbits of a periodic orbit, on a level of the first integral."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Literal

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Numbers, Vector
from orbitproof.shared.claims.without_symmetry import WithoutSymmetry, check_numbers, check_positive, refuse
from orbitproof.shared.stored import Rational, rules, stored
from orbitproof.shared.systems import ReversibleSystem, System

HOMOCLINIC = "homoclinic"
Signs = Annotated[tuple[Literal[1, -1], ...], rules("signs", minItems=4, maxItems=4)]


@dataclass(frozen=True, repr=False)
class HomoclinicOrbit(WithoutSymmetry):
    """A claim: a symmetric periodic orbit has a transverse homoclinic orbit that meets Fix(R).

    The section is the set of the states with `section` = 0 on the level. p is the other coordinate that R fixes, q the
    other one that R negates. A box about a point of Fix(R) has the coordinates (a, s): p = c + a + s and
    q = slope (a - s), |a|, |s| <= r.

    Attributes:
        id: unique name within a file.
        system: the vector field, of 4 coordinates, with a first integral A + b w^2 in the level coordinate w.
        parameters: exact values of all parameters of the vector field, by name.
        reversing_symmetry: the signs of R, 4 of them, two of them -1.
        section: the coordinate that is 0 on the section; R negates it.
        level_coordinate: w, a coordinate that R fixes.
        level_sign: the sign of w at the points of the box.
        crossings: the number of crossings of the section, in either direction, in a period of the periodic orbit.
        arrival: the number of crossings from the box to Fix(R).
        slope: dq/dp of the unstable direction, about; not 0.
        cone: the unstable manifold rises at most so steeply in (a, s).
        centre: shape (2,), c, and the middle of the interval of a in which the homoclinic orbit is.
        radii: shape (2,), r, and the half-width of this interval, both positive.
        level: of the first integral; there has to be one.
        provenance: free-form, ignored by the verifier.
    """

    id: Id
    system: System
    parameters: Mapping[Identifier, Rational]
    reversing_symmetry: Signs
    section: Identifier
    level_coordinate: Identifier
    level_sign: Literal[1, -1]
    crossings: Crossings
    arrival: Crossings
    slope: Fraction
    cone: Fraction
    centre: Numbers
    radii: Numbers
    level: Rational | None = None
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = HOMOCLINIC
    parameter = None

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        self.check_setting()
        system = self.system
        if len(system.state) != 4 or system.defined:
            refuse("system", f"{system.name} has not 4 coordinates in plain arithmetic", "give another system")
        if self.level is None:
            refuse("level", "missing", "give that of the first integral")
        if system.first_integral_program is None:
            refuse("level", f"{system.name} has no first integral", "give a system that has one")
        signs = self.reversing_symmetry
        if len(signs) != 4 or any(type(sign) is not int or sign not in (1, -1) for sign in signs) or sum(signs):
            refuse("reversing_symmetry", f"{signs!r} are not two signs 1 and two -1", "give one for each coordinate")
        for name, value, sign in (("section", self.section, -1), ("level_coordinate", self.level_coordinate, 1)):
            if value not in system.state or signs[system.state.index(value)] != sign:
                refuse(name, f"{value!r} is no coordinate with the sign {sign}", f"name one of {system.state}")
        if type(self.level_sign) is not int or self.level_sign not in (1, -1):
            refuse("level_sign", f"{self.level_sign!r} is no sign", "give 1 or -1")
        for name in ("crossings", "arrival"):
            number = getattr(self, name)
            if type(number) is not int or number < 1:
                refuse(name, f"{number!r} is no number of crossings", "give an integer, at least 1")
        for name in ("centre", "radii"):
            if len(getattr(self, name)) != 2:
                refuse(name, "wrong length", "give 2 numbers")
        check_numbers({"level": [(self.level,)]}, rational=True)
        check_numbers({
            "slope": [(self.slope,)], "cone": [(self.cone,)], "centre": [self.centre], "radii": [self.radii],
        })  # fmt: skip
        check_positive("radii", self.radii)
        check_positive("cone", [self.cone])
        if not self.slope:
            refuse("slope", "it is 0", "give that of the unstable direction")

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the box and of the interval."""
        return self.radii

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre."""
        return self.along, "a"

    @cached_property
    def along(self) -> str:
        """The name of p."""
        others = zip(self.system.state, self.reversing_symmetry, strict=True)
        return next(name for name, sign in others if sign == 1 and name != self.level_coordinate)

    @cached_property
    def across(self) -> str:
        """The name of q."""
        others = zip(self.system.state, self.reversing_symmetry, strict=True)
        return next(name for name, sign in others if sign == -1 and name != self.section)

    @cached_property
    def reversible(self) -> ReversibleSystem:
        """The system with the reversing symmetry, the section and the level coordinate of the claim."""
        system = self.system
        return ReversibleSystem(
            name=system.name,
            title=system.title,
            state=system.state,
            parameters=system.parameters,
            vector_field=system.vector_field,
            reversing_symmetry=self.reversing_symmetry,
            section=self.section,
            level_coordinate=self.level_coordinate,
            first_integral=system.first_integral,
            first_integral_name=system.first_integral_name,
        )

    def __repr__(self) -> str:
        return f"<HomoclinicOrbit {self.id!r}: of {self.system.name}>"
