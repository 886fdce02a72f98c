"""Claims about homoclinic orbits for all levels of an interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Annotated, Any, Literal

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Matrix, Numbers, Polynomials, Vector
from orbitproof.shared.claims.homoclinic import HomoclinicOrbit, Signs
from orbitproof.shared.claims.without_symmetry import WithoutSymmetry
from orbitproof.shared.stored import Rational, rules, stored
from orbitproof.shared.systems import System

HOMOCLINIC_CURVE = "homoclinic_curve"


@dataclass(frozen=True, repr=False)
class HomoclinicCurve(WithoutSymmetry):
    """A claim: on each level of an interval a symmetric periodic orbit has a transverse homoclinic orbit.

    All is as in `HomoclinicOrbit`, on the levels level + level_radius t, |t| <= 1; c, the middle and the slope vary.

    Attributes:
        id: unique name within a file.
        system: the vector field, of 4 coordinates, with a first integral A + b w^2 in the level coordinate w.
        parameters: exact values of all parameters of the vector field, by name.
        reversing_symmetry: the signs of R, 4 of them, two of them -1.
        section: the coordinate that is 0 on the section; R negates it.
        level_coordinate: w, a coordinate that R fixes.
        level_sign: the sign of w at the points of the boxes.
        crossings: the number of crossings of the section, in either direction, in a period of the periodic orbits.
        arrival: the number of crossings from the boxes to Fix(R).
        slope: dq/dp of the unstable direction, about, for t = 0; the polynomial is 0 for no t.
        cone: the unstable manifolds rise at most so steeply in (a, s).
        centre: shape (2,), c, and the middle of the interval of a in which the homoclinic orbit is, for t = 0.
        radii: shape (2,), r, and the half-width of the intervals, both positive.
        level_radius: half the length of the interval of levels, positive.
        powers: of c, of the middle and of the slope the coefficients of t, t^2, ..
        level: of the first integral, for t = 0; there has to be one.
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
    level_radius: Rational
    powers: Annotated[Polynomials, rules(minItems=3, maxItems=3)]
    level: Rational | None = None
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = HOMOCLINIC_CURVE
    parameter = None

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        from orbitproof.shared.claims.special_claims import check_homoclinic_curve

        check_homoclinic_curve(self)

    @property
    def middle(self) -> HomoclinicOrbit:
        """The claim for t = 0 alone."""
        return HomoclinicOrbit(**{each.name: getattr(self, each.name) for each in fields(HomoclinicOrbit)})

    @property
    def polynomials(self) -> Matrix:
        """Of c, of the middle of the interval of a, and of the slope: coefficients of 1, t, t^2, .."""
        return tuple((first, *row) for first, row in zip((*self.centre, self.slope), self.powers, strict=True))

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the boxes and of the intervals."""
        return self.radii

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre."""
        return self.middle.coordinates

    def __repr__(self) -> str:
        return f"<HomoclinicCurve {self.id!r}: of {self.system.name}>"
