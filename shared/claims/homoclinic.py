"""Claims about symmetric homoclinic orbits of a periodic orbit, on a level of the first integral."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Numbers, Vector
from orbitproof.shared.claims.without_symmetry import WithoutSymmetry
from orbitproof.shared.stored import Rational, rules, stored
from orbitproof.shared.systems import System

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
        from orbitproof.shared.claims.special_claims import check_homoclinic

        check_homoclinic(self)

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the box and of the interval."""
        return self.radii

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre."""
        return self.along, "a"

    @property
    def along(self) -> str:
        """The name of p."""
        return self._other(1, self.level_coordinate)

    @property
    def across(self) -> str:
        """The name of q."""
        return self._other(-1, self.section)

    def _other(self, sign: int, name: str) -> str:
        signs = zip(self.system.state, self.reversing_symmetry, strict=True)
        return next(each for each, own in signs if own == sign and each != name)

    def __repr__(self) -> str:
        return f"<HomoclinicOrbit {self.id!r}: of {self.system.name}>"
