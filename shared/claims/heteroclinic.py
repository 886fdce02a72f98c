"""Claims about heteroclinic orbits between two symmetric periodic orbits, on one level of the first integral."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Any, Literal

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Numbers, Vector
from orbitproof.shared.claims.homoclinic import HomoclinicOrbit, Signs
from orbitproof.shared.claims.without_symmetry import WithoutSymmetry, refuse
from orbitproof.shared.stored import Rational, stored
from orbitproof.shared.systems import System

HETEROCLINIC = "heteroclinic"
Sign = Literal[1, -1]


@dataclass(frozen=True, repr=False)
class HeteroclinicOrbit(WithoutSymmetry):
    """A claim: a transverse heteroclinic orbit leads from one symmetric periodic orbit to another one on its level.

    Section, p, q and boxes are as in `HomoclinicOrbit`. What there is two of is that of the orbit from which the
    heteroclinic orbit comes, and that of the orbit to which it tends; the latter is followed backwards, as R tells.

    Attributes:
        id: unique name within a file.
        system: the vector field, of 4 coordinates, with a first integral A + b w^2 in the level coordinate w.
        parameters: exact values of all parameters of the vector field, by name.
        reversing_symmetry: the signs of R, 4 of them, two of them -1.
        section: the coordinate that is 0 on the section; R negates it.
        level_coordinate: w, a coordinate that R fixes.
        level_sign: two signs, of w at the points of the boxes.
        returns: two numbers of crossings of the section, in either direction, in a period of each periodic orbit.
        arrival: two numbers of crossings, from the boxes to where the unstable manifold of the one meets the mirror
            image of that of the other.
        slope: two numbers, dq/dp of the unstable directions, about; not 0.
        cone: two numbers: the unstable manifolds rise at most so steeply in (a, s).
        centre: shape (4,), of each end c, and the middle of the interval of a in which the heteroclinic orbit is.
        radii: shape (4,), of each end r, and the half-width of this interval, all positive.
        level: of the first integral; there has to be one.
        provenance: free-form, ignored by the verifier.
    """

    id: Id
    system: System
    parameters: Mapping[Identifier, Rational]
    reversing_symmetry: Signs
    section: Identifier
    level_coordinate: Identifier
    level_sign: tuple[Sign, Sign]
    returns: tuple[Crossings, Crossings]
    arrival: tuple[Crossings, Crossings]
    slope: tuple[Fraction, Fraction]
    cone: tuple[Fraction, Fraction]
    centre: Numbers
    radii: Numbers
    level: Rational | None = None
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = HETEROCLINIC
    parameter = None

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        for name in ("level_sign", "returns", "arrival", "slope", "cone"):
            if len(getattr(self, name)) != 2:
                refuse(name, "wrong length", "give 2 numbers, one for each periodic orbit")
        for name in ("centre", "radii"):
            if len(getattr(self, name)) != 4:
                refuse(name, "wrong length", "give 4 numbers, two for each periodic orbit")
        for each in self.returns:
            if type(each) is not int or each < 1:
                refuse("returns", f"{each!r} is no number of crossings", "give integers, at least 1")
        for number in range(2):
            self._end(number)

    @classmethod
    def between(cls, name: str, first: HomoclinicOrbit, second: HomoclinicOrbit) -> HeteroclinicOrbit:
        """The claim that has these ends; what both have in common is taken from the first."""
        given = {each.name: getattr(first, each.name) for each in fields(first)}
        given |= {"id": name, "returns": (given.pop("crossings"), second.crossings)}
        given |= {key: (given[key], getattr(second, key)) for key in ("level_sign", "arrival", "slope", "cone")}
        given |= {key: (*given[key], *getattr(second, key)) for key in ("centre", "radii")}
        return cls(**given)

    @property
    def ends(self) -> tuple[HomoclinicOrbit, HomoclinicOrbit]:
        """Periodic orbit, box and sliver of each end. That the way from there ends in Fix(R) is not claimed."""
        return self._end(0), self._end(1)

    def _end(self, number: int) -> HomoclinicOrbit:
        given = {each.name: getattr(self, each.name) for each in fields(HomoclinicOrbit)}
        given |= {"crossings": self.returns[number], "provenance": {}}
        given |= {name: given[name][number] for name in ("level_sign", "arrival", "slope", "cone")}
        given |= {name: given[name][2 * number : 2 * number + 2] for name in ("centre", "radii")}
        return HomoclinicOrbit(**given)

    @property
    def crossings(self) -> int:
        """Of both returns; other claims about boxes have one such number."""
        return sum(self.returns)

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the boxes and of the intervals."""
        return self.radii

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre."""
        along, a = self.ends[0].coordinates
        return along, a, f"{along} of the other end", f"{a} of the other end"

    def __repr__(self) -> str:
        return f"<HeteroclinicOrbit {self.id!r}: of {self.system.name}>"
